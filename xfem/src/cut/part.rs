//! Parts of a cell between cracks, their quadrature, and the crack faces between them.
//!
//! Sub-cells are built in physical space: a straight crack is curved in the reference cell of a distorted quad, and
//! rules built there miss it (patch error 4e-2 against 1e-5).

use crate::geometry::clip::{Side, halve_tetrahedron, tetrahedron_volume};
use crate::geometry::polygon::{self, Polygon};
use crate::geometry::{Point, cross, mean, norm, sub};
use crate::mesh::cell::CellMap;
use crate::quadrature::rational::rational_points;
use crate::quadrature::{WeightedPoint, tetrahedron, triangle};

/// A part of a cell.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// Sides of the cracks that divide it from other parts, in crack order.
    pub sides: Vec<(usize, Side)>,
    /// 2D: its outline, counter-clockwise.
    pub polygon: Polygon,
    /// 3D: tetrahedra that fill it.
    pub tetrahedra: Vec<[Point; 4]>,
}

impl Part {
    /// A whole cell.
    pub fn whole(map: &CellMap) -> Self {
        let mut part = Part::default();
        if map.kind.dim() == 2 {
            part.polygon = map.to_vec();
        } else {
            let tetrahedra = map.kind.tetrahedra().iter();
            part.tetrahedra = tetrahedra.map(|t| t.map(|i| map[i])).collect();
        }
        part
    }

    /// Side of a crack, if the crack cuts the cell here.
    pub fn side(&self, crack: usize) -> Option<Side> {
        self.sides.iter().find(|s| s.0 == crack).map(|s| s.1)
    }

    /// 2D: triangles that fill it.
    pub fn triangles(&self) -> Vec<[Point; 3]> {
        polygon::triangles(&self.polygon)
    }

    /// Area [m²] or volume [m³].
    pub fn measure(&self) -> f64 {
        let solid: f64 = self.tetrahedra.iter().map(tetrahedron_volume).sum();
        solid + polygon::area(&self.polygon).max(0.0)
    }

    /// A point well inside: the centroid of the largest simplex.
    pub fn middle(&self) -> Point {
        let flat = self.triangles().into_iter().map(|t| {
            let size = norm(&cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0])));
            (size, mean(&t))
        });
        let solid = self.tetrahedra.iter();
        let solid = solid.map(|t| (tetrahedron_volume(t), mean(t)));
        flat.chain(solid)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map_or([f64::NAN; 3], |found| found.1)
    }

    /// Degree-4 (2D) or degree-5 (3D) points.
    pub fn points(&self) -> Vec<WeightedPoint> {
        let flat = self.triangles();
        let solid = self.tetrahedra.iter().flat_map(tetrahedron);
        flat.iter().flat_map(triangle).chain(solid).collect()
    }

    /// Points for the non-affine map of its cell, whose integrand is not polynomial.
    pub fn fine_points(&self, map: &CellMap) -> Vec<WeightedPoint> {
        let mut points = Vec::new();
        for t in self.triangles() {
            rational_points(map, &t, &mut points);
        }
        // Each tetrahedron in eight by its edge midpoints: the error of the degree-5 rule falls by 2⁻⁶.
        let solid = self.tetrahedra.iter().flat_map(halve_tetrahedron);
        points.extend(solid.flat_map(|t| tetrahedron(&t)));
        points
    }
}

/// A corner of a face: position, and the local nodes of the mesh edge it lies on (equal at a node; `None` inside the cell).
pub type FaceCorner = (Point, Option<[usize; 2]>);

/// A piece of a crack between two parts.
#[derive(Debug, Clone)]
pub struct Face {
    /// Crack.
    pub crack: usize,
    /// Two corners along the crack (2D), or a convex polygon in cyclic order.
    pub corners: Vec<FaceCorner>,
    /// Parts on side 1 and side 2.
    pub parts: [usize; 2],
}

impl Face {
    /// Mean of its corners [m].
    pub fn middle(&self) -> Point {
        mean(self.corners.iter().map(|corner| &corner.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::is_split;
    use crate::geometry::clip::{clip, clip_tetrahedron};
    use crate::geometry::dot;
    use crate::mesh::cell::CellKind;
    use crate::quadrature::{gauss_map, measure};
    use proptest::prelude::*;

    /// Unit parallelepiped sheared a little.
    fn cell(kind: CellKind) -> CellMap {
        CellMap::new(kind, |i| {
            let [x, y, z] = kind.corner(i);
            let lift = if kind.dim() == 3 { 0.2 * x } else { 0.0 };
            [x + 0.3 * y, y - 0.1 * x, z + lift]
        })
    }

    /// The part of a cell on one side of a level.
    fn half(map: &CellMap, phi: &[f64], side: Side) -> Part {
        let mut part = Part::default();
        if map.kind.dim() == 2 {
            part.polygon = clip(map, phi, side);
        }
        for t in map.kind.tetrahedra() {
            let (corners, phi) = (t.map(|i| map[i]), t.map(|i| phi[i]));
            clip_tetrahedron(&corners, &phi, side, &mut part.tetrahedra);
        }
        part
    }

    proptest! {
        #[test]
        fn sub_cells_fill_the_cell_and_integrate_exactly_on_both_sides(
            normal in prop::array::uniform3(-1.0f64..1.0), offset in -0.9f64..0.9
        ) {
            prop_assume!(norm(&normal) > 0.1);
            for kind in [CellKind::Quad4, CellKind::Hex8] {
                let map = cell(kind);
                let mut n = normal;
                n[kind.dim()..].fill(0.0);
                prop_assume!(norm(&n) > 0.1);
                let phi: Vec<f64> = map.iter().map(|x| dot(&n, x) - offset * norm(&n)).collect();
                if !is_split(&phi) { continue; }
                let f = |x: &Point| 1.0 + x[0] * x[1] + x[2].powi(2) * x[0] + x[1].powi(4);
                let parts = [1.0, -1.0].map(|side| half(&map, &phi, side));
                let whole: f64 = gauss_map(&map, 4).map(|(_, p)| p.weight * f(&p.x)).sum();
                let volume = measure(&map);
                let sum: f64 = parts.iter().flat_map(Part::points).map(|p| p.weight).sum();
                prop_assert!((sum - volume).abs() < 1e-13 * volume);
                for fine in [false, true] {
                    let rule = |part: &Part| if fine { part.fine_points(&map) } else { part.points() };
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
}
