//! Cases, methods and values of the main job by name; what is missing is an error.

use crate::case::{Case, CaseError, shipped};
use crate::run::choice::Choice;
use crate::run::registry::method;
use crate::run::verdict::Verdict;
use crate::studies::measure::RunError;
use crate::studies::record::Record;
use crate::studies::results::Results;

/// Method that the others are compared with.
pub const REFERENCE_METHOD: &str = "b-newton";

/// Why the main job stopped.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// A run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The printed numbers.
    #[error("cases/reference: {0}")]
    Reference(#[from] csv::Error),
    /// A case or method that this program was built without.
    #[error("this program was built without {0}")]
    Missing(String),
}

impl From<CaseError> for PaperError {
    fn from(error: CaseError) -> Self {
        PaperError::Run(error.into())
    }
}

/// A shipped case.
///
/// # Errors
/// One that this program was built without, or that does not parse.
pub fn case(name: &str) -> Result<Case, PaperError> {
    match shipped::find(name) {
        Some(case) => Ok(case?),
        None => Err(PaperError::Missing(format!("cases/{name}.toml"))),
    }
}

/// A method with options.
///
/// # Errors
/// One that this program was built without.
pub fn choice(name: &str, options: &[(String, f64)]) -> Result<Choice, PaperError> {
    let missing = || PaperError::Missing(format!("method {name}"));
    let method = method(name).ok_or_else(missing)?;
    Choice::new(method, options).map_err(|e| PaperError::Missing(format!("{name}: {e}")))
}

/// The quantity compared: quantity, place, component.
pub type Compared = [&'static str; 3];

/// Reaction of the plate at its top.
pub const REACTION: Compared = ["reaction", "top", "y"];

/// The reaction as the paper prints it [MN/m]: the support pushes down on the body, the paper has the magnitude.
pub fn as_printed(reaction: f64) -> f64 {
    -reaction / 1e6
}

/// A run of a case by a method, among others.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Everything that was run; the case on one mesh.
    pub results: &'a Results,
    /// Case.
    pub case: &'a str,
    /// Friction coefficient.
    pub friction: f64,
    /// Method label.
    pub method: &'a str,
}

impl<'a> Run<'a> {
    /// The run of a case at a friction coefficient by a method.
    pub fn of(results: &'a Results, case: &'a str, friction: f64, method: &'a str) -> Self {
        Self {
            results,
            case,
            friction,
            method,
        }
    }

    /// Its record; `None` where there is no such run.
    pub fn record(&self) -> Option<&'a Record> {
        let has = |record: &&Record| {
            (record.asked.case == self.case && record.found.method == self.method)
                && record.asked.mu() == self.friction
        };
        self.results.records().filter(has).last()
    }

    /// Value of a quantity at its end; `None` where the run has none.
    pub fn value(&self, [quantity, at, component]: [&str; 3]) -> Option<f64> {
        let mut own = self.record()?.found.increments.last()?.quantities.iter();
        own.find(|q| q.name == quantity && q.at == at && q.component == component)
            .map(|q| q.value)
    }

    /// Its verdict.
    pub fn verdict(&self) -> Option<Verdict> {
        self.record().map(|record| record.found.verdict.clone())
    }
}
