//! A solid in front of and behind a crack inside it, and its edges.

use super::outline::Weld;
use super::solid::{Deformed, VIEW};
use super::surface::Patch;
use crate::model::field_mesh::{CellShape, FieldMesh};
use std::collections::BTreeMap;

/// Patches whose normals make an angle with a larger cosine meet in no edge.
const SMOOTH: f64 = 0.9;
/// Points nearer than this fraction of the body's size to a side of its box lie on it, or in one place.
const NEAR: f64 = 1e-6;

/// Flat crack: a point and the unit normal that points to the viewer.
pub struct Plane {
    pub point: [f64; 3],
    pub normal: [f64; 3],
}

impl Plane {
    /// Mean plane of the facets of a crack; none without area.
    pub fn of(crack: &FieldMesh) -> Option<Self> {
        let (mut normal, mut point, mut count) = ([0.0; 3], [0.0; 3], 0.0);
        let polygons = crack.cells.iter().filter(|c| c.shape == CellShape::Polygon);
        for polygon in polygons {
            let own = newell(crack, &polygon.points);
            // Facets may run either way round.
            let sign = if dot(own, normal) < 0.0 { -1.0 } else { 1.0 };
            for p in &polygon.points {
                point = sum(point, 1.0, crack.points[*p]);
                count += 1.0;
            }
            normal = sum(normal, sign, own);
        }
        let length = dot(normal, normal).sqrt();
        let sign = if dot(normal, VIEW) < 0.0 { -1.0 } else { 1.0 };
        (length > 0.0).then(|| Self {
            point: point.map(|c| c / count),
            normal: normal.map(|c| sign * c / length),
        })
    }

    /// Distance towards the viewer along the normal [m].
    fn distance(&self, x: [f64; 3]) -> f64 {
        dot(sum(x, -1.0, self.point), self.normal)
    }

    /// The part of a vector in the plane.
    pub fn tangential(&self, v: [f64; 3]) -> [f64; 3] {
        sum(v, -dot(v, self.normal), self.normal)
    }
}

/// A solid as it is drawn around a crack.
pub struct OpenedSolid<'a> {
    /// Patches behind the crack that look at the viewer, from back to front; none where the crack parts nothing.
    pub body: Vec<&'a Patch>,
    /// Edges of the rest: ends, and whether they are in sight.
    pub edges: Vec<([usize; 2], bool)>,
    /// Points of the part behind the crack, or all.
    pub behind: Vec<bool>,
}

impl<'a> OpenedSolid<'a> {
    /// Parts a solid at a crack.
    pub fn new(
        picture: &FieldMesh,
        displacement: &[[f64; 3]],
        shape: &'a Deformed,
        crack: &Plane,
    ) -> Self {
        let component = components(picture);
        let mut sums: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
        for cell in &picture.cells {
            for p in &cell.points {
                let (total, count) = sums.entry(component[*p]).or_default();
                *total += crack.distance(picture.points[*p]);
                *count += 1.0;
            }
        }
        let apart = sums.len() > 1;
        let behind: Vec<bool> = component
            .iter()
            .map(|c| !apart || sums.get(c).is_some_and(|(total, _)| *total < 0.0))
            .collect();
        let is_body = |patch: &Patch| apart && behind[patch.faces[0][0]];
        let outer = Outer::of(picture);
        let open = shape.patches.iter().filter(|patch| !is_body(patch));
        let open: Vec<&Patch> = open.filter(|patch| outer.holds(picture, patch)).collect();
        let body = shape.visible().into_iter().filter(|patch| is_body(patch));
        Self {
            body: body.collect(),
            edges: edges(picture, &open, shape, &Weld::new(picture, displacement)),
            behind,
        }
    }
}

/// Edges of patches that meet under an angle, and whether one of the two looks at the viewer.
fn edges(
    picture: &FieldMesh,
    patches: &[&Patch],
    shape: &Deformed,
    weld: &Weld<'_>,
) -> Vec<([usize; 2], bool)> {
    type Meeting = ([usize; 2], Vec<[f64; 3]>, bool);
    let mut found: BTreeMap<[usize; 2], Meeting> = BTreeMap::new();
    for patch in patches {
        let (normal, seen) = (
            unit(newell(picture, &patch.faces[0])),
            shape.faces_viewer(patch),
        );
        for edge in &patch.outline {
            let [a, b] = edge.map(|p| weld.place[p]);
            let meeting = found.entry([a.min(b), a.max(b)]);
            let (_, normals, any) = meeting.or_insert((*edge, Vec::new(), false));
            normals.push(normal);
            *any |= seen;
        }
    }
    let sharp = |normals: &[[f64; 3]]| {
        let first = normals[0];
        normals.len() == 1 || normals.iter().any(|n| dot(*n, first) < SMOOTH)
    };
    let edges = found.into_values().filter(|(_, normals, _)| sharp(normals));
    edges.map(|(edge, _, seen)| (edge, seen)).collect()
}

