//! Block Gauss–Seidel sweeps over the points: the contact law of each solved exactly with all others held.

use crate::condensed::local::LocalOperator;
use crate::condensed::problem::Reduced;
use crate::condensed::saddle::{Iterate, Saddle};
use crate::contract::law::Branch;

/// Proximal term on local problems, relative to 1/ρ: regularises points that do not move at all, and no fixed point
/// notices.
const PROXIMAL: f64 = 1e-10;

/// The local problems of all points.
pub(crate) struct Sweeps {
    local: Vec<LocalOperator>,
    /// Proximal term in m/N.
    proximal: f64,
}

impl Sweeps {
    pub fn new(problem: &Reduced<'_>, saddle: &Saddle) -> Self {
        let proximal = PROXIMAL / problem.condensed.rho;
        let local = (0..problem.rows.points())
            .map(|i| {
                let rows = problem.rows.of(i);
                LocalOperator::new(rows.len(), |k, l| {
                    let own = if k == l { proximal } else { 0.0 };
                    saddle.w()[(rows.start + k, rows.start + l)] + own
                })
            })
            .collect();
        Self { local, proximal }
    }

    /// Solves the local problem of one point after the other; returns how many changed their branch.
    pub fn sweep(
        &self,
        problem: &mut Reduced<'_>,
        saddle: &Saddle,
        omega: f64,
        x: &mut Iterate,
        branches: &mut [Branch],
    ) -> usize {
        problem.counters.local_solves += self.local.len();
        let w = saddle.w();
        let mut changes = 0;
        for (i, local) in self.local.iter().enumerate() {
            let rows = problem.rows.of(i);
            let mut q = [0.0; 3];
            for (k, q) in rows.clone().zip(&mut q) {
                *q = x.v[k] - self.proximal * x.p[k];
                for l in rows.clone() {
                    *q -= w[(k, l)] * x.p[l];
                }
            }
            let (p, branch) = local.solve(problem.friction(i), &q[..rows.len()]);
            for (k, p) in rows.zip(p) {
                let step = omega * (p - x.p[k]);
                if step != 0.0 {
                    x.p[k] += step;
                    for (v, w) in x.v.iter_mut().zip(w.col_as_slice(k)) {
                        *v += w * step;
                    }
                }
            }
            changes += usize::from(std::mem::replace(&mut branches[i], branch) != branch);
        }
        changes
    }
}
