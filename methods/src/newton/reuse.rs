//! Newton steps from the factors of an earlier one, where few rows of the tangent have changed since. In 2D a row depends on the
//! state of its point alone, so that near the solution hardly any changes.
//! ```text
//! J₀ = L U on the rows S₀ that were active; J on those that are
//! rows that are the same       J₀ x₀ + B x₁ + E y = f₀       x₁: rows active since, columns B; y: by how much other rows of J₀ fail
//! changed rows and new ones    G x₀ + H x₁ = f₁              G, H: rows of J
//! rows no longer active        e·x₀ = 0
//!
//! x₀ = z − Z u,   J₀ z = f₀,   J₀ Z = (B E),   u = (x₁, y):   [G Z − (H 0); e·Z] u = [G z − f₁; e·z]
//! ```
//! Woodbury's formula, with new rows as Schur's complement (W. Hager, SIAM Review 31 (1989) 221). Z is kept, so that a step pays for
//! the rows alone that changed in it. What the detour loses is seen from f − J x, which corrects x; too much of it is a reason to
//! factor.

#![allow(non_snake_case)]

use std::collections::BTreeMap;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use crate::ContactProblem;
use crate::algebra::dense::{DenseLu, larger, minus, mul_add};
use crate::algebra::strips::{WORTH_THREADS, column_strips, for_all};

/// Rows from which steps with earlier factors are worth their bookkeeping.
const FEWEST: usize = 256;
/// Operations that a step may take, as a fraction of those of a factorisation: they are as well blocked.
const SHARE: f64 = 0.5;
/// Largest |f − J x| of an accepted step, relative to |f|, and how often it is corrected to get there.
const ACCURACY: f64 = 1e-12;
const CORRECTIONS: usize = 3;
/// Right-hand sides that are solved for at once.
const WIDTH: usize = 32;

/// The tangent by row, of rows that are not active too: A δP + C δv.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    /// Increasing.
    pub active: &'a [usize],
    pub a: &'a [[f64; 3]],
    pub c: &'a [[f64; 3]],
}

/// Where the unknowns of a change come from; its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Unknown {
    /// y of a row of S₀.
    Slack(usize),
    /// x₁ of a row that was not in S₀.
    New(usize),
}

/// The tangent that was factored, and what was solved with it.
pub(crate) struct Factored {
    /// S₀.
    active: Vec<usize>,
    a: Vec<[f64; 3]>,
    c: Vec<[f64; 3]>,
    /// Columns of Z.
    solved: BTreeMap<Unknown, Vec<f64>>,
}

impl Factored {
    /// To be remembered of a tangent that was factored; `None` where that is not worth it, or where pieces float, whose balance
    /// stands beside the rows.
    pub fn new(problem: &ContactProblem<'_>, rows: Rows<'_>) -> Option<Self> {
        let worth = rows.active.len() >= FEWEST && problem.modes() == 0;
        worth.then(|| Self {
            active: rows.active.to_vec(),
            a: rows.a.to_vec(),
            c: rows.c.to_vec(),
            solved: BTreeMap::new(),
        })
    }

    /// x with J x = f on the active rows; `None` if too many rows are others, or rounding spoils it. `lu`: the factors of J₀.
    pub fn solve(
        &mut self,
        problem: &ContactProblem<'_>,
        lu: &DenseLu,
        rows: Rows<'_>,
        f: &[f64],
    ) -> Option<Vec<f64>> {
        let changes = self.changes(rows);
        self.is_worth(&changes).then_some(())?;
        self.solve_changed(problem, lu, rows, &changes, f)
    }

    /// Whether a step costs little enough: 2 n² operations for a new column of Z, 2 k² n + 2k³/3 for k changes, 2n³/3 for all.
    fn is_worth(&self, changes: &[Unknown]) -> bool {
        let missing = changes
            .iter()
            .filter(|change| !self.solved.contains_key(change));
        let (n, k, new) = (
            self.active.len() as f64,
            changes.len() as f64,
            missing.count() as f64,
        );
        2.0 * n * n * new + 2.0 * k * k * n + k * k * k / 1.5 <= SHARE * n * n * n / 1.5
    }

