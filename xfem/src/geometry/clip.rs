//! Parts of convex polygons and tetrahedra on one side of a level.

use super::{Point, add_scaled, cross, dot, sub};

/// Side of a crack: +1 (side 1) or −1.
pub type Side = f64;

/// Crossing of an edge: x on the edge from `p` (φ = `f`) to `q` (φ = `g`) with φ = 0, for f g < 0.
pub fn crossing(p: &Point, f: f64, q: &Point, g: f64) -> Point {
    // From the end with the smaller |φ|: the crossing then keeps its distance to that end in full relative accuracy.
    if f.abs() <= g.abs() {
        add_scaled(p, f / (f - g), &sub(q, p))
    } else {
        add_scaled(q, g / (g - f), &sub(p, q))
    }
}

/// Vertices of the part of a convex polygon on one side of φ = 0, in cyclic order, each with its φ.
pub fn clip(polygon: &[(Point, f64)], side: Side) -> Vec<(Point, f64)> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (i, &(p, f)) in polygon.iter().enumerate() {
        let (q, g) = polygon[(i + 1) % polygon.len()];
        if f * side >= 0.0 {
            part.push((p, f));
        }
        if f * g < 0.0 {
            part.push((crossing(&p, f, &q, g), 0.0));
        }
    }
    part
}

/// Part of a facet or 2D cell on one side of the crack; empty where only its border touches that side.
pub fn polygon_part(vertices: &[Point], phi: &[f64], side: Side) -> Vec<Point> {
    let polygon: Vec<(Point, f64)> = vertices.iter().copied().zip(phi.iter().copied()).collect();
    if !phi.iter().any(|&f| f * side > 0.0) {
        return Vec::new();
    }
    clip(&polygon, side).into_iter().map(|(p, _)| p).collect()
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

/// The eight tetrahedra of edge midpoints.
pub fn halve_tetrahedron(t: &[Point; 4]) -> Vec<[Point; 4]> {
    let mid = |i: usize, j: usize| add_scaled(&t[i], 0.5, &sub(&t[j], &t[i]));
    let (m01, m02, m03) = (mid(0, 1), mid(0, 2), mid(0, 3));
    let (m12, m13, m23) = (mid(1, 2), mid(1, 3), mid(2, 3));
    vec![
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

/// Unsigned volume of a tetrahedron [m³].
pub fn tetrahedron_volume(t: &[Point; 4]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|i| sub(&t[i], &t[0]));
    dot(&a, &cross(&b, &c)).abs() / 6.0
}

/// The six tetrahedra of a hex around its diagonal 0–6.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 2, 6],
    [0, 2, 3, 6],
    [0, 3, 7, 6],
    [0, 7, 4, 6],
    [0, 4, 5, 6],
    [0, 5, 1, 6],
];

/// The six tetrahedra of a hexahedron, as what is given for its corners; exact for cells with planar faces.
pub fn tetrahedra_of<T: Copy>(corners: &[T]) -> [[T; 4]; 6] {
    TETRAHEDRA.map(|t| t.map(|i| corners[i]))
}
