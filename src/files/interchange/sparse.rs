//! A sparse matrix between file and solver.

use faer::sparse::{SparseColMat, Triplet};
use stickslip_methods::{JumpOperator, MethodError, SquareMatrix};

/// Sparse matrix in compressed columns, rows sorted within a column, no position stored twice; zeros may be stored.
#[derive(Debug, Clone)]
pub struct SparseMatrix(SparseColMat<usize, f64>);

impl PartialEq for SparseMatrix {
    /// Of one size, with the same entries stored.
    fn eq(&self, other: &Self) -> bool {
        let sizes = |m: &Self| (m.rows(), m.cols());
        sizes(self) == sizes(other) && self.entries().eq(other.entries())
    }
}

impl SparseMatrix {
    /// Takes triplets (row, column, value) in any order; values at one position are added.
    ///
    /// `None` if a position lies outside the matrix.
    pub fn from_triplets(
        rows: usize,
        cols: usize,
        triplets: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Option<Self> {
        let triplets = triplets.into_iter();
        let triplets: Vec<_> = triplets.map(|(i, j, v)| Triplet::new(i, j, v)).collect();
        let inside = triplets.iter().all(|t| t.row < rows && t.col < cols);
        let matrix = || SparseColMat::try_new_from_triplets(rows, cols, &triplets).ok();
        inside.then(matrix).flatten().map(Self)
    }

    /// The same for positions known to lie inside.
    fn of(
        rows: usize,
        cols: usize,
        triplets: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Self {
        Self::from_triplets(rows, cols, triplets).unwrap_or_else(|| unreachable!("outside"))
    }

    /// All of a matrix, of a symmetric one both triangles.
    pub fn from_square(a: &SquareMatrix) -> Self {
        let n = a.size();
        let column = |j| a.column(j).map(move |(i, value)| (i, j, value));
        let stored = Self::of(n, n, (0..n).flat_map(column));
        if a.is_symmetric() {
            stored.mirrored()
        } else {
            stored
        }
    }

    /// The jump operator B.
    pub fn from_rows(b: &JumpOperator) -> Self {
        let row = |i| b.row(i).map(move |(j, value)| (i, j, value));
        Self::of(b.rows(), b.cols(), (0..b.rows()).flat_map(row))
    }

    /// Dense columns of equal length.
    pub fn from_dense_columns(rows: usize, columns: &[Vec<f64>]) -> Self {
        Self::from_dense(rows, columns.len(), |i, j| columns[j][i])
    }

    /// All entries of a dense matrix that are not zero, and its diagonal.
    pub fn from_dense(rows: usize, cols: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let places = (0..cols).flat_map(|j| (0..rows).map(move |i| (i, j)));
        let entries = places.map(|(i, j)| (i, j, entry(i, j)));
        Self::of(rows, cols, entries.filter(|&(i, j, v)| v != 0.0 || i == j))
    }

    /// Whether it has entries above and below its diagonal.
    pub fn sides(&self) -> [bool; 2] {
        [usize::lt, usize::gt].map(|is: fn(&usize, &usize) -> bool| {
            self.entries()
                .any(|(i, j, value)| value != 0.0 && is(&i, &j))
        })
    }

    /// The symmetric matrix of which it is one triangle.
    pub fn mirrored(&self) -> Self {
        let beside = self.entries().filter(|(i, j, _)| i != j);
        let beside = beside.map(|(i, j, value)| (j, i, value));
        Self::of(self.rows(), self.cols(), self.entries().chain(beside))
    }

    /// The transpose.
    pub fn transposed(&self) -> Self {
        let mirrored = self.entries().map(|(i, j, value)| (j, i, value));
        Self::of(self.cols(), self.rows(), mirrored)
    }

    /// The lower triangle of (A + Aᵀ)/2, every diagonal entry stored.
    ///
    /// # Errors
    /// A matrix that is not square.
    pub fn symmetric_part(&self) -> Result<SquareMatrix, MethodError> {
        let (n, least) = (self.rows().max(self.cols()), self.rows().min(self.cols()));
        // Halves of an exactly symmetric matrix add up to its entries again; a diagonal entry comes once, and whole.
        let entries = self.entries().map(|(i, j, value)| {
            if i == j {
                (i, j, value)
            } else {
                (i.max(j), i.min(j), 0.5 * value)
            }
        });
        let lower = Self::of(n, n, entries.chain((0..n).map(|j| (j, j, 0.0))));
        let (ends, rows, values) = lower.parts();
        // Of a matrix that is not square there are more columns than it is told.
        SquareMatrix::symmetric(least, ends, rows, values)
    }

    /// The matrix as it stands, where it is square.
    ///
    /// # Errors
    /// A matrix that is not square, non-finite values.
    pub fn as_square(&self) -> Result<SquareMatrix, MethodError> {
        let (ends, rows, values) = self.parts();
        SquareMatrix::general(self.rows(), ends, rows, values)
    }

    /// The matrix as jump operator.
    ///
    /// # Errors
    /// Non-finite values.
    pub fn as_rows(&self) -> Result<JumpOperator, MethodError> {
        let (ends, cols, values) = self.transposed().parts();
        JumpOperator::new(self.rows(), self.cols(), ends, cols, values)
    }

    /// Ends of the columns, rows and values.
    fn parts(&self) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (ends, rows) = (self.0.col_ptr(), self.0.row_idx());
        (ends.to_vec(), rows.to_vec(), self.0.val().to_vec())
    }

    /// Column `j`, dense.
    pub fn column(&self, j: usize) -> Vec<f64> {
        let mut column = vec![0.0; self.rows()];
        let stored = self.0.row_idx_of_col(j).zip(self.0.val_of_col(j));
        stored.for_each(|(i, value)| column[i] = *value);
        column
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.0.nrows()
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.0.ncols()
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.0.val().len()
    }

    /// True if nothing is stored.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Stored entries (row, column, value), column by column, rows increasing.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.0.triplet_iter().map(|t| (t.row, t.col, *t.val))
    }

