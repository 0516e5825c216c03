//! A cell cut by one or more cracks: its parts, each on known sides of the cracks, and the crack faces between them.
//!
//! ```text
//!   one crack      parts { + }, { − }                       crossing    { + + }, { + − }, { − + }, { − − }
//!   branching      { 1+ 2+ }, { 1+ 2− }, { 1− }             the second crack ends on the first
//! ```
//!
//! Cracks are taken in their order: each divides those parts of the cell on which it lives. In 2D parts are simple polygons
//! cut along chains of segments, in 3D tetrahedra clipped by planes; nothing is rounded to a grid, slivers keep their
//! relative size.

use crate::geometry::clip::{Side, clip_tetrahedron, crossing, tetrahedra_of};
use crate::geometry::polygon::{self, Polygon};
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub};
use crate::mesh::Mesh;
use crate::mesh::cell::CellKind;

use super::SubCells;
use super::crack::{Crack, Geometry};

/// A corner of a face: position, and the local nodes of the mesh edge it lies on (equal at a node; `None` inside the cell).
pub type FaceCorner = (Point, Option<[usize; 2]>);

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
    /// Side of a crack, if the crack cuts the cell here.
    pub fn side(&self, crack: usize) -> Option<Side> {
        self.sides.iter().find(|s| s.0 == crack).map(|s| s.1)
    }

    /// A point well inside: the centroid of the largest simplex.
    pub fn middle(&self) -> Point {
        let mean = |corners: &[Point]| {
            corners.iter().fold([0.0; 3], |sum, x| {
                add_scaled(&sum, 1.0 / corners.len() as f64, x)
            })
        };
        let triangles = polygon::triangles(&self.polygon);
        let flat = triangles.iter().map(|t| {
            let size = norm(&cross(&sub(&t[1], &t[0]), &sub(&t[2], &t[0])));
            (size, mean(t))
        });
        let solid = self.tetrahedra.iter().map(|t| {
            let size = crate::geometry::clip::tetrahedron_volume(t);
            (size, mean(t))
        });
        flat.chain(solid)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map_or([f64::NAN; 3], |found| found.1)
    }

    /// Simplices that fill it.
    pub fn sub_cells(&self) -> SubCells {
        SubCells {
            triangles: polygon::triangles(&self.polygon),
            tetrahedra: self.tetrahedra.clone(),
        }
    }
}

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

/// A divided cell.
#[derive(Debug, Clone, Default)]
pub struct Partition {
    /// Parts.
    pub parts: Vec<Part>,
    /// Faces, crack by crack.
    pub faces: Vec<Face>,
}

/// Why a cell cannot be divided.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PartitionError {
    /// The crack bends within the cell more than its crossings with the edges can tell.
    #[error(
        "the crack crosses the edges of a cell {0} times: the mesh is too coarse for its bends"
    )]
    Crossings(usize),
    /// The pieces do not fit together.
    #[error("the cracks in a cell leave no clean parts")]
    Muddle,
}

impl Partition {
    /// Divides a cell by cracks (indices in rising order).
    pub fn new(
        mesh: &Mesh,
        cell: usize,
        cracks: &[Crack],
        inside: &[usize],
    ) -> Result<Self, PartitionError> {
        let corners = mesh.corners(cell);
        let corners = &corners[..mesh.kind.nodes()];
        let mut whole = Partition::whole(mesh.kind, corners);
        match mesh.kind {
            CellKind::Quad4 => {
                for &index in inside {
                    let phi = cracks[index].cell_phi(mesh, cell);
                    let chain = chain_in(mesh, corners, &phi, cracks, index)?;
                    whole.divide_flat(index, &cracks[index], &chain)?;
                }
            }
            CellKind::Hex8 => {
                for &index in inside {
                    let phi = cracks[index].cell_phi(mesh, cell);
                    whole.divide_solid(index, cracks, corners, &phi)?;
                }
            }
        }
        Ok(whole)
    }

    /// An undivided cell.
    pub fn whole(kind: CellKind, corners: &[Point]) -> Self {
        let (polygon, tetrahedra) = match kind {
            CellKind::Quad4 => (corners.to_vec(), Vec::new()),
            CellKind::Hex8 => (Vec::new(), tetrahedra_of(corners).to_vec()),
        };
        let part = Part {
            sides: Vec::new(),
            polygon,
            tetrahedra,
        };
        Partition {
            parts: vec![part],
            faces: Vec::new(),
        }
    }

