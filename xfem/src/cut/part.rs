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

/// Number of a part of a cell, see [`super::partition`]; 0 in a cell that no crack cuts.
pub type Region = usize;

/// A region of a cell.
pub type Place = (usize, Region);

/// A part of a cell.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// Sides of the cracks that divide it from other parts: in 2D first of those that it borders on; each in crack order.
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

    /// Corners of its outline or tetrahedra.
    pub fn corners(&self) -> impl Iterator<Item = &Point> {
        self.polygon.iter().chain(self.tetrahedra.iter().flatten())
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

/// A piece of a crack between two regions, of one cell or of two.
#[derive(Debug, Clone)]
pub struct Face {
    /// Crack.
    pub crack: usize,
    /// Two corners along the crack (2D), or a convex polygon in cyclic order.
    pub corners: Vec<FaceCorner>,
    /// Places on side 1 and side 2.
    pub sides: [Place; 2],
    /// Frame n, a, b of the piece: a bent 2D crack is a chain of chords.
    pub frame: [Point; 3],
}

impl Face {
    /// Mean of its corners [m].
    pub fn middle(&self) -> Point {
        mean(self.corners.iter().map(|corner| &corner.0))
    }
}
