//! A solid around a flat crack inside it, as it is drawn: what is behind the crack as a body, the rest as edges.
//!
//! The view is isometric, along the diagonal of the axes: x points to the lower left, y to the lower right, z up.

use super::mesh::{deformed, dot, fail, sides};
use crate::model::field_mesh::{CellShape, FieldMesh};
use crate::report::ReportError;
use std::collections::BTreeMap;

type Vec3 = [f64; 3];

/// Direction to the viewer.
const VIEW: Vec3 = [1.0, 1.0, 1.0];
/// Faces whose normals make an angle with a larger cosine meet in no edge.
const SMOOTH: f64 = 0.9;
/// Points nearer than this fraction of the body's size to a side of its box lie on it, or in one place.
const NEAR: f64 = 1e-6;

/// Faces of a hexahedron, corners in VTK's order, normals outwards.
const HEXAHEDRON: [&[usize]; 6] = [
    &[0, 3, 2, 1],
    &[4, 5, 6, 7],
    &[0, 1, 5, 4],
    &[1, 2, 6, 5],
    &[2, 3, 7, 6],
    &[3, 0, 4, 7],
];
/// Faces of a tetrahedron.
const TETRA: [&[usize]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];

/// Isometric projection: right and up on the paper [m].
pub fn project([x, y, z]: Vec3) -> [f64; 2] {
    [(y - x) / 2f64.sqrt(), (2.0 * z - x - y) / 6f64.sqrt()]
}

/// a + s b.
pub fn sum(a: Vec3, s: f64, b: Vec3) -> Vec3 {
    std::array::from_fn(|c| a[c] + s * b[c])
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
}

/// Unit normal of a polygon, also of one that is not quite plane (Newell); not finite without area.
pub fn normal(points: &[Vec3], polygon: &[usize]) -> Vec3 {
    unit(area(points, polygon))
}

fn unit(v: Vec3) -> Vec3 {
    v.map(|c| c / dot(v, v).sqrt())
}

/// Normal of a polygon, twice as long as its area.
fn area(points: &[Vec3], polygon: &[usize]) -> Vec3 {
    // About the first point, for the digits.
    let at = |p: usize| sum(points[p], -1.0, points[polygon[0]]);
    sides(polygon).fold([0.0; 3], |total, [a, b]| {
        sum(total, 1.0, cross(at(a), at(b)))
    })
}

/// Flat crack: a point and the unit normal that points to the viewer.
pub struct Plane {
    point: Vec3,
    normal: Vec3,
}

impl Plane {
    /// Mean plane of the facets of a crack; none without area.
    pub fn of(crack: &FieldMesh) -> Option<Self> {
        let (mut normal, mut point, mut count) = ([0.0; 3], [0.0; 3], 0.0);
        for polygon in crack.cells.iter().filter(|c| c.shape == CellShape::Polygon) {
            let own = area(&crack.points, &polygon.points);
            // Facets may run either way round.
            normal = sum(normal, if dot(own, normal) < 0.0 { -1.0 } else { 1.0 }, own);
            for p in &polygon.points {
                point = sum(point, 1.0, crack.points[*p]);
                count += 1.0;
            }
        }
        let sign = if dot(normal, VIEW) < 0.0 { -1.0 } else { 1.0 };
        let found = Self {
            point: point.map(|c| c / count),
            normal: unit(normal).map(|c| sign * c),
        };
        (dot(normal, normal) > 0.0).then_some(found)
    }

    /// The part of a vector in the plane.
    pub fn tangential(&self, v: Vec3) -> Vec3 {
        sum(v, -dot(v, self.normal), self.normal)
    }
}

/// A solid opened at a crack, on its deformed shape.
pub struct OpenedSolid {
    /// Magnification of the displacement.
    pub factor: f64,
    /// Deformed positions of the points [m].
    pub places: Vec<Vec3>,
    /// Faces behind the crack that look at the viewer, from back to front; none where the crack parts nothing.
    pub body: Vec<Vec<usize>>,
    /// Edges of the rest: ends, and whether they are in sight.
    pub edges: Vec<([usize; 2], bool)>,
    /// Points of the part behind the crack, or all: reference and deformed positions [m].
    behind: Vec<[Vec3; 2]>,
    slack: f64,
}

