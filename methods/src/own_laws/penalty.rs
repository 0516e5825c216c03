//! Penalty method with return mapping.
//!
//! Wriggers, Computational Contact Mechanics (2006), ch. 5 and 6; consistent tangent: Simo & Laursen, Comput. Struct.
//! 42 (1992) 97.
//!
//! ```text
//! P_n = k_n max(−g, 0)
//! P_t = proj_{|·| <= μ P_n}(P_t(start) − k_t d)        elastic predictor, radial return
//! k_n = normal · ρ,   k_t = tangential · ρ,   ρ = rows / trace(W)
//! ```
//!
//! The contact laws are replaced by springs: a contact force needs a penetration P_n/k_n, and sticking creeps by
//! P_t/k_t. That error falls like 1/k and never vanishes. `Converged` therefore refers to the penalised equations
//! above, whose residual fills the history; the outcome says so by [`Claim::Penalised`], and the natural map the judge
//! finds measures the modelling error.
//!
//! # Options
//! `normal`, `tangential`: k as multiples of ρ, the mean stiffness the body itself opposes to a contact force.
//! `max_iterations`. `monolithic`: 1 solves each step
//! on all unknowns with a sparse LU of K + Bᵀ C B, C the stiffness of the springs in contact, as papers usually run the
//! method; the iterates are the same.
//!
//! # Guarantees
//! Without friction the penalised energy is convex: the solution is unique, and Newton's method on a piecewise linear
//! gradient ends after finitely many steps. With friction quadratic convergence at regular points. A claim is judged
//! before it is made; if it would be false, Newton's method goes on, at most three times, and then ends as `stalled`.
//!
//! # Skips
//! An open crack is one linear solve. Open points leave the dense LU; without friction there are no tangential rows.
//!
//! # Failure modes
//! With large μ the Newton iteration may cycle. Large k does no harm here, unlike in K + k Bᵀ B: the springs are added
//! to W as compliances 1/k.

use crate::condensed::problem::{Begin, Reduced};
use crate::newton::springs::{Springs, recorded};
use crate::newton::step::{MONOLITHIC, Tangent};
use crate::own_laws::confirm::confirm;
use crate::{
    Claim, ContactSystem, Enforcement, Increment, Method, MethodError, Monitor, OptionSpec,
    Options, Outcome, Status,
};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "penalty",
    label: "Penalty, return mapping",
    reference: "Simo & Laursen, Comput. Struct. 42 (1992) 97; Wriggers, Computational Contact Mechanics (2006)",
    summary: "replaces the contact laws by stiff springs with a frictional return mapping; its error falls like 1/stiffness",
    exact: false,
    options: &OPTIONS,
    source: include_str!("penalty.rs"),
    build: |options| Ok(Box::new(Penalty::new(options))),
};

static OPTIONS: [OptionSpec; 4] = [
    OptionSpec {
        name: "normal",
        unit: "-",
        default: 1e4,
        min: 1e-2,
        max: 1e10,
        integer: false,
        help: "normal penalty stiffness as a multiple of rho = rows/trace(W)",
    },
    OptionSpec {
        name: "tangential",
        unit: "-",
        default: 1e4,
        min: 1e-2,
        max: 1e10,
        integer: false,
        help: "tangential penalty stiffness as a multiple of rho",
    },
    OptionSpec {
        name: "max_iterations",
        unit: "-",
        default: 100.0,
        min: 1.0,
        max: 1e6,
        integer: true,
        help: "Newton steps before giving up",
    },
    MONOLITHIC,
];

/// The penalised equations are solved this much more accurately than asked, because the judge holds the claim to them in
/// another norm; and again by this much after every claim that he would reject.
const CLAIM_FRACTION: f64 = 0.1;

struct Penalty {
    normal: f64,
    tangential: f64,
    max_iterations: usize,
    tangent: Tangent,
}

impl Penalty {
    fn new(options: &Options) -> Self {
        Self {
            normal: options.own("normal"),
            tangential: options.own("tangential"),
            max_iterations: options.own("max_iterations") as usize,
            tangent: Tangent::new(options),
        }
    }
}

impl Enforcement for Penalty {
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
        let claim = |rho: f64| Claim::Penalised {
            normal: self.normal * rho,
            tangential: self.tangential * rho,
        };
        let mut problem = match Reduced::begin(increment, claim)? {
            Begin::Done(outcome) => return Ok(outcome),
            Begin::Contact(problem) => problem,
        };
        let rho = problem.condensed.rho;
        // Springs start unloaded along the normal, and loaded by the friction force of the start along the tangent.
        let mut anchor = problem.rows.restrict(&increment.start.p);
        for &row in &problem.rows.start[..problem.rows.points()] {
            anchor[row] = 0.0;
        }
        let springs = Springs {
            normal: self.normal * rho,
            tangential: self.tangential * rho,
            anchor,
            coupled: None,
        };

        let p = problem.start_forces();
        let beta = problem.start_amplitudes(&p);
        let mut start = springs.predict(&problem, &p, beta);
        let (mut stop, mut corrections) = (CLAIM_FRACTION * problem.stop, 0);

        let (status, end) = loop {
            let left = (self.max_iterations).saturating_sub(problem.history.len());
            let report = recorded(monitor, |problem, at| problem.jump(&at.p, &at.beta));
            let tangent = &mut self.tangent;
            let (status, mut end) =
                springs.solve(&mut problem, start, stop, left, tangent, report)?;
            problem.rebalance(&mut end.p);
            // Stalled: solved to rounding, which may be enough.
            if status != Status::Converged && status != Status::Stalled {
                break (status, end);
            }
            match confirm(&mut problem, &end.p, &end.beta, &mut corrections)? {
                Some(status) => break (status, end),
                None if problem.counters.iterations >= self.max_iterations => {
                    break (Status::MaxIterations, end);
                }
                None => {
                    stop *= CLAIM_FRACTION;
                    start = springs.predict(&problem, &end.p, end.beta);
                }
            }
        };
        problem.finish(status, &end.p, &end.beta)
    }
}
