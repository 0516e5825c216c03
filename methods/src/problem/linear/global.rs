//! Sparse LU of the whole body with its contact, for the monolithic variants.
//! ```text
//! saddle:    [ K   −Bᵀ ] [δu]   [ 0]        explicit, A = I:   (K + Bᵀ C B) δu = −Bᵀ h
//!            [ C B   A ] [δP] = [−h]                           δP = −h − C B δu
//! ```
//! All contact rows stay in the matrix whatever the points do, so that the pattern is analysed once. Displacements are
//! scaled by K_jj^(−1/2), forces by √ρ.

#![allow(non_snake_case)]

use std::sync::Arc;

use faer::MatMut;
use faer::linalg::solvers::Solve;
use faer::sparse::FaerError;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};

use super::super::b_equations::Row;
use super::super::condensed::Condensed;
use super::factor::{norm, sparse};
use crate::{ContactSystem, MethodError};

/// (δP, δv) or another pair of vectors by row.
pub(crate) type TwoVectors = (Vec<f64>, Vec<f64>);

/// Largest |A x − b|/|b| of a solve that counts: a singular matrix leaves more.
const SOLVED: f64 = 1e-6;

/// One entry of the matrix by where its value comes from.
enum Entry {
    /// A fixed value: K and −Bᵀ.
    Fixed(f64),
    /// Entry (row, column) of A at a point.
    A(usize, usize, usize),
    /// Σ_l C[row][l] b_l at a point, with b the scaled coefficients of the point's rows of B at one unknown.
    CB(usize, usize, [f64; 3]),
    /// Σ_kl b_k C[k][l] b'_l at a point.
    Product(usize, [f64; 3], [f64; 3]),
}

/// The analysed matrix of one system.
pub(crate) struct Global {
    condensed: Arc<Condensed>,
    explicit: bool,
    entries: Vec<Entry>,
    pattern: SymbolicSparseColMat<usize>,
    argsort: Argsort<usize>,
    symbolic: SymbolicLu<usize>,
    /// Scaled rows of B in use, point by point: (unknown, coefficients on the rows of the point).
    b: Vec<Vec<(usize, [f64; 3])>>,
    /// First row and number of rows of each point.
    rows: Vec<(usize, usize)>,
    sigma: f64,
    n: usize,
    m: usize,
}

impl Global {
    /// The saddle-point form, for rows of any kind.
    pub fn saddle(system: &ContactSystem) -> Result<Self, MethodError> {
        Self::new(system, false)
    }

    /// The displacement form, for rows that give δP explicitly (A = I).
    pub fn explicit(system: &ContactSystem) -> Result<Self, MethodError> {
        Self::new(system, true)
    }

    fn new(system: &ContactSystem, explicit: bool) -> Result<Self, MethodError> {
        let condensed = system.condensed()?;
        let (elastic, set) = (system.elastic(), system.row_set());
        let K = elastic.stiffness().ok_or(MethodError::NoStiffness)?;
        let (n, m) = (K.size(), set.len());
        let scale: Vec<f64> = (0..n).map(|j| 1.0 / K.diagonal(j).sqrt()).collect();
        let sigma = condensed.rho.sqrt();
        let (mut at, mut entries) = (Vec::new(), Vec::new());
        let mut push = |row: usize, col: usize, entry: Entry| {
            at.push(Pair { row, col });
            entries.push(entry);
        };
        for j in 0..n {
            for k in K.col_ptr()[j]..K.col_ptr()[j + 1] {
                let (i, value) = (K.row_idx()[k], K.values()[k]);
                let value = value * scale[i] * scale[j];
                push(i, j, Entry::Fixed(value));
                if i != j {
                    push(j, i, Entry::Fixed(value));
                }
            }
        }
        let (mut b, mut rows) = (Vec::new(), Vec::new());
        for point in 0..set.points() {
            let own = set.of(point);
            rows.push((own.start, own.len()));
            let mut columns = std::collections::BTreeMap::<usize, [f64; 3]>::new();
            for (l, k) in own.clone().enumerate() {
                for (j, value) in elastic.jump().row(set.source[k]) {
                    columns.entry(j).or_default()[l] += value * scale[j] * sigma;
                }
            }
            let columns: Vec<(usize, [f64; 3])> = columns.into_iter().collect();
            for &(j, coefficients) in &columns {
                if explicit {
                    for &(i, others) in &columns {
                        push(i, j, Entry::Product(point, others, coefficients));
                    }
                    continue;
                }
                for (l, k) in own.clone().enumerate() {
                    push(j, n + k, Entry::Fixed(-coefficients[l]));
                    push(n + k, j, Entry::CB(point, l, coefficients));
                }
            }
            if !explicit {
                for (l, k) in own.clone().enumerate() {
                    for (c, column) in own.clone().enumerate() {
                        push(n + k, n + column, Entry::A(point, l, c));
                    }
                }
            }
            b.push(columns);
        }
        let size = if explicit { n } else { n + m };
        let (pattern, argsort) = SymbolicSparseColMat::try_new_from_indices(size, size, &at)
            .map_err(|e| sparse("pattern of the monolithic matrix", e))?;
        let symbolic = SymbolicLu::try_new(pattern.as_ref())
            .map_err(|e| sparse("symbolic LU of the monolithic matrix", e))?;
        Ok(Self {
            condensed,
            explicit,
            entries,
            pattern,
            argsort,
            symbolic,
            b,
            rows,
            sigma,
            n,
            m,
        })
    }

