//! Linearised contact laws at the points, and the one dense solve of Newton's methods.
//! ```text
//! rows:      A δP + C δv = f,     δv = W δP + Q δβ,   Qᵀ δP = c          A, C by point
//! columns:   E y + δv = f,        δP = S y,           Qᵀ δP = c          E, S by point
//! ```
//! Both are one bordered system (E + L W R) x + L Q β = f, Qᵀ R x = c, on the rows that are active.

#![allow(non_snake_case)]

use std::ops::Range;

use crate::algebra::delassus::Delassus;
use crate::algebra::plain::Full;
use crate::algebra::sparse::{Sparse, SparseLu};
use crate::algebra::tied::{Tie, TiedLu};
use crate::condensed::problem::ContactProblem;

/// Row k of the linearised equations at one point: Σ a_l δP_l + Σ c_l δv_l = −h.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointRow {
    pub a: [f64; 3],
    pub c: [f64; 3],
    pub h: f64,
}

impl PointRow {
    /// Rows of a point with right-hand sides and no coefficients yet.
    #[inline(always)]
    pub fn reading(h: [f64; 3]) -> [Self; 3] {
        let (a, c) = ([0.0; 3], [0.0; 3]);
        let mut rows = [Self { a, c, h: 0.0 }; 3];
        rows.iter_mut().zip(h).for_each(|(row, h)| row.h = h);
        rows
    }
}

/// A 3 × 3 block by row: entry l of row k couples it with row l of its point.
pub(crate) type Blocks<'a> = &'a [[f64; 3]];

/// Where the blocks of the law stand beside W.
pub(crate) enum Law<'a> {
    /// E = A, L = C, R = I.
    Rows { a: Blocks<'a>, c: Blocks<'a> },
    /// L = I, R = S.
    Columns { e: Blocks<'a>, s: Blocks<'a> },
}

impl Law<'_> {
    /// (L Q, Qᵀ R) of an active row and a rigid motion, of which the law's own blocks carry 1/ρ.
    fn border(&self, place: &Place, q: &[f64], rho: f64) -> (f64, f64) {
        let (k, own) = (place.0, place.1.clone());
        match self {
            Law::Rows { c, .. } => (law_border(place, c, q, rho), q[k]),
            Law::Columns { s, .. } => {
                let column = k - own.start;
                (q[k], own.map(|l| q[l] * s[l][column] / rho).sum())
            }
        }
    }
}

/// The system, assembled and factored. The memory of one serves the next.
#[derive(Default)]
pub(crate) struct Bordered {
    lu: TiedLu,
    /// In its place where few entries of W are not 0.
    sparse: Option<Box<SparseLu>>,
    /// Unknowns are amplitudes times this.
    amplitude: f64,
    /// Right-hand sides of the balance are divided by this.
    balance: f64,
    active: Vec<Place>,
    laws: Vec<LawPoint>,
    right: Vec<f64>,
    work: Vec<f64>,
}

impl Bordered {
    /// Assembled and factored on the active rows, in increasing order; `None` if it is singular.
    pub fn new(problem: &ContactProblem<'_>, active: &[usize], law: &Law<'_>) -> Option<Self> {
        let (mut system, w) = (Self::default(), &*problem.operator.w);
        let regular = system.factor_with(problem, w, active, law, false);
        regular.then_some(system)
    }

    /// Assembles and factors it on the active rows, in increasing order; false if it is singular. Where the rows leave a piece loose,
    /// Qᵀ R x − ε ρ β = c holds it. Without a load it stays where it is, as good a place as any; with one it moves until something is
    /// in its way.
    pub fn factor_held(
        &mut self,
        problem: &ContactProblem<'_>,
        active: &[usize],
        law: &Law<'_>,
    ) -> bool {
        self.factor_with(problem, &*problem.operator.w, active, law, true)
    }