    fn solve_changed(
        &mut self,
        problem: &ContactProblem<'_>,
        lu: &DenseLu,
        rows: Rows<'_>,
        changes: &[Unknown],
        f: &[f64],
    ) -> Option<Vec<f64>> {
        self.solve_columns(problem, lu, changes)?;
        let step = Step::new(self, problem, lu, rows, changes)?;
        let mut x = step.solve(f)?;
        let size = f.iter().fold(0.0, |most, f| larger(most, f.abs()));
        for _ in 0..CORRECTIONS {
            let left = residual(problem, rows, f, &x);
            let most = left.iter().fold(0.0, |most, r| larger(most, r.abs()));
            if most <= ACCURACY * size {
                return Some(x);
            }
            let correction = step.solve(&left)?;
            x.iter_mut()
                .zip(correction)
                .for_each(|(x, more)| *x += more);
        }
        None
    }

    /// What has changed since: slacks of rows of S₀ that are others or no longer active, then new rows.
    fn changes(&self, rows: Rows<'_>) -> Vec<Unknown> {
        let same = |k: usize| self.a[k] == rows.a[k] && self.c[k] == rows.c[k];
        let is_in = |list: &[usize], k: usize| list.binary_search(&k).is_ok();
        let slack = self
            .active
            .iter()
            .filter(|&&k| !(is_in(rows.active, k) && same(k)));
        let new = rows.active.iter().filter(|&&k| !is_in(&self.active, k));
        let slack = slack.map(|&k| Unknown::Slack(k));
        slack.chain(new.map(|&k| Unknown::New(k))).collect()
    }

    /// Columns of Z that were not needed before.
    fn solve_columns(
        &mut self,
        problem: &ContactProblem<'_>,
        lu: &DenseLu,
        changes: &[Unknown],
    ) -> Option<()> {
        let missing = changes
            .iter()
            .filter(|change| !self.solved.contains_key(change));
        let missing: Vec<Unknown> = missing.copied().collect();
        let mut Z = Mat::zeros(self.active.len(), missing.len());
        for (j, change) in missing.iter().enumerate() {
            let column = Z.col_as_slice_mut(j);
            match change {
                Unknown::Slack(k) => column[self.active.binary_search(k).ok()?] = 1.0,
                Unknown::New(k) => {
                    let own = Rows {
                        active: &self.active,
                        a: &self.a,
                        c: &self.c,
                    };
                    entries(problem, own, *k, column);
                }
            }
        }
        let n = self.active.len() as f64;
        let threads = n * n * missing.len() as f64 > WORTH_THREADS;
        for_all(column_strips(Z.as_mut(), WIDTH), threads, |(_, strip)| {
            lu.solve_in_place(strip)
        });
        for (j, change) in missing.into_iter().enumerate() {
            self.solved.insert(change, Z.col_as_slice(j).to_vec());
        }
        Some(())
    }
}

/// The changes of a step, factored.
struct Step<'s> {
    lu: &'s DenseLu,
    rows: Rows<'s>,
    /// S₀.
    before: &'s [usize],
    changes: &'s [Unknown],
    /// Rows of S₀ that are no longer active.
    left: Vec<usize>,
    /// Changed and new rows.
    others: Vec<usize>,
    Z: Mat<f64>,
    G: Mat<f64>,
    schur: DenseLu,
}

