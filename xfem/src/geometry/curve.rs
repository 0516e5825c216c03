//! Plane curves that cracks follow: chains of straight segments and circular arcs, both continued beyond their ends.
//!
//! ```text
//!   s(x)   abscissa of the nearest point, 0 at the first end, L at the last, beyond them on the continuation
//!   φ(x)   signed distance, positive on the side of n = tangent turned by +90°
//! ```
//!
//! A chain is continued by its end segments, an arc by its circle.

use std::f64::consts::PI;
use std::sync::Arc;

use super::chain::Chain;
use super::{Point, norm, sub};

/// A plane curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// Straight segments.
    Chain(Arc<Chain>),
    /// Part of a circle from angle `from` to `to` [rad]; counter-clockwise if `to` is larger.
    Arc {
        /// Centre [m].
        centre: Point,
        /// Radius [m].
        radius: f64,
        /// First end [rad].
        from: f64,
        /// Last end [rad].
        to: f64,
    },
}

/// Where a point lies with respect to a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Abscissa s [m].
    pub s: f64,
    /// Signed distance φ [m].
    pub phi: f64,
    /// Unit tangent at the nearest point.
    pub tangent: Point,
}

/// A vector turned by +90°.
pub fn turned(a: &Point) -> Point {
    [-a[1], a[0], 0.0]
}

impl Curve {
    /// Straight segments through points of the plane.
    pub fn chain(points: &[[f64; 2]]) -> Self {
        let points = points.iter().map(|p| [p[0], p[1], 0.0]);
        Curve::Chain(Arc::new(Chain::new(points.collect())))
    }

    /// Part of a circle of the plane.
    pub fn arc(centre: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> Self {
        Curve::Arc {
            centre: [centre[0], centre[1], 0.0],
            radius,
            from,
            to,
        }
    }

    /// Local frame n, a, b at the point nearest to one: a along the curve, b = e_z.
    pub fn frame(&self, x: &Point) -> [Point; 3] {
        let a = self.nearest(x).tangent;
        [turned(&a), a, [0.0, 0.0, 1.0]]
    }

    /// Length L [m].
    pub fn length(&self) -> f64 {
        match self {
            Curve::Chain(chain) => chain.length(),
            Curve::Arc {
                radius, from, to, ..
            } => radius * (to - from).abs(),
        }
    }

    /// True if the curve ends where it begins.
    pub fn is_closed(&self) -> bool {
        match self {
            Curve::Chain(points) => points.first() == points.last(),
            Curve::Arc { from, to, .. } => (to - from).abs() >= 2.0 * PI * (1.0 - 1e-12),
        }
    }

    /// The nearest point of the curve or its continuation.
    pub fn nearest(&self, x: &Point) -> Nearest {
        match self {
            Curve::Chain(chain) => chain.nearest(x),
            Curve::Arc {
                centre,
                radius,
                from,
                to,
            } => {
                let d = sub(x, centre);
                let (rho, turn) = (norm(&d), (to - from).signum());
                // Angle from the first end in the direction of travel, cut opposite to the middle of the arc.
                let half = 0.5 * (to - from).abs();
                let middle = from + turn * half;
                let e = if rho > 0.0 { d[1].atan2(d[0]) } else { middle };
                let mut offset = (turn * (e - middle)).rem_euclid(2.0 * PI);
                if offset > PI {
                    offset -= 2.0 * PI;
                }
                let angle = middle + turn * offset;
                Nearest {
                    s: radius * (half + offset),
                    phi: turn * (radius - rho),
                    tangent: [-turn * angle.sin(), turn * angle.cos(), 0.0],
                }
            }
        }
    }

    /// Point and unit tangent at an abscissa, also on the continuation; at a kink the tangent of the segment that ends.
    pub fn at(&self, s: f64) -> (Point, Point) {
        match self {
            Curve::Chain(chain) => chain.at(s),
            Curve::Arc {
                centre,
                radius,
                from,
                to,
            } => {
                let turn = (to - from).signum();
                let (sin, cos) = (from + turn * s / radius).sin_cos();
                (
                    [centre[0] + radius * cos, centre[1] + radius * sin, 0.0],
                    [-turn * sin, turn * cos, 0.0],
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::add_scaled;
    use super::*;

    fn arc(from: f64, to: f64) -> Curve {
        Curve::Arc {
            centre: [0.3, -0.2, 0.0],
            radius: 1.7,
            from,
            to,
        }
    }

    #[test]
    fn points_beside_a_curve_are_found_again() {
        let chain = Curve::chain(&[[0.0, 0.0], [1.0, 0.0], [1.5, 0.8], [3.0, 0.9]]);
        for curve in [chain, arc(-0.4, 2.0), arc(2.0, -0.4), arc(3.0, 9.0)] {
            let length = curve.length();
            for k in -5..=25 {
                let s = length * (f64::from(k) + 0.37) / 20.0;
                // An arc's continuation ends opposite to its middle.
                let limit = match curve {
                    Curve::Arc { radius, .. } => PI * radius,
                    Curve::Chain(_) => f64::INFINITY,
                };
                if (s - 0.5 * length).abs() > 0.99 * limit {
                    continue;
                }
                let (x, tangent) = curve.at(s);
                for phi in [0.02, -0.02, 1e-9] {
                    let found = curve.nearest(&add_scaled(&x, phi, &turned(&tangent)));
                    let error = (found.phi - phi).abs();
                    assert!(error < 1e-13, "{curve:?} {s} {phi}: {found:?}");
                    assert!((found.s - s).abs() < 1e-12, "{curve:?} {s}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_kink_is_convex_on_one_side_and_the_sign_follows_the_mean_normal() {
        let chain = Curve::chain(&[[0.0, 0.0], [1.0, 0.0], [1.0, -1.0]]);
        let outside = chain.nearest(&[1.3, 0.4, 0.0]);
        assert!((outside.phi - 0.5).abs() < 1e-14 && (outside.s - 1.0).abs() < 1e-14);
        let inside = chain.nearest(&[0.8, -0.3, 0.0]);
        assert!((inside.phi + 0.2).abs() < 1e-14 && (inside.s - 1.3).abs() < 1e-14);
    }

    #[test]
    fn arcs_measure_their_length_and_close() {
        assert!((arc(0.0, 1.0).length() - 1.7).abs() < 1e-14);
        assert!(arc(0.5, 0.5 + 2.0 * PI).is_closed() && !arc(0.0, 6.0).is_closed());
    }
}
