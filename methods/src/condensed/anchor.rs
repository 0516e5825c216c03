//! Where the jump is known from the body itself; see `recovery.rs`.

use crate::algebra::dense::minus;
use crate::condensed::forces::Forces;
use crate::contract::state::ContactState;

/// An iterate whose displacements were recovered.
pub(crate) struct Anchor {
    pub at: Forces,
    /// Rows (g, d).
    pub v: Vec<f64>,
    pub state: ContactState,
}

impl Anchor {
    /// The way from here to an iterate.
    pub fn step_to(&self, p: &[f64], beta: &[f64]) -> Forces {
        Forces {
            p: minus(p, &self.at.p),
            beta: minus(beta, &self.at.beta),
        }
    }
}
