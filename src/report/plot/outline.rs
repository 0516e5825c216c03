//! Boundaries of bodies whose picture cells need not share points.
//!
//! Parts of a cut cell have points of their own, so neighbours are found by place. The two faces of a crack lie in the
//! same place too; they stay apart because their cells are on opposite sides, or because their displacements differ.

use crate::model::field_mesh::FieldMesh;
use std::collections::BTreeMap;

/// Points nearer than this fraction of the body's size are one place.
const SAME_PLACE: f64 = 1e-7;
/// Displacements nearer than this fraction of the largest are equal.
const SAME_DISPLACEMENT: f64 = 1e-7;

/// Places of points, and whether two faces or edges in one place belong together.
pub struct Weld<'a> {
    /// Number of the place of every point.
    pub place: Vec<usize>,
    displacement: &'a [[f64; 3]],
    tolerance: f64,
}

impl<'a> Weld<'a> {
    /// Finds the places; `displacement` has one vector per point.
    pub fn new(picture: &FieldMesh, displacement: &'a [[f64; 3]]) -> Self {
        let largest = |vectors: &[[f64; 3]]| {
            let values = vectors.iter().flatten().map(|c| c.abs());
            values
                .filter(|c| c.is_finite())
                .fold(f64::MIN_POSITIVE, f64::max)
        };
        let grid = SAME_PLACE * largest(&picture.points);
        let mut numbers = BTreeMap::new();
        let place = picture
            .points
            .iter()
            .map(|x| {
                let next = numbers.len();
                *numbers
                    .entry(x.map(|c| (c / grid).round() as i64))
                    .or_insert(next)
            })
            .collect();
        let tolerance = SAME_DISPLACEMENT * largest(displacement);
        Self {
            place,
            displacement,
            tolerance,
        }
    }

    /// Whether two sets of points in the same places move together.
    pub fn moves_with(&self, a: &[usize], b: &[usize]) -> bool {
        a.iter().all(|p| {
            let twin = b.iter().find(|q| self.place[**q] == self.place[*p]);
            twin.is_some_and(|q| {
                let (u, v) = (self.displacement[*p], self.displacement[*q]);
                (0..3).all(|c| (u[c] - v[c]).abs() <= self.tolerance)
            })
        })
    }
}

/// Values of a cell scalar, 0 where the picture has none of that name.
pub fn cell_scalar(picture: &FieldMesh, name: &str) -> Vec<f64> {
    let found = picture.cell_scalars.iter().find(|(n, _)| n == name);
    let mut values = found.map(|(_, values)| values.clone()).unwrap_or_default();
    values.resize(picture.cells.len(), 0.0);
    values
}

/// A plane face and the side of the crack that it is on: +1, −1, or 0 for neither.
pub struct Face {
    pub points: Vec<usize>,
    pub side: f64,
}

/// Edges of the body's boundary and of crack faces.
pub fn outline(picture: &FieldMesh, faces: &[Face], weld: &Weld<'_>) -> Vec<[usize; 2]> {
    let mut edges: Vec<([usize; 2], [usize; 2], f64)> = faces
        .iter()
        .flat_map(|face| {
            let n = face.points.len();
            (0..n).map(move |i| ([face.points[i], face.points[(i + 1) % n]], face.side))
        })
        .map(|(edge, side)| {
            let [a, b] = edge.map(|p| weld.place[p]);
            ([a.min(b), a.max(b)], edge, side)
        })
        .filter(|(places, _, _)| places[0] != places[1])
        .collect();
    edges.sort_by_key(|(places, edge, _)| (*places, *edge));

    let (mut kept, mut single) = (Vec::new(), Vec::new());
    for equal in edges.chunk_by(|a, b| a.0 == b.0) {
        match equal {
            [(_, edge, _)] => single.push(*edge),
            [a, b] => {
                // The faces of a crack have points of their own, whether they move apart or not.
                let same = a.1 == b.1 || a.1 == [b.1[1], b.1[0]];
                let crack = !same && (a.2 * b.2 < 0.0 || !weld.moves_with(&a.1, &b.1));
                kept.extend(crack.then_some([a.1, b.1]).into_iter().flatten());
            }
            more => kept.extend(more.iter().map(|(_, edge, _)| *edge)),
        }
    }
    kept.extend(without_hanging(picture, single, weld));
    kept
}

