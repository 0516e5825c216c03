//! Common parts of pictures of meshes: faces and edges of the boundary, the deformed shape, lines along edges.
//!
//! Cells of a picture share their points, but for the faces of a crack, which have points of their own: what belongs to one
//! cell alone is the boundary, crack faces among it.

use super::axis::{nice_step, range};
use super::bands::chains;
use super::canvas::{Canvas, Pixel};
use super::colour::Rgb;
use crate::model::field_mesh::FieldMesh;
use crate::report::ReportError;
use std::collections::{BTreeMap, BTreeSet};

/// Name of the point vector that deforms a body.
pub const DISPLACEMENT: &str = "displacement_m";

/// The error of a picture that lacks something.
pub fn fail<T>(name: &str, reason: &str) -> Result<T, ReportError> {
    Err(ReportError::field_mesh(name, reason.to_owned()))
}

/// A point vector of a picture.
///
/// # Errors
/// [`ReportError::FieldMesh`] when there is none of that name, or not one value per point.
pub fn point_vector<'a>(picture: &'a FieldMesh, name: &str) -> Result<&'a [[f64; 3]], ReportError> {
    let found = picture.point_vectors.iter().find(|(n, _)| n == name);
    let values = found.map_or(&[][..], |(_, values)| values);
    if values.len() != picture.points.len() {
        let (found, points) = (values.len(), picture.points.len());
        return fail(name, &format!("{found} values for {points} points"));
    }
    Ok(values)
}

/// Deformed positions of the points [m], and the round factor that makes the largest displacement about a twentieth of the
/// body.
///
/// # Errors
/// Those of [`point_vector`].
pub fn deformed(picture: &FieldMesh) -> Result<(Vec<[f64; 3]>, f64), ReportError> {
    let displacement = point_vector(picture, DISPLACEMENT)?;
    let length = |u: &[f64; 3]| u.iter().map(|c| c * c).sum::<f64>().sqrt();
    let extent =
        |c: usize| range(picture.points.iter().map(|p| p[c])).map_or(0.0, |(low, high)| high - low);
    let diameter = length(&std::array::from_fn(extent));
    let lengths = displacement.iter().map(length).filter(|u| u.is_finite());
    let largest = lengths.fold(0.0, f64::max);
    let factor = if largest > 0.0 && diameter > 0.0 {
        nice_step(0.02 * diameter / largest)
    } else {
        1.0
    };
    let moved = picture.points.iter().zip(displacement);
    let places = moved.map(|(x, u)| std::array::from_fn(|c| x[c] + factor * u[c]));
    Ok((places.collect(), factor))
}

/// The sides of a closed polygon.
pub fn sides(face: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]])
}

/// Edges of exactly one of the faces.
pub fn outline(faces: &[Vec<usize>]) -> BTreeSet<[usize; 2]> {
    let edges = || faces.iter().flat_map(|face| sides(face)).map(undirected);
    // Their larger ends by the smaller one.
    let mut begin = vec![0; faces.iter().flatten().max().map_or(1, |p| p + 2)];
    edges().for_each(|[a, _]| begin[a + 1] += 1);
    (1..begin.len()).for_each(|p| begin[p] += begin[p - 1]);
    let (mut ends, mut at) = (vec![0; begin[begin.len() - 1]], begin.clone());
    for [a, b] in edges() {
        ends[at[a]] = b;
        at[a] += 1;
    }
    let mut single = BTreeSet::new();
    for (a, range) in begin.windows(2).enumerate() {
        let own = &mut ends[range[0]..range[1]];
        own.sort_unstable();
        let alone = own.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
        single.extend(alone.map(|b| [a, b[0]]));
    }
    single
}