impl OpenedSolid {
    /// Parts a solid at a crack.
    ///
    /// # Errors
    /// [`ReportError::FieldMesh`] when the picture is not 3D, has no solid cell or one with the wrong points, or lacks the
    /// displacement.
    pub fn new(picture: &FieldMesh, crack: &Plane) -> Result<Self, ReportError> {
        if picture.dim != 3 {
            return fail(
                "picture",
                &format!("{} dimensions, a solid needs 3", picture.dim),
            );
        }
        let (places, factor) = deformed(picture)?;
        let faces = boundary(picture)?;
        let part = parts(picture);
        let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
        for p in picture.cells.iter().flat_map(|cell| &cell.points) {
            let distance = dot(sum(picture.points[*p], -1.0, crack.point), crack.normal);
            *sums.entry(part[*p]).or_default() += distance;
        }
        let apart = sums.len() > 1;
        let is_behind = |p: usize| !apart || sums.get(&part[p]).is_some_and(|total| *total < 0.0);
        let values = |c: usize| picture.points.iter().map(move |p| p[c]);
        let low: Vec3 = std::array::from_fn(|c| values(c).fold(f64::INFINITY, f64::min));
        let high: Vec3 = std::array::from_fn(|c| values(c).fold(f64::NEG_INFINITY, f64::max));
        let slack = NEAR * (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
        // Crack faces do not lie on the box around the body, nor does what the cells at a front leave open.
        let on_box = |face: &&Vec<usize>| {
            let on = |c: usize, end: f64| {
                face.iter()
                    .all(|p| (picture.points[*p][c] - end).abs() <= slack)
            };
            (0..3).any(|c| on(c, low[c]) || on(c, high[c]))
        };
        let seen = |face: &[usize]| dot(area(&places, face), VIEW) > 0.0;
        let (mut body, open): (Vec<Vec<usize>>, Vec<Vec<usize>>) = faces
            .into_iter()
            .partition(|face| apart && is_behind(face[0]));
        body.retain(|face| seen(face));
        let depth = |face: &Vec<usize>| {
            let total: f64 = face.iter().map(|p| dot(places[*p], VIEW)).sum();
            total / face.len() as f64
        };
        body.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
        // Edges where faces meet under an angle, in sight if one of them looks at the viewer.
        let mut meeting: BTreeMap<[usize; 2], (Vec<Vec3>, bool)> = BTreeMap::new();
        for face in open.iter().filter(on_box) {
            for [a, b] in sides(face) {
                let (normals, any) = meeting.entry([a.min(b), a.max(b)]).or_default();
                normals.push(normal(&picture.points, face));
                *any |= seen(face);
            }
        }
        let sharp = |normals: &[Vec3]| {
            normals.len() == 1 || normals.iter().any(|n| dot(*n, normals[0]) < SMOOTH)
        };
        let mut edges = Vec::new();
        for (edge, (normals, seen)) in meeting {
            edges.extend(sharp(&normals).then_some((edge, seen)));
        }
        let known = |p: &usize| is_behind(*p) && places[*p].iter().all(|c| c.is_finite());
        let behind = (0..places.len()).filter(known);
        let behind = behind.map(|p| [picture.points[p], places[p]]).collect();
        Ok(Self {
            factor,
            places,
            body,
            edges,
            behind,
            slack,
        })
    }

    /// Where a point of the crack goes with the part behind it: the mean over the body's points in its place, or with the
    /// nearest one [m].
    pub fn moved(&self, x: Vec3) -> Vec3 {
        let away = |y: Vec3| {
            let d = sum(x, -1.0, y);
            dot(d, d).sqrt()
        };
        let distances = self.behind.iter().map(|[y, _]| away(*y));
        let reach = distances.fold(f64::INFINITY, f64::min).max(self.slack);
        let near = self.behind.iter().filter(|[y, _]| away(*y) <= reach);
        let moves: Vec<Vec3> = near.map(|[y, place]| sum(*place, -1.0, *y)).collect();
        let total = moves.iter().fold([0.0; 3], |total, u| sum(total, 1.0, *u));
        sum(x, 1.0 / moves.len().max(1) as f64, total)
    }
}

/// Faces of exactly one solid cell, with outward normals.
fn boundary(picture: &FieldMesh) -> Result<Vec<Vec<usize>>, ReportError> {
    let mut found: BTreeMap<Vec<usize>, Vec<Vec<usize>>> = BTreeMap::new();
    for (index, cell) in picture.cells.iter().enumerate() {
        let (needed, faces): (usize, &[&[usize]]) = match cell.shape {
            CellShape::Hexahedron => (8, &HEXAHEDRON),
            CellShape::Tetra => (4, &TETRA),
            _ => continue,
        };
        if cell.points.len() != needed || cell.points.iter().any(|p| *p >= picture.points.len()) {
            return fail("cells", &format!("cell {index} has wrong points"));
        }
        // The points of a tetrahedron may come in either orientation.
        let at = |i: usize| picture.points[cell.points[i]];
        let edge = |i: usize| sum(at(i), -1.0, at(0));
        let mirrored = needed == 4 && dot(edge(1), cross(edge(2), edge(3))) < 0.0;
        for face in faces {
            let mut points: Vec<usize> = face.iter().map(|i| cell.points[*i]).collect();
            if mirrored {
                points.reverse();
            }
            let mut set = points.clone();
            set.sort_unstable();
            found.entry(set).or_default().push(points);
        }
    }
    if found.is_empty() {
        return fail("cells", "no hexahedron or tetrahedron");
    }
    let single = found.into_values().filter(|equal| equal.len() == 1);
    Ok(single.flatten().collect())
}

/// Number of the connected part of every point: cells that share a point belong together.
fn parts(picture: &FieldMesh) -> Vec<usize> {
    fn root(parent: &mut [usize], mut p: usize) -> usize {
        while parent[p] != p {
            parent[p] = parent[parent[p]];
            p = parent[p];
        }
        p
    }
    let mut parent: Vec<usize> = (0..picture.points.len()).collect();
    for pair in picture.cells.iter().flat_map(|cell| cell.points.windows(2)) {
        let (a, b) = (root(&mut parent, pair[0]), root(&mut parent, pair[1]));
        parent[a.max(b)] = a.min(b);
    }
    (0..parent.len()).map(|p| root(&mut parent, p)).collect()
}
