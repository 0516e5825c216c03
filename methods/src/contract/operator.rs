//! The body seen from the contact points: `[[u]] = q + W P + Q β`.
//!
//! W is the Delassus operator on the rows in use; Q spans the jumps of rigid motions (no columns if K is definite).

use std::sync::Arc;

use crate::algebra::delassus::Delassus;
use crate::algebra::dense::dot;
use crate::algebra::floating::ModeJumps;
use crate::error::MethodError;

/// Below this fraction of the local compliance the trace of W is rounding, and what moves beside rigid motions of what their load
/// would.
pub(crate) const NO_TRACE: f64 = 1e-10;

/// Above this multiple of the compliance on the stiffest unknowns the trace of W is that of a few swaying motions; of a
/// plate, a beam, an inner crack it is 3 to 20.
pub const SWAYING: f64 = 100.0;

/// How a method works with the Delassus operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DelassusForm {
    /// As a matrix: formed once per body, its columns cost nothing.
    #[default]
    Formed,
    /// By products alone, each a solve with K: never formed.
    Products,
}

/// W, Q and the scale of the natural map for one set of rows.
pub struct ContactOperator {
    /// Delassus operator.
    pub w: Arc<dyn Delassus>,
    /// Jumps of rigid motions.
    pub(crate) modes: ModeJumps,
    /// ρ = rows / trace(W⊥) in N/m, W⊥ = (I − Q Qᵀ) W (I − Q Qᵀ), which no choice of pins changes.
    pub rho: f64,
    /// ρ̂ ≥ ρ \[N/m\] of the natural map and of overlap: ρ, but at least rows / (100 Σ_i |B_i|² / max_j K_jj). Where
    /// slender parts sway, overlap that is nothing beside their motion can be all there is of the answer elsewhere.
    pub sharp: f64,
    /// trace(W⊥) / (Σ_i |B_i|² / max_j K_jj): how far contact forces move the body beside what they press into its
    /// stiffest unknowns. Displacements carry the rounding of K times this.
    pub sway: f64,
    /// Whether every contact row moves rigidly.
    pub(crate) stiff: bool,
}

impl ContactOperator {
    /// `local`: compliance of the contact unknowns with all others held, `stiffest`: on the stiffest unknowns alone.
    pub(crate) fn new(
        w: Arc<dyn Delassus>,
        modes: ModeJumps,
        local: f64,
        stiffest: f64,
    ) -> Result<Self, MethodError> {
        let rows = w.rows();
        let mut trace = w.trace();
        for q in &modes.q {
            let mut wq = vec![0.0; q.len()];
            w.apply_add(q, &mut wq);
            trace -= dot(q, &wq);
        }
        if rows > 0 && local <= 0.0 {
            return Err(MethodError::RigidContact);
        }
        // Where every contact row moves rigidly, W⊥ vanishes and the local compliance sets the scale.
        let compliance = if trace > NO_TRACE * local {
            trace
        } else {
            local
        };
        let scale = |compliance: f64| rows as f64 / compliance;
        Ok(Self {
            w,
            modes,
            rho: scale(compliance),
            sharp: scale(compliance.min(SWAYING * stiffest)),
            sway: compliance / stiffest,
            stiff: trace <= NO_TRACE * local,
        })
    }

    /// v := Π (v + W P), Π = I − Q Qᵀ.
    pub(crate) fn moved_add(&self, p: &[f64], v: &mut [f64]) {
        self.w.apply_add(p, v);
        self.modes.project_out(v);
    }

    /// (P_ref, u_ref) = (ρ s, P_ref/ρ̂).
    pub(crate) fn reference(&self, scale: f64) -> (f64, f64) {
        (self.rho * scale, scale * (self.rho / self.sharp))
    }

    /// A bound of ε ||W||P||, what rounding leaves of W P.
    pub(crate) fn rounding(&self, p: &[f64]) -> f64 {
        f64::EPSILON * self.w.magnitude(p)
    }
}
