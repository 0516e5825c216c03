//! A CSV table of the folder, its shape checked.

use std::path::{Path, PathBuf};

use super::PageError;

/// A table with its header; every row as long as the header.
#[derive(Debug, Clone)]
pub struct Sheet {
    file: PathBuf,
    header: Vec<String>,
    rows: Vec<(u64, Vec<String>)>,
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
        let header = reader.headers().map_err(|error| broken(&error))?;
        let header: Vec<String> = header.iter().map(str::to_owned).collect();
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

    /// Cells of a column.
    ///
    /// # Errors
    /// [`PageError::Column`] where it is missing.
    pub fn texts(&self, column: &str) -> Result<Vec<&str>, PageError> {
        let found = self.header.iter().position(|name| name == column);
        let index = found.ok_or_else(|| PageError::Column {
            file: self.file.clone(),
            column: column.into(),
        })?;
        Ok(self.rows.iter().map(|row| row.1[index].as_str()).collect())
    }

    /// Contents of a column, each read from its cell.
    ///
    /// # Errors
    /// [`PageError::Column`] where it is missing, [`PageError::Row`] at a cell that cannot be read.
    pub fn parsed<T: std::str::FromStr>(&self, column: &str) -> Result<Vec<T>, PageError> {
        let parse = |(cell, (line, _)): (&str, &(u64, Vec<String>))| {
            cell.parse().map_err(|_| PageError::Row {
                file: self.file.clone(),
                line: *line,
                reason: format!("`{cell}` does not belong into column `{column}`"),
            })
        };
        let cells = self.texts(column)?.into_iter();
        cells.zip(&self.rows).map(parse).collect()
    }
}
