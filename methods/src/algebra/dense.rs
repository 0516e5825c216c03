//! Vectors and small dense systems: LU with partial pivoting and a singularity test.

use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, MatMut, Par};

use crate::algebra::strips::lu;

/// Ratio of pivots below which a matrix counts as singular, times its size.
const SINGULAR: f64 = 1e-15;

/// LU factors of a regular matrix.
pub(crate) struct DenseLu {
    factors: Mat<f64>,
    /// Rows of the matrix in the order of the pivots.
    rows: Vec<usize>,
}

impl DenseLu {
    /// `None` if A is singular to working precision.
    pub fn new(mut a: Mat<f64>) -> Option<Self> {
        let rows = lu(&mut a);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for i in 0..a.nrows() {
            let pivot = a[(i, i)].abs();
            if pivot.is_nan() {
                return None;
            }
            (least, most) = (least.min(pivot), most.max(pivot));
        }
        let regular = a.nrows() == 0 || least > SINGULAR * a.nrows() as f64 * most;
        regular.then_some(Self { factors: a, rows })
    }

    /// x with A x = b; `None` if it is not finite.
    pub fn solve(&self, b: &[f64]) -> Option<Vec<f64>> {
        let mut x: Vec<f64> = self.rows.iter().map(|&i| b[i]).collect();
        let (n, factors) = (b.len(), self.factors.as_ref());
        let mut column = MatMut::from_column_major_slice_mut(&mut x, n, 1);
        solve_unit_lower_triangular_in_place(factors, column.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(factors, column, Par::Seq);
        x.iter().all(|v| v.is_finite()).then_some(x)
    }
}

/// Solves A x = b; `None` if A is singular to working precision or the solution is not finite.
pub(crate) fn solve_dense(a: Mat<f64>, b: &[f64]) -> Option<Vec<f64>> {
    if b.is_empty() {
        return Some(Vec::new());
    }
    DenseLu::new(a)?.solve(b)
}

/// x + t s.
pub(crate) fn along(x: &[f64], t: f64, s: &[f64]) -> Vec<f64> {
    x.iter().zip(s).map(|(x, s)| x + t * s).collect()
}

/// x − y.
pub(crate) fn minus(x: &[f64], y: &[f64]) -> Vec<f64> {
    x.iter().zip(y).map(|(x, y)| x - y).collect()
}

/// y += Aᵀ x for a full matrix.
pub(crate) fn mul_transpose_add(a: &Mat<f64>, x: &[f64], y: &mut [f64]) {
    for (j, y) in y.iter_mut().enumerate() {
        *y += dot(a.col_as_slice(j), x);
    }
}

/// y += A x for a full matrix.
pub(crate) fn mul_add(a: &Mat<f64>, x: &[f64], y: &mut [f64]) {
    // Column sweep: columns are contiguous and zero forces of open points cost nothing.
    for (j, &xj) in x.iter().enumerate() {
        if xj != 0.0 {
            for (y, a) in y.iter_mut().zip(a.col_as_slice(j)) {
                *y += a * xj;
            }
        }
    }
}

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Euclidean norm.
pub(crate) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The larger of two numbers; NaN if one is, which `max` would drop.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// x / reference with 0/0 = 0.
pub(crate) fn ratio(x: f64, reference: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x / reference }
}
