//! Small dense systems: LU with partial pivoting and a singularity test.

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Mat, MatMut};

/// Ratio of pivots below which a matrix counts as singular, times its size.
const SINGULAR: f64 = 1e-15;

/// Solves A x = b; `None` if A is singular to working precision or the solution is not finite.
pub(crate) fn solve_dense(a: &Mat<f64>, b: &[f64]) -> Option<Vec<f64>> {
    let n = b.len();
    if n == 0 {
        return Some(Vec::new());
    }
    let lu = PartialPivLu::new(a.as_ref());
    let pivots = (0..n).map(|i| lu.U()[(i, i)].abs());
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for p in pivots {
        if p.is_nan() {
            return None;
        }
        (least, most) = (least.min(p), most.max(p));
    }
    if least <= SINGULAR * n as f64 * most {
        return None;
    }
    let mut x = b.to_vec();
    lu.solve_in_place(MatMut::from_column_major_slice_mut(&mut x, n, 1));
    x.iter().all(|v| v.is_finite()).then_some(x)
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
