//! Coulomb friction as the fixed point of a convex problem with one parameter per point: the loop of `socp` and `tresca`.
//! ```text
//! (P, β) <- convex program with parameter a        to a tolerance that follows the natural map
//! a <- parameter of (P, v), accelerated by Anderson's method
//! stuck:  once more from the forces of a tied crack
//! polish: Newton's method of Alart and Curnier once the natural map is below 1e-6, or the programs have reached their floor
//! ```

#![allow(non_snake_case)]

use crate::condensed::anderson::Anderson;
use crate::condensed::branches::Branches;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::condensed::starts::tied_forces;
use crate::contract::options::{Options, options};
use crate::contract::state::Monitor;
use crate::error::MethodError;
use crate::newton::iteration::Newton;
use crate::newton::newton_ac::AlartCurnier;
use crate::newton::step::Tangent;

/// Tolerance beyond which clarabel falls back to a worse iterate more often than it gains a digit.
pub(crate) const TIGHTEST: f64 = 1e-11;
/// Tolerance of a program, relative to the natural map before it.
const LOOSE: f64 = 1e-3;
/// Tolerance of a program after a step that has not halved the natural map, relative to the one before.
const TIGHTEN: f64 = 1e-2;
/// Natural map below which Newton's method takes over.
const POLISH: f64 = 1e-6;
/// Natural map above which programs that make no progress are not at their floor but cycle.
const CYCLING: f64 = 1e-3;
/// Steps without progress after which the iteration counts as stalled.
const PATIENCE: usize = 20;
/// The same once programs are as accurate as they get, near the solution.
const FLOOR_PATIENCE: usize = 5;
/// The same while polishing, counted from the best of the programs.
const POLISH_PATIENCE: usize = 30;

options! {
    Settings {
        max_iterations: Count(200, 1, 1_000_000), "convex programs and Newton steps before giving up";
        anderson: Count(Settings::ANDERSON, 0, 20), "differences that Anderson acceleration keeps; 0: the plain fixed point";
        polish: Switch(true), "1: finish by Newton steps, which reach what the programs cannot";
    }
}

impl Settings {
    /// Differences kept by default.
    const ANDERSON: i64 = 5;
}

/// The convex problem of one parameter per point.
pub(crate) trait Program {
    /// `None` if no force fulfils the constraints.
    fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        a: &[f64],
        tolerance: f64,
    ) -> Result<Option<Forces>, MethodError>;
}

/// The program of an increment.
pub(crate) type NewProgram = fn(&ContactProblem<'_>) -> Result<Box<dyn Program>, MethodError>;
/// a of one point from μ, P, v.
pub(crate) type Parameter = fn(f64, &[f64], &[f64]) -> f64;

/// The fixed point of one law.
pub(crate) struct FixedPoint {
    settings: Settings,
    program: NewProgram,
    parameter: Parameter,
}

impl FixedPoint {
    /// As the options say.
    pub fn new(options: &Options, program: NewProgram, parameter: Parameter) -> Self {
        Self {
            settings: Settings::new(options),
            program,
            parameter,
        }
    }

    /// A few Newton steps.
    fn polished(
        &self,
        problem: &mut ContactProblem<'_>,
        x: Forces,
        monitor: &mut dyn Monitor,
    ) -> Result<End, MethodError> {
        let limits = Limits::new(self.settings.max_iterations, POLISH_PATIENCE);
        let mut newton = Newton::plain(AlartCurnier, limits, Tangent::default());
        newton.run(problem, x, monitor)
    }

    fn parameters(&self, problem: &ContactProblem<'_>, P: &[f64], v: &[f64]) -> Vec<f64> {
        let points = 0..problem.rows.points();
        points
            .map(|i| {
                let rows = problem.rows.of(i);
                (self.parameter)(problem.friction(i), &P[rows.clone()], &v[rows])
            })
            .collect()
    }
}

impl CondensedMethod for FixedPoint {
    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let mut x = problem.start();
        let mut program = (self.program)(problem)?;
        let mut anderson = Anderson::new(self.settings.anderson);
        let mut branches = Branches::default();
        let mut accuracy = Accuracy::new(problem);
        let mut restarted = false;
        loop {
            let v = problem.jump(&x.p, &x.beta);
            let violation = problem.violation(&x.p, &v);
            let patience = accuracy.patience(violation);
            if self.settings.polish && at_floor(problem, violation, patience) {
                return self.polished(problem, x, monitor);
            }
            if stuck(problem, violation) && !restarted {
                restarted = true;
                problem.begin_phase();
                anderson = Anderson::new(self.settings.anderson);
                if let Some(p) = tied_forces(problem) {
                    let beta = problem.start_amplitudes(&p);
                    x = Forces { p, beta };
                    continue;
                }
            }
            let limits = Limits::new(self.settings.max_iterations, patience);
            let changes = branches.changes(problem, &x.p, &v);
            match problem.check(violation, (&x.p, &x.beta), changes, limits, monitor)? {
                Check::GoOn => {}
                Check::Corrected => {
                    // The program holds q.
                    program = (self.program)(problem)?;
                    continue;
                }
                Check::End(status) => return Ok(End { status, at: x }),
            }
            let mut a = self.parameters(problem, &x.p, &v);
            anderson.next(&mut a);
            let Some(next) = program.solve(problem, &a, accuracy.next(violation))? else {
                // On a loose piece without load the cones have no interior.
                if self.settings.polish && violation <= POLISH {
                    return self.polished(problem, x, monitor);
                }
                let status = problem.singular();
                return Ok(End { status, at: x });
            };
            x = next;
            problem.rebalance(&mut x.p);
        }
    }
}

/// Whether Newton's method should take over: not before the fixed point has done its work, and not if that is enough.
fn at_floor(problem: &ContactProblem<'_>, violation: f64, patience: usize) -> bool {
    let idle = problem.stagnates() || problem.idle() >= patience;
    let at_floor = idle && violation <= CYCLING;
    violation > problem.stop && (violation <= POLISH || at_floor)
}

/// Whether the fixed point cycles or runs away, as where a wedge locks: μ P_n then grows faster than the bound it came from.
fn stuck(problem: &ContactProblem<'_>, violation: f64) -> bool {
    problem.stagnates() && violation > CYCLING
}

/// How accurately the next program is solved: far from the fixed point its last digits would be thrown away.
struct Accuracy {
    tolerance: f64,
    violation: f64,
}

impl Accuracy {
    /// Without friction the first program is the solution.
    fn new(problem: &ContactProblem<'_>) -> Self {
        let frictionless = problem.len() == problem.rows.points();
        Self {
            tolerance: if frictionless { TIGHTEST } else { LOOSE },
            violation: f64::INFINITY,
        }
    }

    fn next(&mut self, violation: f64) -> f64 {
        let slow = violation > 0.5 * self.violation;
        let wanted = if slow {
            TIGHTEN * self.tolerance
        } else {
            LOOSE * violation
        };
        self.tolerance = wanted.clamp(TIGHTEST, self.tolerance);
        self.violation = violation;
        self.tolerance
    }

    /// Steps without progress that are enough to give up.
    fn patience(&self, violation: f64) -> usize {
        if self.tolerance <= TIGHTEST && violation <= CYCLING {
            FLOOR_PATIENCE
        } else {
            PATIENCE
        }
    }
}
