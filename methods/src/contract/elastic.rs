//! The elastic body: K, B and the rigid motions, factored once and condensed once, whatever happens at the contact.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use faer::Mat;

use crate::algebra::factor::{Factor, norm};
use crate::algebra::floating::{ModeJumps, pins};
use crate::algebra::matrix::{JumpOperator, SymmetricMatrix};
use crate::algebra::{delassus, ordering};
use crate::contract::judge::ratio;
use crate::contract::operator::{Condensed, RowSet};
use crate::error::{MethodError, check_finite, check_len, check_positive};
use crate::own_laws::stabilisation::Tractions;

/// What a discretisation hands over.
#[derive(Debug, Clone)]
pub struct ElasticParts {
    /// Space dimension, 2 or 3.
    pub dim: usize,
    /// Stiffness K with supports eliminated, n × n, semi-definite with kernel `floating`. In N/m, in 2D
    /// N/m².
    pub stiffness: SymmetricMatrix,
    /// Jump operator B, `dim` rows per contact point, n columns; dimensionless.
    pub jump: JumpOperator,
    /// Tributary area (2D: length) per contact point, > 0, in m² (m).
    pub weight: Vec<f64>,
    /// Preferred fill-reducing elimination order of the n unknowns, a permutation.
    pub order: Vec<usize>,
    /// Basis of the kernel of K: the rigid motions left by the supports, n entries each; empty if K is definite.
    pub floating: Vec<Vec<f64>>,
    /// Promise that no run on this body will ever have friction: only normal rows are condensed.
    pub frictionless: bool,
    /// Traction operator S, for the methods that need one: S u is the contact force on side 1 that the stress of the
    /// bulk implies at every contact point, rows as in `jump`, in N per m of displacement (2D: N/m²).
    pub traction: Option<JumpOperator>,
}

/// How often the body was factored, solved with and condensed so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ElasticCounters {
    /// Sparse factorisations of K (0 or 1).
    pub factorisations: usize,
    /// Solves with the factor; refinement steps belong to the solve they refine.
    pub solves: usize,
    /// Condensations to the contact points (0 or 1).
    pub condensations: usize,
}

/// Wall-clock times of the work shared by all runs on the body, in s; 0 for work not done.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElasticTimings {
    /// Elimination order and symbolic factorisation.
    pub analysis_s: f64,
    /// Scaling and numeric factorisation.
    pub factorisation_s: f64,
    /// Delassus operator.
    pub condensation_s: f64,
    /// Condensation of the traction operator, for the methods that need it.
    pub traction_s: f64,
}

/// How displacements follow from forces.
enum Response {
    /// K u = f.
    Stiffness {
        k: SymmetricMatrix,
        order: Vec<usize>,
        factor: Box<OnceLock<Result<Factor, MethodError>>>,
    },
    /// u = W f: the unknowns are the jumps themselves.
    Compliance(SymmetricMatrix),
}

/// The elastic body, shared by all systems on it through an [`Arc`]. The factor of K and the Delassus operator are
/// computed on first use.
pub struct Elastic {
    dim: usize,
    response: Response,
    jump: JumpOperator,
    weight: Vec<f64>,
    floating: Vec<Vec<f64>>,
    frictionless: bool,
    traction: Option<JumpOperator>,
    condensed: OnceLock<Result<(Arc<Condensed>, f64), MethodError>>,
    tractions: OnceLock<Result<(Arc<Tractions>, f64), MethodError>>,
    solves: AtomicUsize,
}

impl std::fmt::Debug for Elastic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Elastic")
            .field("dim", &self.dim())
            .field("unknowns", &self.unknowns())
            .field("points", &self.points())
            .finish_non_exhaustive()
    }
}

