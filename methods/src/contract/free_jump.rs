//! The load on the contact points without contact forces, and the scale that it sets for whatever breaks the contact laws.

use crate::algebra::dense::{dot, norm};
use crate::algebra::rows::RowSet;
use crate::contract::operator::{ContactOperator, NO_TRACE};
use crate::contract::system::Increment;
use crate::error::MethodError;

/// The jump without contact forces and the load on floating pieces. Data alone: no answer changes it.
pub(crate) struct FreeJump {
    /// Rows (g, d) for P = 0, β = 0, in m.
    pub q: Vec<f64>,
    /// `[[u]]` at the start of the increment.
    pub start_jump: Vec<f64>,
    /// c in Qᵀ P = c.
    pub balance: Vec<f64>,
    /// s = max(|Π (q + W Q c)|, |Π W Π P⁰|) in m, Π = I − Q Qᵀ, with all of the tangential jump: without what rigid motions and
    /// pins contribute. Q c are the contact forces of least norm that balance the load, P⁰ those at the start: what is locked in
    /// when the load has gone.
    ///
    /// Where nothing acts the jump at the start counts too. Where every contact row moves rigidly, or nothing deforms, the load on the
    /// pieces is all there is.
    pub scale: f64,
}

impl FreeJump {
    /// From `[[u]]` without contact forces.
    ///
    /// # Errors
    /// [`MethodError::Refused`] where P_ref or u_ref would leave the range of numbers.
    pub fn new(
        i: &Increment<'_>,
        operator: &ContactOperator,
        jump: &[f64],
    ) -> Result<Self, MethodError> {
        let (rows, modes) = (i.system.row_set(), &operator.modes);
        let start_jump = i.start_jump();
        let balance = modes.balance(&i.resultant());
        let beside = |x: &[f64]| {
            let mut x = rows.restrict(x);
            modes.project_out(&mut x);
            x
        };
        let mut free = beside(jump);
        if !balance.is_empty() {
            let mut least = vec![0.0; rows.len()];
            modes.add(&balance, &mut least);
            operator.moved_add(&least, &mut free);
        }
        let (load, start) = (norm(&balance) / operator.rho, beside(&i.start.p));
        let mut locked = vec![0.0; rows.len()];
        if start.iter().any(|&p| p != 0.0) {
            operator.moved_add(&start, &mut locked);
        }
        let mut scale = norm(&free).max(norm(&locked) - operator.rounding(&start));
        if i.unloaded() {
            scale = scale.max(norm(&beside(&start_jump)));
        }
        if load > 0.0 && (operator.stiff || scale <= NO_TRACE * load) {
            scale = load;
        }
        let (p_ref, u_ref) = operator.reference(scale);
        if scale != 0.0 && !(p_ref.is_normal() && u_ref.is_normal()) {
            let reason = format!(
                "without contact forces the faces move by {scale:.1e} m, which takes contact forces of {p_ref:.1e} N (2D: N/m) to \
                 undo: beyond the range of numbers; choose other units"
            );
            return Err(MethodError::Refused { reason });
        }
        Ok(Self {
            q: slip_from(rows, i.system.dim(), jump, &start_jump),
            start_jump,
            balance,
            scale,
        })
    }
}

/// Rows (g, d): normal gap, and tangential jump since the start of the increment.
pub(crate) fn slip_from(rows: &RowSet, dim: usize, jump: &[f64], start: &[f64]) -> Vec<f64> {
    rows.source
        .iter()
        .map(|&r| {
            if r % dim == 0 {
                jump[r]
            } else {
                jump[r] - start[r]
            }
        })
        .collect()
}

impl Increment<'_> {
    /// −Rᵀ f: what Nᵀ P must be. Nothing where the parts cancel to rounding, so that what is loose may stay without forces.
    pub(crate) fn resultant(&self) -> Vec<f64> {
        /// Of the sum of |r_i f_i|.
        const ROUNDING: f64 = 1e-14;
        let f = &self.load.force;
        let of = |r: &Vec<f64>| {
            let size: f64 = r.iter().zip(f).map(|(r, f)| (r * f).abs()).sum();
            let sum = dot(r, f);
            if sum.abs() > ROUNDING * size {
                -sum
            } else {
                0.0
            }
        };
        self.system.elastic().floating().iter().map(of).collect()
    }
}
