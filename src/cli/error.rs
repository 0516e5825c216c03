//! Why a command ended without an answer.

use crate::case::CaseError;
use crate::case::reader::suggestion;
use crate::files::bundle::FolderError;
use crate::report::ReportError;
use crate::report::page::PageError;
use crate::run::choice::ChoiceError;
use crate::studies::exchange::export::ExportError;
use crate::studies::exchange::problem_file::ProblemFileError;
use crate::studies::lab::LabError;
use crate::studies::measure::RunError;
use crate::studies::paper::PaperError;
use crate::studies::records::RecordsError;
use crate::studies::sources::collection::CollectionError;

/// Why a command ended with exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A run could not start.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The main job.
    #[error(transparent)]
    Paper(#[from] PaperError),
    /// Files.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A folder that cannot be written.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A folder that cannot be shown as a page.
    #[error(transparent)]
    Page(#[from] PageError),
    /// An increment that cannot be exported.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A folder of problem files that cannot be listed.
    #[error(transparent)]
    Collection(#[from] CollectionError),
    /// A problem file that cannot be solved.
    #[error(transparent)]
    ProblemFile(#[from] ProblemFileError),
    /// A name nobody knows.
    #[error("unknown {what} `{name}`{}, known: {known}", suggestion(name, &known.split(", ").collect::<Vec<_>>()))]
    Unknown {
        /// Method or case.
        what: &'static str,
        /// As given.
        name: String,
        /// The choices.
        known: String,
    },
    /// Two runs of one name.
    #[error("{what} `{name}` is given twice: their results would have the same name")]
    Twice {
        /// Method or case.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A method whose limit are laws of its own, where errors of the discretisation are asked for.
    #[error(
        "method `{name}` solves laws of its own: its modelling error would hide that of the mesh"
    )]
    Inexact {
        /// The method.
        name: String,
    },
    /// Methods given beside a sweep.
    #[error("--method is for cases and folders: a sweep file names its own methods")]
    MethodOfSweep,
    /// A folder of records.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// Not all could be measured.
    #[error(transparent)]
    Lab(#[from] LabError),
    /// This program cannot be found to start it again.
    #[error("cannot find this program to measure cells in a process of its own: {0}")]
    Program(&'static str),
    /// Interruptions cannot be caught.
    #[error("cannot watch for interruptions: {0}")]
    Interrupt(ctrlc::Error),
    /// A worker that lost its conductor, or was refused its memory limit.
    #[error("cannot measure cells: {0}")]
    Work(std::io::Error),
    /// A method with options.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
}

impl From<CaseError> for CliError {
    fn from(error: CaseError) -> Self {
        CliError::Run(error.into())
    }
}
