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
//! `stiffness`: k as a multiple of ρ = rows/trace(W). `max_outer`, `max_inner`. `monolithic`: 1 solves each step
//! on all unknowns with a sparse LU of K + Bᵀ C B, C the stiffness of the springs in contact, as papers usually run the
//! method; the iterates are the same.
//!
//! # Guarantees
//! Without friction the outer loop contracts by 1/(1 + k w_min), w_min the smallest eigenvalue of W, for any k > 0; the
//! condensed inner problem stays well conditioned for large k, unlike K + k Bᵀ B.
//!
//! # Skips
//! An open crack is one linear solve. Each inner problem starts from the last; open points leave its dense LU.
//!
//! # Failure modes
//! Slow for small k; with friction the inner problem can fail for large μ, as for the penalty method.

use crate::condensed::problem::{Begin, Limits, Reduced};
use crate::newton::springs::Springs;
use crate::newton::step::{MONOLITHIC, Tangent};
use crate::{
    Claim, ContactSystem, Enforcement, Increment, Method, MethodError, Monitor, OptionSpec,
    Options, Outcome, Status,
};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "augmented-lagrangian",
    label: "Augmented Lagrangian (Uzawa)",
    reference: "Simo & Laursen, Comput. Struct. 42 (1992) 97",
    summary: "repeats a penalised solve, each time anchored at the contact forces of the last, until the springs are slack",
    exact: true,
    options: &OPTIONS,
    source: include_str!("augmented_lagrangian.rs"),
    build: |options| Ok(Box::new(AugmentedLagrangian::new(options))),
};

static OPTIONS: [OptionSpec; 4] = [
    OptionSpec {
        name: "stiffness",
        unit: "-",
        default: 1e3,
        min: 1e-2,
        max: 1e6,
        integer: false,
        help: "penalty stiffness of the inner problem as a multiple of rho = rows/trace(W)",
    },
    OptionSpec {
        name: "max_outer",
        unit: "-",
        default: 1000.0,
        min: 1.0,
        max: 1e6,
        integer: true,
        help: "multiplier updates before giving up",
    },
    OptionSpec {
        name: "max_inner",
        unit: "-",
        default: 100.0,
        min: 1.0,
        max: 1e6,
        integer: true,
        help: "Newton steps per inner problem before giving up",
    },
    MONOLITHIC,
];

/// The inner problem is solved this much more accurately than the outer loop is stopped.
const INNER_FRACTION: f64 = 1e-2;

/// Multiplier updates without progress after which the iteration counts as stalled.
const PATIENCE: usize = 200;

struct AugmentedLagrangian {
    stiffness: f64,
    max_outer: usize,
    max_inner: usize,
    tangent: Tangent,
}

impl AugmentedLagrangian {
    fn new(options: &Options) -> Self {
        Self {
            stiffness: options.own("stiffness"),
            max_outer: options.own("max_outer") as usize,
            max_inner: options.own("max_inner") as usize,
            tangent: Tangent::new(options),
        }
    }
}

impl Enforcement for AugmentedLagrangian {
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        self.tangent.refuses(system)
    }

    fn prepare(&mut self, system: &ContactSystem) -> Result<(), MethodError> {
        system.elastic().factorise()
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
        let k = self.stiffness * problem.condensed.rho;
        let mut p = problem.start_forces();
        let mut beta = problem.start_amplitudes(&p);
        let mut springs = Springs {
            normal: k,
            tangential: k,
            anchor: p.clone(),
            coupled: None,
        };
        let inner_stop = INNER_FRACTION * problem.stop;
        let mut changes = 0;
        let limits = Limits {
            iterations: self.max_outer,
            patience: PATIENCE,
        };

        let status = loop {
            let v = problem.jump(&p, &beta);
            let natural_map = problem.natural_map(&p, &v);
            if let Some(status) = problem.ends(natural_map, changes, limits, monitor) {
                match problem.confirm(status, &p, &beta)? {
                    Some(status) => break status,
                    None => continue,
                }
            }
            springs.anchor.clone_from(&p);
            let start = springs.predict(&problem, &p, beta);
            changes = 0;
            let (inner, end) = springs.solve(
                &mut problem,
                start,
                inner_stop,
                self.max_inner,
                &mut self.tangent,
                |_, _, c| {
                    changes += c;
                    true
                },
            )?;
            (p, beta) = (end.p, end.beta);
            problem.rebalance(&mut p);
            // Stalled: solved to rounding, which the outer loop can still use.
            if !matches!(inner, Status::Converged | Status::Stalled) {
                break inner;
            }
        };
        problem.finish(status, &p, &beta)
    }
}
