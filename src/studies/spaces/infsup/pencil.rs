//! The symmetric eigenproblem S x = λ C x with a positive definite C, dense.
//!
//! ```text
//!   D C D = L Lᵀ,  D = diag(C)^(−½)         scaling first: multipliers of slivers are small
//!   S̃ = L⁻¹ D S D L⁻ᵀ                        has the same eigenvalues
//! ```

use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};

/// Why the eigenproblem has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PencilError {
    /// A diagonal entry of C is not positive.
    #[error("a function of the multiplier space vanishes")]
    Vanishing,
    /// C is not positive definite.
    #[error("the functions of the multiplier space are linearly dependent")]
    Dependent,
    /// The iteration ends without eigenvalues.
    #[error("the eigenvalues were not found")]
    Lost,
}

/// All eigenvalues, ascending; `s` and `c` are symmetric m × m, row by row.
///
/// # Errors
/// [`PencilError`].
pub fn eigenvalues(s: &[f64], c: &[f64], m: usize) -> Result<Vec<f64>, PencilError> {
    let scale: Vec<f64> = (0..m).map(|i| 1.0 / c[i * m + i].sqrt()).collect();
    if !scale.iter().all(|d| d.is_finite()) {
        return Err(PencilError::Vanishing);
    }
    let scaled = |a: &[f64]| Mat::from_fn(m, m, |i, j| scale[i] * a[i * m + j] * scale[j]);
    let llt = Llt::new(scaled(c).as_ref(), Side::Lower).map_err(|_| PencilError::Dependent)?;
    let l = llt.L();
    let mut x = scaled(s);
    solve_lower_triangular_in_place(l, x.as_mut(), Par::Seq);
    let mut x = x.transpose().to_owned();
    solve_lower_triangular_in_place(l, x.as_mut(), Par::Seq);
    let mut values = x
        .self_adjoint_eigenvalues(Side::Lower)
        .map_err(|_| PencilError::Lost)?;
    values.sort_by(f64::total_cmp);
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a multiplier space with a function too many is refused, not judged.
    #[test]
    fn dependent_multipliers_are_refused() {
        let ones = [1.0; 4];
        assert_eq!(eigenvalues(&ones, &ones, 2), Err(PencilError::Dependent));
        let unit = [1.0, 0.0, 0.0, 1.0];
        let gap = [1.0, 0.0, 0.0, 0.0];
        assert_eq!(eigenvalues(&unit, &gap, 2), Err(PencilError::Vanishing));
    }
}
