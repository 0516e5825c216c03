//! The scalar functions of a cell: standard, shifted Heaviside, shifted branch functions.
//!
//! ```text
//!   u(x) = Σ N_i ū_i + Σ N_j (H(x) − H(x_j)) b_j + Σ N_k Σ_l (g_l(x) − g_l(x_k)) c_kl        (paper, Eq. 10)
//!   g = √r { sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ }                                  (paper, Eq. 12)
//! ```
//!
//! Shifting makes ū_i the displacement of node i itself. Only H and g_1 jump: [[H]] = 2, [[g_1]] = 2 √r.

use crate::fem::cell::CellKind;
use crate::fem::{Point, dot, sub};

use super::cut::Side;

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

/// A tip inside the body with its frame.
#[derive(Debug, Clone, PartialEq)]
pub struct TipFrame {
    /// Crack number.
    pub crack: usize,
    /// Position [m].
    pub position: Point,
    /// Unit direction out of the crack.
    pub ahead: Point,
    /// Crack normal, towards side 1.
    pub normal: Point,
}

impl TipFrame {
    /// Branch functions and their gradients at a point.
    ///
    /// `side` says on which face a point of the crack lies (θ = ±π); `None` takes the side from the position.
    pub fn branch(&self, x: &Point, side: Option<Side>) -> ([f64; 4], [Point; 4]) {
        let d = sub(x, &self.position);
        let (x1, mut x2) = (dot(&d, &self.ahead), dot(&d, &self.normal));
        match side {
            Some(side) if side > 0.0 => x2 = x2.max(0.0),
            Some(_) => x2 = -((-x2).max(0.0)),
            None => {}
        }
        let r = x1.hypot(x2);
        let theta = x2.atan2(x1);
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
                    gradients[l][a] = g1 * self.ahead[a] + g2 * self.normal[a];
                }
            }
        }
        (values, gradients)
    }
}

/// One scalar function of one cell.
#[derive(Debug, Clone, Copy)]
pub struct CellFunction {
    /// Local node.
    pub local: usize,
    /// Kind.
    pub kind: FunctionKind,
    /// H(x_j) (Heaviside) or g_l(x_k) (branch) at the node.
    pub shift: f64,
    /// Side of the function's crack that the whole cell lies on, if the crack does not split it.
    pub whole: Option<Side>,
}

impl CellFunction {
    /// Constant of a Heaviside function on a side of the splitting crack, H − H(x_j); 1 for the others.
    pub fn step(&self, side: Side) -> f64 {
        match self.kind {
            FunctionKind::Heaviside { .. } => self.whole.unwrap_or(side) - self.shift,
            _ => 1.0,
        }
    }
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
    /// Crack that splits the cell.
    pub crack: Option<usize>,
    /// All tips of the body.
    pub tips: &'a [TipFrame],
}

impl CellBasis<'_> {
    /// Values and gradients of all functions at ξ (position x), on a side of the splitting crack.
    pub fn evaluate(
        &self,
        xi: &Point,
        x: &Point,
        side: Side,
        values: &mut [f64],
        gradients: &mut [Point],
    ) {
        let n = self.kind.shape(xi);
        let (dn, _) = self.kind.gradients(self.corners, xi);
        let mut cached: Option<(u32, [f64; 4], [Point; 4])> = None;
        for (f, (value, gradient)) in self.functions.iter().zip(values.iter_mut().zip(gradients)) {
            let (ni, dni) = (n[f.local], dn[f.local]);
            match f.kind {
                FunctionKind::Standard => (*value, *gradient) = (ni, dni),
                FunctionKind::Heaviside { .. } => {
                    let h = f.step(side);
                    (*value, *gradient) = (ni * h, dni.map(|d| d * h));
                }
                FunctionKind::Branch { tip, order } => {
                    let (g, dg) = match cached {
                        Some((number, g, dg)) if number == tip => (g, dg),
                        _ => {
                            let frame = &self.tips[tip as usize];
                            let split = (self.crack == Some(frame.crack)).then_some(side);
                            let (g, dg) = frame.branch(x, split.or(f.whole));
                            cached = Some((tip, g, dg));
                            (g, dg)
                        }
                    };
                    let l = order as usize;
                    let h = g[l] - f.shift;
                    *value = ni * h;
                    for a in 0..3 {
                        gradient[a] = dni[a] * h + ni * dg[l][a];
                    }
                }
            }
        }
    }
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
