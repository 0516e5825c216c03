//! The boundary of a solid as patches: plane pieces that belong to one cell of the mesh.
//!
//! A cut cell comes as many tetrahedra; its faces are put together again, so that the picture shows the mesh and not the
//! tetrahedra. Cells of one mesh cell have the same value of the cell scalar `cell`.

use super::outline::{Weld, cell_scalar};
use crate::model::field_mesh::{CellShape, FieldCell, FieldMesh};
use crate::report::ReportError;
use std::collections::BTreeMap;

/// Name of the cell scalar that holds the number of the mesh cell.
pub const MESH_CELL: &str = "cell";
/// Name of the cell scalar that holds the side of the crack.
pub const SIDE: &str = "side";
/// Normals that agree to this are one.
const SAME_NORMAL: f64 = 1e-3;

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

/// A plane piece of the boundary.
pub struct Patch {
    /// Faces with outward normals.
    pub faces: Vec<Vec<usize>>,
    /// Edges that bound the piece.
    pub outline: Vec<[usize; 2]>,
    side: f64,
}

/// The patches that bound the solid, crack faces among them.
///
/// # Errors
/// [`ReportError::FieldMesh`] when there is no solid cell, or one with the wrong points.
pub fn boundary(picture: &FieldMesh, weld: &Weld<'_>) -> Result<Vec<Patch>, ReportError> {
    // Patches in the same place have the same places of edges.
    let mut found: BTreeMap<Vec<[usize; 2]>, Vec<Patch>> = BTreeMap::new();
    for patch in patches(picture, weld)? {
        let mut places: Vec<[usize; 2]> = patch
            .outline
            .iter()
            .map(|edge| edge.map(|p| weld.place[p]))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        places.sort_unstable();
        found.entry(places).or_default().push(patch);
    }
    let corners =
        |patch: &Patch| -> Vec<usize> { patch.outline.iter().flatten().copied().collect() };
    found.retain(|_, equal| match &equal[..] {
        [a, b] => a.side * b.side < 0.0 || !weld.moves_with(&corners(a), &corners(b)),
        _ => true,
    });
    Ok(found.into_values().flatten().collect())
}

/// Faces of every mesh cell, those inside it dropped, those in one plane together.
fn patches(picture: &FieldMesh, weld: &Weld<'_>) -> Result<Vec<Patch>, ReportError> {
    let sides = cell_scalar(picture, SIDE);
    let numbered = picture
        .cell_scalars
        .iter()
        .any(|(name, _)| name == MESH_CELL);
    let numbers = cell_scalar(picture, MESH_CELL);
    // Without numbers every cell stands for itself.
    let parent = |index: usize| {
        if numbered {
            numbers[index].to_bits()
        } else {
            index as u64
        }
    };
    let mut cells: BTreeMap<(u64, bool), Vec<usize>> = BTreeMap::new();
    for (index, cell) in picture.cells.iter().enumerate() {
        if check(picture, index, cell)? {
            cells
                .entry((parent(index), sides[index] < 0.0))
                .or_default()
                .push(index);
        }
    }
    if cells.is_empty() {
        return Err(ReportError::field_mesh(
            "cells",
            "no hexahedron or tetrahedron".into(),
        ));
    }
    let mut patches = Vec::new();
    for members in cells.values() {
        let mut faces: BTreeMap<Vec<usize>, Vec<Vec<usize>>> = BTreeMap::new();
        for face in members
            .iter()
            .flat_map(|index| cell_faces(picture, &picture.cells[*index]))
        {
            let mut places: Vec<usize> = face.iter().map(|p| weld.place[*p]).collect();
            places.sort_unstable();
            faces.entry(places).or_default().push(face);
        }
        let mut planes: BTreeMap<[i64; 3], Vec<Vec<usize>>> = BTreeMap::new();
        for face in faces
            .into_values()
            .filter(|equal| equal.len() == 1)
            .flatten()
        {
            if let Some(normal) = normal(picture, &face) {
                planes.entry(normal).or_default().push(face);
            }
        }
        let side = sides[members[0]];
        patches.extend(planes.into_values().map(|faces| {
            let outline = open_edges(&faces, weld);
            Patch {
                faces,
                outline,
                side,
            }
        }));
    }
    Ok(patches)
}

/// Whether a cell is solid.
fn check(picture: &FieldMesh, index: usize, cell: &FieldCell) -> Result<bool, ReportError> {
    let needed = match cell.shape {
        CellShape::Hexahedron => 8,
        CellShape::Tetra => 4,
        _ => return Ok(false),
    };
    let known = cell.points.iter().all(|p| *p < picture.points.len());
    if cell.points.len() != needed || !known {
        return Err(ReportError::field_mesh(
            "cells",
            format!("cell {index} has wrong points"),
        ));
    }
    Ok(true)
}

