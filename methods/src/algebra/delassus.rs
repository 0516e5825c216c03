//! The Delassus operator W = B K⁻¹ Bᵀ: what it can be asked, and W as a full matrix.

use std::sync::Arc;

use faer::Mat;

use crate::algebra::dense::{add_columns, dot, mul_add, norm, refill};
use crate::algebra::matrix::SquareMatrix;
use crate::algebra::memory;
use crate::algebra::plain::Full;
use crate::algebra::sparse::Sparse;
use crate::error::MethodError;

/// The Delassus operator on the contact rows in use, in m/N (2D: m²/N): symmetric positive semi-definite where it comes from
/// a stiffness, whatever it is where it was given. How it is held is the business of the implementation alone.
pub trait Delassus: Send + Sync {
    /// Number of contact rows.
    fn rows(&self) -> usize;

    /// v += W p.
    fn apply_add(&self, p: &[f64], v: &mut [f64]);

    /// Diagonal entries, the compliance of every row.
    fn diagonal(&self) -> &[f64];

    /// Column k, borrowed where it is held, else computed into `work`.
    fn column<'a>(&'a self, k: usize, work: &'a mut Vec<f64>) -> &'a [f64];

    /// Whether the matrix is held, so that columns cost nothing.
    fn formed(&self) -> bool;

    /// Whether W = Wᵀ.
    fn symmetric(&self) -> bool {
        true
    }

    /// W by its entries, where few are not 0.
    fn sparse(&self) -> Option<&Sparse> {
        None
    }

    /// The block of some of the rows.
    ///
    /// # Errors
    /// None that an operator that exists could cause.
    fn select(&self, at: &[usize]) -> Result<Arc<dyn Delassus>, MethodError> {
        let block = Full::of_columns(at.len(), at.len(), |j, to| {
            let mut work = Vec::new();
            let column = self.column(at[j], &mut work);
            to.iter_mut().zip(at).for_each(|(to, &i)| *to = column[i]);
        });
        Ok(Arc::new(Dense::new(block, self.symmetric())))
    }

    /// All of it, of an unsymmetric one what is not 0.
    ///
    /// # Errors
    /// Entries that are not finite.
    fn matrix(&self) -> Result<SquareMatrix, MethodError> {
        let (m, mut work) = (self.rows(), Vec::new());
        let (mut ends, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..m {
            for (i, &value) in self.column(j, &mut work).iter().enumerate() {
                if if self.symmetric() {
                    i >= j
                } else {
                    value != 0.0
                } {
                    rows.push(i);
                    values.push(value);
                }
            }
            ends.push(values.len());
        }
        if self.symmetric() {
            SquareMatrix::symmetric(m, ends, rows, values)
        } else {
            SquareMatrix::general(m, ends, rows, values)
        }
    }

    /// v += Wᵀ p.
    fn apply_transpose_add(&self, p: &[f64], v: &mut [f64]) {
        if self.symmetric() {
            return self.apply_add(p, v);
        }
        let mut work = Vec::new();
        for (k, v) in v.iter_mut().enumerate() {
            *v += dot(self.column(k, &mut work), p);
        }
    }

    /// A bound of ||W||P||: |w_ij| <= √(w_ii w_jj) where W is symmetric and positive semi-definite.
    fn magnitude(&self, p: &[f64]) -> f64 {
        if self.symmetric() {
            let own = p.iter().zip(self.diagonal());
            return own.map(|(p, w)| p.abs() * w.sqrt()).sum::<f64>() * self.trace().sqrt();
        }
        let mut sum = vec![0.0; self.rows()];
        self.apply_abs_add(p, &mut sum);
        norm(&sum)
    }

    /// v += |W| |p|, entry by entry.
    fn apply_abs_add(&self, p: &[f64], v: &mut [f64]) {
        columns_abs_add(self, p, v);
    }

    /// Sum of the diagonal.
    fn trace(&self) -> f64 {
        self.diagonal().iter().sum()
    }

    /// Entries between the (at most three) rows of one point.
    fn block(&self, rows: std::ops::Range<usize>) -> [[f64; 3]; 3] {
        let (mut block, mut work) = ([[0.0; 3]; 3], Vec::new());
        for (l, column) in rows.clone().enumerate() {
            let column = self.column(column, &mut work);
            for (k, row) in rows.clone().enumerate() {
                block[k][l] = column[row];
            }
        }
        block
    }

    /// The whole matrix.
    fn to_matrix(&self) -> Mat<f64> {
        let (m, mut work) = (self.rows(), Vec::new());
        let mut matrix = Mat::zeros(m, m);
        for j in 0..m {
            let column = self.column(j, &mut work);
            matrix.col_as_slice_mut(j).copy_from_slice(column);
        }
        matrix
    }
}

/// v += |W| |p| by the columns of W.
pub(crate) fn columns_abs_add<W: Delassus + ?Sized>(w: &W, p: &[f64], v: &mut [f64]) {
    let mut work = Vec::new();
    for (k, p) in p.iter().enumerate() {
        let parts = v.iter_mut().zip(w.column(k, &mut work));
        parts.for_each(|(v, w)| *v += (w * p).abs());
    }
}

/// W held as a full matrix.
pub(crate) struct Dense {
    w: Full,
    diagonal: Vec<f64>,
    symmetric: bool,
}

impl Dense {
    /// `symmetric`: whether it is, up to the rounding of whoever computed it.
    pub fn new(w: impl Into<Full>, symmetric: bool) -> Self {
        let w = w.into();
        let diagonal = (0..w.rows()).map(|k| w[(k, k)]).collect();
        Self {
            w,
            diagonal,
            symmetric,
        }
    }
}

impl Delassus for Dense {
    fn rows(&self) -> usize {
        self.w.rows()
    }

