//! The elastic body: K, B and the rigid motions, factored once and condensed once, whatever happens at the contact.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use crate::algebra::condensation::Tractions;
use crate::algebra::delassus::Delassus;
use crate::algebra::factor::Factor;
use crate::algebra::floating::ModeJumps;
use crate::algebra::loads::Loads;
use crate::algebra::matrix::{JumpOperator, SquareMatrix};
use crate::algebra::multifrontal::Analysis;
use crate::algebra::rows::RowSet;
use crate::algebra::spectrum::rank;
use crate::algebra::stiffness::{DelassusOnly, SparseStiffness, Stiffness};
use crate::contract::body_work::{ElasticCost, ElasticCounters, ElasticTimings};
use crate::contract::operator::ContactOperator;
use crate::error::{MethodError, check_finite, check_len, check_positive};

/// Product of a discretisation.
#[derive(Debug, Clone)]
pub struct ElasticParts {
    /// Space dimension, 2 or 3.
    pub dim: usize,
    /// Stiffness K with supports eliminated, n × n, semi-definite with kernel `floating`. In N/m, in 2D N/m².
    pub stiffness: SquareMatrix,
    /// Jump operator B, `dim` rows per contact point, n columns; dimensionless.
    pub jump: JumpOperator,
    /// Tributary area (2D: length) per contact point, > 0, in m² (m).
    pub weight: Vec<f64>,
    /// Preferred fill-reducing elimination order of the n unknowns, a permutation.
    pub order: Vec<usize>,
    /// Basis of the kernel of K: the rigid motions left by the supports, n entries each; empty if K is definite.
    pub floating: Vec<Vec<f64>>,
    /// Promise by point that no run will ever have friction there: of these only normal rows are condensed. Empty: no promise.
    pub frictionless: Vec<bool>,
    /// Traction operator S, for the methods that need one: S u is the contact force on side 1 that the stress of the
    /// bulk implies at every contact point, rows as in `jump`, in N per m of displacement (2D: N/m²).
    pub traction: Option<JumpOperator>,
}

/// What is computed on first use.
type Shared<T> = OnceLock<Result<T, MethodError>>;

/// The elastic body, shared by all systems on it through an [`Arc`]. The factor of K and the Delassus operator are
/// computed on first use.
pub struct Elastic {
    dim: usize,
    stiffness: Box<dyn Stiffness>,
    jump: JumpOperator,
    weight: Vec<f64>,
    floating: Vec<Vec<f64>>,
    frictionless: Vec<bool>,
    traction: Option<JumpOperator>,
    diagonal: Shared<Vec<f64>>,
    delassus: Shared<(Arc<dyn Delassus>, f64)>,
    condensed: Shared<Arc<ContactOperator>>,
    tractions: Shared<(Arc<Tractions>, f64)>,
    loads: Loads,
    solves: AtomicUsize,
    on_body_ns: AtomicU64,
    products: AtomicUsize,
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
    /// A stiffness that is not symmetric, inconsistent sizes, non-finite or non-positive entries, an order that is no
    /// permutation, motions that are not rigid, dependent or without any jump.
    pub fn new(parts: ElasticParts) -> Result<Arc<Self>, MethodError> {
        let n = parts.stiffness.size();
        if !parts.stiffness.is_symmetric() {
            return Err(MethodError::UnsymmetricStiffness);
        }
        check_len("elimination order", parts.order.len(), n)?;
        let diagonal = (0..n).map(|j| parts.stiffness.diagonal(j));
        check_positive("stiffness diagonal", diagonal)?;
        check_permutation(&parts.order)?;
        check_contact(parts.dim, n, &parts.jump, &parts.weight, &parts.floating)?;
        if let Some(traction) = &parts.traction {
            check_len("traction operator rows", traction.rows(), parts.jump.rows())?;
            check_len("traction operator columns", traction.cols(), n)?;
        }
        if !parts.frictionless.is_empty() {
            check_len(
                "frictionless points",
                parts.frictionless.len(),
                parts.weight.len(),
            )?;
        }
        let moved = in_contact(&parts.jump, parts.dim, &parts.frictionless);
        let stiffness =
            SparseStiffness::new(parts.stiffness, parts.order, &moved, &parts.floating)?;
        check_motions(&parts.jump, &parts.floating)?;
        Ok(Arc::new(Self {
            frictionless: parts.frictionless,
            traction: parts.traction,
            ..Self::behind(
                Box::new(stiffness),
                parts.dim,
                parts.jump,
                parts.weight,
                parts.floating,
            )
        }))
    }

