//! One increment from several starts: what a single answer cannot say about uniqueness.
//!
//! For friction above the critical value of a contact (Klarbring, Ing. Arch. 60 (1990) 529; Janovský 1981) an increment can
//! have several solutions, and which one a method finds depends on where it starts. A method that finds different ones has
//! solved the problem, but its answer is not *the* answer.

use super::error::MethodError;
use super::linear::dense::solve_dense;
use super::linear::factor::norm;
use super::reduced::{Begin, Reduced};
use super::state::{Claim, ContactState, Silent, Status};
use super::system::Increment;
use crate::Enforcement;
use faer::Mat;

/// Contact forces to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// No forces.
    Zero,
    /// As if every point were tied.
    Stick,
    /// Tension at every point, as large as the reference force: every point reads as open.
    Open,
}

impl Start {
    /// All starts.
    pub const ALL: [Start; 3] = [Start::Zero, Start::Stick, Start::Open];
}

/// What the starts together say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uniqueness {
    /// Every start led to the same solution.
    Solved,
    /// Every start led to a solution, and they differ.
    NonUniqueSuspected,
    /// Some start led nowhere, the first of them so.
    Failed(Status),
}

impl Uniqueness {
    /// Name in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Uniqueness::Solved => "solved",
            Uniqueness::NonUniqueSuspected => "solved-nonunique-suspected",
            Uniqueness::Failed(status) => status.as_str(),
        }
    }
}

/// Solutions are different if their forces differ by more than this multiple of the tolerance, relative to the reference
/// force: the condition of the problem enlarges what the tolerance leaves open.
const DIFFERENT: f64 = 1e4;

/// Solves an increment from every start of [`Start::ALL`]; the history of slip is that of the increment's own start.
///
/// # Errors
/// Those of the method.
pub fn from_all_starts(
    method: &mut dyn Enforcement,
    increment: &Increment<'_>,
) -> Result<(Uniqueness, Vec<ContactState>), MethodError> {
    let mut states: Vec<ContactState> = Vec::new();
    let mut failed = None;
    // No problem: nothing closes, and nothing depends on the start.
    let problem = match Reduced::begin(increment, |_| Claim::Exact)? {
        Begin::Contact(problem) => Some(problem),
        Begin::Done(_) => None,
    };
    for start in Start::ALL {
        let guess = ContactState {
            u: increment.start.u.clone(),
            p: forces(start, increment, problem.as_ref()),
        };
        let posed = Increment {
            start: &guess,
            ..*increment
        };
        let outcome = method.solve(&posed, &mut Silent)?;
        if outcome.status != Status::Converged && failed.is_none() {
            failed = Some(outcome.status);
        }
        states.push(outcome.state);
    }
    let apart = |a: &ContactState, b: &ContactState| {
        let d: Vec<f64> = a.p.iter().zip(&b.p).map(|(a, b)| a - b).collect();
        let size = problem.as_ref().map_or(0.0, |p| p.reference_force(&a.p));
        norm(&d) > DIFFERENT * increment.tolerance * size
    };
    let verdict = match failed {
        Some(status) => Uniqueness::Failed(status),
        None if states[1..].iter().any(|s| apart(&states[0], s)) => Uniqueness::NonUniqueSuspected,
        None => Uniqueness::Solved,
    };
    Ok((verdict, states))
}

/// Contact forces of a start, all rows.
fn forces(start: Start, increment: &Increment<'_>, problem: Option<&Reduced<'_>>) -> Vec<f64> {
    let mut p = vec![0.0; increment.start.p.len()];
    match (start, problem) {
        (Start::Stick, Some(problem)) => {
            for (&row, force) in
                (problem.rows.source.iter()).zip(tied_forces(problem).unwrap_or_default())
            {
                p[row] = force;
            }
        }
        (Start::Open, Some(problem)) => {
            let tension = -problem.reference_force(&[]);
            let normal = p.iter_mut().step_by(increment.system.dim());
            normal.for_each(|p| *p = tension);
        }
        (Start::Zero, _) | (_, None) => {}
    }
    p
}

/// P of W P + Q β = −q, Qᵀ P = c: all points tied; `None` if points are redundant.
pub(crate) fn tied_forces(problem: &Reduced<'_>) -> Option<Vec<f64>> {
    let m = problem.len();
    let (modes, rho) = (&problem.condensed.modes.q, problem.condensed.rho);
    let size = m + modes.len();
    let bordered = Mat::from_fn(size, size, |i, j| match (i < m, j < m) {
        (true, true) => rho * problem.condensed.w[(i, j)],
        (true, false) => modes[j - m][i],
        (false, true) => modes[i - m][j],
        (false, false) => 0.0,
    });
    let mut rhs: Vec<f64> = problem.q.iter().map(|q| -rho * q).collect();
    rhs.extend(&problem.balance);
    let mut solution = solve_dense(&bordered, &rhs)?;
    solution.truncate(m);
    Some(solution)
}
