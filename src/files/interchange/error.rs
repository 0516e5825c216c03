//! Faults of a file that holds a contact problem.

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
    /// A file that is not HDF5, lacks a part, has another one than the layout or a number out of range, or asks for something
    /// not solved here.
    #[error("`{}`{what}", path.display())]
    Refused {
        /// Which file.
        path: PathBuf,
        /// Where in it and why.
        what: String,
    },
    /// A problem whose parts do not fit, so that no file of it would be readable.
    #[error("cannot write the problem: {what}")]
    Unwritable {
        /// The misfit.
        what: String,
    },
}

impl InterchangeError {
    /// A file that lacks a part, or asks for something not solved here.
    pub fn refused(path: &Path, what: impl AsRef<str>) -> Self {
        let what = format!(": {}", what.as_ref());
        Self::Refused {
            path: path.into(),
            what,
        }
    }

    /// Bytes that are not HDF5, or a group or dataset that cannot be decoded; `""` for the whole file.
    pub(super) fn unreadable(path: &Path, dataset: &str, reason: &str) -> Self {
        let at = if dataset.is_empty() { "" } else { ", " };
        Self::Refused {
            path: path.into(),
            what: format!("{at}{dataset}: not readable as HDF5: {reason}"),
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
        Ok(())
    } else {
        Err(unwritable(format!(
            "{what}: {found} entries, expected {expected}"
        )))
    }
}
