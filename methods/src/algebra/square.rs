//! Square matrices that need not be symmetric, and Delassus operators as a file or another program gives them.

use faer::Mat;

use crate::algebra::delassus::check_rows;
use crate::algebra::matrix::{SymmetricMatrix, check_pointers};
use crate::error::{MethodError, check_finite, check_len};

/// Square sparse matrix, compressed columns with sorted rows. What is not stored is 0.
#[derive(Debug, Clone, PartialEq)]
pub struct SquareMatrix {
    n: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
    values: Vec<f64>,
}

impl SquareMatrix {
    /// Takes the arrays of the compressed columns.
    ///
    /// # Errors
    /// Wrong lengths, rows unsorted or outside the matrix, non-finite values.
    pub fn new(
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
        })
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// Stored entries of a column: (row, value).
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = self.col_ptr[j]..self.col_ptr[j + 1];
        let rows = self.row_idx[own.clone()].iter().copied();
        rows.zip(self.values[own].iter().copied())
    }

    /// Entry (i, j); 0 where nothing is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let own = self.col_ptr[j]..self.col_ptr[j + 1];
        match self.row_idx[own.clone()].binary_search(&i) {
            Ok(place) => self.values[own.start + place],
            Err(_) => 0.0,
        }
    }

    /// y = A x.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (j, &xj) in x.iter().enumerate() {
            self.column(j).for_each(|(i, a)| y[i] += a * xj);
        }
    }

    /// |A| |x| with absolute values throughout: what rounding of A x is relative to.
    fn mul_abs(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (j, &xj) in x.iter().enumerate() {
            self.column(j).for_each(|(i, a)| y[i] += (a * xj).abs());
        }
    }

    /// How far it is from its transpose: max |a_ij − a_ji| / max |a_ij|; 0 for a symmetric matrix.
    pub fn asymmetry(&self) -> f64 {
        let largest = self.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let beside = |j| self.column(j).map(move |(i, a)| (a - self.get(j, i)).abs());
        match (0..self.n).flat_map(beside).fold(0.0, f64::max) {
            0.0 => 0.0,
            most => most / largest,
        }
    }
}

/// W as it is given: `dim` rows per contact point, in m/N (2D: m²/N).
#[derive(Debug, Clone, PartialEq)]
pub enum DelassusMatrix {
    /// W = Wᵀ.
    Symmetric(SymmetricMatrix),
    /// Not symmetric, as where a time step linearises gyroscopic forces, or a writer has rounded.
    General(SquareMatrix),
}

impl From<SymmetricMatrix> for DelassusMatrix {
    fn from(w: SymmetricMatrix) -> Self {
        Self::Symmetric(w)
    }
}

impl From<SquareMatrix> for DelassusMatrix {
    fn from(w: SquareMatrix) -> Self {
        Self::General(w)
    }
}

impl DelassusMatrix {
    /// Number of rows.
    pub fn size(&self) -> usize {
        match self {
            Self::Symmetric(w) => w.size(),
            Self::General(w) => w.size(),
        }
    }

    pub(crate) fn diagonal(&self, j: usize) -> f64 {
        match self {
            Self::Symmetric(w) => w.diagonal(j),
            Self::General(w) => w.get(j, j),
        }
    }

    /// Stored entries of a column, of a symmetric matrix from the diagonal on: (row, value).
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (pointers, rows, values) = match self {
            Self::Symmetric(w) => (w.col_ptr(), w.row_idx(), w.values()),
            Self::General(w) => (&w.col_ptr[..], &w.row_idx[..], &w.values[..]),
        };
        let own = pointers[j]..pointers[j + 1];
        rows[own.clone()]
            .iter()
            .copied()
            .zip(values[own].iter().copied())
    }

    /// y = W x.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        match self {
            Self::Symmetric(w) => w.mul(x, y),
            Self::General(w) => w.mul(x, y),
        }
    }

    pub(crate) fn mul_abs(&self, x: &[f64], y: &mut [f64]) {
        match self {
            Self::Symmetric(w) => w.mul_abs(x, y),
            Self::General(w) => w.mul_abs(x, y),
        }
    }

    /// [`SquareMatrix::asymmetry`].
    pub(crate) fn asymmetry(&self) -> f64 {
        match self {
            Self::Symmetric(_) => 0.0,
            Self::General(w) => w.asymmetry(),
        }
    }

    /// The full matrix.
    pub(crate) fn dense(&self) -> Result<Mat<f64>, MethodError> {
        let m = self.size();
        check_rows(m)?;
        let mut full = Mat::<f64>::zeros(m, m);
        let symmetric = matches!(self, Self::Symmetric(_));
        for j in 0..m {
            for (i, value) in self.column(j) {
                full[(i, j)] = value;
                if symmetric {
                    full[(j, i)] = value;
                }
            }
        }
        Ok(full)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [[4, 1, 0], [2, 5, 0], [0, 0, 0]].
    fn unsymmetric() -> SquareMatrix {
        let (rows, values) = (vec![0, 1, 0, 1], vec![4.0, 2.0, 1.0, 5.0]);
        SquareMatrix::new(3, vec![0, 2, 4, 4], rows, values).unwrap()
    }

    #[test]
    fn products_and_asymmetry_know_rows_from_columns() {
        let a = unsymmetric();
        let mut y = [0.0; 3];
        a.mul(&[1.0, -1.0, 7.0], &mut y);
        assert_eq!(y, [3.0, -3.0, 0.0]);
        a.mul_abs(&[1.0, -1.0, 7.0], &mut y);
        assert_eq!(y, [5.0, 7.0, 0.0]);
        assert_eq!(a.asymmetry(), 0.2);
        let full = DelassusMatrix::from(a).dense().unwrap();
        assert_eq!((full[(0, 1)], full[(1, 0)], full[(2, 2)]), (1.0, 2.0, 0.0));
    }

    /// An entry without mirror image counts, on whichever side of the diagonal it stands.
    #[test]
    fn an_entry_alone_is_compared_with_zero() {
        for (column, row) in [(0, 1), (1, 0)] {
            let ends = if column == 0 { [0, 1, 1] } else { [0, 0, 1] };
            let a = SquareMatrix::new(2, ends.to_vec(), vec![row], vec![-3.0]).unwrap();
            assert_eq!(a.asymmetry(), 1.0);
        }
        let none = SquareMatrix::new(2, vec![0; 3], vec![], vec![]).unwrap();
        assert_eq!(none.asymmetry(), 0.0);
    }

    #[test]
    fn malformed_matrices_are_refused() {
        let a = |ends: &[usize], rows: &[usize], values: &[f64]| {
            SquareMatrix::new(2, ends.to_vec(), rows.to_vec(), values.to_vec()).is_err()
        };
        assert!(a(&[0, 2, 2], &[1, 0], &[1.0, 1.0]), "rows fall");
        assert!(a(&[0, 1, 1], &[2], &[1.0]), "row out of range");
        assert!(a(&[0, 1, 1], &[0], &[f64::NAN]), "NaN");
    }
}
