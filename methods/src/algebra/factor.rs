//! Sparse Cholesky factor of the symmetrically scaled stiffness, D K D = L Lᵀ with D = diag(K)^(−1/2).
//!
//! The scaling keeps the condition number bounded however small a cut cell is. Rows and columns of pinned unknowns
//! (one per rigid motion) are replaced by those of the unit matrix; what is solved for are balanced forces, see
//! [`Balance`].

use std::fmt::Debug;
use std::sync::Arc;
use std::time::Instant;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{CreationError, FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, Par, Side};

use crate::algebra::dense::norm;
use crate::algebra::floating::Balance;
use crate::algebra::matrix::SymmetricMatrix;
use crate::algebra::ordering::Ordering;
use crate::error::MethodError;

/// Refinement aims at this backward error |K u − f| / (||K| |u|| + |f|), a few units of rounding.
const REFINED: f64 = 1e-15;
/// Pivots of D K D, whose diagonal is 1, lie above this unless K is singular to working precision.
const SMALLEST_PIVOT: f64 = 1e-12;
/// More refinement steps do not help once rounding of the residual itself dominates.
const MAX_REFINEMENTS: usize = 3;

/// The factor with everything needed to solve.
pub(crate) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    pub ordering: Ordering,
    /// D by unknown.
    pub scale: Vec<f64>,
    /// Pinned unknowns.
    pub pins: Vec<usize>,
    /// Forces and motions of a floating body.
    pub balance: Arc<Balance>,
    pub analysis_s: f64,
    pub factorisation_s: f64,
}

impl Factor {
    pub fn new(
        k: &SymmetricMatrix,
        ordering: Ordering,
        pins: Vec<usize>,
        balance: Arc<Balance>,
    ) -> Result<Self, MethodError> {
        let n = k.size();
        let clock = Instant::now();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, k.col_ptr(), None, k.row_idx());
        let permutation = PermRef::new_checked(&ordering.forward, &ordering.inverse, n);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Custom(permutation),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|e| sparse("symbolic factorisation", e))?;
        let analysis_s = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let scale: Vec<f64> = (0..n).map(|j| 1.0 / k.diagonal(j).sqrt()).collect();
        let scaled = scaled_values(k, &scale, &pins);
        // The largest array of a run: where it does not fit, the run says so.
        let denied = MethodError::OutOfMemory {
            what: "sparse factorisation",
        };
        let mut values = Vec::new();
        (values.try_reserve_exact(symbolic.len_val())).map_err(|_| denied.clone())?;
        values.resize(symbolic.len_val(), 0.0);
        let req = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(req).map_err(|_| denied)?;
        symbolic
            .factorize_numeric_llt::<f64>(
                &mut values,
                SparseColMatRef::new(pattern, &scaled),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(
                |LltError::NonPositivePivot { index }| MethodError::NotPositiveDefinite {
                    unknown: ordering.forward[index.min(n.saturating_sub(1))],
                    size: n,
                },
            )?;
        let factorisation_s = clock.elapsed().as_secs_f64();
        let factor = Self {
            symbolic,
            values,
            ordering,
            scale,
            pins,
            balance,
            analysis_s,
            factorisation_s,
        };
        factor.check_pivots()?;
        Ok(factor)
    }

    /// Refuses pivots that are rounding: a singular K can pass Cholesky by luck.
    fn check_pivots(&self) -> Result<(), MethodError> {
        let l = self.supernodes()?;
        for s in 0..self.supernode_count() {
            let node = l.supernode(s);
            for k in 0..node.val().ncols() {
                if node.val()[(k, k)].powi(2) < SMALLEST_PIVOT {
                    return Err(MethodError::NotPositiveDefinite {
                        unknown: self.ordering.forward[node.start() + k],
                        size: self.scale.len(),
                    });
                }
            }
        }
        Ok(())
    }

    /// x := G f in place with iterative refinement: solves K x = f if f leaves no rigid motion a resultant.
    pub fn solve(&self, k: &SymmetricMatrix, x: &mut [f64]) -> Result<(), MethodError> {
        let n = k.size();
        let req = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = solve_memory(req)?;
        let mut f = x.to_vec();
        self.balance.balance(&mut f);
        for &pin in &self.pins {
            f[pin] = 0.0;
        }
        x.copy_from_slice(&f);
        self.solve_scaled(column(x), &mut memory);

        let (mut residual, mut kx) = (vec![0.0; n], vec![0.0; n]);
        let mut best = f64::INFINITY;
        for _ in 0..MAX_REFINEMENTS {
            k.mul(x, &mut kx);
            for &pin in &self.pins {
                kx[pin] = 0.0;
            }
            for j in 0..n {
                residual[j] = f[j] - kx[j];
            }
            k.mul_abs(x, &mut kx);
            let size = norm(&kx) + norm(&f);
            let relative = if size > 0.0 {
                norm(&residual) / size
            } else {
                0.0
            };
            if relative <= REFINED || relative > 0.5 * best {
                break;
            }
            best = relative;
            self.solve_scaled(column(&mut residual), &mut memory);
            for j in 0..n {
                x[j] += residual[j];
            }
        }
        self.balance.take_out(x);
        Ok(())
    }

    /// X := G F in place for all columns together, without refinement.
    pub fn solve_columns(&self, x: &mut Mat<f64>) -> Result<(), MethodError> {
        let req = (self.symbolic).solve_in_place_scratch::<f64>(x.ncols(), Par::Seq);
        let mut memory = solve_memory(req)?;
        for j in 0..x.ncols() {
            let f = x.col_as_slice_mut(j);
            self.balance.balance(f);
            self.pins.iter().for_each(|&pin| f[pin] = 0.0);
        }
        self.solve_scaled(x.as_mut(), &mut memory);
        for j in 0..x.ncols() {
            self.balance.take_out(x.col_as_slice_mut(j));
        }
        Ok(())
    }

    fn solve_scaled(&self, mut x: MatMut<'_, f64>, memory: &mut MemBuffer) {
        let scale = |x: &mut MatMut<'_, f64>| {
            for j in 0..x.ncols() {
                for (i, d) in self.scale.iter().enumerate() {
                    x[(i, j)] *= d;
                }
            }
        };
        scale(&mut x);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            x.as_mut(),
            Par::Seq,
            MemStack::new(memory),
        );
        scale(&mut x);
        for &pin in &self.pins {
            x.as_mut().row_mut(pin).fill(0.0);
        }
    }

    /// The supernodes of L, in permuted numbering.
    pub fn supernodes(&self) -> Result<SupernodalLltRef<'_, usize, f64>, MethodError> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                Ok(SupernodalLltRef::new(symbolic, &self.values))
            }
            // FORCE_SUPERNODAL excludes it; said as an error rather than a panic.
            SymbolicCholeskyRaw::Simplicial(_) => {
                Err(kernel("condensation", "factor is not supernodal".into()))
            }
        }
    }

    /// Number of supernodes.
    pub fn supernode_count(&self) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic.n_supernodes(),
            SymbolicCholeskyRaw::Simplicial(_) => 0,
        }
    }
}

