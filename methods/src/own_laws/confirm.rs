//! Methods with laws of their own judge an iterate before they claim it, as [`residuals_of`] will.
//!
//! Their Newton methods stop by another norm than the judge's, which weights slip by μ, and they solve with W where the
//! judge takes K: either can turn a claim false.

use crate::condensed::problem::ContactProblem;
use crate::contract::judge::residuals_of;
use crate::contract::state::Status;
use crate::error::MethodError;

/// Backward error of equilibrium to reach, below what verdicts allow.
const EQUILIBRIUM: f64 = 1e-13;
/// Corrections per increment; each gains the digits that the condensed operators have right.
const MAX_CORRECTIONS: usize = 3;

/// An iterate that its method holds to be solved, judged.
pub(crate) enum Judged {
    /// The method ends so.
    End(Status),
    /// The claim would be false. The displacements of the iterate, for a correction of the condensed problem.
    Wrong(Vec<f64>),
}

/// Judges an iterate by the laws of `problem.claim`. After as many corrections as are worthwhile a wrong one is `Stalled`.
pub(crate) fn judge(
    problem: &mut ContactProblem<'_>,
    p: &[f64],
    beta: &[f64],
    corrections: usize,
) -> Result<Judged, MethodError> {
    let Some(state) = problem.recover(p, beta)? else {
        return Ok(Judged::End(Status::Diverged));
    };
    let found = residuals_of(problem.increment, &state, problem.claim)?;
    let kept =
        found.claimed <= problem.increment.tolerance && found.claimed_equilibrium <= EQUILIBRIUM;
    if !kept && corrections < MAX_CORRECTIONS {
        return Ok(Judged::Wrong(state.u));
    }
    problem.confirmed = Some(state);
    Ok(Judged::End(if kept {
        Status::Converged
    } else {
        Status::Stalled
    }))
}

/// Judges an iterate of laws on v alone. `None`: the claim would be false, and q has taken up the difference between the
/// jump of the recovered displacements and the condensed one, so that the method can go on from where it is.
pub(crate) fn confirm(
    problem: &mut ContactProblem<'_>,
    p: &[f64],
    beta: &[f64],
    corrections: &mut usize,
) -> Result<Option<Status>, MethodError> {
    let u = match judge(problem, p, beta, *corrections)? {
        Judged::End(status) => return Ok(Some(status)),
        Judged::Wrong(u) => u,
    };
    *corrections += 1;
    let found = problem.slip_of(&u);
    problem.correct(&found, p, beta);
    Ok(None)
}
