//! The condensed increment from outside a method: what any pair of contact forces and jumps is worth, and how far rounding
//! lets it come.

use std::sync::Arc;

use crate::algebra::dense::ratio;
use crate::algebra::rows::RowSet;
use crate::contract::judge::{Residuals, Violations, free_jump, reference_force, slip_from};
use crate::contract::operator::{ContactOperator, DelassusForm};
use crate::contract::system::Increment;
use crate::error::MethodError;

/// An increment on the rows in use, `v = q + W P + Q β`, `Qᵀ P = c`, for whoever watches a method.
pub struct Gauge<'a> {
    increment: &'a Increment<'a>,
    operator: Arc<ContactOperator>,
    /// Rows (g, d) for P = 0, β = 0, in m.
    pub q: Vec<f64>,
    /// c in Qᵀ P = c.
    pub balance: Vec<f64>,
    /// |q| in P_ref.
    free_jump: f64,
}

impl<'a> Gauge<'a> {
    /// Condenses the increment.
    ///
    /// # Errors
    /// Those of factorisation and condensation.
    pub fn new(increment: &'a Increment<'a>) -> Result<Self, MethodError> {
        increment.check()?;
        let (system, force) = (increment.system, &increment.load.force);
        let (elastic, rows) = (system.elastic(), system.row_set());
        let mut u = force.clone();
        elastic.on_body(|| elastic.solve(&mut u))??;
        let jump = increment.jump(&u);
        let operator = system.operator(DelassusForm::Formed)?;
        let balance = operator.modes.balance(&increment.resultant());
        Ok(Self {
            free_jump: free_jump(increment, &operator, &rows.restrict(&jump), &balance),
            q: slip_from(rows, system.dim(), &jump, &increment.start_jump()),
            balance,
            operator,
            increment,
        })
    }

    /// Rows in use.
    pub fn rows(&self) -> &'a RowSet {
        self.increment.system.row_set()
    }

    /// Friction coefficient by point.
    pub fn friction(&self) -> &'a [f64] {
        self.increment.system.friction()
    }

    /// ρ in N/m.
    pub fn rho(&self) -> f64 {
        self.operator.rho
    }

    /// Q, the orthonormal jumps of the rigid motions; empty unless the body floats.
    pub fn rigid(&self) -> &[Vec<f64>] {
        &self.operator.modes.q
    }

    /// Columns of W.
    pub fn columns(&self) -> Vec<Vec<f64>> {
        let mut work = Vec::new();
        let column = |k| self.operator.w.column(k, &mut work).to_vec();
        (0..self.q.len()).map(column).collect()
    }

    /// How well P and v = (g, d) fulfil the contact laws, as the judge measures it. Equilibrium, and what takes a slip of its
    /// own to know, stay 0.
    pub fn residuals(&self, p: &[f64], v: &[f64]) -> Residuals {
        let (rho, p_ref) = (
            self.operator.sharp,
            reference_force(self.operator.rho, p, self.free_jump),
        );
        Violations::of(self.friction(), self.rows(), rho, p_ref, p, v).residuals(rho, p_ref)
    }

    /// What rounding of v = q + W P leaves of the violation at P: ε |(|q| + |W| |P|)| over u_ref, Euclidean norms.
    pub fn floor(&self, p: &[f64]) -> f64 {
        let mut size: Vec<f64> = self.q.iter().map(|q| q.abs()).collect();
        let mut work = Vec::new();
        for (k, force) in p.iter().enumerate() {
            let column = self.operator.w.column(k, &mut work);
            let parts = size.iter_mut().zip(column);
            parts.for_each(|(size, w)| *size += (w * force).abs());
        }
        let p_ref = reference_force(self.operator.rho, p, self.free_jump);
        let norm = size.iter().map(|s| s * s).sum::<f64>().sqrt();
        ratio(f64::EPSILON * norm, p_ref / self.operator.sharp)
    }
}
