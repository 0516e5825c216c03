//! LATIN method: local and global stages in turn.
//!
//! Ladevèze, Nonlinear Computational Structural Mechanics (1999); on cracks in XFEM: Dolbow, Moës & Belytschko,
//! Comput. Meth. Appl. Mech. Engng 190 (2001) 6825.
//!
//! ```text
//! local stage,   at each point:  z = P − k₀ v                   search direction +k₀
//!                                P̂_n = max(z_n, 0),  P̂_t = proj_{|·| <= μ P̂_n}(z_t),  v̂ = (P̂ − z)/k₀
//! global stage,  all points:     P + k₀ v = P̂ + k₀ v̂,  v = q + W P + Q β,  Qᵀ P = c      search direction −k₀
//!                                (I + k₀ W) P + k₀ Q β = P̂ + k₀ v̂ − k₀ q
//! relaxation:                    (P, v) <- (P, v) + ω (new − old)
//! ```
//! The local pair (P̂, v̂) fulfils the contact laws, the global pair (P, v) equilibrium; both meet at the solution.
//! I + k₀ W never changes and is factored once per system.
//!
//! # Options
//! `search_direction`: k₀ as a multiple of 1/√(w_min w_max), which minimises the contraction of the linear part,
//! max |1 − k₀ w|/(1 + k₀ w) over the eigenvalues w of W. w_min and w_max come from 60 Lanczos steps; eigenvalues
//! below 1e-4 w_max (redundant contact points) do not count. `relaxation`: ω; 1/2 is Douglas–Rachford, 1
//! Peaceman–Rachford. `max_iterations`.
//!
//! # Guarantees
//! Convergence for monotone laws (no friction, or Tresca) and ω < 1. For Coulomb friction there is no proof; the
//! iteration count hardly depends on μ in practice.
//!
//! # Failure modes
//! Slow far from the best k₀ (times ten in iterations for a factor of ten), and on ill-conditioned W.

use std::sync::Arc;

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, MatMut, Side};

use crate::problem::condensed::Condensed;
use crate::problem::law::{Branch, return_map};
use crate::problem::linear::dense::solve_dense;
use crate::problem::linear::factor::kernel;
use crate::problem::linear::floating::dot;
use crate::problem::linear::spectrum::extremes;
use crate::problem::reduced::{Begin, Reduced};
use crate::{
    Claim, ContactSystem, Enforcement, Increment, Iteration, Method, MethodError, Monitor,
    OptionSpec, Options, Outcome, Status,
};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "latin",
    label: "LATIN",
    reference: "Dolbow, Moës & Belytschko, Comput. Meth. Appl. Mech. Engng 190 (2001) 6825",
    summary: "alternates the contact laws point by point with linear equilibrium along fixed search directions",
    exact: true,
    options: &OPTIONS,
    build: |options| Ok(Box::new(Latin::new(options))),
};

static OPTIONS: [OptionSpec; 3] = [
    OptionSpec {
        name: "search_direction",
        unit: "-",
        default: 1.0,
        min: 1e-3,
        max: 1e3,
        integer: false,
        help: "search direction k0 as a multiple of 1/sqrt(w_min w_max), extreme eigenvalues of W",
    },
    OptionSpec {
        name: "relaxation",
        unit: "-",
        default: 0.8,
        min: 0.1,
        max: 1.0,
        integer: false,
        help: "relaxation of the global stage",
    },
    OptionSpec {
        name: "max_iterations",
        unit: "-",
        default: 20_000.0,
        min: 1.0,
        max: 1e7,
        integer: true,
        help: "pairs of stages before giving up",
    },
];

struct Latin {
    search_direction: f64,
    relaxation: f64,
    max_iterations: usize,
    global: Option<GlobalStage>,
}

impl Latin {
    fn new(options: &Options) -> Self {
        Self {
            search_direction: options.own("search_direction"),
            relaxation: options.own("relaxation"),
            max_iterations: options.own("max_iterations") as usize,
            global: None,
        }
    }

