//! Failures while a folder becomes a page.

use std::path::PathBuf;

use crate::files::bundle::FolderError;

/// Failure to make a page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A row of a table.
    #[error("{}:{line}: {reason}", file.display())]
    Row {
        /// The table.
        file: PathBuf,
        /// Line in the file, from 1.
        line: u64,
        /// The fault, in words.
        reason: String,
    },
    /// A table without a column that its name promises.
    #[error("{}:1: no column `{column}`", file.display())]
    Column {
        /// The table.
        file: PathBuf,
        /// The missing thing.
        column: String,
    },
    /// A figure or provenance that cannot be shown.
    #[error("{}: {reason}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// The fault, in words.
        reason: String,
    },
    /// Nothing to show.
    #[error("no report in `{}`: neither tables (.csv) nor figures (.svg)", folder.display())]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
    /// The file system refused.
    #[error(transparent)]
    Folder(#[from] FolderError),
}