/// Without the edges where one long edge meets two short ones: beside the tip of a crack, which ends inside a cell.
fn without_hanging(
    picture: &FieldMesh,
    single: Vec<[usize; 2]>,
    weld: &Weld<'_>,
) -> Vec<[usize; 2]> {
    let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (index, edge) in single.iter().enumerate() {
        for point in edge {
            at.entry(weld.place[*point]).or_default().push(index);
        }
    }
    let between = |a: usize, c: usize, b: usize| {
        let [a, c, b] = [a, c, b].map(|p| picture.points[p]);
        let length =
            |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
        length(a, c) + length(c, b) <= length(a, b) * (1.0 + SAME_PLACE)
    };
    let mut dropped = vec![false; single.len()];
    for (long, [a, b]) in single.iter().enumerate() {
        let ends = [a, b].map(|p| weld.place[*p]);
        let near = |end: usize| at[&end].iter().copied().filter(move |i| *i != long);
        for first in near(ends[0]) {
            let Some(c) = single[first].iter().find(|p| weld.place[**p] != ends[0]) else {
                continue;
            };
            let second =
                near(ends[1]).find(|i| single[*i].iter().any(|p| weld.place[*p] == weld.place[*c]));
            // The two faces of a crack that another one meets look alike, but have points of their own.
            let second = second.filter(|i| single[first].contains(a) && single[*i].contains(b));
            if let Some(second) = second.filter(|_| between(*a, *c, *b)) {
                for index in [long, first, second] {
                    dropped[index] = true;
                }
            }
        }
    }
    let kept = single
        .into_iter()
        .zip(dropped)
        .filter(|(_, dropped)| !dropped);
    kept.map(|(edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::field_mesh::{CellShape, FieldCell};

    /// A square left of a square that is cut at half height, every part with points of its own.
    fn cut_beside_whole(jump: f64) -> (FieldMesh, Vec<Face>, Vec<[f64; 3]>) {
        let mut picture = FieldMesh {
            dim: 2,
            ..FieldMesh::default()
        };
        // The cells share their points, but for the faces of the crack from (1, 0.5) to (2, 0.5).
        let points = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [2.0, 0.0],
            [2.0, 0.5],
            [1.0, 0.5],
            [2.0, 0.5],
            [2.0, 1.0],
        ];
        picture.points = points.map(|[x, y]| [x, y, 0.0]).to_vec();
        let mut displacement = vec![[0.0; 3]; points.len()];
        displacement[7][0] = jump;
        let parts = [
            (0.0, vec![0, 1, 2, 3]),
            (-1.0, vec![1, 4, 5, 6]),
            (1.0, vec![6, 7, 8, 2]),
        ];
        let mut faces = Vec::new();
        for (side, points) in parts {
            picture.cells.push(FieldCell {
                shape: CellShape::Quad,
                points: points.clone(),
            });
            faces.push(Face { points, side });
        }
        (picture, faces, displacement)
    }

    #[test]
    fn only_the_boundary_and_the_crack_are_outlined() {
        for jump in [0.0, 0.3] {
            let (picture, faces, displacement) = cut_beside_whole(jump);
            let weld = Weld::new(&picture, &displacement);
            let edges = outline(&picture, &faces, &weld);
            let upright_inside = edges
                .iter()
                .filter(|edge| edge.iter().all(|p| picture.points[*p][0] == 1.0))
                .count();
            assert_eq!(
                upright_inside, 0,
                "the long edge beside the tip and its two halves"
            );
            let faces_of_crack = edges
                .iter()
                .filter(|edge| edge.iter().all(|p| picture.points[*p][1] == 0.5))
                .count();
            assert_eq!(faces_of_crack, 2, "closed or not, both faces of the crack");
            assert_eq!(edges.len(), 2 + 3 + 4);
        }
    }
}
