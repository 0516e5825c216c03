//! The sparse matrices of the problem: the stiffness K or a Delassus operator W that is given, and the jump operator B.

use crate::error::{MethodError, check_finite, check_len};

/// Square sparse matrix, compressed columns with sorted rows: of a symmetric one the lower triangle with every diagonal entry, of
/// another all that is not 0.
#[derive(Debug, Clone, PartialEq)]
pub struct SquareMatrix {
    n: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
    values: Vec<f64>,
    symmetric: bool,
}

impl SquareMatrix {
    /// Takes the arrays of a matrix that need not be symmetric, as where a time step linearises gyroscopic forces, or a writer has
    /// rounded.
    ///
    /// # Errors
    /// Wrong lengths, rows unsorted or outside the matrix, non-finite values.
    pub fn general(
        n: usize,
        col_ptr: Vec<usize>,
        row_idx: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<Self, MethodError> {
        let what = "square matrix";
        check_pointers("square matrix column pointers", &col_ptr, n, row_idx.len())?;
        check_len("square matrix values", values.len(), row_idx.len())?;
        check_finite("square matrix values", &values)?;
        for j in 0..n {
            let rows = &row_idx[col_ptr[j]..col_ptr[j + 1]];
            if rows.windows(2).any(|w| w[0] >= w[1]) {
                let reason = "the rows of a column must increase";
                return Err(MethodError::pattern(what, j, reason));
            }
            if rows.last().is_some_and(|&i| i >= n) {
                let reason = "a row index exceeds the size";
                return Err(MethodError::pattern(what, j, reason));
            }
        }
        Ok(Self {
            n,
            col_ptr,
            row_idx,
            values,
            symmetric: false,
        })
    }

    /// Takes the arrays of the lower triangle of a symmetric matrix.
    ///
    /// # Errors
    /// Those of [`general`](Self::general), entries above the diagonal, a missing diagonal entry.
    pub fn symmetric(
        n: usize,
        col_ptr: Vec<usize>,
        row_idx: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<Self, MethodError> {
        let mut lower = Self::general(n, col_ptr, row_idx, values)?;
        let begins = |&j: &usize| lower.column(j).next().is_none_or(|(i, _)| i != j);
        if let Some(j) = (0..n).find(begins) {
            let reason = "the first row of a column must be its diagonal entry";
            return Err(MethodError::pattern("symmetric matrix", j, reason));
        }
        lower.symmetric = true;
        Ok(lower)
    }

    /// Whether it is held as a symmetric one.
    pub fn is_symmetric(&self) -> bool {
        self.symmetric
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

    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Diagonal entry of column `j`.
    pub fn diagonal(&self, j: usize) -> f64 {
        if self.symmetric {
            self.values[self.col_ptr[j]]
        } else {
            self.stored(j, j)
        }
    }

    /// Stored entries of a column, of a symmetric matrix from the diagonal on: (row, value).
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = self.col_ptr[j]..self.col_ptr[j + 1];
        let rows = self.row_idx[own.clone()].iter().copied();
        rows.zip(self.values[own].iter().copied())
    }

    /// The same matrix with both triangles held.
    ///
    /// # Errors
    /// None that a matrix that exists could cause.
    pub(crate) fn whole(&self) -> Result<Self, MethodError> {
        if !self.symmetric {
            return Ok(self.clone());
        }
        let mut columns = vec![Vec::new(); self.n];
        // Columns in their order: what is mirrored from earlier ones stands before what a column holds itself.
        for j in 0..self.n {
            for (i, value) in self.column(j) {
                columns[j].push((i, value));
                if i != j {
                    columns[i].push((j, value));
                }
            }
        }
        let ends = columns.iter().scan(0, |end, column| {
            *end += column.len();
            Some(*end)
        });
        let ends = std::iter::once(0).chain(ends).collect();
        let (rows, values) = columns.into_iter().flatten().unzip();
        Self::general(self.n, ends, rows, values)
    }

    /// The lower triangle of one that holds both, as a symmetric matrix.
    ///
    /// # Errors
    /// A missing diagonal entry.
    pub(crate) fn lower(&self) -> Result<Self, MethodError> {
        let (mut ends, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..self.n {
            for (i, value) in self.column(j).filter(|(i, _)| *i >= j) {
                rows.push(i);
                values.push(value);
            }
            ends.push(values.len());
        }
        Self::symmetric(self.n, ends, rows, values)
    }

    /// The rows and columns of some unknowns, in their order, of a symmetric matrix.
    ///
    /// # Errors
    /// None that a matrix that exists could cause.
    pub(crate) fn part(&self, own: &[usize]) -> Result<Self, MethodError> {
        let mut number = vec![None; self.n];
        (own.iter().enumerate()).for_each(|(k, &i)| number[i] = Some(k));
        let (mut ends, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for &j in own {
            for (i, value) in self.column(j) {
                if let Some(k) = number[i] {
                    rows.push(k);
                    values.push(value);
                }
            }
            ends.push(values.len());
        }
        Self::symmetric(own.len(), ends, rows, values)
    }

    /// The entry stored at (i, j); 0 where there is none.
    fn stored(&self, i: usize, j: usize) -> f64 {
        let own = self.col_ptr[j]..self.col_ptr[j + 1];
        match self.row_idx[own.clone()].binary_search(&i) {
            Ok(place) => self.values[own.start + place],
            Err(_) => 0.0,
        }
    }

    /// y = A x.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.product(x, y, |a, x| a * x);
    }

    /// |A| |x| with absolute values throughout: what rounding of A x is relative to.
    pub fn mul_abs(&self, x: &[f64], y: &mut [f64]) {
        self.product(x, y, |a, x| (a * x).abs());
    }

    #[inline(always)]
    fn product(&self, x: &[f64], y: &mut [f64], times: impl Fn(f64, f64) -> f64) {
        y.fill(0.0);
        for (j, &xj) in x.iter().enumerate() {
            let (mut begin, end) = (self.col_ptr[j], self.col_ptr[j + 1]);
            let mut sum = 0.0;
            if self.symmetric {
                sum = times(self.values[begin], xj);
                begin += 1;
            }
            for (&i, &a) in self.row_idx[begin..end]
                .iter()
                .zip(&self.values[begin..end])
            {
                y[i] += times(a, xj);
                if self.symmetric {
                    sum += times(a, x[i]);
                }
            }
            if self.symmetric {
                y[j] += sum;
            }
        }
    }

    /// max |a_ij|.
    pub(crate) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
    }

    /// How far it is from its transpose: max |a_ij − a_ji| / max |a_ij|; 0 for a symmetric matrix.
    pub fn asymmetry(&self) -> f64 {
        if self.symmetric {
            return 0.0;
        }
        let beside = |j| {
            self.column(j)
                .map(move |(i, a)| (a - self.stored(j, i)).abs())
        };
        match (0..self.n).flat_map(beside).fold(0.0, f64::max) {
            0.0 => 0.0,
            most => most / self.largest(),
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

    /// The same without entries of 0.
    pub(crate) fn touched(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.row(i).filter(|e| e.1 != 0.0)
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

    type New = fn(usize, Vec<usize>, Vec<usize>, Vec<f64>) -> Result<SquareMatrix, MethodError>;

    /// [[4, 1, 0], [2, 5, 0], [0, 0, 0]].
    fn unsymmetric() -> SquareMatrix {
        let (rows, values) = (vec![0, 1, 0, 1], vec![4.0, 2.0, 1.0, 5.0]);
        SquareMatrix::general(3, vec![0, 2, 4, 4], rows, values).unwrap()
    }

    #[test]
    fn products_know_rows_from_columns_and_use_both_triangles() {
        let a = unsymmetric();
        let mut y = [0.0; 3];
        a.mul(&[1.0, -1.0, 7.0], &mut y);
        assert_eq!(y, [3.0, -3.0, 0.0]);
        a.mul_abs(&[1.0, -1.0, 7.0], &mut y);
        assert_eq!(y, [5.0, 7.0, 0.0]);
        assert_eq!(a.asymmetry(), 0.2);
        let (ends, rows, values) = (vec![0, 2, 3], vec![0, 1, 1], vec![2.0, -1.0, 3.0]);
        let k = SquareMatrix::symmetric(2, ends, rows, values).unwrap();
        let mut y = [0.0; 2];
        k.mul(&[1.0, 10.0], &mut y);
        assert_eq!(y, [-8.0, 29.0]);
    }

    /// An entry without mirror image counts, on whichever side of the diagonal it stands.
    #[test]
    fn an_entry_alone_is_compared_with_zero() {
        for (ends, row) in [([0, 1, 1], 1), ([0, 0, 1], 0)] {
            let a = SquareMatrix::general(2, ends.to_vec(), vec![row], vec![-3.0]).unwrap();
            assert_eq!(a.asymmetry(), 1.0);
        }
        let none = SquareMatrix::general(2, vec![0; 3], vec![], vec![]).unwrap();
        assert_eq!(none.asymmetry(), 0.0);
    }

    #[test]
    fn malformed_matrices_are_refused() {
        let refused = |new: New, ends: &[usize], rows: &[usize], values: &[f64]| {
            new(2, ends.to_vec(), rows.to_vec(), values.to_vec()).is_err()
        };
        let (lower, full): (New, New) = (SquareMatrix::symmetric, SquareMatrix::general);
        let values = [2.0, -1.0, 2.0];
        assert!(!refused(lower, &[0, 2, 3], &[0, 1, 1], &values));
        assert!(
            refused(lower, &[0, 1, 2], &[1, 1], &values[..2]),
            "no diagonal"
        );
        assert!(
            refused(full, &[0, 2, 3], &[0, 2, 1], &values),
            "row out of range"
        );
        assert!(
            refused(full, &[0, 2, 2], &[1, 0], &values[..2]),
            "rows fall"
        );
        assert!(
            refused(full, &[0, 2], &[0, 1], &values[..2]),
            "short pointers"
        );
        assert!(refused(full, &[0, 1, 1], &[0], &[f64::NAN]), "NaN");
        let out = JumpOperator::new(1, 2, vec![0, 1], vec![2], vec![1.0]);
        assert!(out.is_err(), "column out of range");
    }
}
