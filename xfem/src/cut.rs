//! Cutting cells: the crack inside a cell, sub-cells on both sides, their quadrature in space.
//!
//! Sub-cells are built in physical space: a straight crack is curved in the reference cell of a distorted quad, and
//! rules built there miss it (patch error 4e-2 against 1e-5).

pub mod crack;
pub mod partition;
pub mod placement;

use crate::geometry::clip::{crossing, halve_tetrahedron};
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub};
use crate::mesh::cell::CellKind;
use crate::quadrature::rational::rational_points;
use crate::quadrature::{WeightedPoint, tetrahedron, triangle};

/// True if a cell has nodes strictly on both sides.
pub fn is_split(kind: CellKind, phi: &[f64]) -> bool {
    let phi = &phi[..kind.nodes()];
    phi.iter().any(|&f| f > 0.0) && phi.iter().any(|&f| f < 0.0)
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

/// Simplices that fill one side of a split cell.
#[derive(Debug, Clone, Default)]
pub struct SubCells {
    /// 2D.
    pub triangles: Vec<[Point; 3]>,
    /// 3D.
    pub tetrahedra: Vec<[Point; 4]>,
}

impl SubCells {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::clip::{
        Side, clip_tetrahedron, fan, polygon_part, tetrahedra_of, tetrahedron_volume,
    };
    use crate::quadrature::gauss_cell;
    use crate::quadrature::graded::graded_points;
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

    /// Sub-cells of one side.
    fn sub_cells(kind: CellKind, corners: &[Point], phi: &[f64], side: Side) -> SubCells {
        let mut cells = SubCells::default();
        match kind {
            CellKind::Quad4 => cells.triangles = fan(&polygon_part(corners, phi, side)),
            CellKind::Hex8 => {
                for (t, phi) in tetrahedra_of(corners).iter().zip(tetrahedra_of(phi)) {
                    clip_tetrahedron(t, &phi, side, &mut cells.tetrahedra);
                }
            }
        }
        cells
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
                let parts = [1.0, -1.0].map(|side| sub_cells(kind, &corners, &phi, side));
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
                    let along = crate::geometry::unit(&sub(&b, &a));
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