/// Number of the connected part of every point: cells that share a point belong together.
fn components(picture: &FieldMesh) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..picture.points.len()).collect();
    fn root(parent: &mut [usize], mut p: usize) -> usize {
        while parent[p] != p {
            parent[p] = parent[parent[p]];
            p = parent[p];
        }
        p
    }
    for cell in &picture.cells {
        for pair in cell.points.windows(2) {
            let (a, b) = (root(&mut parent, pair[0]), root(&mut parent, pair[1]));
            parent[a.max(b)] = a.min(b);
        }
    }
    (0..parent.len()).map(|p| root(&mut parent, p)).collect()
}

/// The box around a body.
struct Outer {
    low: [f64; 3],
    high: [f64; 3],
    slack: f64,
}

impl Outer {
    fn of(picture: &FieldMesh) -> Self {
        let values = |c: usize| picture.points.iter().map(move |p| p[c]);
        let low: [f64; 3] = std::array::from_fn(|c| values(c).fold(f64::INFINITY, f64::min));
        let high: [f64; 3] = std::array::from_fn(|c| values(c).fold(f64::NEG_INFINITY, f64::max));
        let size = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
        Self {
            low,
            high,
            slack: NEAR * size,
        }
    }

    /// Whether a patch lies on a side of the box: crack faces do not, nor does what the cells at a front leave open.
    fn holds(&self, picture: &FieldMesh, patch: &Patch) -> bool {
        let points = || patch.faces.iter().flatten().map(|p| picture.points[*p]);
        let on = |c: usize, end: f64| points().all(|x| (x[c] - end).abs() <= self.slack);
        (0..3).any(|c| on(c, self.low[c]) || on(c, self.high[c]))
    }
}

/// Mean displacement of the points of a body that a place has; of the nearest one where it has none.
pub struct Lookup<'a> {
    points: Vec<([f64; 3], [f64; 3])>,
    found: BTreeMap<[i64; 3], Vec<&'a [f64; 3]>>,
    grid: f64,
}

impl<'a> Lookup<'a> {
    /// Of the points that `wanted` marks.
    pub fn new(picture: &FieldMesh, displacement: &'a [[f64; 3]], wanted: &[bool]) -> Self {
        let outer = Outer::of(picture);
        let mut lookup = Self {
            points: Vec::new(),
            found: BTreeMap::new(),
            grid: outer.slack,
        };
        let points = picture.points.iter().zip(displacement).zip(wanted);
        for ((x, u), _) in
            points.filter(|((_, u), wanted)| **wanted && u.iter().all(|c| c.is_finite()))
        {
            let key = lookup.key(*x);
            lookup.found.entry(key).or_default().push(u);
            lookup.points.push((*x, *u));
        }
        lookup
    }

    fn key(&self, x: [f64; 3]) -> [i64; 3] {
        x.map(|c| (c / self.grid).round() as i64)
    }

    /// Displacement at a place [m].
    pub fn at(&self, x: [f64; 3]) -> [f64; 3] {
        if let Some(found) = self.found.get(&self.key(x)) {
            let total = found.iter().fold([0.0; 3], |t, u| sum(t, 1.0, **u));
            return total.map(|c| c / found.len() as f64);
        }
        let away = |y: &[f64; 3]| {
            let d = sum(x, -1.0, *y);
            dot(d, d)
        };
        let nearest = self
            .points
            .iter()
            .min_by(|a, b| away(&a.0).total_cmp(&away(&b.0)));
        nearest.map_or([0.0; 3], |(_, u)| *u)
    }
}

/// Normal of a polygon, twice as long as its area.
fn newell(picture: &FieldMesh, polygon: &[usize]) -> [f64; 3] {
    let mut normal = [0.0; 3];
    for (i, point) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (a, b) = (picture.points[*point], picture.points[next]);
        for c in 0..3 {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            normal[c] += (a[d] - b[d]) * (a[e] + b[e]);
        }
    }
    normal
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| a[c] * b[c]).sum()
}

/// a + s b.
pub fn sum(a: [f64; 3], s: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + s * b[c])
}
