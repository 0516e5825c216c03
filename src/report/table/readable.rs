//! A table for reading: cells as text; Markdown and terminal.

use super::{Digits, Value};

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Text.
    Left,
    /// Numbers.
    Right,
    /// Numbers with a fixed number of decimals: on a terminal the points stand below each other.
    Decimal,
}

impl Align {
    /// Numbers stand on the right.
    pub fn of(digits: Option<Digits>, values: impl IntoIterator<Item = Value>) -> Self {
        let text = |value: Value| matches!(value, Value::Text(_));
        match digits {
            Some(Digits::Fixed(_) | Digits::Percent(_)) => Self::Decimal,
            _ if values.into_iter().any(text) => Self::Left,
            _ => Self::Right,
        }
    }
}

/// Heading of a column.
#[derive(Debug, Clone)]
pub struct Heading {
    /// Words.
    pub name: String,
    /// Unit, in brackets behind the words; empty for none.
    pub unit: String,
    /// Alignment of the cells and the heading.
    pub align: Align,
}

impl Heading {
    fn text(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }
}

/// A table as text: as many cells in every row as there are columns.
#[derive(Debug, Clone)]
pub struct Readable {
    /// Title, the caption in LaTeX.
    pub title: String,
    /// Columns.
    pub columns: Vec<Heading>,
    /// Cells.
    pub rows: Vec<Vec<String>>,
}

impl Readable {
    /// GitHub Markdown: the title as a heading of level 3, then the table.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let heading = |column: &Heading| escape_markdown(&column.text());
        let rule = |column: &Heading| match column.align {
            Align::Left => ":---".to_owned(),
            _ => "---:".to_owned(),
        };
        let mut text = format!("### {}\n\n", self.title);
        text += &line(self.columns.iter().map(heading).collect());
        text += &line(self.columns.iter().map(rule).collect());
        for row in &self.rows {
            text += &line(row.iter().map(|cell| escape_markdown(cell)).collect());
        }
        text
    }

    /// The title and the table for a terminal, never wrapped; no trailing line end.
    pub fn terminal(&self) -> String {
        const FIGURE_SPACE: &str = "\u{2007}";
        let heads = self.columns.iter().map(Heading::text).collect();
        let mut lines: Vec<Vec<String>> = vec![heads];
        lines.extend(self.rows.iter().map(|row| {
            let padded = row.iter().enumerate().map(|(column, cell)| {
                cell.clone() + &FIGURE_SPACE.repeat(self.padding(column, cell))
            });
            padded.collect()
        }));
        let size = |cell: &String| cell.chars().count();
        let widest = |column| lines.iter().map(|row| size(&row[column])).max();
        let widths: Vec<usize> = (0..self.columns.len()).filter_map(widest).collect();
        // Two spaces between columns and no vertical lines, since Table 2 is wide.
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&self.columns).zip(&widths);
            let cells = cells.map(|((cell, column), &width)| match column.align {
                Align::Left => format!("{cell:<width$}"),
                Align::Right | Align::Decimal => format!("{cell:>width$}"),
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        };
        let mut lines: Vec<String> = lines.iter().map(line).collect();
        // Three rules as in booktabs.
        let rule = "─".repeat(lines.iter().map(size).max().unwrap_or(0));
        lines.insert(1, rule.clone());
        format!("{}\n{rule}\n{}\n{rule}", self.title, lines.join("\n"))
    }

    /// Characters to add to a cell so that it has as many decimals as the longest of its column.
    fn padding(&self, column: usize, cell: &str) -> usize {
        if self.columns[column].align != Align::Decimal || !is_number(cell) {
            return 0;
        }
        let cells = self.rows.iter().map(|row| row[column].as_str());
        let longest = cells.filter(|cell| is_number(cell)).map(behind_point).max();
        longest.unwrap_or(0).saturating_sub(behind_point(cell))
    }
}

fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok()
}

/// Characters from the decimal point on, the point included.
fn behind_point(cell: &str) -> usize {
    let mantissa = cell.split(['e', 'E']).next().unwrap_or(cell);
    mantissa.find('.').map_or(0, |at| mantissa.len() - at)
}

/// Text for a cell of Markdown.
pub(super) fn escape_markdown(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '|' | '*' | '`' | '<' => out.extend(['\\', c]),
            '\n' => out.push(' '),
            _ => out.push(c),
        }
    }
    out
}
