//! Newton steps from the factors of an earlier one, where few rows of the tangent have changed since. With `b-newton`, `newton-ac`,
//! `pdas` and springs a row in 2D, and without friction, depends on the state of its point alone: near the solution hardly any changes.
//! ```text
//! J₀ = L U on the rows S₀ that were active; J on those that are
//! rows of S₀                   J₀ x₀ + B x₁ + E y = f₀       x₁: rows active since, columns B; y: by how much changed rows fail
//! changed rows and new ones    G x₀ + H x₁ = f₁              G, H: rows of J
//! rows no longer active        e·x₀ = 0
//!
//! x₀ = z − Z u,   J₀ z = f₀,   J₀ Z = (B E),   u = (x₁, y):   [G Z − (H 0); e·Z] u = [G z − f₁; e·z]
//! ```
//! Woodbury's formula, with new rows as Schur's complement (W. Hager, SIAM Review 31 (1989) 221). The balance of floating pieces and
//! their motions ρ β are rows and unknowns of J₀ that never change. Z is kept, so that a step pays for
//! the rows alone that changed in it. What the detour loses is seen from f − J x, which corrects x. If that does not help, or if the
//! small matrix is singular beside what was subtracted in it, the tangent is factored, and seen for what it is.

#![allow(non_snake_case)]

use std::collections::BTreeMap;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use crate::algebra::delassus::Delassus;
use crate::algebra::dense::{DenseLu, SINGULAR, dot, larger, minus, mul_add};
use crate::algebra::strips::{WORTH_THREADS, column_strips, for_all};
use crate::algebra::tied::TiedLu;
use crate::condensed::point_row::{
    Blocks, LawPoint, Place, law_border, law_column, law_points, place,
};
use crate::condensed::problem::ContactProblem;

/// Active rows from which steps with earlier factors are worth their bookkeeping.
const FEWEST: usize = 256;
/// Operations that a step may take, as a fraction of those of a factorisation: they are as well blocked.
const SHARE: f64 = 0.5;
/// Largest |f − J x| of an accepted step, relative to its largest terms, and how often it is corrected to get there.
const ACCURACY: f64 = 1e-13;
const CORRECTIONS: usize = 2;
/// Columns of Z that are kept, as a fraction 1/n of the rows.
const KEPT: usize = 2;
/// Columns that are computed at once.
const WIDTH: usize = 32;

/// The tangent by row, of rows that are not active too: A δP + C δv, δv = `w` δP.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub w: &'a dyn Delassus,
    /// Increasing.
    pub active: &'a [usize],
    pub a: Blocks<'a>,
    pub c: Blocks<'a>,
}

/// The unknown that a change brings, with its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Unknown {
    /// y of a row of S₀.
    Slack(usize),
    /// x₁ of a row that was not in S₀.
    New(usize),
}

/// The tangent that was factored, and what was solved with it. The memory of one serves the next.
#[derive(Default)]
pub(crate) struct Factored {
    /// S₀.
    active: Vec<usize>,
    a: Vec<[f64; 3]>,
    c: Vec<[f64; 3]>,
    /// Columns of Z, and where their rows stand.
    solved: BTreeMap<Unknown, Vec<f64>>,
    listed: Option<Listed>,
}

/// How [`Factored::solve`] ends.
pub(crate) enum Solved {
    /// x, then ρ β.
    Step(Vec<f64>),
    /// Too many rows are others: to be factored.
    TooManyChanges,
    /// Rounding spoils it, or J is singular: to be factored.
    Failed,
}

impl Factored {
    /// Remembers a tangent that was factored.
    pub fn remember(&mut self, rows: Rows<'_>) {
        rows.active.clone_into(&mut self.active);
        rows.a.clone_into(&mut self.a);
        rows.c.clone_into(&mut self.c);
        self.solved.clear();
        self.listed = None;
    }

    /// Frees Z.
    pub fn forget(&mut self) {
        self.solved.clear();
    }

    /// Whether the factors are those of this tangent.
    pub fn is_of(&self, rows: Rows<'_>) -> bool {
        self.active == rows.active && self.a == rows.a && self.c == rows.c
    }

