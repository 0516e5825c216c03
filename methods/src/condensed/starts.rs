//! One increment from several starts: what a single answer cannot say about uniqueness.
//!
//! For friction above the critical value of a contact (Klarbring, Ing. Arch. 60 (1990) 529; Janovský 1981) an increment can
//! have several solutions, and which one a method finds depends on where it starts. A method that finds different ones has
//! solved the problem, but its answer is not *the* answer.

use crate::algebra::dense::{minus, norm};
use crate::condensed::point_row::{Bordered, Law};
use crate::condensed::problem::{Begin, ContactProblem};
use crate::contract::judge::residuals_of;
use crate::contract::law::tangential_norm;
use crate::contract::operator::DelassusForm;
use crate::contract::registry::Enforcement;
use crate::contract::state::{Claim, ContactState, Silent, Status};
use crate::contract::system::{ContactSystem, Increment};
use crate::error::MethodError;

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
    /// Nothing closes without contact forces, so that every method answers with the open crack: starts do not matter, and
    /// say nothing about further solutions. Above the critical friction there may be some.
    Open,
    /// Every start led to the same solution.
    Solved,
    /// Every start led to a solution, and they differ.
    NonUniqueSuspected,
    /// Some start led to a claim of a state that breaks the contact laws.
    FalseClaim,
    /// Some start led nowhere, the first of them so.
    Failed(Status),
}

impl Uniqueness {
    /// Name in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Uniqueness::Open => "solved-open",
            Uniqueness::Solved => "solved",
            Uniqueness::NonUniqueSuspected => "solved-nonunique-suspected",
            Uniqueness::FalseClaim => "false-claim",
            Uniqueness::Failed(status) => status.as_str(),
        }
    }
}

/// Regularisation of a singular tangent of redundant points, relative to 1/ρ: it picks one of the possible P.
pub(crate) const RIDGE: f64 = 1e-10;

/// Solutions are different if their forces differ by more than this multiple of the tolerance, relative to the reference
/// force: the condition of the problem enlarges what the tolerance leaves open.
const DIFFERENT: f64 = 1e4;

/// Solves an increment with every start of [`Start::ALL`] as its guess: history is that of the increment's own start. Every
/// claim is judged before it counts, by the laws that it is about.
///
/// # Errors
/// Those of the method.
pub fn from_all_starts(
    method: &mut dyn Enforcement,
    increment: &Increment<'_>,
) -> Result<(Uniqueness, Vec<ContactState>), MethodError> {
    let problem = match ContactProblem::begin(increment, DelassusForm::Formed, |_| Claim::Exact)? {
        Begin::Contact(problem) => Some(problem),
        Begin::Done(_) => None,
    };
    let mut states: Vec<ContactState> = Vec::new();
    let (mut failed, mut broken) = (None, false);
    for start in Start::ALL {
        let Some(p) = forces(start, increment, problem.as_deref()) else {
            failed = failed.or(problem.as_deref().map(ContactProblem::singular));
            continue;
        };
        let posed = Increment {
            guess: Some(&p),
            ..*increment
        };
        let outcome = method.solve(&posed, &mut Silent)?;
        if outcome.status == Status::Converged {
            let found = residuals_of(&posed, &outcome.state, outcome.claim)?.claimed;
            // A NaN is no solution.
            broken |= found.is_nan() || found > increment.tolerance;
        } else {
            failed = failed.or(Some(outcome.status));
        }
        states.push(outcome.state);
    }
    let apart = |a: &ContactState, b: &ContactState| {
        let size = problem.as_ref().map_or(0.0, |p| p.reference_force());
        norm(&minus(&a.p, &b.p)) > DIFFERENT * increment.tolerance * size
    };
    let verdict = match (failed, &problem) {
        _ if broken => Uniqueness::FalseClaim,
        (Some(status), _) => Uniqueness::Failed(status),
        (None, None) => Uniqueness::Open,
        (None, Some(_)) if states[1..].iter().any(|s| apart(&states[0], s)) => {
            Uniqueness::NonUniqueSuspected
        }
        (None, Some(_)) => Uniqueness::Solved,
    };
    Ok((verdict, states))
}

