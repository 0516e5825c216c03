//! Coulomb friction as the fixed point of a convex problem with one parameter per point: the loop of `socp` and `tresca`.
//! ```text
//! (P, β) <- cone program with parameter a          to a tolerance that follows the natural map
//! a <- parameter of (P, v), accelerated by Anderson's method
//! stuck:  once more from the forces of a tied crack
//! polish: Newton's method of Alart and Curnier once the natural map is below 1e-6, or the programs have reached their floor
//! ```

#![allow(non_snake_case)]

use crate::condensed::branches::Branches;
use crate::condensed::problem::{Begin, Limits, Reduced};
use crate::condensed::starts::tied_forces;
use crate::conic::anderson::Anderson;
use crate::conic::cone_program::{ConeProgram, Law, TIGHTEST};
use crate::contract::state::{Claim, Monitor, Outcome, Status};
use crate::contract::system::Increment;
use crate::error::MethodError;
use crate::newton::iteration::{Iterate, Safeguards, newton};
use crate::newton::newton_ac::AlartCurnier;
use crate::newton::step::Tangent;
use crate::{OptionSpec, Options};

/// Tolerance of a cone program, relative to the natural map before it.
const LOOSE: f64 = 1e-3;
/// Tolerance of a cone program after a step that has not halved the natural map, relative to the one before.
const TIGHTEN: f64 = 1e-2;
/// Natural map below which Newton's method takes over.
const POLISH: f64 = 1e-6;
/// Natural map above which programs that make no progress are not at their floor but cycle.
const CYCLING: f64 = 1e-3;
/// Steps without progress after which the iteration counts as stalled.
const PATIENCE: usize = 20;
/// The same while polishing, counted from the best of the programs.
const POLISH_PATIENCE: usize = 30;

/// What both methods can be told.
pub(crate) static OPTIONS: [OptionSpec; 3] = [
    OptionSpec {
        name: "max_iterations",
        unit: "-",
        default: 200.0,
        min: 1.0,
        max: 1e6,
        integer: true,
        help: "cone programs and Newton steps before giving up",
    },
    OptionSpec {
        name: "anderson",
        unit: "-",
        default: 5.0,
        min: 0.0,
        max: 20.0,
        integer: true,
        help: "differences that Anderson acceleration keeps; 0: the plain fixed point",
    },
    OptionSpec {
        name: "polish",
        unit: "-",
        default: 1.0,
        min: 0.0,
        max: 1.0,
        integer: true,
        help: "1: finish by Newton steps, which reach what the cone programs cannot",
    },
];

/// The fixed point of one law.
pub(crate) struct FixedPoint {
    max_iterations: usize,
    anderson: usize,
    polish: bool,
    law: Law,
    /// a of one point from μ, P, v.
    parameter: fn(f64, &[f64], &[f64]) -> f64,
}

impl FixedPoint {
    /// As the options say.
    pub fn new(options: &Options, law: Law, parameter: fn(f64, &[f64], &[f64]) -> f64) -> Self {
        Self {
            max_iterations: options.own("max_iterations") as usize,
            anderson: options.own("anderson") as usize,
            polish: options.own("polish") == 1.0,
            law,
            parameter,
        }
    }

    /// Solves one increment.
    pub fn solve(
        &self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        let mut problem = match Reduced::begin(increment, |_| Claim::Exact)? {
            Begin::Done(outcome) => return Ok(outcome),
            Begin::Contact(problem) => problem,
        };
        let limits = Limits {
            iterations: self.max_iterations,
            patience: PATIENCE,
        };
        let mut x = Iterate::start(&problem);
        let mut program = ConeProgram::new(&problem, self.law, &x.P)?;
        let mut anderson = Anderson::new(self.anderson);
        let mut branches = Branches::default();
        let mut accuracy = Accuracy::new(&problem);
        let mut restarted = false;

        let status = loop {
            let v = problem.jump(&x.P, &x.beta);
            let natural_map = problem.natural_map(&x.P, &v);
            if self.polish && at_floor(&problem, natural_map) {
                let (status, polished) = polish(&mut problem, x, limits, monitor)?;
                x = polished;
                break status;
            }
            if stuck(&problem, natural_map) && !restarted {
                restarted = true;
                problem.begin_phase();
                anderson = Anderson::new(self.anderson);
                if let Some(tied) = tied_forces(&problem) {
                    let beta = problem.start_amplitudes(&tied);
                    x = Iterate { P: tied, beta };
                    continue;
                }
            }
            let changes = branches.changes(&problem, &x.P, &v);
            if let Some(status) = problem.ends(natural_map, changes, limits, monitor) {
                match problem.confirm(status, &x.P, &x.beta)? {
                    Some(status) => break status,
                    None => {
                        // q has changed.
                        program = ConeProgram::new(&problem, self.law, &x.P)?;
                        continue;
                    }
                }
            }
            let a = anderson.next(self.parameters(&problem, &x.P, &v));
            let solution = program.solve(&a, accuracy.next(natural_map))?;
            problem.counters.factorisations += solution.factorisations;
            let Some((P, beta)) = solution.forces else {
                break problem.singular();
            };
            x = Iterate { P, beta };
            problem.rebalance(&mut x.P);
        };
        problem.finish(status, &x.P, &x.beta)
    }

    fn parameters(&self, problem: &Reduced<'_>, P: &[f64], v: &[f64]) -> Vec<f64> {
        let points = 0..problem.rows.points();
        points
            .map(|i| {
                let rows = problem.rows.of(i);
                (self.parameter)(problem.friction(i), &P[rows.clone()], &v[rows])
            })
            .collect()
    }
}

/// Whether Newton's method should take over: not before the fixed point has done its work, and not if that is enough.
fn at_floor(problem: &Reduced<'_>, natural_map: f64) -> bool {
    let at_floor = problem.stagnates() && natural_map <= CYCLING;
    natural_map > problem.stop && (natural_map <= POLISH || at_floor)
}

/// Whether the fixed point cycles or runs away, as where a wedge locks: μ P_n then grows faster than the bound it came from.
fn stuck(problem: &Reduced<'_>, natural_map: f64) -> bool {
    problem.stagnates() && natural_map > CYCLING
}

/// A few Newton steps.
fn polish(
    problem: &mut Reduced<'_>,
    x: Iterate,
    limits: Limits,
    monitor: &mut dyn Monitor,
) -> Result<(Status, Iterate), MethodError> {
    let limits = Limits {
        patience: POLISH_PATIENCE,
        ..limits
    };
    let safeguards = Safeguards {
        line_search: true,
        rescue: false,
    };
    let (tangent, how) = (&mut Tangent::Condensed, (limits, safeguards));
    newton(&AlartCurnier, problem, tangent, (x, 1.0), how, monitor)
}

/// How accurately the next program is solved: far from the fixed point its last digits would be thrown away.
struct Accuracy {
    tolerance: f64,
    natural_map: f64,
}

impl Accuracy {
    /// Without friction the first program is the solution.
    fn new(problem: &Reduced<'_>) -> Self {
        let frictionless = problem.len() == problem.rows.points();
        Self {
            tolerance: if frictionless { TIGHTEST } else { LOOSE },
            natural_map: f64::INFINITY,
        }
    }

    fn next(&mut self, natural_map: f64) -> f64 {
        let slow = natural_map > 0.5 * self.natural_map;
        let wanted = if slow {
            TIGHTEN * self.tolerance
        } else {
            LOOSE * natural_map
        };
        self.tolerance = wanted.clamp(TIGHTEST, self.tolerance);
        self.natural_map = natural_map;
        self.tolerance
    }
}
