//! Hybrid method: Newton's method, at once where its steps are cheap, else after first-order sweeps have chosen the states of the
//! points; along the path of an interior-point method where both fail.
//!
//! Sweeps: Jourdan, Alart & Jean, Comput. Meth. Appl. Mech. Engng 155 (1998) 31 (see `nsgs`). Newton: Hüeber, Stadler &
//! Wohlmuth 2008 (see `pdas`) and Christensen, Klarbring, Pang & Strömberg 1998 (see `b-newton`). That Newton methods should be
//! started by, and fall back on, Gauss–Seidel sweeps is the experience of Acary, Brémond & Huber, "On solving contact
//! problems with Coulomb friction: formulations and numerical comparisons" (2018).
//!
//! ```text
//! x from the start of the increment
//! y <- Newton from x, Alart–Curnier                   where a step costs less than the sweeps: on at most 150 rows, and on
//!                                                     floating pieces in 2D; where pieces float, with rescues
//! for round = 0, …, 4
//!   x <- s sweeps from x,  s = first · 2^round        a globally sound, slow method
//!   y <- Newton from x, active sets                   a locally fast one, stopped after 8 steps without progress
//!   if W is sparse, or the tangent singular:          granular media, redundant points: every later round would fail, too
//!     y <- interior-point from the start, Newton from near its end, active sets;  leave the rounds
//!   y <- Newton from x, B-differentiable              it cycles elsewhere
//! y <- ipm-anm from the start                         the slowest, and the one that solves most
//! until the natural map of y, or of x, is small
//! ```
//! After sweeps the damped tangent of the active sets comes first because undamped ones waste steps where many points in 3D turn their
//! slip: on a slab of 1980 points 10 steps against 61 of Alart and Curnier's. Floating pieces in 2D are slid through by rescues
//! from the start, and few rows of the tangent change: three blocks with 242 points take 8 steps with 4 factorisations, not 31 with 49.
//!
//! A Newton run that fails leaves no trace: the sweeps go on from where they were. Where contact points are redundant, as in packings
//! of rigid bodies, sweeps creep and Newton's tangents are singular, while inside the cones the matrix is regular.
//!
//! # Options
//! `first`: sweeps of the first round. `r`: scale of the first Newton run of an increment, as in `pdas`. If it is not 1 that run ends after
//! 12 steps, and all others have r = 1: a wrong r costs no more than these steps. `max_iterations`: sweeps and Newton steps together.
//!
//! # Guarantees
//! Near a regular solution, quadratic. With friction there is no proof, only several methods that would all have to fail on the same
//! problem. `stickslip study random` with seed 1, 200 problems for
//! each of seven μ from 0 to 5 in 2D and 3D, tier high: all 2800 solved, in 2 to 7 iterations in the median.
//!
//! # Failure modes
//! Ends as `ipm-anm` does, after at most 1000 steps of it.
//!
//! # Skips
//! An open crack is one linear solve. Most problems of few rows end in one to four Newton steps without any sweep, most others in the
//! first round: a few sweeps and three to six Newton steps.

#![allow(non_snake_case)]

use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{ContactProblem, Limits};
use crate::condensed::saddle::{self, Saddle};
use crate::condensed::sweeps::Sweeps;
use crate::contract::law::Branch;
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;
use crate::newton::b_newton::BEquations;
use crate::newton::interior_point::{FRACTION, NEAR, along_path};
use crate::newton::ipm_anm::{self, along_series};
use crate::newton::iteration::Newton;
use crate::newton::newton_ac::AlartCurnier;
use crate::newton::pdas::Sets;
use crate::newton::scheme::Scheme;
use crate::newton::step::Tangent;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "hybrid",
    label: "Hybrid of Newton and sweeps",
    reference: "Acary, Brémond & Huber (2018), in Advanced Topics in Nonsmooth Dynamics, Springer",
    summary: "Newton's method, at once where its steps are cheap, else after a few Gauss-Seidel sweeps, in rounds with ever more of them until one succeeds",
    exact: true,
    options: Hybrid::OPTIONS,
    source: include_str!("hybrid.rs"),
    build: |options| {
        Box::new(Solver {
            settings: Hybrid::new(options),
            tangent: Tangent::default(),
        })
    },
};

options! {
    Hybrid {
        r: Real(1.0, 1e-3, 1e3), "multiple of 1/W_ii that turns gaps and slips into forces";
        max_iterations: Count(50_000, 1, 100_000_000), "sweeps and Newton steps before giving up";
        first: Count(5, 1, 10_000), "sweeps of the first round";
    }
}

/// Rows up to which Newton's method is tried before any sweeps, whatever the body.
const FEW: usize = 150;
/// Newton steps without progress after which a run is given up.
const NEWTON_PATIENCE: usize = 8;
/// Most steps of a Newton run with another scale than the natural one, or where W is sparse: there it cycles, or is done by then.
const SHORT_STEPS: usize = 12;
/// Interior-point steps without progress after which its path is followed by series.
const PATH_PATIENCE: usize = 6;
/// Rounds of sweeps before the last method.
const ROUNDS: usize = 5;
/// Most steps of the interior-point method, and of the one that follows its path.
const SHARE: usize = 200;
const LAST: usize = 1000;