impl<'s> Step<'s> {
    fn new(
        base: &'s Factored,
        problem: &ContactProblem<'_>,
        lu: &'s DenseLu,
        rows: Rows<'s>,
        changes: &'s [Unknown],
    ) -> Option<Self> {
        let row = |change: &Unknown| match *change {
            Unknown::Slack(k) | Unknown::New(k) => k,
        };
        let active = |k: &usize| rows.active.binary_search(k).is_ok();
        let (others, left): (Vec<usize>, Vec<usize>) = changes.iter().map(row).partition(active);
        let (n, size) = (base.active.len(), changes.len());
        let mut Z = Mat::zeros(n, size);
        for (j, change) in changes.iter().enumerate() {
            Z.col_as_slice_mut(j).copy_from_slice(&base.solved[change]);
        }

        let own = Rows {
            active: &others,
            ..rows
        };
        let mut G = Mat::zeros(others.len(), n);
        for (j, k) in base.active.iter().enumerate() {
            entries(problem, own, *k, G.col_as_slice_mut(j));
        }
        let mut schur = Mat::zeros(size, size);
        let threads = (size * size) as f64 * n as f64 > WORTH_THREADS;
        for_all(
            column_strips(schur.as_mut(), WIDTH),
            threads,
            |(begin, mut strip)| {
                let width = strip.ncols();
                let upper = strip.as_mut().subrows_mut(0, others.len());
                matmul(
                    upper,
                    Accum::Replace,
                    &G,
                    Z.subcols(begin, width),
                    1.0,
                    Par::Seq,
                );
            },
        );
        let mut H = vec![0.0; others.len()];
        for (j, change) in changes.iter().enumerate() {
            for (i, k) in left.iter().enumerate() {
                schur[(others.len() + i, j)] = Z[(base.active.binary_search(k).ok()?, j)];
            }
            if let Unknown::New(k) = change {
                entries(problem, own, *k, &mut H);
                (H.iter().enumerate()).for_each(|(i, h)| schur[(i, j)] -= h);
            }
        }
        Some(Self {
            lu,
            rows,
            before: &base.active,
            changes,
            left,
            others,
            Z,
            G,
            schur: DenseLu::new(&schur)?,
        })
    }

    /// x for a right-hand side on the active rows; `None` if it is not finite.
    fn solve(&self, f: &[f64]) -> Option<Vec<f64>> {
        let place = |k: &usize| self.rows.active.binary_search(k).ok();
        let mut f0: Vec<f64> = self
            .before
            .iter()
            .map(|k| place(k).map_or(0.0, |i| f[i]))
            .collect();
        for change in self.changes {
            if let Unknown::Slack(k) = change {
                f0[self.before.binary_search(k).ok()?] = 0.0;
            }
        }
        let z = self.lu.solve(&f0)?;

        let mut right = vec![0.0; self.changes.len()];
        mul_add(&self.G, &z, &mut right[..self.others.len()]);
        for (right, k) in right.iter_mut().zip(&self.others) {
            *right -= f[place(k)?];
        }
        for (right, k) in right[self.others.len()..].iter_mut().zip(&self.left) {
            *right = z[self.before.binary_search(k).ok()?];
        }
        let u = self.schur.solve(&right)?;

        let mut moved = vec![0.0; z.len()];
        mul_add(&self.Z, &u, &mut moved);
        let x0 = minus(&z, &moved);
        let mut x = vec![0.0; f.len()];
        for (k, x0) in self.before.iter().zip(x0) {
            if let Some(i) = place(k) {
                x[i] = x0;
            }
        }
        for (change, u) in self.changes.iter().zip(u) {
            if let Unknown::New(k) = change {
                x[place(k)?] = u;
            }
        }
        Some(x)
    }
}

/// Column k of the tangent on its active rows: A and C W.
fn entries(problem: &ContactProblem<'_>, rows: Rows<'_>, k: usize, column: &mut [f64]) {
    let mut work = Vec::new();
    let w = problem.operator.w.column(k, &mut work);
    for (entry, &row) in column.iter_mut().zip(rows.active) {
        let own = problem.rows.around(row);
        *entry = (own.clone().zip(rows.c[row])).map(|(l, c)| c * w[l]).sum();
        if own.contains(&k) {
            *entry += rows.a[row][k - own.start];
        }
    }
}

