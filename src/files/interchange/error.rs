//! What can be wrong with a file that holds a contact problem.

use std::path::{Path, PathBuf};

/// Why a file cannot be read or written. Every message names the file and the place in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InterchangeError {
    /// The file system refused.
    #[error("cannot read `{}`: {source}", path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The bytes are not HDF5, or a part of it that cannot be decoded.
    #[error("`{}`{}: not readable as HDF5: {reason}", path.display(), at(dataset))]
    Hdf5 {
        /// Which file.
        path: PathBuf,
        /// Group or dataset; empty for the whole file.
        dataset: String,
        /// What was found.
        reason: String,
    },
    /// A group or dataset the layout demands is not there.
    #[error("`{}`: {dataset} is missing", path.display())]
    Missing {
        /// Which file.
        path: PathBuf,
        /// Group or dataset.
        dataset: String,
    },
    /// Neither or both of the two problems.
    #[error("`{}`: {found}, expected one of the groups /fclib_local and /fclib_global", path.display())]
    NoProblem {
        /// Which file.
        path: PathBuf,
        /// What is there.
        found: &'static str,
    },
    /// A dataset of another type.
    #[error("`{}`: {dataset} holds {found}, expected {allowed}", path.display())]
    Type {
        /// Which file.
        path: PathBuf,
        /// Which dataset.
        dataset: String,
        /// Type found.
        found: String,
        /// Types that can be read.
        allowed: &'static str,
    },
    /// A dataset of another length.
    #[error("`{}`: {dataset} has {found} entries, expected {allowed}", path.display())]
    Length {
        /// Which file.
        path: PathBuf,
        /// Which dataset.
        dataset: String,
        /// Length found.
        found: u64,
        /// Length expected, in words where it is a range.
        allowed: String,
    },
    /// A matrix of another shape.
    #[error("`{}`: a matrix of {rows} × {cols}, expected {allowed}", path.display())]
    Shape {
        /// Which file.
        path: PathBuf,
        /// Rows found.
        rows: usize,
        /// Columns found.
        cols: usize,
        /// Shape expected.
        allowed: String,
    },
    /// A number out of range.
    #[error("`{}`: {dataset}[{index}] = {value}, allowed: {allowed}", path.display())]
    Value {
        /// Which file.
        path: PathBuf,
        /// Which dataset.
        dataset: String,
        /// Entry, from 0.
        index: usize,
        /// Value found.
        value: String,
        /// What is allowed there.
        allowed: String,
    },
    /// A problem in the right layout that asks for something not solved here.
    #[error("`{}`: {what}", path.display())]
    Unsupported {
        /// Which file.
        path: PathBuf,
        /// What it asks for.
        what: String,
    },
    /// A line of a text file.
    #[error("`{}`, line {line}: `{found}`, expected {allowed}", path.display())]
    Line {
        /// Which file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Text found.
        found: String,
        /// What is allowed there.
        allowed: String,
    },
    /// A problem whose parts do not fit, so that no file of it would be readable.
    #[error("cannot write the problem: {what}")]
    Unwritable {
        /// What does not fit.
        what: String,
    },
}

fn at(dataset: &str) -> String {
    if dataset.is_empty() {
        String::new()
    } else {
        format!(", {dataset}")
    }
}

impl InterchangeError {
    pub(super) fn value(
        path: &Path,
        dataset: impl Into<String>,
        index: usize,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Value {
            path: path.into(),
            dataset: dataset.into(),
            index,
            value: value.to_string(),
            allowed: allowed.into(),
        }
    }
}
