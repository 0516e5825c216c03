//! Quadrature on the facets of a crack, with the linear functions of their corners.

use crate::cut::crack::{Crack, Geometry};
use crate::geometry::ellipse::Ellipse;
use crate::geometry::{Point, add_scaled, cross, dot, mean, norm, sub, unit};
use crate::mesh::Mesh;
use crate::mesh::cell::CellMap;
use crate::quadrature::front::FrontPiece;
use crate::quadrature::front_facet::front_facet_points;
use crate::quadrature::graded::{graded_segment, graded_triangles};
use crate::quadrature::rational::rational_order;
use crate::quadrature::{WeightedPoint, gauss, triangle, triangle_collapsed};

use super::Enrichment;
use super::facets::{CrackFacets, Facet, FrontCut};

/// A quadrature point of a facet.
#[derive(Debug, Clone)]
pub struct FacetPoint {
    /// Position [m].
    pub x: Point,
    /// Length [m] or area [m²].
    pub weight: f64,
    /// Values of the corners' functions: linear along a segment; in a polygon linear on each triangle of its centroid and
    /// an edge, the centroid taking the mean. They sum to one.
    pub hats: Vec<f64>,
}

/// Tips farther away than this from a segment, in its lengths, leave a smooth function on it.
const NEAR: f64 = 2.0;

/// Rule of one facet of a crack by what lives in its cells.
pub fn facet_points(
    mesh: &Mesh,
    crack: &Crack,
    enrichment: &Enrichment,
    facets: &CrackFacets,
    facet: &Facet,
) -> Vec<FacetPoint> {
    let cells = facet.sides.map(|side| side.0);
    let maps = cells.map(|cell| mesh.map(cell));
    let polygon = facets.polygon(facet);
    let affine = maps.iter().all(CellMap::is_affine);
    let branch = cells.iter().any(|&cell| enrichment.has_branch(cell));
    if let &[p, q] = polygon.as_slice() {
        let near = NEAR * norm(&sub(&q, &p));
        let tips = || enrichment.singular_points_near(&[p, q], near);
        let integrand = match (branch, affine) {
            (true, _) => Integrand::Root(tips()),
            (false, true) => Integrand::Polynomial,
            (false, false) => {
                let [one, two] = maps.each_ref().map(|map| rational_order(map, [&p, &q]));
                Integrand::Rational(one.max(two))
            }
        };
        return segment_points(&[p, q], integrand);
    }
    match (&crack.geometry, branch, &facet.front) {
        (Geometry::Ellipse(ellipse), true, Some(cut)) => front_facet(ellipse, cut, &polygon),
        (Geometry::Ellipse(ellipse), true, None) => {
            let distance = |x: &Point| ellipse.nearest(x).psi.abs();
            graded_facet(&polygon, distance)
        }
        _ => polygon_points(&polygon, affine),
    }
}

/// How the jump varies on a facet.
enum Integrand {
    /// Polynomial: the cell is affine and carries no branch function.
    Polynomial,
    /// Rational, the cell is distorted: takes so many points.
    Rational(usize),
    /// Like √r from tips this near (2D).
    Root(Vec<Point>),
}

/// Points of a segment.
///
/// ```text
///   jump × hat is cubic on an affine cell: 2 points;    with branch functions: x = tip + ρ² e, a polynomial in ρ
/// ```
fn segment_points(ends: &[Point; 2], integrand: Integrand) -> Vec<FacetPoint> {
    /// Points in ρ: exact for √r × quartics, and far from tips.
    const ROOT: usize = 10;
    /// A tip on the line of the segment, in its lengths.
    const ON_LINE: f64 = 1e-9;
    /// Points and halvings towards tips beside it, or one of several: exact to 1e-12.
    const SEVERAL: usize = 12;
    const DEPTH: usize = 28;
    let d = sub(&ends[1], &ends[0]);
    let length = norm(&d);
    let point = |t: f64, weight: f64| FacetPoint {
        x: add_scaled(&ends[0], t, &d),
        weight,
        hats: vec![1.0 - t, t],
    };
    let unit = |n: usize| {
        gauss(n)
            .into_iter()
            .map(|(t, w)| (0.5 * (1.0 + t), 0.5 * w))
    };
    let plain = |n: usize| unit(n).map(|(t, w)| point(t, w * length)).collect();
    let tips = match integrand {
        Integrand::Polynomial => return plain(2),
        Integrand::Rational(n) => return plain(n),
        Integrand::Root(tips) => tips,
    };
    let from = |tip: &Point| [0, 1].map(|i| sub(&ends[i], tip));
    let on_line = |tip: &&Point| {
        let [p, q] = from(tip);
        norm(&cross(&p, &q)) <= ON_LINE * length * length
    };
    let tip = match tips.as_slice() {
        [] => return plain(ROOT),
        [tip] if on_line(&tip) => tip,
        _ => {
            let points = graded_segment(&ends[0], &ends[1], &tips, SEVERAL, DEPTH).into_iter();
            let place = |x: &Point| dot(&sub(x, &ends[0]), &d) / (length * length);
            return points.map(|p| point(place(&p.x), p.weight)).collect();
        }
    };
    // r along the segment, from the end next to the tip.
    let r = from(tip).map(|v| norm(&v));
    let (low, high) = (r[0].min(r[1]).sqrt(), r[0].max(r[1]).sqrt());
    let of_rho = |(q, w): (f64, f64)| {
        let rho = low + q * (high - low);
        let along = (rho * rho - low * low) / length;
        let t = if r[0] <= r[1] { along } else { 1.0 - along };
        point(t, 2.0 * rho * (high - low) * w)
    };
    unit(ROOT).map(of_rho).collect()
}

