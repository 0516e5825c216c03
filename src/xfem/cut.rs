//! Cutting cells: the crack inside a cell, sub-cells on both sides, their quadrature in space.
//!
//! Sub-cells are built in physical space: a straight crack is curved in the reference cell of a distorted quad, and
//! rules built there miss it (patch error 4e-2 against 1e-5).

use crate::fem::cell::CellKind;
use crate::fem::quadrature::{
    WeightedPoint, tetrahedron, tip_triangle, triangle, triangle_collapsed,
};
use crate::fem::{Point, add_scaled, cross, dot, norm, sub};

use super::rational::rational_points;

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

/// True if a cell has nodes strictly on both sides.
pub fn is_split(kind: CellKind, phi: &[f64]) -> bool {
    let phi = &phi[..kind.nodes()];
    phi.iter().any(|&f| f > 0.0) && phi.iter().any(|&f| f < 0.0)
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

/// The crack inside a split cell: a segment (2D, two points) or a convex polygon in cyclic order (3D).
///
/// Each vertex lies on a cell edge or at a node: given as the local nodes it lies between (equal at a node).
pub fn facet(kind: CellKind, corners: &[Point], phi: &[f64]) -> Vec<(Point, [usize; 2])> {
    let mut vertices: Vec<(Point, [usize; 2])> = Vec::new();
    for i in 0..kind.nodes() {
        if phi[i] == 0.0 {
            vertices.push((corners[i], [i, i]));
        }
    }
    for &[i, j] in kind.edges() {
        if phi[i] * phi[j] < 0.0 {
            vertices.push((crossing(&corners[i], phi[i], &corners[j], phi[j]), [i, j]));
        }
    }
    if kind == CellKind::Hex8 && vertices.len() > 2 {
        // Sort around the mean, in the plane of the polygon.
        let mut centre = [0.0; 3];
        for (p, _) in &vertices {
            centre = add_scaled(&centre, 1.0 / vertices.len() as f64, p);
        }
        let e1 = sub(&vertices[0].0, &centre);
        let mut normal = [0.0; 3];
        for (p, _) in &vertices[1..] {
            let candidate = cross(&e1, &sub(p, &centre));
            if norm(&candidate) > norm(&normal) {
                normal = candidate;
            }
        }
        let e2 = cross(&normal, &e1);
        let (l1, l2) = (norm(&e1), norm(&e2));
        let angle = |p: &Point| {
            let d = sub(p, &centre);
            (dot(&d, &e2) / l2).atan2(dot(&d, &e1) / l1)
        };
        vertices.sort_by(|p, q| angle(&p.0).total_cmp(&angle(&q.0)));
    }
    vertices
}

/// The six tetrahedra of a hex around its diagonal 0–6; exact for cells with planar faces.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 2, 6],
    [0, 2, 3, 6],
    [0, 3, 7, 6],
    [0, 7, 4, 6],
    [0, 4, 5, 6],
    [0, 5, 1, 6],
];

/// Simplices that fill one side of a split cell.
#[derive(Debug, Clone, Default)]
pub struct SubCells {
    /// 2D.
    pub triangles: Vec<[Point; 3]>,
    /// 3D.
    pub tetrahedra: Vec<[Point; 4]>,
}

/// The six tetrahedra of a hexahedron.
pub fn tetrahedra_of(corners: &[Point]) -> Vec<[Point; 4]> {
    TETRAHEDRA.map(|t| t.map(|i| corners[i])).to_vec()
}

impl SubCells {
    /// Sub-cells of one side.
    pub fn of(kind: CellKind, corners: &[Point], phi: &[f64], side: Side) -> Self {
        let mut cells = SubCells::default();
        match kind {
            CellKind::Quad4 => {
                let part = polygon_part(&corners[..4], &phi[..4], side);
                cells.triangles = fan(&part);
            }
            CellKind::Hex8 => {
                for t in TETRAHEDRA {
                    clip_tetrahedron(
                        &t.map(|i| corners[i]),
                        &t.map(|i| phi[i]),
                        side,
                        &mut cells.tetrahedra,
                    );
                }
            }
        }
        cells
    }

