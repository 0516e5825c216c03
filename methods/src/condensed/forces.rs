//! Iterates of methods on the condensed increment: contact forces with what goes with them.

use crate::algebra::dense::add;
use crate::contract::state::Status;
use crate::error::MethodError;

/// Contact forces on the rows in use and amplitudes of the rigid motions, or a step of both.
#[derive(Debug, Clone, Default)]
pub struct Forces {
    /// P by row, in N (2D: N/m).
    pub p: Vec<f64>,
    /// β by rigid motion, in m; empty unless the body floats.
    pub beta: Vec<f64>,
}

impl Forces {
    /// Both.
    pub(crate) fn of(p: &[f64], beta: &[f64]) -> Self {
        Self {
            p: p.to_vec(),
            beta: beta.to_vec(),
        }
    }

    /// self := x, in the memory of self.
    pub(crate) fn copy(&mut self, x: &Forces) {
        self.p.clone_from(&x.p);
        self.beta.clone_from(&x.beta);
    }

    /// self := self + t step.
    pub fn move_along(&mut self, t: f64, step: &Forces) {
        add(t, &step.p, &mut self.p);
        add(t, &step.beta, &mut self.beta);
    }
}

/// How an iteration ended, unless it could not begin.
pub type Ended = Result<End, MethodError>;

/// How an iteration ended, and where.
#[derive(Debug, Clone)]
pub struct End {
    /// How.
    pub status: Status,
    /// The last iterate.
    pub at: Forces,
}

impl End {
    /// Whether nothing is to be tried after it; iterations that have run out the next method sees itself.
    pub(crate) fn is_final(&self) -> bool {
        [Status::Converged, Status::Rounding, Status::Stopped].contains(&self.status)
    }
}
