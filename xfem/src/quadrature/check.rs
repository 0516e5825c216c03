//! Closed forms that rules are tested against.

use super::WeightedPoint;
use crate::geometry::polygon::edges;
use crate::geometry::{Point, cross, dot, sub, unit};

/// Σ w f(x).
pub fn integral(points: &[WeightedPoint], f: impl Fn(&Point) -> f64) -> f64 {
    points.iter().map(|p| p.weight * f(&p.x)).sum()
}

/// ∫ 1/r over a counter-clockwise polygon in the plane, r the distance from a point anywhere in it.
///
/// Signed triangles of the point and the edges: Σ h (asinh(s₁/h) − asinh(s₀/h)).
pub fn inverse_distance(polygon: &[Point], tip: &Point) -> f64 {
    let triangle = |(p, q): (Point, Point)| {
        let along = unit(&sub(&q, &p));
        let h = cross(&sub(&p, tip), &along)[2];
        let [from, to] = [p, q].map(|x| (dot(&sub(&x, tip), &along) / h.abs()).asinh());
        if h == 0.0 { 0.0 } else { h * (to - from) }
    };
    edges(polygon).map(triangle).sum()
}
