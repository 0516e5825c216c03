//! Cases, methods and values of the main job by name; what is missing is an error.

use crate::case::{Case, CaseError, shipped};
use crate::run::choice::Choice;
use crate::run::record::{Results, RunKey};
use crate::run::registry::method;
use crate::run::run_case::RunError;
use crate::run::verdict::Verdict;

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

/// Value of a quantity of a run; `None` where the run has none.
pub fn value(
    results: &Results,
    key: impl Fn(&RunKey) -> bool,
    quantity: &str,
    at: &str,
    component: &str,
) -> Option<f64> {
    results
        .quantities
        .iter()
        .filter(|row| key(&row.key))
        .map(|row| &row.quantity)
        .find(|q| q.name == quantity && q.at == at && q.component == component)
        .map(|q| q.value)
}

/// Verdict of the last increment of a run.
pub fn verdict(results: &Results, key: impl Fn(&RunKey) -> bool) -> Option<Verdict> {
    let last = results.runs.iter().rfind(|r| key(&r.key));
    last.map(|r| r.verdict.clone())
}
