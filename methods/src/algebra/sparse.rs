//! A Delassus operator of which few entries are not 0, as of granular media, and LU factors of matrices made of it.

use std::ops::Range;
use std::sync::Arc;

use faer::MatMut;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

use crate::algebra::delassus::{Delassus, Dense};
use crate::algebra::dense::{SINGULAR, larger, refill, zero};
use crate::algebra::matrix::SquareMatrix;
use crate::algebra::plain::Full;
use crate::error::MethodError;

/// Fewest rows of an operator that is held by its entries.
const FEWEST: usize = 128;
/// Most entries of it, as a part 1/n of all.
const SPARSE: usize = 16;

/// W by the entries that are not 0, of both triangles.
pub struct Sparse {
    w: SquareMatrix,
    diagonal: Vec<f64>,
    symmetric: bool,
}

impl Sparse {
    /// `None` where W has few rows, or many entries.
    pub fn of(w: &SquareMatrix) -> Result<Option<Self>, MethodError> {
        let (n, entries) = (w.size(), w.values().len());
        let both = if w.is_symmetric() {
            2 * entries - n
        } else {
            entries
        };
        if !is_sparse(n, both) {
            return Ok(None);
        }
        Ok(Some(Self {
            diagonal: (0..n).map(|k| w.diagonal(k)).collect(),
            symmetric: w.is_symmetric(),
            w: w.whole()?,
        }))
    }

    /// Rows and entries of column `k`.
    pub fn entries(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.w.column(k)
    }

    /// v += W δP of one point.
    pub fn add_columns(&self, rows: Range<usize>, step: [f64; 3], v: &mut [f64]) {
        for (k, step) in rows.zip(step) {
            self.entries(k).for_each(|(i, w)| v[i] += w * step);
        }
    }

    /// c W + 1 on the diagonal, factored; `None` if it is singular.
    pub(crate) fn shifted(&self, c: f64) -> Option<SparseLu> {
        let mut lu = SparseLu::default();
        lu.clear();
        let mut column = Vec::new();
        for k in 0..self.rows() {
            column.clear();
            column.extend(self.entries(k).map(|(i, w)| (i, c * w)));
            column.push((k, 1.0));
            lu.push(&mut column);
        }
        lu.factor().then_some(lu)
    }

    /// Whether W, symmetric, moved by `shift` has a Cholesky factor.
    pub fn is_definite(&self, shift: f64) -> bool {
        let (ends, rows, mut values) =
            (self.w.col_ptr(), self.w.row_idx(), self.w.values().to_vec());
        for j in 0..self.rows() {
            let own = ends[j]..ends[j + 1];
            match rows[own.clone()].binary_search(&j) {
                Ok(at) => values[own.start + at] += shift,
                // A row without a diagonal entry is definite only if it is empty.
                Err(_) if !own.is_empty() => return false,
                Err(_) => {}
            }
        }
        let n = self.rows();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, ends, None, rows);
        let factor = SparseColMatRef::new(pattern, &values).sp_cholesky(faer::Side::Lower);
        factor.is_ok()
    }
}

impl Delassus for Sparse {
    fn rows(&self) -> usize {
        self.diagonal.len()
    }

