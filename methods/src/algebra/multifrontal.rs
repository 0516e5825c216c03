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

use std::sync::{Arc, Mutex, PoisonError};

use faer::MatRef;

use crate::algebra::strips::{Failure, WORTH_THREADS};

pub(crate) use analysis::{Analysis, Entries, Ordering};
pub(crate) use condense::{Columns, Shared};
use front::{Front, Update};
use tree::{AssemblyTree, NONE};

/// The factor.
pub(crate) struct Cholesky {
    pub tree: Arc<AssemblyTree>,
    /// The columns of every supernode, by strips: see [`Trapezoid`](crate::algebra::strips::Trapezoid).
    values: Vec<f64>,
}

impl Cholesky {
    /// Factors the matrix with these entries below its diagonal of ones.
    ///
    /// # Errors
    /// The same whatever the number of threads: no memory, else the first column without a positive pivot.
    pub fn new(
        tree: Arc<AssemblyTree>,
        entries: &Entries,
        values: &[f64],
    ) -> Result<Self, Failure> {
        let nodes = &tree.nodes;
        let mut l = lazy_zeros(tree.entries())?;
        let panels = parts(&mut l, nodes.iter().map(|node| node.entries.len()));
        let fronts: Vec<Mutex<Begun>> = (panels.into_iter())
            .map(|panel| Mutex::new(Begun::new(panel)))
            .collect();
        let updates: Vec<Mutex<Option<Update>>> = nodes.iter().map(|_| Mutex::new(None)).collect();
        let failure = Mutex::new(None::<Failure>);
        let begun = |s: usize| fronts[s].lock().unwrap_or_else(PoisonError::into_inner);
        let update_of = |s: usize| updates[s].lock().unwrap_or_else(PoisonError::into_inner);
        let from_k = |s: usize, panel| -> Result<Front<'_>, Failure> {
            let mut front = Front::new(panel, nodes[s].shape())?;
            for (k, c) in nodes[s].columns.clone().enumerate() {
                let column = front.column_mut(k);
                column[0] = 1.0;
                for e in entries.begin[c]..entries.begin[c + 1] {
                    column[entries.place[e] as usize - k] = values[e];
                }
            }
            Ok(front)
        };
        let eliminate = |s: usize| -> Result<(), Failure> {
            let own = std::mem::take(&mut *begun(s));
            // Without an update of a child there is no factor.
            if own.children < tree.children[s].len() {
                return Ok(());
            }
            let mut front = match own.front {
                Some(front) => front,
                None => from_k(s, own.panel)?,
            };
            front.eliminate()?;
            let parent = nodes[s].parent;
            if parent == NONE {
                return Ok(());
            }
            // The part that goes into the front above is freed at once, in the order of the children.
            *update_of(s) = Some(front.update);
            let above = &mut *begun(parent);
            while let Some(&child) = tree.children[parent].get(above.children) {
                let Some(update) = update_of(child).take() else {
                    break;
                };
                let front = match &mut above.front {
                    Some(front) => front,
                    none => none.insert(from_k(parent, std::mem::take(&mut above.panel))?),
                };
                front.extend_add(&update, tree.places(child));
                above.children += 1;
            }
            Ok(())
        };
        tree.upwards(tree.work() > WORTH_THREADS, |s| {
            if let Err(own) = eliminate(s) {
                let own = own.behind(nodes[s].columns.start);
                let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
                *failure = Some(failure.map_or(own, |before| before.or(own)));
            }
        });
        drop(fronts);
        match (failure.into_inner()).unwrap_or_else(PoisonError::into_inner) {
            Some(failure) => Err(failure),
            None => Ok(Self { tree, values: l }),
        }
    }

    /// The first column whose pivot in A, l², is below a bound.
    pub fn pivot_below(&self, least: f64) -> Option<usize> {
        let first = |s: usize| {
            let (node, panel) = (&self.tree.nodes[s], self.panel(s));
            let pivot = |k: usize| panel[node.shape().column(k).start];
            let small = |&k: &usize| pivot(k).powi(2) < least;
            let begin = node.columns.start;
            (0..node.columns.len()).find(small).map(|k| begin + k)
        };
        (0..self.tree.nodes.len()).find_map(first)
    }

    /// L of supernode `s`: the lower triangle of the columns' own rows, and the rows below.
    fn panel(&self, s: usize) -> &[f64] {
        &self.values[self.tree.nodes[s].entries.clone()]
    }

    /// The columns of supernode `s` by strips, each with its first column.
    pub fn strips(&self, s: usize) -> impl Iterator<Item = (usize, MatRef<'_, f64>)> {
        self.tree.nodes[s].shape().strips(self.panel(s))
    }
}

/// A front that waits for its children.
#[derive(Default)]
struct Begun<'a> {
    /// Where it will be.
    panel: &'a mut [f64],
    front: Option<Front<'a>>,
    /// How many children it has taken in.
    children: usize,
}

impl<'a> Begun<'a> {
    fn new(panel: &'a mut [f64]) -> Self {
        Self {
            panel,
            ..Self::default()
        }
    }
}

/// Parts of these sizes, one after the other.
fn parts(x: &mut [f64], sizes: impl Iterator<Item = usize>) -> Vec<&mut [f64]> {
    let mut rest = x;
    let part = |size: usize| {
        let (own, others) = std::mem::take(&mut rest).split_at_mut(size);
        rest = others;
        own
    };
    sizes.map(part).collect()
}

/// Zeros, of which the system keeps no pages until they are written to.
fn lazy_zeros(len: usize) -> Result<Vec<f64>, Failure> {
    // No memory is an answer here, where `vec!` would end the program; nobody else asks at this moment.
    let mut probe = Vec::<f64>::new();
    let denied = probe.try_reserve_exact(len).is_err();
    drop(probe);
    if denied {
        return Err(Failure::OutOfMemory);
    }
    Ok(vec![0.0; len])
}