    /// Whether the matrix was analysed for this system.
    pub fn belongs_to(&self, system: &ContactSystem) -> bool {
        system
            .condensed()
            .is_ok_and(|c| Arc::ptr_eq(&c, &self.condensed))
    }

    /// (δP, δv) by row; `None` if the matrix is singular.
    pub fn solve(&self, rows: &[[Row; 3]]) -> Result<Option<TwoVectors>, MethodError> {
        let failed = |e: FaerError| sparse("sparse LU of the monolithic matrix", e);
        // In scaled unknowns C becomes C/ρ: B carries √ρ, and so does P.
        let rho = self.sigma * self.sigma;
        let c = |point: usize, k: usize, l: usize| rows[point][k].c[l] / rho;
        let values: Vec<f64> = (self.entries.iter())
            .map(|entry| match entry {
                Entry::Fixed(value) => *value,
                Entry::A(point, k, l) => rows[*point][*k].a[*l],
                Entry::CB(point, k, b) => (0..3).map(|l| c(*point, *k, l) * b[l]).sum(),
                Entry::Product(point, b, d) => (0..3)
                    .map(|k| b[k] * (0..3).map(|l| c(*point, k, l) * d[l]).sum::<f64>())
                    .sum(),
            })
            .collect();
        let matrix = SparseColMat::new_from_argsort(self.pattern.clone(), &self.argsort, &values)
            .map_err(failed)?;
        let size = matrix.ncols();
        let mut rhs = vec![0.0; size];
        for (point, &(start, len)) in self.rows.iter().enumerate() {
            for k in 0..len {
                let h = rows[point][k].h / self.sigma;
                if self.explicit {
                    self.b[point].iter().for_each(|&(j, b)| rhs[j] -= b[k] * h);
                } else {
                    rhs[self.n + start + k] = -h;
                }
            }
        }
        let lu = match Lu::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref()) {
            Ok(lu) => lu,
            Err(LuError::SymbolicSingular { .. }) => return Ok(None),
            Err(LuError::Generic(e)) => return Err(failed(e)),
        };
        let mut x = rhs.clone();
        lu.solve_in_place(MatMut::from_column_major_slice_mut(&mut x, size, 1));
        let mut left = rhs.clone();
        for j in 0..size {
            let (rows, values) = (matrix.row_idx_of_col_raw(j), matrix.val_of_col(j));
            for (&i, value) in rows.iter().zip(values) {
                left[i] -= value * x[j];
            }
        }
        let solved = norm(&left) <= SOLVED * norm(&rhs) && x.iter().all(|x| x.is_finite());
        Ok(solved.then(|| self.unscaled(rows, &x)))
    }

    fn unscaled(&self, rows: &[[Row; 3]], x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut dP, mut dv) = (vec![0.0; self.m], vec![0.0; self.m]);
        for (point, &(start, len)) in self.rows.iter().enumerate() {
            for k in 0..len {
                dv[start + k] =
                    self.b[point].iter().map(|&(j, b)| b[k] * x[j]).sum::<f64>() / self.sigma;
            }
            for k in 0..len {
                dP[start + k] = if self.explicit {
                    let row = &rows[point][k];
                    -row.h - (0..len).map(|l| row.c[l] * dv[start + l]).sum::<f64>()
                } else {
                    x[self.n + start + k] * self.sigma
                };
            }
        }
        (dP, dv)
    }
}
