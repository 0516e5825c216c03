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

use crate::fem::cell::CellKind;
use crate::fem::{Point, cross, dot, norm, sub};

use super::curve::{Curve, turned};
use super::cut::Side;
use super::ellipse::Ellipse;

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

/// A tip or front inside the body with its coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct TipFrame {
    /// Crack number.
    pub crack: usize,
    /// Position; of an ellipse its centre [m].
    pub position: Point,
    /// Unit direction out of the crack; of an ellipse its first axis.
    pub ahead: Point,
    /// Crack normal, towards side 1.
    pub normal: Point,
    /// What the crack behind it looks like.
    pub shape: FrontShape,
}

/// Shape of a crack near its tip, which bends the coordinates of the branch functions along with it.
#[derive(Debug, Clone, PartialEq)]
pub enum FrontShape {
    /// Straight.
    Straight,
    /// A circular arc.
    Arc {
        /// Its curve.
        curve: Curve,
        /// Whether the tip is its last end.
        last: bool,
    },
    /// The front of an elliptic crack in 3D.
    Ellipse(Ellipse),
}

/// Crack-tip coordinates of a point: r = √(ψ² + φ²), θ = atan2(φ, ψ).
#[derive(Debug, Clone, Copy)]
pub struct TipCoordinates {
    /// Distance ahead of the front along the crack, negative behind it [m].
    pub psi: f64,
    /// Distance from the crack, positive on side 1 [m].
    pub phi: f64,
    /// ∇ψ.
    pub psi_gradient: Point,
    /// ∇φ.
    pub phi_gradient: Point,
}

impl TipFrame {
    /// True for the front of a 3D crack.
    pub fn shape_is_ellipse(&self) -> bool {
        matches!(self.shape, FrontShape::Ellipse(_))
    }

    /// Coordinates of a point.
    pub fn coordinates(&self, x: &Point) -> TipCoordinates {
        let d = sub(x, &self.position);
        match &self.shape {
            FrontShape::Straight => TipCoordinates {
                psi: dot(&d, &self.ahead),
                phi: dot(&d, &self.normal),
                psi_gradient: self.ahead,
                phi_gradient: self.normal,
            },
            FrontShape::Arc { curve, last } => {
                // ψ runs along the arc: constant on its radii, so ∇ψ shrinks outwards.
                let near = curve.nearest(x);
                let sign = if *last { 1.0 } else { -1.0 };
                let end = if *last { curve.length() } else { 0.0 };
                let stretch = match curve {
                    Curve::Arc { centre, radius, .. } => radius / norm(&sub(x, centre)),
                    Curve::Chain(_) => 1.0,
                };
                TipCoordinates {
                    psi: sign * (near.s - end),
                    phi: near.phi,
                    psi_gradient: near.tangent.map(|t| sign * stretch * t),
                    phi_gradient: turned(&near.tangent),
                }
            }
            FrontShape::Ellipse(ellipse) => {
                let near = ellipse.nearest(x);
                TipCoordinates {
                    psi: near.psi,
                    phi: dot(&d, &self.normal),
                    psi_gradient: near.ahead,
                    phi_gradient: self.normal,
                }
            }
        }
    }

    /// Distance r from the tip or front [m].
    pub fn distance(&self, x: &Point) -> f64 {
        let at = self.coordinates(x);
        at.psi.hypot(at.phi)
    }

    /// Frame at the point of the front nearest to x: ahead, crack normal, tangent = ahead × normal.
    pub fn frame(&self, x: &Point) -> [Point; 3] {
        let ahead = match &self.shape {
            FrontShape::Ellipse(ellipse) => ellipse.nearest(x).ahead,
            _ => self.ahead,
        };
        [ahead, self.normal, cross(&ahead, &self.normal)]
    }

    /// Branch functions and their gradients at a point.
    ///
    /// `side` says on which face a point of the crack lies (θ = ±π); `None` takes the side from the position.
    pub fn branch(&self, x: &Point, side: Option<Side>) -> ([f64; 4], [Point; 4]) {
        let TipCoordinates {
            psi,
            mut phi,
            psi_gradient,
            phi_gradient,
        } = self.coordinates(x);
        match side {
            Some(side) if side > 0.0 => phi = phi.max(0.0),
            Some(_) => phi = -((-phi).max(0.0)),
            None => {}
        }
        let r = psi.hypot(phi);
        let theta = phi.atan2(psi);
        let (root, s, c) = (r.sqrt(), (0.5 * theta).sin(), (0.5 * theta).cos());
        let (sin, cos) = (theta.sin(), theta.cos());
        let angular = [s, c, s * sin, c * sin];
        let slope = [
            0.5 * c,
            -0.5 * s,
            0.5 * c * sin + s * cos,
            -0.5 * s * sin + c * cos,
        ];
        let values = angular.map(|f| root * f);
        let mut gradients = [[0.0; 3]; 4];
        if r > 0.0 {
            for l in 0..4 {
                // ∂g/∂r = f/(2√r), (1/r) ∂g/∂θ = f'/√r, turned into space
                let (gr, gt) = (0.5 * angular[l] / root, slope[l] / root);
                let (g1, g2) = (gr * cos - gt * sin, gr * sin + gt * cos);
                for a in 0..3 {
                    gradients[l][a] = g1 * psi_gradient[a] + g2 * phi_gradient[a];
                }
            }
        }
        (values, gradients)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> TipFrame {
        let (s, c) = 0.5f64.sin_cos();
        TipFrame {
            crack: 0,
            position: [0.3, -0.2, 0.0],
            ahead: [c, s, 0.0],
            normal: [-s, c, 0.0],
            shape: FrontShape::Straight,
        }
    }

    #[test]
    fn branch_gradients_are_the_derivatives() {
        let tip = frame();
        for x in [[0.5, 0.1, 0.0], [0.1, -0.5, 0.0], [-0.4, -0.2, 0.0]] {
            let (_, gradients) = tip.branch(&x, None);
            let h = 1e-6;
            for a in 0..2 {
                let (mut p, mut m) = (x, x);
                p[a] += h;
                m[a] -= h;
                for l in 0..4 {
                    let slope = (tip.branch(&p, None).0[l] - tip.branch(&m, None).0[l]) / (2.0 * h);
                    assert!((slope - gradients[l][a]).abs() < 1e-8, "{x:?} {l} {a}");
                }
            }
        }
    }

    #[test]
    fn only_the_first_branch_function_jumps_and_by_two_roots_of_r() {
        let tip = frame();
        for r in [1e-3, 0.2, 1.5] {
            let x = crate::fem::add_scaled(&tip.position, -r, &tip.ahead);
            let (upper, _) = tip.branch(&x, Some(1.0));
            let (lower, _) = tip.branch(&x, Some(-1.0));
            assert!((upper[0] - lower[0] - 2.0 * r.sqrt()).abs() < 1e-12);
            for l in 1..4 {
                assert!((upper[l] - lower[l]).abs() < 1e-12);
            }
        }
    }
}