impl Elastic {
    /// Checks the parts. Nothing is factored yet.
    ///
    /// # Errors
    /// Inconsistent sizes, non-finite or non-positive entries, an order that is no permutation, motions that are not
    /// rigid, dependent or without any jump.
    pub fn new(parts: ElasticParts) -> Result<Arc<Self>, MethodError> {
        let n = parts.stiffness.size();
        check_len("elimination order", parts.order.len(), n)?;
        let diagonal = (0..n).map(|j| parts.stiffness.diagonal(j));
        check_positive("stiffness diagonal", diagonal)?;
        let mut seen = vec![false; n];
        for (index, &j) in parts.order.iter().enumerate() {
            if j >= n || std::mem::replace(&mut seen[j], true) {
                return Err(MethodError::Pattern {
                    what: "elimination order",
                    index,
                    reason: "not a permutation of the unknowns",
                });
            }
        }
        for mode in &parts.floating {
            check_len("floating mode", mode.len(), n)?;
            check_finite("floating mode", mode)?;
        }
        pins(&parts.stiffness, &parts.floating)?;
        if let Some(traction) = &parts.traction {
            check_len("traction operator rows", traction.rows(), parts.jump.rows())?;
            check_len("traction operator columns", traction.cols(), n)?;
        }
        Self::checked(Self {
            dim: parts.dim,
            response: Response::Stiffness {
                k: parts.stiffness,
                order: parts.order,
                factor: Box::default(),
            },
            jump: parts.jump,
            weight: parts.weight,
            floating: parts.floating,
            frictionless: parts.frictionless,
            traction: parts.traction,
            condensed: OnceLock::new(),
            tractions: OnceLock::new(),
            solves: AtomicUsize::new(0),
        })
    }

    /// A body known at its contact points only, by its Delassus operator W (`dim` rows per point, in m/N) and the
    /// jumps `floating` of its rigid motions, one vector each. Its unknowns u are the jumps of the contact points:
    /// u = W (f + P) + R α, and a load carries the free jump q as its offset.
    ///
    /// # Errors
    /// Inconsistent sizes, negative diagonal entries, non-finite values.
    pub fn from_delassus(
        dim: usize,
        w: SymmetricMatrix,
        floating: Vec<Vec<f64>>,
    ) -> Result<Arc<Self>, MethodError> {
        let m = w.size();
        if let Some(index) = (0..m).find(|&j| w.diagonal(j) < 0.0) {
            return Err(MethodError::Range {
                what: "Delassus operator diagonal",
                index,
                value: w.diagonal(index),
                allowed: "not negative",
            });
        }
        for mode in &floating {
            check_len("floating mode", mode.len(), m)?;
            check_finite("floating mode", mode)?;
        }
        Self::checked(Self {
            dim,
            response: Response::Compliance(w),
            jump: JumpOperator::identity(m),
            weight: vec![1.0; m / dim.max(1)],
            floating,
            frictionless: false,
            traction: None,
            condensed: OnceLock::new(),
            tractions: OnceLock::new(),
            solves: AtomicUsize::new(0),
        })
    }

    /// What both kinds of body must fulfil.
    fn checked(self) -> Result<Arc<Self>, MethodError> {
        if !(self.dim == 2 || self.dim == 3) {
            return Err(MethodError::Range {
                what: "dimension",
                index: 0,
                value: self.dim as f64,
                allowed: "2 or 3",
            });
        }
        check_len(
            "jump operator rows",
            self.jump.rows(),
            self.dim * self.weight.len(),
        )?;
        check_len("jump operator columns", self.jump.cols(), self.unknowns())?;
        check_positive("weight", self.weight.iter().copied())?;
        let all: Vec<usize> = (0..self.jump.rows()).collect();
        let free = ModeJumps::new(&self.jump, &all, &self.floating).free;
        if free > 0 {
            return Err(MethodError::FreeRigidMotion { modes: free });
        }
        Ok(Arc::new(self))
    }

    /// Space dimension.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of contact points.
    pub fn points(&self) -> usize {
        self.weight.len()
    }

    /// Number of unknowns n.
    pub fn unknowns(&self) -> usize {
        match &self.response {
            Response::Stiffness { k, .. } => k.size(),
            Response::Compliance(w) => w.size(),
        }
    }

    /// Stiffness K; `None` if only the Delassus operator is known.
    pub fn stiffness(&self) -> Option<&SymmetricMatrix> {
        match &self.response {
            Response::Stiffness { k, .. } => Some(k),
            Response::Compliance(_) => None,
        }
    }

    /// Jump operator B with all `dim` rows per point.
    pub fn jump(&self) -> &JumpOperator {
        &self.jump
    }

    /// Traction operator S with all `dim` rows per point, if the body has one.
    pub fn traction(&self) -> Option<&JumpOperator> {
        self.traction.as_ref()
    }

    /// Tributary area (2D: length) per point; 1 if only the Delassus operator is known.
    pub fn weight(&self) -> &[f64] {
        &self.weight
    }