    /// x with J x = f on the active rows and the balance behind them. `lu`: the factors of J₀.
    pub fn solve(
        &mut self,
        problem: &ContactProblem<'_>,
        lu: &TiedLu,
        rows: Rows<'_>,
        f: &[f64],
    ) -> Solved {
        if self.active.len() < FEWEST {
            return Solved::TooManyChanges;
        }
        let changes = self.changes(rows);
        if !self.is_worth(&changes, lu.size()) {
            return Solved::TooManyChanges;
        }
        match self.solve_changed(problem, lu, rows, &changes, f) {
            Some(x) => Solved::Step(x),
            None => Solved::Failed,
        }
    }

    /// Changes since: slacks of rows of S₀ that are others or no longer active, then new rows.
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

    /// Whether a step costs little enough: 2 n m operations for a new column of Z, 2 k² n + 2k³/3 for k changes, 2m³/3 for all m
    /// rows of the factors.
    fn is_worth(&self, changes: &[Unknown], m: usize) -> bool {
        let missing = changes
            .iter()
            .filter(|change| !self.solved.contains_key(change));
        let (n, m, k, new) = (
            self.active.len() as f64,
            m as f64,
            changes.len() as f64,
            missing.count() as f64,
        );
        2.0 * n * m * new + 2.0 * k * k * n + k * k * k / 1.5 <= SHARE * m * m * m / 1.5
    }

    fn solve_changed(
        &mut self,
        problem: &ContactProblem<'_>,
        lu: &TiedLu,
        rows: Rows<'_>,
        changes: &[Unknown],
        f: &[f64],
    ) -> Option<Vec<f64>> {
        self.solve_columns(problem, lu, rows.w, changes)?;
        let step = Step::new(self, problem, lu, rows, changes)?;
        let mut x = step.solve(f)?;
        for corrections in 0..=CORRECTIONS {
            let (rest, terms) = residual(problem, rows, f, &x);
            if largest(&rest) <= ACCURACY * terms {
                return Some(x);
            }
            if corrections < CORRECTIONS {
                let more = step.solve(&rest)?;
                x.iter_mut().zip(more).for_each(|(x, more)| *x += more);
            }
        }
        None
    }

    /// Columns of Z that were not needed before.
    fn solve_columns(
        &mut self,
        problem: &ContactProblem<'_>,
        lu: &TiedLu,
        w: &dyn Delassus,
        changes: &[Unknown],
    ) -> Option<()> {
        let (n, c) = (self.active.len(), &self.c);
        let listed = self.listed.take();
        let listed = listed.unwrap_or_else(|| Listed::new(problem, &self.active, c));
        let missing = changes
            .iter()
            .filter(|change| !self.solved.contains_key(change));
        let missing: Vec<Unknown> = missing.copied().collect();
        if KEPT * (self.solved.len() + missing.len()) > n {
            self.solved.retain(|kept, _| changes.contains(kept));
        }
        let size = n + problem.modes();
        let (mut Z, mut work) = (Mat::zeros(size, missing.len()), Vec::new());
        for (j, change) in missing.iter().enumerate() {
            let (column, balance) = Z.col_as_slice_mut(j).split_at_mut(n);
            match change {
                Unknown::Slack(k) => column[self.active.binary_search(k).ok()?] = 1.0,
                Unknown::New(k) => {
                    listed.column(problem, w, &self.a, *k, &mut work, column);
                    let motions = balance.iter_mut().zip(&problem.operator.modes.q);
                    motions.for_each(|(entry, q)| *entry = q[*k]);
                }
            }
        }
        self.listed = Some(listed);
        let threads = (n * lu.size()) as f64 * missing.len() as f64 > WORTH_THREADS;
        let strips = column_strips(Z.as_mut(), WIDTH);
        for_all(strips, threads, |(_, strip)| lu.solve_in_place(strip));
        for (j, change) in missing.into_iter().enumerate() {
            self.solved.insert(change, Z.col_as_slice(j).to_vec());
        }
        Some(())
    }
}

/// Rows of a tangent whose columns are asked for.
struct Listed {
    places: Vec<Place>,
    laws: Vec<LawPoint>,
}

