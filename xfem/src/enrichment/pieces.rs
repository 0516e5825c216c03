//! Connected pieces of the cut body and the rigid motions its supports leave free.
//!
//! Every node has one copy on its own piece of its support and one on every other. Regions of cells join the copies they
//! touch; what stays joined is a piece of the body.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, SVD, SymmetricEigen};

use crate::geometry::boxes::{Extents, around, joined};
use crate::geometry::{Point, mean, norm, root, sub, unite};
use crate::mesh::Mesh;

use super::Enrichment;

/// A body that can move without any contact point telling.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the supports leave {} rigid motion(s) that no contact can resist", motions.len())]
pub struct MotionError {
    /// Independent motions, over all unknowns.
    pub motions: Vec<Vec<f64>>,
}

/// The connected pieces of a body.
#[derive(Debug, Clone)]
pub struct Pieces {
    /// Boxes around them [m].
    pub extents: Vec<Extents>,
    /// Copies of every node: constants of its piece functions there (all 0 on the node's own piece), and the piece of the body.
    copies: Vec<Vec<(Vec<f64>, usize)>>,
}

/// Finds the pieces.
pub fn pieces(mesh: &Mesh, enrichment: &Enrichment) -> Pieces {
    // Copies by node and constants, 0 or 1.
    let mut number: Vec<Vec<(Vec<f64>, usize)>> = vec![Vec::new(); mesh.nodes.len()];
    let mut parent: Vec<usize> = Vec::new();
    let mut copy_at = |parent: &mut Vec<usize>, node: usize, constants: Vec<f64>| {
        let known = &mut number[node];
        match known.iter().find(|(c, _)| *c == constants) {
            Some(&(_, copy)) => copy,
            None => {
                parent.push(parent.len());
                known.push((constants, parent.len() - 1));
                parent.len() - 1
            }
        }
    };
    // A node without cells of its own side still has a copy there.
    for node in 0..mesh.nodes.len() {
        let none = vec![0.0; enrichment.pieces_of(node).count()];
        copy_at(&mut parent, node, none);
    }
    let mut boxes = Vec::new();
    for cell in 0..mesh.cell_count() {
        let map = mesh.map(cell);
        let parts = enrichment.partition(cell).map(|own| &own.parts);
        let functions = enrichment.cell(cell);
        let steps = enrichment.steps(cell);
        for region in 0..enrichment.regions(cell) {
            let mut first = None;
            for &node in mesh.cell(cell) {
                let constants = enrichment.pieces_of(node as usize).map(|f| {
                    let place = functions.iter().position(|&g| g as usize == f);
                    place.map_or(0.0, |i| steps[region * functions.len() + i])
                });
                let constants = constants.collect();
                let copy = copy_at(&mut parent, node as usize, constants);
                unite(&mut parent, copy, *first.get_or_insert(copy));
            }
            let own = match parts {
                Some(parts) => around(parts[region].corners(), 0.0),
                None => around(map.iter(), 0.0),
            };
            boxes.extend(first.map(|copy| (copy, own)));
        }
    }
    let mut piece_of = vec![None; parent.len()];
    let mut count = 0;
    let copies = number
        .into_iter()
        .map(|list| {
            let numbered = list.into_iter().map(|(constants, copy)| {
                let r = root(&mut parent, copy);
                let piece = *piece_of[r].get_or_insert_with(|| {
                    count += 1;
                    count - 1
                });
                (constants, piece)
            });
            numbered.collect()
        })
        .collect::<Vec<_>>();
    let mut extents = vec![around([], 0.0); count];
    for (copy, own) in boxes {
        let piece = piece_of[root(&mut parent, copy)].unwrap_or_default();
        extents[piece] = joined(extents[piece], &own);
    }
    Pieces { extents, copies }
}

impl Pieces {
    /// Piece of a node on its own piece of its support.
    pub fn of_node(&self, node: usize) -> usize {
        self.copies[node][0].1
    }

    /// All unknowns of a field given piece by piece, 0 in the branch functions.
    ///
    /// ```text
    ///   ū + Σ_f c_f b_f = r of the copy's piece at x, for every copy of the node
    /// ```
    pub fn field(
        &self,
        mesh: &Mesh,
        enrichment: &Enrichment,
        r: impl Fn(usize, &Point) -> Point,
    ) -> Vec<f64> {
        let dim = mesh.dim();
        let mut u = vec![0.0; enrichment.functions.len() * dim];
        for (node, copies) in self.copies.iter().enumerate() {
            let x = &mesh.nodes[node];
            let own = r(copies[0].1, x);
            u[node * dim..(node + 1) * dim].copy_from_slice(&own[..dim]);
            let functions: Vec<usize> = enrichment.pieces_of(node).collect();
            let others = &copies[1..];
            let moved = others.iter().any(|copy| r(copy.1, x) != own);
            if functions.is_empty() || !moved {
                continue;
            }
            let matrix = DMatrix::from_fn(others.len(), functions.len(), |i, j| others[i].0[j]);
            let right = DMatrix::from_fn(others.len(), dim, |i, a| r(others[i].1, x)[a] - own[a]);
            // As many independent copies as functions, or fewer: the smallest solution then leaves unused ones at rest.
            let Ok(found) = SVD::new(matrix, true, true).solve(&right, 1e-12) else {
                continue;
            };
            for (j, f) in functions.into_iter().enumerate() {
                for a in 0..dim {
                    u[f * dim + a] = found[(j, a)];
                }
            }
        }
        u
    }
}

