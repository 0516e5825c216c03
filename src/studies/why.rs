//! Why a run gave up, decided by what its iterates do, and which published stopping test lies on the way.
//!
//! A method that gives up says how it ended, not why. Its run is deterministic, so it is repeated under the eyes of a
//! [`Watch`], which sees P and v of every iterate; the method knows nothing of it. Files: `watch` records,
//! `active` measures W and the tangent on the points in contact, `enumerate` and `answers` say which solutions there are,
//! `cause` decides, `remedy` finds what solves it, `stopping` evaluates criteria that are no residual of the contact laws.

pub mod active;
pub mod answers;
pub mod cause;
pub mod enumerate;
pub mod remedy;
pub mod stopping;
pub mod watch;

use std::fmt;

use serde::{Deserialize, Serialize};
use stickslip_methods::{Gauge, Increment, MethodError, Tier};

use crate::run::choice::Choice;
use crate::run::path::Solver;
use crate::run::verdict::Verdict;
use answers::Answers;
use cause::{Diagnosis, Evidence};
use stopping::Stop;
use watch::Watch;

/// Why a run gave up, and what solves the problem instead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Why.
    pub diagnosis: Diagnosis,
    /// Solutions known of the problem.
    pub solutions: usize,
    /// First of the [`remedy`] list that solved it, as on the command line.
    pub remedy: Option<String>,
}

impl fmt::Display for Explanation {
    /// The cause, what it is decided by, and what to change.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnosis { cause, measure, .. } = &self.diagnosis;
        write!(f, "{cause}")?;
        if measure.is_finite() {
            write!(f, " ({measure:.1e})")?;
        }
        match &self.remedy {
            Some(remedy) => write!(f, "; {remedy} solves it"),
            None => write!(f, "; {}", cause.advice()),
        }
    }
}

/// Runs a failed method again with the watch on, and says why it failed. `answers` are those of the same increment; `remedies`:
/// whether to look for one.
///
/// # Errors
/// Input that no method could treat.
pub fn explain(
    choice: &Choice,
    solver: &mut Solver<'_>,
    increment: &Increment<'_>,
    verdict: &Verdict,
    answers: &Answers,
    remedies: bool,
) -> Result<Explanation, MethodError> {
    let gauge = Gauge::new(increment)?;
    let mut watch = Watch::new(&gauge);
    // A program outside shows nothing, and is not asked twice.
    if choice.is_registered() {
        solver.watched(increment, &mut watch)?;
    }
    let evidence = Evidence {
        verdict,
        exact: choice.exact(),
        tolerance: increment.tolerance,
        limit: limit(choice),
        watch: &watch,
        answers,
    };
    let diagnosis = Diagnosis::of(&evidence);
    let remedy = match diagnosis.cause {
        cause::Cause::NoSolution => None,
        _ if !remedies => None,
        _ => remedy::of(choice, increment),
    };
    Ok(Explanation {
        diagnosis,
        solutions: answers.solutions,
        remedy,
    })
}

/// Iterations that a method allows itself: the first of its options that is a limit.
fn limit(choice: &Choice) -> Option<f64> {
    let mut options = choice.options().into_iter();
    let limit = options.find(|(spec, _)| spec.name().starts_with("max_"));
    limit.map(|(_, value)| value.number())
}

/// Where each criterion would have stopped a method, asked for the tier `high`.
///
/// # Errors
/// Input that no method could treat.
pub fn stops(
    choice: &Choice,
    solver: &mut Solver<'_>,
    increment: &Increment<'_>,
) -> Result<Vec<Stop>, MethodError> {
    if !choice.is_registered() {
        return Ok(Vec::new());
    }
    let posed = Increment {
        tolerance: Tier::High.tolerance(),
        ..*increment
    };
    let gauge = Gauge::new(&posed)?;
    let mut watch = Watch::new(&gauge);
    solver.watched(&posed, &mut watch)?;
    Ok(stopping::evaluate(
        choice.name(),
        choice.exact(),
        watch.seen(),
    ))
}
