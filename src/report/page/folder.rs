//! The folder a page is made from: which files there are, and what is in them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::{PageError, Sheet};
use crate::files::bundle::FolderError;
use crate::report::Bundle;
use crate::report::figures::{
    Kind, performance, success, time_against_solver_error, time_against_total_error,
};

/// A link to a file.
pub struct Link {
    /// Text.
    pub text: String,
    /// File, relative to the page, not encoded.
    pub path: String,
    /// Further text behind the link; may be empty.
    pub note: String,
}

/// Folders inside folders that are looked into: `accuracy/figures`, one more for what users arrange.
const DEPTH: usize = 3;

/// Kinds of files that a page knows.
const KINDS: [&str; 5] = ["csv", "md", "tex", "svg", "toml"];

/// Folders that are left out: fields for ParaView are many, large and not for reading.
const SKIPPED: [&str; 1] = ["fields"];

/// Kinds of figures that open the page, one of each.
const HEADLINES: [&Kind; 4] = [
    &time_against_total_error::KIND,
    &performance::KIND,
    &time_against_solver_error::KIND,
    &success::KIND,
];

/// A report folder.
#[derive(Debug)]
pub struct Folder<'a> {
    root: PathBuf,
    /// Files that are not on disk yet.
    bundle: Option<&'a Bundle>,
    /// Paths relative to the root, `/` between folders.
    files: BTreeSet<String>,
}

/// Bytes of figures that the page still takes.
#[derive(Debug)]
pub struct Budget {
    left: usize,
}

impl Budget {
    /// So many bytes.
    pub fn new(bytes: usize) -> Self {
        Self { left: bytes }
    }
}

/// One figure inside the page.
pub struct Figure {
    /// Title in the file: what a reader hears who does not see it.
    pub title: String,
    /// File, relative to the page.
    pub path: String,
    /// The file as a data URL: as an image it can neither fetch nor act.
    pub source: String,
    /// Whether it is made for the whole width of a page.
    pub wide: bool,
}

/// Figures of one kind.
pub struct Figures {
    /// The question that they answer.
    pub title: &'static str,
    /// Figures inside the page.
    pub figures: Vec<Figure>,
    /// Figures that are only linked.
    pub links: Vec<Link>,
}

/// Where the numbers of a folder come from: its `provenance.toml`.
pub struct Origin {
    /// Folder, relative to the page; empty for that of the page.
    pub folder: String,
    /// Entries, sorted by name, those of sub-tables behind a colon.
    pub entries: Vec<(String, String)>,
}

impl<'a> Folder<'a> {
    /// Looks into a folder and those below it.
    ///
    /// # Errors
    /// [`FolderError::Io`] where one cannot be listed.
    pub fn open(root: &Path) -> Result<Self, PageError> {
        let mut files = BTreeSet::new();
        list(root, "", DEPTH, &mut files)?;
        Ok(Self {
            root: root.to_path_buf(),
            bundle: None,
            files,
        })
    }

    /// The folder that a bundle becomes.
    pub fn of(bundle: &'a Bundle) -> Self {
        let shown = |path: &&str| has_kind(path);
        Self {
            root: PathBuf::new(),
            bundle: Some(bundle),
            files: bundle.paths().filter(shown).map(str::to_owned).collect(),
        }
    }

    /// Whether there is a file of this path.
    pub fn has(&self, path: &str) -> bool {
        self.files.contains(path)
    }

    /// Paths whose last part is `name`, those nearer to the top first.
    pub fn named(&self, name: &str) -> Vec<&str> {
        self.matching(|own| own == name)
    }

    fn matching(&self, wanted: impl Fn(&str) -> bool) -> Vec<&str> {
        let files = self.files.iter().map(String::as_str);
        let mut found: Vec<&str> = files.filter(|path| wanted(split(path).1)).collect();
        found.sort_by_key(|path| (path.matches('/').count(), *path));
        found
    }

    /// Figures that open the page, as far as the folder has them.
    pub fn headlines(&self) -> Vec<&str> {
        let first = |kind: &&Kind| self.matching(|name| kind.has(name)).into_iter().next();
        HEADLINES.iter().filter_map(first).collect()
    }

    fn bytes(&self, path: &str) -> Result<Vec<u8>, PageError> {
        if let Some(bytes) = self.bundle.and_then(|bundle| bundle.get(path)) {
            return Ok(bytes.to_vec());
        }
        let full = self.root.join(path);
        fs::read(&full).map_err(|e| FolderError::io("read file", &full, e).into())
    }

    fn text(&self, path: &str) -> Result<String, PageError> {
        String::from_utf8(self.bytes(path)?).map_err(|_| self.content(path, "is no UTF-8 text"))
    }

    fn content(&self, path: &str, reason: impl Into<String>) -> PageError {
        PageError::Content {
            file: self.root.join(path),
            reason: reason.into(),
        }
    }

