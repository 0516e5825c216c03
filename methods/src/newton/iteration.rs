//! Newton's method on non-smooth contact equations: the loop of `b-newton`, `newton-ac`, `pdas`, `gnm` and `ncp-newton`.
//! ```text
//! H(P, v) = 0 at every point,  v = q + W P + Q β,  Qᵀ P = c
//! V (δP, δv) = −H,  δv = W δP + Q δβ,  x <- x + t δ,   x = (P, β),  V an element of the generalised derivative of H
//! ```
//! The [`Scheme`] defines H and V. Full steps are tried first; the non-monotone line search on the energy-scaled
//! merit Σ H²/r steps in only after a rise above the last five merits. A singular V is regularised once by 1e-10/ρ on
//! the diagonal of W: redundant points make W singular, and this picks one of the possible P.
//!
//! Safeguards stand around the loop, which they start again: where V leaves a floating piece loose, or nothing gets better, the
//! iterate is moved on by a few local and global stages, and after that a loose piece is held by a spring.

#![allow(non_snake_case)]

use crate::algebra::dense::refill;
use crate::condensed::branches::changed;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::condensed::stages::rescue;
use crate::contract::options::{OptionSpec, Options, Whole, options};
use crate::contract::registry::Needs;
use crate::contract::state::{Monitor, Status};
use crate::contract::system::ContactSystem;
use crate::error::MethodError;
use crate::newton::contact_point::ContactPoint;
use crate::newton::line_search::LineSearch;
use crate::newton::scheme::{At, Scheme, Work};
use crate::newton::step::{MONOLITHIC, Tangent};

options! {
    R: Real("r", 1.0, 1e-3, 1e3): "multiple of 1/W_ii that turns gaps and slips into forces";
}

/// Options of a scheme that gives up after so many steps.
pub(crate) const fn scheme_options(max_iterations: Whole) -> [OptionSpec; 3] {
    let steps = OptionSpec::Whole(max_iterations);
    [OptionSpec::Real(R), steps, Tangent::OPTION]
}

/// Steps without progress after which an iteration counts as cycling.
pub(crate) const PATIENCE: usize = 60;

/// Newton's method on a scheme.
pub(crate) struct Newton<S> {
    pub scheme: S,
    /// r = `multiple`/W_ii.
    pub multiple: f64,
    pub limits: Limits,
    /// Shorten steps that raise the merit.
    pub line_search: bool,
    /// Move on by a few local and global stages where stuck.
    pub rescue: bool,
    /// Go on where redundant points make the tangent singular.
    pub regularise: bool,
    pub tangent: Tangent,
}

/// Where the loop stands. Every step works in the memory of the one before.
struct State<P> {
    x: Forces,
    v: Vec<f64>,
    /// Scale by row that turns jumps into forces.
    r: Vec<f64>,
    pieces: Vec<P>,
    /// Those of the last iterate that went on.
    before: Vec<P>,
    step: Forces,
    search: LineSearch,
    /// The merit of x where it was the last trial of a line search; then its jump is at hand, too.
    merit: Option<f64>,
    /// Growth of r once slender parts sway.
    sharper: f64,
    work: Work,
}

/// Why the loop stops.
#[derive(Clone, Copy, PartialEq)]
enum Stop {
    End(Status),
    /// Nothing has got better for too long.
    Stuck,
    SingularTangent,
}

impl<S: Scheme> Newton<S> {
    /// The method as its options say, with all safeguards.
    pub fn new(scheme: S, options: &Options, max_iterations: &Whole) -> Self {
        let limits = Limits::new(options.count(max_iterations), PATIENCE);
        let tangent = Tangent::new(options.switch(&MONOLITHIC));
        Self {
            multiple: options.real(&R),
            rescue: true,
            ..Self::plain(scheme, limits, tangent)
        }
    }

    /// The method without rescues, in the memory of a tangent.
    pub fn plain(scheme: S, limits: Limits, tangent: Tangent) -> Self {
        Self {
            scheme,
            multiple: 1.0,
            limits,
            line_search: true,
            rescue: false,
            regularise: true,
            tangent,
        }
    }

    /// The loop.
    fn steps(
        &mut self,
        problem: &mut ContactProblem<'_>,
        at: &mut State<S::Piece>,
        monitor: &mut dyn Monitor,
    ) -> Result<Stop, MethodError> {
        loop {
            at.follow(problem);
            self.choose_pieces(problem, at);
            let (violation, forces) = (problem.violation(&at.x.p, &at.v), (&*at.x.p, &*at.x.beta));
            let changes = changed(&at.pieces, &at.before);
            match problem.check(violation, forces, changes, self.limits, monitor)? {
                Check::GoOn => {}
                Check::Corrected => {
                    at.sharpen();
                    continue;
                }
                Check::End(status) => return Ok(Stop::End(status)),
            }
            at.before.clone_from(&at.pieces);
            if self.scheme.prepare(problem, violation) {
                at.merit = None;
            }
            if self.rescue && problem.stagnates() {
                return Ok(Stop::Stuck);
            }
            if !self.find_direction(problem, at, false)? {
                return Ok(Stop::SingularTangent);
            }
            self.advance(problem, at)?;
        }
    }