/// The method with the memory of its Newton runs.
struct Solver {
    settings: Hybrid,
    tangent: Tangent,
}

impl CondensedMethod for Solver {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let settings = self.settings;
        let mut runs = NewtonRuns {
            multiple: settings.r,
            settings,
            tangent: &mut self.tangent,
        };
        let floats = problem.modes() > 0;
        if problem.len() <= FEW || (floats && problem.increment.system.dim() == 2) {
            let newton = Newton {
                // A tangent that leaves a piece loose is nothing that sweeps would mend.
                rescue: floats,
                ..runs.newton(AlartCurnier)
            };
            let end = runs.run(newton, problem.start(), problem, monitor)?;
            if end.is_final() {
                return Ok(end);
            }
            problem.begin_again();
        }
        let sparse = problem.operator.w.sparse().is_some();
        let mut sweeps = Started::new(problem);
        for round in 0..ROUNDS {
            let limits = Limits::new(settings.max_iterations, usize::MAX / 2);
            if let Some(end) = sweeps.sweep(settings.first << round, limits, problem, monitor)? {
                return Ok(end);
            }
            let newton = Newton {
                regularise: false,
                ..runs.newton(Sets)
            };
            let end = runs.run(newton, sweeps.reached(problem), problem, monitor)?;
            if end.is_final() {
                return Ok(end);
            }
            if sparse || end.status == Status::SingularTangent {
                problem.begin_again();
                let limits = runs.within(SHARE, PATH_PATIENCE, problem);
                let end = along_path(problem, FRACTION, NEAR, limits, monitor)?;
                if end.is_final() {
                    return Ok(end);
                }
                break;
            }
            let newton = runs.newton(BEquations);
            let end = runs.run(newton, sweeps.reached(problem), problem, monitor)?;
            if end.is_final() {
                return Ok(end);
            }
        }
        problem.begin_again();
        let limits = runs.within(LAST, usize::MAX / 2, problem);
        along_series(problem, ipm_anm::SERIES, limits, monitor)
    }
}

/// Runs of Newton's method, each stopped soon after it makes no progress.
struct NewtonRuns<'s> {
    /// r of the next one: as given, from the first that fails 1.
    multiple: f64,
    settings: Hybrid,
    /// Its memory serves all runs.
    tangent: &'s mut Tangent,
}

impl NewtonRuns<'_> {
    fn newton<S: Scheme>(&mut self, scheme: S) -> Newton<S> {
        let limits = Limits::new(self.settings.max_iterations, NEWTON_PATIENCE);
        Newton {
            multiple: self.multiple,
            ..Newton::plain(scheme, limits, std::mem::take(self.tangent))
        }
    }

    fn run<S: Scheme>(
        &mut self,
        mut newton: Newton<S>,
        start: Forces,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Ended {
        problem.begin_phase();
        if self.multiple != 1.0 || problem.operator.w.sparse().is_some() {
            newton.limits = self.within(SHORT_STEPS, NEWTON_PATIENCE, problem);
        }
        let end = newton.run(problem, start, monitor);
        (self.multiple, *self.tangent) = (1.0, newton.tangent);
        end
    }

    /// Limits of a method that begins now.
    fn within(&self, steps: usize, patience: usize, problem: &ContactProblem<'_>) -> Limits {
        let most = problem.counters.iterations + steps;
        Limits::new(most.min(self.settings.max_iterations), patience)
    }
}

/// Sweeps from the start of the increment.
struct Started {
    saddle: Saddle,
    sweeps: Sweeps,
    x: saddle::Iterate,
    branches: Vec<Branch>,
}

impl Started {
    fn new(problem: &ContactProblem<'_>) -> Self {
        let saddle = Saddle::new(problem.operator.clone());
        Self {
            sweeps: Sweeps::new(problem, &saddle),
            x: saddle.start(problem),
            saddle,
            branches: vec![Branch::Open; problem.rows.points()],
        }
    }

    /// So many more; how the method ends, if it does.
    fn sweep(
        &mut self,
        count: usize,
        limits: Limits,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<End>, MethodError> {
        problem.begin_phase();
        self.saddle.refresh(problem, &mut self.x);
        let mut changes = 0;
        for _ in 0..count {
            let (saddle, x) = (&self.saddle, &mut self.x);
            if let Some(status) = saddle.ends(problem, x, changes, limits, monitor)? {
                let at = self.reached(problem);
                return Ok(Some(End { status, at }));
            }
            saddle.update_multipliers(problem, x);
            changes = (self.sweeps).sweep(problem, saddle, 1.0, x, &mut self.branches);
        }
        Ok(None)
    }

    fn reached(&self, problem: &ContactProblem<'_>) -> Forces {
        let (p, beta) = self.saddle.balanced(problem, &self.x);
        Forces { p, beta }
    }
}
