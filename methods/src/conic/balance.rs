//! Proofs that an increment has no solution.
//!
//! Of the forces, by a rigid motion that none of them opposes and the load drives (Farkas' lemma for cones, up to limits):
//! ```text
//! Qᵀ P = c  for some P with |P_t| <= μ P_n           the load on floating pieces can be balanced
//! g >= μ |d|  for v = Q β = (g, d),   c·β < 0        or a rigid motion opens or slides out everywhere, and the load drives it
//! ```
//! since P·Q β >= 0 for every such P. Of the gaps, by points that pinch each other whatever the forces:
//! ```text
//! g >= 0  for some v = q + W P + Q β
//! y_n >= 0,  y_t = 0,  Wᵀ y = 0,  Qᵀ y = 0,  y·q < 0        or y·v = y·q < 0 for all P and β: some gap is negative
//! ```
//! Both are looked for by clarabel and tested here.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use faer::Mat;

use crate::algebra::dense::{dot, larger, mul_add, mul_transpose_add, norm};
use crate::algebra::strips::cholesky;
use crate::condensed::problem::{Begin, ContactProblem};
use crate::conic::cone_program::{ConeProgram, refused, settings};
use crate::conic::fixed_point::TIGHTEST;
use crate::contract::law::tangential_norm;
use crate::contract::operator::DelassusForm;
use crate::contract::state::Claim;
use crate::contract::system::Increment;
use crate::error::MethodError;

/// Part of |v| by which the motion may miss the cones: forces that would balance the load all the same are at least
/// [`DRIVEN`]/`CLOSED` times the load.
const CLOSED: f64 = 1e-10;
/// Least −c·β / |c| |β|.
const DRIVEN: f64 = 1e-6;
/// Least −c·β / |β| in reference forces, and −y·q / Σ y in reference jumps: less is lost in the tolerance of any answer.
const FELT: f64 = 1e-9;
/// Most points that are asked whether they pinch each other: it takes time with their third power.
const MOST_POINTS: usize = 1000;
/// An eigenvalue of W on the normal rows above this is none of a kernel: far above the rounding of `MOST_POINTS` rows.
const REGULAR: f64 = 1e-9;
/// Entries of y below this part of the largest are not of it.
const ABSENT: f64 = 1e-7;

/// True if it is proved that an increment has no solution: no contact force within the cones of friction balances its load, or
/// none opens all gaps.
///
/// # Errors
/// Input that no method could treat; see [`MethodError`].
pub fn no_equilibrium(increment: &Increment<'_>) -> Result<bool, MethodError> {
    let begin = ContactProblem::begin(increment, DelassusForm::Products, |_| Claim::Exact)?;
    let Begin::Contact(problem) = begin else {
        return Ok(false);
    };
    Ok(driven(&problem)? || pinched(&problem)?)
}

