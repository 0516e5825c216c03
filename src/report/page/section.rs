//! What a page is made of: sections of blocks. No HTML here.

use super::Drawing;

/// A part of the page with an entry in its table of contents.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Anchor: ASCII letters, digits and hyphens, unique in the page.
    pub id: String,
    /// Heading.
    pub title: String,
    /// What the reader finds here, one or two sentences; may be empty.
    pub lead: String,
    /// Contents in order.
    pub blocks: Vec<Block>,
}

/// Contents of a section.
#[derive(Debug, Clone)]
pub enum Block {
    /// Heading below that of the section.
    Heading(String),
    /// Text.
    Paragraph(String),
    /// Items of text.
    List(Vec<String>),
    /// Words and what they mean.
    Terms(Vec<(String, String)>),
    /// Single numbers, shown large.
    Facts(Vec<Fact>),
    /// A table.
    Table(Grid),
    /// Figures that are folded together.
    Figures(Figures),
    /// Links to files.
    Links(Vec<Link>),
}

/// One number with what it counts.
#[derive(Debug, Clone)]
pub struct Fact {
    /// The number, as shown.
    pub value: String,
    /// What it is.
    pub label: String,
    /// Section that tells more.
    pub section: &'static str,
}

/// A table: cells as in the CSV file, shown with the digits of their column.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    /// Anchor, unique in the page.
    pub id: String,
    /// Title.
    pub title: String,
    /// Columns.
    pub columns: Vec<Column>,
    /// Cells; as many per row as there are columns.
    pub rows: Vec<Vec<String>>,
    /// The files that the table comes from.
    pub links: Vec<Link>,
}

/// A column of a table.
#[derive(Debug, Clone)]
pub struct Column {
    /// Heading.
    pub heading: String,
    /// Unit; empty for none.
    pub unit: String,
    /// What stands in it.
    pub kind: Kind,
}

/// What stands in a column. Numbers are right-aligned and sorted as numbers; a cell that is no number is shown as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Text.
    Text,
    /// A verdict: text with a colour.
    Verdict,
    /// A number as it is written.
    Number,
    /// A number with this many decimals.
    Fixed(usize),
    /// A number with this many significant digits.
    Digits(usize),
    /// A share, shown in per cent with this many decimals.
    Percent(usize),
}

/// Figures that are folded together.
#[derive(Debug, Clone)]
pub struct Figures {
    /// What they show: the line that is always visible.
    pub title: String,
    /// Whether they are unfolded at first.
    pub open: bool,
    /// Figures inside the page.
    pub figures: Vec<Figure>,
    /// Figures that are only linked.
    pub links: Vec<Link>,
}

/// One figure inside the page.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Caption.
    pub caption: String,
    /// File, relative to the page.
    pub path: String,
    /// What is drawn.
    pub drawing: Drawing,
}

/// A link to a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    /// Text.
    pub text: String,
    /// File, relative to the page, not encoded.
    pub path: String,
    /// Further text behind the link; may be empty.
    pub note: String,
}

impl Link {
    /// A link without further text.
    pub fn new(text: impl Into<String>, path: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            path: path.into(),
            note: String::new(),
        }
    }
}

/// Where the numbers of a folder come from: its `provenance.toml`.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    /// Folder, relative to the page; empty for that of the page.
    pub folder: String,
    /// Entries, sorted by name, those of sub-tables behind a colon.
    pub entries: Vec<(String, String)>,
}

/// Units at the end of column names.
const UNITS: [(&str, &str); 10] = [
    ("_mn_per_m", "MN/m"),
    ("_n_per_m", "N/m"),
    ("_mib", "MiB"),
    ("_rad", "rad"),
    ("_pa", "Pa"),
    ("_mm", "mm"),
    ("_ms", "ms"),
    ("_us", "µs"),
    ("_m", "m"),
    ("_s", "s"),
];

/// Heading and unit of a column by its name in the CSV file: `reaction_mn_per_m` is `reaction`, `MN/m`.
pub fn heading(column: &str) -> (String, String) {
    let found = UNITS
        .iter()
        .find_map(|(end, unit)| Some((column.strip_suffix(end)?, *unit)));
    let (name, unit) = found.unwrap_or((column, ""));
    (name.replace('_', " "), unit.to_owned())
}
