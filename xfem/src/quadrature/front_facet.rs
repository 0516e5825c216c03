//! Quadrature of a crack facet in a cell with the crack front: the jump behaves like the root of the distance behind it.

use crate::geometry::clip::crossing;
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub, unit};

use super::front::{FrontPiece, abscissae};
use super::{WeightedPoint, gauss};

/// Points of the convex piece of a crack facet behind the front inside a front cell; `polygon`: the whole facet of the
/// cell (the crack plane's part in it), in cyclic order.
///
/// Strips perpendicular to the chord; in each the distance w behind the front is ρ², so functions polynomial in √w are
/// integrated exactly.
pub fn front_facet_points<F: Fn(&Point) -> Option<Point>>(
    polygon: &[Point],
    piece: &FrontPiece<F>,
    behind: &Point,
    along_points: usize,
) -> Vec<WeightedPoint> {
    /// Points in √w: exact for a jump in √w, w, … w^(7/2) times a linear multiplier.
    const ACROSS: usize = 5;
    let [a, b] = piece.chord;
    let along = unit(&sub(&b, &a));
    let mut back = cross(&piece.normal, &along);
    if dot(&back, behind) < 0.0 {
        back = back.map(|v| -v);
    }
    let breaks: Vec<f64> = polygon.iter().map(|x| dot(&sub(x, &a), &along)).collect();
    if breaks.is_empty() {
        return Vec::new();
    }
    let across = gauss(ACROSS);
    let mut points = Vec::new();
    for (s, ds) in abscissae(breaks, [0.0, norm(&sub(&b, &a))], along_points) {
        let on_chord = add_scaled(&a, s, &along);
        let Some(tip) = (piece.at)(&on_chord) else {
            continue;
        };
        // The strip meets the polygon in w from `near` to `far`.
        let (mut near, mut far) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, p) in polygon.iter().enumerate() {
            let q = &polygon[(i + 1) % polygon.len()];
            let (f, g) = (
                dot(&sub(p, &on_chord), &along),
                dot(&sub(q, &on_chord), &along),
            );
            if f * g < 0.0 {
                let w = dot(&sub(&crossing(p, f, q, g), &tip), &back);
                near = near.min(w);
                far = far.max(w);
            }
        }
        let (from, to) = (near.max(0.0).sqrt(), far.max(0.0).sqrt());
        if to <= from {
            continue;
        }
        for &(t, weight) in &across {
            let rho = 0.5 * ((to - from) * t + from + to);
            let weight = ds * (to - from) * rho * weight; // dw = 2 ρ dρ
            let x = add_scaled(&tip, rho * rho, &back);
            points.push(WeightedPoint::new(x, weight));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_facets_integrate_roots_of_the_distance_exactly() {
        // Unit square, front x = 0.6 + 0.2 z: ∫ √w w^k over the part behind, w = (0.6 + 0.2 z − x) / √1.04.
        let square = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 0.0, 0.0],
        ];
        let chord = [[0.6, 0.0, 0.0], [0.8, 0.0, 1.0]];
        let piece = FrontPiece {
            chord,
            normal: [0.0, 1.0, 0.0],
            at: |x: &Point| Some(*x),
        };
        let points = front_facet_points(&square, &piece, &[-1.0, 0.0, 0.0], 5);
        assert!(points.iter().all(|p| p.weight > 0.0));
        let c = f64::sqrt(1.04);
        for k in [-0.5, 0.0, 0.5, 1.0, 1.5, 2.5] {
            let found: f64 = points
                .iter()
                .map(|p| p.weight * ((0.6 + 0.2 * p.x[2] - p.x[0]) / c).powf(k))
                .sum();
            let power = |x: f64| (x / c).powf(k + 2.0);
            let exact = (power(0.8) - power(0.6)) * c * c / ((k + 1.0) * (k + 2.0)) / 0.2;
            assert!((found - exact).abs() < 1e-8 * exact, "{k}: {found} {exact}");
        }
    }
}
