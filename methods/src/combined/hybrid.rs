//! Hybrid method: Newton's method, at once where its steps are cheap, else after first-order sweeps have chosen the states of the points.
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
//! for round = 0, 1, 2, …
//!   x <- s sweeps from x,  s = first · 2^round        a globally sound, slow method
//!   y <- Newton from x, active sets                   a locally fast one, stopped after 8 steps without progress
//!   y <- Newton from x, B-differentiable              if that failed: it cycles elsewhere
//! until the natural map of y, or of x, is small
//! ```
//! After sweeps the damped tangent of the active sets comes first because undamped ones waste steps where many points in 3D turn their
//! slip: on a slab of 1980 points 10 steps against 61 of Alart and Curnier's. Floating pieces in 2D are slid through by rescues
//! from the start, and few rows of the tangent change: three blocks with 242 points take 8 steps with 4 factorisations, not 31 with 49.
//!
//! A Newton run that fails leaves no trace: the sweeps go on from where they were, so that the method is never worse than
//! the sweeps alone by more than a few Newton steps a round. Rounds grow to 640 sweeps. Before the first of that size
//! the methods of other families are tried from the start of the increment, once: `interior-point`, `pdas` with its rescues,
//! `socp` if W is symmetric. Where the others cycle one of them often finds a way. Rounds of that size that do not halve the
//! natural map halve the relaxation of the sweeps (large μ), down to 1/16; after that everything starts again, up
//! to eight times: from the forces of a tied crack, from the normal forces reached without any friction, and from ever
//! more stages of an alternating method (LATIN).
//!
//! Where contact points are redundant, as in packings of rigid bodies, `interior-point` comes as early as after the second
//! round: sweeps then creep, and Newton's tangents are singular. On packings of 70 to 80 spheres, 237 to 289 points with two
//! fifths of the rows of W redundant, it takes 15 to 18 steps where sweeps stall at 1e-5.
//!
//! # Options
//! `first`: sweeps of the first round. `r`: scale of the first Newton run of an increment, as in `pdas`. If it is not 1 that run ends after
//! 12 steps, and all others have r = 1: a wrong r costs no more than these steps. `max_iterations`: sweeps and Newton steps together.
//!
//! # Guarantees
//! Those of the sweeps: convergence without friction. Near a regular solution, quadratic. With friction there is no proof,
//! only several methods that would all have to fail on the same problem. `stickslip study random` with seed 1, 200 problems for
//! each of seven μ from 0 to 5 in 2D and 3D, tier high: all 2800 solved, in 2 to 7 iterations in the median.
//!
//! # Failure modes
//! Ends with `max-iterations`, or `stalled` after the last restart.
//!
//! # Skips
//! An open crack is one linear solve. Most problems of few rows end in one to four Newton steps without any sweep, most others in the
//! first round: a few sweeps and three to six Newton steps.

#![allow(non_snake_case)]

use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::point_row::{Bordered, Law};
use crate::condensed::problem::{ContactProblem, Limits};
use crate::condensed::saddle::{self, Saddle};
use crate::condensed::stages::alternate;
use crate::condensed::starts::tied_forces;
use crate::condensed::sweeps::Sweeps;
use crate::conic::socp;
use crate::contract::law::{Branch, return_map};
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;
use crate::newton::b_newton::BEquations;
use crate::newton::interior_point::{self, along_path};
use crate::newton::iteration::{self, Newton};
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
/// Most steps of a Newton run with another scale than the natural one.
const SCALED_STEPS: usize = 12;
/// Most sweeps of a round.
const MAX_SWEEPS: usize = 640;
/// A round of sweeps counts as progress if it brings the natural map below this fraction of the best before.
const PROGRESS: f64 = 0.5;
/// Smallest relaxation of the sweeps.
const LEAST_RELAXATION: f64 = 0.1;
/// Where points are redundant, sweeps of a round before the interior-point method, as a multiple of the first: those of the
/// second round.
const EARLY: usize = 2;
/// Most iterations of each method of another family.
const SHARE: usize = 200;
/// Restarts before the method gives up.
const MAX_RESTARTS: usize = 8;
/// Sweeps of the first round after a restart.
const RESTART_SWEEPS: usize = 20;

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
        let mut runs = NewtonRuns {
            multiple: self.settings.r,
            settings: self.settings,
            tangent: &mut self.tangent,
        };
        let floats = problem.modes() > 0;
        if problem.len() <= FEW || (floats && problem.increment.system.dim() == 2) {
            let start = problem.start();
            // A tangent that leaves a piece loose is nothing that sweeps would mend.
            if let Some(end) = runs.from(start, AlartCurnier, floats, problem, monitor)? {
                return Ok(end);
            }
            problem.begin_again();
        }
        let mut rounds = Rounds::new(problem, runs);
        loop {
            if let Some(end) = rounds.sweep(problem, monitor)? {
                return Ok(end);
            }
            if let Some(end) = rounds.newton(Sets, problem, monitor)? {
                return Ok(end);
            }
            if let Some(end) = rounds.newton(BEquations, problem, monitor)? {
                return Ok(end);
            }
            if let Some(end) = rounds.others(problem, monitor)? {
                return Ok(end);
            }
            if !rounds.next(problem)? {
                let (status, at) = (Status::Stalled, rounds.best);
                return Ok(End { status, at });
            }
        }
    }
}

