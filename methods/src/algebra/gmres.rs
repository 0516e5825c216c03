//! Generalised minimal residuals: Saad & Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856.

use crate::algebra::dense::{add, dot, norm};

/// What is left of A v beside the vectors before, if it is rounding: A is singular.
const ROUNDING: f64 = 1e-14;

/// Coefficients y of the vectors that `apply` was called with, in their order, so that |b − Σ y_j A v_j| is least and at most
/// `tolerance` |b|; `None` where `most` of them do not suffice. `apply` gives A v.
pub(crate) fn gmres(
    b: &[f64],
    tolerance: f64,
    most: usize,
    mut apply: impl FnMut(&[f64]) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let size = norm(b);
    if size == 0.0 {
        return Some(Vec::new());
    }
    let mut basis = vec![b.iter().map(|b| b / size).collect::<Vec<f64>>()];
    // R by columns, the rotations that made it, and what they made of |b| e₁.
    let (mut r, mut rotations) = (Vec::<Vec<f64>>::new(), Vec::<[f64; 2]>::new());
    let mut g = vec![size];
    for j in 0..most {
        let mut w = apply(&basis[j])?;
        let least = ROUNDING * norm(&w);
        let mut h = vec![0.0; j + 1];
        // Twice for orthogonality.
        for _ in 0..2 {
            for (h, v) in h.iter_mut().zip(&basis) {
                let part = dot(&w, v);
                *h += part;
                add(-part, v, &mut w);
            }
        }
        let left = norm(&w);
        for (k, [c, s]) in rotations.iter().enumerate() {
            (h[k], h[k + 1]) = (c * h[k] + s * h[k + 1], c * h[k + 1] - s * h[k]);
        }
        let length = h[j].hypot(left);
        if !(length > least && length.is_finite()) {
            return None;
        }
        let [c, s] = [h[j] / length, left / length];
        h[j] = length;
        g.push(-s * g[j]);
        g[j] *= c;
        r.push(h);
        rotations.push([c, s]);
        if g[j + 1].abs() <= tolerance * size {
            return Some(back(&r, &g));
        }
        basis.push(w.iter().map(|w| w / left).collect());
    }
    None
}

/// y of R y = g, R upper triangular by columns.
fn back(r: &[Vec<f64>], g: &[f64]) -> Vec<f64> {
    let mut y = g[..r.len()].to_vec();
    for j in (0..r.len()).rev() {
        y[j] /= r[j][j];
        let own = y[j];
        (y[..j].iter_mut().zip(&r[j])).for_each(|(y, r)| *y -= own * r);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the matrix itself. Goal: n steps solve n equations, however unsymmetric; a singular matrix has no answer, and
    /// fewer steps than it takes none either.
    #[test]
    fn as_many_steps_as_equations_solve_them() {
        let a = [[2.0, -1.0, 0.5], [4.0, 1.0, 0.0], [-3.0, 0.0, 0.2]];
        let times = |a: &[[f64; 3]; 3], v: &[f64]| a.iter().map(|row| dot(row, v)).collect();
        let (b, mut tried) = ([1.0, -2.0, 3.0], Vec::new());
        let y = gmres(&b, 1e-14, 3, |v| {
            tried.push(v.to_vec());
            Some(times(&a, v))
        });
        let mut x = vec![0.0; 3];
        let y = y.unwrap();
        y.iter().zip(&tried).for_each(|(y, v)| add(*y, v, &mut x));
        let found: Vec<f64> = times(&a, &x);
        for (found, b) in found.iter().zip(b) {
            assert!((found - b).abs() < 1e-13, "{found} {b}");
        }
        assert_eq!(gmres(&b, 1e-14, 2, |v| Some(times(&a, v))), None);
        let singular = [a[0], a[1], a[0]];
        assert_eq!(gmres(&b, 1e-10, 9, |v| Some(times(&singular, v))), None);
        assert_eq!(gmres(&[0.0; 3], 1e-10, 9, |_| None), Some(Vec::new()));
    }
}