    /// A body known at its contact points only, by its Delassus operator W (`dim` rows per point, in m/N) and the
    /// jumps `floating` of its rigid motions, one vector each. Its unknowns u are the jumps of the contact points:
    /// u = W (f + P) + R α, and a load carries the free jump q as its offset.
    ///
    /// W need not be symmetric: then it acts on forces as it stands, row by row, and methods that need a symmetric one [refuse](crate::Needs::refuses) it.
    ///
    /// # Errors
    /// Inconsistent sizes, negative diagonal entries, non-finite values.
    pub fn from_delassus(
        dim: usize,
        w: SquareMatrix,
        floating: Vec<Vec<f64>>,
    ) -> Result<Arc<Self>, MethodError> {
        let m = w.size();
        if let Some(index) = (0..m).find(|&j| w.diagonal(j) < 0.0) {
            return Err(MethodError::range(
                "Delassus operator diagonal",
                index,
                w.diagonal(index),
                "not negative",
            ));
        }
        let (jump, weight) = (JumpOperator::identity(m), vec![1.0; m / dim.max(1)]);
        check_contact(dim, m, &jump, &weight, &floating)?;
        check_motions(&jump, &floating)?;
        let stiffness = Box::new(DelassusOnly::new(w, &jump, &floating));
        Ok(Arc::new(Self::behind(
            stiffness, dim, jump, weight, floating,
        )))
    }

    fn behind(
        stiffness: Box<dyn Stiffness>,
        dim: usize,
        jump: JumpOperator,
        weight: Vec<f64>,
        floating: Vec<Vec<f64>>,
    ) -> Self {
        Self {
            dim,
            stiffness,
            jump,
            weight,
            floating,
            frictionless: Vec::new(),
            traction: None,
            diagonal: OnceLock::new(),
            delassus: OnceLock::new(),
            condensed: OnceLock::new(),
            tractions: OnceLock::new(),
            loads: Loads::default(),
            solves: AtomicUsize::new(0),
            on_body_ns: AtomicU64::new(0),
            products: AtomicUsize::new(0),
        }
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
        self.stiffness.unknowns()
    }

    /// Stiffness K; `None` if only the Delassus operator is known.
    pub fn stiffness(&self) -> Option<&SquareMatrix> {
        self.stiffness.matrix()
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

    /// Whether only the normal row of a point is ever condensed.
    pub fn frictionless(&self, point: usize) -> bool {
        self.frictionless.get(point).is_some_and(|own| *own)
    }

    /// max |w_ij − w_ji| / max |w_ij| of the Delassus operator W that was given; 0 where W comes from a stiffness.
    pub fn asymmetry(&self) -> f64 {
        self.stiffness.asymmetry()
    }

    /// Whether the symmetric W that was given has an eigenvalue below −1e-9 times its largest entry; found out once, by one
    /// Cholesky factorisation. Never where W comes from a stiffness.
    pub fn indefinite(&self) -> bool {
        self.stiffness.indefinite()
    }

    /// Work done so far.
    pub fn counters(&self) -> ElasticCounters {
        ElasticCounters {
            factorisations: self.stiffness.factorisations().0,
            solves: self.solves.load(Relaxed),
            products: self.products.load(Relaxed),
            condensations: usize::from(self.delassus.get().is_some()),
        }
    }

    /// What it takes until W is formed; `None` where only W is known.
    pub fn cost(&self) -> Option<ElasticCost> {
        let (Analysis { ordering, tree, .. }, analysis_s) = self.stiffness.plan()?;
        let rows = self.rows().source;
        let touched = |&i: &usize| -> Vec<usize> {
            let own = self.jump.touched(i);
            own.map(|e| ordering.inverse[e.0]).collect()
        };
        let touched: Vec<_> = rows.iter().map(touched).collect();
        Some(ElasticCost {
            factorisation: tree.work(),
            condensation: tree.condensation(&touched, !self.floating.is_empty()),
            entries: tree.entries(),
            rows: rows.len(),
            analysis_s: *analysis_s,
        })
    }

    /// Times of the work done so far.
    pub fn timings(&self) -> ElasticTimings {
        let (_, analysis_s, factorisation_s) = self.stiffness.factorisations();
        let condensed = self.delassus.get().and_then(|w| w.as_ref().ok());
        let tractions = self.tractions.get().and_then(|t| t.as_ref().ok());
        ElasticTimings {
            analysis_s,
            factorisation_s,
            condensation_s: condensed.map_or(0.0, |c| c.1),
            traction_s: tractions.map_or(0.0, |t| t.1),
            on_body_s: 1e-9 * self.on_body_ns.load(Relaxed) as f64,
        }
    }

    /// The factor of K, computed on first use.
    pub(crate) fn factor(&self) -> Result<&Factor, MethodError> {
        self.stiffness.factor()
    }

    /// Factors K unless that is done.
    ///
    /// # Errors
    /// K not positive definite apart from the given rigid motions; out of memory.
    pub fn factorise(&self) -> Result<(), MethodError> {
        self.stiffness.factorise()
    }

    /// Factors K on some unknowns, ascending, with all others held, and keeps nothing of it: whether it is positive definite there.
    ///
    /// # Errors
    /// An unknown of the body at which it is not; out of memory.
    pub fn try_part(&self, own: &[usize]) -> Result<(), MethodError> {
        self.stiffness.try_part(own)
    }

    /// Solves K x = f in place, with iterative refinement. Where the body floats, f must balance (Rᵀ f = 0) and the
    /// solution is the one with the pinned unknowns at 0.
    ///
    /// # Errors
    /// Wrong length; the errors of the first factorisation.
    pub fn solve(&self, x: &mut [f64]) -> Result<(), MethodError> {
        check_len("right-hand side", x.len(), self.unknowns())?;
        self.stiffness.solve(x)?;
        self.solves.fetch_add(1, Relaxed);
        Ok(())
    }

    /// Displacements of a load without contact forces, as [`solve`](Self::solve) gives them: once a load, however many methods and
    /// judges ask; the last loads are kept.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    pub fn free(&self, force: &[f64]) -> Result<Arc<Vec<f64>>, MethodError> {
        self.loads.solved(force, |u| self.solve(u))
    }