    /// A table.
    ///
    /// # Errors
    /// Those of [`Sheet::read`].
    pub fn sheet(&self, path: &str) -> Result<Sheet, PageError> {
        Sheet::read(&self.root.join(path), &self.bytes(path)?)
    }

    /// Links to the forms of a table.
    pub fn forms(&self, stem: &str) -> Vec<Link> {
        let link = |(text, kind): (&str, &str)| Link {
            text: text.to_owned(),
            path: format!("{stem}.{kind}"),
            note: String::new(),
        };
        let forms = [("CSV", "csv"), ("LaTeX", "tex"), ("Markdown", "md")];
        let links = forms.into_iter().map(link);
        links.filter(|link| self.has(&link.path)).collect()
    }

    /// A figure, if the page still takes it.
    ///
    /// # Errors
    /// [`PageError::Content`] at a file that is no drawing.
    pub fn figure(&self, path: &str, budget: &mut Budget) -> Result<Option<Figure>, PageError> {
        let text = self.text(path)?;
        let size = |name: &str| {
            let (_, behind) = text.split_once(&format!("{name}=\""))?;
            behind.split_once('"').map(|(value, _)| value.to_owned())
        };
        if !text.trim_start().starts_with("<svg") && !text.contains("<svg ") {
            return Err(self.content(path, "is no SVG drawing"));
        }
        if text.len() > budget.left {
            return Ok(None);
        }
        budget.left -= text.len();
        let title = text
            .split_once("<title>")
            .and_then(|(_, t)| t.split_once("</title>"));
        let width = size("width").and_then(|w| w.strip_suffix("mm")?.parse::<f64>().ok());
        Ok(Some(Figure {
            title: title.map_or_else(String::new, |(title, _)| title.to_owned()),
            path: path.to_owned(),
            source: format!("data:image/svg+xml;base64,{}", STANDARD.encode(&text)),
            wide: width.is_none_or(|width| width > 100.0),
        }))
    }

    /// The figures of a kind: inside the page while there is room, linked otherwise; those that open the page are not
    /// repeated. `None` without any.
    ///
    /// # Errors
    /// Those of [`Folder::figure`].
    pub fn figures(&self, kind: &Kind, budget: &mut Budget) -> Result<Option<Figures>, PageError> {
        let mut group = Figures {
            title: kind.question,
            figures: Vec::new(),
            links: Vec::new(),
        };
        let opening = self.headlines();
        let mut own = self.matching(|name| kind.has(name));
        own.retain(|path| !opening.contains(path));
        for path in own {
            match self.figure(path, budget)? {
                Some(figure) => group.figures.push(figure),
                None => group.links.push(Link {
                    text: split(path).1.to_owned(),
                    path: path.to_owned(),
                    note: String::new(),
                }),
            }
        }
        let any = !group.figures.is_empty() || !group.links.is_empty();
        Ok(any.then_some(group))
    }

    /// All `provenance.toml`, that of the page's own folder first.
    ///
    /// # Errors
    /// [`PageError::Content`] where one is no TOML.
    pub fn origins(&self) -> Result<Vec<Origin>, PageError> {
        let read = |path: &str| {
            let table: toml::Table = self
                .text(path)?
                .parse()
                .map_err(|e: toml::de::Error| self.content(path, e.to_string()))?;
            let mut entries = Vec::new();
            for (name, value) in &table {
                match value {
                    toml::Value::Table(options) => {
                        let option = |(key, value)| (format!("{name}: {key}"), plain(value));
                        entries.extend(options.iter().map(option));
                    }
                    other => entries.push((name.clone(), plain(other))),
                }
            }
            Ok(Origin {
                folder: split(path).0.to_owned(),
                entries,
            })
        };
        self.named("provenance.toml")
            .into_iter()
            .map(read)
            .collect()
    }
}

fn plain(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}

/// Folder and name of a path.
pub fn split(path: &str) -> (&str, &str) {
    path.rsplit_once('/').unwrap_or(("", path))
}

fn has_kind(name: &str) -> bool {
    let kind = name.rsplit_once('.').map(|(_, kind)| kind);
    kind.is_some_and(|kind| KINDS.contains(&kind))
}

fn list(
    dir: &Path,
    below: &str,
    depth: usize,
    files: &mut BTreeSet<String>,
) -> Result<(), PageError> {
    let fail = |e| FolderError::io("list folder", dir, e);
    for entry in fs::read_dir(dir).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let kind = entry.file_type().map_err(fail)?;
        let Some(name) = entry.file_name().to_str().map(str::to_owned) else {
            continue;
        };
        let path = format!("{below}{name}");
        if kind.is_dir() {
            let hidden = name.starts_with('.') || SKIPPED.contains(&name.as_str());
            if depth > 0 && !hidden {
                list(&entry.path(), &format!("{path}/"), depth - 1, files)?;
            }
        } else if kind.is_file() && has_kind(&name) {
            files.insert(path);
        }
    }
    Ok(())
}
