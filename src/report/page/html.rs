//! Sections as HTML. The only place that knows tags; text is escaped by the templates.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::folder::{Figure, Figures, Link, Origin, split};
use super::{Folder, PageError, Sheet};
use crate::report::table::{About, Description, Shown, View};
use crate::run::verdict::{NOT_RUN, Verdict, VerdictKind};
use crate::studies::rows::{MET, MISSED_AS_DOCUMENTED};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Nothing may be fetched, whatever a table says; figures are images, which can neither fetch nor act.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// A part of the page with an entry in its table of contents.
pub struct Section {
    /// Anchor, unique in the page.
    pub id: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Contents for the reader.
    pub lead: &'static str,
    /// Contents in order.
    pub blocks: Vec<Block>,
}

/// Contents of a section.
pub enum Block {
    /// Single numbers, shown large.
    Facts(Vec<Fact>),
    /// Words and what they mean, folded.
    Terms {
        title: &'static str,
        terms: Vec<(String, String)>,
    },
    /// A table.
    Table(Grid),
    /// One figure.
    Figure(Figure),
    /// Figures of one kind, folded where there are several.
    Figures(Figures),
    /// Links to files.
    Links(Vec<Link>),
}

/// One number with what it counts.
pub struct Fact {
    /// The number, as shown.
    pub value: String,
    /// The kind.
    pub label: String,
    /// Section that tells more.
    pub section: &'static str,
}

/// A table: cells as in the CSV file, shown with the digits of their column.
pub struct Grid {
    id: String,
    title: String,
    /// Where cells come from, and what stands above them.
    columns: Vec<(About, Shown)>,
    rows: Vec<Vec<String>>,
    links: Vec<Link>,
}

impl Grid {
    /// The part of a table that is read; times only in rows with an honest verdict.
    ///
    /// # Errors
    /// Those of [`Sheet::texts`].
    pub fn of(
        table: &Description,
        sheet: &Sheet,
        folder: &Folder,
        path: &str,
    ) -> Result<Self, PageError> {
        // Columns that are only in newer files are not missed.
        let has = |column: &&About| column.shown || sheet.texts(column.name).is_ok();
        let columns: Vec<About> = table.columns.iter().filter(has).copied().collect();
        let cells = columns.iter().map(|column| sheet.texts(column.name));
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        let verdict = columns.iter().position(|column| column.name == "verdict");
        let row = |line: usize| {
            let honest = |k: usize| {
                let parsed = cells[k][line].parse::<Verdict>();
                parsed.is_ok_and(|verdict| verdict.is_honest()) || cells[k][line].is_empty()
            };
            let honest = verdict.is_none_or(honest);
            let cell = |k: usize| match columns[k].unit {
                "s" if !honest => "NaN".to_owned(),
                _ => cells[k][line].to_owned(),
            };
            (0..columns.len()).map(cell).collect()
        };
        let rows: Vec<Vec<String>> = (0..sheet.size().0).map(row).collect();
        let view = View::of(table.pivot, &columns, &rows);
        let stem = path.strip_suffix(".csv").unwrap_or(path);
        let (place, name) = split(path);
        let alone = place.is_empty() || folder.named(name).len() == 1;
        let clean = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let place = if alone {
            String::new()
        } else {
            format!(" ({place})")
        };
        let shown = view.columns.into_iter();
        Ok(Self {
            id: format!("table-{}", stem.chars().map(clean).collect::<String>()),
            title: format!("{}{}{place}", table.title, view.note),
            columns: shown.map(|shown| (columns[shown.from], shown)).collect(),
            rows: view.rows,
            links: folder.forms(stem),
        })
    }
}

/// The page: table of contents, sections in order, provenance at the end.
pub fn compose(sections: &[Section], origins: &[Origin]) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { "stickslip: report" }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                a.skip href="#contents" { "Skip to the contents" }
                header {
                    h1 { "stickslip" span { "report" } }
                    p { "Methods of enforcing frictional contact on crack faces, compared on one discretisation." }
                    button #theme type="button" hidden { "Theme" }
                }
                div.frame {
                    nav aria-label="Contents" {
                        details open {
                            summary { "Contents" }
                            ol {
                                @for section in sections {
                                    li { a href={ "#" (section.id) } { (section.title) } }
                                }
                                @if !origins.is_empty() {
                                    li { a href="#provenance" { "Provenance" } }
                                }
                            }
                        }
                    }
                    main #contents tabindex="-1" {
                        @for section in sections { (section_markup(section)) }
                        @if !origins.is_empty() { (provenance(origins)) }
                    }
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    let mut text = page.into_string();
    text.push('\n');
    text
}

fn section_markup(section: &Section) -> Markup {
    html! {
        section #(section.id) {
            h2 { (section.title) }
            p.lead { (section.lead.replace('`', "")) }
            @for block in &section.blocks { (block_markup(block)) "\n" }
        }
        "\n"
    }
}

fn block_markup(block: &Block) -> Markup {
    match block {
        Block::Terms { title, terms } => html! {
            details.gallery {
                summary { (title) }
                dl { @for (term, meaning) in terms { dt { (term) } dd { (meaning) } } }
            }
        },
        Block::Facts(facts) => html! {
            ul.facts {
                @for fact in facts {
                    li { a href={ "#" (fact.section) } { strong { (fact.value) } " " span { (fact.label) } } }
                }
            }
        },
        Block::Table(grid) => table(grid),
        Block::Figure(figure) => card(figure),
        Block::Figures(group) => gallery(group),
        Block::Links(links) => html! { ul.files { @for link in links { li { (anchor(link)) } } } },
    }
}

