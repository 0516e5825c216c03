//! Vectors and dense systems: LU with partial pivoting and a singularity test.

use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::reborrow::ReborrowMut;
use faer::{Mat, MatMut, Par};

use crate::algebra::plain::{self, Full, wide};
use crate::algebra::strips::{lu, permute_rows};

/// Ratio of pivots below which a matrix counts as singular, times its size.
pub(crate) const SINGULAR: f64 = 1e-15;
/// Up to this size plain loops factor faster than blocks, whose set-up costs more than it gains.
const PLAIN: usize = 48;

/// LU factors of a regular matrix. The memory of one serves the next.
#[derive(Default)]
pub(crate) struct DenseLu {
    factors: Full,
    /// Rows of the matrix in the order of the pivots.
    rows: Vec<usize>,
    /// Room for a column.
    column: Vec<f64>,
}

impl DenseLu {
    /// `None` if A is singular to working precision.
    pub fn new(a: &Mat<f64>) -> Option<Self> {
        let mut lu = Self {
            factors: a.into(),
            ..Self::default()
        };
        lu.factor().then_some(lu)
    }

    /// With room for matrices of this size.
    pub fn with_room(n: usize) -> Self {
        let mut lu = Self::default();
        // A first factorisation asks for all of it.
        lu.zeros(n);
        lu.factor();
        lu
    }

    /// n × n zeros in place of the factors: to be filled, then [factored](Self::factor).
    pub fn zeros(&mut self, n: usize) -> &mut Full {
        self.factors.clear(n, n);
        &mut self.factors
    }

    /// The matrix that is to be factored.
    pub fn matrix(&mut self) -> &mut Full {
        &mut self.factors
    }

    /// Factors the matrix that stands in place of the factors; false if it is singular to working precision.
    pub fn factor(&mut self) -> bool {
        let (a, rows) = (&mut self.factors, &mut self.rows);
        let n = a.rows();
        match n {
            0..=PLAIN => plain::lu(a, rows, &mut self.column),
            _ => *rows = lu(a.view_mut()),
        }
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for i in 0..n {
            let pivot = a[(i, i)].abs();
            if pivot.is_nan() {
                return false;
            }
            (least, most) = (least.min(pivot), most.max(pivot));
        }
        n == 0 || least > SINGULAR * n as f64 * most
    }

    /// The least pivot, absolutely; infinite without any.
    pub fn least_pivot(&self) -> f64 {
        let pivots = (0..self.factors.rows()).map(|i| self.factors[(i, i)].abs());
        pivots.fold(f64::INFINITY, f64::min)
    }

    /// x with A x = b; `None` if it is not finite.
    pub fn solve(&self, b: &[f64]) -> Option<Vec<f64>> {
        let mut x = Vec::new();
        self.solve_into(b, &mut x).then_some(x)
    }

    /// X := A⁻¹ X, by blocks.
    pub fn solve_in_place(&self, mut x: MatMut<'_, f64>) {
        permute_rows(x.rb_mut(), &self.rows);
        solve_unit_lower_triangular_in_place(self.factors.view(), x.rb_mut(), Par::Seq);
        solve_upper_triangular_in_place(self.factors.view(), x, Par::Seq);
    }

    /// x := A⁻¹ b in place of what `x` holds; false if it is not finite. For one vector blocks gain nothing at any size.
    pub fn solve_into(&self, b: &[f64], x: &mut Vec<f64>) -> bool {
        refill(x, self.rows.iter().map(|&i| b[i]));
        plain::solve(&self.factors, x);
        x.iter().all(|v| v.is_finite())
    }
}

/// Solves A x = b; `None` if A is singular to working precision or the solution is not finite.
pub(crate) fn solve_dense(a: Mat<f64>, b: &[f64]) -> Option<Vec<f64>> {
    if b.is_empty() {
        return Some(Vec::new());
    }
    DenseLu::new(&a)?.solve(b)
}

/// x + t s.
pub(crate) fn along(x: &[f64], t: f64, s: &[f64]) -> Vec<f64> {
    x.iter().zip(s).map(|(x, s)| x + t * s).collect()
}

/// x := x + t s.
pub(crate) fn add(t: f64, s: &[f64], x: &mut [f64]) {
    x.iter_mut().zip(s).for_each(|(x, s)| *x += t * s);
}

/// x := these values, in the memory of x.
pub(crate) fn refill<T>(x: &mut Vec<T>, values: impl IntoIterator<Item = T>) {
    x.clear();
    x.extend(values);
}

/// x := n zeros, in the memory of x.
pub(crate) fn zero(x: &mut Vec<f64>, n: usize) {
    x.clear();
    x.resize(n, 0.0);
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
    add_columns(|j| a.col_as_slice(j), x, y);
}

/// y += A x for an A that is given by columns.
#[inline(always)]
pub(crate) fn add_columns<'a>(column: impl Fn(usize) -> &'a [f64], x: &[f64], y: &mut [f64]) {
    // Column sweep: columns are contiguous and zero forces of open points cost nothing.
    wide(
        #[inline(always)]
        || {
            for (j, &xj) in x.iter().enumerate() {
                if xj != 0.0 {
                    for (y, a) in y.iter_mut().zip(column(j)) {
                        *y += a * xj;
                    }
                }
            }
        },
    );
}

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Euclidean norm, also where squares leave the range of numbers.
pub(crate) fn norm(x: &[f64]) -> f64 {
    let square = x.iter().map(|v| v * v).sum::<f64>();
    if square.is_normal() {
        return square.sqrt();
    }
    let most = x.iter().fold(0.0, |m: f64, v| larger(m, v.abs()));
    if most == 0.0 || !most.is_finite() {
        return most;
    }
    most * x.iter().map(|v| (v / most).powi(2)).sum::<f64>().sqrt()
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
            assert!(DenseLu::new(&singular).is_none(), "{n}");
            let broken = Mat::from_fn(n, n, |i, j| if i == j { f64::NAN } else { 1.0 });
            assert!(DenseLu::new(&broken).is_none(), "{n}");
        }
    }
}
