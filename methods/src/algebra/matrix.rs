//! The two sparse matrices of the problem: the stiffness K and the jump operator B.

use crate::error::{MethodError, check_finite, check_len};

/// Symmetric sparse matrix, lower triangle, compressed columns with sorted rows and every diagonal entry present.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetricMatrix {
    n: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// Takes the arrays of the lower triangle.
    ///
    /// # Errors
    /// Wrong lengths, rows unsorted or outside the lower triangle, a missing diagonal entry, non-finite values.
    pub fn new(
        n: usize,
        col_ptr: Vec<usize>,
        row_idx: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<Self, MethodError> {
        check_pointers("stiffness column pointers", &col_ptr, n, row_idx.len())?;
        check_len("stiffness values", values.len(), row_idx.len())?;
        check_finite("stiffness values", &values)?;
        let bad = |index, reason| Err(MethodError::pattern("stiffness", index, reason));
        for j in 0..n {
            let rows = &row_idx[col_ptr[j]..col_ptr[j + 1]];
            if rows.first() != Some(&j) {
                return bad(j, "the first row of a column must be its diagonal entry");
            }
            if rows.windows(2).any(|w| w[0] >= w[1]) {
                return bad(j, "the rows of a column must increase");
            }
            if rows.last().is_some_and(|&i| i >= n) {
                return bad(j, "a row index exceeds the size");
            }
        }
        Ok(Self {
            n,
            col_ptr,
            row_idx,
            values,
        })
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// Start of each column in [`row_idx`](Self::row_idx); `size() + 1` entries.
    pub fn col_ptr(&self) -> &[usize] {
        &self.col_ptr
    }

    /// Row of each stored entry.
    pub fn row_idx(&self) -> &[usize] {
        &self.row_idx
    }

    /// Value of each stored entry.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Diagonal entry of column `j`.
    pub fn diagonal(&self, j: usize) -> f64 {
        self.values[self.col_ptr[j]]
    }

    /// y = A x.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.n {
            let (begin, end) = (self.col_ptr[j], self.col_ptr[j + 1]);
            let mut sum = self.values[begin] * x[j];
            for k in begin + 1..end {
                let i = self.row_idx[k];
                y[i] += self.values[k] * x[j];
                sum += self.values[k] * x[i];
            }
            y[j] += sum;
        }
    }

    /// |A| |x| with absolute values throughout: what rounding of A x is relative to.
    pub fn mul_abs(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.n {
            let (begin, end) = (self.col_ptr[j], self.col_ptr[j + 1]);
            let mut sum = (self.values[begin] * x[j]).abs();
            for k in begin + 1..end {
                let i = self.row_idx[k];
                let value = self.values[k].abs();
                y[i] += value * x[j].abs();
                sum += value * x[i].abs();
            }
            y[j] += sum;
        }
    }
}

/// The jump operator B in compressed rows: `[[u]] = B u`, rows point by point, each `(n, a[, b])`.
#[derive(Debug, Clone, PartialEq)]
pub struct JumpOperator {
    rows: usize,
    cols: usize,
    row_ptr: Vec<usize>,
    col_idx: Vec<usize>,
    values: Vec<f64>,
}

impl JumpOperator {
    /// Takes the arrays of the compressed rows; columns within a row need no order.
    ///
    /// # Errors
    /// Wrong lengths, columns outside the matrix, non-finite values.
    pub fn new(
        rows: usize,
        cols: usize,
        row_ptr: Vec<usize>,
        col_idx: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<Self, MethodError> {
        check_pointers("jump operator row pointers", &row_ptr, rows, col_idx.len())?;
        check_len("jump operator values", values.len(), col_idx.len())?;
        check_finite("jump operator values", &values)?;
        if let Some(index) = col_idx.iter().position(|&j| j >= cols) {
            return Err(MethodError::pattern(
                "jump operator",
                index,
                "a column index exceeds the number of unknowns",
            ));
        }
        Ok(Self {
            rows,
            cols,
            row_ptr,
            col_idx,
            values,
        })
    }

    /// The operator of unknowns that are the jumps themselves.
    pub(crate) fn identity(n: usize) -> Self {
        Self {
            rows: n,
            cols: n,
            row_ptr: (0..=n).collect(),
            col_idx: (0..n).collect(),
            values: vec![1.0; n],
        }
    }

    /// Number of rows, `dim` per contact point.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of unknowns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Entries of row `i`: (column, value).
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.row_ptr[i]..self.row_ptr[i + 1];
        self.col_idx[range.clone()]
            .iter()
            .copied()
            .zip(self.values[range].iter().copied())
    }

    /// out = B u.
    pub fn mul(&self, u: &[f64], out: &mut [f64]) {
        for i in 0..self.rows {
            out[i] = self.row(i).map(|(j, b)| b * u[j]).sum();
        }
    }

    /// f += Bᵀ p.
    pub fn mul_transpose_add(&self, p: &[f64], f: &mut [f64]) {
        for i in 0..self.rows {
            if p[i] != 0.0 {
                for (j, b) in self.row(i) {
                    f[j] += b * p[i];
                }
            }
        }
    }
}

/// Checks the pointer array of a compressed format.
pub(crate) fn check_pointers(
    what: &'static str,
    ptr: &[usize],
    n: usize,
    entries: usize,
) -> Result<(), MethodError> {
    check_len(what, ptr.len(), n + 1)?;
    let bad = |index, reason| Err(MethodError::pattern(what, index, reason));
    if ptr[0] != 0 {
        return bad(0, "must start at 0");
    }
    if let Some(index) = ptr.windows(2).position(|w| w[0] > w[1]) {
        return bad(index, "must not decrease");
    }
    if ptr[n] != entries {
        return bad(n, "must end at the number of entries");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn malformed_matrices_are_refused() {
        let k = |col_ptr: &[usize], row_idx: &[usize], values: &[f64]| {
            SymmetricMatrix::new(2, col_ptr.to_vec(), row_idx.to_vec(), values.to_vec())
        };
        assert!(k(&[0, 2, 3], &[0, 1, 1], &[2.0, -1.0, 2.0]).is_ok());
        assert!(
            k(&[0, 1, 2], &[1, 1], &[2.0, 2.0]).is_err(),
            "missing diagonal"
        );
        assert!(
            k(&[0, 2, 3], &[0, 2, 1], &[2.0, -1.0, 2.0]).is_err(),
            "row out of range"
        );
        assert!(k(&[0, 2], &[0, 1], &[2.0, -1.0]).is_err(), "short pointers");
        assert!(
            k(&[0, 2, 3], &[0, 1, 1], &[2.0, f64::NAN, 2.0]).is_err(),
            "NaN"
        );
        assert!(
            JumpOperator::new(1, 2, vec![0, 1], vec![2], vec![1.0]).is_err(),
            "column out of range"
        );
    }

    #[test]
    fn products_use_both_triangles() {
        let k =
            SymmetricMatrix::new(2, vec![0, 2, 3], vec![0, 1, 1], vec![2.0, -1.0, 3.0]).unwrap();
        let mut y = [0.0; 2];
        k.mul(&[1.0, 10.0], &mut y);
        assert_eq!(y, [-8.0, 29.0]);
    }
}