    /// The loop from `x` until it ends, with what lets it go on where it stops.
    pub fn run(
        &mut self,
        problem: &mut ContactProblem<'_>,
        x: Forces,
        monitor: &mut dyn Monitor,
    ) -> Ended {
        let end = self.guarded(problem, x, monitor);
        self.tangent.forget();
        end
    }

    fn guarded(
        &mut self,
        problem: &mut ContactProblem<'_>,
        x: Forces,
        monitor: &mut dyn Monitor,
    ) -> Ended {
        self.scheme.begin();
        let mut at = State::new(problem, x, self.multiple);
        loop {
            let stop = self.steps(problem, &mut at, monitor)?;
            let status = match stop {
                Stop::End(status) => return Ok(End { status, at: at.x }),
                Stop::Stuck => Status::Stalled,
                Stop::SingularTangent => problem.singular(),
            };
            if self.rescue
                && problem.rescue_left()
                && let Some(pair) = rescue(problem)?
            {
                (at.x, at.merit) = (pair.into(), None);
                continue;
            }
            let loose = stop == Stop::SingularTangent && problem.modes() > 0;
            if !(loose && self.find_direction(problem, &mut at, true)?) {
                return Ok(End { status, at: at.x });
            }
            self.advance(problem, &mut at)?;
        }
    }

    /// The pieces at x.
    fn choose_pieces(&self, problem: &ContactProblem<'_>, at: &mut State<S::Piece>) {
        let point = |i| ContactPoint::of(problem, i, &at.r, (&at.x.p, &at.v));
        let points = 0..problem.rows.points();
        refill(&mut at.pieces, points.map(|i| self.scheme.piece(&point(i))));
    }

    /// The Newton direction; false if the tangent is singular. `hold`: loose pieces by springs.
    fn find_direction(
        &mut self,
        problem: &mut ContactProblem<'_>,
        at: &mut State<S::Piece>,
        hold: bool,
    ) -> Result<bool, MethodError> {
        (at.work.hold, at.work.regularise) = (hold, self.regularise);
        // A direction before may have asked for others.
        at.pieces.clone_from(&at.before);
        let mut of_step = At {
            problem,
            tangent: &mut self.tangent,
            work: &mut at.work,
            r: &at.r,
            x: &at.x,
            v: &at.v,
        };
        self.scheme
            .direction(&mut of_step, &mut at.pieces, &mut at.step)
    }

    /// x <- x + t δ, t = 1 unless that raises the merit.
    fn advance(
        &self,
        problem: &mut ContactProblem<'_>,
        at: &mut State<S::Piece>,
    ) -> Result<(), MethodError> {
        let mut t = 1.0;
        if self.line_search {
            let merit = at.merit.take();
            let merit = merit.unwrap_or_else(|| self.merit(problem, &at.r, &at.x.p, &at.v));
            at.search.record(merit);
            let Work { trial, jump, .. } = &mut at.work;
            let mut last = (f64::NAN, f64::NAN);
            t = at.search.length(|t| {
                problem.jump_after(&at.x, t, &at.step, trial, jump);
                last = (t, self.merit(problem, &at.r, &trial.p, jump));
                last.1
            });
            at.merit = (last.0 == t && !problem.corrects_steps()).then_some(last.1);
        }
        problem.move_along(&mut at.x, t, &at.step)
    }

    /// Σ H²/r over all rows, an energy.
    fn merit(&self, problem: &ContactProblem<'_>, r: &[f64], P: &[f64], v: &[f64]) -> f64 {
        let mut sum = 0.0;
        for i in 0..problem.rows.points() {
            let at = ContactPoint::of(problem, i, r, (P, v));
            let H = self.scheme.equations(&at);
            sum += at.r.iter().zip(H).map(|(r, h)| h * h / r).sum::<f64>();
        }
        sum
    }
}

impl<P> State<P> {
    fn new(problem: &ContactProblem<'_>, x: Forces, multiple: f64) -> Self {
        let mut r = problem.scales(&vec![0.0; problem.len()]);
        r.iter_mut().for_each(|r| *r *= multiple);
        Self {
            x,
            v: Vec::new(),
            r,
            pieces: Vec::new(),
            before: Vec::new(),
            step: Forces::default(),
            search: LineSearch::default(),
            merit: None,
            sharper: problem.operator.sharp / problem.operator.rho,
            work: Work::default(),
        }
    }

    /// v of x.
    fn follow(&mut self, problem: &ContactProblem<'_>) {
        match self.merit {
            Some(_) => std::mem::swap(&mut self.v, &mut self.work.jump),
            None => problem.jump_into(&self.x.p, &self.x.beta, &mut self.v),
        }
    }

    /// Where slender parts sway, the gaps that are left drown in the rounding of P − v/W_ii.
    fn sharpen(&mut self) {
        self.merit = None;
        if self.sharper > 1.0 {
            self.r.iter_mut().for_each(|r| *r *= self.sharper);
            self.search = LineSearch::default();
            self.sharper = 1.0;
        }
    }
}

impl<S: Scheme> CondensedMethod for Newton<S> {
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        self.tangent.refuses(system)
    }

    fn needs(&self) -> Needs {
        self.tangent.needs()
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let start = problem.start();
        self.run(problem, start, monitor)
    }
}
