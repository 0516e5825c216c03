//! Sections as HTML. The only place that knows tags; text is escaped by the templates.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Block, Column, Figure, Figures, Grid, Kind, Link, Origin, Section};
use crate::report::number::{fixed, significant};
use crate::run::record::{MET, MISSED_AS_DOCUMENTED};
use crate::run::verdict::{NOT_RUN, Verdict, VerdictKind};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Nothing may be fetched, whatever a table or figure says.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

/// The page: table of contents, sections in order, provenance at the end.
pub fn compose(sections: &[Section], origins: &[Origin]) -> String {
    let mut figures = 0;
    let bodies: Vec<Markup> = sections
        .iter()
        .map(|section| section_markup(section, &mut figures))
        .collect();
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
                        @for body in &bodies { (body) }
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

fn section_markup(section: &Section, figures: &mut usize) -> Markup {
    html! {
        section #(section.id) {
            h2 { (section.title) }
            @if !section.lead.is_empty() { p.lead { (section.lead) } }
            @for block in &section.blocks { (block_markup(block, figures)) "\n" }
        }
        "\n"
    }
}

fn block_markup(block: &Block, figures: &mut usize) -> Markup {
    match block {
        Block::Heading(text) => html! { h3 { (text) } },
        Block::Paragraph(text) => html! { p { (text) } },
        Block::List(items) => html! { ul { @for item in items { li { (item) } } } },
        Block::Terms(terms) => html! {
            dl { @for (term, meaning) in terms { dt { (term) } dd { (meaning) } } }
        },
        Block::Facts(facts) => html! {
            ul.facts {
                @for fact in facts {
                    li { a href={ "#" (fact.section) } { strong { (fact.value) } " " span { (fact.label) } } }
                }
            }
        },
        Block::Table(grid) => table(grid),
        Block::Figures(group) => gallery(group, figures),
        Block::Links(links) => html! { ul.files { @for link in links { li { (anchor(link)) } } } },
    }
}

fn table(grid: &Grid) -> Markup {
    let title = format!("{}-title", grid.id);
    html! {
        figure.table {
            figcaption {
                span #(title) { (grid.title) }
                span.forms { @for link in &grid.links { (anchor(link)) " " } }
            }
            div.scroll role="region" aria-labelledby=(title) tabindex="0" {
                table #(grid.id) {
                    thead { tr {
                        @for column in &grid.columns {
                            th scope="col" class=[is_number(column.kind).then_some("n")] {
                                (column.heading)
                                @if !column.unit.is_empty() { " " span.unit { "[" (column.unit) "]" } }
                            }
                        }
                    } }
                    tbody {
                        @for row in &grid.rows {
                            tr { @for (cell, column) in row.iter().zip(&grid.columns) { (data(cell, column)) } }
                            "\n"
                        }
                    }
                }
            }
        }
    }
}

fn is_number(kind: Kind) -> bool {
    !matches!(kind, Kind::Text | Kind::Verdict)
}

fn data(cell: &str, column: &Column) -> Markup {
    match column.kind {
        Kind::Text => html! { td { (cell) } },
        Kind::Verdict => html! { td { span class=(verdict_class(cell)) { (cell) } } },
        kind => {
            let text = shown(cell, kind);
            // What is sorted by, where it is not what is read.
            let full = (text != cell).then_some(cell);
            html! { td.n data-v=[full] { (text) } }
        }
    }
}

/// Colour of a verdict, on a run or on what a run found; the word stays, so nothing depends on the colour.
fn verdict_class(text: &str) -> &'static str {
    let run = text.parse::<Verdict>().map(|verdict| verdict.kind());
    match (run, text) {
        (Ok(VerdictKind::Solved), _) | (_, MET | "pass" | "stable") => "v good",
        (Ok(VerdictKind::Approximate), _) | (_, MISSED_AS_DOCUMENTED) => "v fair",
        (Ok(VerdictKind::Refused), _) | (_, NOT_RUN | "") => "v none",
        (Ok(VerdictKind::FalseClaim | VerdictKind::GaveUp | VerdictKind::Crashed), _)
        | (Ok(VerdictKind::TimedOut | VerdictKind::OutOfMemory), _) => "v bad",
        // `missed`, `fail`, `not stable`; `met against the documentation` says that the documentation is wrong.
        (Err(_), _) => "v bad",
    }
}

