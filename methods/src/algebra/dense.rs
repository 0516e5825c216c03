//! Vectors and dense systems: LU with partial pivoting and a singularity test.

use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, MatMut, Par};

use crate::algebra::strips::lu;

/// Ratio of pivots below which a matrix counts as singular, times its size.
const SINGULAR: f64 = 1e-15;
/// Up to this size plain loops are faster than blocks, whose set-up costs more than it gains: a Newton step on 22 rows
/// takes 4.3 µs with them, 5.2 with blocks.
const PLAIN: usize = 48;

/// LU factors of a regular matrix.
pub(crate) struct DenseLu {
    factors: Mat<f64>,
    /// Rows of the matrix in the order of the pivots.
    rows: Vec<usize>,
}

impl DenseLu {
    /// `None` if A is singular to working precision.
    pub fn new(mut a: Mat<f64>) -> Option<Self> {
        let rows = match a.nrows() {
            0..=PLAIN => plain_lu(&mut a),
            _ => lu(&mut a),
        };
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
        if n <= PLAIN {
            plain_solve(&self.factors, &mut x);
            return x.iter().all(|v| v.is_finite()).then_some(x);
        }
        let mut column = MatMut::from_column_major_slice_mut(&mut x, n, 1);
        solve_unit_lower_triangular_in_place(factors, column.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(factors, column, Par::Seq);
        x.iter().all(|v| v.is_finite()).then_some(x)
    }
}

/// As [`lu`], of a matrix of at most [`PLAIN`] rows: one column after the other, all later ones updated at once.
fn plain_lu(a: &mut Mat<f64>) -> Vec<usize> {
    let n = a.nrows();
    let mut rows: Vec<usize> = (0..n).collect();
    let mut own = [0.0; PLAIN];
    for k in 0..n {
        let column = &mut a.col_as_slice_mut(k)[k..n];
        let mut pivot = 0;
        for (i, x) in column.iter().enumerate() {
            if x.abs() > column[pivot].abs() {
                pivot = i;
            }
        }
        column.swap(0, pivot);
        let (first, below) = (column[0], &mut column[1..]);
        let own = &mut own[..below.len()];
        if first != 0.0 {
            below.iter_mut().for_each(|x| *x /= first);
        }
        own.copy_from_slice(below);
        rows.swap(k, k + pivot);
        for j in 0..n {
            if j == k {
                continue;
            }
            let column = &mut a.col_as_slice_mut(j)[k..n];
            column.swap(0, pivot);
            if j > k {
                let (first, below) = (column[0], &mut column[1..]);
                below
                    .iter_mut()
                    .zip(&*own)
                    .for_each(|(x, l)| *x -= l * first);
            }
        }
    }
    rows
}

/// x := U⁻¹ L⁻¹ x.
fn plain_solve(factors: &Mat<f64>, x: &mut [f64]) {
    for k in 0..x.len() {
        let (first, below) = x[k..].split_first_mut().expect("k < n");
        let l = &factors.col_as_slice(k)[k + 1..];
        below.iter_mut().zip(l).for_each(|(x, l)| *x -= l * *first);
    }
    for k in (0..x.len()).rev() {
        let u = factors.col_as_slice(k);
        x[k] /= u[k];
        let (above, last) = x[..=k].split_at_mut(k);
        above.iter_mut().zip(u).for_each(|(x, u)| *x -= u * last[0]);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: x itself. Tolerance: rounding, times the condition of these matrices. Sizes on both sides of the change of
    /// algorithm.
    #[test]
    fn systems_are_solved_and_singular_ones_found_by_either_algorithm() {
        for n in [1, 2, 5, 22, PLAIN, PLAIN + 1, 70] {
            let entry = |i: usize, j: usize| ((3 * i * i + 7 * j + i * j) as f64).sin();
            // Rows in disorder, so that there is something to exchange.
            let a = Mat::from_fn(n, n, |i, j| {
                entry(i, j) + if (i + 3) % n == j { n as f64 } else { 0.0 }
            });
            let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut b = vec![0.0; n];
            mul_add(&a, &x, &mut b);
            let found = solve_dense(a.clone(), &b).unwrap();
            assert!(norm(&minus(&found, &x)) < 1e-13 * norm(&x), "{n}");

            let mut singular = a;
            for i in 0..n {
                singular[(i, n - 1)] = if n == 1 { 0.0 } else { 2.0 * singular[(i, 0)] };
            }
            assert!(DenseLu::new(singular).is_none(), "{n}");
            let broken = Mat::from_fn(n, n, |i, j| if i == j { f64::NAN } else { 1.0 });
            assert!(DenseLu::new(broken).is_none(), "{n}");
        }
    }
}