/// Points of a convex polygon in space.
fn polygon_points(polygon: &[Point], affine: bool) -> Vec<FacetPoint> {
    fan_points(polygon, |t| {
        if affine {
            triangle(t)
        } else {
            triangle_collapsed(t, 6)
        }
    })
}

/// Points of a convex polygon whose jump varies like the root of a distance from a front outside of it.
fn graded_facet(polygon: &[Point], distance: impl Fn(&Point) -> f64) -> Vec<FacetPoint> {
    /// Points per direction and halvings: relative error of √distance below 1e-6.
    const POINTS: usize = 5;
    const DEPTH: usize = 8;
    fan_points(polygon, |t| {
        graded_triangles(&[*t], &distance, POINTS, DEPTH)
    })
}

/// Points of the triangles of a polygon's fan by a rule.
fn fan_points(
    polygon: &[Point],
    rule: impl Fn(&[Point; 3]) -> Vec<WeightedPoint>,
) -> Vec<FacetPoint> {
    let mut points = Vec::new();
    for (t, corners) in fans(polygon) {
        for p in rule(&t) {
            points.extend(with_hats(p, &t, &corners, polygon.len()));
        }
    }
    points
}

/// Points of a convex polygon cut from a face by the front of an elliptic crack, up to the front itself.
fn front_facet(ellipse: &Ellipse, cut: &FrontCut, polygon: &[Point]) -> Vec<FacetPoint> {
    /// Points along the chord between two corners.
    const ALONG: usize = 5;
    let chord = cut.chord;
    let along = unit(&sub(&chord[1], &chord[0]));
    let ahead = cross(&along, &ellipse.normal);
    let away = dot(&ahead, &sub(&mean(polygon), &chord[0]));
    let behind = ahead.map(|v| v * away.signum());
    let piece = FrontPiece {
        chord,
        normal: ellipse.normal,
        at: |x: &Point| ellipse.meet(x, &behind),
    };
    let triangles = fans(polygon);
    front_facet_points(&cut.face, &piece, &behind, ALONG)
        .into_iter()
        .filter_map(|p| {
            // Between chord and front a point lies just outside all triangles: the nearest one speaks for it.
            let outside = |t: &[Point; 3]| {
                let parts = barycentric(t, &p.x)?;
                Some(parts.iter().fold(0.0, |worst: f64, v| worst.max(-v)))
            };
            let (t, corners) = triangles
                .iter()
                .filter(|(t, _)| outside(t).is_some())
                .min_by(|a, b| {
                    outside(&a.0)
                        .unwrap_or(f64::INFINITY)
                        .total_cmp(&outside(&b.0).unwrap_or(f64::INFINITY))
                })?;
            with_hats(p, t, corners, polygon.len())
        })
        .collect()
}

/// A triangle of a fan with the corners of the polygon it takes, `None` for the centroid.
type FanTriangle = ([Point; 3], [Option<usize>; 3]);

/// Triangles of the centroid and the edges; a triangle is one itself.
fn fans(polygon: &[Point]) -> Vec<FanTriangle> {
    // A triangle needs no centroid: its hats are linear throughout.
    if let &[a, b, c] = polygon {
        return vec![([a, b, c], [Some(0), Some(1), Some(2)])];
    }
    let (count, centre) = (polygon.len(), mean(polygon));
    (0..count)
        .map(|i| {
            let j = (i + 1) % count;
            ([centre, polygon[i], polygon[j]], [None, Some(i), Some(j)])
        })
        .collect()
}