    /// Entry (i, j); 0 where nothing is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.0.get(i, j).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triplets_are_sorted_and_added() {
        let a = SparseMatrix::from_triplets(2, 3, [(1, 2, 1.0), (0, 0, 2.0), (1, 2, 0.5)]).unwrap();
        let entries: Vec<_> = a.entries().collect();
        assert_eq!(entries, [(0, 0, 2.0), (1, 2, 1.5)]);
        assert_eq!((a.get(1, 2), a.get(1, 1), a.len()), (1.5, 0.0, 2));
        assert_eq!(SparseMatrix::from_triplets(2, 3, [(2, 0, 1.0)]), None);
        assert_eq!(SparseMatrix::from_triplets(2, 3, [(0, 3, 1.0)]), None);
    }

    #[test]
    fn matrices_of_the_methods_come_back() {
        let entries = [(0, 0, 4.0), (0, 1, 0.3), (1, 0, 0.3), (1, 1, 5.0)];
        let a = SparseMatrix::from_triplets(2, 2, entries).unwrap();
        let lower = a.symmetric_part().unwrap();
        assert_eq!(lower.values(), [4.0, 0.3, 5.0]);
        assert_eq!(SparseMatrix::from_square(&lower), a);
        let skew = SparseMatrix::from_triplets(2, 2, [(0, 1, 1.0), (1, 0, 2.0)]).unwrap();
        assert_eq!(skew.symmetric_part().unwrap().values(), [0.0, 1.5, 0.0]);
        assert_eq!(SparseMatrix::from_square(&skew.as_square().unwrap()), skew);
        let b = SparseMatrix::from_triplets(2, 3, [(1, 0, 2.0), (0, 2, -1.0)]).unwrap();
        assert_eq!(SparseMatrix::from_rows(&b.as_rows().unwrap()), b);
        assert_eq!(b.transposed().get(2, 0), -1.0);
        assert_eq!(b.column(0), [0.0, 2.0]);
    }

    #[test]
    fn dense_matrices_keep_their_diagonal() {
        let a = SparseMatrix::from_dense(2, 2, |i, j| if i < j { 3.0 } else { 0.0 });
        let entries: Vec<_> = a.entries().collect();
        assert_eq!(entries, [(0, 0, 0.0), (0, 1, 3.0), (1, 1, 0.0)]);
    }
}