    /// Basis of the kernel of K.
    pub fn floating(&self) -> &[Vec<f64>] {
        &self.floating
    }

    /// Whether only normal rows are ever condensed.
    pub fn frictionless(&self) -> bool {
        self.frictionless
    }

    /// Work done so far.
    pub fn counters(&self) -> ElasticCounters {
        ElasticCounters {
            factorisations: usize::from(self.factor_cell().is_some_and(|f| f.get().is_some())),
            solves: self.solves.load(Relaxed),
            condensations: usize::from(self.condensed.get().is_some()),
        }
    }

    /// Times of the work done so far.
    pub fn timings(&self) -> ElasticTimings {
        let factor = self.factor_cell().and_then(OnceLock::get);
        let factor = factor.and_then(|f| f.as_ref().ok());
        let condensed = self.condensed.get().and_then(|c| c.as_ref().ok());
        let tractions = self.tractions.get().and_then(|t| t.as_ref().ok());
        ElasticTimings {
            analysis_s: factor.map_or(0.0, |f| f.analysis_s),
            factorisation_s: factor.map_or(0.0, |f| f.factorisation_s),
            condensation_s: condensed.map_or(0.0, |c| c.1),
            traction_s: tractions.map_or(0.0, |t| t.1),
        }
    }

    /// Solves K x = f in place, with iterative refinement. Where the body floats, f must balance (Rᵀ f = 0) and the
    /// solution is the one with the pinned unknowns at 0.
    ///
    /// # Errors
    /// Wrong length; the errors of the first factorisation.
    pub fn solve(&self, x: &mut [f64]) -> Result<(), MethodError> {
        check_len("right-hand side", x.len(), self.unknowns())?;
        match &self.response {
            Response::Stiffness { k, .. } => self.factor()?.solve(k, x),
            Response::Compliance(w) => {
                let f = x.to_vec();
                w.mul(&f, x);
                Ok(())
            }
        }?;
        self.solves.fetch_add(1, Relaxed);
        Ok(())
    }

    /// Solves K X = F in place for all columns together, without refinement. Forces at pinned unknowns count as 0.
    pub(crate) fn solve_columns(&self, x: &mut Mat<f64>) -> Result<(), MethodError> {
        self.factor()?.solve_columns(x)?;
        self.solves.fetch_add(x.ncols(), Relaxed);
        Ok(())
    }

    /// Backward error of equilibrium between displacements and the sum of some forces:
    /// |K u − Σ f| / (Σ |f| + ||K| |u||). With the Delassus operator alone: |u − W Σ f| / (|u| + ||W| |Σ f||), up to
    /// rigid motions, or |Qᵀ Σ f| / Σ |f| if that is larger, Q an orthonormal basis of the rigid motions.
    pub(crate) fn imbalance(&self, u: &[f64], forces: &[&[f64]]) -> f64 {
        let n = u.len();
        let sum = |j: usize| forces.iter().map(|f| f[j]).sum::<f64>();
        let mut work = vec![0.0; n];
        let (residual, scale): (Vec<f64>, f64) = match &self.response {
            Response::Stiffness { k, .. } => {
                k.mul(u, &mut work);
                let residual = (0..n).map(|j| work[j] - sum(j)).collect();
                k.mul_abs(u, &mut work);
                let forces: f64 = forces.iter().map(|f| norm(f)).sum();
                (residual, forces + norm(&work))
            }
            Response::Compliance(w) => {
                let total: Vec<f64> = (0..n).map(sum).collect();
                w.mul(&total, &mut work);
                let mut residual: Vec<f64> = u.iter().zip(&work).map(|(u, w)| u - w).collect();
                let all: Vec<usize> = (0..n).collect();
                let modes = ModeJumps::new(&self.jump, &all, &self.floating);
                modes.project_out(&mut residual);
                w.mul_abs(&total, &mut work);
                let deformation = ratio(norm(&residual), norm(u) + norm(&work));
                // W knows nothing of the rigid motions: that no force is left to drive them is a condition of its own.
                let size: f64 = forces.iter().map(|f| norm(f)).sum();
                return deformation.max(ratio(norm(&modes.components(&total)), size));
            }
        };
        ratio(norm(&residual), scale)
    }

