//! The condensed increment from outside a method: what any pair of contact forces and jumps is worth, and how far rounding
//! lets it come.

use std::sync::Arc;

use crate::algebra::dense::{norm, ratio};
use crate::algebra::rows::RowSet;
use crate::contract::free_jump::FreeJump;
use crate::contract::judge::{Residuals, Violations};
use crate::contract::operator::{ContactOperator, DelassusForm};
use crate::contract::system::Increment;
use crate::error::MethodError;

/// An increment on the rows in use, `v = q + W P + Q β`, `Qᵀ P = c`, for whoever watches a method.
pub struct Gauge<'a> {
    increment: &'a Increment<'a>,
    operator: Arc<ContactOperator>,
    free: FreeJump,
}

impl<'a> Gauge<'a> {
    /// Condenses the increment.
    ///
    /// # Errors
    /// Those of factorisation and condensation.
    pub fn new(increment: &'a Increment<'a>) -> Result<Self, MethodError> {
        increment.check()?;
        let elastic = increment.system.elastic();
        let u = elastic.on_body(|| elastic.free(&increment.load.force))??;
        let operator = increment.system.operator(DelassusForm::Formed)?;
        Ok(Self {
            free: FreeJump::new(increment, &operator, &increment.jump(&u))?,
            operator,
            increment,
        })
    }

    /// Rows (g, d) for P = 0, β = 0, in m.
    pub fn q(&self) -> &[f64] {
        &self.free.q
    }

    /// c in Qᵀ P = c.
    pub fn balance(&self) -> &[f64] {
        &self.free.balance
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
        (0..self.free.q.len()).map(column).collect()
    }

    /// How well P and v = (g, d) fulfil the contact laws, as the judge measures it. Equilibrium, sway and rounding stay 0.
    pub fn residuals(&self, p: &[f64], v: &[f64]) -> Residuals {
        let scale = self.free.scale;
        Violations::of(self.friction(), self.rows(), &self.operator, scale, p, v)
            .residuals(&self.operator, scale)
    }

    /// Rounding of v = q + W P in the violation at P: ε |(|q| + |W| |P|)| over u_ref, Euclidean norms.
    pub fn floor(&self, p: &[f64]) -> f64 {
        let mut size: Vec<f64> = self.free.q.iter().map(|q| q.abs()).collect();
        self.operator.w.apply_abs_add(p, &mut size);
        let u_ref = self.operator.reference(self.free.scale).1;
        ratio(f64::EPSILON * norm(&size), u_ref)
    }
}
