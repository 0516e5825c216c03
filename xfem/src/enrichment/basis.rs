//! The scalar functions of a body: standard, shifted Heaviside, shifted branch functions.
//!
//! ```text
//!   u(x) = Σ N_i ū_i + Σ N_j (H(x) − H(x_j)) b_j + Σ N_k Σ_l (g_l(x) − g_l(x_k)) c_kl        (paper, Eq. 10)
//!   g = √r { sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ }                                  (paper, Eq. 12)
//! ```
//!
//! Shifting makes ū_i the displacement of node i itself. Only H and g_1 jump: [[H]] = 2, [[g_1]] = 2 √r.
//!
//! Within a fixed radius of a tip the branch functions are multiplied by a ramp ρ = Σ N_i over the nodes inside the radius,
//! and all nodes of their cells carry them: ρ is 1 inside, falls to 0 in the cells at the rim, and no cell is left with
//! some of its nodes enriched, which would spoil the order (T.-P. Fries, Int. J. Numer. Meth. Engng 75 (2008) 503). The
//! cells of the tip have no Heaviside functions: the inside holds at least the cells around them, whatever the radius. Where
//! a kink or another end of the crack is nearer than those, there is no ramp.

/// Kind of a scalar function; its node is kept beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FunctionKind {
    /// N_i.
    Standard,
    /// N_j (H(x) − H(x_j)) of a crack.
    Heaviside {
        /// Crack number.
        crack: u32,
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

/// Number of a part of a cell, see [`crate::cut::partition`]; 0 in a cell that no crack cuts.
pub type Region = usize;
