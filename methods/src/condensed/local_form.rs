//! An increment as interchange formats hold it: condensed to the contact points, all `dim` rows of every point.

use crate::algebra::dense::dot;
use crate::algebra::floating::ModeJumps;
use crate::algebra::matrix::SymmetricMatrix;
use crate::algebra::rows::RowSet;
use crate::contract::judge::slip_from;
use crate::contract::system::Increment;
use crate::error::MethodError;

/// `v = (g, d) = q + W P + V α`, `Vᵀ P = c`, and the contact laws between v and P.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalForm {
    /// Delassus operator W, `dim` rows per point, in m/N (2D: m²/N).
    pub w: SymmetricMatrix,
    /// Gaps and slips without contact forces, `dim` per point, in m; the tangential jump at the start of the increment
    /// is taken off.
    pub q: Vec<f64>,
    /// Orthonormal jumps V of the rigid motions, one vector each; empty unless the body floats.
    pub modes: Vec<Vec<f64>>,
    /// What the contact forces must amount to on each rigid motion, in N (2D: N/m).
    pub balance: Vec<f64>,
}

impl Increment<'_> {
    /// Condenses the increment, points without friction included with all their rows.
    ///
    /// # Errors
    /// Those of the first factorisation and condensation; a body set up without friction, which has only normal rows.
    pub fn local_form(&self) -> Result<LocalForm, MethodError> {
        self.check()?;
        let (elastic, dim) = (self.system.elastic(), self.system.dim());
        if elastic.frictionless() {
            return Err(MethodError::NoTangentialRows);
        }
        let mut u = self.load.force.clone();
        elastic.solve(&mut u)?;
        let rows = RowSet::all(dim, elastic.points());
        let modes = ModeJumps::new(elastic.jump(), &rows.source, elastic.floating());
        let resultant: Vec<f64> = (elastic.floating().iter())
            .map(|r| -dot(r, &self.load.force))
            .collect();
        Ok(LocalForm {
            w: elastic.formed()?.lower()?,
            q: slip_from(&rows, dim, &self.jump(&u), &self.start_jump()),
            balance: modes.balance(&resultant),
            modes: modes.q,
        })
    }
}
