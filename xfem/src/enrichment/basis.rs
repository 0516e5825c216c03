//! The scalar functions of a body: standard, on pieces of supports, shifted branch functions.
//!
//! ```text
//!   u(x) = Σ N_i ū_i + Σ N_j 2·1_p(x) b_jp + Σ N_k Σ_l (g_l(x) − g_l(x_k)) c_kl              (paper, Eq. 10)
//!   g = √r { sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ }                              (paper, Eq. 12)
//! ```
//!
//! p runs over the pieces that the cracks leave of the support of node j, but for the node's own ([`super::supports`]): for
//! one crack the paper's shifted Heaviside function N_j (H(x) − H(x_j)) but for its sign. ū_i is the displacement of node i itself.
//! Of the branch functions only g_1 jumps: [[g_1]] = 2 √r.
//!
//! Beyond other cracks, which part a region from its tip, a branch function is 0: what a crack keeps apart shares no function.
//!
//! Within a radius of a tip the branch functions are multiplied by a ramp ρ = Σ N_i over the nodes inside the radius, and all
//! nodes of their cells carry them: ρ is 1 inside, falls to 0 in the cells at the rim, and no cell is left with some of its
//! nodes enriched, which would spoil the order (T.-P. Fries, Int. J. Numer. Meth. Engng 75 (2008) 503). The inside holds at
//! least the cells around those of the tip, whatever the radius. Where there is no room for that, there is no ramp.

/// Value of a piece function beside N_j: the jump of the paper's step H, so that unknowns have its scale.
pub const STEP: f64 = 2.0;

/// Constant of a branch function in a region that another crack parts from its tip: it is 0 there.
pub const ABSENT: f64 = f64::INFINITY;

/// Kind of a scalar function; its node is kept beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FunctionKind {
    /// N_i.
    Standard,
    /// 2 N_j on a piece of its support, 0 elsewhere.
    Piece {
        /// Number of the piece among those of the node, from 0; the node's own is none of them.
        piece: u32,
    },
    /// N_k (g_l(x) − g_l(x_k)) of a tip.
    Branch {
        /// Tip number.
        tip: u32,
        /// l = 0..4.
        order: u8,
    },
}

/// A scalar function of the whole body: a node and a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Function {
    /// Node number.
    pub node: u32,
    /// Kind.
    pub kind: FunctionKind,
}
