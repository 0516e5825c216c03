//! Block Gauss–Seidel sweeps over the points: the contact law of each solved exactly with all others held.

use crate::condensed::local::LocalOperator;
use crate::condensed::problem::ContactProblem;
use crate::condensed::saddle::{Iterate, Saddle};
use crate::contract::law::Branch;

/// Proximal term on local problems, relative to 1/ρ: regularises points that do not move at all, and no fixed point
/// notices.
const PROXIMAL: f64 = 1e-10;

/// The local problems of all points.
pub(crate) struct Sweeps {
    /// Local problem and diagonal block of W' by point.
    local: Vec<(LocalOperator, [[f64; 3]; 3])>,
    /// Proximal term in m/N.
    proximal: f64,
}

impl Sweeps {
    pub fn new(problem: &ContactProblem<'_>, saddle: &Saddle) -> Self {
        let proximal = PROXIMAL / problem.operator.rho;
        let mirrored = saddle.w().symmetric();
        let points = problem.rows.iter();
        let local = points.map(|rows| {
            let block = saddle.w().block(rows.clone());
            let operator = LocalOperator::new(rows.len(), |k, l| {
                // Rounding may have left a symmetric W' two halves.
                let (k, l) = if mirrored && k == 0 { (l, 0) } else { (k, l) };
                block[k][l] + if k == l { proximal } else { 0.0 }
            });
            (operator, block)
        });
        Self {
            local: local.collect(),
            proximal,
        }
    }

    /// Solves the local problem of one point after the other; returns how many changed their branch.
    pub fn sweep(
        &self,
        problem: &mut ContactProblem<'_>,
        saddle: &Saddle,
        omega: f64,
        x: &mut Iterate,
        branches: &mut [Branch],
    ) -> usize {
        problem.counters.local_solves += self.local.len();
        let (w, mut work) = (saddle.w(), Vec::new());
        let mut changes = 0;
        for (i, (local, block)) in self.local.iter().enumerate() {
            let rows = problem.rows.of(i);
            let mut q = [0.0; 3];
            for (a, k) in rows.clone().enumerate() {
                q[a] = x.v[k] - self.proximal * x.p[k];
                for (b, l) in rows.clone().enumerate() {
                    q[a] -= block[a][b] * x.p[l];
                }
            }
            let (p, branch) = local.solve(problem.friction(i), &q[..rows.len()]);
            for (k, p) in rows.zip(p) {
                let step = omega * (p - x.p[k]);
                if step != 0.0 {
                    x.p[k] += step;
                    for (v, w) in x.v.iter_mut().zip(w.column(k, &mut work)) {
                        *v += w * step;
                    }
                }
            }
            changes += usize::from(std::mem::replace(&mut branches[i], branch) != branch);
        }
        changes
    }
}
