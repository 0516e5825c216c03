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
use faer::sparse::{Argsort, Pair as Place, SparseColMat, SymbolicSparseColMat};

use crate::algebra::dense::{along, norm};
use crate::algebra::factor::sparse;
use crate::algebra::rows::RowSet;
use crate::condensed::pair::Pair;
use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::contract::elastic::Elastic;
use crate::contract::operator::DelassusForm;
use crate::contract::system::ContactSystem;
use crate::error::MethodError;

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
pub(crate) struct WholeBody {
    elastic: Arc<Elastic>,
    set: RowSet,
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

impl WholeBody {
    /// The saddle-point form, for rows of any kind.
    pub fn saddle(system: &ContactSystem) -> Result<Self, MethodError> {
        Self::new(system, false)
    }

    /// The displacement form, for rows that give δP explicitly (A = I).
    pub fn explicit(system: &ContactSystem) -> Result<Self, MethodError> {
        Self::new(system, true)
    }

    fn new(system: &ContactSystem, explicit: bool) -> Result<Self, MethodError> {
        let rho = system.operator(DelassusForm::Products)?.rho;
        let (elastic, set) = (system.elastic(), system.row_set());
        let K = elastic.stiffness().ok_or(MethodError::NoStiffness)?;
        let (n, m) = (K.size(), set.len());
        let scale: Vec<f64> = (0..n).map(|j| 1.0 / K.diagonal(j).sqrt()).collect();
        let sigma = rho.sqrt();
        let (mut at, mut entries) = (Vec::new(), Vec::new());
        let mut push = |row: usize, col: usize, entry: Entry| {
            at.push(Place { row, col });
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
            elastic: elastic.clone(),
            set: set.clone(),
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
        Arc::ptr_eq(system.elastic(), &self.elastic) && *system.row_set() == self.set
    }

    /// The step from contact forces P that fulfils the rows, with its jump and amplitudes; `None` if the matrix is singular.
    pub fn step(
        &self,
        problem: &mut ContactProblem<'_>,
        P: &[f64],
        rows: &mut [[PointRow; 3]],
    ) -> Result<Option<Pair>, MethodError> {
        let factor = self.factorise(problem, rows)?;
        Ok(factor.and_then(|factor| factor.step(problem, P, rows)))
    }

    /// Factors the matrix of the coefficients of some rows; `None` if it is singular.
    pub fn factorise(
        &self,
        problem: &mut ContactProblem<'_>,
        rows: &[[PointRow; 3]],
    ) -> Result<Option<WholeBodyFactor<'_>>, MethodError> {
        problem.counters.global_factorisations += 1;
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
        match Lu::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref()) {
            Ok(lu) => Ok(Some(WholeBodyFactor {
                body: self,
                matrix,
                lu,
            })),
            Err(LuError::SymbolicSingular { .. }) => Ok(None),
            Err(LuError::Generic(e)) => Err(failed(e)),
        }
    }

    fn unscaled(&self, rows: &[[PointRow; 3]], x: &[f64]) -> (Vec<f64>, Vec<f64>) {
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

/// The matrix of the whole body for the coefficients of some rows, factored.
pub(crate) struct WholeBodyFactor<'a> {
    body: &'a WholeBody,
    matrix: SparseColMat<usize, f64>,
    lu: Lu<usize, f64>,
}

impl WholeBodyFactor<'_> {
    /// The step from contact forces P that fulfils rows of the factored coefficients; `None` if the matrix is singular.
    pub fn step(
        &self,
        problem: &ContactProblem<'_>,
        P: &[f64],
        rows: &mut [[PointRow; 3]],
    ) -> Option<Pair> {
        // Without balance there is no equilibrium to linearise: step from the nearest balanced forces P + Q (c − Qᵀ P).
        let (mut lack, mut response) = (vec![0.0; P.len()], vec![0.0; P.len()]);
        if problem.modes() > 0 {
            problem.operator.modes.add(&problem.missing(P), &mut lack);
            problem.operator.w.apply_add(&lack, &mut response);
        }
        for (own, of_point) in problem.rows.iter().zip(rows.iter_mut()) {
            for row in of_point.iter_mut().take(own.len()) {
                for (l, k) in own.clone().enumerate() {
                    row.h += row.a[l] * lack[k] + row.c[l] * response[k];
                }
            }
        }
        let (dP, dv) = self.solve(rows)?;
        let (p, v) = (along(&dP, 1.0, &lack), along(&dv, 1.0, &response));
        let beta = amplitudes(problem, &p, v.clone());
        Some(Pair { p, v, beta })
    }

    /// (δP, δv) by row; `None` if the matrix is singular.
    fn solve(&self, rows: &[[PointRow; 3]]) -> Option<(Vec<f64>, Vec<f64>)> {
        let (body, size) = (self.body, self.matrix.ncols());
        let mut rhs = vec![0.0; size];
        for (point, &(start, len)) in body.rows.iter().enumerate() {
            for k in 0..len {
                let h = rows[point][k].h / body.sigma;
                if body.explicit {
                    body.b[point].iter().for_each(|&(j, b)| rhs[j] -= b[k] * h);
                } else {
                    rhs[body.n + start + k] = -h;
                }
            }
        }
        let mut x = rhs.clone();
        self.lu
            .solve_in_place(MatMut::from_column_major_slice_mut(&mut x, size, 1));
        let mut left = rhs.clone();
        for j in 0..size {
            let (rows, values) = (self.matrix.row_idx_of_col_raw(j), self.matrix.val_of_col(j));
            for (&i, value) in rows.iter().zip(values) {
                left[i] -= value * x[j];
            }
        }
        let solved = norm(&left) <= SOLVED * norm(&rhs) && x.iter().all(|x| x.is_finite());
        solved.then(|| body.unscaled(rows, &x))
    }
}

/// δβ = Qᵀ (δv − W δP).
fn amplitudes(problem: &ContactProblem<'_>, dP: &[f64], mut dv: Vec<f64>) -> Vec<f64> {
    if problem.modes() > 0 {
        let minus: Vec<f64> = dP.iter().map(|p| -p).collect();
        problem.operator.w.apply_add(&minus, &mut dv);
    }
    problem.operator.modes.components(&dv)
}