impl Listed {
    /// `indices`: increasing.
    fn new(problem: &ContactProblem<'_>, indices: &[usize], c: Blocks<'_>) -> Self {
        let (mut places, mut laws) = (Vec::new(), Vec::new());
        place(problem, indices, &mut places);
        law_points(&places, c, &mut laws);
        Self { places, laws }
    }

    /// Column k, with the rows' A.
    fn column(
        &self,
        problem: &ContactProblem<'_>,
        w: &dyn Delassus,
        a: Blocks<'_>,
        k: usize,
        work: &mut Vec<f64>,
        column: &mut [f64],
    ) {
        let rows = (&self.places[..], a, &self.laws[..]);
        let place = (k, problem.rows.around(k));
        law_column(problem, w, &place, rows, work, column);
    }
}

/// The changes of a step, factored.
struct Step<'s> {
    lu: &'s TiedLu,
    rows: Rows<'s>,
    /// S₀.
    before: &'s [usize],
    changes: &'s [Unknown],
    /// Where rows that are no longer active stand in S₀.
    gone: Vec<usize>,
    /// Changed and new rows, increasing.
    others: Vec<usize>,
    Z: Mat<f64>,
    G: Mat<f64>,
    schur: DenseLu,
}

impl<'s> Step<'s> {
    /// `None` if J is singular: pivots of Schur's complement drown in the rounding of what it is the difference of.
    fn new(
        base: &'s Factored,
        problem: &ContactProblem<'_>,
        lu: &'s TiedLu,
        rows: Rows<'s>,
        changes: &'s [Unknown],
    ) -> Option<Self> {
        let row = |change: &Unknown| match *change {
            Unknown::Slack(k) | Unknown::New(k) => k,
        };
        let active = |k: &usize| rows.active.binary_search(k).is_ok();
        let (mut others, gone): (Vec<usize>, Vec<usize>) =
            changes.iter().map(row).partition(active);
        others.sort_unstable();
        let stood = |k: &usize| base.active.binary_search(k).ok();
        let gone: Vec<usize> = gone.iter().map(stood).collect::<Option<_>>()?;
        let (n, size) = (base.active.len() + problem.modes(), changes.len());
        let mut Z = Mat::zeros(n, size);
        for (j, change) in changes.iter().enumerate() {
            Z.col_as_slice_mut(j).copy_from_slice(&base.solved[change]);
        }
        let (listed, mut work) = (Listed::new(problem, &others, rows.c), Vec::new());
        let mut G = Mat::zeros(others.len(), n);
        for (j, k) in base.active.iter().enumerate() {
            let column = G.col_as_slice_mut(j);
            listed.column(problem, rows.w, rows.a, *k, &mut work, column);
        }
        for (j, q) in (base.active.len()..).zip(&problem.operator.modes.q) {
            for (i, place) in listed.places.iter().enumerate() {
                G[(i, j)] = law_border(place, rows.c, q, problem.operator.rho);
            }
        }

        let mut schur = product(&G, &Z, size);
        let mut H = vec![0.0; others.len()];
        for (j, change) in changes.iter().enumerate() {
            for (i, &at) in gone.iter().enumerate() {
                schur[(others.len() + i, j)] = Z[(at, j)];
            }
            if let Unknown::New(k) = change {
                listed.column(problem, rows.w, rows.a, *k, &mut work, &mut H);
                (H.iter().enumerate()).for_each(|(i, h)| schur[(i, j)] -= h);
            }
        }
        let schur = DenseLu::new(&schur)?;
        let of_z = (0..size).fold(0.0, |most, j| larger(most, largest(Z.col_as_slice(j))));
        let rounding = SINGULAR * n as f64 * of_z * row_sum(&G).max(of_z).max(1.0);
        (size == 0 || schur.least_pivot() > rounding).then_some(Self {
            lu,
            rows,
            before: &base.active,
            changes,
            gone,
            others,
            Z,
            G,
            schur,
        })
    }