    /// Degree-4 (2D) or degree-5 (3D) points of all sub-cells.
    pub fn points(&self) -> Vec<WeightedPoint> {
        let flat = self.triangles.iter().flat_map(triangle);
        let solid = self.tetrahedra.iter().flat_map(tetrahedron);
        flat.chain(solid).collect()
    }

    /// Points for the non-affine map of the cell with these corners, whose integrand is not polynomial.
    pub fn fine_points(&self, kind: CellKind, corners: &[Point]) -> Vec<WeightedPoint> {
        let mut points = Vec::new();
        for t in &self.triangles {
            rational_points(kind, corners, t, &mut points);
        }
        let solid = self.tetrahedra.iter().flat_map(|t| {
            // Each tetrahedron in eight by its edge midpoints: the error of the degree-5 rule falls by 2⁻⁶.
            halve_tetrahedron(t)
                .into_iter()
                .flat_map(|t| tetrahedron(&t))
        });
        points.extend(solid);
        points
    }
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

/// Points of a counter-clockwise polygon with a tip in its closure: the fan of [`tip_triangle`]s, negative where the
/// outline turns its back on the tip.
pub fn tip_points(part: &[Point], tip: &Point, affine: bool) -> Vec<WeightedPoint> {
    let mut points = Vec::new();
    for i in 0..part.len() {
        let (a, b) = (&part[i], &part[(i + 1) % part.len()]);
        let sign = 1.0f64.copysign(cross(&sub(a, tip), &sub(b, tip))[2]);
        let triangle = tip_triangle(tip, a, b, affine).into_iter();
        points.extend(triangle.map(|p| WeightedPoint {
            weight: sign * p.weight,
            ..p
        }));
    }
    points
}

/// Points of triangles that carry branch functions of tips outside of them: halved until no tip is closer than the
/// triangle's diameter, then a rule that is exact to 1e-9 for functions with singularities at that distance.
pub fn graded_points(triangles: &[[Point; 3]], tips: &[Point]) -> Vec<WeightedPoint> {
    /// Points per direction: relative error (3 + √8)^−2n = 2e-11.
    const POINTS: usize = 7;
    /// Halvings; a tip 1e-9 edges away needs 30.
    const DEPTH: usize = 40;
    let mut stack: Vec<([Point; 3], usize)> = triangles.iter().map(|t| (*t, 0)).collect();
    let mut points = Vec::new();
    while let Some((t, depth)) = stack.pop() {
        let edge = |i: usize| norm(&sub(&t[i], &t[(i + 1) % 3]));
        let diameter = edge(0).max(edge(1)).max(edge(2));
        let near = tips
            .iter()
            .any(|tip| (0..3).any(|i| segment_distance(tip, &t[i], &t[(i + 1) % 3]) < diameter));
        if !near || depth == DEPTH {
            points.extend(triangle_collapsed(&t, POINTS));
            continue;
        }
        let mid = |i: usize, j: usize| add_scaled(&t[i], 0.5, &sub(&t[j], &t[i]));
        let (a, b, c) = (mid(0, 1), mid(1, 2), mid(2, 0));
        for part in [[t[0], a, c], [a, t[1], b], [c, b, t[2]], [a, b, c]] {
            stack.push((part, depth + 1));
        }
    }
    points
}

/// Distance of a point from the segment p q [m].
fn segment_distance(x: &Point, p: &Point, q: &Point) -> f64 {
    let d = sub(q, p);
    let t = (dot(&sub(x, p), &d) / dot(&d, &d)).clamp(0.0, 1.0);
    norm(&sub(x, &add_scaled(p, t, &d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::quadrature::{gauss_cell, tetrahedron_volume};
    use proptest::prelude::*;

    /// Unit parallelepiped sheared a little.
    fn cell(kind: CellKind) -> Vec<Point> {
        (0..kind.nodes())
            .map(|i| {
                let c = kind.corner(i);
                [
                    c[0] + 0.3 * c[1],
                    c[1] - 0.1 * c[0],
                    c[2] + if kind == CellKind::Hex8 {
                        0.2 * c[0]
                    } else {
                        0.0
                    },
                ]
            })
            .collect()
    }

    fn measure(points: &[WeightedPoint]) -> f64 {
        points.iter().map(|p| p.weight).sum()
    }

    proptest! {
        #[test]
        fn sub_cells_fill_the_cell_and_integrate_exactly_on_both_sides(
            normal in prop::array::uniform3(-1.0f64..1.0), offset in -0.9f64..0.9
        ) {
            prop_assume!(norm(&normal) > 0.1);
            for kind in [CellKind::Quad4, CellKind::Hex8] {
                let corners = cell(kind);
                let mut n = normal;
                if kind == CellKind::Quad4 { n[2] = 0.0; }
                prop_assume!(norm(&n) > 0.1);
                let phi: Vec<f64> = corners.iter().map(|x| dot(&n, x) - offset * norm(&n)).collect();
                if !is_split(kind, &phi) { continue; }
                let f = |x: &Point| 1.0 + x[0] * x[1] + x[2].powi(2) * x[0] + x[1].powi(4);
                let parts = [1.0, -1.0].map(|side| SubCells::of(kind, &corners, &phi, side));
                let whole: f64 = gauss_cell(kind.dim(), 4).iter().map(|(xi, w)| {
                    w * kind.gradients(&corners, xi).1 * f(&kind.map(&corners, xi))
                }).sum();
                let volume: f64 = gauss_cell(kind.dim(), 2).iter().map(|(xi, w)| w * kind.gradients(&corners, xi).1).sum();
                let sum: f64 = parts.iter().map(|p| measure(&p.points())).sum();
                prop_assert!((sum - volume).abs() < 1e-13 * volume);
                for fine in [false, true] {
                    let rule = |part: &SubCells| if fine { part.fine_points(kind, &corners) } else { part.points() };
                    let total: f64 = parts.iter().flat_map(rule).map(|p| p.weight * f(&p.x)).sum();
                    prop_assert!((total - whole).abs() < 1e-12 * volume);
                }
                for (part, side) in parts.iter().zip([1.0, -1.0]) {
                    for p in part.points() {
                        prop_assert!((dot(&n, &p.x) - offset * norm(&n)) * side > -1e-12);
                    }
                }
            }
        }
    }

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

    #[test]
    fn the_facet_of_a_diagonal_cut_joins_two_nodes_and_of_an_oblique_plane_is_a_hexagon() {
        let corners: Vec<Point> = (0..4).map(|i| CellKind::Quad4.corner(i)).collect();
        let phi: Vec<f64> = corners.iter().map(|x| x[1] - x[0]).collect();
        let segment = facet(CellKind::Quad4, &corners, &phi);
        assert_eq!(
            segment.iter().map(|v| v.1).collect::<Vec<_>>(),
            [[0, 0], [2, 2]]
        );
        let corners: Vec<Point> = (0..8).map(|i| CellKind::Hex8.corner(i)).collect();
        let phi: Vec<f64> = corners.iter().map(|x| x[0] + x[1] + x[2]).collect();
        let polygon = facet(CellKind::Hex8, &corners, &phi);
        assert_eq!(polygon.len(), 6);
        let area: f64 = fan(&polygon.iter().map(|v| v.0).collect::<Vec<_>>())
            .iter()
            .map(|t| 0.5 * norm(&cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0]))))
            .sum();
        assert!((area - 3.0 * 3.0f64.sqrt()).abs() < 1e-12); // regular hexagon of side √2
    }

    #[test]
    fn graded_points_integrate_a_near_singularity() {
        let t = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for distance in [1e-1, 1e-3, 1e-6] {
            let tip = [0.4, -distance, 0.0];
            let points = graded_points(&[t], &[tip]);
            // ∫ 1/r over the triangle as the signed fan of its edges: Σ h (asinh(s1/h) − asinh(s0/h))
            let exact: f64 = (0..3)
                .map(|i| {
                    let (a, b) = (t[i], t[(i + 1) % 3]);
                    let along = crate::fem::unit(&sub(&b, &a));
                    let (s0, s1) = (dot(&sub(&a, &tip), &along), dot(&sub(&b, &tip), &along));
                    let h = cross(&sub(&a, &tip), &along)[2];
                    h * ((s1 / h.abs()).asinh() - (s0 / h.abs()).asinh())
                })
                .sum();
            let found: f64 = points
                .iter()
                .map(|p| p.weight / norm(&sub(&p.x, &tip)))
                .sum();
            assert!(
                (found / exact - 1.0).abs() < 1e-8,
                "{distance}: {found} {exact}"
            );
        }
    }
}
