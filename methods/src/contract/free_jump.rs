//! What acts on the contact points without contact forces, and the scale that it sets for whatever breaks the contact laws.

use crate::algebra::dense::{dot, larger, norm, refill};
use crate::contract::judge::slip_from;
use crate::contract::operator::{ContactOperator, NO_TRACE};
use crate::contract::system::Increment;
use crate::error::MethodError;

/// The jump without contact forces and the load on floating pieces. Data alone: no answer changes it.
pub(crate) struct FreeJump {
    /// Rows (g, d) for P = 0, β = 0, in m.
    pub q: Vec<f64>,
    /// c in Qᵀ P = c.
    pub balance: Vec<f64>,
    /// |Π (q + W Q c)| in m, Π = I − Q Qᵀ, with all of the tangential jump: without what rigid motions and pins contribute. Q c
    /// are the contact forces of least norm that balance the load.
    ///
    /// Where nothing acts there is no such jump, and residuals would be relative to nothing: the size of what the increment starts
    /// from takes its place, its jump or what its forces move. Where every contact row moves rigidly, or nothing deforms, the load
    /// on the pieces is all there is.
    pub size: f64,
    /// Π W Q c by row; empty unless the body floats.
    rigid: Vec<f64>,
}

impl FreeJump {
    /// From the displacements without contact forces.
    ///
    /// # Errors
    /// [`MethodError::Refused`] where P_ref or u_ref would leave the range of numbers.
    pub fn new(
        i: &Increment<'_>,
        operator: &ContactOperator,
        u: &[f64],
    ) -> Result<Self, MethodError> {
        let (rows, modes) = (i.system.row_set(), &operator.modes);
        let (jump, start_jump) = (i.jump(u), i.start_jump());
        let balance = modes.balance(&i.resultant());
        let mut rigid = Vec::new();
        if !balance.is_empty() {
            let mut least = vec![0.0; rows.len()];
            modes.add(&balance, &mut least);
            rigid = operator.moved(&least);
        }
        let beside = |jump: &[f64]| {
            let mut jump = rows.restrict(jump);
            modes.project_out(&mut jump);
            jump
        };
        let size = if i.unloaded() {
            let mut start = rows.restrict(&i.start.p);
            modes.project_out(&mut start);
            larger(norm(&beside(&start_jump)), norm(&operator.moved(&start)))
        } else {
            let mut free = beside(&jump);
            (free.iter_mut().zip(&rigid)).for_each(|(free, rigid)| *free += rigid);
            let (free, load) = (norm(&free), norm(&balance) / operator.rho);
            let all = load > 0.0 && (operator.stiff || free <= NO_TRACE * load);
            if all { load } else { free }
        };
        let (p_ref, u_ref) = operator.reference(size);
        if size != 0.0 && !(p_ref.is_normal() && u_ref.is_normal()) {
            let reason = format!(
                "without contact forces the faces move by {size:.1e} m, which takes contact forces of {p_ref:.1e} N (2D: N/m) to \
                 undo: beyond the range of numbers; choose other units"
            );
            return Err(MethodError::Refused { reason });
        }
        Ok(Self {
            q: slip_from(rows, i.system.dim(), &jump, &start_jump),
            balance,
            size,
            rigid,
        })
    }

    /// s = max(|Π (q + W Q c)|, |Π W Π P| − ε ||W||P||) of contact forces and their rows (g, d): forces that W does not feel, the
    /// rigid share of forces, and the rounding of forces that cancel buy nothing. NaN, which no judge accepts, beyond the range
    /// of numbers. `moved` is room for rows.
    pub fn scale(
        &self,
        operator: &ContactOperator,
        p: &[f64],
        v: &[f64],
        moved: &mut Vec<f64>,
    ) -> f64 {
        // Π W Π P = Π (v − q) − Π W Q c, without a product.
        refill(moved, v.iter().zip(&self.q).map(|(v, q)| v - q));
        operator.modes.project_out(moved);
        (moved.iter_mut().zip(&self.rigid)).for_each(|(moved, rigid)| *moved -= rigid);
        let scale = larger(self.size, norm(moved) - operator.rounding(p));
        if scale.is_finite() { scale } else { f64::NAN }
    }
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