    fn apply_add(&self, p: &[f64], v: &mut [f64]) {
        add_columns(|j| self.w.column(j), p, v);
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn column<'a>(&'a self, k: usize, _: &'a mut Vec<f64>) -> &'a [f64] {
        self.w.column(k)
    }

    fn formed(&self) -> bool {
        true
    }

    fn symmetric(&self) -> bool {
        self.symmetric
    }
}

/// W + C, a compliance C in series with the body.
pub(crate) struct Series {
    w: Arc<dyn Delassus>,
    compliance: Mat<f64>,
    diagonal: Vec<f64>,
}

impl Series {
    /// Both.
    pub fn new(w: Arc<dyn Delassus>, compliance: Mat<f64>) -> Self {
        let of_w = w.diagonal().iter().enumerate();
        Self {
            diagonal: of_w.map(|(k, w)| w + compliance[(k, k)]).collect(),
            w,
            compliance,
        }
    }

    /// C.
    pub fn compliance(&self) -> &Mat<f64> {
        &self.compliance
    }
}

impl Delassus for Series {
    fn rows(&self) -> usize {
        self.w.rows()
    }

    fn apply_add(&self, p: &[f64], v: &mut [f64]) {
        self.w.apply_add(p, v);
        mul_add(&self.compliance, p, v);
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn column<'a>(&'a self, k: usize, work: &'a mut Vec<f64>) -> &'a [f64] {
        let mut of_w = Vec::new();
        let columns = (self.w.column(k, &mut of_w).iter()).zip(self.compliance.col_as_slice(k));
        refill(work, columns.map(|(w, c)| w + c));
        work
    }

    fn formed(&self) -> bool {
        self.w.formed()
    }

    fn symmetric(&self) -> bool {
        false
    }
}

/// A W that was given as a full matrix.
///
/// # Errors
/// Those of [`check_rows`].
pub(crate) fn dense(w: &SquareMatrix) -> Result<Full, MethodError> {
    let m = w.size();
    check_rows(m)?;
    let mut full = Full::zeros(m, m);
    for j in 0..m {
        for (i, value) in w.column(j) {
            full[(i, j)] = value;
            if w.is_symmetric() {
                full[(j, i)] = value;
            }
        }
    }
    Ok(full)
}

/// Refuses more rows than there is memory left for a full W with a tangent of its size.
///
/// # Errors
/// [`MethodError::TooManyRows`].
pub fn check_rows(rows: usize) -> Result<(), MethodError> {
    let (needed_gb, free_gb) = (16e-9 * (rows as f64).powi(2), memory::free_gb());
    if needed_gb > free_gb {
        return Err(MethodError::TooManyRows {
            rows,
            needed_gb,
            free_gb,
        });
    }
    Ok(())
}
