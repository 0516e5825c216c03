//! Accelerated projected gradients.
//!
//! Mazhar, Heyn, Negrut & Tasora, ACM Trans. Graph. 34 (2015) 32, after Nesterov, Soviet Math. Dokl. 27 (1983) 372; restart:
//! O'Donoghue & Candès, Found. Comput. Math. 15 (2015) 715. They minimise the convex problem of a given shift; the shift
//! makes it Coulomb's law: De Saxcé & Feng, Math. Comput. Modelling 28 (1998) 225.
//!
//! ```text
//! min ½ P·W' P + (q' + Q γ + s)·P   over P in K_μ                    f = q' + W' P + Q γ + s, the gradient
//!
//! step    P⁺ = proj(y − t r f(y)),   t <- min(t/2, |δP|²/δP·W'δP) and again while δP·W'δP > |δP|²/t,  δP = P⁺ − y
//!         θ⁺² = (1 − θ⁺) θ²,  y <- P⁺ + θ (1 − θ)/(θ² + θ⁺) (P⁺ − P);   y <- P⁺, θ <- 1 if f(y)·(P⁺ − P) > 0
//!         t <- t/0.9
//! shift   s <- (μ|d|, 0), accelerated,  γ <- γ + κ (Qᵀ P − c)    once the convex problem is solved better than its shift is known
//! ```
//! Norms and projections are those of the metric |P|²/r, with r, W', q' and γ as in `projection`, whose fixed point takes
//! the plain step and a new shift every time. The convex problem counts as solved where what a projected step would still
//! move is less than half of what a new shift would. Shifts are accelerated by Anderson's method, as those of `socp`.
//!
//! # Options
//! `max_iterations`.
//!
//! # Guarantees
//! Without friction, for bodies that do not float, the objective falls like 1/k². With friction each shift gives a convex
//! problem; their sequence has no proof.
//!
//! # Failure modes
//! Large μ: shifts then overshoot, and each convex problem has to be solved the better. At μ = 50 it stalls where
//! `projection`, with a new shift in every step, does not. On random problems (`stickslip study random`; 60 per entry,
//! `projection`: 100) median iterations and how many gave up:
//!
//! | μ                | 0   | 0.3    | 1       | 2       | 5         |
//! |------------------|-----|--------|---------|---------|-----------|
//! | 2D, this method  | 179 | 269    | 551     | 793     | 1685      |
//! | 2D, `projection` | 944 | 900    | 1507    | 3286    | 7894, 7   |
//! | 3D, this method  | 147 | 242    | 479     | 1077    | 2423, 3   |
//! | 3D, `projection` | 776 | 832    | 1489, 3 | 4167, 6 | 12221, 23 |
//!
//! A step costs one product with W' and two more projections to know when the shift is due.
//!
//! # Skips
//! Nothing is factored. v follows P by columns of W', without those whose force did not change; it is computed afresh
//! only every now and then, and before anything is claimed.

use crate::algebra::dense::{dot, refill, zero};
use crate::condensed::anderson::Anderson;
use crate::condensed::branches::changed;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{ContactProblem, Limits};
use crate::condensed::saddle::{Iterate, REFRESH};
use crate::contract::law::{Branch, tangential_norm};
use crate::contract::options::options;
use crate::contract::registry::Method;
use crate::contract::state::Monitor;
use crate::splitting::projection::Step;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "accelerated-gradient",
    label: "Accelerated projected gradient",
    reference: "Mazhar, Heyn, Negrut & Tasora, ACM Trans. Graph. 34 (2015) 32",
    summary: "projected gradients with Nesterov's momentum on convex problems shifted by the slip",
    exact: true,
    options: AcceleratedGradient::OPTIONS,
    source: include_str!("accelerated_gradient.rs"),
    build: |options| Box::new(AcceleratedGradient::new(options)),
};

options! {
    AcceleratedGradient {
        max_iterations: Count(100_000, 1, 100_000_000), "steps before giving up";
    }
}

/// Iterations without progress after which the iteration counts as stalled.
const PATIENCE: usize = 20_000;
/// Part of what a new shift moves below which the convex problem counts as solved.
const SOLVED: f64 = 0.5;
/// Differences of shifts kept.
const SHIFTS: usize = 5;
/// Shortening of a step, and what it is lengthened by after every step.
const SHRINK: f64 = 0.5;
const GROW: f64 = 1.0 / 0.9;

impl CondensedMethod for AcceleratedGradient {
    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.max_iterations, PATIENCE);
        let gradient = Step::new(problem);
        let saddle = &gradient.saddle;
        let mut x = saddle.start(problem);
        let mut program = Program::new(problem, &gradient, &x);
        let mut changes = 0;
        let mut before = vec![Branch::Open; problem.rows.points()];

        let status = loop {
            if let Some(status) = saddle.ends(problem, &mut x, changes, limits, monitor)? {
                break status;
            }
            let stale = problem.counters.iterations.is_multiple_of(REFRESH);
            if stale {
                saddle.refresh(problem, &mut x);
            }
            if program.solved(problem, &x) {
                saddle.update_multipliers(problem, &mut x);
                program.shift(problem, &x);
            } else if stale {
                program.restart(&x);
            }
            program.step(problem, &mut x);
            let branches = &mut program.trial.branches;
            changes = changed(branches, &before);
            std::mem::swap(&mut before, branches);
        };
        let (p, beta) = saddle.balanced(problem, &x);
        let at = Forces { p, beta };
        Ok(End { status, at })
    }
}