    /// Cuts the polygon that a chain runs through; cuts the faces that its ends lie on.
    fn divide_flat(
        &mut self,
        index: usize,
        crack: &Crack,
        chain: &[FaceCorner],
    ) -> Result<(), PartitionError> {
        let points: Vec<Point> = chain.iter().map(|c| c.0).collect();
        let middle = add_scaled(&points[0], 0.5, &sub(&points[1], &points[0]));
        let host = (0..self.parts.len())
            .find(|&i| {
                let lives = crack
                    .parents
                    .iter()
                    .all(|p| self.parts[i].side(p.crack).is_none_or(|s| s == p.side));
                lives && polygon::contains(&self.parts[i].polygon, &middle)
            })
            .ok_or(PartitionError::Muddle)?;
        let [left, right] =
            polygon::split(&self.parts[host].polygon, &points).ok_or(PartitionError::Muddle)?;
        let new = self.parts.len();
        let mut other = self.parts[host].clone();
        // The left of a curve is its side 1.
        self.parts[host].polygon = left;
        self.parts[host].sides.push((index, 1.0));
        other.polygon = right;
        other.sides.push((index, -1.0));
        self.parts.push(other);
        // Earlier faces of the host now border on either part; one that an end of the chain touches is cut there.
        let mut faces = Vec::new();
        for face in std::mem::take(&mut self.faces) {
            for piece in cut_at(face, &[chain[0], chain[chain.len() - 1]]) {
                faces.push(self.reassigned(piece, host, new));
            }
        }
        faces.extend(chain.windows(2).map(|w| Face {
            crack: index,
            corners: w.to_vec(),
            parts: [host, new],
        }));
        self.faces = faces;
        Ok(())
    }

    /// A face of a part that was divided, with the half it belongs to.
    fn reassigned(&self, mut face: Face, host: usize, new: usize) -> Face {
        let middle = |face: &Face| {
            let scale = 1.0 / face.corners.len() as f64;
            face.corners
                .iter()
                .fold([0.0; 3], |sum, c| add_scaled(&sum, scale, &c.0))
        };
        let x = middle(&face);
        for part in &mut face.parts {
            if *part == host {
                let distance = |i: usize| polygon::border_distance(&self.parts[i].polygon, &x);
                if distance(new) < distance(host) {
                    *part = new;
                }
            }
        }
        face
    }

    /// Cuts the tetrahedra on which a planar crack lives.
    fn divide_solid(
        &mut self,
        index: usize,
        cracks: &[Crack],
        corners: &[Point],
        phi: &[f64],
    ) -> Result<(), PartitionError> {
        let crack = &cracks[index];
        let lives = |part: &Part| {
            crack
                .parents
                .iter()
                .all(|p| part.side(p.crack).is_none_or(|s| s == p.side))
        };
        let level = |x: &Point| {
            // The nodes' own values, so that a node on the crack stays on it.
            let node = corners.iter().position(|c| c == x);
            node.map_or_else(|| crack.distance(x), |i| phi[i])
        };
        let size = norm(&sub(&corners[6], &corners[0]));
        let mut halves: Vec<Option<usize>> = vec![None; self.parts.len()];
        for host in 0..self.parts.len() {
            if !lives(&self.parts[host]) {
                continue;
            }
            let mut sides = [Vec::new(), Vec::new()];
            for t in &self.parts[host].tetrahedra {
                let values = t.map(|x| {
                    let value = level(&x);
                    if value.abs() <= 1e-14 * size {
                        0.0
                    } else {
                        value
                    }
                });
                for (part, side) in sides.iter_mut().zip([1.0, -1.0]) {
                    clip_tetrahedron(t, &values, side, part);
                }
            }
            let [upper, lower] = sides;
            if upper.is_empty() || lower.is_empty() {
                // The crack misses this part: the part keeps the side it lies on.
                let side = if upper.is_empty() { -1.0 } else { 1.0 };
                self.parts[host].sides.push((index, side));
                continue;
            }
            let mut other = self.parts[host].clone();
            self.parts[host].tetrahedra = upper;
            self.parts[host].sides.push((index, 1.0));
            other.tetrahedra = lower;
            other.sides.push((index, -1.0));
            halves[host] = Some(self.parts.len());
            self.parts.push(other);
        }
        // Earlier faces are clipped by this plane where it lives.
        let mut faces = Vec::new();
        for face in std::mem::take(&mut self.faces) {
            if face
                .parts
                .iter()
                .all(|&p| halves.get(p).copied().flatten().is_none())
            {
                faces.push(face);
                continue;
            }
            for side in [1.0, -1.0] {
                let polygon = clip_face(&face.corners, &level, side);
                if polygon.len() > 2 {
                    let parts = face.parts.map(|p| match halves.get(p).copied().flatten() {
                        Some(lower) if side < 0.0 => lower,
                        _ => p,
                    });
                    faces.push(Face {
                        crack: face.crack,
                        corners: polygon,
                        parts,
                    });
                }
            }
        }
        let facet: Vec<FaceCorner> = super::facet(CellKind::Hex8, corners, phi)
            .into_iter()
            .map(|(x, nodes)| (x, Some(nodes)))
            .collect();
        // Its own face, clipped to every part it divides by the cracks that divide those from each other.
        for (host, half) in halves.iter().enumerate() {
            let Some(lower) = *half else { continue };
            let mut polygon = facet.clone();
            for &(other, side) in self.parts[host].sides.iter().filter(|s| s.0 != index) {
                polygon = clip_face(&polygon, &|x: &Point| cracks[other].distance(x), side);
            }
            if polygon.len() > 2 {
                faces.push(Face {
                    crack: index,
                    corners: polygon,
                    parts: [host, lower],
                });
            }
        }
        self.faces = faces;
        Ok(())
    }
}

