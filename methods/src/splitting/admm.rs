//! Alternating direction method of multipliers (ADMM).
//!
//! Boyd, Parikh, Chu, Peleato & Eckstein, Found. Trends Mach. Learn. 3 (2011) 1; for frictional contact Tasora, Mangoni,
//! Benatti & Garziera, Int. J. Numer. Meth. Engng 122 (2021) 4093. De Saxcé's correction, updated in every iteration, makes
//! it Coulomb's law: De Saxcé & Feng, Math. Comput. Modelling 28 (1998) 225.
//!
//! ```text
//! min ½ P·W P + (q + s)·P   over Qᵀ P = c,  P = y,  y in K_μ        s = (μ|d|, 0), De Saxcé's correction
//!
//! P <- (W + I/k)⁻¹ ((y − ξ)/k − q − s − Q β),  Qᵀ P = c             linear, all points
//! z <- α P + (1 − α) y + ξ                                          over-relaxation
//! y <- proj_{K_μ}(z),   ξ <- z − y                                  point by point
//! s <- (μ|d|, 0),       d = −ξ_t/k
//! ```
//! 1/k is the penalty parameter and ξ the scaled multiplier: −ξ/k tends to ṽ = (g + μ|d|, d). A fixed point has
//! y = proj_{K_μ}(y − k ṽ), the natural map itself.
//!
//! LATIN with ω = 1/2 takes the same linear step and differs in the local one: it solves the local problem
//! z = P̂ − k v̂ with v̂ and its own |d̂| at once (return mapping, not associated), where ADMM projects on the cone along its
//! normal and takes s from the iteration before. Without friction both are Douglas–Rachford splitting.
//!
//! # Options
//! `penalty`: the first k as a multiple of ρ = rows/trace(W). It follows the residuals |P − y| and |y − y_old|/k (Boyd et
//! al. §3.4.1) in powers of 2, by the mean of their ratio since the last look, at iterations ever farther apart. The ratio
//! is the geometric mean of two that fail in different places: relative to |P| and |ξ|/k (Wohlberg 2017; misled by large
//! gaps elsewhere), and to the scale 1 : 1/ρ of the natural map (misled by the condition of W). `over_relaxation`: α,
//! dropped to 1 once 25 iterations in a row bring no progress. `max_iterations`.
//! `anderson`: differences kept by the acceleration of (y, ξ) (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715), taken back
//! where the natural map doubles, begun anew when k moves. On random problems (`stickslip study random`, 100 per entry)
//! median iterations and how many gave up:
//!
//! | μ                | 0       | 0.3     | 1       | 2       | 5       |
//! |------------------|---------|---------|---------|---------|---------|
//! | 2D, default      | 64      | 251     | 116     | 109     | 147     |
//! | 2D, `anderson` 5 | 34      | 60      | 56      | 59      | 87      |
//! | 3D, default      | 118, 1  | 327, 7  | 208, 2  | 240, 2  | 558, 3  |
//! | 3D, `anderson` 5 | 56      | 101     | 105     | 116     | 237     |
//!
//! # Guarantees
//! Without friction convergence for any fixed k and α < 2, so also once k no longer changes. A W that is not symmetric has no
//! minimum to go to: then it is Douglas–Rachford splitting of 0 ∈ W P + q + s + N(P), which converges as well if W + Wᵀ is
//! semi-definite (Lions & Mercier, SIAM J. Numer. Anal. 16 (1979) 964). With friction each s gives a
//! convex problem; their sequence has no proof.
//!
//! # Failure modes
//! Large μ: s then overshoots, the more the larger α. Of 200 random, strongly coupled systems per μ all converge up to
//! μ = 1, 199 at μ = 2 and 197 at μ = 5, with α = 1 throughout as many, at small μ in nearly twice the iterations
//! (`tests/robustness.rs`). Over-relaxation to the end loses many of them at μ = 5.
//!
//! # Skips
//! W + I/k is factored once per move of k; the three factors used last are kept, also between increments.

use std::sync::Arc;

use crate::algebra::dense::{norm, refill};
use crate::condensed::acceleration::Acceleration;
use crate::condensed::forces::{End, Ended};
use crate::condensed::method::CondensedMethod;
use crate::condensed::pair::Pair;
use crate::condensed::problem::{ContactProblem, Limits};
use crate::condensed::stages::GlobalStage;
use crate::contract::law::{Branch, project_cone, tangential_norm};
use crate::contract::options::{Options, options};
use crate::contract::registry::{Method, Needs};
use crate::contract::state::Monitor;
use crate::error::MethodError;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "admm",
    label: "ADMM",
    reference: "Tasora, Mangoni, Benatti & Garziera, Int. J. Numer. Meth. Engng 122 (2021) 4093",
    summary: "alternates linear equilibrium and projections on Coulomb's cone, with De Saxce's correction",
    exact: true,
    options: Settings::OPTIONS,
    source: include_str!("admm.rs"),
    build: |options| Box::new(Admm::new(options)),
};