/// The sweeps and what is tried from them.
struct Rounds<'s> {
    saddle: Saddle,
    sweeps: Sweeps,
    x: saddle::Iterate,
    branches: Vec<Branch>,
    /// Sweeps of the round.
    count: usize,
    relaxation: f64,
    /// Natural map after the last sweep, and the least of all rounds from the same start.
    reached: (f64, f64),
    /// Restarts so far.
    restarts: usize,
    runs: NewtonRuns<'s>,
    /// Whether the other methods were tried, and whether the interior-point method was.
    tried: bool,
    pathed: bool,
    /// Where the sweeps ended last.
    best: Forces,
}

/// Whether contact points are redundant: the matrix of all points tied is singular.
fn redundant(problem: &mut ContactProblem<'_>) -> bool {
    problem.counters.factorisations += 1;
    let all: Vec<usize> = (0..problem.len()).collect();
    let (unit, none) = (problem.operator.rho, vec![[0.0; 3]; problem.len()]);
    let mut tied = none.clone();
    for own in problem.rows.iter() {
        own.clone()
            .zip(0..)
            .for_each(|(k, l): (usize, usize)| tied[k][l] = unit);
    }
    let law = Law::Rows { a: &none, c: &tied };
    Bordered::new(problem, &all, &law).is_none()
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
    /// From `start`; how the method ends, if it does. `rescue`: move on where the tangent is singular.
    fn from<S: Scheme>(
        &mut self,
        start: Forces,
        scheme: S,
        rescue: bool,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<End>, MethodError> {
        problem.begin_phase();
        let mut newton = Newton {
            rescue,
            ..self.newton(scheme)
        };
        if self.multiple != 1.0 {
            let most = problem.counters.iterations + SCALED_STEPS;
            let most = most.min(self.settings.max_iterations);
            newton.limits = Limits::new(most, NEWTON_PATIENCE);
        }
        let end = newton.run(problem, start, monitor);
        (self.multiple, *self.tangent) = (1.0, newton.tangent);
        let end = end?;
        Ok(end.is_final().then_some(end))
    }

    fn newton<S: Scheme>(&mut self, scheme: S) -> Newton<S> {
        Newton {
            scheme,
            multiple: self.multiple,
            limits: Limits::new(self.settings.max_iterations, NEWTON_PATIENCE),
            line_search: true,
            rescue: false,
            tangent: std::mem::take(self.tangent),
        }
    }
}

impl<'s> Rounds<'s> {
    fn new(problem: &ContactProblem<'_>, runs: NewtonRuns<'s>) -> Self {
        let saddle = Saddle::new(problem.operator.clone());
        Self {
            sweeps: Sweeps::new(problem, &saddle),
            x: saddle.start(problem),
            saddle,
            branches: vec![Branch::Open; problem.rows.points()],
            count: runs.settings.first,
            relaxation: 1.0,
            reached: (f64::INFINITY, f64::INFINITY),
            restarts: 0,
            tried: false,
            pathed: false,
            best: problem.start(),
            runs,
        }
    }

    fn limits(&self, patience: usize) -> Limits {
        Limits::new(self.runs.settings.max_iterations, patience)
    }

    /// The sweeps of a round; how the method ends, if it does.
    fn sweep(
        &mut self,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<End>, MethodError> {
        let limits = self.limits(usize::MAX / 2);
        problem.begin_phase();
        self.saddle.refresh(problem, &mut self.x);
        let mut changes = 0;
        for _ in 0..self.count {
            let (saddle, x) = (&self.saddle, &mut self.x);
            if let Some(status) = saddle.ends(problem, x, changes, limits, monitor)? {
                let at = self.forces(problem);
                return Ok(Some(End { status, at }));
            }
            saddle.update_multipliers(problem, x);
            let (omega, branches) = (self.relaxation, &mut self.branches);
            changes = self.sweeps.sweep(problem, saddle, omega, x, branches);
        }
        self.best = self.forces(problem);
        let v = problem.jump(&self.best.p, &self.best.beta);
        self.reached.0 = problem.violation(&self.best.p, &v);
        Ok(None)
    }

    /// Newton's method from where the sweeps ended; how the method ends, if it does.
    fn newton<S: Scheme>(
        &mut self,
        scheme: S,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<End>, MethodError> {
        let start = self.best.clone();
        self.runs.from(start, scheme, false, problem, monitor)
    }

    /// Iterations in all at which a method of another family is given up that begins now.
    fn share(&self, problem: &ContactProblem<'_>) -> usize {
        (problem.counters.iterations + SHARE).min(self.runs.settings.max_iterations)
    }

    /// Other methods from the start of the increment, before the first of the largest rounds; how the method ends, if it does.
    fn others(
        &mut self,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<End>, MethodError> {
        let last_chance = !self.tried && 2 * self.count >= MAX_SWEEPS;
        let second = self.count == EARLY * self.runs.settings.first;
        if !self.pathed && (last_chance || (second && redundant(problem))) {
            self.pathed = true;
            let limits = Limits::new(self.share(problem), interior_point::PATIENCE);
            problem.begin_again();
            let end = along_path(problem, interior_point::FRACTION, limits, monitor)?;
            if end.is_final() {
                return Ok(Some(end));
            }
        }
        if !last_chance {
            return Ok(None);
        }
        self.tried = true;
        problem.begin_again();
        let mut newton = Newton {
            line_search: false,
            rescue: true,
            limits: Limits::new(self.share(problem), iteration::PATIENCE),
            ..self.runs.newton(Sets)
        };
        let start = problem.start();
        let end = newton.run(problem, start, monitor);
        *self.runs.tangent = newton.tangent;
        let mut end = end?;
        // Cone programs are minimisations.
        if !end.is_final() && problem.operator.w.symmetric() {
            problem.begin_again();
            end = socp::within(self.share(problem)).iterate(problem, monitor)?;
        }
        Ok(end.is_final().then_some(end))
    }

    /// Prepares the next round; false if nothing is left to try.
    fn next(&mut self, problem: &mut ContactProblem<'_>) -> Result<bool, MethodError> {
        self.count = (2 * self.count).min(MAX_SWEEPS);
        let progress = self.reached.0 < PROGRESS * self.reached.1;
        self.reached.1 = self.reached.1.min(self.reached.0);
        if progress {
            return Ok(true);
        }
        if self.count == MAX_SWEEPS && self.relaxation > LEAST_RELAXATION {
            self.relaxation *= 0.5;
            return Ok(true);
        }
        if self.count < MAX_SWEEPS {
            return Ok(true);
        }
        self.restarts += 1;
        self.relaxation = 1.0;
        self.count = RESTART_SWEEPS;
        self.reached = (f64::INFINITY, f64::INFINITY);
        match self.restarts {
            1 => self.restart_tied(problem),
            2 => self.restart_without_friction(problem),
            3..=MAX_RESTARTS => self.restart_alternating(problem)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// As if all points were tied: W P + Q β = −q, with tension cut off.
    fn restart_tied(&mut self, problem: &mut ContactProblem<'_>) {
        problem.counters.factorisations += 1;
        let Some(mut p) = tied_forces(problem) else {
            return;
        };
        for (i, own) in problem.rows.iter().enumerate() {
            return_map(problem.friction(i), &mut p[own]);
        }
        self.x = self.saddle.at(problem, p);
    }

    /// With the normal forces reached so far and no friction force.
    fn restart_without_friction(&mut self, problem: &ContactProblem<'_>) {
        let mut p = self.best.p.clone();
        for own in problem.rows.iter() {
            p[own][1..].fill(0.0);
        }
        self.x = self.saddle.at(problem, p);
    }

    /// From ever more sweeps of an alternating method.
    fn restart_alternating(&mut self, problem: &mut ContactProblem<'_>) -> Result<(), MethodError> {
        if let Some(pair) = alternate(problem, RESTART_SWEEPS << self.restarts)? {
            self.x = self.saddle.at(problem, pair.p);
        }
        Ok(())
    }

    fn forces(&self, problem: &ContactProblem<'_>) -> Forces {
        let (p, beta) = self.saddle.balanced(problem, &self.x);
        Forces { p, beta }
    }
}