/// Convex polygon of face corners on one side of a level.
fn clip_face(corners: &[FaceCorner], level: &dyn Fn(&Point) -> f64, side: Side) -> Vec<FaceCorner> {
    let size = corners
        .iter()
        .map(|c| norm(&sub(&c.0, &corners[0].0)))
        .fold(0.0, f64::max);
    let values: Vec<f64> = corners
        .iter()
        .map(|c| {
            let value = level(&c.0);
            if value.abs() <= 1e-13 * size {
                0.0
            } else {
                value
            }
        })
        .collect();
    if !values.iter().any(|v| v * side > 0.0) {
        return Vec::new();
    }
    let mut part = Vec::new();
    for i in 0..corners.len() {
        let j = (i + 1) % corners.len();
        if values[i] * side >= 0.0 {
            part.push(corners[i]);
        }
        if values[i] * values[j] < 0.0 {
            part.push((
                crossing(&corners[i].0, values[i], &corners[j].0, values[j]),
                None,
            ));
        }
    }
    part
}

/// The crack inside a 2D cell from entry to exit, or from or to the crack it ends on.
fn chain_in(
    mesh: &Mesh,
    corners: &[Point],
    phi: &[f64; 8],
    cracks: &[Crack],
    index: usize,
) -> Result<Vec<FaceCorner>, PartitionError> {
    let crack = &cracks[index];
    let Geometry::Curve(curve) = &crack.geometry else {
        return Err(PartitionError::Muddle);
    };
    let mut ends: Vec<(f64, FaceCorner)> = crossings(mesh.kind, corners, phi, crack)
        .into_iter()
        .map(|(x, nodes)| (curve.nearest(&x).s, (x, Some(nodes))))
        .collect();
    if ends.len() != 2 {
        return Err(PartitionError::Crossings(ends.len()));
    }
    if curve.is_closed() && (ends[0].0 - ends[1].0).abs() > 0.5 * curve.length() {
        // The cell holds the seam of a closed curve.
        let low = if ends[0].0 < ends[1].0 { 0 } else { 1 };
        ends[low].0 += curve.length();
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = norm(&sub(&corners[2], &corners[0]));
    // What ends on another crack in this cell stops there.
    for (k, end) in ends.iter_mut().enumerate() {
        let bound = crack.range[k];
        let beyond = if k == 0 { bound - end.0 } else { end.0 - bound };
        if !crack.free[k] && beyond > 1e-12 * size {
            *end = (bound, (curve.at(bound).0, None));
        }
    }
    let inside = |x: &Point| {
        let xi = mesh.kind.inverse_map(corners, x);
        xi.is_some_and(|xi| xi[0].abs() < 1.0 && xi[1].abs() < 1.0)
    };
    let inner = curve.between(ends[0].0, ends[1].0);
    let inner: Vec<Point> = if inner.iter().all(inside) {
        inner
    } else {
        Vec::new()
    };
    let mut chain = vec![ends[0].1];
    chain.extend(inner.into_iter().map(|x| (x, None)));
    chain.push(ends[1].1);
    Ok(chain)
}

/// Nodes on the crack and crossed edges of a cell.
pub fn crossings(
    kind: CellKind,
    corners: &[Point],
    phi: &[f64],
    crack: &Crack,
) -> Vec<(Point, [usize; 2])> {
    let mut found: Vec<(Point, [usize; 2])> = (0..kind.nodes())
        .filter(|&i| phi[i] == 0.0)
        .map(|i| (corners[i], [i, i]))
        .collect();
    for &[i, j] in kind.edges() {
        if phi[i] * phi[j] < 0.0 {
            found.push((
                crack.crossing(&corners[i], phi[i], &corners[j], phi[j]),
                [i, j],
            ));
        }
    }
    found
}

/// A 2D face cut at the given points that lie inside it.
fn cut_at(face: Face, at: &[FaceCorner]) -> Vec<Face> {
    let [p, q] = [face.corners[0], face.corners[1]];
    let d = sub(&q.0, &p.0);
    let length = norm(&d);
    let mut cuts: Vec<(f64, FaceCorner)> = at
        .iter()
        .filter_map(|&(x, nodes)| {
            let from = sub(&x, &p.0);
            let t = dot(&from, &d) / (length * length);
            let off = norm(&cross(&from, &d)) / length;
            (nodes.is_none() && off <= 1e-3 * length && t > 1e-12 && t < 1.0 - 1e-12)
                .then_some((t, (x, None)))
        })
        .collect();
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut corners = vec![p];
    corners.extend(cuts.into_iter().map(|c| c.1));
    corners.push(q);
    corners
        .windows(2)
        .map(|w| Face {
            corners: w.to_vec(),
            ..face.clone()
        })
        .collect()
}
