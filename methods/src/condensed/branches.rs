//! Changes between open, stick and slip from one iterate to the next.

use crate::condensed::problem::ContactProblem;
use crate::contract::law::{Branch, return_map};

/// Branch of every point at the iterate before.
#[derive(Debug, Default)]
pub(crate) struct Branches(Vec<Branch>);

impl Branches {
    /// Points whose branch, that of the return mapping of P − ρ v, is another one than at the iterate before.
    pub fn changes(&mut self, problem: &ContactProblem<'_>, p: &[f64], v: &[f64]) -> usize {
        let rho = problem.operator.rho;
        let mut z: Vec<f64> = p.iter().zip(v).map(|(p, v)| p - rho * v).collect();
        let now: Vec<Branch> = (0..problem.rows.points())
            .map(|i| return_map(problem.friction(i), &mut z[problem.rows.of(i)]))
            .collect();
        let changes = now.iter().zip(&self.0).filter(|(a, b)| a != b).count();
        self.0 = now;
        changes
    }
}