/// The convex problem of one shift, and where its iteration stands.
struct Program<'g> {
    gradient: &'g Step,
    /// s by row.
    s: Vec<f64>,
    /// Lesson of the shifts before.
    anderson: Anderson,
    /// t.
    t: f64,
    /// Nesterov's point and θ.
    y: Iterate,
    theta: f64,
    /// The projected step tried last.
    trial: Trial,
    /// The shift of the iterate itself, and the projected step with it.
    own_s: Vec<f64>,
    shifted: Trial,
}

/// A projected step.
#[derive(Default)]
struct Trial {
    /// Its end.
    p: Vec<f64>,
    branches: Vec<Branch>,
    /// δP and W' δP.
    dp: Vec<f64>,
    dv: Vec<f64>,
}

impl Trial {
    /// P <- proj(P − t r (v + s)) from `x`.
    fn project(
        &mut self,
        problem: &mut ContactProblem<'_>,
        gradient: &Step,
        x: &Iterate,
        s: &[f64],
        t: f64,
    ) {
        problem.counters.local_solves += problem.rows.points();
        let (r, p) = (&gradient.r, &mut self.p);
        refill(p, (0..s.len()).map(|k| x.p[k] - t * r[k] * (x.v[k] + s[k])));
        let point = |(i, own): (usize, std::ops::Range<usize>)| {
            gradient.project_point(problem.friction(i), &r[own.clone()], &mut p[own])
        };
        refill(
            &mut self.branches,
            problem.rows.iter().enumerate().map(point),
        );
    }

    /// δP from where the step began, and W' δP.
    fn multiply(&mut self, gradient: &Step, begin: &[f64]) {
        refill(&mut self.dp, self.p.iter().zip(begin).map(|(p, b)| p - b));
        zero(&mut self.dv, begin.len());
        gradient.saddle.w().apply_add(&self.dp, &mut self.dv);
    }
}

/// De Saxcé's shift of a jump by row, in place of what `s` holds.
fn shift_of(problem: &ContactProblem<'_>, v: &[f64], s: &mut Vec<f64>) {
    zero(s, v.len());
    for (i, own) in problem.rows.iter().enumerate() {
        s[own.start] = problem.friction(i) * tangential_norm(&v[own.clone()]);
    }
}

impl<'g> Program<'g> {
    fn new(problem: &ContactProblem<'_>, gradient: &'g Step, x: &Iterate) -> Self {
        let mut program = Self {
            gradient,
            s: Vec::new(),
            anderson: Anderson::new(SHIFTS),
            t: 1.0,
            y: Iterate::default(),
            theta: 1.0,
            trial: Trial::default(),
            own_s: Vec::new(),
            shifted: Trial::default(),
        };
        program.shift(problem, x);
        program
    }

    /// Takes the shift of `x`.
    fn shift(&mut self, problem: &ContactProblem<'_>, x: &Iterate) {
        shift_of(problem, &x.v, &mut self.s);
        self.anderson.next(&mut self.s);
        self.restart(x);
    }

    /// Forgets all but the step length.
    fn restart(&mut self, x: &Iterate) {
        self.y.copy(x);
        self.theta = 1.0;
    }

    /// Whether a step with the shift of `x` itself would do much more than one with the old.
    fn solved(&mut self, problem: &mut ContactProblem<'_>, x: &Iterate) -> bool {
        let gradient = self.gradient;
        self.trial.project(problem, gradient, x, &self.s, 1.0);
        shift_of(problem, &x.v, &mut self.own_s);
        (self.shifted).project(problem, gradient, x, &self.own_s, 1.0);
        let missing = problem.missing(&x.p);
        let unbalanced = gradient.saddle.kappa * dot(&missing, &missing);
        let (old, new) = (&self.trial.p, &self.shifted.p);
        self.squared(old, &x.p) <= (SOLVED * SOLVED) * (self.squared(new, old) + unbalanced)
    }

    /// |δP|²/r between two forces.
    fn squared(&self, to: &[f64], from: &[f64]) -> f64 {
        let rows = to.iter().zip(from).zip(&self.gradient.r);
        rows.map(|((to, from), r)| (to - from) * (to - from) / r)
            .sum()
    }

    /// Nesterov's step.
    fn step(&mut self, problem: &mut ContactProblem<'_>, x: &mut Iterate) {
        let gradient = self.gradient;
        loop {
            (self.trial).project(problem, gradient, &self.y, &self.s, self.t);
            self.trial.multiply(gradient, &self.y.p);
            let size = self.squared(&self.trial.p, &self.y.p);
            let curvature = dot(&self.trial.dp, &self.trial.dv);
            // Forces at rest: any step will do; where numbers left the finite range none helps.
            let steep = curvature * self.t > size && curvature.is_finite();
            if !steep || size == 0.0 {
                break;
            }
            self.t = (SHRINK * self.t).min(size / curvature);
        }
        let Self { y, s, trial, .. } = self;
        let slope: f64 = (0..s.len())
            .map(|k| (y.v[k] + s[k]) * (trial.p[k] - x.p[k]))
            .sum();
        let theta = self.theta;
        let next = 0.5 * theta * ((theta * theta + 4.0).sqrt() - theta);
        let mut beta = theta * (1.0 - theta) / (theta * theta + next);
        self.theta = next;
        if slope > 0.0 {
            (beta, self.theta) = (0.0, 1.0);
        }
        for k in 0..s.len() {
            let (p, v) = (trial.p[k], y.v[k] + trial.dv[k]);
            y.p[k] = p + beta * (p - x.p[k]);
            y.v[k] = v + beta * (v - x.v[k]);
            (x.p[k], x.v[k]) = (p, v);
        }
        self.t *= GROW;
    }
}
