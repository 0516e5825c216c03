//! Failures while results become files.

use crate::files::bundle::FolderError;

/// Failure to write a report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The folder that the report goes to.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A picture whose arrays do not fit together.
    #[error("picture `{name}`: {reason}")]
    FieldMesh {
        /// Array or picture name.
        name: String,
        /// The misfit, with sizes.
        reason: String,
    },
    /// The drawing library failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
    /// The CSV library failed.
    #[error("cannot write CSV: {0}")]
    Csv(#[from] ::csv::Error),
    /// The provenance has no TOML form.
    #[error("cannot write provenance: {0}")]
    Provenance(#[from] toml::ser::Error),
}

impl ReportError {
    /// Lack of a picture for a figure.
    pub(crate) fn field_mesh(name: &str, reason: String) -> Self {
        Self::FieldMesh {
            name: name.to_owned(),
            reason,
        }
    }
}
