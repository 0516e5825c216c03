//! One table, three forms: LaTeX, Markdown, terminal.
//!
//! Cells are text; whoever fills the table decides about digits. On a terminal, cells of columns aligned at the decimal
//! point are padded where they have fewer decimals, so that the points stand below each other.

mod latex;

use super::{Bundle, ReportError};
use comfy_table::{CellAlignment, ContentArrangement, TableStyle};

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Text.
    Left,
    /// Whole numbers.
    Right,
    /// Numbers with decimals: the decimal points stand below each other.
    Decimal,
}

/// One column.
#[derive(Debug, Clone)]
pub struct Column {
    /// Heading.
    pub name: String,
    /// Unit, shown in brackets behind the heading; empty for none.
    pub unit: String,
    /// Alignment of the cells and the heading.
    pub align: Align,
}

impl Column {
    /// A column with a heading, a unit (may be empty) and an alignment.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, align: Align) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            align,
        }
    }

    fn heading(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

/// A table: title, columns, rows of cells.
#[derive(Debug, Clone)]
pub struct Table {
    /// Title, the caption in LaTeX.
    pub title: String,
    /// Columns.
    pub columns: Vec<Column>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(title: impl Into<String>, columns: Vec<Column>) -> Self {
        Self {
            title: title.into(),
            columns,
            rows: Vec::new(),
        }
    }

    /// Appends a row.
    ///
    /// # Errors
    /// [`ReportError::TableShape`] when the number of cells differs from the number of columns.
    pub fn push(&mut self, cells: Vec<String>) -> Result<(), ReportError> {
        if cells.len() != self.columns.len() {
            return Err(ReportError::TableShape {
                title: self.title.clone(),
                row: self.rows.len() + 1,
                found: cells.len(),
                expected: self.columns.len(),
            });
        }
        self.rows.push(cells);
        Ok(())
    }

    /// Rows so far.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// Decimals to add to a cell so that it has as many as the longest of its column.
    fn padding(&self, column: usize, cell: &str) -> usize {
        if self.columns[column].align != Align::Decimal || !is_number(cell) {
            return 0;
        }
        let longest = self
            .rows
            .iter()
            .map(|row| &row[column])
            .filter(|cell| is_number(cell))
            .map(|cell| behind_point(cell))
            .max()
            .unwrap_or(0);
        longest - behind_point(cell)
    }

    /// GitHub Markdown: the title as a heading of level 3, then the table.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = format!("### {}\n\n", self.title);
        text += &line(
            self.columns
                .iter()
                .map(|c| escape_markdown(&c.heading()))
                .collect(),
        );
        text += &line(
            self.columns
                .iter()
                .map(|c| {
                    if c.align == Align::Left {
                        ":---"
                    } else {
                        "---:"
                    }
                    .to_owned()
                })
                .collect(),
        );
        for row in &self.rows {
            text += &line(row.iter().map(|cell| escape_markdown(cell)).collect());
        }
        text
    }

    /// The title and the table for a terminal, never wrapped; no trailing line end.
    pub fn terminal(&self) -> String {
        const FIGURE_SPACE: &str = "\u{2007}";
        let mut table = comfy_table::Table::new();
        // Two spaces between columns and no vertical lines, since Table 2 is wide.
        table.load_style(TableStyle::new());
        table.set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(self.columns.iter().map(Column::heading));
        for row in &self.rows {
            table.add_row(row.iter().enumerate().map(|(column, cell)| {
                cell.clone() + &FIGURE_SPACE.repeat(self.padding(column, cell))
            }));
        }
        for (index, column) in self.columns.iter().enumerate() {
            if let Some(target) = table.column_mut(index) {
                target.set_padding((0, 2));
                target.set_cell_alignment(match column.align {
                    Align::Left => CellAlignment::Left,
                    Align::Right | Align::Decimal => CellAlignment::Right,
                });
            }
        }
        let lines: Vec<String> = table
            .lines()
            .map(|line| line.trim_end().to_owned())
            .collect();
        // Three rules as in booktabs.
        let width = lines.iter().map(|line| line.chars().count()).max();
        let rule = "─".repeat(width.unwrap_or(0));
        let mut text = format!("{}\n{rule}\n", self.title);
        for (index, line) in lines.iter().enumerate() {
            text += line;
            text.push('\n');
            if index == 0 {
                text += &rule;
                text.push('\n');
            }
        }
        text + &rule
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

fn escape_markdown(text: &str) -> String {
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

/// Adds a table as `<stem>.md` and `<stem>.tex`, its LaTeX label `tab:<stem>`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_readable(bundle: &mut Bundle, stem: &str, table: &Table) -> Result<(), ReportError> {
    bundle.add(format!("{stem}.md"), table.markdown())?;
    Ok(bundle.add(format!("{stem}.tex"), table.latex(&format!("tab:{stem}")))?)
}
