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
    /// A part that is not what the layout has there: a dataset of another type or length, a matrix of another shape.
    #[error("`{}`: {found}, expected {allowed}", path.display())]
    Unexpected {
        /// Which file.
        path: PathBuf,
        /// The part, and what it is.
        found: String,
        /// What it may be.
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
    /// A file that lacks a part, or asks for something not solved here.
    #[error("`{}`: {what}", path.display())]
    Refused {
        /// Which file.
        path: PathBuf,
        /// Why.
        what: String,
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
    /// A part that is not what the layout has there.
    pub fn unexpected(path: &Path, found: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self::Unexpected {
            path: path.into(),
            found: found.into(),
            allowed: allowed.into(),
        }
    }

    /// A file that lacks a part, or asks for something not solved here.
    pub fn refused(path: &Path, what: impl Into<String>) -> Self {
        Self::Refused {
            path: path.into(),
            what: what.into(),
        }
    }
}

pub(super) fn unwritable(what: impl Into<String>) -> InterchangeError {
    InterchangeError::Unwritable { what: what.into() }
}

/// Refuses a part whose size does not fit the others.
pub(super) fn check_size(
    what: &str,
    found: usize,
    expected: usize,
) -> Result<(), InterchangeError> {
    if found == expected {
        return Ok(());
    }
    Err(unwritable(format!(
        "{what}: {found} entries, expected {expected}"
    )))
}