    /// The same with another W, and loose pieces held or not.
    pub fn factor_with(
        &mut self,
        problem: &ContactProblem<'_>,
        w: &dyn Delassus,
        active: &[usize],
        law: &Law<'_>,
        held: bool,
    ) -> bool {
        /// ε. Answers do not depend on it; with 1e-10 … 1e-3 Newton methods take as many steps, with 1 more.
        const SPRING: f64 = 1e-3;
        self.factor_on_spring(problem, w, active, law, 0.0)
            || (held
                && problem.modes() > 0
                && self.factor_on_spring(problem, w, active, law, SPRING))
    }

    fn factor_on_spring(
        &mut self,
        problem: &ContactProblem<'_>,
        w: &dyn Delassus,
        indices: &[usize],
        law: &Law<'_>,
        spring: f64,
    ) -> bool {
        place(problem, indices, &mut self.active);
        (self.amplitude, self.balance) = match law {
            Law::Rows { .. } => (problem.operator.rho, 1.0),
            Law::Columns { .. } => (1.0, problem.operator.rho),
        };
        match w.sparse() {
            Some(w) => {
                let lu = self.sparse.get_or_insert_default();
                sparse_columns(lu, problem, w, &self.active, law, spring);
                lu.factor()
            }
            None => {
                self.sparse = None;
                self.fill(problem, w, law, spring);
                self.lu.factor()
            }
        }
    }

    /// The full matrix, in place of the factors.
    fn fill(&mut self, problem: &ContactProblem<'_>, w: &dyn Delassus, law: &Law<'_>, spring: f64) {
        let (q, rho) = (&problem.operator.modes.q, problem.operator.rho);
        let (size, active) = (self.active.len() + q.len(), &mut self.active);
        let ties = match law {
            Law::Rows { a, c } => ties(active, a, c),
            Law::Columns { .. } => Vec::new(),
        };
        let tied: Vec<Place> = ties.iter().map(|tie| active[tie.d].clone()).collect();
        active.retain(|place| tied.binary_search_by_key(&place.0, |tied| tied.0).is_err());
        self.lu.ties = ties;
        let (J, across) = self.lu.zeros(size);
        let n = active.len();
        match law {
            Law::Rows { a, c } => {
                law_points(active, c, &mut self.laws);
                let rows = (&active[..], *a, &self.laws[..]);
                for (to, places) in [(&mut *J, &active[..]), (&mut *across, &tied)] {
                    to.for_columns(|j, column| {
                        if let Some(place) = places.get(j) {
                            let column = &mut column[..n];
                            law_column(problem, w, place, rows, &mut Vec::new(), column);
                        }
                    });
                }
            }
            Law::Columns { e, s } => columns(J, w, active, e, s),
        }
        for (j, q) in q.iter().enumerate() {
            J[(n + j, n + j)] = -spring;
            for (b, place) in active.iter().enumerate() {
                (J[(b, n + j)], J[(n + j, b)]) = law.border(place, q, rho);
            }
            for (b, place) in tied.iter().enumerate() {
                across[(n + j, b)] = law.border(place, q, rho).1;
            }
        }
    }

    /// The factors of a full matrix.
    pub fn factors(&self) -> Option<&TiedLu> {
        self.sparse.is_none().then_some(&self.lu)
    }

    /// (x, β) for right-hand sides f on the active rows and c; `None` if they are not finite.
    pub fn solve(&mut self, f: &[f64], c: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let (mut x, mut beta) = (Vec::new(), Vec::new());
        self.solve_into(f, c, &mut x, &mut beta)
            .then_some((x, beta))
    }

    /// The same in place of what `x` and `beta` hold; false if they are not finite.
    pub fn solve_into(
        &mut self,
        f: &[f64],
        c: &[f64],
        x: &mut Vec<f64>,
        beta: &mut Vec<f64>,
    ) -> bool {
        let balance = c.iter().map(|c| c / self.balance);
        self.right.clear();
        self.right.extend(f.iter().copied().chain(balance));
        let finite = match &self.sparse {
            Some(lu) => lu.solve_into(&self.right, x),
            None => self.lu.solve_into(&self.right, x, &mut self.work),
        };
        beta.clear();
        beta.extend(x.drain(f.len()..).map(|b| b / self.amplitude));
        finite
    }
}

