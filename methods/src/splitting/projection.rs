//! Projection: steps against the corrected jump, projected on Coulomb's cone.
//!
//! De Saxcé & Feng, Math. Comput. Modelling 28 (1998) 225; compared with other solvers by Acary, Brémond & Huber, in
//! Advanced Topics in Nonsmooth Dynamics (2018) 375. The step length: Khobotov, USSR Comput. Math. Math. Phys. 27 (1987)
//! 120; He & Liao, J. Optim. Theory Appl. 112 (2002) 111.
//!
//! ```text
//! ṽ(P, γ) = (g + μ|d|, d),  v = (g, d) = q' + W' P + Q γ            De Saxcé's correction
//!
//! γ <- γ + κ (Qᵀ P − c)                            bodies that float: method of multipliers
//! P <- P̄ = proj_{K_μ}(P − τ r ṽ(P, γ))
//!
//! step    l = τ |F(P̄, γ) − F(P, γ)| / |P̄ − P|,   F = (ṽ, c − Qᵀ P)
//!         l > 0.9: τ <- 2/3 τ min(1, 1/l) and P̄ again;   l < 0.3: τ <- 3/2 τ for the next step
//! ```
//! r = 1/mean(W'_ii) per point makes τ a number near 1; it is the same for both tangents, so that their frame does not matter.
//! The normal takes r/max(μ, 1): the correction μ|d| would otherwise dominate for large μ. That halves the iterations at
//! μ = 5, and with it μ = 50 converges at all. Norms and projections are those of this metric, |P|²/r and r |v|². W', q', γ:
//! `condensed/saddle.rs`.
//!
//! # Options
//! `max_iterations`.
//!
//! # Guarantees
//! Converges without friction for bodies that do not float, as projected gradients of a convex programme. With friction ṽ is
//! not monotone and there is no proof.
//!
//! # Failure modes
//! Slow, with plateaus of thousands of iterations: their number grows like the condition of W, and with μ. Of 200 of
//! those systems per μ one fails at μ = 2 and none else up to μ = 5, where the median is 621 iterations in 2D, 1130 in
//! 3D.
//!
//! # Skips
//! Nothing is factored. v follows P by columns of W', without those whose force did not change; it is computed afresh
//! only every now and then, and before anything is claimed.

use crate::algebra::dense::refill;
use crate::condensed::branches::changed;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{COMPLIANCE_FLOOR, ContactProblem, Limits};
use crate::condensed::saddle::{Iterate, REFRESH, Saddle};
use crate::contract::law::{Branch, project_cone, tangential_norm};
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::Monitor;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "projection",
    label: "Projection",
    reference: "De Saxce & Feng, Math. Comput. Modelling 28 (1998) 225",
    summary: "steps against the corrected jump and projects on Coulomb's cone, with a step length that adapts",
    exact: true,
    options: Projection::OPTIONS,
    source: include_str!("projection.rs"),
    build: |options| Box::new(Projection::new(options)),
};

options! {
    Projection {
        max_iterations: Count(100_000, 1, 100_000_000), "steps before giving up";
    }
}

/// Iterations without progress after which the iteration counts as stalled: at large μ plateaus of several thousand end in
/// convergence.
const PATIENCE: usize = 20_000;
/// l above which a step is repeated with a shorter τ.
const LARGEST: f64 = 0.9;
/// l below which τ grows.
const SMALLEST: f64 = 0.3;
/// Change of τ.
const SHRINK: f64 = 2.0 / 3.0;

impl CondensedMethod for Projection {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.max_iterations, PATIENCE);
        let step = Step::new(problem);
        let saddle = &step.saddle;
        let mut x = saddle.start(problem);
        let mut trial = Trial::default();
        let (mut tau, mut changes) = (1.0, 0);
        let mut before = vec![Branch::Open; problem.rows.points()];

        let status = loop {
            if let Some(status) = saddle.ends(problem, &mut x, changes, limits, monitor)? {
                break status;
            }
            saddle.update_multipliers(problem, &mut x);
            if problem.counters.iterations.is_multiple_of(REFRESH) {
                saddle.refresh(problem, &mut x);
            }
            let next_tau = step.adapted(problem, &x, &mut tau, &mut trial);
            changes = changed(&trial.branches, &before);
            std::mem::swap(&mut before, &mut trial.branches);
            std::mem::swap(&mut x, &mut trial.x);
            tau = next_tau;
        };
        let (p, beta) = saddle.balanced(problem, &x);
        let at = Forces { p, beta };
        Ok(End { status, at })
    }
}

