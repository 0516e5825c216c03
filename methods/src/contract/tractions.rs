//! The traction operator condensed to the contact points: T = S K⁻¹ Sᵀ and X = B K⁻¹ Sᵀ.

use faer::Mat;

use crate::MethodError;
use crate::algebra::matrix::JumpOperator;
use crate::algebra::stiffness::Stiffness;

/// Columns of Sᵀ solved for together.
const PANEL: usize = 128;

/// T and X on the rows of a body.
pub(crate) struct Tractions {
    /// S K⁻¹ Sᵀ, symmetric positive semi-definite, in N/m.
    pub t: Mat<f64>,
    /// B K⁻¹ Sᵀ, dimensionless.
    pub x: Mat<f64>,
}

impl Tractions {
    /// Back-solves for the listed rows of S; unlike rows of B they reach beyond the trailing block of the factor.
    pub fn new(
        stiffness: &dyn Stiffness,
        s: &JumpOperator,
        b: &JumpOperator,
        rows: &[usize],
    ) -> Result<Self, MethodError> {
        let m = rows.len();
        let (mut t, mut x) = (Mat::<f64>::zeros(m, m), Mat::<f64>::zeros(m, m));
        for begin in (0..m).step_by(PANEL) {
            let panel = &rows[begin..(begin + PANEL).min(m)];
            let mut u = Mat::<f64>::zeros(stiffness.unknowns(), panel.len());
            for (column, &i) in panel.iter().enumerate() {
                s.row(i).for_each(|(j, v)| u[(j, column)] += v);
            }
            stiffness.solve_columns(&mut u)?;
            for column in 0..panel.len() {
                let u = u.col_as_slice(column);
                for (k, &i) in rows.iter().enumerate() {
                    t[(k, begin + column)] = s.row(i).map(|(j, v)| v * u[j]).sum();
                    x[(k, begin + column)] = b.row(i).map(|(j, v)| v * u[j]).sum();
                }
            }
        }
        // Each pair is read from one triangle, so the result is symmetric to the bit.
        let t = Mat::from_fn(m, m, |i, j| t[(i.max(j), i.min(j))]);
        Ok(Self { t, x })
    }
}
