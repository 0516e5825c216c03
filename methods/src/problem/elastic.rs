//! The elastic body: K, B and the rigid motions, factored once and condensed once, whatever happens at the contact.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::condensed::{Condensed, RowSet};
use super::error::{MethodError, check_finite, check_len};
use super::linear::factor::Factor;
use super::linear::floating::{ModeJumps, pins};
use super::linear::{delassus, ordering};
use super::matrix::{JumpOperator, SymmetricMatrix};

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
}

/// The elastic body, shared by all systems on it through an [`Arc`]. The factor of K and the Delassus operator are
/// computed on first use.
pub struct Elastic {
    parts: ElasticParts,
    factor: OnceLock<Result<Factor, MethodError>>,
    condensed: OnceLock<Result<(Arc<Condensed>, f64), MethodError>>,
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
        let ElasticParts {
            dim,
            stiffness,
            jump,
            weight,
            order,
            floating,
            ..
        } = &parts;
        let n = stiffness.size();
        if !(*dim == 2 || *dim == 3) {
            return Err(MethodError::Range {
                what: "dimension",
                index: 0,
                value: *dim as f64,
                allowed: "2 or 3",
            });
        }
        check_len("jump operator rows", jump.rows(), dim * weight.len())?;
        check_len("jump operator columns", jump.cols(), n)?;
        check_len("elimination order", order.len(), n)?;
        let positive = |what, values: &mut dyn Iterator<Item = f64>| match values
            .enumerate()
            .find(|(_, v)| !(*v > 0.0 && v.is_finite()))
        {
            None => Ok(()),
            Some((index, value)) => Err(MethodError::Range {
                what,
                index,
                value,
                allowed: "positive and finite",
            }),
        };
        positive(
            "stiffness diagonal",
            &mut (0..n).map(|j| stiffness.diagonal(j)),
        )?;
        positive("weight", &mut weight.iter().copied())?;
        let mut seen = vec![false; n];
        for (index, &j) in order.iter().enumerate() {
            if j >= n || std::mem::replace(&mut seen[j], true) {
                return Err(MethodError::Pattern {
                    what: "elimination order",
                    index,
                    reason: "not a permutation of the unknowns",
                });
            }
        }
        for mode in floating {
            check_len("floating mode", mode.len(), n)?;
            check_finite("floating mode", mode)?;
        }
        pins(stiffness, floating)?;
        let all: Vec<usize> = (0..jump.rows()).collect();
        let free = ModeJumps::new(jump, &all, floating).free;
        if free > 0 {
            return Err(MethodError::FreeRigidMotion { modes: free });
        }
        Ok(Arc::new(Self {
            parts,
            factor: OnceLock::new(),
            condensed: OnceLock::new(),
            solves: AtomicUsize::new(0),
        }))
    }

    /// Space dimension.
    pub fn dim(&self) -> usize {
        self.parts.dim
    }

    /// Number of contact points.
    pub fn points(&self) -> usize {
        self.parts.weight.len()
    }

    /// Number of unknowns n.
    pub fn unknowns(&self) -> usize {
        self.parts.stiffness.size()
    }

    /// Stiffness K.
    pub fn stiffness(&self) -> &SymmetricMatrix {
        &self.parts.stiffness
    }

    /// Jump operator B with all `dim` rows per point.
    pub fn jump(&self) -> &JumpOperator {
        &self.parts.jump
    }

    /// Tributary area (2D: length) per point.
    pub fn weight(&self) -> &[f64] {
        &self.parts.weight
    }

    /// Basis of the kernel of K.
    pub fn floating(&self) -> &[Vec<f64>] {
        &self.parts.floating
    }

    /// Whether only normal rows are ever condensed.
    pub fn frictionless(&self) -> bool {
        self.parts.frictionless
    }

    /// Work done so far.
    pub fn counters(&self) -> ElasticCounters {
        ElasticCounters {
            factorisations: usize::from(self.factor.get().is_some()),
            solves: self.solves.load(Relaxed),
            condensations: usize::from(self.condensed.get().is_some()),
        }
    }

    /// Times of the work done so far.
    pub fn timings(&self) -> ElasticTimings {
        let factor = self.factor.get().and_then(|f| f.as_ref().ok());
        let condensed = self.condensed.get().and_then(|c| c.as_ref().ok());
        ElasticTimings {
            analysis_s: factor.map_or(0.0, |f| f.analysis_s),
            factorisation_s: factor.map_or(0.0, |f| f.factorisation_s),
            condensation_s: condensed.map_or(0.0, |c| c.1),
        }
    }

    /// Solves K x = f in place, with iterative refinement. Where the body floats, f must balance (Rᵀ f = 0) and the
    /// solution is the one with the pinned unknowns at 0.
    ///
    /// # Errors
    /// Wrong length; the errors of the first factorisation.
    pub fn solve(&self, x: &mut [f64]) -> Result<(), MethodError> {
        check_len("right-hand side", x.len(), self.unknowns())?;
        let factor = self.factor()?;
        self.solves.fetch_add(1, Relaxed);
        factor.solve(&self.parts.stiffness, x)
    }

    /// Factors K unless that is done.
    ///
    /// # Errors
    /// K not positive definite apart from the given rigid motions; out of memory.
    pub fn factorise(&self) -> Result<(), MethodError> {
        self.factor().map(|_| ())
    }

    /// The factor, computed on first use.
    pub(crate) fn factor(&self) -> Result<&Factor, MethodError> {
        self.factor
            .get_or_init(|| self.new_factor())
            .as_ref()
            .map_err(Clone::clone)
    }

    fn new_factor(&self) -> Result<Factor, MethodError> {
        let ElasticParts {
            stiffness,
            jump,
            order,
            floating,
            ..
        } = &self.parts;
        let pins = pins(stiffness, floating)?;
        let clock = Instant::now();
        let mut in_contact = vec![false; stiffness.size()];
        for &i in &self.rows().source {
            for (j, b) in jump.row(i) {
                in_contact[j] |= b != 0.0;
            }
        }
        let ordering = ordering::contact_last(stiffness, order, &in_contact);
        let ordering_s = clock.elapsed().as_secs_f64();
        let mut factor = Factor::new(stiffness, ordering, pins)?;
        factor.analysis_s += ordering_s;
        Ok(factor)
    }

    /// Rows that are condensed.
    pub(crate) fn rows(&self) -> RowSet {
        let components = if self.parts.frictionless {
            1
        } else {
            self.parts.dim
        };
        RowSet::new(self.parts.dim, &vec![components; self.points()])
    }

    /// The Delassus operator on [`rows`](Self::rows), computed unless it exists.
    pub(crate) fn condensed(&self) -> Result<Arc<Condensed>, MethodError> {
        let build = || {
            let factor = self.factor()?;
            let clock = Instant::now();
            let rows = self.rows();
            let w = delassus::condense(factor, &self.parts.jump, &rows.source)?;
            let condensed = Condensed::new(self, w, &rows)?;
            Ok((Arc::new(condensed), clock.elapsed().as_secs_f64()))
        };
        self.condensed
            .get_or_init(build)
            .as_ref()
            .map(|c| c.0.clone())
            .map_err(Clone::clone)
    }
}
