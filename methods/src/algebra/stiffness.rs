//! The body behind the contact points: how displacements follow from forces.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use crate::algebra::condensation::{self, Tractions};
use crate::algebra::delassus::{Delassus, check_rows, dense};
use crate::algebra::dense::{norm, ratio};
use crate::algebra::factor::{Factor, backward_error};
use crate::algebra::floating::{Balance, ModeJumps, pins};
use crate::algebra::matrix::{JumpOperator, SquareMatrix};
use crate::algebra::multifrontal::Analysis;
use crate::algebra::sparse::{Sparse, computed, held};
use crate::algebra::strips::cholesky;
use crate::error::MethodError;

/// K behind a factor: factorise, solve, Schur complement on the contact rows. Everything above works through this door.
pub(crate) trait Stiffness: Send + Sync {
    /// Number of unknowns n.
    fn unknowns(&self) -> usize;

    /// K itself, where it is known.
    fn matrix(&self) -> Option<&SquareMatrix>;

    /// The factor of K, computed on first use.
    fn factor(&self) -> Result<&Factor, MethodError> {
        Err(MethodError::NoStiffness)
    }

    /// How K is factored, analysed on first use, and the seconds of that.
    fn plan(&self) -> Option<&(Analysis, f64)> {
        None
    }

    /// Factors K unless that is done.
    fn factorise(&self) -> Result<(), MethodError>;

    /// Factors K on some unknowns, ascending, with all others and the pins held: whether it is positive definite there.
    fn try_part(&self, _own: &[usize]) -> Result<(), MethodError> {
        Ok(())
    }

    /// Factorisations so far, with the seconds of analysis and of numeric work.
    fn factorisations(&self) -> (usize, f64, f64);

    /// Solves K x = f in place, with iterative refinement; where K is singular, by a generalised inverse.
    fn solve(&self, x: &mut [f64]) -> Result<(), MethodError>;

    /// W = B K⁻¹ Bᵀ on the listed rows of B, and its diagonal as [`compliances`](Self::compliances) gives it.
    fn delassus(&self, jump: &JumpOperator, rows: &[usize]) -> Result<Formed, MethodError>;

    /// A traction operator condensed to the listed rows.
    fn tractions(
        &self,
        traction: &JumpOperator,
        jump: &JumpOperator,
        rows: &[usize],
    ) -> Result<Tractions, MethodError>;

    /// The diagonal of W alone: W is not formed.
    fn compliances(&self, jump: &JumpOperator, rows: &[usize]) -> Result<Vec<f64>, MethodError>;

    /// Σ_j B_ij² / K_jj over the listed rows of B: compliance of the contact unknowns with all others held.
    fn local_compliance(&self, jump: &JumpOperator, rows: &[usize]) -> f64;

    /// Σ_ij B_ij² / max_j K_jj, the maximum over the unknowns of a row: what is left of it where the softer side of a contact
    /// point is held by other points.
    fn stiffest_compliance(&self, jump: &JumpOperator, rows: &[usize]) -> f64;

    /// Backward error of equilibrium between displacements and the sum of some forces.
    fn imbalance(&self, u: &[f64], forces: &[&[f64]]) -> f64;

    /// |W| |f|, entry by entry, where W was given.
    fn product_abs(&self, _f: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// max |w_ij − w_ji| / max |w_ij|: 0 where W comes from a stiffness.
    fn asymmetry(&self) -> f64 {
        0.0
    }

    /// Whether W has an eigenvalue below −[`INDEFINITE`] times its largest entry; never where it comes from a stiffness.
    fn indefinite(&self) -> bool {
        false
    }
}

/// W and its diagonal.
pub(crate) type Formed = (Arc<dyn Delassus>, Vec<f64>);

/// Negative eigenvalues of W down to this multiple of its largest entry are rounding of whoever computed it.
pub(crate) const INDEFINITE: f64 = 1e-9;

/// A sparse K, factored once.
pub(crate) struct SparseStiffness {
    k: SquareMatrix,
    /// Preferred order of elimination.
    order: Vec<usize>,
    plan: OnceLock<(Analysis, f64)>,
    pins: Vec<usize>,
    balance: Arc<Balance>,
    factor: OnceLock<Result<Factor, MethodError>>,
}

impl SparseStiffness {
    /// `floating` spans the kernel of K; `in_contact`: the unknowns that move a contact point.
    ///
    /// # Errors
    /// Motions that are not rigid or depend on each other.
    pub fn new(
        k: SquareMatrix,
        order: Vec<usize>,
        in_contact: &[bool],
        floating: &[Vec<f64>],
    ) -> Result<Self, MethodError> {
        let pins = pins(&k, floating)?;
        let balance = Arc::new(Balance::new(&k, floating, in_contact));
        Ok(Self {
            k,
            balance,
            order,
            plan: OnceLock::new(),
            pins,
            factor: OnceLock::new(),
        })
    }