/// f − J x on the active rows.
fn residual(problem: &ContactProblem<'_>, rows: Rows<'_>, f: &[f64], x: &[f64]) -> Vec<f64> {
    let mut p = vec![0.0; problem.len()];
    rows.active.iter().zip(x).for_each(|(&k, x)| p[k] = *x);
    let mut v = vec![0.0; problem.len()];
    problem.operator.w.apply_add(&p, &mut v);
    let left = |(&k, f): (&usize, &f64)| {
        let own = problem.rows.around(k);
        let reached = |l: usize| rows.a[k][l] * p[own.start + l] + rows.c[k][l] * v[own.start + l];
        f - (0..own.len()).map(reached).sum::<f64>()
    };
    rows.active.iter().zip(f).map(left).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::condensed::fixture::with_contact;
    use crate::condensed::point_row::{Bordered, Law};
    use crate::{Elastic, SymmetricMatrix};

    const POINTS: usize = 9;
    const ROWS: usize = 3 * POINTS;

    fn number(i: usize, j: usize) -> f64 {
        (12.9 * (i + 1) as f64 + 78.2 * ((i * j + 3 * j) as f64).sqrt()).sin()
    }

    /// Regular rows that are neither symmetric nor those of any law.
    fn law(seed: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let rows = |seed: usize, unit: f64| {
            let entry =
                |k: usize, l: usize| number(k + seed, l) + if k % 3 == l { unit } else { 0.0 };
            (0..ROWS).map(|k| [0, 1, 2].map(|l| entry(k, l))).collect()
        };
        (rows(seed, 3.0), rows(seed + 70, 3.0))
    }

    /// Source: the dense system of the step itself, factored. Tolerance: rounding, times its condition.
    #[test]
    fn changed_new_and_left_rows_are_solved_for_with_earlier_factors() {
        let (row_idx, col_ptr) = (
            (0..ROWS).flat_map(|j| j..ROWS),
            (0..=ROWS).map(|j| j * ROWS - j * j.saturating_sub(1) / 2),
        );
        let row_idx: Vec<usize> = row_idx.collect();
        let of_column =
            |j: usize| (j..ROWS).map(move |i| if i == j { 9.0 } else { number(i, j) / 9.0 });
        let values = (0..ROWS).flat_map(of_column).collect();
        let w = SymmetricMatrix::new(ROWS, col_ptr.collect(), row_idx, values).unwrap();
        let body = Elastic::from_delassus(3, w, vec![]).unwrap();
        let load = (vec![-1.0; ROWS], vec![0.0; ROWS]);
        with_contact(&body, vec![0.3; POINTS], load, |_, problem| {
            let (mut a, mut c) = law(1);
            let first: Vec<usize> = (0..ROWS).filter(|k| ![4, 5, 16].contains(k)).collect();
            let base = Bordered::new(&problem, &first, &Law::Rows { a: &a, c: &c }).unwrap();
            let mut earlier = Factored {
                active: first.clone(),
                a: a.clone(),
                c: c.clone(),
                solved: BTreeMap::new(),
            };
            let f: Vec<f64> = (0..ROWS).map(|k| number(k, 2)).collect();
            let others = law(5);
            let all = |k: &usize| ![0, 7, 26].contains(k);
            for (changed, active) in [
                (vec![], first.clone()),
                (vec![2, 11], first),
                (vec![2, 12, 13], (0..ROWS).filter(all).collect()),
                (vec![20], (0..ROWS).collect()),
            ] {
                for k in changed {
                    (a[k], c[k]) = (others.0[k], others.1[k]);
                }
                let rows = Rows {
                    active: &active,
                    a: &a,
                    c: &c,
                };
                let (law, f) = (Law::Rows { a: &a, c: &c }, &f[..active.len()]);
                let changes = earlier.changes(rows);
                let found = earlier
                    .solve_changed(&problem, base.factors(), rows, &changes, f)
                    .unwrap();
                let (exact, _) = Bordered::new(&problem, &active, &law)
                    .unwrap()
                    .solve(f, &[])
                    .unwrap();
                let off = found
                    .iter()
                    .zip(&exact)
                    .map(|(x, y)| (x - y).abs())
                    .fold(0.0, f64::max);
                let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                assert!(off < 1e-11 * size, "{}: {off:e} of {size}", changes.len());
            }
            // Every column was solved for once.
            let solved: Vec<Unknown> = earlier.solved.into_keys().collect();
            let slack = [0, 2, 7, 11, 12, 13, 20, 26].map(Unknown::Slack);
            let new = [4, 5, 16].map(Unknown::New);
            assert_eq!(solved, [&slack[..], &new].concat());
        });
    }
}
