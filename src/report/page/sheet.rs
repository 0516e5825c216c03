//! A CSV table of the folder, its shape checked.

use std::path::{Path, PathBuf};

use super::section::heading;
use super::{Column, Kind, PageError};
use crate::run::verdict::{NoVerdict, Verdict};

/// A table with its header; every row as long as the header.
#[derive(Debug, Clone)]
pub struct Sheet {
    file: PathBuf,
    header: Vec<String>,
    rows: Vec<(u64, Vec<String>)>,
}

/// A column to be shown.
#[derive(Debug, Clone)]
pub struct Show {
    /// Name in the file.
    pub column: &'static str,
    /// What stands in it.
    pub kind: Kind,
    /// Heading; that of the name if `None`.
    pub heading: Option<&'static str>,
}

impl Show {
    /// A column whose heading is made from its name.
    pub const fn new(column: &'static str, kind: Kind) -> Self {
        Self {
            column,
            kind,
            heading: None,
        }
    }

    /// The same with a heading of its own.
    #[must_use]
    pub const fn titled(mut self, text: &'static str) -> Self {
        self.heading = Some(text);
        self
    }
}

impl Sheet {
    /// Reads CSV; `file` is for messages.
    ///
    /// # Errors
    /// [`PageError::Row`] where a row has another number of cells than the header or is no UTF-8.
    pub fn read(file: &Path, bytes: &[u8]) -> Result<Self, PageError> {
        let fail = |line: u64, reason: String| PageError::Row {
            file: file.to_path_buf(),
            line,
            reason,
        };
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(bytes);
        let broken = |error: &csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            fail(line, "is no UTF-8 text".into())
        };
        let header: Vec<String> = match reader.headers() {
            Ok(header) => header.iter().map(str::to_owned).collect(),
            Err(error) => return Err(broken(&error)),
        };
        if header.is_empty() {
            return Err(fail(1, "no header".into()));
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| broken(&error))?;
            let line = record.position().map_or(1, csv::Position::line);
            if record.len() != header.len() {
                let reason = format!("{} cells, the header has {}", record.len(), header.len());
                return Err(fail(line, reason));
            }
            rows.push((line, record.iter().map(str::to_owned).collect()));
        }
        Ok(Self {
            file: file.to_path_buf(),
            header,
            rows,
        })
    }

    /// Numbers of rows and columns.
    pub fn size(&self) -> (usize, usize) {
        (self.rows.len(), self.header.len())
    }

    /// Whether there is a column of this name.
    pub fn has(&self, column: &str) -> bool {
        self.header.iter().any(|name| name == column)
    }

    fn index(&self, column: &str) -> Result<usize, PageError> {
        let found = self.header.iter().position(|name| name == column);
        found.ok_or_else(|| PageError::Column {
            file: self.file.clone(),
            column: column.into(),
        })
    }

    /// Cells of a column.
    ///
    /// # Errors
    /// [`PageError::Column`] where it is missing.
    pub fn texts(&self, column: &str) -> Result<Vec<&str>, PageError> {
        let index = self.index(column)?;
        Ok(self.rows.iter().map(|row| row.1[index].as_str()).collect())
    }

    /// The column `verdict` of a table of runs.
    ///
    /// # Errors
    /// [`PageError::Column`] where it is missing, [`PageError::Row`] at text that is no verdict.
    pub fn verdicts(&self) -> Result<Vec<Verdict>, PageError> {
        let index = self.index("verdict")?;
        let parse = |(line, row): &(u64, Vec<String>)| {
            row[index]
                .parse()
                .map_err(|error: NoVerdict| PageError::Row {
                    file: self.file.clone(),
                    line: *line,
                    reason: error.to_string(),
                })
        };
        self.rows.iter().map(parse).collect()
    }

    /// Numbers of a column; NaN where a cell is empty.
    ///
    /// # Errors
    /// [`PageError::Column`] where it is missing, [`PageError::Row`] at text that is no number.
    pub fn numbers(&self, column: &str) -> Result<Vec<f64>, PageError> {
        let index = self.index(column)?;
        let parse = |(line, row): &(u64, Vec<String>)| {
            let cell = row[index].as_str();
            if cell.is_empty() {
                return Ok(f64::NAN);
            }
            cell.parse().map_err(|_| PageError::Row {
                file: self.file.clone(),
                line: *line,
                reason: format!("`{cell}` in column `{column}` is no number"),
            })
        };
        self.rows.iter().map(parse).collect()
    }

    /// Columns and cells to be shown, rows in the order of the file.
    ///
    /// # Errors
    /// Those of [`Sheet::texts`] and [`Sheet::numbers`].
    pub fn shown(&self, shows: &[Show]) -> Result<(Vec<Column>, Vec<Vec<String>>), PageError> {
        let mut columns = Vec::new();
        let mut cells = Vec::new();
        for show in shows {
            if !matches!(show.kind, Kind::Text | Kind::Verdict) {
                self.numbers(show.column)?;
            }
            cells.push(self.texts(show.column)?);
            let (name, unit) = heading(show.column);
            columns.push(Column {
                heading: show.heading.map_or(name, str::to_owned),
                unit,
                kind: show.kind,
            });
        }
        let row = |line: usize| cells.iter().map(|column| column[line].to_owned()).collect();
        let rows = (0..self.rows.len()).map(row).collect();
        Ok((columns, rows))
    }
}