fn table(grid: &Grid) -> Markup {
    let title = format!("{}-title", grid.id);
    let numeric: Vec<bool> = (0..grid.columns.len())
        .map(|k| {
            let cells = grid.rows.iter().map(|row| row[k].as_str());
            cells
                .filter(|c| !c.is_empty())
                .all(|c| c.parse::<f64>().is_ok())
        })
        .collect();
    html! {
        figure.table {
            figcaption {
                span #(title) { (grid.title) }
                span.forms { @for link in &grid.links { (anchor(link)) " " } }
            }
            div.scroll role="region" aria-labelledby=(title) tabindex="0" {
                table #(grid.id) {
                    thead { tr {
                        @for ((_, shown), numeric) in grid.columns.iter().zip(&numeric) {
                            th scope="col" class=[numeric.then_some("n")] {
                                (shown.heading)
                                @if !shown.unit.is_empty() { " " span.unit { "[" (shown.unit) "]" } }
                            }
                        }
                    } }
                    tbody {
                        @for row in &grid.rows {
                            tr { @for (k, cell) in row.iter().enumerate() { (data(cell, &grid.columns[k].0, numeric[k])) } }
                            "\n"
                        }
                    }
                }
            }
        }
    }
}

fn data(cell: &str, column: &About, numeric: bool) -> Markup {
    if column.name == "verdict" {
        return html! { td { span class=(verdict_class(cell)) { (cell) } } };
    }
    if !numeric && (column.shown_digits.is_none() || cell.parse::<f64>().is_err()) {
        return html! { td { (cell) } };
    }
    let text = match cell.parse::<f64>() {
        Ok(x) if x.is_infinite() => if x > 0.0 { "∞" } else { "−∞" }.to_owned(),
        Ok(x) if x.is_finite() && column.shown_digits.is_some() => typeset(&column.read(x)),
        Ok(x) if x.is_finite() => typeset(cell),
        _ => "–".to_owned(),
    };
    // The key of sorting, where it is not what is read.
    let full = (text != cell).then_some(cell);
    html! { td.n data-v=[full] { (text) } }
}

/// Colour of a verdict, on a run or on what a run found; the word stays, so nothing depends on the colour.
fn verdict_class(text: &str) -> &'static str {
    let run = text.parse::<Verdict>().map(|verdict| verdict.kind());
    match (run, text) {
        (Ok(VerdictKind::Solved), _) | (_, MET | "pass" | "stable") => "v good",
        (Ok(VerdictKind::Approximate), _) | (_, MISSED_AS_DOCUMENTED) => "v fair",
        (Ok(VerdictKind::Refused), _) | (_, NOT_RUN | "") => "v none",
        (
            Ok(
                VerdictKind::FalseClaim
                | VerdictKind::GaveUp
                | VerdictKind::Suspect
                | VerdictKind::Crashed,
            ),
            _,
        )
        | (Ok(VerdictKind::TimedOut | VerdictKind::OutOfMemory), _) => "v bad",
        // `missed`, `fail`, `not stable`; `met against the documentation` says that the documentation is wrong.
        (Err(_), _) => "v bad",
    }
}

/// `-1.5e-7` as −1.5×10⁻⁷.
fn typeset(number: &str) -> String {
    let (mantissa, exponent) = number.split_once('e').unwrap_or((number, ""));
    let mut text = mantissa.replace('-', "−");
    if !exponent.is_empty() {
        text += "×10";
        let raised = |c: char| match c.to_digit(10) {
            Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
            None => '⁻',
        };
        text.extend(exponent.chars().map(raised));
    }
    text
}

fn gallery(group: &Figures) -> Markup {
    let total = group.figures.len() + group.links.len();
    html! {
        details.gallery open[total == 1] {
            summary {
                (group.title) " "
                span.count { "(" (total) @if total == 1 { " figure)" } @else { " figures)" } }
            }
            div.cards { @for item in &group.figures { (card(item)) "\n" } }
            @if !group.links.is_empty() {
                p { "As files: " @for (k, link) in group.links.iter().enumerate() {
                    @if k > 0 { ", " }
                    (anchor(link))
                } }
            }
        }
    }
}

fn card(item: &Figure) -> Markup {
    html! {
        figure class=(if item.wide { "card wide" } else { "card" }) {
            img src=(item.source) alt=(item.title);
            figcaption {
                (anchor(&Link { text: split(&item.path).1.to_owned(), path: item.path.clone(), note: String::new() }))
            }
        }
    }
}

fn anchor(link: &Link) -> Markup {
    html! {
        a href=(encode(&link.path)) { (link.text) }
        @if !link.note.is_empty() { " " span.note { (link.note) } }
    }
}

/// A path as a relative URL. A first part with a colon would be taken for a scheme.
fn encode(path: &str) -> String {
    let mut url = String::new();
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' | b'=' => {
                url.push(char::from(byte));
            }
            _ => url += &format!("%{byte:02X}"),
        }
    }
    url
}

/// Folders beside each other, one row per entry.
fn provenance(origins: &[Origin]) -> Markup {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in origins.iter().flat_map(|origin| &origin.entries) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let value = |origin: &Origin, name: &str| {
        let found = origin.entries.iter().find(|entry| entry.0 == name);
        found.map_or_else(String::new, |entry| entry.1.clone())
    };
    html! {
        section #provenance {
            h2 { "Provenance" }
            p.lead { "Which program on which machine made the numbers. Times are comparable within one folder only." }
            div.scroll tabindex="0" {
                table {
                    thead { tr {
                        th scope="col" { "entry" }
                        @for origin in origins {
                            th scope="col" { @if origin.folder.is_empty() { "this folder" } @else { (origin.folder) } }
                        }
                    } }
                    tbody { @for name in names {
                        tr { td { (name) } @for origin in origins { td { (value(origin, name)) } } }
                    } }
                }
            }
        }
    }
}