/// Contact forces to look for further solutions from, all rows, by number from 0: those of [`Start::ALL`] as far as there are any, then
/// forces at random within the cones of friction, the same at every call. None where nothing closes without contact forces.
///
/// # Errors
/// Those of factorisation and condensation.
pub fn guess(increment: &Increment<'_>, number: usize) -> Result<Option<Vec<f64>>, MethodError> {
    let begun = ContactProblem::begin(increment, DelassusForm::Formed, |_| Claim::Exact)?;
    let Begin::Contact(problem) = begun else {
        return Ok(None);
    };
    let known = Start::ALL
        .into_iter()
        .filter_map(|start| forces(start, increment, Some(&problem)));
    let size = problem.reference_force() / (problem.rows.points() as f64).sqrt();
    // Evenly spread without a pattern: multiples of the golden section.
    let mut turns = (1..).map(|k| (0.618_033_988_749_895 * k as f64).fract());
    let mut random = || {
        let mut p = vec![0.0; problem.len()];
        for (i, own) in problem.rows.iter().enumerate() {
            let [normal, share, angle] = std::array::from_fn(|_| turns.next().unwrap_or_default());
            let (sin, cos) = (std::f64::consts::TAU * angle).sin_cos();
            p[own.start] = 2.0 * normal * size;
            let bound = share * problem.friction(i) * p[own.start];
            let tangential = own.skip(1).zip([cos, sin]);
            tangential.for_each(|(k, part)| p[k] = bound * part);
        }
        problem.all_forces(&p)
    };
    Ok(known.chain(std::iter::repeat_with(&mut random)).nth(number))
}

/// Contact forces of a start, all rows; `None` if there are no tied forces.
fn forces(
    start: Start,
    increment: &Increment<'_>,
    problem: Option<&ContactProblem<'_>>,
) -> Option<Vec<f64>> {
    match (start, problem) {
        (Start::Stick, Some(problem)) => Some(problem.all_forces(&tied_forces(problem)?)),
        (Start::Open, Some(problem)) => {
            let tension = problem.by_row(-problem.reference_force(), 0.0);
            Some(problem.all_forces(&tension))
        }
        (Start::Zero, _) | (_, None) => Some(vec![0.0; increment.start.p.len()]),
    }
}

/// P of W P + Q β = −q, Qᵀ P = c: all points tied. Redundant points make W singular; 1e-10/ρ on its diagonal then picks one
/// of the possible P. `None` if that does not help.
pub(crate) fn tied_forces(problem: &ContactProblem<'_>) -> Option<Vec<f64>> {
    let rho = problem.operator.rho;
    let (all, scaled): (Vec<usize>, Vec<f64>) = (
        (0..problem.len()).collect(),
        problem.q.iter().map(|q| -rho * q).collect(),
    );
    let tied = |ridge: f64| {
        let blocks = |value: f64| -> Vec<[f64; 3]> {
            let unit = [[value, 0.0, 0.0], [0.0, value, 0.0], [0.0, 0.0, value]];
            let points = problem.rows.iter();
            points
                .flat_map(|own| unit.into_iter().take(own.len()))
                .collect()
        };
        let (a, c) = (blocks(ridge), blocks(rho));
        let mut system = Bordered::held(problem, &all, &Law::Rows { a: &a, c: &c })?;
        system.solve(&scaled, &problem.balance).map(|x| x.0)
    };
    tied(0.0).or_else(|| tied(RIDGE))
}

/// ρ · min_i (W_nn − μ |W_nt|) over the diagonal blocks of the Delassus operator \[-\].
///
/// Where it is positive, every point alone, the others held, has exactly one solution for any load (Klarbring 1990;
/// Janovský 1981). Otherwise friction is large enough for several, and no method can be expected to find the one
/// another finds. The sign says nothing certain about all points together, and it depends on the pins of a floating body.
///
/// # Errors
/// Those of factorisation and condensation.
pub fn contact_wise_margin(system: &ContactSystem) -> Result<f64, MethodError> {
    let operator = system.operator(DelassusForm::Formed)?;
    let rows = system.row_set();
    let margin = |i: usize| {
        let own = rows.of(i);
        let block = operator.w.block(own.clone());
        let row = block[0];
        row[0] - system.friction()[i] * tangential_norm(&row[..own.len()])
    };
    let least = (0..rows.points()).map(margin).fold(f64::INFINITY, f64::min);
    Ok(operator.rho * least)
}