    fn planned(&self) -> &(Analysis, f64) {
        self.plan.get_or_init(|| {
            let clock = Instant::now();
            let analysis = Analysis::new(&self.k, &self.order);
            (analysis, clock.elapsed().as_secs_f64())
        })
    }
}

impl Stiffness for SparseStiffness {
    fn unknowns(&self) -> usize {
        self.k.size()
    }

    fn matrix(&self) -> Option<&SquareMatrix> {
        Some(&self.k)
    }

    fn factor(&self) -> Result<&Factor, MethodError> {
        let build = || {
            let (pins, balance) = (self.pins.clone(), self.balance.clone());
            Factor::new(&self.k, &self.planned().0, pins, balance)
        };
        self.factor
            .get_or_init(build)
            .as_ref()
            .map_err(Clone::clone)
    }

    fn plan(&self) -> Option<&(Analysis, f64)> {
        Some(self.planned())
    }

    fn factorise(&self) -> Result<(), MethodError> {
        self.factor().map(|_| ())
    }

    fn try_part(&self, own: &[usize]) -> Result<(), MethodError> {
        let free = own.iter().copied().filter(|i| !self.pins.contains(i));
        let own: Vec<usize> = free.collect();
        let part = self.k.part(&own)?;
        let place = |i: &usize| own.binary_search(i).ok();
        let order: Vec<usize> = self.order.iter().filter_map(place).collect();
        let held = Arc::new(Balance::new(&part, &[], &[]));
        let factor = Factor::new(&part, &Analysis::new(&part, &order), Vec::new(), held);
        factor.map(|_| ()).map_err(|error| match error {
            MethodError::NotPositiveDefinite { unknown, .. } => MethodError::NotPositiveDefinite {
                unknown: own[unknown],
                size: self.k.size(),
            },
            other => other,
        })
    }

    fn factorisations(&self) -> (usize, f64, f64) {
        match self.factor.get() {
            None => (0, 0.0, 0.0),
            Some(Err(_)) => (1, 0.0, 0.0),
            Some(Ok(factor)) => (1, self.planned().1, factor.factorisation_s),
        }
    }

    fn solve(&self, x: &mut [f64]) -> Result<(), MethodError> {
        self.factor()?.solve(&self.k, x);
        Ok(())
    }

    fn delassus(&self, jump: &JumpOperator, rows: &[usize]) -> Result<Formed, MethodError> {
        let (w, diagonal) = condensation::condense(self.factor()?, jump, rows)?;
        Ok((computed(w)?, diagonal))
    }

    fn tractions(
        &self,
        traction: &JumpOperator,
        jump: &JumpOperator,
        rows: &[usize],
    ) -> Result<Tractions, MethodError> {
        Tractions::new(self.factor()?, traction, jump, rows)
    }

    fn compliances(&self, jump: &JumpOperator, rows: &[usize]) -> Result<Vec<f64>, MethodError> {
        Ok(condensation::diagonal(self.factor()?, jump, rows))
    }

    fn local_compliance(&self, jump: &JumpOperator, rows: &[usize]) -> f64 {
        (rows.iter())
            .flat_map(|&i| jump.row(i))
            .map(|(j, b)| b * b / self.k.diagonal(j))
            .sum()
    }

    fn stiffest_compliance(&self, jump: &JumpOperator, rows: &[usize]) -> f64 {
        let of_row = |&i: &usize| {
            jump.touched(i)
                .fold((0.0, 0.0), |(square, stiffest): (f64, f64), (j, b)| {
                    (square + b * b, stiffest.max(self.k.diagonal(j)))
                })
        };
        let rows = rows.iter().map(of_row);
        rows.map(|(square, stiffest)| ratio(square, stiffest)).sum()
    }

