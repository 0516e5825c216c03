//! Loads that no contact force balances: the proof that an increment has no solution.
//!
//! Of two things exactly one is true (Farkas' lemma for cones, up to limits):
//! ```text
//! Qᵀ P = c  for some P with |P_t| <= μ P_n           the load on floating pieces can be balanced
//! g >= μ |d|  for v = Q β = (g, d),   c·β < 0        a rigid motion opens or slides out everywhere, and the load drives it
//! ```
//! since P·Q β >= 0 for every such P. The motion is looked for by clarabel and tested here.

use crate::algebra::dense::{dot, norm};
use crate::condensed::problem::{Begin, ContactProblem};
use crate::conic::cone_program::ConeProgram;
use crate::contract::law::tangential_norm;
use crate::{Claim, DelassusForm, Increment, MethodError};

/// Part of |v| by which the motion may miss the cones: forces that would balance the load all the same are at least
/// [`DRIVEN`]/`CLOSED` times the load.
const CLOSED: f64 = 1e-10;
/// Least −c·β / |c| |β|.
const DRIVEN: f64 = 1e-6;
/// Least −c·β / |β| in reference forces: less is lost in the tolerance of any answer.
const FELT: f64 = 1e-9;

/// True if no contact force within the cones of friction balances the load of an increment: no displacement is in equilibrium.
///
/// # Errors
/// Input that no method could treat; see [`MethodError`].
pub fn unbalanced(increment: &Increment<'_>) -> Result<bool, MethodError> {
    if increment.system.elastic().floating().is_empty() {
        return Ok(false);
    }
    let begin = ContactProblem::begin(increment, DelassusForm::Formed, |_| Claim::Exact)?;
    let Begin::Contact(problem) = begin else {
        return Ok(false);
    };
    let Some(beta) = ConeProgram::unbalanced(&problem)? else {
        return Ok(false);
    };
    let modes = &problem.operator.modes;
    let mut v = vec![0.0; problem.len()];
    modes.add(&beta, &mut v);
    let slack = CLOSED * norm(&v);
    let opens = problem.rows.iter().enumerate().all(|(i, own)| {
        let v = &v[own];
        v[0] >= problem.friction(i) * tangential_norm(v) - slack
    });
    let least = (DRIVEN * norm(&problem.balance)).max(FELT * problem.reference_force(&[]));
    let power = -dot(&problem.balance, &beta);
    Ok(opens && power > least * norm(&beta))
}
