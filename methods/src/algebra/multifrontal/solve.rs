//! Forward and back substitution along the tree.

use std::sync::{Mutex, OnceLock, PoisonError};

use crate::algebra::multifrontal::{Cholesky, parts};

/// Numbers in L from which threads are worth it.
const WORTH_THREADS: usize = 1_000_000;
/// Sums run in this many lanes.
const LANES: usize = 8;

impl Cholesky {
    /// x := (L Lᵀ)⁻¹ x.
    pub fn solve(&self, x: &mut [f64]) {
        let tree = &self.tree;
        let threads = tree.entries() > WORTH_THREADS;
        // Front by supernode: first the right-hand side with what came from below, then the solution.
        let parts = parts(x, tree.nodes.iter().map(|node| node.columns.len()));
        let parts: Vec<Mutex<&mut [f64]>> = parts.into_iter().map(Mutex::new).collect();
        let updates: Vec<OnceLock<Vec<f64>>> = tree.nodes.iter().map(|_| OnceLock::new()).collect();
        let own = |s: usize| parts[s].lock().unwrap_or_else(PoisonError::into_inner);
        tree.upwards(threads, |s| {
            let (node, mut x) = (&tree.nodes[s], own(s));
            let (columns, height) = (node.columns.len(), node.height());
            let mut front = vec![0.0; height];
            front[..columns].copy_from_slice(&x);
            for &child in &tree.children[s] {
                let update = updates[child].get().map_or(&[][..], Vec::as_slice);
                for (&place, value) in tree.places(child).iter().zip(update) {
                    front[place as usize] += value;
                }
            }
            let (panel, shape) = (self.panel(s), node.shape());
            for k in 0..columns {
                let column = &panel[shape.column(k)];
                let (done, below) = front.split_at_mut(k + 1);
                done[k] /= column[0];
                for (below, l) in below.iter_mut().zip(&column[1..]) {
                    *below -= l * done[k];
                }
            }
            x.copy_from_slice(&front[..columns]);
            let _ = updates[s].set(front.split_off(columns));
        });
        let fronts: Vec<OnceLock<Vec<f64>>> = tree.nodes.iter().map(|_| OnceLock::new()).collect();
        tree.downwards(threads, |s| {
            let (node, mut x) = (&tree.nodes[s], own(s));
            let columns = node.columns.len();
            let mut front = x.to_vec();
            let above = fronts.get(node.parent).and_then(OnceLock::get);
            let above = above.map_or(&[][..], Vec::as_slice);
            front.extend(tree.places(s).iter().map(|&place| above[place as usize]));
            let (panel, shape) = (self.panel(s), node.shape());
            for k in (0..columns).rev() {
                let column = &panel[shape.column(k)];
                let (own, below) = front.split_at_mut(k + 1);
                own[k] = (own[k] - dot(&column[1..], below)) / column[0];
            }
            x.copy_from_slice(&front[..columns]);
            let _ = fronts[s].set(front);
        });
    }
}

/// a·b in lanes, the same on every machine.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut lanes, whole) = ([0.0; LANES], a.len() / LANES * LANES);
    for (a, b) in a[..whole]
        .chunks_exact(LANES)
        .zip(b[..whole].chunks_exact(LANES))
    {
        for l in 0..LANES {
            lanes[l] += a[l] * b[l];
        }
    }
    let rest: f64 = a[whole..].iter().zip(&b[whole..]).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f64>() + rest
}
