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

use crate::algebra::dense::solve_dense;
use crate::algebra::factor::kernel;
use crate::algebra::floating::dot;
use crate::algebra::spectrum::extremes;
use crate::condensed::problem::Reduced;
use crate::contract::law::{Branch, return_map};
use crate::contract::operator::Condensed;
use crate::error::MethodError;

/// Relaxation of the sweeps that rescue a Newton method.
const RESCUE_RELAXATION: f64 = 0.8;
/// Their number at the first rescue of an increment; each further one takes twice as many, so that it ends closer to the
/// solution than the one that was not enough.
const RESCUE_SWEEPS: usize = 20;

/// Contact forces, jump rows and rigid amplitudes that fulfil equilibrium.
pub(crate) struct Pair {
    pub p: Vec<f64>,
    pub v: Vec<f64>,
    pub beta: Vec<f64>,
}

impl Pair {
    /// The pair every method starts from.
    pub fn start(problem: &Reduced<'_>) -> Self {
        let p = problem.start_forces();
        let beta = problem.start_amplitudes(&p);
        Self {
            v: problem.jump(&p, &beta),
            p,
            beta,
        }
    }

    /// self += ω (new − self).
    pub fn relax(&mut self, problem: &Reduced<'_>, omega: f64, new: &Pair) {
        let step = |x: &mut [f64], new: &[f64]| {
            x.iter_mut()
                .zip(new)
                .for_each(|(x, new)| *x += omega * (new - *x));
        };
        step(&mut self.p, &new.p);
        step(&mut self.v, &new.v);
        step(&mut self.beta, &new.beta);
        problem.rebalance(&mut self.p);
    }
}

/// The factored global stage, bordered by the rigid motions.
pub(crate) struct GlobalStage {
    condensed: Arc<Condensed>,
    k0: f64,
    /// Cholesky factor of I + k₀ W.
    factor: Llt<f64>,
    /// (I + k₀ W)⁻¹ Q by column.
    border: Vec<Vec<f64>>,
    /// Qᵀ (I + k₀ W)⁻¹ Q.
    schur: Mat<f64>,
}

impl GlobalStage {
    /// k₀ = `multiple`/√(w_min w_max).
    pub fn new(condensed: Arc<Condensed>, multiple: f64) -> Result<Self, MethodError> {
        // A body that is rigid at its contact points has no best direction; ρ still has the right units.
        let best = extremes(&condensed.w, &condensed.modes)
            .map_or(condensed.rho, |(least, most)| 1.0 / (least * most).sqrt());
        Self::along(condensed, multiple * best)
    }

    /// With the given k₀ in N/m.
    pub fn along(condensed: Arc<Condensed>, k0: f64) -> Result<Self, MethodError> {
        let w = &condensed.w;
        let m = w.nrows();
        let a = Mat::from_fn(m, m, |i, j| k0 * w[(i, j)] + f64::from(u8::from(i == j)));
        let factor = Llt::new(a.as_ref(), Side::Lower)
            .map_err(|e| kernel("factorisation of I + k0 W", format!("{e:?}")))?;
        let border: Vec<Vec<f64>> = condensed
            .modes
            .q
            .iter()
            .map(|q| apply(&factor, q.clone()))
            .collect();
        let schur = Mat::from_fn(border.len(), border.len(), |i, j| {
            dot(&condensed.modes.q[i], &border[j])
        });
        Ok(Self {
            condensed,
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
    pub fn belongs_to(&self, condensed: &Arc<Condensed>) -> bool {
        Arc::ptr_eq(&self.condensed, condensed)
    }

    /// P̂ + k₀ v̂ = 2 P̂ − z by row, and the branch of each point.
    pub fn local_stage(&self, problem: &mut Reduced<'_>, pair: &Pair) -> (Vec<f64>, Vec<Branch>) {
        problem.counters.local_solves += problem.rows.points();
        let z: Vec<f64> = pair
            .p
            .iter()
            .zip(&pair.v)
            .map(|(p, v)| p - self.k0 * v)
            .collect();
        let mut p_hat = z.clone();
        let branches = (0..problem.rows.points())
            .map(|i| return_map(problem.friction(i), &mut p_hat[problem.rows.of(i)]))
            .collect();
        (
            p_hat.iter().zip(&z).map(|(p, z)| 2.0 * p - z).collect(),
            branches,
        )
    }

    /// The pair with P + k₀ v = `target`; `None` if the rigid motions move no row.
    pub fn global_stage(&self, problem: &Reduced<'_>, target: &[f64]) -> Option<Pair> {
        let rhs = target
            .iter()
            .zip(&problem.q)
            .map(|(t, q)| t - self.k0 * q)
            .collect();
        let mut p = apply(&self.factor, rhs);
        let excess: Vec<f64> = problem.missing(&p).iter().map(|c| -c).collect();
        let k0_beta = solve_dense(&self.schur, &excess)?;
        for (column, b) in self.border.iter().zip(&k0_beta) {
            p.iter_mut().zip(column).for_each(|(p, c)| *p -= b * c);
        }
        let v = target
            .iter()
            .zip(&p)
            .map(|(t, p)| (t - p) / self.k0)
            .collect();
        Some(Pair {
            p,
            v,
            beta: k0_beta.iter().map(|b| b / self.k0).collect(),
        })
    }
}

/// A pair out of the reach of a singular tangent or a cycle: sweeps of both stages from the start of the increment.
///
/// Not from the iterate that failed: a floating block it has pushed far down a slope slides on from there.
pub(crate) fn rescue(problem: &mut Reduced<'_>) -> Result<Option<Pair>, MethodError> {
    alternate(problem, RESCUE_SWEEPS << problem.earlier_rescues())
}

/// That many sweeps of both stages from the start of the increment; `None` if the rigid motions move no row.
pub(crate) fn alternate(
    problem: &mut Reduced<'_>,
    sweeps: usize,
) -> Result<Option<Pair>, MethodError> {
    let mut pair = Pair::start(problem);
    let stage = GlobalStage::new(problem.condensed.clone(), 1.0)?;
    problem.counters.factorisations += 1;
    for _ in 0..sweeps {
        let (target, _) = stage.local_stage(problem, &pair);
        let Some(new) = stage.global_stage(problem, &target) else {
            return Ok(None);
        };
        pair.relax(problem, RESCUE_RELAXATION, &new);
    }
    Ok(Some(pair))
}

fn apply(factor: &Llt<f64>, mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len();
    factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut x, n, 1));
    x
}