/// A row with the rows of its point.
pub(crate) type Place = (usize, Range<usize>);

/// Rows of C of one point: how many, where those of the point stand in a column of W, and the coefficients of each.
pub(crate) struct LawPoint {
    rows: usize,
    own: Range<usize>,
    c: [[f64; 3]; 3],
}

/// Rows, in increasing order, in place of what `places` holds.
pub(crate) fn place(problem: &ContactProblem<'_>, indices: &[usize], places: &mut Vec<Place>) {
    let mut left = indices.iter().peekable();
    places.clear();
    for own in problem.rows.iter() {
        while let Some(&k) = left.next_if(|k| own.contains(k)) {
            places.push((k, own.clone()));
        }
    }
}

/// Second rows in 2D that read the gap alone, as the first does, or nothing: where a point slips.
fn ties(active: &[Place], a: Blocks<'_>, c: Blocks<'_>) -> Vec<Tie> {
    /// Largest α: beyond, pivots tell better.
    const STEEP: f64 = 1e3;
    let tie = |(before, rows): (usize, &[Place])| {
        let (k, d) = (rows[0].0, rows[1].0);
        let (gap, alone) = (c[k][0], c[k][1] == 0.0 && c[k][0] != 0.0);
        if rows[0].1 != rows[1].1
            || rows[0].1.len() != 2
            || c[d][1] != 0.0
            || c[d][0] != 0.0 && !alone
        {
            return None;
        }
        let phi = if c[d][0] == 0.0 { 0.0 } else { c[d][0] / gap };
        let [by, pivot] = [0, 1].map(|l| a[d][l] - phi * a[k][l]);
        let tie = Tie {
            d: before + 1,
            alpha: -by / pivot,
            phi,
            pivot,
        };
        (tie.alpha.abs() < STEEP).then_some(tie)
    };
    active.windows(2).enumerate().filter_map(tie).collect()
}

/// C of these rows in place of what `laws` holds.
pub(crate) fn law_points(places: &[Place], c: Blocks<'_>, laws: &mut Vec<LawPoint>) {
    let law = |point: &[Place]| LawPoint {
        rows: point.len(),
        own: point[0].1.clone(),
        c: [0, 1, 2].map(|k| point.get(k).map_or([0.0; 3], |place| c[place.0])),
    };
    laws.clear();
    laws.extend(places.chunk_by(|a, b| a.1 == b.1).map(law));
}

