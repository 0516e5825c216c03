//! A cell cut by one or more cracks: its parts, each on known sides of the cracks, and the crack faces between them.
//!
//! ```text
//!   one crack      parts { + }, { − }                       crossing    { + + }, { + − }, { − + }, { − − }
//!   branching      { 1+ 2+ }, { 1+ 2− }, { 1− }             the second crack ends on the first
//! ```
//!
//! In 2D parts are simple polygons cut along chains of segments ([`super::regions`]); in 3D tetrahedra clipped by planes, crack
//! by crack: each divides those parts of the cell on which it lives. Slivers keep their relative size.

use crate::geometry::clip::{Side, clip_tetrahedron, clip_with, crossing};
use crate::geometry::{Point, cross, dot, mean, norm, sub};
use crate::mesh::Mesh;
use crate::mesh::cell::CellMap;

use super::crack::{Crack, crossings};
use super::part::{Face, FaceCorner, Part, Region};

/// A divided cell.
#[derive(Debug, Clone, Default)]
pub struct Partition {
    /// Parts.
    pub parts: Vec<Part>,
    /// Faces, crack by crack.
    pub faces: Vec<Face>,
    /// Pairs of parts that are one: between them lies a crack's continuation beyond its end.
    pub joined: Vec<[usize; 2]>,
    /// 2D: the segment between each of these pairs, the first part to its left [m].
    pub beyond: Vec<[Point; 2]>,
    /// 2D: the border of the cell between places of cracks, counter-clockwise.
    pub border: Vec<BorderPiece>,
    /// Cracks that run into the cell but divide nothing: they end where they enter.
    pub dropped: Vec<usize>,
}

/// A piece of the border of a plane cell between places of cracks, its corners and the ends of continuations.
#[derive(Debug, Clone)]
pub struct BorderPiece {
    /// Local edge, by its first node.
    pub edge: usize,
    /// From where to where, counter-clockwise [m].
    pub ends: [Point; 2],
    /// The region beside it.
    pub region: usize,
    /// Whether it begins at a place that the cell beyond knows, too: at no end of a continuation, which parts what is one.
    pub at_place: bool,
}

/// Why a cell cannot be divided.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PartitionError {
    /// The pieces do not fit together.
    #[error("the cracks in a cell leave no clean parts")]
    Muddle,
}

impl Partition {
    /// Divides a 3D cell by cracks (indices in rising order); the parts on both sides of those that `end` in it are one.
    pub fn solid(
        mesh: &Mesh,
        cell: usize,
        cracks: &[Crack],
        inside: &[usize],
        ending: &[usize],
    ) -> Self {
        let mut whole = Partition::whole(&mesh.map(cell));
        for &index in inside {
            whole.divide_solid(index, cracks, mesh, cell);
        }
        let pairs = whole.faces.iter().filter(|f| ending.contains(&f.crack));
        whole.joined = pairs.map(|f| f.sides.map(|side| side.1)).collect();
        whole
    }

    /// 2D: the regions beside the pieces of a local edge, in its direction.
    pub fn along(&self, edge: usize) -> impl DoubleEndedIterator<Item = &BorderPiece> {
        self.border.iter().filter(move |piece| piece.edge == edge)
    }

    /// Arms that the regions of the cell lie on a side of.
    pub fn arms(&self) -> impl Iterator<Item = usize> {
        let sides = self.parts.iter().flat_map(|part| &part.sides);
        sides.map(|side| side.0)
    }

    /// An undivided cell.
    pub fn whole(map: &CellMap) -> Self {
        Partition {
            parts: vec![Part::whole(map)],
            ..Partition::default()
        }
    }

    /// Divides a part by a crack into its halves on side 1 and side 2; the number of the latter.
    fn divide(&mut self, host: usize, crack: usize, halves: [Vec<[Point; 4]>; 2]) -> usize {
        let mut other = self.parts[host].clone();
        let [upper, lower] = halves;
        for (part, half, side) in [
            (&mut self.parts[host], upper, 1.0),
            (&mut other, lower, -1.0),
        ] {
            part.tetrahedra = half;
            part.sides.push((crack, side));
        }
        self.parts.push(other);
        self.parts.len() - 1
    }