/// Whether the load drives a rigid motion that no force opposes.
fn driven(problem: &ContactProblem<'_>) -> Result<bool, MethodError> {
    let Some(beta) = ConeProgram::unbalanced(problem)? else {
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
    let least = (DRIVEN * norm(&problem.balance)).max(FELT * problem.reference_force());
    let power = -dot(&problem.balance, &beta);
    Ok(opens && power > least * norm(&beta))
}

/// Whether points pinch each other. W is scaled to a diagonal of ones, so that points of unlike compliance count alike, and Wᵀ y has
/// to vanish to the rounding of its entries: a soft mode proves nothing.
fn pinched(problem: &ContactProblem<'_>) -> Result<bool, MethodError> {
    let (normal, rows) = (problem.rows.normal(), problem.len());
    if normal.is_empty() || normal.len() > MOST_POINTS {
        return Ok(false);
    }
    let operator = problem.increment.system.operator(DelassusForm::Formed)?;
    let w = operator.w.to_matrix();
    let root = |k: usize| match w[(k, k)] {
        own if own > 0.0 => own.sqrt(),
        _ => operator.rho.recip().sqrt(),
    };
    let modes = &operator.modes.q;
    // Wᵀ above Qᵀ, on normal rows.
    let a = Mat::from_fn(rows + modes.len(), normal.len(), |i, j| {
        let k = normal[j];
        match i.checked_sub(rows) {
            None => w[(k, i)] / (root(k) * root(i)),
            Some(mode) => modes[mode][k] / root(k) / operator.rho.sqrt(),
        }
    });
    if operator.w.symmetric()
        && regular(Mat::from_fn(normal.len(), normal.len(), |i, j| {
            a[(normal[i], j)]
        }))
    {
        return Ok(false);
    }
    let gaps: Vec<f64> = normal.iter().map(|&k| problem.q[k] / root(k)).collect();
    let Some(y) = least_gap(&a, &gaps)? else {
        return Ok(false);
    };
    // On its support alone, where the kernel is found anew: what clarabel leaves of the other entries is none of it.
    let most = y.iter().copied().fold(0.0, larger);
    let support: Vec<usize> = (0..y.len()).filter(|&j| y[j] > ABSENT * most).collect();
    let own = Mat::from_fn(a.nrows(), support.len(), |i, j| a[(i, support[j])]);
    let Some(basis) = kernel(&own) else {
        return Ok(false);
    };
    let on_support: Vec<f64> = support.iter().map(|&j| y[j]).collect();
    let (mut parts, mut y) = (vec![0.0; basis.ncols()], vec![0.0; support.len()]);
    mul_transpose_add(&basis, &on_support, &mut parts);
    mul_add(&basis, &parts, &mut y);
    let mut left = vec![0.0; own.nrows()];
    mul_add(&own, &y, &mut left);
    let closes: f64 = y.iter().zip(&support).map(|(y, &j)| -y * gaps[j]).sum();
    let weight: f64 = (y.iter().zip(&support))
        .map(|(y, &j)| y / root(normal[j]))
        .sum();
    let felt = FELT * problem.reference_jump();
    let vanishes = norm(&left) <= rows as f64 * f64::EPSILON * norm(&y);
    Ok(vanishes && y.iter().all(|&y| y > 0.0) && closes > felt * weight)
}

/// Whether a symmetric matrix with a diagonal of ones has no eigenvalue that rounding could have made of 0: a tenth of the time, at
/// most, that its kernel takes.
fn regular(mut w: Mat<f64>) -> bool {
    (0..w.ncols()).for_each(|j| w[(j, j)] -= REGULAR);
    cholesky(w.as_mut()).is_ok()
}

/// y >= 0 in the kernel of a matrix, Σ y = 1, with the least y·gaps; `None` if there is no such y.
fn least_gap(a: &Mat<f64>, gaps: &[f64]) -> Result<Option<Vec<f64>>, MethodError> {
    let Some(basis) = kernel(a) else {
        return Ok(None);
    };
    let (n, size) = (gaps.len(), basis.ncols());
    let unit = norm(gaps);
    let mut cost = vec![0.0; size];
    mul_transpose_add(&basis, gaps, &mut cost);
    cost.iter_mut().for_each(|cost| *cost /= unit);
    // Σ y = 1 above y >= 0.
    let (mut starts, mut values) = (vec![0], Vec::new());
    for j in 0..size {
        let column = basis.col_as_slice(j);
        values.push(column.iter().sum());
        values.extend(column.iter().map(|y| -y));
        starts.push(values.len());
    }
    let entries = (0..size).flat_map(|_| 0..=n).collect();
    let constraints = CscMatrix::new(n + 1, size, starts, entries, values);
    let mut right = vec![0.0; n + 1];
    right[0] = 1.0;
    let cones = [
        SupportedConeT::ZeroConeT(1),
        SupportedConeT::NonnegativeConeT(n),
    ];
    let none = CscMatrix::zeros((size, size));
    let mut solver = DefaultSolver::new(
        &none,
        &cost,
        &constraints,
        &right,
        &cones,
        settings(TIGHTEST)?,
    )
    .map_err(refused)?;
    solver.solve();
    let solved =
        [SolverStatus::Solved, SolverStatus::AlmostSolved].contains(&solver.solution.status);
    let mut y = vec![0.0; n];
    mul_add(&basis, &solver.solution.x, &mut y);
    Ok((solved && dot(&y, gaps) < 0.0).then_some(y))
}

/// An orthonormal basis of the kernel of a matrix, to the rounding of its entries, by column; `None` if it has none.
fn kernel(a: &Mat<f64>) -> Option<Mat<f64>> {
    let svd = a.thin_svd().ok()?;
    let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let least = a.nrows() as f64 * f64::EPSILON * values.first()?;
    let at: Vec<usize> = (0..values.len()).filter(|&j| values[j] <= least).collect();
    let v = svd.V();
    (!at.is_empty()).then(|| Mat::from_fn(v.nrows(), at.len(), |i, j| v[(i, at[j])]))
}
