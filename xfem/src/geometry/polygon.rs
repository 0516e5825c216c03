//! Simple polygons in the plane: cut along chains, filled with triangles.

use std::collections::BTreeSet;

use earcut::Earcut;

use super::boxes::Extents;
use super::clip::fan;
use super::{Point, add_scaled, cross, dot, norm, sub};

/// Corners in counter-clockwise order.
pub type Polygon = Vec<Point>;

/// Twice the signed area of a triangle.
fn doubled_area(a: &Point, b: &Point, c: &Point) -> f64 {
    cross(&sub(b, a), &sub(c, a))[2]
}

/// Area [m²], negative if it runs clockwise.
pub fn area(polygon: &[Point]) -> f64 {
    (2..polygon.len())
        .map(|i| 0.5 * doubled_area(&polygon[0], &polygon[i - 1], &polygon[i]))
        .sum()
}

/// Area of a flat polygon in space [m²].
pub fn space_area(polygon: &[Point]) -> f64 {
    let sum = (2..polygon.len()).fold([0.0; 3], |sum, i| {
        let (p, q) = (
            sub(&polygon[i - 1], &polygon[0]),
            sub(&polygon[i], &polygon[0]),
        );
        add_scaled(&sum, 0.5, &cross(&p, &q))
    });
    norm(&sum)
}