/// Column k of A + C W on some rows.
pub(crate) fn law_column(
    problem: &ContactProblem<'_>,
    w: &dyn Delassus,
    (k, point): &Place,
    (places, a, laws): (&[Place], Blocks<'_>, &[LawPoint]),
    work: &mut Vec<f64>,
    column: &mut [f64],
) {
    let w = w.column(*k, work);
    match problem.increment.system.dim() {
        2 => times::<2>(laws, w, column),
        _ => times::<3>(laws, w, column),
    }
    // Rows of one point follow each other.
    let first = places.partition_point(|(row, _)| *row < point.start);
    let of_point = places[first..].iter().take_while(|place| place.1 == *point);
    let entries = column[first..].iter_mut().zip(of_point);
    entries.for_each(|(entry, (row, own))| *entry += a[*row][k - own.start]);
}

/// C Q/ρ of a row and a rigid motion.
pub(crate) fn law_border((k, own): &Place, c: Blocks<'_>, q: &[f64], rho: f64) -> f64 {
    own.clone().zip(c[*k]).map(|(l, c)| c * q[l] / rho).sum()
}

/// C w; of a point with all `D` rows without a loop.
fn times<const D: usize>(laws: &[LawPoint], w: &[f64], mut column: &mut [f64]) {
    for LawPoint { rows, own, c } in laws {
        let (entries, rest) = column.split_at_mut(*rows);
        let w = &w[own.clone()];
        match (w.first_chunk::<D>(), entries.first_chunk_mut::<D>()) {
            (Some(w), Some(entries)) => {
                *entries = std::array::from_fn(|k| (0..D).map(|l| c[k][l] * w[l]).sum());
            }
            _ => (entries.iter_mut().zip(c))
                .for_each(|(entry, c)| *entry = c.iter().zip(w).map(|(c, w)| c * w).sum()),
        }
        column = rest;
    }
}

/// E + W S on the active rows.
fn columns(J: &mut Full, w: &dyn Delassus, active: &[Place], e: Blocks<'_>, s: Blocks<'_>) {
    let mut work = Vec::new();
    for (b, (k, point)) in active.iter().enumerate() {
        let column = &mut J.column_mut(b)[..active.len()];
        for l in point.clone() {
            let s = s[l][k - point.start];
            if s != 0.0 {
                let w = w.column(l, &mut work);
                let entries = column.iter_mut().zip(active);
                entries.for_each(|(entry, (a, _))| *entry += w[*a] * s);
            }
            // Rows of one point follow each other, so row l of this point is active row b − k + l.
            column[b + l - k] += e[l][k - point.start];
        }
    }
}

/// The columns of the whole system where few entries of W are not 0, in place of what `lu` holds.
fn sparse_columns(
    lu: &mut SparseLu,
    problem: &ContactProblem<'_>,
    w: &Sparse,
    active: &[Place],
    law: &Law<'_>,
    spring: f64,
) {
    let (modes, rho) = (&problem.operator.modes.q, problem.operator.rho);
    let n = active.len();
    // Where each row stands among the active ones, and the rows of its point.
    let mut at = vec![None; problem.len()];
    (active.iter().enumerate()).for_each(|(i, (k, _))| at[*k] = Some(i));
    let points = problem.rows.iter();
    let around: Vec<_> = points
        .flat_map(|own| own.clone().map(move |_| own.clone()))
        .collect();
    let of_mode = |q: &Vec<f64>| -> Vec<(f64, f64)> {
        let places = active.iter();
        places.map(|place| law.border(place, q, rho)).collect()
    };
    let border: Vec<_> = modes.iter().map(of_mode).collect();
    lu.clear();
    let mut column = Vec::new();
    for (b, (k, own)) in active.iter().enumerate() {
        column.clear();
        let local = k - own.start;
        let e = match law {
            Law::Rows { a, c } => {
                // Rows of one point follow each other, in the column as in W.
                let mut entries = w.entries(*k).peekable();
                while let Some(&(i, _)) = entries.peek() {
                    let (point, mut of_point) = (&around[i], [0.0; 3]);
                    while let Some((i, w)) = entries.next_if(|(i, _)| point.contains(i)) {
                        of_point[i - point.start] = w;
                    }
                    for row in point.clone() {
                        let entry: f64 = c[row].iter().zip(of_point).map(|(c, w)| c * w).sum();
                        column.extend(at[row].filter(|_| c[row] != [0.0; 3]).map(|to| (to, entry)));
                    }
                }
                a
            }
            Law::Columns { e, s } => {
                for l in own.clone().filter(|l| s[*l][local] != 0.0) {
                    let s = s[l][local];
                    let entries = w.entries(l).filter_map(|(i, w)| Some((at[i]?, w * s)));
                    column.extend(entries);
                }
                e
            }
        };
        let of_point = own.clone().filter_map(|l| Some((at[l]?, e[l][local])));
        column.extend(of_point);
        let motions = border.iter().enumerate();
        column.extend(motions.map(|(j, border)| (n + j, border[b].1)));
        lu.push(&mut column);
    }
    for (j, border) in border.iter().enumerate() {
        column.clear();
        column.extend(border.iter().enumerate().map(|(b, border)| (b, border.0)));
        column.push((n + j, -spring));
        lu.push(&mut column);
    }
}