options! {
    Settings {
        penalty: Real(1.0, 1e-3, 1e3), "first k, the inverse of the penalty parameter, as a multiple of rho = rows/trace(W)";
        over_relaxation: Real(1.6, 0.5, 1.9), "over-relaxation; 1 is the plain method";
        max_iterations: Count(20_000, 1, 10_000_000), "pairs of steps before giving up";
        anderson: Count(0, 0, 20), Acceleration::HELP;
    }
}

/// Iterations without progress after which the iteration counts as stalled.
const PATIENCE: usize = 2000;
/// Iterations without progress after which there is no more over-relaxation.
const STAGNATION: usize = 25;
/// The first iteration at which k may move; each further one comes twice as late.
const FIRST_BALANCE: usize = 10;
/// Largest power of 2 in one move of k.
const MAX_MOVE: f64 = 4.0;

/// Factors kept: each is as large as W. The first k, the one before a move and the one after.
const KEPT: usize = 3;

struct Admm {
    settings: Settings,
    /// The linear step with its power of 2, the last one used at the end.
    stages: Vec<(i32, Arc<GlobalStage>)>,
}

impl Admm {
    fn new(options: &Options) -> Self {
        Self {
            settings: Settings::new(options),
            stages: Vec::new(),
        }
    }

    /// The linear step with k = `penalty` ρ 2^power.
    fn stage(
        &mut self,
        problem: &mut ContactProblem<'_>,
        power: i32,
    ) -> Result<Arc<GlobalStage>, MethodError> {
        self.stages
            .retain(|(_, stage)| stage.belongs_to(&problem.operator));
        let kept = self.stages.iter().position(|(kept, _)| *kept == power);
        let stage = if let Some(place) = kept {
            self.stages.remove(place).1
        } else {
            let k = self.settings.penalty * problem.operator.rho * 2.0_f64.powi(power);
            problem.counters.factorisations += 1;
            Arc::new(GlobalStage::along(problem.operator.clone(), k)?)
        };
        self.stages.push((power, stage.clone()));
        if self.stages.len() > KEPT {
            self.stages.remove(0);
        }
        Ok(stage)
    }
}

impl CondensedMethod for Admm {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.settings.max_iterations, PATIENCE);
        let (mut power, mut balance) = (0, Balance::default());
        let mut stage = self.stage(problem, power)?;
        let (mut pair, mut new) = (Pair::start(problem), Pair::default());
        let mut cone = Cone::start(problem, &pair, stage.k0());
        let (mut changes, mut alpha) = (0, self.settings.over_relaxation);
        let mut target = Vec::new();
        let mut acceleration = Acceleration::new(self.settings.anderson, || cone.stacked());

        let status = loop {
            if let Some(status) = pair.ends(problem, changes, limits, monitor)? {
                break status;
            }
            if problem.idle() >= STAGNATION {
                alpha = alpha.min(1.0);
            }
            let growth;
            (changes, growth) = cone.project(problem, &pair, alpha);
            let power_step = balance.moves(problem.counters.iterations, growth);
            if power_step != 0 {
                power += power_step;
                stage = self.stage(problem, power)?;
                cone.rescale(stage.k0());
            }
            if let Some(acceleration) = &mut acceleration {
                match power_step {
                    0 => cone.unstack(&acceleration.next(problem, cone.stacked())),
                    _ => acceleration.restart(cone.stacked()),
                }
            }
            cone.target(problem, &mut target);
            if !stage.global_stage(problem, &target, &mut new) {
                break problem.singular();
            }
            std::mem::swap(&mut pair, &mut new);
        };
        let at = pair.into();
        Ok(End { status, at })
    }
}

/// When k moves and how far: by the mean of what was asked for, ever more rarely.
struct Balance {
    next: usize,
    /// Sum of log₂ of the growth asked for since the last look, and in how many iterations.
    asked: (f64, usize),
}

impl Default for Balance {
    fn default() -> Self {
        Self {
            next: FIRST_BALANCE,
            asked: (0.0, 0),
        }
    }
}

impl Balance {
    /// The power by which k moves, from the growth each iteration asks for.
    fn moves(&mut self, iteration: usize, growth: f64) -> i32 {
        let Self { next, asked } = self;
        asked.0 += growth.log2();
        asked.1 += 1;
        if iteration < *next {
            return 0;
        }
        let mean = asked.0 / asked.1 as f64;
        *asked = (0.0, 0);
        *next *= 2;
        // Where all points stick, the multiplier vanishes and the mean is infinite: the largest move is right, as v = 0
        // is then the fixed point of k = ∞. NaN casts to 0.
        mean.round().clamp(-MAX_MOVE, MAX_MOVE) as i32
    }
}

