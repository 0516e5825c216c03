//! LU factors of a full matrix J some rows of which, less a multiple of the row before, hold two unknowns alone.
//! ```text
//! row d − φ row d−1:   p (x_d − α x_{d−1}) = f_d − φ f_{d−1}
//! x_d = t + α x_{d−1},   t = (f_d − φ f_{d−1})/p,   (J_KK + J_Kd α) x_K = f_K − J_Kd t        K: all other rows
//! ```
//! Where m of n rows are tied, the factors have n − m.

#![allow(non_snake_case)]

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, Par};

use crate::algebra::dense::{DenseLu, add, add_columns, refill};
use crate::algebra::plain::Full;

/// A row d and how it is tied to the one before.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tie {
    pub d: usize,
    pub alpha: f64,
    pub phi: f64,
    pub pivot: f64,
}

impl Tie {
    fn t(&self, f: impl Fn(usize) -> f64) -> f64 {
        (f(self.d) - self.phi * f(self.d - 1)) / self.pivot
    }
}

/// The factors. The memory of one serves the next.
#[derive(Default)]
pub(crate) struct TiedLu {
    /// Of J_KK + J_Kd α.
    lu: DenseLu,
    /// By increasing d.
    pub ties: Vec<Tie>,
    /// J_Kd.
    across: Full,
}

impl TiedLu {
    /// Zeros for J_KK and J_Kd, to be filled, then [factored](Self::factor), of a J of `n` rows with these `ties`.
    pub fn zeros(&mut self, n: usize) -> (&mut Full, &mut Full) {
        let kept = n - self.ties.len();
        self.across.clear(kept, self.ties.len());
        (self.lu.zeros(kept), &mut self.across)
    }

    /// Factors what was filled in; false if it is singular to working precision.
    pub fn factor(&mut self) -> bool {
        let Self { lu, ties, across } = self;
        for (j, tie) in ties.iter().enumerate() {
            // As many tied rows stand before it as ties.
            let column = lu.matrix().column_mut(tie.d - 1 - j);
            add(tie.alpha, across.column(j), column);
        }
        lu.factor()
    }

    /// Rows and columns of the factors.
    pub fn size(&self) -> usize {
        self.across.rows()
    }

    /// K, of n rows.
    fn kept(&self, n: usize) -> impl Iterator<Item = usize> {
        let mut tied = self.ties.iter().peekable();
        (0..n).filter(move |i| tied.next_if(|tie| tie.d == *i).is_none())
    }

    /// x with J x = f; `None` if it is not finite.
    pub fn solve(&self, f: &[f64]) -> Option<Vec<f64>> {
        let mut x = Vec::new();
        self.solve_into(f, &mut x, &mut Vec::new()).then_some(x)
    }

    /// The same in place of what `x` holds; false if it is not finite.
    pub fn solve_into(&self, f: &[f64], x: &mut Vec<f64>, work: &mut Vec<f64>) -> bool {
        if self.ties.is_empty() {
            return self.lu.solve_into(f, x);
        }
        let minus = self.ties.iter().map(|tie| -tie.t(|i| f[i]));
        refill(work, self.kept(f.len()).map(|i| f[i]).chain(minus));
        let (rest, minus) = work.split_at_mut(self.size());
        add_columns(|j| self.across.column(j), minus, rest);
        let finite = self.lu.solve_into(rest, x);
        // From the last on, so that nothing is overwritten.
        x.resize(f.len(), 0.0);
        let mut end = f.len();
        for (k, Tie { d, alpha, .. }) in self.ties.iter().enumerate().rev() {
            x.copy_within(d - k..end - k - 1, d + 1);
            x[*d] = alpha * x[d - 1 - k] - minus[k];
            end = *d;
        }
        finite && x.iter().all(|v| v.is_finite())
    }

    /// X := J⁻¹ X, by blocks.
    pub fn solve_in_place(&self, mut X: MatMut<'_, f64>) {
        if self.ties.is_empty() {
            return self.lu.solve_in_place(X);
        }
        let kept: Vec<usize> = self.kept(X.nrows()).collect();
        let t = Mat::from_fn(self.ties.len(), X.ncols(), |k, j| {
            self.ties[k].t(|i| X[(i, j)])
        });
        let mut rest = Mat::from_fn(kept.len(), X.ncols(), |i, j| X[(kept[i], j)]);
        matmul(
            &mut rest,
            Accum::Add,
            self.across.view(),
            &t,
            -1.0,
            Par::Seq,
        );
        self.lu.solve_in_place(rest.as_mut());
        for j in 0..X.ncols() {
            (kept.iter().enumerate()).for_each(|(i, &to)| X[(to, j)] = rest[(i, j)]);
            for (k, Tie { d, alpha, .. }) in self.ties.iter().enumerate() {
                X[(*d, j)] = t[(k, j)] + alpha * X[(d - 1, j)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::dense::{minus, norm};

    /// Source: the full matrix. Tolerance: rounding. Ties at both ends and beside each other.
    #[test]
    fn answers_are_those_of_the_full_matrix() {
        let (n, tied) = (9, [1, 4, 6, 8]);
        let entry = |i: usize, j: usize| ((3 * i * i + 7 * j + i * j) as f64).sin();
        let mut J = Mat::from_fn(n, n, |i, j| entry(i, j) + if i == j { 4.0 } else { 0.0 });
        let mut lu = TiedLu::default();
        for (k, d) in tied.into_iter().enumerate() {
            let [alpha, phi, pivot] = [0, 1, 2].map(|l| 1.5 + entry(k, l));
            for j in 0..n {
                J[(d, j)] = phi * J[(d - 1, j)];
            }
            J[(d, d)] += pivot;
            J[(d, d - 1)] -= alpha * pivot;
            let tie = Tie {
                d,
                alpha,
                phi,
                pivot,
            };
            lu.ties.push(tie);
        }
        let kept = [0, 2, 3, 5, 7];
        let (own, across) = lu.zeros(n);
        for (i, &from) in kept.iter().enumerate() {
            (0..5).for_each(|j| own.column_mut(j)[i] = J[(from, kept[j])]);
            (0..4).for_each(|j| across[(i, j)] = J[(from, tied[j])]);
        }
        assert!(lu.factor());
        let x = Mat::from_fn(n, 3, |i, j| entry(j, i));
        let mut found = &J * &x;
        let f = found.col_as_slice(1).to_vec();
        let off = |found: &[f64], j: usize| norm(&minus(found, x.col_as_slice(j)));
        assert!(off(&lu.solve(&f).unwrap(), 1) < 1e-13);
        lu.solve_in_place(found.as_mut());
        assert!((0..3).all(|j| off(found.col_as_slice(j), j) < 1e-13));
    }
}