/// Where a step ends.
#[derive(Default)]
struct Trial {
    /// (P̄, γ) and its v.
    x: Iterate,
    /// P̄ − P.
    dp: Vec<f64>,
    branches: Vec<Branch>,
}

/// Facts about the system that a step needs.
pub(crate) struct Step {
    pub saddle: Saddle,
    /// r by row, in N/m.
    pub r: Vec<f64>,
}

impl Step {
    /// Of the problem.
    pub fn new(problem: &ContactProblem<'_>) -> Self {
        let saddle = Saddle::new(problem.operator.clone());
        let floor = COMPLIANCE_FLOOR / problem.operator.rho;
        let mut r = vec![0.0; problem.len()];
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            let trace: f64 = saddle.w().diagonal()[rows.clone()].iter().sum();
            let mean = trace / rows.len() as f64;
            r[rows.clone()].fill(1.0 / mean.max(floor));
            r[rows.start] /= problem.friction(i).max(1.0);
        }
        Self { saddle, r }
    }

    /// The trial with `tau` shortened until l <= 0.9; returns the τ to begin the next step with.
    fn adapted(
        &self,
        problem: &mut ContactProblem<'_>,
        x: &Iterate,
        tau: &mut f64,
        trial: &mut Trial,
    ) -> f64 {
        loop {
            self.project(problem, x, *tau, trial);
            let l = *tau * self.lipschitz(problem, x, trial);
            if l < SMALLEST {
                return *tau / SHRINK;
            } else if l <= LARGEST || l.is_nan() {
                return *tau;
            }
            *tau *= SHRINK * f64::min(1.0, 1.0 / l);
        }
    }

    /// The step from `x`, in place of what `trial` holds.
    fn project(&self, problem: &mut ContactProblem<'_>, x: &Iterate, tau: f64, trial: &mut Trial) {
        problem.counters.local_solves += problem.rows.points();
        let Trial {
            x: Iterate { p, gamma, v },
            dp,
            branches,
        } = trial;
        p.clone_from(&x.p);
        branches.clear();
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            let mu = problem.friction(i);
            for k in rows.clone() {
                p[k] -= tau * self.r[k] * x.v[k];
            }
            p[rows.start] -= tau * self.r[rows.start] * mu * tangential_norm(&x.v[rows.clone()]);
            branches.push(self.project_point(mu, &self.r[rows.clone()], &mut p[rows]));
        }
        gamma.clone_from(&x.gamma);
        refill(dp, p.iter().zip(&x.p).map(|(p, old)| p - old));
        v.clone_from(&x.v);
        self.saddle.w().apply_add(dp, v);
    }

    /// Projects on the cone of one point, nearest in |P|²/r.
    pub fn project_point(&self, mu: f64, r: &[f64], p: &mut [f64]) -> Branch {
        let last = r.len() - 1;
        let stretch = (r[0] / r[last]).sqrt();
        p[0] /= stretch;
        let branch = project_cone(mu * stretch, p);
        p[0] *= stretch;
        branch
    }

    /// |F(P̄) − F(P)| / |P̄ − P|, F = (ṽ, c − Qᵀ P).
    fn lipschitz(&self, problem: &ContactProblem<'_>, x: &Iterate, trial: &Trial) -> f64 {
        let Trial { x: end, dp, .. } = trial;
        let (mut forces, mut jumps) = (0.0, 0.0);
        for (i, rows) in problem.rows.iter().enumerate() {
            let slip = |x: &Iterate| tangential_norm(&x.v[rows.clone()]);
            let mut dv = [0.0; 3];
            for (dv, k) in dv.iter_mut().zip(rows.clone()) {
                *dv = end.v[k] - x.v[k];
            }
            dv[0] += problem.friction(i) * (slip(end) - slip(x));
            for (dv, k) in dv.into_iter().zip(rows.clone()) {
                forces += dp[k] * dp[k] / self.r[k];
                jumps += dv * dv * self.r[k];
            }
        }
        let kappa = self.saddle.kappa;
        for dc in problem.operator.modes.components(dp) {
            jumps += kappa * dc * dc;
        }
        // Forces at rest: any step will do.
        if jumps == 0.0 {
            0.0
        } else {
            (jumps / forces).sqrt()
        }
    }
}
