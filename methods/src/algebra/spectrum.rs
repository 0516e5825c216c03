//! Extreme eigenvalues of a positive semi-definite operator, of its symmetric part if it has another, estimated by the
//! Lanczos process.

use faer::{Mat, Side};

use crate::algebra::delassus::Delassus;
use crate::algebra::dense::{dot, norm};
use crate::algebra::floating::ModeJumps;

/// Lanczos steps: the largest eigenvalue is then exact to a few digits, the smallest within a small factor.
const STEPS: usize = 60;
/// Eigenvalues below this fraction of the largest belong to redundant contact points, not to the body.
const SIGNIFICANT: f64 = 1e-4;

/// (smallest significant, largest) eigenvalue of (W + Wᵀ)/2 on the complement of the rigid motions; `None` if W vanishes there.
pub(crate) fn extremes(w: &dyn Delassus, modes: &ModeJumps) -> Option<(f64, f64)> {
    let m = w.rows();
    let steps = STEPS.min(m - modes.len().min(m));
    // Any start without symmetry will do; it must be the same every time.
    let mut v: Vec<f64> = (0..m)
        .map(|i| 0.5 + (0.618_033_988_749_895 * (i + 1) as f64).fract())
        .collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let (mut diagonal, mut off) = (Vec::new(), Vec::new());
    let mut scale = 0.0_f64;
    for _ in 0..steps {
        for _ in 0..2 {
            modes.project_out(&mut v);
            for b in &basis {
                let c = dot(b, &v);
                v.iter_mut().zip(b).for_each(|(v, b)| *v -= c * b);
            }
        }
        let length = norm(&v);
        if basis.is_empty() {
            if length == 0.0 {
                return None;
            }
        } else if length <= 1e-10 * scale {
            break;
        } else {
            off.push(length);
        }
        v.iter_mut().for_each(|v| *v /= length);
        let mut next = vec![0.0; m];
        w.apply_add(&v, &mut next);
        if !w.symmetric() {
            w.apply_transpose_add(&v, &mut next);
            next.iter_mut().for_each(|x| *x *= 0.5);
        }
        modes.project_out(&mut next);
        diagonal.push(dot(&v, &next));
        scale = scale.max(norm(&next));
        basis.push(std::mem::replace(&mut v, next));
    }
    let k = diagonal.len();
    let t = Mat::from_fn(k, k, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off[i.min(j)],
        _ => 0.0,
    });
    let values = t.self_adjoint_eigenvalues(Side::Lower).ok()?;
    let largest = values.iter().copied().fold(0.0, f64::max);
    let smallest = values
        .iter()
        .copied()
        .filter(|&x| x >= SIGNIFICANT * largest)
        .fold(largest, f64::min);
    (largest > 0.0).then_some((smallest, largest))
}

/// Singular values above this fraction of the largest count for the rank.
const NEGLIGIBLE: f64 = 1e-10;

/// Numerical rank of W; `None` if its singular values are not to be had.
pub(crate) fn rank(w: &dyn Delassus) -> Option<usize> {
    let full = w.to_matrix();
    let values = if w.symmetric() {
        full.self_adjoint_eigenvalues(Side::Lower).ok()?
    } else {
        full.singular_values().ok()?
    };
    let largest = values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let counts = |x: &&f64| x.abs() > NEGLIGIBLE * largest;
    Some(values.iter().filter(counts).count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::delassus::Dense;

    #[test]
    fn extremes_of_a_diagonal_matrix_are_found_and_zero_eigenvalues_passed_over() {
        let none = ModeJumps::empty();
        let w = Mat::from_fn(40, 40, |i, j| {
            if i == j {
                [0.0, 1.0 + i as f64][usize::from(i > 1)]
            } else {
                0.0
            }
        });
        let (least, most) = extremes(&Dense::new(&w, true), &none).unwrap();
        assert!(
            (least - 3.0).abs() < 1e-9 && (most - 40.0).abs() < 1e-9,
            "{least} {most}"
        );
        assert_eq!(extremes(&Dense::new(&Mat::zeros(3, 3), true), &none), None);
    }

    /// A nilpotent matrix has eigenvalues 0 alone, and the rank of its entry.
    #[test]
    fn the_rank_counts_singular_values() {
        let entry = Mat::from_fn(3, 3, |i, j| f64::from(u8::from(i == 0 && j == 2)));
        assert_eq!(rank(&Dense::new(&entry, false)), Some(1));
        let ones = Mat::from_fn(4, 4, |i, j| f64::from(u8::from(i % 2 == j % 2)) * 1e-7);
        assert_eq!(rank(&Dense::new(&ones, true)), Some(2));
        assert_eq!(rank(&Dense::new(&Mat::zeros(2, 2), true)), Some(0));
    }
}
