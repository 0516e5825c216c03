//! Tips and fronts of cracks with their coordinates: distance ahead along the crack, distance from it.

use super::clip::Side;
use super::curve::{Curve, turned};
use super::ellipse::Ellipse;
use super::{Point, cross, dot, norm, sub};

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
    /// A straight front at a place; `ahead` and `normal` are its frame.
    pub fn straight(crack: usize, position: Point, ahead: Point, normal: Point) -> Self {
        TipFrame {
            crack,
            position,
            ahead,
            normal,
            shape: FrontShape::Straight,
        }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> TipFrame {
        let (s, c) = 0.5f64.sin_cos();
        TipFrame::straight(0, [0.3, -0.2, 0.0], [c, s, 0.0], [-s, c, 0.0])
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
            let x = crate::geometry::add_scaled(&tip.position, -r, &tip.ahead);
            let (upper, _) = tip.branch(&x, Some(1.0));
            let (lower, _) = tip.branch(&x, Some(-1.0));
            assert!((upper[0] - lower[0] - 2.0 * r.sqrt()).abs() < 1e-12);
            for l in 1..4 {
                assert!((upper[l] - lower[l]).abs() < 1e-12);
            }
        }
    }
}
