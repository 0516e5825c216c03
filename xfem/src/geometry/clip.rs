//! Parts of convex polygons and tetrahedra on one side of a level, parts of half the size.

use super::{Point, add_scaled, bisect, cross, dot, sub};

/// Side of a crack: +1 (side 1) or −1.
pub type Side = f64;

/// A level that is 0 exactly if it is no larger than a tolerance.
pub fn snapped(level: f64, tolerance: f64) -> f64 {
    if level.abs() <= tolerance { 0.0 } else { level }
}

/// Rounding of coordinates in the distance of a place from a plane [m]: far from the origin a cut closer than
/// this to a corner is one through it, and what two cuts leave between them is nothing.
pub fn rounding<'a>(corners: impl IntoIterator<Item = &'a Point>) -> f64 {
    let all = corners.into_iter().flatten();
    8.0 * f64::EPSILON * all.fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Crossing of an edge: x on the edge from `p` (φ = `f`) to `q` (φ = `g`) with φ = 0, for f g < 0.
pub fn crossing(p: &Point, f: f64, q: &Point, g: f64) -> Point {
    // From the end with the smaller |φ|: the crossing then keeps its distance to that end in full relative accuracy.
    if f.abs() <= g.abs() {
        add_scaled(p, f / (f - g), &sub(q, p))
    } else {
        add_scaled(q, g / (g - f), &sub(p, q))
    }
}

/// The same for a level that is not linear, by bisection.
pub fn bent_crossing(p: &Point, f: f64, q: &Point, level: impl Fn(&Point) -> f64) -> Point {
    let d = sub(q, p);
    let same = |t: f64| level(&add_scaled(p, t, &d)) * f > 0.0;
    add_scaled(p, bisect(0.0, 1.0, same), &d)
}

/// The part of a convex polygon with given levels of its corners on one side of 0, in cyclic order; `crossing(i, j)`: the
/// corner on the edge from i to j.
pub fn clip_with<T: Copy>(
    corners: &[T],
    levels: &[f64],
    side: Side,
    mut crossing: impl FnMut(usize, usize) -> T,
) -> Vec<T> {
    let mut part = Vec::with_capacity(corners.len() + 1);
    for (i, corner) in corners.iter().enumerate() {
        let j = (i + 1) % corners.len();
        if levels[i] * side >= 0.0 {
            part.push(*corner);
        }
        if levels[i] * levels[j] < 0.0 {
            part.push(crossing(i, j));
        }
    }
    part
}

/// The same for a level that is linear along the edges.
pub fn clip(polygon: &[Point], levels: &[f64], side: Side) -> Vec<Point> {
    clip_with(polygon, levels, side, |i, j| {
        crossing(&polygon[i], levels[i], &polygon[j], levels[j])
    })
}

/// Triangles (v0, v_i, v_{i+1}) of a convex polygon.
pub fn fan(polygon: &[Point]) -> Vec<[Point; 3]> {
    (2..polygon.len())
        .map(|i| [polygon[0], polygon[i - 1], polygon[i]])
        .collect()
}

/// Appends the part of a tetrahedron on one side, as tetrahedra.
pub fn clip_tetrahedron(t: &[Point; 4], phi: &[f64; 4], side: Side, parts: &mut Vec<[Point; 4]>) {
    let (inside, outside): (Vec<usize>, Vec<usize>) = (0..4).partition(|&i| phi[i] * side >= 0.0);
    if !inside.iter().any(|&i| phi[i] != 0.0) {
        return; // at most a face on the crack
    }
    let at = |i: usize, j: usize| {
        if phi[i] == 0.0 {
            t[i]
        } else {
            crossing(&t[i], phi[i], &t[j], phi[j])
        }
    };
    // A prism with triangles (a0 a1 a2) and (b0 b1 b2) as three tetrahedra.
    let mut prism = |a: [Point; 3], b: [Point; 3]| {
        parts.push([a[0], a[1], a[2], b[2]]);
        parts.push([a[0], a[1], b[1], b[2]]);
        parts.push([a[0], b[0], b[1], b[2]]);
    };
    match (inside.as_slice(), outside.as_slice()) {
        (_, []) => parts.push(*t),
        (&[i], &[a, b, c]) => parts.push([t[i], at(i, a), at(i, b), at(i, c)]),
        (&[i, j], &[a, b]) => prism([t[i], at(i, a), at(i, b)], [t[j], at(j, a), at(j, b)]),
        (&[i, j, k], &[a]) => prism([t[i], t[j], t[k]], [at(i, a), at(j, a), at(k, a)]),
        _ => {} // four outside
    }
}

/// The four triangles of edge midpoints.
pub fn halve_triangle(t: &[Point; 3]) -> [[Point; 3]; 4] {
    let [a, b, c] = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| middle(&t[i], &t[j]));
    [[t[0], a, c], [a, t[1], b], [c, b, t[2]], [a, b, c]]
}

/// The eight tetrahedra of edge midpoints.
pub fn halve_tetrahedron(t: &[Point; 4]) -> [[Point; 4]; 8] {
    let mid = |i: usize, j: usize| middle(&t[i], &t[j]);
    let (m01, m02, m03) = (mid(0, 1), mid(0, 2), mid(0, 3));
    let (m12, m13, m23) = (mid(1, 2), mid(1, 3), mid(2, 3));
    [
        [t[0], m01, m02, m03],
        [t[1], m01, m12, m13],
        [t[2], m02, m12, m23],
        [t[3], m03, m13, m23],
        [m01, m23, m02, m03],
        [m01, m23, m03, m13],
        [m01, m23, m13, m12],
        [m01, m23, m12, m02],
    ]
}

/// Middle of a segment.
fn middle(p: &Point, q: &Point) -> Point {
    add_scaled(p, 0.5, &sub(q, p))
}

/// Unsigned volume of a tetrahedron [m³].
pub fn tetrahedron_volume(t: &[Point; 4]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|i| sub(&t[i], &t[0]));
    dot(&a, &cross(&b, &c)).abs() / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_cut_keeps_one_tetrahedron_per_corner() {
        let t = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for eps in [1e-1, 1e-6, 1e-12] {
            let phi = [-eps, 1.0 - eps, 1.0 - eps, 1.0 - eps];
            let mut parts = Vec::new();
            clip_tetrahedron(&t, &phi, -1.0, &mut parts);
            assert_eq!(parts.len(), 1);
            let volume = tetrahedron_volume(&parts[0]);
            assert!((volume / (eps.powi(3) / 6.0) - 1.0).abs() < 1e-10, "{eps}");
        }
    }
}
