//! Connected pieces of the cut body and the rigid motions its supports leave free.
//!
//! Every node has one copy per side of a crack that cuts its cells: the standard function is the copy on the node's own
//! side, the Heaviside function the one across. Cells join the copies they touch; what stays joined is a piece. A rigid
//! motion r of a piece reads, in the functions of the body,
//!
//! ```text
//!   ū_i = r(x_i) if the own copy belongs to the piece,     b_j = ½ H_j (r_own − r_across)
//! ```

use nalgebra::{DMatrix, SymmetricEigen};

use crate::fem::Point;
use crate::fem::mesh::Mesh;

use super::basis::FunctionKind;
use super::enrichment::Enrichment;

/// Rigid motions left free.
#[derive(Debug, Clone)]
pub struct FreeMotions {
    /// Basis of ker K over the free unknowns; empty if the supports hold every piece.
    pub modes: Vec<Vec<f64>>,
}

/// A body that can move without any contact resisting.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// A piece touches no support.
    #[error("the piece of the body around {at:?} is cut off and touches no support")]
    Unsupported {
        /// Mean position of its nodes [m].
        at: Point,
    },
    /// A rigid motion opens no crack.
    #[error("the supports leave {count} rigid motion(s) that no contact can resist")]
    Rigid {
        /// Number of independent motions.
        count: usize,
    },
}

/// Piece of every copy: index = function number (standard: own copy, Heaviside: copy across), `None` for branch functions.
pub fn pieces(mesh: &Mesh, enrichment: &Enrichment) -> (Vec<Option<usize>>, usize) {
    let count = enrichment.functions.len();
    let mut parent: Vec<usize> = (0..count).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for cell in 0..mesh.cell_count() {
        let split = enrichment.split[cell];
        let sides: &[f64] = if split.is_some() {
            &[1.0, -1.0]
        } else {
            &[0.0]
        };
        for &side in sides {
            let mut first = None;
            for &node in mesh.cell(cell) {
                let across = enrichment.enriched_of(node as usize).find(|&f| {
                    let FunctionKind::Heaviside { crack } = enrichment.functions[f].kind else {
                        return false;
                    };
                    // A whole cell lists only the functions of cracks it lies across.
                    if Some(crack) == split {
                        enrichment.shifts[f] != side
                    } else {
                        enrichment.cell(cell).contains(&(f as u32))
                    }
                });
                let copy = root(&mut parent, across.unwrap_or(node as usize));
                match first {
                    None => first = Some(copy),
                    Some(other) => parent[copy] = root(&mut parent, other),
                }
            }
        }
    }
    let mut number = vec![None; count];
    let mut total = 0;
    let piece = (0..count)
        .map(|f| {
            if matches!(enrichment.functions[f].kind, FunctionKind::Branch { .. }) {
                return None;
            }
            let r = root(&mut parent, f);
            Some(*number[r].get_or_insert_with(|| {
                total += 1;
                total - 1
            }))
        })
        .collect();
    (piece, total)
}