    /// Cuts the tetrahedra on which a planar crack lives.
    fn divide_solid(&mut self, index: usize, cracks: &[Crack], mesh: &Mesh, cell: usize) {
        let crack = &cracks[index];
        let (map, phi) = (mesh.map(cell), crack.cell_phi(mesh, cell));
        let level = |x: &Point| crack.level(x);
        let mut halves: Vec<Option<usize>> = vec![None; self.parts.len()];
        for host in 0..self.parts.len() {
            if !lives(cracks, crack, &self.parts[host]) {
                continue;
            }
            let mut sides = [Vec::new(), Vec::new()];
            for t in &self.parts[host].tetrahedra {
                let values = t.map(|x| level(&x));
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
            halves[host] = Some(self.divide(host, index, [upper, lower]));
        }
        // Earlier faces are clipped by this plane where it lives.
        let lower = |part: usize| halves.get(part).copied().flatten();
        let mut faces = Vec::new();
        for face in std::mem::take(&mut self.faces) {
            if face.sides.iter().all(|side| lower(side.1).is_none()) {
                faces.push(face);
                continue;
            }
            for side in [1.0, -1.0] {
                let corners = clip_face(&face.corners, level, side);
                if corners.len() > 2 {
                    let sides = face.sides.map(|own| match lower(own.1) {
                        Some(lower) if side < 0.0 => (own.0, lower),
                        _ => own,
                    });
                    faces.push(Face {
                        crack: face.crack,
                        corners,
                        sides,
                        frame: face.frame,
                    });
                }
            }
        }
        let crossings = crossings(&map, &phi).into_iter();
        let facet = cyclic(crossings.map(|(x, nodes)| (x, Some(nodes))).collect());
        let frame = crack.frame(&map[0]);
        // Its own face, clipped to every part it divides by the cracks that divide those from each other.
        for (host, half) in halves.iter().enumerate() {
            let Some(lower) = *half else { continue };
            let mut polygon = facet.clone();
            for &(other, side) in self.parts[host].sides.iter().filter(|s| s.0 != index) {
                polygon = clip_face(&polygon, |x| cracks[other].level(x), side);
            }
            if polygon.len() > 2 {
                faces.push(Face {
                    crack: index,
                    corners: polygon,
                    sides: [(cell, host), (cell, lower)],
                    frame,
                });
            }
        }
        self.faces = faces;
    }

    /// What a region leaves of a polygon in a facet of its cell; cracks along all of it leave it whole.
    pub fn clipped(
        &self,
        cracks: &[Crack],
        region: Region,
        mut polygon: Vec<FaceCorner>,
    ) -> Vec<FaceCorner> {
        for &(crack, side) in &self.parts[region].sides {
            let level = |x: &Point| cracks[crack].level(x);
            if polygon.iter().any(|corner| level(&corner.0) != 0.0) {
                polygon = clip_face(&polygon, level, side);
            }
        }
        polygon
    }
}

/// Whether a crack reaches into a part, or ends on another one before.
pub fn lives(cracks: &[Crack], crack: &Crack, part: &Part) -> bool {
    crack.parents.iter().all(|p| {
        let of = |arm: usize| cracks[arm].number == cracks[p.crack].number;
        let own = part.sides.iter().find(|side| of(side.0));
        own.is_none_or(|own| own.1 == p.side)
    })
}

/// Convex polygon of face corners on one side of a level.
fn clip_face(corners: &[FaceCorner], level: impl Fn(&Point) -> f64, side: Side) -> Vec<FaceCorner> {
    let levels: Vec<f64> = corners.iter().map(|c| level(&c.0)).collect();
    if !levels.iter().any(|v| v * side > 0.0) {
        return Vec::new();
    }
    clip_with(corners, &levels, side, |i, j| {
        (
            crossing(&corners[i].0, levels[i], &corners[j].0, levels[j]),
            None,
        )
    })
}

/// Corners of a convex polygon in cyclic order around their mean.
fn cyclic(mut corners: Vec<FaceCorner>) -> Vec<FaceCorner> {
    let centre = mean(corners.iter().map(|corner| &corner.0));
    let from_centre = |corner: &FaceCorner| sub(&corner.0, &centre);
    let Some(e1) = corners.first().map(from_centre) else {
        return corners;
    };
    let mut normal = [0.0; 3];
    for corner in &corners[1..] {
        let candidate = cross(&e1, &from_centre(corner));
        if norm(&candidate) > norm(&normal) {
            normal = candidate;
        }
    }
    let e2 = cross(&normal, &e1);
    let (l1, l2) = (norm(&e1), norm(&e2));
    let angle = |corner: &FaceCorner| {
        let d = from_centre(corner);
        (dot(&d, &e2) / l2).atan2(dot(&d, &e1) / l1)
    };
    corners.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    corners
}
