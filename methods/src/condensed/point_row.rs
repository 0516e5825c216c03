//! Linearised contact laws at the points, and the one dense solve of Newton's methods.
//! ```text
//! rows:      A δP + C δv = f,     δv = W δP + Q δβ,   Qᵀ δP = c          A, C by point
//! columns:   E y + δv = f,        δP = S y,           Qᵀ δP = c          E, S by point
//! ```
//! Both are one bordered system (E + L W R) x + L Q β = f, Qᵀ R x = c, on the rows that are active.

#![allow(non_snake_case)]

use std::ops::Range;

use faer::Mat;

use crate::algebra::delassus::Delassus;
use crate::algebra::dense::DenseLu;
use crate::condensed::problem::ContactProblem;

/// Row k of the linearised equations at one point: Σ a_l δP_l + Σ c_l δv_l = −h.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointRow {
    pub a: [f64; 3],
    pub c: [f64; 3],
    pub h: f64,
}

impl PointRow {
    /// A row with a right-hand side and no coefficients yet.
    pub fn reading(h: f64) -> Self {
        Self {
            a: [0.0; 3],
            c: [0.0; 3],
            h,
        }
    }
}

/// A 3 × 3 block by row: entry l of row k couples it with row l of its point.
pub(crate) type Blocks<'a> = &'a [[f64; 3]];

/// Where the blocks of the law stand beside W.
pub(crate) enum Law<'a> {
    /// E = A, L = C, R = I.
    Rows { a: Blocks<'a>, c: Blocks<'a> },
    /// L = I, R = S, E = `unit` I + e; `series` is a compliance added to W.
    Columns {
        unit: f64,
        e: Blocks<'a>,
        s: Blocks<'a>,
        series: Option<&'a Mat<f64>>,
    },
}

/// The factored system.
pub(crate) struct Bordered {
    lu: DenseLu,
    /// Unknowns are amplitudes times this.
    amplitude: f64,
    /// Right-hand sides of the balance are divided by this.
    balance: f64,
    active: usize,
}

impl Bordered {
    /// Assembles and factors it on the active rows, in increasing order; `None` if it is singular.
    pub fn new(problem: &ContactProblem<'_>, active: &[usize], law: &Law<'_>) -> Option<Self> {
        Self::on_spring(problem, active, law, 0.0)
    }

    /// The same; where the rows leave a piece loose, Qᵀ R x − ε ρ β = c holds it. Without a load it stays where it is, as good
    /// a place as any; with one it moves until something is in its way.
    pub fn held(problem: &ContactProblem<'_>, active: &[usize], law: &Law<'_>) -> Option<Self> {
        /// ε. Answers do not depend on it; with 1e-10 … 1e-3 Newton methods take as many steps, with 1 more.
        const SPRING: f64 = 1e-3;
        let free = Self::new(problem, active, law);
        free.or_else(|| match problem.modes() {
            0 => None,
            _ => Self::on_spring(problem, active, law, SPRING),
        })
    }

    fn on_spring(
        problem: &ContactProblem<'_>,
        active: &[usize],
        law: &Law<'_>,
        spring: f64,
    ) -> Option<Self> {
        let (w, q, rho) = (
            &*problem.operator.w,
            &problem.operator.modes.q,
            problem.operator.rho,
        );
        // With the rows of its point.
        let (indices, mut left) = (active, active.iter().peekable());
        let mut active: Vec<(usize, Range<usize>)> = Vec::with_capacity(indices.len());
        for own in problem.rows.iter() {
            while let Some(&k) = left.next_if(|k| own.contains(k)) {
                active.push((k, own.clone()));
            }
        }
        let (n, size) = (active.len(), active.len() + q.len());
        let mut J = Mat::<f64>::zeros(size, size);
        match law {
            Law::Rows { a, c } => rows(&mut J, w, &active, a, c),
            Law::Columns { unit, e, s, series } => {
                (0..n).for_each(|k| J[(k, k)] = *unit);
                columns(&mut J, w, *series, (indices, &active), e, s);
            }
        }
        for (j, q) in q.iter().enumerate() {
            J[(n + j, n + j)] = -spring;
            for (b, (k, own)) in active.iter().enumerate() {
                let (k, own) = (*k, own.clone());
                match law {
                    Law::Rows { c, .. } => {
                        J[(b, n + j)] = own.zip(c[k]).map(|(l, c)| c * q[l] / rho).sum();
                        J[(n + j, b)] = q[k];
                    }
                    Law::Columns { s, .. } => {
                        let column = k - own.start;
                        J[(b, n + j)] = q[k];
                        J[(n + j, b)] = own.map(|l| q[l] * s[l][column] / rho).sum();
                    }
                }
            }
        }
        let (amplitude, balance) = match law {
            Law::Rows { .. } => (rho, 1.0),
            Law::Columns { .. } => (1.0, rho),
        };
        Some(Self {
            lu: DenseLu::new(J)?,
            amplitude,
            balance,
            active: n,
        })
    }