/// The rigid motions that the prescribed unknowns leave free, checked against contact.
///
/// `numbers`: number of every unknown among the free ones, `None` if prescribed; `jump(mode)`: largest jump of a motion
/// at the contact points, `mode` over all unknowns.
pub fn free_motions(
    mesh: &Mesh,
    enrichment: &Enrichment,
    numbers: &[Option<u32>],
    jump: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<FreeMotions, MotionError> {
    /// Eigenvalues of the normalised support matrix below this are zero: supports act on motions of order one.
    const ZERO: f64 = 1e-10;
    let dim = mesh.dim();
    let (piece, count) = pieces(mesh, enrichment);
    let mut held = vec![false; count];
    for (f, p) in piece.iter().enumerate() {
        if let (Some(p), FunctionKind::Standard) = (p, enrichment.functions[f].kind) {
            held[*p] |= (0..dim).any(|a| numbers[f * dim + a].is_none());
        }
    }
    if let Some(loose) = held.iter().position(|h| !h) {
        if count > 1 {
            let own: Vec<&Point> = (0..mesh.nodes.len())
                .filter(|&n| piece[n] == Some(loose))
                .map(|n| &mesh.nodes[n])
                .collect();
            let at =
                [0, 1, 2].map(|a| own.iter().map(|x| x[a]).sum::<f64>() / own.len().max(1) as f64);
            return Err(MotionError::Unsupported { at });
        }
        let count = if dim == 2 { 3 } else { 6 };
        return Err(MotionError::Rigid { count });
    }
    let modes = piece_motions(mesh, enrichment, &piece, count);
    // Support matrix S_kl = Σ over prescribed unknowns of mode_k mode_l: its kernel are the free motions.
    let m = modes.len();
    let mut support = DMatrix::<f64>::zeros(m, m);
    for unknown in (0..numbers.len()).filter(|&i| numbers[i].is_none()) {
        let values: Vec<f64> = modes.iter().map(|mode| mode[unknown]).collect();
        for k in 0..m {
            if values[k] != 0.0 {
                for l in 0..m {
                    support[(k, l)] += values[k] * values[l];
                }
            }
        }
    }
    let scale = support.diagonal().max().max(f64::MIN_POSITIVE);
    let eigen = SymmetricEigen::new(support / scale);
    let free: Vec<Vec<f64>> = (0..m)
        .filter(|&k| eigen.eigenvalues[k].abs() < ZERO)
        .map(|k| {
            let mut mode = vec![0.0; numbers.len()];
            for (l, part) in modes.iter().enumerate() {
                let c = eigen.eigenvectors[(l, k)];
                for (value, p) in mode.iter_mut().zip(part) {
                    *value += c * p;
                }
            }
            mode
        })
        .collect();
    if !free.is_empty() {
        // Contact must feel every free motion: the Gram matrix of their jumps must be regular.
        let jumps: Vec<Vec<f64>> = free.iter().map(|mode| jump(mode)).collect();
        let gram = DMatrix::<f64>::from_fn(free.len(), free.len(), |k, l| {
            jumps[k].iter().zip(&jumps[l]).map(|(a, b)| a * b).sum()
        });
        let size = gram.diagonal().max().max(f64::MIN_POSITIVE);
        let values = SymmetricEigen::new(gram / size).eigenvalues;
        let silent = if size == f64::MIN_POSITIVE {
            free.len()
        } else {
            values.iter().filter(|v| v.abs() < ZERO).count()
        };
        if silent > 0 {
            return Err(MotionError::Rigid { count: silent });
        }
    }
    let modes = free
        .into_iter()
        .map(|mode| {
            (0..numbers.len())
                .filter(|&i| numbers[i].is_some())
                .map(|i| mode[i])
                .collect()
        })
        .collect();
    Ok(FreeMotions { modes })
}

/// All rigid motions of all pieces over all unknowns; rotations scaled to order one.
fn piece_motions(
    mesh: &Mesh,
    enrichment: &Enrichment,
    piece: &[Option<usize>],
    count: usize,
) -> Vec<Vec<f64>> {
    let dim = mesh.dim();
    let (size, centre) = mesh.extent();
    let rotations: &[[usize; 2]] = if dim == 2 {
        &[[0, 1]]
    } else {
        &[[0, 1], [1, 2], [2, 0]]
    };
    let motion = |kind: usize, x: &Point| -> Point {
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
    let mut modes = Vec::with_capacity(count * kinds);
    for p in 0..count {
        for kind in 0..kinds {
            let mut mode = vec![0.0; enrichment.functions.len() * dim];
            for (f, function) in enrichment.functions.iter().enumerate() {
                let node = function.node as usize;
                let factor = match function.kind {
                    FunctionKind::Standard if piece[f] == Some(p) => 1.0,
                    FunctionKind::Heaviside { .. } => {
                        let own = f64::from(u8::from(piece[node] == Some(p)));
                        let across = f64::from(u8::from(piece[f] == Some(p)));
                        0.5 * enrichment.shifts[f] * (own - across)
                    }
                    _ => 0.0,
                };
                if factor != 0.0 {
                    let r = motion(kind, &mesh.nodes[node]);
                    for a in 0..dim {
                        mode[f * dim + a] = factor * r[a];
                    }
                }
            }
            modes.push(mode);
        }
    }
    modes
}
