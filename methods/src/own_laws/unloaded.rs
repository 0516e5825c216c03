//! A floating body that nothing presses and nothing pulls.

#![allow(non_snake_case)]

use crate::condensed::forces::{End, Forces};
use crate::condensed::problem::{Check, ContactProblem};
use crate::contract::state::Status;
use crate::error::MethodError;

/// Lift of a body, relative to its deepest penetration: rounding must not leave any.
const CLEARANCE: f64 = 1.0 + 1e-9;

/// No load on a floating body and no jump that its rigid motions could not close: no contact forces are needed, and there
/// is no length to measure a barrier by. The body stays as close to where it was as its gaps allow.
pub(crate) fn unloaded(problem: &mut ContactProblem<'_>) -> Result<End, MethodError> {
    let P = vec![0.0; problem.len()];
    let beta = lifted(problem, problem.start_amplitudes(&P));
    let v = problem.jump(&P, &beta);
    let violation = problem.violation(&P, &v);
    problem.note(violation, 0);
    let status = if violation <= problem.stop {
        Status::Converged
    } else {
        Status::Stalled
    };
    let status = match problem.confirm(status, &P, &beta)? {
        Check::End(status) => status,
        _ => Status::Stalled,
    };
    let at = Forces { p: P, beta };
    Ok(End { status, at })
}

/// Moved out of penetration along the rigid motion that opens all points most evenly, as far as that opens them.
fn lifted(problem: &ContactProblem<'_>, beta: Vec<f64>) -> Vec<f64> {
    let modes = &problem.operator.modes;
    let along = modes.components(&problem.by_row(1.0, 0.0));
    let mut opening = vec![0.0; problem.len()];
    modes.add(&along, &mut opening);
    let v = problem.jump(&vec![0.0; problem.len()], &beta);
    let normal = problem.rows.normal().iter();
    let needed = normal.filter(|&&k| v[k] < 0.0).map(|&k| -v[k] / opening[k]);
    let t = CLEARANCE * needed.filter(|t| t.is_finite()).fold(0.0, f64::max);
    beta.iter().zip(&along).map(|(b, a)| b + t * a).collect()
}