    /// (x, β) for right-hand sides f on the active rows and c; `None` if they are not finite.
    pub fn solve(&self, f: &[f64], c: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let balance = c.iter().map(|c| c / self.balance);
        let rhs: Vec<f64> = f.iter().copied().chain(balance).collect();
        let mut x = self.lu.solve(&rhs)?;
        let beta = x.split_off(self.active);
        Some((x, beta.iter().map(|b| b / self.amplitude).collect()))
    }
}

/// A + C W on the active rows.
fn rows(
    J: &mut Mat<f64>,
    w: &dyn Delassus,
    active: &[(usize, Range<usize>)],
    a: Blocks<'_>,
    c: Blocks<'_>,
) {
    // Side by side, for the loop over all entries.
    let laws: Vec<(Range<usize>, [f64; 3])> = (active.iter())
        .map(|(row, own)| (own.clone(), c[*row]))
        .collect();
    let mut work = Vec::new();
    for (column, (k, point)) in active.iter().enumerate() {
        let w = w.column(*k, &mut work);
        let entries = &mut J.col_as_slice_mut(column)[..active.len()];
        for (entry, (own, c)) in entries.iter_mut().zip(&laws) {
            *entry = match &w[own.clone()] {
                [n] => c[0] * n,
                [n, a] => c[0] * n + c[1] * a,
                [n, a, b] => c[0] * n + c[1] * a + c[2] * b,
                own => unreachable!("a point of {} rows", own.len()),
            };
        }
        // Active rows of one point follow each other.
        let before = (active[..column].iter().rev()).take_while(|(_, own)| own == point);
        let first = column - before.count();
        for (entry, (row, own)) in entries[first..].iter_mut().zip(&active[first..]) {
            if own != point {
                break;
            }
            *entry += a[*row][k - own.start];
        }
    }
}

/// E + (W + C) S on the active rows.
fn columns(
    J: &mut Mat<f64>,
    w: &dyn Delassus,
    series: Option<&Mat<f64>>,
    (indices, active): (&[usize], &[(usize, Range<usize>)]),
    e: Blocks<'_>,
    s: Blocks<'_>,
) {
    // Where all rows are active, whole columns are added.
    let (mut work, all) = (Vec::new(), active.len() == w.rows());
    for (b, (k, point)) in active.iter().enumerate() {
        let column = &mut J.col_as_slice_mut(b)[..active.len()];
        for l in point.clone() {
            let s = s[l][k - point.start];
            if s != 0.0 {
                let held = series.map(|c| c.col_as_slice(l));
                for w in [Some(w.column(l, &mut work)), held].into_iter().flatten() {
                    let entries = column.iter_mut();
                    if all {
                        entries.zip(w).for_each(|(entry, w)| *entry += w * s);
                    } else {
                        let own = entries.zip(indices);
                        own.for_each(|(entry, &a)| *entry += w[a] * s);
                    }
                }
            }
            // Rows of one point follow each other, so row l of this point is active row b − k + l.
            column[b + l - k] += e[l][k - point.start];
        }
    }
}