/// Faces of a cell with outward normals; the points of a tetrahedron may come in either orientation.
fn cell_faces(picture: &FieldMesh, cell: &FieldCell) -> Vec<Vec<usize>> {
    let faces: &[&[usize]] = match cell.shape {
        CellShape::Hexahedron => &HEXAHEDRON,
        CellShape::Tetra => &TETRA,
        _ => &[],
    };
    let mirrored = cell.shape == CellShape::Tetra && {
        let x = |i: usize| picture.points[cell.points[i]];
        let edge = |i: usize| -> [f64; 3] { std::array::from_fn(|c| x(i)[c] - x(0)[c]) };
        let [a, b, c] = [edge(1), edge(2), edge(3)];
        let minor = |d: usize, e: usize| b[d] * c[e] - b[e] * c[d];
        a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1) < 0.0
    };
    let corners = |face: &&[usize]| -> Vec<usize> {
        let points = face.iter().map(|i| cell.points[*i]);
        if mirrored {
            points.rev().collect()
        } else {
            points.collect()
        }
    };
    faces.iter().map(corners).collect()
}

/// Outward normal of a face, rounded; none for a face without area.
///
/// A part of a mesh cell is convex, so its faces with one normal lie in one plane.
fn normal(picture: &FieldMesh, face: &[usize]) -> Option<[i64; 3]> {
    // Newell's sum serves quads that are not quite plane.
    let mut normal = [0.0; 3];
    for (i, point) in face.iter().enumerate() {
        let next = face[(i + 1) % face.len()];
        let (a, b) = (picture.points[*point], picture.points[next]);
        for c in 0..3 {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            normal[c] += (a[d] - b[d]) * (a[e] + b[e]);
        }
    }
    let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
    (length > 0.0).then(|| normal.map(|c| (c / length / SAME_NORMAL).round() as i64))
}

/// Edges of exactly one of the faces.
fn open_edges(faces: &[Vec<usize>], weld: &Weld<'_>) -> Vec<[usize; 2]> {
    let mut edges: Vec<([usize; 2], [usize; 2])> = faces
        .iter()
        .flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]))
        .map(|edge| {
            let [a, b] = edge.map(|p| weld.place[p]);
            ([a.min(b), a.max(b)], edge)
        })
        .filter(|(places, _)| places[0] != places[1])
        .collect();
    edges.sort_unstable();
    let single = edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|equal| equal.len() == 1);
    single.map(|equal| equal[0].1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit cube beside one that comes as six tetrahedra with points of their own.
    fn cubes(numbered: bool) -> FieldMesh {
        let corner = |i: usize, x: f64| {
            [
                x + f64::from(u8::from(matches!(i, 1 | 2 | 5 | 6))),
                f64::from(u8::from(matches!(i, 2 | 3 | 6 | 7))),
                f64::from(u8::from(i > 3)),
            ]
        };
        let mut picture = FieldMesh {
            dim: 3,
            ..FieldMesh::default()
        };
        picture.points.extend((0..8).map(|i| corner(i, 0.0)));
        let points = (0..8).collect();
        picture.cells.push(FieldCell {
            shape: CellShape::Hexahedron,
            points,
        });
        let around = [1, 2, 3, 7, 4, 5];
        for (i, a) in around.into_iter().enumerate() {
            let b = around[(i + 1) % 6];
            let first = picture.points.len();
            // Every other one mirrored.
            let tetra = if i % 2 == 0 {
                [0, a, b, 6]
            } else {
                [0, b, a, 6]
            };
            picture.points.extend(tetra.map(|c| corner(c, 1.0)));
            let points = (first..first + 4).collect();
            picture.cells.push(FieldCell {
                shape: CellShape::Tetra,
                points,
            });
        }
        if numbered {
            let numbers = [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
            picture
                .cell_scalars
                .push((MESH_CELL.into(), numbers.to_vec()));
        }
        picture
    }

    fn patches_of(picture: &FieldMesh) -> Vec<Patch> {
        let displacement = vec![[0.0; 3]; picture.points.len()];
        boundary(picture, &Weld::new(picture, &displacement)).expect("solid cells")
    }

    #[test]
    fn tetrahedra_of_a_cell_show_as_its_faces() {
        let patches = patches_of(&cubes(true));
        assert_eq!(
            patches.len(),
            10,
            "five faces of each cube, none between them"
        );
        assert!(
            patches.iter().all(|patch| patch.outline.len() == 4),
            "no diagonals"
        );
        // Without numbers: five quads, ten triangles, and the face between that does not match its halves.
        assert_eq!(patches_of(&cubes(false)).len(), 5 + 10 + 1 + 2);
    }

    #[test]
    fn faces_that_slide_on_each_other_stay() {
        let picture = cubes(true);
        let mut displacement = vec![[0.0; 3]; picture.points.len()];
        for u in &mut displacement[8..] {
            u[2] = 0.1;
        }
        let patches = boundary(&picture, &Weld::new(&picture, &displacement)).expect("solid cells");
        assert_eq!(patches.len(), 12);
    }
}
