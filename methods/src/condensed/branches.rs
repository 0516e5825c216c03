//! Changes between open, stick and slip from one iterate to the next.

use crate::algebra::dense::refill;
use crate::condensed::problem::ContactProblem;
use crate::contract::law::{Branch, return_map};

/// Points that are on another piece than before.
pub(crate) fn changed<T: PartialEq>(now: &[T], before: &[T]) -> usize {
    now.iter().zip(before).filter(|(a, b)| a != b).count()
}

/// Branch of every point at the last iterate, and what it is read from.
#[derive(Debug, Default)]
pub(crate) struct Branches {
    /// Empty before the first iterate.
    before: Vec<Branch>,
    /// Π(P − k v), Π the return mapping, of the last iterate by row.
    pub image: Vec<f64>,
}

impl Branches {
    /// Points whose branch, that of the return mapping of P − ρ v, is another one than at the iterate before.
    pub fn changes(&mut self, problem: &ContactProblem<'_>, p: &[f64], v: &[f64]) -> usize {
        self.map(problem, problem.operator.rho, p, v)
    }

    /// The same with another k in place of ρ.
    pub fn map(&mut self, problem: &ContactProblem<'_>, k: f64, p: &[f64], v: &[f64]) -> usize {
        let mut changes = 0;
        refill(&mut self.image, p.iter().zip(v).map(|(p, v)| p - k * v));
        for (i, own) in problem.rows.iter().enumerate() {
            let branch = return_map(problem.friction(i), &mut self.image[own]);
            match self.before.get_mut(i) {
                Some(before) => changes += usize::from(std::mem::replace(before, branch) != branch),
                None => self.before.push(branch),
            }
        }
        changes
    }
}