/// Values of D K D with pinned rows and columns replaced by those of the unit matrix.
fn scaled_values(k: &SymmetricMatrix, scale: &[f64], pins: &[usize]) -> Vec<f64> {
    let mut pinned = vec![false; k.size()];
    for &pin in pins {
        pinned[pin] = true;
    }
    let mut values = k.values().to_vec();
    for j in 0..k.size() {
        let begin = k.col_ptr()[j];
        values[begin] = 1.0;
        for e in begin + 1..k.col_ptr()[j + 1] {
            let i = k.row_idx()[e];
            values[e] = if pinned[i] || pinned[j] {
                0.0
            } else {
                values[e] * scale[i] * scale[j]
            };
        }
    }
    values
}

fn column(x: &mut [f64]) -> MatMut<'_, f64> {
    let n = x.len();
    MatMut::from_column_major_slice_mut(x, n, 1)
}

/// Memory of a solve.
fn solve_memory(req: StackReq) -> Result<MemBuffer, MethodError> {
    let what = "sparse solve";
    MemBuffer::try_new(req).map_err(|_| MethodError::OutOfMemory { what })
}

/// An error of a sparse kernel.
pub(crate) fn sparse(what: &'static str, error: impl Into<CreationError> + Debug) -> MethodError {
    let reason = format!("{error:?}");
    match error.into() {
        CreationError::Generic(FaerError::OutOfMemory) => MethodError::OutOfMemory { what },
        _ => kernel(what, reason),
    }
}

pub(crate) fn kernel(what: &'static str, reason: String) -> MethodError {
    MethodError::Kernel { what, reason }
}