/// A number as the column shows it; other text as it is, nothing where there is no number.
fn shown(cell: &str, kind: Kind) -> String {
    let Ok(value) = cell.parse::<f64>() else {
        return if cell.is_empty() { "–" } else { cell }.to_owned();
    };
    if value.is_nan() {
        return "–".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "−∞" }.to_owned();
    }
    typeset(&match kind {
        Kind::Fixed(decimals) => fixed(value, decimals),
        Kind::Percent(decimals) => fixed(100.0 * value, decimals) + " %",
        Kind::Digits(digits) => significant(value, digits),
        _ => cell.to_owned(),
    })
}

/// `-1.5e-7` as −1.5×10⁻⁷.
fn typeset(number: &str) -> String {
    let (mantissa, exponent) = number.split_once('e').unwrap_or((number, ""));
    let mut text = mantissa.replace('-', "−");
    if !exponent.is_empty() {
        text += "×10";
        text.extend(exponent.chars().map(|c| match c {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            '9' => '⁹',
            other => other,
        }));
    }
    text
}

fn gallery(group: &Figures, count: &mut usize) -> Markup {
    let total = group.figures.len() + group.links.len();
    html! {
        details.gallery open[group.open] {
            summary {
                (group.title) " "
                span.count { "(" (total) @if total == 1 { " figure)" } @else { " figures)" } }
            }
            div.cards { @for item in &group.figures { (card(item, count)) "\n" } }
            @if !group.links.is_empty() {
                p { "As files: " @for (k, link) in group.links.iter().enumerate() {
                    @if k > 0 { ", " }
                    (anchor(link))
                } }
            }
        }
    }
}

fn card(item: &Figure, count: &mut usize) -> Markup {
    *count += 1;
    let prefix = format!("figure-{count}-");
    let class = if item.drawing.is_wide() {
        "card wide"
    } else {
        "card"
    };
    html! {
        figure class=(class) {
            // Checked by `Drawing::read`: shapes and text only.
            (PreEscaped(item.drawing.markup(&prefix)))
            figcaption { (anchor(&Link::new(item.caption.as_str(), item.path.as_str()))) }
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

/// Folders beside each other; entries that all have in common stay one row.
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
    let column = |heading: &str| Column {
        heading: heading.to_owned(),
        unit: String::new(),
        kind: Kind::Text,
    };
    let folder = |origin: &Origin| match origin.folder.as_str() {
        "" => "this folder".to_owned(),
        other => other.to_owned(),
    };
    let file = |origin: &Origin| match origin.folder.as_str() {
        "" => "provenance.toml".to_owned(),
        other => format!("{other}/provenance.toml"),
    };
    let grid = Grid {
        id: "table-provenance".into(),
        title: "Program, machine and options by folder".into(),
        columns: std::iter::once(column("entry"))
            .chain(origins.iter().map(|origin| column(&folder(origin))))
            .collect(),
        rows: names
            .iter()
            .map(|name| {
                let values = origins.iter().map(|origin| value(origin, name));
                std::iter::once((*name).to_owned()).chain(values).collect()
            })
            .collect(),
        links: origins
            .iter()
            .map(|origin| Link::new(file(origin), file(origin)))
            .collect(),
    };
    html! {
        section #provenance {
            h2 { "Provenance" }
            p.lead { "Which program on which machine made the numbers. Times are comparable within one folder only." }
            (table(&grid))
        }
    }
}