    /// Σ_j B_ij² / K_jj over the listed rows of B: compliance of the contact unknowns with all others held.
    pub(crate) fn local_compliance(&self, rows: &[usize]) -> f64 {
        match &self.response {
            Response::Stiffness { k, .. } => (rows.iter())
                .flat_map(|&i| self.jump.row(i))
                .map(|(j, b)| b * b / k.diagonal(j))
                .sum(),
            Response::Compliance(w) => rows.iter().map(|&i| w.diagonal(i)).sum(),
        }
    }

    /// Factors K unless that is done.
    ///
    /// # Errors
    /// K not positive definite apart from the given rigid motions; out of memory.
    pub fn factorise(&self) -> Result<(), MethodError> {
        match &self.response {
            Response::Stiffness { .. } => self.factor().map(|_| ()),
            Response::Compliance(_) => Ok(()),
        }
    }

    fn factor_cell(&self) -> Option<&OnceLock<Result<Factor, MethodError>>> {
        match &self.response {
            Response::Stiffness { factor, .. } => Some(factor),
            Response::Compliance(_) => None,
        }
    }

    /// The factor, computed on first use.
    pub(crate) fn factor(&self) -> Result<&Factor, MethodError> {
        match &self.response {
            Response::Stiffness { k, order, factor } => factor
                .get_or_init(|| self.new_factor(k, order))
                .as_ref()
                .map_err(Clone::clone),
            Response::Compliance(_) => Err(MethodError::NoStiffness),
        }
    }

    fn new_factor(&self, k: &SymmetricMatrix, order: &[usize]) -> Result<Factor, MethodError> {
        let pins = pins(k, &self.floating)?;
        let clock = Instant::now();
        let mut in_contact = vec![false; k.size()];
        for &i in &self.rows().source {
            for (j, b) in self.jump.row(i) {
                in_contact[j] |= b != 0.0;
            }
        }
        let ordering = ordering::contact_last(k, order, &in_contact);
        let ordering_s = clock.elapsed().as_secs_f64();
        let mut factor = Factor::new(k, ordering, pins)?;
        factor.analysis_s += ordering_s;
        Ok(factor)
    }

    /// The Delassus operator W = B K⁻¹ Bᵀ, computed unless it exists: `dim` rows per point, in m/N (2D: m²/N); where the body
    /// floats, that of the body held at the pinned unknowns.
    ///
    /// # Errors
    /// Those of the first factorisation and condensation; a body set up without friction, which has only normal rows.
    pub fn delassus(&self) -> Result<SymmetricMatrix, MethodError> {
        if self.frictionless {
            return Err(MethodError::NoTangentialRows);
        }
        delassus::lower(&self.condensed()?.w)
    }

    /// Rows that are condensed.
    pub(crate) fn rows(&self) -> RowSet {
        let components = if self.frictionless { 1 } else { self.dim };
        RowSet::new(self.dim, &vec![components; self.points()])
    }

    /// The Delassus operator on [`rows`](Self::rows), computed unless it exists.
    pub(crate) fn condensed(&self) -> Result<Arc<Condensed>, MethodError> {
        let build = || {
            let rows = self.rows();
            let (w, clock) = match &self.response {
                Response::Stiffness { .. } => {
                    let factor = self.factor()?;
                    let clock = Instant::now();
                    (delassus::condense(factor, &self.jump, &rows.source)?, clock)
                }
                Response::Compliance(w) => {
                    let clock = Instant::now();
                    (delassus::dense(w)?, clock)
                }
            };
            let condensed = Condensed::new(self, w, &rows)?;
            Ok((Arc::new(condensed), clock.elapsed().as_secs_f64()))
        };
        self.condensed
            .get_or_init(build)
            .as_ref()
            .map(|c| c.0.clone())
            .map_err(Clone::clone)
    }

    /// The condensed traction operator on [`rows`](Self::rows), computed unless it exists.
    pub(crate) fn tractions(&self) -> Result<Arc<Tractions>, MethodError> {
        let build = || {
            self.factorise()?;
            let clock = Instant::now();
            let tractions = Tractions::new(self)?;
            Ok((Arc::new(tractions), clock.elapsed().as_secs_f64()))
        };
        self.tractions
            .get_or_init(build)
            .as_ref()
            .map(|t| t.0.clone())
            .map_err(Clone::clone)
    }
}
