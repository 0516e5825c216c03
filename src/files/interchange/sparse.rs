//! A sparse matrix between file and solver.

use stickslip_methods::{JumpOperator, MethodError, SquareMatrix};

/// Sparse matrix in compressed columns, rows sorted within a column, no position stored twice.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseMatrix {
    rows: usize,
    cols: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
    values: Vec<f64>,
}

impl SparseMatrix {
    /// Sorts triplets (row, column, value); values at one position are added in the order given.
    ///
    /// `None` if a position lies outside the matrix.
    pub fn from_triplets(
        rows: usize,
        cols: usize,
        triplets: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Option<Self> {
        let triplets: Vec<(usize, usize, f64)> = triplets.into_iter().collect();
        let inside = triplets.iter().all(|&(i, j, _)| i < rows && j < cols);
        inside.then(|| Self::sorted(rows, cols, triplets))
    }

    /// The same for positions known to lie inside.
    fn sorted(rows: usize, cols: usize, triplets: Vec<(usize, usize, f64)>) -> Self {
        let sorted = counted(cols, counted(rows, triplets, |t| t.0), |t| t.1);
        let mut matrix = Self {
            rows,
            cols,
            col_ptr: vec![0; cols + 1],
            row_idx: Vec::with_capacity(sorted.len()),
            values: Vec::with_capacity(sorted.len()),
        };
        let mut last = None;
        for (i, j, value) in sorted {
            if last == Some((i, j)) {
                if let Some(sum) = matrix.values.last_mut() {
                    *sum += value;
                }
                continue;
            }
            last = Some((i, j));
            matrix.row_idx.push(i);
            matrix.values.push(value);
            matrix.col_ptr[j + 1] = matrix.values.len();
        }
        for j in 0..cols {
            matrix.col_ptr[j + 1] = matrix.col_ptr[j + 1].max(matrix.col_ptr[j]);
        }
        matrix
    }

    /// All of a matrix, of a symmetric one both triangles.
    pub fn from_square(a: &SquareMatrix) -> Self {
        let mut triplets = Vec::with_capacity(2 * a.values().len());
        for j in 0..a.size() {
            for (i, value) in a.column(j) {
                triplets.push((i, j, value));
                if a.is_symmetric() && i != j {
                    triplets.push((j, i, value));
                }
            }
        }
        Self::sorted(a.size(), a.size(), triplets)
    }

    /// The jump operator B.
    pub fn from_rows(b: &JumpOperator) -> Self {
        let row = |i| b.row(i).map(move |(j, value)| (i, j, value));
        Self::sorted(b.rows(), b.cols(), (0..b.rows()).flat_map(row).collect())
    }

    /// Dense columns of equal length.
    pub fn from_dense_columns(rows: usize, columns: &[Vec<f64>]) -> Self {
        Self::from_dense(rows, columns.len(), |i, j| columns[j][i])
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
        Self::sorted(self.rows, self.cols, self.entries().chain(beside).collect())
    }

    /// The transpose.
    pub fn transposed(&self) -> Self {
        let mirrored = self.entries().map(|(i, j, value)| (j, i, value));
        Self::sorted(self.cols, self.rows, mirrored.collect())
    }

    /// The lower triangle of (A + Aᵀ)/2, every diagonal entry stored.
    ///
    /// # Errors
    /// A matrix that is not square.
    pub fn symmetric_part(&self) -> Result<SquareMatrix, MethodError> {
        let lower = self
            .entries()
            .map(|(i, j, value)| (i.max(j), i.min(j), 0.5 * value));
        let mut triplets: Vec<_> = lower.collect();
        triplets.extend((0..self.cols).map(|j| (j, j, 0.0)));
        // Halves of an exactly symmetric matrix add up to its entries again, but a diagonal entry comes once.
        let diagonal = self.entries().filter(|e| e.0 == e.1);
        triplets.extend(diagonal.map(|(i, j, value)| (i, j, 0.5 * value)));
        let lower = Self::sorted(self.rows, self.cols, triplets);
        SquareMatrix::symmetric(self.cols, lower.col_ptr, lower.row_idx, lower.values)
    }

    /// The matrix as it stands, where it is square.
    ///
    /// # Errors
    /// A matrix that is not square, non-finite values.
    pub fn as_square(&self) -> Result<SquareMatrix, MethodError> {
        let (ends, rows) = (self.col_ptr.clone(), self.row_idx.clone());
        SquareMatrix::general(self.rows, ends, rows, self.values.clone())
    }

    /// The matrix as jump operator.
    ///
    /// # Errors
    /// Non-finite values.
    pub fn as_rows(&self) -> Result<JumpOperator, MethodError> {
        let Self {
            col_ptr,
            row_idx,
            values,
            ..
        } = self.transposed();
        JumpOperator::new(self.rows, self.cols, col_ptr, row_idx, values)
    }

    /// Column `j`, dense.
    pub fn column(&self, j: usize) -> Vec<f64> {
        let mut column = vec![0.0; self.rows];
        for k in self.col_ptr[j]..self.col_ptr[j + 1] {
            column[self.row_idx[k]] = self.values[k];
        }
        column
    }

    /// All entries of a dense matrix that are not zero, and its diagonal.
    pub fn from_dense(rows: usize, cols: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let mut matrix = Self {
            rows,
            cols,
            col_ptr: vec![0],
            row_idx: Vec::new(),
            values: Vec::new(),
        };
        for j in 0..cols {
            for i in 0..rows {
                let value = entry(i, j);
                if value != 0.0 || i == j {
                    matrix.row_idx.push(i);
                    matrix.values.push(value);
                }
            }
            matrix.col_ptr.push(matrix.values.len());
        }
        matrix
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True if nothing is stored.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Stored entries (row, column, value), column by column, rows increasing.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.cols).flat_map(move |j| {
            (self.col_ptr[j]..self.col_ptr[j + 1])
                .map(move |k| (self.row_idx[k], j, self.values[k]))
        })
    }

    /// Entry (i, j); 0 where nothing is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let column = self.col_ptr[j]..self.col_ptr[j + 1];
        match self.row_idx[column.clone()].binary_search(&i) {
            Ok(position) => self.values[column.start + position],
            Err(_) => 0.0,
        }
    }
}

/// Triplets in the order of one of their indices, and of several with the same in the order given, so that sums have one
/// order. Counting takes time with their number; the full W of a large body has 10⁷ and more.
fn counted(
    size: usize,
    triplets: Vec<(usize, usize, f64)>,
    index: fn(&(usize, usize, f64)) -> usize,
) -> Vec<(usize, usize, f64)> {
    let mut next = vec![0; size + 1];
    triplets.iter().for_each(|t| next[index(t) + 1] += 1);
    for k in 0..size {
        next[k + 1] += next[k];
    }
    let mut sorted = vec![(0, 0, 0.0); triplets.len()];
    for triplet in triplets {
        let place = &mut next[index(&triplet)];
        sorted[*place] = triplet;
        *place += 1;
    }
    sorted
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