    /// x, ρ β for a right-hand side on the active rows and the balance; `None` if they are not finite.
    fn solve(&self, f: &[f64]) -> Option<Vec<f64>> {
        let (_, balance) = f.split_at(self.rows.active.len());
        let place = |k: &usize| self.rows.active.binary_search(k).ok();
        let of_row = |k: &usize| place(k).map_or(0.0, |i| f[i]);
        let mut f0: Vec<f64> = self.before.iter().map(of_row).collect();
        for change in self.changes {
            if let Unknown::Slack(k) = change {
                f0[self.before.binary_search(k).ok()?] = 0.0;
            }
        }
        f0.extend(balance);
        let z = self.lu.solve(&f0)?;

        let mut right = vec![0.0; self.changes.len()];
        let (of_others, of_gone) = right.split_at_mut(self.others.len());
        mul_add(&self.G, &z, of_others);
        (of_others.iter_mut().zip(&self.others)).for_each(|(right, k)| *right -= of_row(k));
        (of_gone.iter_mut().zip(&self.gone)).for_each(|(right, &at)| *right = z[at]);
        let u = self.schur.solve(&right)?;

        let mut moved = vec![0.0; z.len()];
        mul_add(&self.Z, &u, &mut moved);
        let x0 = minus(&z, &moved);
        let (x0, amplitudes) = x0.split_at(self.before.len());
        let mut x = vec![0.0; self.rows.active.len()];
        x.extend(amplitudes);
        for (k, x0) in self.before.iter().zip(x0) {
            if let Some(i) = place(k) {
                x[i] = *x0;
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

/// G Z, with rows for more below.
fn product(G: &Mat<f64>, Z: &Mat<f64>, rows: usize) -> Mat<f64> {
    let mut product = Mat::zeros(rows, Z.ncols());
    let threads = (G.nrows() * G.ncols()) as f64 * Z.ncols() as f64 > WORTH_THREADS;
    let strips = column_strips(product.as_mut(), WIDTH);
    for_all(strips, threads, |(begin, strip)| {
        let columns = Z.subcols(begin, strip.ncols());
        let upper = strip.subrows_mut(0, G.nrows());
        matmul(upper, Accum::Replace, G, columns, 1.0, Par::Seq);
    });
    product
}

/// The largest sum of the magnitudes of a row.
fn row_sum(a: &Mat<f64>) -> f64 {
    let mut sums = vec![0.0; a.nrows()];
    for j in 0..a.ncols() {
        (sums.iter_mut().zip(a.col_as_slice(j))).for_each(|(sum, a)| *sum += a.abs());
    }
    largest(&sums)
}

/// f − J x, and the largest sum of the magnitudes of its terms.
fn residual(problem: &ContactProblem<'_>, rows: Rows<'_>, f: &[f64], x: &[f64]) -> (Vec<f64>, f64) {
    let modes = &problem.operator.modes;
    let (x, amplitudes) = x.split_at(rows.active.len());
    let (f, balance) = f.split_at(rows.active.len());
    let mut p = vec![0.0; problem.len()];
    rows.active.iter().zip(x).for_each(|(&k, x)| p[k] = *x);
    let mut v = vec![0.0; problem.len()];
    rows.w.apply_add(&p, &mut v);
    let beta: Vec<f64> = amplitudes
        .iter()
        .map(|b| b / problem.operator.rho)
        .collect();
    modes.add(&beta, &mut v);
    let mut most = 0.0;
    let rest = |(&k, f): (&usize, &f64)| {
        let (mut rest, mut terms) = (*f, f.abs());
        for (l, at) in problem.rows.around(k).enumerate() {
            let (by_force, by_jump) = (rows.a[k][l] * p[at], rows.c[k][l] * v[at]);
            rest -= by_force + by_jump;
            terms += by_force.abs() + by_jump.abs();
        }
        most = larger(most, terms);
        rest
    };
    let mut rest: Vec<f64> = rows.active.iter().zip(f).map(rest).collect();
    for (q, c) in modes.q.iter().zip(balance) {
        let terms = q.iter().zip(&p).map(|(q, p)| (q * p).abs()).sum::<f64>();
        most = larger(most, c.abs() + terms);
        rest.push(c - dot(q, &p));
    }
    (rest, most)
}

/// The largest magnitude; NaN if there is one.
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most, x| larger(most, x.abs()))
}

#[cfg(test)]
mod tests;