fn undirected([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The faces with every point between the ends of a side that splits the other side of the same line: beside the tip of a
/// crack, where its continuation parts a cell, and where cracks cross. Otherwise a side inside the body would count as its
/// boundary, and the faces would gape where such a point moves off the line.
pub fn conforming(picture: &FieldMesh, mut faces: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let single = Single::new(picture, &outline(&faces));
    // From its smaller to its larger point.
    let mut between: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for [one, other] in single.seams() {
        for (row, across) in [(&one, &other), (&other, &one)] {
            for ends in row.windows(2).map(|e| [e[0], e[1]]) {
                let inner = across.iter().filter(|p| single.parts(ends, **p));
                let mut inner: Vec<usize> = inner.copied().collect();
                if ends[0] > ends[1] {
                    inner.reverse();
                }
                between.insert(undirected(ends), inner);
            }
        }
    }
    let split = |[a, b]: [usize; 2]| {
        let mut inner = between
            .get(&undirected([a, b]))
            .cloned()
            .unwrap_or_default();
        if a > b {
            inner.reverse();
        }
        std::iter::once(a).chain(inner)
    };
    let mut met = vec![false; picture.points.len()];
    between.keys().flatten().for_each(|p| met[*p] = true);
    for face in &mut faces {
        if face.iter().any(|p| met[*p]) {
            *face = sides(face).flat_map(split).collect();
        }
    }
    faces
}

/// Cosine of the largest angle between edges on one line, and relative distance of places that are the same, less than 1.
const STRAIGHT: f64 = 1.0 - 1e-12;
const SAME: f64 = 1e-6;

/// Of some points those that share a place and a displacement, by each of them.
fn twins(picture: &FieldMesh, points: impl Iterator<Item = usize>) -> BTreeMap<usize, Vec<usize>> {
    let named = |name: &str| picture.point_vectors.iter().find(|(n, _)| n == name);
    let u = named(DISPLACEMENT).map_or(&[][..], |(_, values)| values);
    let size = |values: &[[f64; 3]]| {
        let sizes = values.iter().flatten().map(|c| c.abs());
        sizes.filter(|c| c.is_finite()).fold(0.0, f64::max)
    };
    let (length, largest) = (size(&picture.points), size(u));
    let near = |a: &[f64; 3], b: &[f64; 3], size: f64| {
        (0..3).all(|c| (a[c] - b[c]).abs() <= SAME * SAME * size)
    };
    let mut sorted: Vec<usize> = points.collect();
    let place = |p: &usize| picture.points[*p];
    sorted.sort_by(|p, q| place(p)[0].total_cmp(&place(q)[0]));
    let mut twins: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, p) in sorted.iter().enumerate() {
        let close = |q: &&usize| place(q)[0] - place(p)[0] <= SAME * SAME * length;
        for q in sorted[i + 1..].iter().take_while(close) {
            let together = u.get(*p).zip(u.get(*q));
            let together = together.is_some_and(|(a, b)| near(a, b, largest));
            if together && near(&place(p), &place(q), length) {
                twins.entry(*p).or_default().push(*q);
                twins.entry(*q).or_default().push(*p);
            }
        }
    }
    twins
}

/// Edges of one face each.
struct Single<'a> {
    points: &'a [[f64; 3]],
    at: BTreeMap<usize, BTreeSet<usize>>,
    /// Points on the same place that move together, by each of them: both faces at the end of a crack.
    twins: BTreeMap<usize, Vec<usize>>,
}

impl<'a> Single<'a> {
    fn new(picture: &'a FieldMesh, edges: &BTreeSet<[usize; 2]>) -> Self {
        let mut at: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for [a, b] in edges {
            at.entry(*a).or_default().insert(*b);
            at.entry(*b).or_default().insert(*a);
        }
        let points = &picture.points;
        let twins = twins(picture, at.keys().copied());
        Self { points, at, twins }
    }

    /// Pairs of rows of edges that run along one line from one point to another: the two sides of one piece.
    ///
    /// The faces of a crack share their ends too, but are split at the same places, by points of their own.
    fn seams(&self) -> Vec<[Vec<usize>; 2]> {
        let mut seams = Vec::new();
        for (&start, ends) in &self.at {
            let ends: Vec<usize> = ends.iter().copied().collect();
            for (i, &one) in ends.iter().enumerate() {
                for &other in &ends[i + 1..] {
                    seams.extend(self.seam(start, [one, other]));
                }
            }
        }
        seams
    }

    /// The two rows from a point along one line, if they meet again.
    fn seam(&self, start: usize, first: [usize; 2]) -> Option<[Vec<usize>; 2]> {
        let (_, direction) = self.step(start, first[0]);
        let mut rows = first.map(|end| vec![start, end]);
        loop {
            let far = [0, 1].map(|row: usize| {
                let end = *rows[row].last().unwrap_or(&start);
                let (length, along) = self.step(start, end);
                (end, length, dot(along, direction) >= STRAIGHT)
            });
            if !far.iter().all(|(_, _, straight)| *straight) {
                return None;
            }
            let [(one, near, _), (other, distant, _)] = far;
            if one == other {
                return Some(rows);
            }
            if (near - distant).abs() <= SAME * near.min(distant) {
                return None;
            }
            // The row that is behind goes on.
            let (row, end) = if near < distant { (0, one) } else { (1, other) };
            let ahead = |next: &&usize| dot(self.step(end, **next).1, direction) >= STRAIGHT;
            let next = |end: &usize| self.at.get(end)?.iter().find(ahead);
            let twins = self.twins.get(&end).into_iter().flatten();
            let (twin, next) = std::iter::once(&end)
                .chain(twins)
                .find_map(|twin| Some((*twin, *next(twin)?)))?;
            if twin != end {
                rows[row].push(twin);
            }
            rows[row].push(next);
        }
    }

