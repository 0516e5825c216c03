//! Simple polygons in the plane: cut along chains, filled with triangles.

use std::collections::BTreeSet;

use super::boxes::Extents;
use super::clip::fan;
use super::ears::ears;
use super::{Point, add_scaled, cross, dot, norm, sub};

/// Corners in counter-clockwise order.
pub type Polygon = Vec<Point>;

/// Twice the signed area of a triangle.
pub(super) fn doubled_area(a: &Point, b: &Point, c: &Point) -> f64 {
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

/// Cuts a polygon along a chain whose ends lie on its outline: the parts to the left and to the right of the chain.
///
/// An end that coincides with a corner is that corner, otherwise it becomes one on the nearest edge. `None` if a part
/// would have fewer than three corners.
pub fn split(polygon: &[Point], chain: &[Point]) -> Option<[Polygon; 2]> {
    let mut outline = polygon.to_vec();
    let (first, last) = (chain.first()?, chain.last()?);
    place(&mut outline, first);
    place(&mut outline, last);
    let position = |x: &Point| outline.iter().position(|c| c == x);
    let (from, to) = (position(first)?, position(last)?);
    if from == to {
        return None;
    }
    let walk = |start: usize, end: usize| {
        let count = outline.len();
        let steps = (end + count - start) % count;
        (1..steps)
            .map(move |k| (start + k) % count)
            .map(|i| outline[i])
            .collect::<Vec<_>>()
    };
    // Corners off the chain first: collapsed rules crowd at the first corner, where nothing should be singular.
    let mut left = walk(to, from);
    left.extend(chain);
    let mut right = walk(from, to);
    right.extend(chain.iter().rev());
    (left.len() > 2 && right.len() > 2).then_some([left, right])
}

/// Makes a point of the outline a corner.
fn place(outline: &mut Polygon, x: &Point) {
    if outline.contains(x) {
        return;
    }
    let nearest = (0..outline.len()).min_by(|&i, &j| {
        let distance =
            |k: usize| segment_distance(x, &outline[k], &outline[(k + 1) % outline.len()]);
        distance(i).total_cmp(&distance(j))
    });
    if let Some(i) = nearest {
        outline.insert(i + 1, *x);
    }
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

/// Triangles that fill a polygon: a fan of a convex one, ears of another.
pub fn triangles(polygon: &[Point]) -> Vec<[Point; 3]> {
    if is_convex(polygon) {
        return fan(polygon);
    }
    ears(polygon)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Polygon {
        vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ]
    }

    fn filled(polygon: &[Point]) -> f64 {
        triangles(polygon)
            .iter()
            .map(|t| 0.5 * doubled_area(&t[0], &t[1], &t[2]))
            .sum()
    }

    #[test]
    fn a_kinked_chain_leaves_two_parts_that_triangles_fill() {
        let chain = [
            [0.3, 0.0, 0.0],
            [0.8, 0.5, 0.0],
            [0.2, 0.6, 0.0],
            [0.3, 1.0, 0.0],
        ];
        let [left, right] = split(&square(), &chain).unwrap();
        assert!((area(&left) + area(&right) - 1.0).abs() < 1e-15);
        assert!(contains(&left, &[0.1, 0.5, 0.0]) && contains(&right, &[0.9, 0.5, 0.0]));
        for part in [left, right] {
            assert!((filled(&part) - area(&part)).abs() < 1e-15);
            let turns = |t: &[Point; 3]| doubled_area(&t[0], &t[1], &t[2]) > 0.0;
            assert!(triangles(&part).iter().all(turns));
        }
    }

    #[test]
    fn chains_from_corner_to_corner_and_slivers_keep_their_area() {
        let [upper, lower] = split(&square(), &[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]).unwrap();
        assert_eq!((upper.len(), lower.len()), (3, 3));
        let eps = 1e-12;
        let [left, right] = split(&square(), &[[eps, 0.0, 0.0], [0.0, eps, 0.0]]).unwrap();
        let sliver = left.len().min(right.len());
        assert_eq!(sliver, 3);
        let small = if left.len() == 3 { left } else { right };
        assert!((area(&small) / (0.5 * eps * eps) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_chain_that_touches_nothing_new_is_refused() {
        assert!(split(&square(), &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]).is_none());
    }
}
