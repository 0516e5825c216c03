//! One method on one increment: prepared, timed, judged. Cases and random studies go through here alike.

use std::time::Instant;

use stickslip_methods::{
    ContactSystem, Enforcement, Increment, MethodError, Outcome, PointStatus, Residuals, Silent,
    consistency, point_status, residuals_of,
};

use super::verdict::Verdict;
use crate::run::choice::Choice;

/// What came of an increment.
pub struct Attempt {
    /// Claim × check.
    pub verdict: Verdict,
    /// Time the method took, in s, without the factorisation and condensation it shares with others.
    pub solve_s: f64,
    /// What was judged; `None` if the method failed with an error.
    pub judged: Option<Judged>,
}

/// An outcome with what the judge found.
pub struct Judged {
    /// As the method returned it.
    pub outcome: Outcome,
    /// Residuals of equilibrium, of the contact laws, and of the laws claimed.
    pub found: Residuals,
    /// Open, stick or slip, by point.
    pub status: Vec<PointStatus>,
    /// See [`consistency`].
    pub consistency: Option<Vec<f64>>,
}

impl Attempt {
    /// No outcome to judge.
    pub fn unsolved(verdict: Verdict) -> Self {
        Self {
            verdict,
            solve_s: f64::NAN,
            judged: None,
        }
    }
}

/// Builds and prepares a method: the method and its seconds, or why not.
///
/// # Errors
/// [`Verdict::Refused`] or [`Verdict::Crashed`].
pub fn prepare(
    choice: &Choice,
    system: &ContactSystem,
) -> Result<(Box<dyn Enforcement>, f64), Verdict> {
    let crashed = |e: MethodError| Verdict::failed(e.to_string());
    let mut method = (choice.method.build)(&choice.options);
    if let Some(reason) = method.refuses(system) {
        return Err(Verdict::Refused(reason));
    }
    let (prepared, seconds) = timed(system, || method.prepare(system));
    prepared.map_err(crashed)?;
    Ok((method, seconds))
}

/// Solves an increment and judges the outcome against the natural map accepted.
pub fn attempt(method: &mut dyn Enforcement, increment: &Increment<'_>, accepted: f64) -> Attempt {
    let (solved, solve_s) = solve(method, increment);
    let judged = solved.and_then(|outcome| {
        let found = residuals_of(increment, &outcome.state, outcome.claim)?;
        let status = point_status(increment, &outcome.state)?;
        let consistency = consistency(increment, &outcome.state, outcome.claim)?;
        Ok(Judged {
            outcome,
            found,
            status,
            consistency,
        })
    });
    match judged {
        Ok(judged) => Attempt {
            verdict: Verdict::of(&judged.outcome, &judged.found, accepted),
            solve_s,
            judged: Some(judged),
        },
        Err(error) => Attempt::unsolved(Verdict::failed(error.to_string())),
    }
}

/// Solves an increment, unjudged: what the method returned and its seconds.
pub fn solve(
    method: &mut dyn Enforcement,
    increment: &Increment<'_>,
) -> (Result<Outcome, MethodError>, f64) {
    timed(increment.system, || method.solve(increment, &mut Silent))
}

/// Seconds a call took, less the time the shared factorisation and condensation took inside it.
fn timed<T>(system: &ContactSystem, call: impl FnOnce() -> T) -> (T, f64) {
    let shared = || {
        let t = system.elastic().timings();
        t.analysis_s + t.factorisation_s + t.condensation_s + t.traction_s
    };
    let (before, clock) = (shared(), Instant::now());
    let value = call();
    let seconds = clock.elapsed().as_secs_f64() - (shared() - before);
    (value, seconds.max(0.0))
}
