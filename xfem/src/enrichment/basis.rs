//! The scalar functions of a cell: standard, shifted Heaviside, shifted branch functions.
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

use crate::geometry::Point;
use crate::geometry::tip_frame::TipFrame;
use crate::mesh::cell::CellKind;

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

/// Number of a part of a cell, see [`super::partition`]; 0 in a cell that no crack cuts.
pub type Region = usize;

/// One scalar function of one cell.
#[derive(Debug, Clone, Copy)]
pub struct CellFunction {
    /// Local node.
    pub local: usize,
    /// Kind.
    pub kind: FunctionKind,
    /// H(x_j) (Heaviside) or g_l(x_k) (branch) at the node.
    pub shift: f64,
    /// Local nodes i of the cell over which the ramp ρ = Σ N_i of a branch function runs, one bit each; all: ρ = 1.
    pub ramp: u8,
}

/// The functions of one cell, ready to be evaluated.
#[derive(Debug)]
pub struct CellBasis<'a> {
    /// Kind of the cell.
    pub kind: CellKind,
    /// Node positions.
    pub corners: &'a [Point],
    /// Functions, the standard ones first.
    pub functions: &'a [CellFunction],
    /// Region by region and function by function: H − H(x_j) of a Heaviside function, the side of its crack for a branch
    /// function (0: by position), 1 for a standard one.
    pub steps: &'a [f64],
    /// All tips of the body.
    pub tips: &'a [TipFrame],
}

impl CellBasis<'_> {
    /// Constants of the functions in a region.
    pub fn steps(&self, region: Region) -> &[f64] {
        let count = self.functions.len();
        &self.steps[region * count..(region + 1) * count]
    }

    /// Values and gradients of all functions at ξ (position x) in a region of the cell.
    pub fn evaluate(
        &self,
        xi: &Point,
        x: &Point,
        region: Region,
        values: &mut [f64],
        gradients: &mut [Point],
    ) {
        let n = self.kind.shape(xi);
        let (dn, _) = self.kind.gradients(self.corners, xi);
        let mut cached: Option<Branches> = None;
        let out = values.iter_mut().zip(gradients);
        for ((f, step), (value, gradient)) in self.functions.iter().zip(self.steps(region)).zip(out)
        {
            let (ni, dni) = (n[f.local], dn[f.local]);
            match f.kind {
                FunctionKind::Standard => (*value, *gradient) = (ni, dni),
                FunctionKind::Heaviside { .. } => {
                    (*value, *gradient) = (ni * step, dni.map(|d| d * step));
                }
                FunctionKind::Branch { tip, order } => {
                    let branches = match cached {
                        Some(known) if known.tip == tip => known,
                        _ => {
                            let side = (*step != 0.0).then_some(*step);
                            let (values, gradients) = self.tips[tip as usize].branch(x, side);
                            let count = self.kind.nodes();
                            let (ramp, ramp_gradient) = ramp(f.ramp, &n[..count], &dn[..count]);
                            Branches {
                                tip,
                                values,
                                gradients,
                                ramp,
                                ramp_gradient,
                            }
                        }
                    };
                    cached = Some(branches);
                    let l = order as usize;
                    let (rho, h) = (branches.ramp, branches.values[l] - f.shift);
                    *value = ni * h * rho;
                    for a in 0..3 {
                        let slope = branches.gradients[l][a] * rho + h * branches.ramp_gradient[a];
                        gradient[a] = dni[a] * h * rho + ni * slope;
                    }
                }
            }
        }
    }
}

/// Branch functions of one tip and their ramp at one point.
#[derive(Clone, Copy)]
struct Branches {
    tip: u32,
    values: [f64; 4],
    gradients: [Point; 4],
    ramp: f64,
    ramp_gradient: Point,
}

/// ρ = Σ N_i over the nodes of a mask, and its gradient; exactly 1 over all of them.
fn ramp(mask: u8, n: &[f64], dn: &[Point]) -> (f64, Point) {
    let inside = |i: usize| mask & (1 << i) != 0;
    if (0..n.len()).all(inside) {
        return (1.0, [0.0; 3]);
    }
    let nodes = (0..n.len()).filter(|&i| inside(i));
    nodes.fold((0.0, [0.0; 3]), |(rho, slope), i| {
        (rho + n[i], [0, 1, 2].map(|a| slope[a] + dn[i][a]))
    })
}
