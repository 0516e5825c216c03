//! Inverse iteration: the smallest eigenvalue of a factored matrix.

/// One less would do where the smallest eigenvalue stands alone.
const ROUNDS: usize = 4;

/// The smallest eigenvalue of a symmetric positive definite matrix and its vector of unit length; `solve`: x := A⁻¹ x.
pub(crate) fn smallest_eigenvalue(count: usize, solve: impl Fn(&mut [f64])) -> (f64, Vec<f64>) {
    let length = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    // No pattern of the mesh is orthogonal to it.
    let mut x: Vec<f64> = (0..count).map(|i| (1.0 + i as f64).sin()).collect();
    let mut eigenvalue = f64::INFINITY;
    for _ in 0..ROUNDS {
        let before = length(&x);
        solve(&mut x);
        let after = length(&x);
        eigenvalue = before / after;
        x.iter_mut().for_each(|v| *v /= after);
    }
    (eigenvalue, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: a diagonal matrix, whose smallest entry is its smallest eigenvalue. Tolerance: (1e-3)⁴ of the next one.
    #[test]
    fn the_smallest_entry_of_a_diagonal_is_found() {
        let diagonal = [2.0, 1e-3, 5.0, 1.0];
        let solve = |x: &mut [f64]| x.iter_mut().zip(diagonal).for_each(|(x, d)| *x /= d);
        let (found, x) = smallest_eigenvalue(4, solve);
        assert!((found / 1e-3 - 1.0).abs() < 1e-10, "{found}");
        assert!((x[1].abs() - 1.0).abs() < 1e-10, "{x:?}");
    }
}
