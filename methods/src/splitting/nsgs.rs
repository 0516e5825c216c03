//! Nonsmooth (block) Gauss–Seidel method.
//!
//! Jourdan, Alart & Jean, Comput. Meth. Appl. Mech. Engng 155 (1998) 31; Moreau's contact dynamics.
//!
//! ```text
//! repeat
//!   for every point i
//!     solve  v_i = q_i + Σ_{j≠i} W_ij P_j + W_ii P̂_i  with the contact laws, exactly       local problem
//!     P_i <- P_i + ω (P̂_i − P_i),   v <- v + W_{·i} ΔP_i
//!   γ <- γ + κ (Qᵀ P − c)                                     bodies that float: method of multipliers
//! until the natural map is small
//! ```
//! The local problem is solved by cases in 2D and as one scalar equation in 3D (`condensed/local.rs`, swept by
//! `condensed/sweeps.rs`); the balance of floating bodies is augmented (`condensed/saddle.rs`).
//!
//! # Options
//! `relaxation`: ω to begin with. Every 300 sweeps in a row without progress halve it, at most four times: cycles at large
//! μ often end so. `max_iterations`: sweeps. `anderson`: differences kept by the acceleration of
//! (P, γ/κ) (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715), taken back where the natural map doubles. On random problems
//! (`stickslip study random`, 100 per entry) median sweeps and how many gave up:
//!
//! | μ                | 0       | 0.3     | 1       | 2       | 5       |
//! |------------------|---------|---------|---------|---------|---------|
//! | 2D, `anderson` 0 | 245     | 206     | 196     | 187, 1  | 177, 3  |
//! | 2D, `anderson` 5 | 43      | 42      | 50, 1   | 58, 1   | 56, 2   |
//! | 3D, `anderson` 0 | 278, 5  | 241, 6  | 250, 4  | 277, 2  | 307, 8  |
//! | 3D, `anderson` 5 | 47, 2   | 55      | 66      | 90, 1   | 88, 7   |
//!
//! An accelerated sweep costs one product with W more, as much as the sweep.
//!
//! # Guarantees
//! Convergence without friction and for bodies that do not float: every local problem lowers the same convex energy. With
//! friction there is no proof. Linear, with a rate that follows the condition of W.
//!
//! # Failure modes
//! Slow on ill-conditioned W; cycles for large μ, outside the range where the solution is unique (of 200 random,
//! strongly coupled systems per μ none fails up to μ = 1, 2 at μ = 2 and 14 at μ = 5: `tests/robustness.rs`). The order
//! of the points changes the iterates, not the limit.
//!
//! # Skips
//! A point whose force does not change, as an open one that stays open, leaves v as it is and costs one local problem. v
//! is computed afresh only every now and then, and before anything is claimed.

use crate::condensed::acceleration::Acceleration;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{ContactProblem, Limits};
use crate::condensed::saddle::{REFRESH, Saddle};
use crate::condensed::sweeps::Sweeps;
use crate::contract::law::Branch;
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::Monitor;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "nsgs",
    label: "Nonsmooth Gauss-Seidel",
    reference: "Jourdan, Alart & Jean, Comput. Meth. Appl. Mech. Engng 155 (1998) 31",
    summary: "sweeps over the points and solves the contact law of each exactly with all others held",
    exact: true,
    options: Nsgs::OPTIONS,
    source: include_str!("nsgs.rs"),
    build: |options| Box::new(Nsgs::new(options)),
};

options! {
    Nsgs {
        relaxation: Real(1.0, 0.1, 1.9), "fraction of the step to the solution of each local problem";
        max_iterations: Count(100_000, 1, 100_000_000), "sweeps over all points before giving up";
        anderson: Count(0, 0, 20), Acceleration::HELP;
    }
}

/// Sweeps without progress after which the iteration counts as stalled.
const PATIENCE: usize = 5000;
/// Sweeps without progress after which the relaxation is halved.
const STAGNATION: usize = 300;
/// Halvings of the relaxation.
const MAX_HALVINGS: usize = 4;

impl CondensedMethod for Nsgs {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.max_iterations, PATIENCE);
        let saddle = Saddle::new(problem.operator.clone());
        let sweeps = Sweeps::new(problem, &saddle);
        let mut x = saddle.start(problem);
        let mut branches = vec![Branch::Open; problem.rows.points()];
        let (mut changes, mut halvings) = (0, 0);
        let mut acceleration = Acceleration::new(self.anderson, || saddle.stacked(&x));

        let status = loop {
            if let Some(status) = saddle.ends(problem, &mut x, changes, limits, monitor)? {
                break status;
            }
            saddle.update_multipliers(problem, &mut x);
            if problem.counters.iterations.is_multiple_of(REFRESH) {
                saddle.refresh(problem, &mut x);
            }
            halvings = halvings.max((problem.idle() / STAGNATION).min(MAX_HALVINGS));
            let omega = self.relaxation / f64::from(1_u32 << halvings);
            changes = sweeps.sweep(problem, &saddle, omega, &mut x, &mut branches);
            if let Some(acceleration) = &mut acceleration {
                let next = acceleration.next(problem, saddle.stacked(&x));
                saddle.unstack(problem, &mut x, &next);
            }
        };
        let (p, beta) = saddle.balanced(problem, &x);
        let at = Forces { p, beta };
        Ok(End { status, at })
    }
}
