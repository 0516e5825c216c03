//! Multifrontal Cholesky factorisation L Lᵀ = A of a sparse symmetric matrix with unit diagonal (Duff and Reid 1983,
//! Liu 1992): dense fronts along a tree, whose branches are worked on at the same time. The same bits for any number of
//! threads.

mod analysis;
mod condense;
mod front;
mod schedule;
mod solve;
#[cfg(test)]
mod tests;
mod tree;

use std::sync::{Mutex, OnceLock, PoisonError};

use faer::MatRef;

use crate::algebra::strips::{Failure, WORTH_THREADS};

pub(crate) use analysis::{Analysis, Entries, Ordering};
use front::{Front, Update};
use tree::AssemblyTree;

/// The factor.
pub(crate) struct Cholesky {
    pub tree: AssemblyTree,
    /// Rows of every supernode by its columns, column by column.
    panels: Vec<Vec<f64>>,
}

impl Cholesky {
    /// Factors the matrix with these entries below its diagonal of ones.
    ///
    /// # Errors
    /// The same whatever the number of threads: no memory, else the first column without a positive pivot.
    pub fn new(tree: AssemblyTree, entries: &Entries, values: &[f64]) -> Result<Self, Failure> {
        let nodes = &tree.nodes;
        let panels: Vec<OnceLock<Vec<f64>>> = nodes.iter().map(|_| OnceLock::new()).collect();
        let updates: Vec<Mutex<Option<Update>>> = nodes.iter().map(|_| Mutex::new(None)).collect();
        let failure = Mutex::new(None::<Failure>);
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
        tree.upwards(tree.work() > WORTH_THREADS, |s| {
            if let Err(own) = eliminate(s) {
                let own = own.behind(nodes[s].columns.start);
                let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
                *failure = Some(failure.map_or(own, |before| before.or(own)));
            }
        });
        match (failure.into_inner()).unwrap_or_else(PoisonError::into_inner) {
            Some(failure) => Err(failure),
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
