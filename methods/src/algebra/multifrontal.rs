//! Multifrontal Cholesky factorisation L Lᵀ = A of a sparse symmetric matrix with unit diagonal (Duff and Reid 1983,
//! Liu 1992): dense fronts along a tree, whose branches are worked on at the same time. The same bits for any number of
//! threads.

mod analysis;
mod front;
mod schedule;
mod solve;
#[cfg(test)]
mod tests;
mod tree;

use std::sync::{Mutex, OnceLock, PoisonError};

use faer::MatRef;

use crate::algebra::strips::Failure;

pub(crate) use analysis::{Analysis, Entries, Ordering};
use front::{Front, Update};
pub(crate) use tree::AssemblyTree;

/// Multiplications below which threads cost more than they bring.
const WORTH_THREADS: f64 = 1e7;

/// The factor.
pub(crate) struct Cholesky {
    pub tree: AssemblyTree,
    /// Rows of every supernode by its columns, column by column.
    panels: Vec<Vec<f64>>,
}

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// This column of L has no positive pivot.
    NotPositive(usize),
    OutOfMemory,
}

impl Cholesky {
    /// Factors the matrix with these entries below its diagonal of ones.
    pub fn new(tree: AssemblyTree, entries: &Entries, values: &[f64]) -> Result<Self, Fault> {
        let nodes = &tree.nodes;
        let panels: Vec<OnceLock<Vec<f64>>> = nodes.iter().map(|_| OnceLock::new()).collect();
        let updates: Vec<Mutex<Option<Update>>> = nodes.iter().map(|_| Mutex::new(None)).collect();
        let fault = Mutex::new(None::<Fault>);
        let update_of = |s: usize| updates[s].lock().unwrap_or_else(PoisonError::into_inner);
        let eliminate = |s: usize| -> Result<(), Failure> {
            let node = &nodes[s];
            let mut front = Front::zeros(node.columns.len(), node.height())?;
            for (k, c) in node.columns.clone().enumerate() {
                let column = &mut front.panel[k * node.height()..][..node.height()];
                column[k] = 1.0;
                for e in entries.begin[c]..entries.begin[c + 1] {
                    column[entries.place[e] as usize] = values[e];
                }
            }
            for &child in &tree.children[s] {
                // Without an update of a child there is no factor.
                let Some(update) = update_of(child).take() else {
                    return Ok(());
                };
                front.extend_add(&update, tree.places(child));
            }
            front.eliminate()?;
            let _ = panels[s].set(front.panel);
            *update_of(s) = Some(front.update);
            Ok(())
        };
        let work: f64 = nodes
            .iter()
            .filter(|s| s.parent == tree::NONE)
            .map(|s| s.work)
            .sum();
        tree.upwards(work > WORTH_THREADS, |s| {
            if let Err(failure) = eliminate(s) {
                let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
                *fault = Some(Fault::first(*fault, failure, nodes[s].columns.start));
            }
        });
        match fault.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(fault) => Err(fault),
            None => Ok(Self {
                panels: panels
                    .into_iter()
                    .map(|p| p.into_inner().unwrap_or_default())
                    .collect(),
                tree,
            }),
        }
    }

    /// The first column whose pivot in A, l², is below a bound.
    pub fn pivot_below(&self, least: f64) -> Option<usize> {
        let first = |s: usize| {
            let (panel, begin) = (self.panel(s), self.tree.nodes[s].columns.start);
            let small = |&k: &usize| panel[(k, k)].powi(2) < least;
            (0..panel.ncols()).find(small).map(|k| begin + k)
        };
        (0..self.tree.nodes.len()).find_map(first)
    }

    /// L of supernode `s`: the columns' own rows, the lower triangle of which counts, over those below.
    pub fn panel(&self, s: usize) -> MatRef<'_, f64> {
        let node = &self.tree.nodes[s];
        MatRef::from_column_major_slice(&self.panels[s], node.height(), node.columns.len())
    }
}

impl Fault {
    /// What is reported whoever came first: no memory, else the first column.
    fn first(before: Option<Self>, failure: Failure, begin: usize) -> Self {
        match (before, failure) {
            (Some(Self::OutOfMemory), _) | (_, Failure::OutOfMemory) => Self::OutOfMemory,
            (None, Failure::NotPositive(k)) => Self::NotPositive(begin + k),
            (Some(Self::NotPositive(c)), Failure::NotPositive(k)) => {
                Self::NotPositive(c.min(begin + k))
            }
        }
    }
}
