//! What can go wrong while a folder becomes a page.

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
        /// What is wrong.
        reason: String,
    },
    /// A table without a column that its name promises.
    #[error("{}:1: no column `{column}`", file.display())]
    Column {
        /// The table.
        file: PathBuf,
        /// What is missing.
        column: String,
    },
    /// A figure or provenance that cannot be shown.
    #[error("{}: {reason}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong.
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