/// The copy of the forces in the cone and its multiplier.
struct Cone {
    y: Vec<f64>,
    /// y of the iteration before.
    y_old: Vec<f64>,
    xi: Vec<f64>,
    k: f64,
    branches: Vec<Branch>,
}

impl Cone {
    /// y = P, ξ = −k ṽ.
    fn start(problem: &ContactProblem<'_>, pair: &Pair, k: f64) -> Self {
        let mut xi: Vec<f64> = pair.v.iter().map(|v| -k * v).collect();
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            let d = tangential_norm(&pair.v[rows.clone()]);
            xi[rows.start] -= k * problem.friction(i) * d;
        }
        Self {
            y: pair.p.clone(),
            y_old: pair.p.clone(),
            xi,
            k,
            branches: vec![Branch::Open; problem.rows.points()],
        }
    }

    /// y and ξ from the new P. Returns how many points changed their branch, and the factor by which k should grow.
    fn project(
        &mut self,
        problem: &mut ContactProblem<'_>,
        pair: &Pair,
        alpha: f64,
    ) -> (usize, f64) {
        problem.counters.local_solves += problem.rows.points();
        std::mem::swap(&mut self.y, &mut self.y_old);
        // z, which ξ keeps.
        for k in 0..self.y.len() {
            self.y[k] = alpha * pair.p[k] + (1.0 - alpha) * self.y_old[k] + self.xi[k];
        }
        self.xi.copy_from_slice(&self.y);
        let mut changes = 0;
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            let branch = project_cone(problem.friction(i), &mut self.y[rows]);
            changes += usize::from(std::mem::replace(&mut self.branches[i], branch) != branch);
        }
        self.xi.iter_mut().zip(&self.y).for_each(|(x, y)| *x -= y);
        let distance = |a: &[f64]| {
            let square = |(a, y): (&f64, &f64)| (a - y).powi(2);
            a.iter().zip(&self.y).map(square).sum::<f64>().sqrt()
        };
        let relative = norm(&pair.p).max(norm(&self.y)) / norm(&self.xi);
        let scaled = problem.operator.rho / self.k;
        let ratio = distance(&self.y_old) / distance(&pair.p) * (relative * scaled).sqrt();
        (changes, ratio.sqrt())
    }

    /// y and ξ in one vector.
    fn stacked(&self) -> Vec<f64> {
        self.y.iter().chain(&self.xi).copied().collect()
    }

    /// Takes what [`stacked`](Self::stacked) gives.
    fn unstack(&mut self, stacked: &[f64]) {
        let (y, xi) = stacked.split_at(self.y.len());
        self.y.copy_from_slice(y);
        self.xi.copy_from_slice(xi);
    }

    /// The same multiplier −ξ/k for another k.
    fn rescale(&mut self, k: f64) {
        let factor = k / self.k;
        self.xi.iter_mut().for_each(|x| *x *= factor);
        self.k = k;
    }

    /// y − ξ − k s: what P + k v of the linear step has to be.
    fn target(&self, problem: &ContactProblem<'_>, target: &mut Vec<f64>) {
        refill(target, self.y.iter().zip(&self.xi).map(|(y, x)| y - x));
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            let d = tangential_norm(&self.xi[rows.clone()]);
            target[rows.start] -= problem.friction(i) * d;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::matrix::SquareMatrix;
    use crate::condensed::fixture::with_contact;
    use crate::contract::elastic::Elastic;

    #[test]
    fn only_the_last_factors_are_kept() {
        let w = SquareMatrix::symmetric(2, vec![0, 1, 2], vec![0, 1], vec![1.0; 2]).unwrap();
        let body = Elastic::from_delassus(2, w, vec![]).unwrap();
        let load = (vec![-1.0, 0.0], vec![0.0; 2]);
        with_contact(&body, vec![0.3], load, |_, mut problem| {
            let mut admm = Admm::new(&Options::new(METHOD.options, &[]).unwrap());
            for (power, factorisations) in [(0, 1), (1, 2), (0, 2), (3, 3), (5, 4), (0, 4), (1, 5)]
            {
                let k0 = admm.stage(&mut problem, power).unwrap().k0();
                assert_eq!(k0, problem.operator.rho * 2.0_f64.powi(power));
                assert!(admm.stages.len() <= KEPT);
                let found = problem.counters.factorisations;
                assert_eq!(found, factorisations, "power {power}");
            }
        });
    }
}