    fn imbalance(&self, u: &[f64], forces: &[&[f64]]) -> f64 {
        let mut residual = vec![0.0; u.len()];
        self.k.mul(u, &mut residual);
        let sum = |j: usize| forces.iter().map(|f| f[j]).sum::<f64>();
        (residual.iter_mut().enumerate()).for_each(|(j, r)| *r -= sum(j));
        backward_error(&self.k, u, forces, &residual, &mut vec![0.0; u.len()])
    }
}

/// A body known by its Delassus operator alone: its unknowns are the jumps of the contact points, u = W f.
pub(crate) struct DelassusOnly {
    w: SquareMatrix,
    asymmetry: f64,
    modes: ModeJumps,
    indefinite: OnceLock<bool>,
}

impl DelassusOnly {
    /// `floating` are the jumps of the rigid motions.
    pub fn new(w: SquareMatrix, jump: &JumpOperator, floating: &[Vec<f64>]) -> Self {
        let all: Vec<usize> = (0..jump.rows()).collect();
        let modes = ModeJumps::new(jump, &all, floating);
        Self {
            asymmetry: w.asymmetry(),
            w,
            modes,
            indefinite: OnceLock::new(),
        }
    }

    /// Whether W, symmetric, moved by [`INDEFINITE`] times its largest entry has no Cholesky factor. What is too large to be
    /// formed is not known to be.
    fn has_negative_eigenvalue(&self) -> bool {
        let shift = INDEFINITE * self.w.largest();
        if shift == 0.0 {
            return false;
        }
        if let Ok(Some(sparse)) = Sparse::of(&self.w) {
            return !sparse.is_definite(shift);
        }
        let Ok(mut full) = dense(&self.w) else {
            return false;
        };
        (0..full.columns()).for_each(|j| full[(j, j)] += shift);
        cholesky(full.view_mut()).is_err()
    }
}

impl Stiffness for DelassusOnly {
    fn unknowns(&self) -> usize {
        self.w.size()
    }

    fn matrix(&self) -> Option<&SquareMatrix> {
        None
    }

    fn factorise(&self) -> Result<(), MethodError> {
        Ok(())
    }

    fn factorisations(&self) -> (usize, f64, f64) {
        (0, 0.0, 0.0)
    }

    fn solve(&self, x: &mut [f64]) -> Result<(), MethodError> {
        // A load enters as an offset of the jump: without contact forces there are none.
        if x.iter().any(|&f| f != 0.0) {
            let f = x.to_vec();
            self.w.mul(&f, x);
        }
        Ok(())
    }

    fn delassus(&self, _: &JumpOperator, rows: &[usize]) -> Result<Formed, MethodError> {
        let diagonal = rows.iter().map(|&i| self.w.diagonal(i)).collect();
        if self.modes.len() > 0 {
            // Augmented by the rigid motions it is full.
            check_rows(rows.len())?;
        }
        Ok((held(&self.w)?, diagonal))
    }

    fn tractions(
        &self,
        _: &JumpOperator,
        _: &JumpOperator,
        _: &[usize],
    ) -> Result<Tractions, MethodError> {
        Err(MethodError::NoStiffness)
    }

    fn compliances(&self, _: &JumpOperator, rows: &[usize]) -> Result<Vec<f64>, MethodError> {
        Ok(rows.iter().map(|&i| self.w.diagonal(i)).collect())
    }

    fn local_compliance(&self, _: &JumpOperator, rows: &[usize]) -> f64 {
        rows.iter().map(|&i| self.w.diagonal(i)).sum()
    }

    fn stiffest_compliance(&self, jump: &JumpOperator, rows: &[usize]) -> f64 {
        self.local_compliance(jump, rows)
    }

    /// |u − W Σ f| / (|u| + ||W| |Σ f||), up to rigid motions, or |Qᵀ Σ f| / Σ |f| if that is larger, Q an orthonormal
    /// basis of the rigid motions: W knows nothing of them, so that no force is left to drive them is a condition of its own.
    fn imbalance(&self, u: &[f64], forces: &[&[f64]]) -> f64 {
        let total: Vec<f64> = (0..u.len())
            .map(|j| forces.iter().map(|f| f[j]).sum())
            .collect();
        let mut work = vec![0.0; u.len()];
        self.w.mul(&total, &mut work);
        let mut residual: Vec<f64> = u.iter().zip(&work).map(|(u, w)| u - w).collect();
        self.modes.project_out(&mut residual);
        self.w.mul_abs(&total, &mut work);
        let deformation = ratio(norm(&residual), norm(u) + norm(&work));
        let size: f64 = forces.iter().map(|f| norm(f)).sum();
        deformation.max(ratio(norm(&self.modes.components(&total)), size))
    }

    fn product_abs(&self, f: &[f64]) -> Option<Vec<f64>> {
        let mut product = vec![0.0; f.len()];
        self.w.mul_abs(f, &mut product);
        Some(product)
    }

    fn asymmetry(&self) -> f64 {
        self.asymmetry
    }

    fn indefinite(&self) -> bool {
        *(self.indefinite).get_or_init(|| self.has_negative_eigenvalue())
    }
}