    /// The global stage of a system; kept for as long as the system stays the same.
    fn stage(&mut self, system: &ContactSystem) -> Result<(&GlobalStage, bool), MethodError> {
        let condensed = system.condensed()?;
        let cached = self
            .global
            .take()
            .filter(|stage| Arc::ptr_eq(&stage.condensed, &condensed));
        let fresh = cached.is_none();
        let stage = match cached {
            Some(stage) => stage,
            None => GlobalStage::new(condensed, self.search_direction)?,
        };
        Ok((self.global.insert(stage), fresh))
    }
}

impl Enforcement for Latin {
    fn prepare(&mut self, system: &ContactSystem) -> Result<(), MethodError> {
        self.stage(system).map(|_| ())
    }

    fn solve(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        let mut problem = match Reduced::begin(increment, |_| Claim::Exact)? {
            Begin::Done(outcome) => return Ok(outcome),
            Begin::Contact(problem) => problem,
        };
        let (relaxation, max_iterations) = (self.relaxation, self.max_iterations);
        let (global, fresh) = self.stage(increment.system)?;
        problem.counters.factorisations += usize::from(fresh);
        let mut p = problem.start_forces();
        let mut beta = problem.start_amplitudes(&p);
        let mut v = problem.jump(&p, &beta);
        let mut before: Vec<Branch> = Vec::new();
        let mut changes = 0;

        let status = loop {
            let mut natural_map = problem.natural_map(&p, &v);
            if natural_map <= problem.stop {
                // The relaxed v carries the rounding of all stages before: claim nothing without a fresh one.
                v = problem.jump(&p, &beta);
                natural_map = problem.natural_map(&p, &v);
            }
            problem.history.push(Iteration {
                natural_map,
                changes,
            });
            if natural_map <= problem.stop {
                break Status::Converged;
            }
            let iteration = problem.counters.iterations;
            if !natural_map.is_finite() {
                break Status::Diverged;
            }
            if !monitor.step(iteration, natural_map) {
                break Status::Stopped;
            }
            if iteration == max_iterations {
                break Status::MaxIterations;
            }
            problem.counters.iterations += 1;

            let (target, branches) = local_stage(&mut problem, global.k0, &p, &v);
            changes = branches.iter().zip(&before).filter(|(a, b)| a != b).count();
            before = branches;
            let Some((new_p, new_beta)) = global.solve(&problem, &target) else {
                break problem.singular();
            };
            for k in 0..p.len() {
                let new_v = (target[k] - new_p[k]) / global.k0;
                v[k] += relaxation * (new_v - v[k]);
                p[k] += relaxation * (new_p[k] - p[k]);
            }
            beta.iter_mut()
                .zip(&new_beta)
                .for_each(|(b, new)| *b += relaxation * (new - *b));
            problem.rebalance(&mut p);
        };
        problem.finish(status, &p, &beta)
    }
}

/// P̂ + k₀ v̂ = 2 P̂ − z by row, and the branch of each point.
fn local_stage(
    problem: &mut Reduced<'_>,
    k0: f64,
    p: &[f64],
    v: &[f64],
) -> (Vec<f64>, Vec<Branch>) {
    problem.counters.local_solves += problem.rows.points();
    let z: Vec<f64> = p.iter().zip(v).map(|(p, v)| p - k0 * v).collect();
    let mut p_hat = z.clone();
    let branches = (0..problem.rows.points())
        .map(|i| return_map(problem.friction(i), &mut p_hat[problem.rows.of(i)]))
        .collect();
    (
        p_hat.iter().zip(&z).map(|(p, z)| 2.0 * p - z).collect(),
        branches,
    )
}

/// The factored global stage, bordered by the rigid motions.
struct GlobalStage {
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
    fn new(condensed: Arc<Condensed>, multiple: f64) -> Result<Self, MethodError> {
        let w = &condensed.w;
        // A body that is rigid at its contact points has no best direction; ρ still has the right units.
        let best = extremes(w, &condensed.modes)
            .map_or(condensed.rho, |(least, most)| 1.0 / (least * most).sqrt());
        let k0 = multiple * best;
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

    /// (P, β) with (I + k₀ W) P + k₀ Q β = target − k₀ q and Qᵀ P = c.
    fn solve(&self, problem: &Reduced<'_>, target: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
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
        Some((p, k0_beta.iter().map(|b| b / self.k0).collect()))
    }
}

fn apply(factor: &Llt<f64>, mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len();
    factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut x, n, 1));
    x
}
