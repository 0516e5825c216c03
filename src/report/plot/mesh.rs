//! What pictures of meshes share: faces and edges of the boundary, the deformed shape, lines along edges.
//!
//! Cells of a picture share their points, but for the faces of a crack, which have points of their own: what belongs to one
//! cell alone is the boundary, crack faces among it.

use super::axis::{nice_step, range};
use super::bands::chains;
use super::canvas::{Canvas, Pixel};
use super::style::Rgb;
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
    let factor = match largest > 0.0 && diameter > 0.0 {
        true => nice_step(0.02 * diameter / largest),
        false => 1.0,
    };
    let moved = picture.points.iter().zip(displacement);
    let places = moved.map(|(x, u)| std::array::from_fn(|c| x[c] + factor * u[c]));
    Ok((places.collect(), factor))
}

/// The sides of a closed polygon.
pub fn sides(face: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]])
}

/// Edges of exactly one of the faces, without those where one long edge meets two short ones: beside the tip of a crack,
/// which ends inside a cell.
pub fn outline(picture: &FieldMesh, faces: &[Vec<usize>]) -> Vec<[usize; 2]> {
    let mut count: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for [a, b] in faces.iter().flat_map(|face| sides(face)) {
        *count.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    let single: BTreeSet<[usize; 2]> = count
        .into_iter()
        .filter(|(_, n)| *n == 1)
        .map(|(e, _)| e)
        .collect();
    let mut at: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for [a, b] in &single {
        at.entry(*a).or_default().insert(*b);
        at.entry(*b).or_default().insert(*a);
    }
    let length = |p: usize, q: usize| {
        let d = (0..3).map(|c| (picture.points[p][c] - picture.points[q][c]).powi(2));
        d.sum::<f64>().sqrt()
    };
    let mut kept = single.clone();
    for [a, b] in &single {
        let between =
            |c: &&usize| length(*a, **c) + length(**c, *b) <= length(*a, *b) * (1.0 + 1e-7);
        if let Some(c) = at[a].intersection(&at[b]).find(between) {
            for [p, q] in [[*a, *b], [*a, *c], [*b, *c]] {
                kept.remove(&[p.min(q), p.max(q)]);
            }
        }
    }
    kept.into_iter().collect()
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
