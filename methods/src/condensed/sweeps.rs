//! Block Gauss–Seidel sweeps over the points: the contact law of each solved exactly with all others held.

use std::ops::Range;

use crate::algebra::delassus::Delassus;
use crate::algebra::plain::wide;
use crate::condensed::local::LocalOperator;
use crate::condensed::problem::ContactProblem;
use crate::condensed::saddle::{Iterate, Saddle};
use crate::contract::law::Branch;

/// Proximal term on local problems, relative to 1/ρ: regularises points that do not move at all, and no fixed point notices.
const PROXIMAL: f64 = 1e-10;

/// Rows below which wide vectors do not pay.
const SHORT: usize = 32;

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
        let (problem, w) = (&*problem, saddle.w());
        if let Some(w) = w.sparse() {
            let add = |rows, step, v: &mut [f64]| w.add_columns(rows, step, v);
            return self.points(problem, add, omega, x, branches);
        }
        let mut work = Default::default();
        if w.rows() < SHORT {
            let add = |rows, step, v: &mut [f64]| add_columns(w, rows, step, &mut work, v);
            self.points(problem, add, omega, x, branches)
        } else {
            wide(
                #[inline(always)]
                || {
                    self.points(
                        problem,
                        #[inline(always)]
                        |rows, step, v| add_columns(w, rows, step, &mut work, v),
                        omega,
                        x,
                        branches,
                    )
                },
            )
        }
    }

    /// `add`: v += W δP of the rows of a point.
    #[inline(always)]
    fn points(
        &self,
        problem: &ContactProblem<'_>,
        mut add: impl FnMut(Range<usize>, [f64; 3], &mut [f64]),
        omega: f64,
        x: &mut Iterate,
        branches: &mut [Branch],
    ) -> usize {
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
            let mut step = [0.0; 3];
            for ((k, p), step) in rows.clone().zip(p).zip(&mut step) {
                *step = omega * (p - x.p[k]);
                x.p[k] += *step;
            }
            if step != [0.0; 3] {
                add(rows, step, &mut x.v);
            }
            changes += usize::from(std::mem::replace(&mut branches[i], branch) != branch);
        }
        changes
    }
}

/// v += W δP of one point, in one pass.
#[inline(always)]
fn add_columns(
    w: &dyn Delassus,
    rows: Range<usize>,
    step: [f64; 3],
    work: &mut [Vec<f64>; 3],
    v: &mut [f64],
) {
    let [first, second, third] = work;
    let a = w.column(rows.start, first);
    let more = rows.start + 1..rows.end;
    let b = more.clone().next().map(|k| w.column(k, second));
    let c = more.clone().nth(1).map(|k| w.column(k, third));
    let v = v.iter_mut().zip(a);
    match (b, c) {
        (Some(b), Some(c)) => {
            let entries = v.zip(b).zip(c);
            entries.for_each(|(((v, a), b), c)| {
                *v = ((*v + a * step[0]) + b * step[1]) + c * step[2];
            });
        }
        (Some(b), None) => {
            let entries = v.zip(b);
            entries.for_each(|((v, a), b)| *v = (*v + a * step[0]) + b * step[1]);
        }
        _ => v.for_each(|(v, a)| *v += a * step[0]),
    }
}
