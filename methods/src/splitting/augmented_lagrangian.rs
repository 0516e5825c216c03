//! Augmented Lagrangian method, Uzawa form.
//!
//! Simo & Laursen, Comput. Struct. 42 (1992) 97; Alart & Curnier, Comput. Meth. Appl. Mech. Engng 92 (1991) 353.
//!
//! ```text
//! repeat                                                      outer loop (Uzawa)
//!   solve  K u = f + Bᵀ P,  P = Π(Λ − k v)                    inner loop: penalised problem, Newton
//!   Λ <- P
//! until the natural map of (u, P) is small
//! Π: P_n = max(z_n, 0),  P_t = proj_{|·| <= μ P_n}(z_t);   k = stiffness · ρ,   v = (g, d)
//! ```
//!
//! A fixed point has P = Π(P − k v), which is the contact law itself: the answer does not depend on k.
//!
//! # Options
//! `stiffness`: k as a multiple of ρ = rows/trace(W). `max_outer`, `max_inner`. `monolithic`: 1 solves each step on all unknowns of the body, as
//! papers usually run the method; the iterates are the same. `anderson`: differences kept by the acceleration of Λ (Walker & Ni, SIAM J. Numer. Anal. 49 (2011)
//! 1715), taken back where the natural map doubles. With the default stiffness there is little to accelerate, 4 instead of 5
//! updates in the median, but it gets past stalls: of 1000 random problems (`stickslip study random`, 100 per dimension
//! and μ = 0, 0.3, 1, 2, 5) 12 instead of 43 are given up.
//!
//! # Guarantees
//! Without friction the outer loop contracts by 1/(1 + k w_min), w_min the smallest eigenvalue of W, for any k > 0; the
//! condensed inner problem stays well conditioned for large k, unlike K + k Bᵀ B.
//!
//! # Skips
//! An open crack is one linear solve. Each inner problem starts from the last; open points leave its dense LU. A tangent that
//! has not changed is not factored again; on 256 active rows and more, nor is one of which few rows have.
//!
//! # Failure modes
//! Slow for small k; with friction the inner problem can fail for large μ, as for the penalty method.

use crate::condensed::acceleration::Acceleration;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::contract::options::{Options, options};
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Monitor, Status};
use crate::contract::system::ContactSystem;
use crate::newton::springs::{SpringNewton, Springs};
use crate::newton::step::Tangent;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "augmented-lagrangian",
    label: "Augmented Lagrangian (Uzawa)",
    reference: "Simo & Laursen, Comput. Struct. 42 (1992) 97",
    summary: "repeats a penalised solve, each time anchored at the contact forces of the last, until the springs are slack",
    exact: true,
    options: Settings::OPTIONS,
    source: include_str!("augmented_lagrangian.rs"),
    build: |options| Box::new(AugmentedLagrangian::new(options)),
};

options! {
    Settings {
        stiffness: Real(1e3, 1e-2, 1e6), "penalty stiffness of the inner problem as a multiple of rho = rows/trace(W)";
        max_outer: Count(1000, 1, 1_000_000), "multiplier updates before giving up";
        max_inner: Count(100, 1, 1_000_000), "Newton steps per inner problem before giving up";
        monolithic: Switch(false), Tangent::HELP;
        anderson: Count(0, 0, 20), Acceleration::HELP;
    }
}

/// The inner problem is solved this much more accurately than the outer loop is stopped.
const INNER_FRACTION: f64 = 1e-2;

/// Multiplier updates without progress after which the iteration counts as stalled.
const PATIENCE: usize = 200;

struct AugmentedLagrangian {
    settings: Settings,
    newton: SpringNewton,
}

impl AugmentedLagrangian {
    fn new(options: &Options) -> Self {
        let settings = Settings::new(options);
        Self {
            newton: SpringNewton::new(Tangent::new(settings.monolithic)),
            settings,
        }
    }
}

impl CondensedMethod for AugmentedLagrangian {
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        self.newton.tangent.refuses(system)
    }

    fn needs(&self) -> Needs {
        self.newton.tangent.needs()
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let end = self.updates(problem, monitor);
        self.newton.tangent.forget();
        end
    }
}

impl AugmentedLagrangian {
    /// The outer loop.
    fn updates(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let k = self.settings.stiffness * problem.operator.rho;
        let outer = Limits::new(self.settings.max_outer, PATIENCE);
        let mut x = problem.start();
        let mut springs = Springs::new(problem, (k, k), x.p.clone(), None);
        let (newton, mut v) = (&mut self.newton, Vec::new());
        let inner_stop = INNER_FRACTION * problem.stop;
        let mut changes = 0;
        let mut acceleration = Acceleration::new(self.settings.anderson, || x.p.clone());

        let status = loop {
            problem.jump_into(&x.p, &x.beta, &mut v);
            let violation = problem.violation(&x.p, &v);
            match problem.check(violation, (&x.p, &x.beta), changes, outer, monitor)? {
                Check::GoOn => {}
                Check::Corrected => continue,
                Check::End(status) => break status,
            }
            springs.anchor.clone_from(&x.p);
            if let Some(acceleration) = &mut acceleration
                && problem.counters.iterations > 1
            {
                springs.anchor = acceleration.next(problem, x.p.clone());
            }
            changes = 0;
            let count = |_: &mut ContactProblem<'_>, _: &Forces, more: usize| {
                changes += more;
                true
            };
            newton.start(problem, &springs, &x);
            let inner = newton.solve(
                problem,
                &springs,
                inner_stop,
                self.settings.max_inner,
                count,
            )?;
            x.copy(&newton.at.forces);
            problem.rebalance(&mut x.p);
            // Stalled: solved to rounding, which the outer loop can still use.
            if !matches!(inner, Status::Converged | Status::Stalled) {
                break inner;
            }
        };
        Ok(End { status, at: x })
    }
}