    fn apply_add(&self, p: &[f64], v: &mut [f64]) {
        for (k, &p) in p.iter().enumerate() {
            if p != 0.0 {
                self.entries(k).for_each(|(i, w)| v[i] += w * p);
            }
        }
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn column<'a>(&'a self, k: usize, work: &'a mut Vec<f64>) -> &'a [f64] {
        zero(work, self.rows());
        self.entries(k).for_each(|(i, w)| work[i] = w);
        work
    }

    fn formed(&self) -> bool {
        true
    }

    fn symmetric(&self) -> bool {
        self.symmetric
    }

    fn sparse(&self) -> Option<&Sparse> {
        Some(self)
    }

    fn apply_transpose_add(&self, p: &[f64], v: &mut [f64]) {
        for (k, v) in v.iter_mut().enumerate() {
            *v += self.entries(k).map(|(i, w)| w * p[i]).sum::<f64>();
        }
    }

    fn apply_abs_add(&self, p: &[f64], v: &mut [f64]) {
        for (k, &p) in p.iter().enumerate() {
            self.entries(k).for_each(|(i, w)| v[i] += (w * p).abs());
        }
    }

    fn block(&self, rows: Range<usize>) -> [[f64; 3]; 3] {
        let mut block = [[0.0; 3]; 3];
        for (l, k) in rows.clone().enumerate() {
            for (i, w) in self.entries(k).filter(|(i, _)| rows.contains(i)) {
                block[i - rows.start][l] = w;
            }
        }
        block
    }

    fn select(&self, at: &[usize]) -> Result<Arc<dyn Delassus>, MethodError> {
        let mut place = vec![usize::MAX; self.rows()];
        at.iter()
            .enumerate()
            .for_each(|(to, &from)| place[from] = to);
        let (mut ends, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for &from in at {
            let kept = self.entries(from).filter(|(i, _)| place[*i] != usize::MAX);
            kept.for_each(|(i, w)| {
                rows.push(place[i]);
                values.push(w);
            });
            ends.push(values.len());
        }
        let w = SquareMatrix::general(at.len(), ends, rows, values)?;
        let diagonal = at.iter().map(|&k| self.diagonal[k]).collect();
        Ok(Arc::new(Self {
            w,
            diagonal,
            symmetric: self.symmetric,
        }))
    }

    fn matrix(&self) -> Result<SquareMatrix, MethodError> {
        if self.symmetric {
            self.w.lower()
        } else {
            Ok(self.w.clone())
        }
    }
}

/// Whether an operator on so many rows is held by its entries.
fn is_sparse(rows: usize, entries: usize) -> bool {
    rows >= FEWEST && SPARSE * entries <= rows * rows
}

/// A symmetric W that was computed in full: of many bodies that touch here and there most entries are 0.
pub(crate) fn computed(w: Full) -> Result<Arc<dyn Delassus>, MethodError> {
    let columns = || (0..w.columns()).map(|j| w.column(j));
    let entries = columns().flatten().filter(|w| **w != 0.0).count();
    if !is_sparse(w.columns(), entries) {
        return Ok(Arc::new(Dense::new(w, true)));
    }
    let (mut ends, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (j, column) in columns().enumerate() {
        let kept = column.iter().enumerate().skip(j);
        for (i, &value) in kept.filter(|(i, w)| *i == j || **w != 0.0) {
            rows.push(i);
            values.push(value);
        }
        ends.push(values.len());
    }
    held(&SquareMatrix::symmetric(w.columns(), ends, rows, values)?)
}

/// W as its entries are few or many.
pub(crate) fn held(w: &SquareMatrix) -> Result<Arc<dyn Delassus>, MethodError> {
    Ok(match Sparse::of(w)? {
        Some(sparse) => Arc::new(sparse),
        None => Arc::new(Dense::new(
            crate::algebra::delassus::dense(w)?,
            w.is_symmetric(),
        )),
    })
}

/// LU factors of a sparse matrix, which is given column by column. A pattern that was the last one's, too, is not analysed again.
#[derive(Default)]
pub(crate) struct SparseLu {
    ends: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    /// Of the pattern beside it.
    analysed: Option<(SymbolicLu<usize>, Vec<usize>, Vec<usize>)>,
    factors: Option<Lu<usize, f64>>,
}

impl SparseLu {
    /// A matrix without columns.
    pub fn clear(&mut self) {
        self.factors = None;
        refill(&mut self.ends, [0]);
        self.rows.clear();
        self.values.clear();
    }

    /// The next column; entries of one row are added.
    pub fn push(&mut self, column: &mut [(usize, f64)]) {
        column.sort_by_key(|entry| entry.0);
        let begin = self.rows.len();
        for &mut (row, value) in column {
            if self.rows.len() > begin && self.rows.last() == Some(&row) {
                let last = self.values.len() - 1;
                self.values[last] += value;
            } else {
                self.rows.push(row);
                self.values.push(value);
            }
        }
        self.ends.push(self.rows.len());
    }

    fn size(&self) -> usize {
        self.ends.len() - 1
    }

    /// Factors it; false if it is singular to working precision, as the answer to a vector of ones of either sign tells.
    pub fn factor(&mut self) -> bool {
        let n = self.size();
        if n == 0 || self.values.iter().any(|v| !v.is_finite()) {
            return n == 0;
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.ends, None, &self.rows);
        let known = self.analysed.take();
        let known = known.filter(|(_, ends, rows)| *ends == self.ends && *rows == self.rows);
        let symbolic = match known {
            Some(known) => known,
            None => match SymbolicLu::try_new(pattern) {
                Ok(symbolic) => (symbolic, self.ends.clone(), self.rows.clone()),
                Err(_) => return false,
            },
        };
        let matrix = SparseColMatRef::new(pattern, &self.values);
        self.factors = Lu::try_new_with_symbolic(symbolic.0.clone(), matrix).ok();
        self.analysed = Some(symbolic);
        self.is_regular()
    }

    fn is_regular(&self) -> bool {
        let n = self.size();
        // A pattern without meaning, so that no symmetry of the matrix hides what is singular.
        let golden = |i: usize| (0.618_033_988_749_895 * (i + 1) as f64).fract();
        let b: Vec<f64> = (0..n)
            .map(|i| if golden(i) < 0.5 { 1.0 } else { -1.0 })
            .collect();
        let mut x = Vec::new();
        if !self.solve_into(&b, &mut x) {
            return false;
        }
        let most = |v: &[f64]| v.iter().fold(0.0, |m: f64, v| larger(m, v.abs()));
        let size = most(&self.values) * most(&x);
        size.is_finite() && SINGULAR * n as f64 * size < 1.0
    }

    /// x with A x = b in place of what `x` holds; false if it is not finite.
    pub fn solve_into(&self, b: &[f64], x: &mut Vec<f64>) -> bool {
        b.clone_into(x);
        if self.size() == 0 {
            return true;
        }
        let Some(factors) = &self.factors else {
            return false;
        };
        factors.solve_in_place(MatMut::from_column_major_slice_mut(x, b.len(), 1));
        x.iter().all(|v| v.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::dense::{minus, norm};

    /// A chain of `n` rows, `off` above and below a diagonal of 4.
    fn chain(n: usize, off: f64) -> SquareMatrix {
        let (mut ends, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            for (i, value) in [(j, 4.0), (j + 1, off)] {
                if i < n {
                    rows.push(i);
                    values.push(value);
                }
            }
            ends.push(values.len());
        }
        SquareMatrix::symmetric(n, ends, rows, values).unwrap()
    }

    /// Source: the full matrix. Tolerance: rounding.
    #[test]
    fn what_it_is_asked_is_what_a_full_matrix_answers() {
        let n = 3 * FEWEST;
        let sparse = Sparse::of(&chain(n, -1.5)).unwrap().unwrap();
        let full = Dense::new(
            crate::algebra::delassus::dense(&chain(n, -1.5)).unwrap(),
            true,
        );
        assert!(Sparse::of(&chain(FEWEST - 1, -1.5)).unwrap().is_none());
        let p: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let both: [&dyn Delassus; 2] = [&sparse, &full];
        let agree = |of: &dyn Fn(&dyn Delassus) -> Vec<f64>| {
            let [a, b] = both.map(of);
            assert!(norm(&minus(&a, &b)) <= 1e-14 * norm(&b));
        };
        let product = |times: &dyn Fn(&mut [f64])| {
            let mut v = vec![0.25; n];
            times(&mut v);
            v
        };
        agree(&|w| product(&|v| w.apply_add(&p, v)));
        agree(&|w| product(&|v| w.apply_abs_add(&p, v)));
        agree(&|w| product(&|v| w.apply_transpose_add(&p, v)));
        agree(&|w| w.column(7, &mut Vec::new()).to_vec());
        agree(&|w| w.block(6..9).concat());
        let at: Vec<usize> = (0..n).step_by(2).collect();
        agree(&|w| w.select(&at).unwrap().to_matrix().col_as_slice(3).to_vec());
        assert_eq!(sparse.matrix().unwrap(), chain(n, -1.5));
        assert!(sparse.is_definite(0.0) && !sparse.is_definite(-2.0));
        let again = computed((&full.to_matrix()).into()).unwrap();
        assert_eq!(again.sparse().unwrap().w, sparse.w);
    }

    /// c on the diagonal, 1 below it and in the far corner: its eigenvalues are c + ωᵏ, ω an even root of 1. Source: x itself. The
    /// pattern is always the same: one analysis serves all.
    #[test]
    fn systems_are_solved_and_singular_ones_found() {
        let (n, mut lu) = (200, SparseLu::default());
        let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        for (c, regular) in [(3.0, true), (1.0, false), (-2.0, true), (-1.0, false)] {
            lu.clear();
            (0..n).for_each(|j| lu.push(&mut [((j + 1) % n, 1.0), (j, c - 1.0), (j, 1.0)]));
            assert_eq!(lu.factor(), regular, "{c}");
            let b: Vec<f64> = (0..n).map(|i| c * x[i] + x[(i + n - 1) % n]).collect();
            let mut solved = Vec::new();
            if regular {
                assert!(lu.solve_into(&b, &mut solved));
                assert!(norm(&minus(&solved, &x)) < 1e-13 * norm(&x));
            }
        }
    }
}
