//! An SVG file that may stand inside a page: well-formed, made of shapes and text only, its ids its own.

/// Elements of a drawing. Scripts, foreign HTML and style sheets, which would reach the whole page, are none.
const ELEMENTS: [&str; 20] = [
    "svg",
    "title",
    "desc",
    "defs",
    "g",
    "rect",
    "circle",
    "ellipse",
    "line",
    "polyline",
    "polygon",
    "path",
    "text",
    "tspan",
    "clipPath",
    "linearGradient",
    "radialGradient",
    "stop",
    "use",
    "image",
];

/// A checked SVG file.
#[derive(Debug, Clone)]
pub struct Drawing {
    title: String,
    view: String,
    /// What stands between `<svg …>` and `</svg>`.
    body: String,
    wide: bool,
}

/// One thing at the beginning of some markup.
enum Token<'a> {
    Text,
    /// Comment, declaration.
    Skip,
    Open(&'a str, Vec<(&'a str, &'a str)>),
    Empty(&'a str, Vec<(&'a str, &'a str)>),
    Close(&'a str),
}

impl Drawing {
    /// Checks an SVG file.
    ///
    /// # Errors
    /// A sentence on the first thing that does not belong into a page.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut open: Vec<&str> = Vec::new();
        let mut rest = text;
        let mut root: Option<Vec<(&str, &str)>> = None;
        let (mut title, mut body) = (String::new(), String::new());
        while !rest.is_empty() {
            let (token, length) = token(rest)?;
            let (source, after) = rest.split_at(length);
            rest = after;
            match token {
                Token::Skip => continue,
                Token::Text if open.is_empty() && source.trim().is_empty() => continue,
                Token::Text if open.is_empty() => return Err("text outside of <svg>".into()),
                Token::Text => {
                    if open.len() == 2 && open[1] == "title" {
                        title.push_str(source);
                    }
                }
                Token::Open(name, attributes) | Token::Empty(name, attributes) => {
                    check(name, &attributes)?;
                    let closed = source.ends_with("/>");
                    if open.is_empty() {
                        if root.is_some() || name != "svg" || closed {
                            return Err("not one <svg> element".into());
                        }
                        root = Some(attributes);
                        open.push(name);
                        continue;
                    }
                    if !closed {
                        open.push(name);
                    }
                }
                Token::Close(name) => {
                    if open.pop() != Some(name) {
                        return Err(format!("</{name}> closes what is not open"));
                    }
                    if open.is_empty() {
                        continue;
                    }
                }
            }
            body.push_str(source);
        }
        if let Some(name) = open.last() {
            return Err(format!("<{name}> is not closed"));
        }
        let root = root.ok_or("no <svg> element")?;
        let value = |name: &str| root.iter().find(|a| a.0 == name).map(|a| a.1);
        let view = value("viewBox").ok_or("no viewBox")?;
        let millimetres = value("width").and_then(|w| w.strip_suffix("mm")?.parse::<f64>().ok());
        Ok(Self {
            title,
            view: view.to_owned(),
            body: body.trim().to_owned(),
            wide: millimetres.is_none_or(|width| width > 100.0),
        })
    }

    /// Title in the file, entities as they stand there; may be empty.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Whether it is made for the whole width of a page.
    pub fn is_wide(&self) -> bool {
        self.wide
    }

    /// Bytes it adds to a page.
    pub fn size(&self) -> usize {
        self.body.len()
    }

    /// Markup for a page; `prefix` makes the ids of this drawing different from those of all others.
    pub fn markup(&self, prefix: &str) -> String {
        let mut body = self.body.clone();
        for (found, start) in [
            (" id=\"", " id=\""),
            ("url(#", "url(#"),
            ("href=\"#", "href=\"#"),
        ] {
            body = body.replace(found, &format!("{start}{prefix}"));
        }
        format!(
            "<svg viewBox=\"{}\" role=\"img\" aria-label=\"{}\" stroke-linejoin=\"round\">{body}</svg>",
            self.view, self.title
        )
    }
}

/// The first token and its length in bytes.
fn token(text: &str) -> Result<(Token<'_>, usize), String> {
    let end_of = |mark: &str| {
        let found = text.find(mark).map(|at| at + mark.len());
        found.ok_or_else(|| format!("no `{mark}` behind `{}`", start(text)))
    };
    if !text.starts_with('<') {
        let length = text.find('<').unwrap_or(text.len());
        return Ok((Token::Text, length));
    }
    if text.starts_with("<!--") {
        return Ok((Token::Skip, end_of("-->")?));
    }
    if text.starts_with("<?") {
        return Ok((Token::Skip, end_of("?>")?));
    }
    if text.starts_with("<!") {
        return Err(format!("`{}` is no element", start(text)));
    }
    // A `>` inside quotes does not end the element.
    let mut quoted = false;
    let end = text.char_indices().find(|(_, c)| {
        quoted ^= *c == '"';
        *c == '>' && !quoted
    });
    let (end, _) = end.ok_or_else(|| format!("no `>` behind `{}`", start(text)))?;
    let inside = &text[1..end];
    if let Some(name) = inside.strip_prefix('/') {
        return Ok((Token::Close(name.trim()), end + 1));
    }
    let (inside, empty) = match inside.strip_suffix('/') {
        Some(inside) => (inside, true),
        None => (inside, false),
    };
    let name_end = inside
        .find(|c: char| c.is_ascii_whitespace())
        .unwrap_or(inside.len());
    let (name, mut rest) = inside.split_at(name_end);
    let mut attributes = Vec::new();
    while !rest.trim().is_empty() {
        let parts = rest.split_once("=\"").and_then(|(key, behind)| {
            let (value, after) = behind.split_once('"')?;
            Some((key.trim(), value, after))
        });
        let Some((key, value, after)) = parts else {
            return Err(format!(
                "<{name}> has an attribute that is no name=\"value\""
            ));
        };
        attributes.push((key, value));
        rest = after;
    }
    let token = match empty {
        true => Token::Empty(name, attributes),
        false => Token::Open(name, attributes),
    };
    Ok((token, end + 1))
}

fn start(text: &str) -> String {
    text.chars().take(20).collect()
}

/// Refuses what would act on the page or fetch something.
fn check(name: &str, attributes: &[(&str, &str)]) -> Result<(), String> {
    if !ELEMENTS.contains(&name) {
        return Err(format!("<{name}> is no part of a drawing"));
    }
    for (key, value) in attributes {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-:_".contains(c);
        let link = key.ends_with("href");
        let outside = link && !value.starts_with('#') && !value.starts_with("data:image/png;");
        let fetched = value.contains("url(") && !value.contains("url(#");
        if !key.chars().all(plain) || key.is_empty() || key.starts_with("on") || value.contains('<')
        {
            return Err(format!("<{name}> has the attribute `{key}`"));
        }
        if outside || fetched {
            return Err(format!("<{name}> fetches `{value}`"));
        }
    }
    Ok(())
}
