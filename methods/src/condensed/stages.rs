//! The two stages of alternating methods: contact laws point by point, and linear equilibrium along a fixed search
//! direction k₀.
//! ```text
//! local:   z = P − k₀ v,  P̂ = Π(z),  v̂ = (P̂ − z)/k₀
//! global:  (I + k₀ W) P + k₀ Q β = P̂ + k₀ v̂ − k₀ q,   Qᵀ P = c
//! ```
//! LATIN iterates them. The Newton methods take a few of them where their tangent is singular: the global stage is
//! regular whatever the points do.

use std::sync::Arc;

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, MatMut, Side};

use crate::algebra::delassus::Delassus;
use crate::algebra::dense::{DenseLu, along, dot, refill, solve_dense};
use crate::algebra::sparse::SparseLu;
use crate::algebra::spectrum::extremes;
use crate::condensed::branches::Branches;
use crate::condensed::pair::Pair;
use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::condensed::whole_body::WholeBody;
use crate::contract::operator::ContactOperator;
use crate::error::MethodError;

/// Relaxation of the sweeps that rescue a Newton method.
const RESCUE_RELAXATION: f64 = 0.8;
/// Their number at the first rescue of an increment; each further one takes twice as many, so that it ends closer to the
/// solution than the one that was not enough.
const RESCUE_SWEEPS: usize = 20;

/// Factors of I + k₀ W.
enum Factor {
    Cholesky(Llt<f64>),
    /// Where W is not symmetric, or symmetric and indefinite beyond 1/k₀.
    Lu(DenseLu),
    /// Where few entries of W are not 0.
    Sparse(Box<SparseLu>),
}

impl Factor {
    /// Of I + k₀ W; `None` if it is singular.
    fn new(w: &dyn Delassus, k0: f64) -> Option<Self> {
        if let Some(w) = w.sparse() {
            return w.shifted(k0).map(|lu| Self::Sparse(Box::new(lu)));
        }
        let mut a = w.to_matrix();
        for j in 0..a.ncols() {
            let column = a.col_as_slice_mut(j);
            column.iter_mut().for_each(|w| *w *= k0);
            column[j] += 1.0;
        }
        let cholesky = (w.symmetric())
            .then(|| Llt::new(a.as_ref(), Side::Lower).ok())
            .flatten();
        match cholesky {
            Some(factor) => Some(Self::Cholesky(factor)),
            None => DenseLu::new(&a).map(Self::Lu),
        }
    }
}

/// The factored global stage, bordered by the rigid motions.
pub(crate) struct GlobalStage {
    operator: Arc<ContactOperator>,
    k0: f64,
    factor: Factor,
    /// (I + k₀ W)⁻¹ Q by column.
    border: Vec<Vec<f64>>,
    /// Qᵀ (I + k₀ W)⁻¹ Q.
    schur: Mat<f64>,
}

impl GlobalStage {
    /// k₀ = `multiple`/√(w_min w_max).
    pub fn new(operator: Arc<ContactOperator>, multiple: f64) -> Result<Self, MethodError> {
        let k0 = multiple * best_direction(&operator);
        Self::along(operator, k0)
    }

    /// With the given k₀ in N/m.
    pub fn along(operator: Arc<ContactOperator>, k0: f64) -> Result<Self, MethodError> {
        let factor = Factor::new(&*operator.w, k0).ok_or_else(|| MethodError::Refused {
            reason: "I + k0 W is singular: W is not positive semi-definite".into(),
        })?;
        let column = |q: &Vec<f64>| {
            let mut column = Vec::new();
            apply(&factor, q, &mut column);
            column
        };
        let border: Vec<Vec<f64>> = operator.modes.q.iter().map(column).collect();
        let schur = Mat::from_fn(border.len(), border.len(), |i, j| {
            dot(&operator.modes.q[i], &border[j])
        });
        Ok(Self {
            operator,
            k0,
            factor,
            border,
            schur,
        })
    }

    /// k₀ in N/m.
    pub fn k0(&self) -> f64 {
        self.k0
    }

    /// Whether the stage was made for this operator.
    pub fn belongs_to(&self, operator: &Arc<ContactOperator>) -> bool {
        Arc::ptr_eq(&self.operator, operator)
    }

    /// The pair with P + k₀ v = `target`, in place of what `new` holds; false if the rigid motions move no row.
    pub fn global_stage(
        &self,
        problem: &ContactProblem<'_>,
        target: &[f64],
        new: &mut Pair,
    ) -> bool {
        let Pair { p, v, beta } = new;
        // The right-hand side stands where v will.
        let rows = target.iter().zip(&problem.q);
        refill(v, rows.map(|(t, q)| t - self.k0 * q));
        apply(&self.factor, v, p);
        let excess: Vec<f64> = problem.missing(p).iter().map(|c| -c).collect();
        let Some(k0_beta) = solve_dense(self.schur.clone(), &excess) else {
            return false;
        };
        for (column, b) in self.border.iter().zip(&k0_beta) {
            p.iter_mut().zip(column).for_each(|(p, c)| *p -= b * c);
        }
        let rows = target.iter().zip(&*p);
        refill(v, rows.map(|(t, p)| (t - p) / self.k0));
        refill(beta, k0_beta.iter().map(|b| b / self.k0));
        true
    }
}