    /// Counts the time of a call as that of work on all unknowns of the body, once K is factored.
    ///
    /// # Errors
    /// Those of the factorisation.
    pub fn on_body<T>(&self, call: impl FnOnce() -> T) -> Result<T, MethodError> {
        self.factorise()?;
        let clock = Instant::now();
        let value = call();
        let spent = u64::try_from(clock.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.on_body_ns.fetch_add(spent, Relaxed);
        Ok(value)
    }

    /// Backward error of equilibrium between displacements and the sum of some forces.
    pub(crate) fn imbalance(&self, u: &[f64], forces: &[&[f64]]) -> f64 {
        self.stiffness.imbalance(u, forces)
    }

    /// The body seen from some rows, `w` the Delassus operator on them.
    pub(crate) fn operator(
        &self,
        rows: &RowSet,
        w: Arc<dyn Delassus>,
    ) -> Result<ContactOperator, MethodError> {
        let (jump, rows) = (&self.jump, &rows.source);
        let local = self.stiffness.local_compliance(jump, rows);
        let stiffest = self.stiffness.stiffest_compliance(jump, rows);
        let modes = ModeJumps::new(jump, rows, &self.floating);
        ContactOperator::new(w, modes, local, stiffest)
    }

    /// Rows that are condensed.
    pub(crate) fn rows(&self) -> RowSet {
        condensed_rows(self.dim, self.points(), &self.frictionless)
    }

    /// The diagonal of W on some of [`rows`](Self::rows). W is not formed for it.
    pub(crate) fn diagonal(&self, rows: &RowSet) -> Result<Vec<f64>, MethodError> {
        let all = self.rows();
        let build = || self.stiffness.compliances(&self.jump, &all.source);
        let diagonal = self.diagonal.get_or_init(build);
        let diagonal = diagonal.as_ref().map_err(Clone::clone)?;
        let places = rows.positions_in(&all);
        Ok(places.into_iter().map(|k| diagonal[k]).collect())
    }

    /// v += W p on some rows by one solve; W is not formed for it.
    pub(crate) fn product_add(&self, rows: &RowSet, p: &[f64], v: &mut [f64]) {
        let mut u = vec![0.0; self.unknowns()];
        let all = self.jump.rows();
        (self.jump).mul_transpose_add(&rows.extend(p, all), &mut u);
        self.products.fetch_add(1, Relaxed);
        if self.stiffness.solve(&mut u).is_err() {
            // Only a body that cannot be factored, or no memory for a vector: what no judge accepts.
            v.fill(f64::NAN);
            return;
        }
        let mut jump = vec![0.0; all];
        self.jump.mul(&u, &mut jump);
        let moved = rows.source.iter().map(|&i| jump[i]);
        v.iter_mut().zip(moved).for_each(|(v, jump)| *v += jump);
    }

    /// |W| |p|, entry by entry, on some rows, where W was given: one product.
    pub(crate) fn product_abs(&self, rows: &RowSet, p: &[f64]) -> Option<Vec<f64>> {
        let all = self
            .stiffness
            .product_abs(&rows.extend(p, self.jump.rows()))?;
        Some(rows.restrict(&all))
    }

    /// W on [`rows`](Self::rows), formed unless it exists.
    pub(crate) fn formed(&self) -> Result<Arc<dyn Delassus>, MethodError> {
        let build = || {
            self.factorise()?;
            let clock = Instant::now();
            let rows = self.rows();
            let (w, diagonal) = self.stiffness.delassus(&self.jump, &rows.source)?;
            self.diagonal.get_or_init(|| Ok(diagonal));
            Ok((w, clock.elapsed().as_secs_f64()))
        };
        let formed = self.delassus.get_or_init(build).as_ref();
        formed.map(|w| w.0.clone()).map_err(Clone::clone)
    }

    /// The operator on [`rows`](Self::rows) with W formed, shared by all systems that use them all.
    pub(crate) fn condensed(&self) -> Result<Arc<ContactOperator>, MethodError> {
        let build = || {
            let operator = self.operator(&self.rows(), self.formed()?)?;
            Ok(Arc::new(operator))
        };
        self.condensed.get_or_init(build).clone()
    }

    /// Numerical rank of the Delassus operator, formed unless it exists: singular values above 1e-10 of the largest. Where it
    /// is less than the number of rows, contact points are redundant. `None` if the decomposition fails. Takes time with the
    /// third power of the rows.
    ///
    /// # Errors
    /// Those of the first factorisation and condensation.
    pub fn rank(&self) -> Result<Option<usize>, MethodError> {
        Ok(rank(&*self.formed()?))
    }

    /// The condensed traction operator on [`rows`](Self::rows), computed unless it exists.
    pub(crate) fn tractions(&self) -> Result<Arc<Tractions>, MethodError> {
        let build = || {
            self.factorise()?;
            let clock = Instant::now();
            let s = self.traction().ok_or(MethodError::NoTraction)?;
            let rows = self.rows().source;
            let tractions = self.stiffness.tractions(s, &self.jump, &rows)?;
            self.solves.fetch_add(rows.len(), Relaxed);
            Ok((Arc::new(tractions), clock.elapsed().as_secs_f64()))
        };
        let tractions = self.tractions.get_or_init(build).as_ref();
        tractions.map(|t| t.0.clone()).map_err(Clone::clone)
    }
}

/// All rows of every point, or the normal ones where there will be no friction.
fn condensed_rows(dim: usize, points: usize, frictionless: &[bool]) -> RowSet {
    let of = |i| match frictionless.get(i) {
        Some(true) => 1,
        _ => dim,
    };
    RowSet::new(dim, &(0..points).map(of).collect::<Vec<_>>())
}

/// The unknowns that move a contact point.
fn in_contact(jump: &JumpOperator, dim: usize, frictionless: &[bool]) -> Vec<bool> {
    let mut moved = vec![false; jump.cols()];
    let rows = condensed_rows(dim, jump.rows() / dim, frictionless);
    let entries = rows.source.iter().flat_map(|&i| jump.touched(i));
    entries.for_each(|(j, _)| moved[j] = true);
    moved
}

/// Refuses an order that is none.
fn check_permutation(order: &[usize]) -> Result<(), MethodError> {
    let mut seen = vec![false; order.len()];
    for (index, &j) in order.iter().enumerate() {
        if j >= order.len() || std::mem::replace(&mut seen[j], true) {
            return Err(MethodError::pattern(
                "elimination order",
                index,
                "not a permutation of the unknowns",
            ));
        }
    }
    Ok(())
}

/// Demands on bodies of any kind.
fn check_contact(
    dim: usize,
    unknowns: usize,
    jump: &JumpOperator,
    weight: &[f64],
    floating: &[Vec<f64>],
) -> Result<(), MethodError> {
    if !(dim == 2 || dim == 3) {
        return Err(MethodError::range("dimension", 0, dim as f64, "2 or 3"));
    }
    check_len("jump operator rows", jump.rows(), dim * weight.len())?;
    check_len("jump operator columns", jump.cols(), unknowns)?;
    check_positive("weight", weight.iter().copied())?;
    for mode in floating {
        check_len("floating mode", mode.len(), unknowns)?;
        check_finite("floating mode", mode)?;
    }
    Ok(())
}

/// Refuses rigid motions that no contact law can hold.
fn check_motions(jump: &JumpOperator, floating: &[Vec<f64>]) -> Result<(), MethodError> {
    let all: Vec<usize> = (0..jump.rows()).collect();
    match ModeJumps::new(jump, &all, floating).free {
        0 => Ok(()),
        modes => Err(MethodError::FreeRigidMotion { modes }),
    }
}