/// Barycentric coordinates in the plane of a triangle; `None` if it has no area.
///
/// By areas, not by scalar products: their determinant is the square of the area, lost in rounding on a sliver.
fn barycentric(t: &[Point; 3], x: &Point) -> Option<[f64; 3]> {
    let (e1, e2, d) = (sub(&t[1], &t[0]), sub(&t[2], &t[0]), sub(x, &t[0]));
    let normal = cross(&e1, &e2);
    let square = dot(&normal, &normal);
    let (u, v) = (
        dot(&cross(&d, &e2), &normal) / square,
        dot(&cross(&e1, &d), &normal) / square,
    );
    (square > 0.0).then_some([1.0 - u - v, u, v])
}

fn with_hats(
    p: WeightedPoint,
    t: &[Point; 3],
    corners: &[Option<usize>; 3],
    count: usize,
) -> Option<FacetPoint> {
    let mut hats = vec![0.0; count];
    for (corner, value) in corners.iter().zip(barycentric(t, &p.x)?) {
        match corner {
            Some(i) => hats[*i] += value,
            None => hats.iter_mut().for_each(|h| *h += value / count as f64),
        }
    }
    Some(FacetPoint {
        x: p.x,
        weight: p.weight,
        hats,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(points: &[FacetPoint], f: impl Fn(&FacetPoint) -> f64) -> f64 {
        points.iter().map(|p| p.weight * f(p)).sum()
    }

    #[test]
    fn a_segment_up_to_the_tip_integrates_roots_exactly() {
        let tip = [1.0, 2.0, 0.0];
        for (far, near) in [(2.0, 0.0), (1.5, 0.3), (0.3, 1.5)] {
            let end = |r: f64| [1.0 - 0.6 * r, 2.0 - 0.8 * r, 0.0];
            let points = segment_points(&[end(far), end(near)], Integrand::Root(vec![tip]));
            let r = |p: &FacetPoint| norm(&sub(&p.x, &tip));
            let power =
                |k: f64| ((far.max(near)).powf(k + 1.0) - far.min(near).powf(k + 1.0)) / (k + 1.0);
            for k in [0.0, 0.5, 1.0, 1.5, 2.5] {
                let found = sum(&points, |p| r(p).powf(k));
                let error = (found - power(k)).abs();
                assert!(error < 1e-13 * power(k), "{far} {near} {k}");
            }
            // ∫ hat of the first end × r: linear in r
            let slope = |p: &FacetPoint| (r(p) - near) / (far - near);
            assert!(points.iter().all(|p| (p.hats[0] - slope(p)).abs() < 1e-13));
        }
    }

    #[test]
    fn hats_of_a_polygon_sum_to_one_and_reproduce_its_area() {
        let pentagon: Vec<Point> = (0..5)
            .map(|i| {
                let (s, c) = (1.3 * f64::from(i)).sin_cos();
                [c, s, 0.5 * c - 0.2 * s]
            })
            .collect();
        for polygon in [&pentagon[..3], &pentagon[..4], &pentagon[..]] {
            let points = polygon_points(polygon, true);
            let sums = points.iter().map(|p| p.hats.iter().sum::<f64>());
            assert!(sums.into_iter().all(|sum| (sum - 1.0).abs() < 1e-13));
            let area: f64 = crate::contact::pairs::vertex_weights(polygon).iter().sum();
            assert!((sum(&points, |_| 1.0) - area).abs() < 1e-14);
            let fine = polygon_points(polygon, false);
            let linear = |p: &FacetPoint| p.hats[1] * (1.0 + p.x[0]);
            assert!((sum(&points, linear) - sum(&fine, linear)).abs() < 1e-14);
        }
    }

    /// Σ hat x = x holds on every triangle of the fan, however thin: rounding of coordinates over the width at most.
    #[test]
    fn slivers_keep_their_points_and_hats() {
        for width in [1e-2, 1e-6, 1e-9, 1e-12] {
            let polygon = [
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, width, 0.0],
                [0.4, 0.7, 0.2],
            ];
            let points = polygon_points(&polygon, true);
            assert_eq!(points.len(), 4 * polygon_points(&polygon[..3], true).len());
            for p in &points {
                let mut x = [0.0; 3];
                for (hat, corner) in p.hats.iter().zip(&polygon) {
                    x = add_scaled(&x, *hat, corner);
                }
                let off = p.weight * norm(&sub(&x, &p.x));
                assert!(off < 1e-15, "{width}: {off:e}");
            }
        }
    }
}