/// A pair out of the reach of a singular tangent or a cycle: sweeps of both stages from the start of the increment.
///
/// Not from the iterate that failed: a floating block it has pushed far down a slope slides on from there.
pub(crate) fn rescue(problem: &mut ContactProblem<'_>) -> Result<Option<Pair>, MethodError> {
    alternate(problem, RESCUE_SWEEPS << problem.earlier_rescues())
}

/// That many sweeps of both stages from the start of the increment; `None` if the rigid motions move no row. Where W is
/// not formed, neither is I + k₀ W: the matrix of the whole body takes its place.
fn alternate(problem: &mut ContactProblem<'_>, sweeps: usize) -> Result<Option<Pair>, MethodError> {
    let (mut pair, mut new) = (Pair::start(problem), Pair::default());
    let (mut branches, mut target) = (Branches::default(), Vec::new());
    let k0 = best_direction(&problem.operator);
    if problem.operator.w.formed() {
        let stage = GlobalStage::along(problem.operator.clone(), k0)?;
        problem.counters.factorisations += 1;
        for _ in 0..sweeps {
            local_stage(k0, problem, &pair, &mut branches, &mut target);
            if !stage.global_stage(problem, &target, &mut new) {
                return Ok(None);
            }
            pair.relax(problem, RESCUE_RELAXATION, &new);
        }
        return Ok(Some(pair));
    }
    let mut body = WholeBody::new(problem.increment.system)?;
    for _ in 0..sweeps {
        local_stage(k0, problem, &pair, &mut branches, &mut target);
        let mut rows = stage_rows(k0, problem, &pair, &target);
        let Some(step) = body.step(problem, &pair.p, &mut rows)? else {
            return Ok(None);
        };
        let (p, beta) = (
            along(&pair.p, 1.0, &step.p),
            along(&pair.beta, 1.0, &step.beta),
        );
        let v = problem.jump(&p, &beta);
        pair.relax(problem, RESCUE_RELAXATION, &Pair { p, v, beta });
    }
    Ok(Some(pair))
}

/// The best k₀ in N/m, 1/√(w_min w_max). A body that is rigid at its contact points has none; ρ still has the right units.
fn best_direction(operator: &ContactOperator) -> f64 {
    let mean = |(least, most): (f64, f64)| match least * most {
        square if square.is_normal() => square.sqrt(),
        // Out of the range of numbers.
        _ => least.sqrt() * most.sqrt(),
    };
    extremes(&*operator.w, &operator.modes).map_or(operator.rho, |both| 1.0 / mean(both))
}

/// P̂ + k₀ v̂ = 2 P̂ − z by row, in place of what `target` holds; how many points changed their branch.
pub(crate) fn local_stage(
    k0: f64,
    problem: &mut ContactProblem<'_>,
    pair: &Pair,
    branches: &mut Branches,
    target: &mut Vec<f64>,
) -> usize {
    problem.counters.local_solves += problem.rows.points();
    let changes = branches.map(problem, k0, &pair.p, &pair.v);
    let rows = branches.image.iter().zip(&pair.p).zip(&pair.v);
    refill(
        target,
        rows.map(|((p_hat, p), v)| 2.0 * p_hat - (p - k0 * v)),
    );
    changes
}

/// The global stage as rows of a step of the whole body: δP + k₀ δv = target − P − k₀ v.
fn stage_rows(
    k0: f64,
    problem: &ContactProblem<'_>,
    pair: &Pair,
    target: &[f64],
) -> Vec<[PointRow; 3]> {
    let of_point = |own: std::ops::Range<usize>| {
        let mut rows = PointRow::reading([0.0; 3]);
        for (l, k) in own.enumerate() {
            rows[l].a[l] = 1.0;
            rows[l].c[l] = k0;
            rows[l].h = pair.p[k] + k0 * pair.v[k] - target[k];
        }
        rows
    };
    problem.rows.iter().map(of_point).collect()
}

/// x := (I + k₀ W)⁻¹ b; NaN, which no judge accepts, where it left the finite range.
fn apply(factor: &Factor, b: &[f64], x: &mut Vec<f64>) {
    let finite = match factor {
        Factor::Cholesky(factor) => {
            b.clone_into(x);
            factor.solve_in_place(MatMut::from_column_major_slice_mut(x, b.len(), 1));
            true
        }
        Factor::Lu(factor) => factor.solve_into(b, x),
        Factor::Sparse(factor) => factor.solve_into(b, x),
    };
    if !finite {
        x.fill(f64::NAN);
    }
}