/// A basis over all unknowns of the rigid motions that the prescribed ones leave free, checked against contact.
///
/// `numbers`: number of every unknown among the free ones, `None` if prescribed; `jump(mode)`: largest jump of a motion
/// at the contact points, `mode` over all unknowns.
pub fn free_motions(
    mesh: &Mesh,
    enrichment: &Enrichment,
    numbers: &[Option<u32>],
    jump: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<Vec<Vec<f64>>, MotionError> {
    /// Eigenvalues of the normalised support matrix below this are zero: supports act on motions of order one.
    const ZERO: f64 = 1e-10;
    let pieces = pieces(mesh, enrichment);
    let modes = piece_motions(mesh, enrichment, &pieces);
    // Support matrix S_kl = Σ over prescribed unknowns of mode_k mode_l: its kernel are the free motions.
    let m = modes.len();
    let mut support = DMatrix::<f64>::zeros(m, m);
    for unknown in (0..numbers.len()).filter(|&i| numbers[i].is_none()) {
        let values = DVector::from_fn(m, |k, _| modes[k][unknown]);
        for k in (0..m).filter(|&k| values[k] != 0.0) {
            support.column_mut(k).axpy(values[k], &values, 1.0);
        }
    }
    let scale = support.diagonal().max().max(f64::MIN_POSITIVE);
    // Block by block of modes that supports tie to each other: free motions stay with their pieces.
    let mut parent: Vec<usize> = (0..m).collect();
    for (k, l) in (0..m).flat_map(|k| (0..k).map(move |l| (k, l))) {
        if support[(k, l)] != 0.0 {
            unite(&mut parent, k, l);
        }
    }
    let mut blocks: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, _) in modes.iter().enumerate() {
        blocks.entry(root(&mut parent, k)).or_default().push(k);
    }
    let mut free = Vec::new();
    for block in blocks.into_values() {
        let count = block.len();
        let own = DMatrix::from_fn(count, count, |i, j| support[(block[i], block[j])] / scale);
        let eigen = SymmetricEigen::new(own);
        let zero = (0..count).filter(|&k| eigen.eigenvalues[k].abs() < ZERO);
        free.extend(zero.map(|k| {
            let parts = block.iter().map(|&l| &modes[l]);
            combined(parts, |i| eigen.eigenvectors[(i, k)])
        }));
    }
    if !free.is_empty() {
        // Contact must feel every free motion: the Gram matrix of their jumps must be regular.
        let jumps: Vec<DVector<f64>> = free.iter().map(|mode| jump(mode).into()).collect();
        let jumps = DMatrix::from_columns(&jumps);
        let gram = jumps.tr_mul(&jumps);
        let size = gram.diagonal().max().max(f64::MIN_POSITIVE);
        let eigen = SymmetricEigen::new(gram / size);
        let motions: Vec<Vec<f64>> = (0..free.len())
            .filter(|&k| size == f64::MIN_POSITIVE || eigen.eigenvalues[k].abs() < ZERO)
            .map(|k| combined(free.iter(), |l| eigen.eigenvectors[(l, k)]))
            .collect();
        if !motions.is_empty() {
            return Err(MotionError { motions });
        }
    }
    // Near a small piece a node moves farther than that: what is solved with is of order one.
    for motion in &mut free {
        let most = motion.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        motion.iter_mut().for_each(|v| *v /= most);
    }
    Ok(free)
}

/// Σ_l c_l mode_l.
fn combined<'a>(modes: impl Iterator<Item = &'a Vec<f64>>, c: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut sum = Vec::new();
    for (l, mode) in modes.enumerate() {
        let c = c(l);
        sum.resize(mode.len(), 0.0);
        for (value, m) in sum.iter_mut().zip(mode) {
            *value += c * m;
        }
    }
    sum
}

/// All rigid motions of all pieces over all unknowns: rotations about the middle of a piece, of order one at its border. In parts of the
/// body those of a small piece would be rounding.
fn piece_motions(mesh: &Mesh, enrichment: &Enrichment, pieces: &Pieces) -> Vec<Vec<f64>> {
    let dim = mesh.dim();
    let rotations: &[[usize; 2]] = if dim == 2 {
        &[[0, 1]]
    } else {
        &[[0, 1], [1, 2], [2, 0]]
    };
    let motion = |kind: usize, piece: usize, x: &Point| -> Point {
        let [low, high] = &pieces.extents[piece];
        let (centre, size) = (mean([low, high]), norm(&sub(high, low)));
        let mut r = [0.0; 3];
        if kind < dim {
            r[kind] = 1.0;
        } else {
            let [a, b] = rotations[kind - dim];
            r[a] = -(x[b] - centre[b]) / size;
            r[b] = (x[a] - centre[a]) / size;
        }
        r
    };
    let kinds = dim + rotations.len();
    // A copy that no region has moves nothing.
    let filled = |&piece: &usize| pieces.extents[piece][0] <= pieces.extents[piece][1];
    let all = (0..pieces.extents.len())
        .filter(filled)
        .flat_map(|piece| (0..kinds).map(move |kind| (piece, kind)));
    all.map(|(piece, kind)| {
        pieces.field(mesh, enrichment, |p, x| {
            if p == piece {
                motion(kind, piece, x)
            } else {
                [0.0; 3]
            }
        })
    })
    .collect()
}
