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
//! `max_iterations`. `monolithic`: 1 solves each step on all unknowns of the body, as
//! papers usually run the method; the iterates are the same.
//!
//! # Guarantees
//! Without friction the penalised energy is convex: the solution is unique, and Newton's method on a piecewise linear
//! gradient ends after finitely many steps. With friction quadratic convergence at regular points. A claim is judged
//! before it is made; if it would be false, Newton's method goes on, at most three times, and then ends as `stalled`.
//!
//! # Skips
//! An open crack is one linear solve. Open points leave the dense LU; without friction there are no tangential rows. A tangent that has
//! not changed is not factored again; on 256 active rows and more, nor is one of which few rows have.
//!
//! # Failure modes
//! With large μ the Newton iteration may cycle. Large k does no harm here, unlike in K + k Bᵀ B: the springs are added
//! to W as compliances 1/k.

use crate::condensed::forces::{End, Ended};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::ContactProblem;
use crate::contract::options::{Options, options};
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Claim, Monitor, Status};
use crate::contract::system::ContactSystem;
use crate::newton::springs::{SpringNewton, Springs, recorded};
use crate::newton::step::Tangent;
use crate::own_laws::confirm::confirm;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "penalty",
    label: "Penalty, return mapping",
    reference: "Simo & Laursen, Comput. Struct. 42 (1992) 97; Wriggers, Computational Contact Mechanics (2006)",
    summary: "replaces the contact laws by stiff springs with a frictional return mapping; its error falls like 1/stiffness",
    exact: false,
    options: Settings::OPTIONS,
    source: include_str!("penalty.rs"),
    build: |options| Box::new(Penalty::new(options)),
};

options! {
    Settings {
        normal: Real(1e4, 1e-2, 1e10), "normal penalty stiffness as a multiple of rho = rows/trace(W)";
        tangential: Real(1e4, 1e-2, 1e10), "tangential penalty stiffness as a multiple of rho";
        max_iterations: Count(100, 1, 1_000_000), "Newton steps before giving up";
        monolithic: Switch(false), Tangent::HELP;
    }
}

/// The penalised equations are solved this much more accurately than asked, because the judge holds the claim to them in
/// another norm; and again by this much after every claim that he would reject.
const CLAIM_FRACTION: f64 = 0.1;

struct Penalty {
    settings: Settings,
    newton: SpringNewton,
}

impl Penalty {
    fn new(options: &Options) -> Self {
        let settings = Settings::new(options);
        Self {
            newton: SpringNewton::new(Tangent::new(settings.monolithic)),
            settings,
        }
    }
}

impl CondensedMethod for Penalty {
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        self.newton.tangent.refuses(system)
    }

    fn needs(&self) -> Needs {
        self.newton.tangent.needs()
    }

    fn claim(&self, rho: f64) -> Claim {
        Claim::Penalised {
            normal: self.settings.normal * rho,
            tangential: self.settings.tangential * rho,
        }
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let end = self.rounds(problem, monitor);
        self.newton.tangent.forget();
        end
    }
}

impl Penalty {
    /// Newton's method, again and more accurately where its claim would be false.
    fn rounds(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let rho = problem.operator.rho;
        // Springs start unloaded along the normal, and loaded by the friction force of the start along the tangent.
        let mut anchor = problem.rows.restrict(&problem.increment.start.p);
        for &row in problem.rows.normal() {
            anchor[row] = 0.0;
        }
        let stiffness = [self.settings.normal, self.settings.tangential].map(|k| k * rho);
        let springs = Springs::new(problem, stiffness.into(), anchor, None);
        let newton = &mut self.newton;
        newton.start(problem, &springs, &problem.start());
        let (mut stop, mut corrections) = (CLAIM_FRACTION * problem.stop, 0);
        loop {
            let left = (self.settings.max_iterations).saturating_sub(problem.history.len());
            let report = recorded(monitor, |problem, at| problem.jump(&at.p, &at.beta));
            let status = newton.solve(problem, &springs, stop, left, report)?;
            let mut at = newton.at.forces.clone();
            problem.rebalance(&mut at.p);
            // Stalled: solved to rounding, which may be enough.
            if status != Status::Converged && status != Status::Stalled {
                return Ok(End { status, at });
            }
            if let Some(status) = confirm(problem, &at.p, &at.beta, &mut corrections)? {
                return Ok(End { status, at });
            }
            if problem.counters.iterations >= self.settings.max_iterations {
                let status = Status::MaxIterations;
                return Ok(End { status, at });
            }
            stop *= CLAIM_FRACTION;
            newton.start(problem, &springs, &at);
        }
    }
}
