//! Quadrature of a convex polygon whose integrand has half powers of the distance r from a point of its plane.
//!
//! With the point in the polygon: the crack-tip fan. With the point outside: polar coordinates around it, with the same
//! ρ = √r. All weights are positive.

use std::f64::consts::PI;

use crate::geometry::clip::{fan, rounding};
use crate::geometry::polygon::edges;
use crate::geometry::{Point, add_scaled, cross, dot, mean, norm, resolve, sub, unit};

use super::{FanRule, WeightedPoint, fan_triangle, gauss, triangle};

/// Points of a convex polygon with normal ± `along` that has the front's point `tip` in its plane; `size`: of the
/// cell [m]; `rule`: of the fan around the tip; half as many points in angle on the intervals of a tip outside. Without a
/// tip the degree-4 rule.
pub fn slice_points(
    slice: &[Point],
    along: &Point,
    tip: Option<Point>,
    size: f64,
    rule: FanRule,
) -> Vec<WeightedPoint> {
    let Some(tip) = tip else {
        return fan(slice).iter().flat_map(triangle).collect();
    };
    let area = |(p, q): (Point, Point)| dot(along, &cross(&sub(&p, &tip), &sub(&q, &tip)));
    let areas: Vec<f64> = edges(slice).map(area).collect();
    let turn = areas.iter().sum::<f64>().signum();
    let lost = rounding(slice);
    let inside = edges(slice).zip(&areas).all(|((p, q), area)| {
        // Distance of the tip from the edge, positive inwards; rounding counts as the closure. An edge that rounding made lies
        // on no line.
        let length = norm(&sub(&p, &q));
        length <= lost || area * turn >= -1e-12 * size * length
    });
    if inside {
        let fan = edges(slice).map(|(p, q)| fan_triangle(&tip, &p, &q, rule));
        fan.flatten().collect()
    } else {
        outside_points(slice, along, &tip, rule)
    }
}

/// Points of a convex polygon in a plane with normal `along`, in polar coordinates around a point outside of it.
///
/// ```text
///   dA = r dr dθ = 2 ρ³ dρ dθ,   r = ρ² between the near edge and the far edge in direction θ
/// ```
///
/// Exact in ρ as [`fan_triangle`] is. An edge's r(θ) = h / cos(θ − foot) has its poles along the edge: intervals of θ,
/// first those between vertices, are halved until they are no wider than their distance to both edges' poles.
fn outside_points(
    polygon: &[Point],
    along: &Point,
    tip: &Point,
    rule: FanRule,
) -> Vec<WeightedPoint> {
    /// Halvings in a row; a tip 1e-9 edges away needs 30.
    const DEPTH: usize = 40;
    /// Halvings in all: two edges may point at the tip from all over a sliver.
    const MOST: usize = 256;
    // Angles from the middle of the polygon, which lies within less than a half turn seen from outside.
    let from_tip: Vec<Point> = polygon.iter().map(|x| sub(x, tip)).collect();
    let e0 = unit(&mean(&from_tip));
    let e1 = cross(along, &e0);
    let flat: Vec<[f64; 2]> = from_tip.iter().map(|d| resolve(&[e0, e1], d)).collect();
    let angles: Vec<f64> = flat.iter().map(|d| d[1].atan2(d[0])).collect();
    // An edge that points at the tip lies between two angles that differ by rounding.
    let lost = rounding(polygon);
    let slack = |d: &[f64; 2]| 1e-13 + 2.0 * lost / d[0].hypot(d[1]);
    let slacks = flat.iter().map(slack);
    let mut breaks: Vec<(f64, f64)> = angles.iter().copied().zip(slacks).collect();
    breaks.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Error (3 + √8)^−2n for simple poles, n points: 7e-10 for 6.
    let angular = gauss(rule.angular / 2);
    let radial = gauss(rule.radial);
    let mut points = Vec::new();
    let mut stack = Vec::new();
    for pair in breaks.windows(2) {
        let (low, high) = (pair[0].0, pair[1].0);
        if high - low < pair[0].1.max(pair[1].1) {
            continue;
        }
        let centre = 0.5 * (low + high);
        // The two edges that a ray between the angles meets: r(θ) = c / sin(pole − θ).
        let met: Vec<(f64, f64, f64)> = (0..flat.len())
            .map(|i| (i, (i + 1) % flat.len()))
            .filter(|&(i, j)| (angles[i] - centre) * (angles[j] - centre) < 0.0)
            .map(|(i, j)| {
                let d = [flat[j][0] - flat[i][0], flat[j][1] - flat[i][1]];
                let length = d[0].hypot(d[1]);
                let c = (flat[i][0] * d[1] - flat[i][1] * d[0]) / length;
                let longest = [i, j].map(|k| flat[k][0].hypot(flat[k][1]));
                (c, d[1].atan2(d[0]), longest[0].max(longest[1]))
            })
            .collect();
        if let [one, other] = met[..] {
            stack.push((low, high, [one, other], 0));
        }
    }
    let mut halvings = 0;
    while let Some((low, high, edges, depth)) = stack.pop() {
        let pole_distance = |pole: f64| {
            // To the nearest of pole + kπ.
            let gap = |t: f64| (t - pole - PI * ((t - pole) / PI).round()).abs();
            gap(low).min(gap(high))
        };
        let nearest = pole_distance(edges[0].1).min(pole_distance(edges[1].1));
        if high - low > nearest && depth < DEPTH && halvings < MOST {
            halvings += 1;
            let middle = 0.5 * (low + high);
            stack.push((low, middle, edges, depth + 1));
            stack.push((middle, high, edges, depth + 1));
            continue;
        }
        for &(t, wt) in &angular {
            let theta = 0.5 * ((high - low) * t + low + high);
            // Rounding may send r to infinity on an edge that points at the tip; it ends at its farther vertex.
            let r = edges.map(|(c, pole, most)| (c / (pole - theta).sin()).min(most).max(0.0));
            let (from, to) = (r[0].min(r[1]).sqrt(), r[0].max(r[1]).sqrt());
            let direction = add_scaled(&e0.map(|v| v * theta.cos()), theta.sin(), &e1);
            for &(s, wx) in &radial {
                let rho = 0.5 * ((to - from) * s + from + to);
                let weight = 0.5 * (high - low) * wt * (to - from) * rho.powi(3) * wx;
                let x = add_scaled(tip, rho * rho, &direction);
                points.push(WeightedPoint::new(x, weight));
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::check::{integral, inverse_distance};

    #[test]
    fn a_point_anywhere_gives_the_closed_form_of_1_over_r() {
        let square = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.3, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        for tip in [
            [0.4, 0.3, 0.0],
            [0.0, 0.0, 0.0],
            [0.5, 0.0, 0.0],
            [0.5, -1e-3, 0.0],
            [-1e-6, -1e-6, 0.0],
            [1.0, -1e-9, 0.0],
            [2.0, 0.0, 0.0],
            [-4.0, 1.0, 0.0],
        ] {
            let normal = [0.0, 0.0, 1.0];
            let points = slice_points(&square, &normal, Some(tip), 1.0, FanRule::fine(true));
            assert!(points.iter().all(|p| p.weight >= 0.0));
            let area = integral(&points, |_| 1.0);
            assert!((area - 1.15).abs() < 1e-8, "{tip:?}: {area}");
            let found = integral(&points, |x| 1.0 / norm(&sub(x, &tip)));
            let exact = inverse_distance(&square, &tip);
            let error = (found - exact).abs();
            assert!(error < 1e-7 * exact, "{tip:?}: {found} {exact}");
        }
    }
}
