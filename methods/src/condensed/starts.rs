//! Where to start an increment from, to find more solutions than one.
//!
//! For friction above the critical value of a contact (Klarbring, Ing. Arch. 60 (1990) 529; Janovský 1981) an increment can
//! have several solutions, and which one a method finds depends on where it starts. A method that finds different ones has
//! solved the problem, but its answer is not *the* answer.

use crate::condensed::point_row::{Bordered, Law};
use crate::condensed::problem::{Begin, ContactProblem};
use crate::contract::law::tangential_norm;
use crate::contract::operator::DelassusForm;
use crate::contract::state::Claim;
use crate::contract::system::{ContactSystem, Increment};
use crate::error::MethodError;

/// Regularisation of a singular tangent of redundant points, relative to 1/ρ: it picks one of the possible P.
pub(crate) const RIDGE: f64 = 1e-10;

/// Contact forces to look for further solutions from, all rows, by number from 0: none, those of points that are all tied, if there
/// are any, tension as large as the reference force, by which every point reads as open, then forces at random within the cones of
/// friction, the same at every call. None where nothing closes without contact forces.
///
/// # Errors
/// Those of factorisation and condensation.
pub fn guess(increment: &Increment<'_>, number: usize) -> Result<Option<Vec<f64>>, MethodError> {
    let begun = ContactProblem::begin(increment, DelassusForm::Formed, |_| Claim::Exact)?;
    let Begin::Contact(problem) = begun else {
        return Ok(None);
    };
    let tension = problem.by_row(-problem.reference_force(), 0.0);
    let known = [
        Some(vec![0.0; problem.len()]),
        tied_forces(&problem),
        Some(tension),
    ];
    let known = known.into_iter().flatten();
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
        p
    };
    let found = known.chain(std::iter::repeat_with(&mut random)).nth(number);
    Ok(found.map(|p| problem.all_forces(&p)))
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
        let (mut system, law) = (Bordered::default(), Law::Rows { a: &a, c: &c });
        system.factor_held(problem, &all, &law).then_some(())?;
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