/// The point of the segment p q nearest to x [m].
pub fn segment_foot(x: &Point, p: &Point, q: &Point) -> Point {
    let d = sub(q, p);
    let squared = dot(&d, &d);
    let t = if squared > 0.0 {
        (dot(&sub(x, p), &d) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    add_scaled(p, t, &d)
}

/// Distance of a point from the segment p q [m].
pub fn segment_distance(x: &Point, p: &Point, q: &Point) -> f64 {
    norm(&sub(x, &segment_foot(x, p, q)))
}

/// Numbers of the points of a polyline between which it is straight, give or take `slack` [m] (D. H. Douglas & T. K. Peucker,
/// Cartographica 10 (1973) 112).
pub fn bends(points: &[Point], slack: f64) -> Vec<usize> {
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut kept = BTreeSet::from([0, last]);
    let mut ranges = vec![(0, last)];
    while let Some((i, j)) = ranges.pop() {
        let off = |k: &usize| segment_distance(&points[*k], &points[i], &points[j]);
        let farthest = (i + 1..j).max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(k) = farthest.filter(|k| off(k) > slack) {
            kept.insert(k);
            ranges.extend([(i, k), (k, j)]);
        }
    }
    kept.into_iter().collect()
}

/// Where a segment p q crosses another, both more than a given part of their lengths from their ends: how far from p, in parts
/// of it, and the place.
pub fn crossed([p, q]: [&Point; 2], [a, b]: [&Point; 2], least: f64) -> Option<(f64, Point)> {
    let (d, e, from) = (sub(q, p), sub(b, a), sub(a, p));
    let turn = cross(&d, &e)[2];
    let [t, s] = [&e, &d].map(|v| cross(&from, v)[2] / turn);
    let inside = |t: f64| t > least && t < 1.0 - least;
    (inside(t) && inside(s)).then(|| (t, add_scaled(p, t, &d)))
}

/// Distance of a point from the outline [m].
pub fn border_distance(polygon: &[Point], x: &Point) -> f64 {
    edges(polygon)
        .map(|(p, q)| segment_distance(x, &p, &q))
        .fold(f64::INFINITY, f64::min)
}

/// Edges, each from corner to corner.
pub fn edges(polygon: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    let count = polygon.len();
    (0..count).map(move |i| (polygon[i], polygon[(i + 1) % count]))
}

/// Whether a longer part of a segment p q than `least` lies in a convex counter-clockwise polygon or no farther than `slack` from
/// it [m].
pub fn meets(polygon: &[Point], [p, q]: [&Point; 2], slack: f64, least: f64) -> bool {
    // The part of the segment inside all half planes (Cyrus and Beck 1978).
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (a, b) in edges(polygon) {
        let d = sub(&b, &a);
        let length = norm(&d);
        let [f, g] = [p, q].map(|x| cross(&d, &sub(x, &a))[2] / length + slack);
        if f < 0.0 && g < 0.0 {
            return false;
        }
        if f < 0.0 {
            from = from.max(f / (f - g));
        } else if g < 0.0 {
            to = to.min(f / (f - g));
        }
    }
    (to - from) * norm(&sub(q, p)) > least
}

/// Whether all places in a box lie to the right of the line a b by so much that none of them rounds to its left.
pub fn right_of([a, b]: [&Point; 2], [low, high]: &Extents) -> bool {
    let d = sub(b, a);
    let size = |v: &Point| v[0].abs() + v[1].abs();
    let level = |x: f64, y: f64| {
        let from = sub(&[x, y, 0.0], a);
        let rounding = 8.0 * f64::EPSILON * size(&d) * size(&from);
        cross(&d, &from)[2] + rounding
    };
    let corners = [
        (low[0], low[1]),
        (high[0], low[1]),
        (low[0], high[1]),
        (high[0], high[1]),
    ];
    corners.into_iter().all(|(x, y)| level(x, y) < 0.0)
}

/// True inside (crossing number); on the outline either.
pub fn contains(polygon: &[Point], x: &Point) -> bool {
    let mut inside = false;
    for (p, q) in edges(polygon) {
        if (p[1] > x[1]) != (q[1] > x[1])
            && x[0] < p[0] + (x[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
        {
            inside = !inside;
        }
    }
    inside
}

/// True if no corner turns right.
pub fn is_convex(polygon: &[Point]) -> bool {
    let count = polygon.len();
    let size = polygon
        .iter()
        .map(|x| norm(&sub(x, &polygon[0])))
        .fold(0.0, f64::max);
    (0..count).all(|i| {
        let (a, b) = (&polygon[(i + count - 1) % count], &polygon[(i + 1) % count]);
        // Corners in line turn by rounding only.
        doubled_area(a, &polygon[i], b) >= -1e-14 * size * norm(&sub(b, a))
    })
}

/// Convex quadrilaterals and triangles that fill a polygon: of a convex one from its first corner, ears of another.
pub fn pieces(polygon: &[Point]) -> Vec<Polygon> {
    if !is_convex(polygon) {
        return ears(polygon).iter().map(|t| t.to_vec()).collect();
    }
    let from_first = |k: usize| {
        let end = (k + 3).min(polygon.len());
        [&polygon[..1], &polygon[k..end]].concat()
    };
    let count = polygon.len().saturating_sub(1);
    (1..count).step_by(2).map(from_first).collect()
}

/// Triangles that fill a simple polygon.
fn ears(polygon: &[Point]) -> Vec<[Point; 3]> {
    let mut corners: Vec<usize> = Vec::new();
    let places = polygon.iter().map(|&[x, y, _]| [x, y]);
    Earcut::new().earcut(places, &[], &mut corners);
    let triangle = |own: &[usize]| {
        let [a, b, c] = [own[0], own[1], own[2]].map(|k| polygon[k]);
        let left = doubled_area(&a, &b, &c) >= 0.0;
        if left { [a, b, c] } else { [a, c, b] }
    };
    corners.chunks_exact(3).map(triangle).collect()
}

/// Triangles that fill a polygon: a fan of a convex one, ears of another. None of corners in line: what lies along one is not in it.
pub fn triangles(polygon: &[Point]) -> Vec<[Point; 3]> {
    if !is_convex(polygon) {
        return ears(polygon);
    }
    let mut found = fan(polygon);
    found.retain(|[a, b, c]| {
        let longest = norm(&sub(b, a)).max(norm(&sub(c, a)));
        doubled_area(a, b, c) > 1e-14 * longest * norm(&sub(c, b))
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_fill_a_part_that_is_not_convex() {
        let part = [
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.3, 1.0, 0.0],
            [0.2, 0.6, 0.0],
            [0.8, 0.5, 0.0],
            [0.3, 0.0, 0.0],
        ];
        assert!(contains(&part, &[0.9, 0.5, 0.0]) && !contains(&part, &[0.1, 0.5, 0.0]));
        let found = triangles(&part);
        let areas = found
            .iter()
            .map(|t| 0.5 * doubled_area(&t[0], &t[1], &t[2]));
        assert!(areas.clone().all(|area| area > 0.0));
        assert!((areas.sum::<f64>() - area(&part)).abs() < 1e-15);
    }
}