    /// Whether a point of the same line lies between the ends of an edge.
    fn parts(&self, [a, b]: [usize; 2], point: usize) -> bool {
        let (length, _) = self.step(a, b);
        point != a && point != b && self.step(a, point).0 < length && self.step(b, point).0 < length
    }

    /// Length and direction from a point to another.
    fn step(&self, from: usize, to: usize) -> (f64, [f64; 3]) {
        let d: [f64; 3] = std::array::from_fn(|c| self.points[to][c] - self.points[from][c]);
        let length = dot(d, d).sqrt();
        (length, d.map(|c| c / length))
    }
}

/// Lines along edges, joined where they meet.
pub fn stroke(
    canvas: &mut Canvas,
    edges: &[[usize; 2]],
    place: impl Fn(usize) -> Pixel,
    colour: Rgb,
    width: f64,
) {
    let edges = edges
        .iter()
        .map(|[a, b]| [place(*a), place(*b)])
        .filter(|[a, b]| a != b);
    let edges: BTreeSet<[Pixel; 2]> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    for line in chains(&edges) {
        canvas.pixel_line(line, colour, width);
    }
}

/// An upright rectangle.
#[derive(Debug, Clone, Copy)]
pub struct Box2 {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Box2 {
    /// The smallest that holds all points; none without finite points or without extent.
    pub fn around(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Self> {
        let (x0, x1) = range(points.clone().map(|p| p[0]))?;
        let (y0, y1) = range(points.map(|p| p[1]))?;
        (x1 > x0 && y1 > y0).then_some(Self {
            low: [x0, y0],
            high: [x1, y1],
        })
    }

    pub fn width(&self) -> f64 {
        self.high[0] - self.low[0]
    }

    pub fn height(&self) -> f64 {
        self.high[1] - self.low[1]
    }
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| a[c] * b[c]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square [0, 2]² in two rows of faces that meet at y = 1; `lower` and `upper`: x and displacement of the points
    /// between the ends of that line, on either side of it. Returns the edges of the outline inside the square.
    fn inner(lower: &[(f64, f64)], upper: &[(f64, f64)]) -> Vec<[usize; 2]> {
        let corners = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ];
        let mut picture = FieldMesh {
            dim: 2,
            points: corners.map(|[x, y]| [x, y, 0.0]).into(),
            point_vectors: vec![(DISPLACEMENT.into(), vec![[1.0, 0.0, 0.0]; 6])],
            ..FieldMesh::default()
        };
        let mut row = |points: &[(f64, f64)]| -> Vec<usize> {
            let first = picture.points.len();
            for &(x, u) in points {
                picture.points.push([x, 1.0, 0.0]);
                picture.point_vectors[0].1.push([u, 0.0, 0.0]);
            }
            (first..picture.points.len()).collect()
        };
        let (below, above) = (row(lower), row(upper));
        let lower = [0, 1, 2]
            .into_iter()
            .chain(below.into_iter().rev())
            .chain([5]);
        let upper = [3, 4, 5].into_iter().chain(above).chain([2]);
        let faces = conforming(&picture, vec![lower.collect(), upper.collect()]);
        let on_line = |edge: &[usize; 2]| {
            let [a, b] = edge.map(|p| picture.points[p]);
            a[1] == 1.0 && b[1] == 1.0 && a != b
        };
        outline(&faces).into_iter().filter(on_line).collect()
    }

    #[test]
    fn an_edge_inside_a_piece_is_no_boundary_however_its_sides_are_split() {
        let none: [[usize; 2]; 0] = [];
        assert_eq!(inner(&[], &[]), none);
        assert_eq!(inner(&[(0.5, 1.0)], &[]), none);
        assert_eq!(inner(&[(0.5, 1.0)], &[(0.7, 1.0), (1.6, 0.9)]), none);
        assert_eq!(inner(&[], &[(0.3, 1.0), (0.5, 0.8), (1.9, 1.0)]), none);
        // The end of a crack in the upper face: two points of one place that move together.
        assert_eq!(inner(&[], &[(0.5, 0.8), (0.5, 0.8)]), none);
    }

    #[test]
    fn the_faces_of_a_crack_are_boundary_also_where_it_sticks() {
        // Split at the same places by points of their own: both faces, from end to end.
        assert_eq!(inner(&[(0.5, 1.0)], &[(0.5, 1.0)]).len(), 4);
        assert_eq!(
            inner(&[(0.5, 1.0), (1.5, 1.0)], &[(0.5, 0.7), (1.5, 1.3)]).len(),
            6
        );
        // Two points of one place that part are the mouth of a crack.
        assert_eq!(inner(&[], &[(0.5, 0.8), (0.5, 0.6)]).len(), 3);
    }
}
