//! Newton's method on non-smooth contact equations: the loop of `b-newton`, `newton-ac`, `pdas`, `gnm` and `ncp-newton`.
//! ```text
//! H(P, v) = 0 at every point,  v = q + W P + Q β,  Qᵀ P = c
//! V (δP, δv) = −H,  δv = W δP + Q δβ,  x <- x + t δ,   x = (P, β),  V an element of the generalised derivative of H
//! ```
//! What H and V are is the [`Scheme`]. Full steps are tried first; the non-monotone line search on the energy-scaled
//! merit Σ H²/r steps in only after a rise above the last five merits. A singular V is regularised once by 1e-10/ρ on
//! the diagonal of W: redundant points make W singular, and this picks one of the possible P. Where V leaves a floating piece
//! loose it is moved on by a few local and global stages, and after that held by a spring.

#![allow(non_snake_case)]

use crate::algebra::dense::refill;
use crate::condensed::branches::changed;
use crate::condensed::point_row::PointRow;
use crate::condensed::stages::rescue;
use crate::condensed::starts::RIDGE;
use crate::contract::law::return_map;
use crate::newton::contact_point::ContactPoint;
use crate::newton::line_search::LineSearch;
use crate::newton::step::{MONOLITHIC, Tangent};
use crate::{
    Check, CondensedMethod, ContactProblem, ContactSystem, End, Ended, Forces, Limits, MethodError,
    Monitor, Needs, OptionSpec, Options, Status, Whole, options,
};

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

/// The equations of one point and the pieces of their derivative.
pub(crate) trait Scheme: Send {
    /// Which smooth piece of H a point is on.
    type Piece: Copy + PartialEq;

    /// H; P − Π(P − r v), Π the return mapping, unless the scheme has its own: the equations of the augmented Lagrangian.
    fn equations(&self, at: &ContactPoint<'_>) -> [f64; 3] {
        let mut H = at.trial();
        return_map(at.mu, &mut H[..at.size()]);
        for (H, P) in H.iter_mut().zip(at.P) {
            *H = P - *H;
        }
        H
    }

    /// The piece at (P, v).
    fn piece(&self, at: &ContactPoint<'_>) -> Self::Piece;

    /// V (δP, δv) = −H on a piece: sets the coefficients of `rows`, which are zero and have [`equations`](Self::equations) on
    /// their right-hand sides. A scheme that steps from other forces sets these, too.
    fn linearise(&self, at: &ContactPoint<'_>, piece: Self::Piece, rows: &mut [PointRow; 3]);

    /// Called before the first iterate, for what must not outlast a run.
    fn begin(&mut self) {}

    /// Called with every iterate and its violation before the next step, for what changes with them; whether the equations do.
    fn prepare(&mut self, _problem: &ContactProblem<'_>, _violation: f64) -> bool {
        false
    }

    /// The Newton direction in place of what `step` holds; false if the tangent is singular. `pieces` are those at x, which may
    /// be changed.
    fn direction(
        &self,
        at: &mut At<'_, '_>,
        pieces: &mut [Self::Piece],
        step: &mut Forces,
    ) -> Result<bool, MethodError> {
        at.step(self, pieces, step)
    }
}

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
    pub tangent: Tangent,
}

impl<S: Scheme> Newton<S> {
    /// The method as its options say, with all safeguards.
    pub fn new(scheme: S, options: &Options, max_iterations: &Whole) -> Self {
        Self {
            scheme,
            multiple: options.real(&R),
            limits: Limits::new(options.count(max_iterations), PATIENCE),
            line_search: true,
            rescue: true,
            tangent: Tangent::new(options.switch(&MONOLITHIC)),
        }
    }

    /// From `x` until it ends.
    pub fn run(
        &mut self,
        problem: &mut ContactProblem<'_>,
        x: Forces,
        monitor: &mut dyn Monitor,
    ) -> Ended {
        let end = self.steps(problem, x, monitor);
        self.tangent.forget();
        end
    }

    /// The loop. Every step works in the memory of the one before.
    fn steps(
        &mut self,
        problem: &mut ContactProblem<'_>,
        mut x: Forces,
        monitor: &mut dyn Monitor,
    ) -> Ended {
        let mut r = problem.scales(&vec![0.0; problem.len()]);
        r.iter_mut().for_each(|r| *r *= self.multiple);
        let mut sharper = problem.operator.sharp / problem.operator.rho;
        let mut search = LineSearch::default();
        let (mut pieces, mut before) = (Vec::new(), Vec::new());
        let (mut v, mut step) = (Vec::new(), Forces::default());
        let mut work = Work::default();
        // The merit of x, where it was the last trial of a line search; then its jump is at hand, too.
        let mut tried = None;
        self.scheme.begin();
        loop {
            let mut merit = tried.take();
            match merit {
                Some(_) => std::mem::swap(&mut v, &mut work.jump),
                None => problem.jump_into(&x.p, &x.beta, &mut v),
            }
            self.pieces(problem, &r, &x.p, &v, &mut pieces);
            let changes = changed(&pieces, &before);
            let violation = problem.violation(&x.p, &v);
            match problem.check(violation, (&x.p, &x.beta), changes, self.limits, monitor)? {
                Check::GoOn => {}
                Check::Corrected => {
                    // Where slender parts sway, the gaps that are left drown in the rounding of P − v/W_ii.
                    if sharper > 1.0 {
                        r.iter_mut().for_each(|r| *r *= sharper);
                        search = LineSearch::default();
                        sharper = 1.0;
                    }
                    continue;
                }
                Check::End(status) => return Ok(End { status, at: x }),
            }
            if self.scheme.prepare(problem, violation) {
                merit = None;
            }
            before.clone_from(&pieces);

            let stuck = self.rescue && problem.stagnates();
            let mut found = !stuck
                && self.direction(problem, &r, (&x, &v), &mut pieces, &mut work, &mut step)?;
            if !found
                && self.rescue
                && problem.rescue_left()
                && let Some(pair) = rescue(problem)?
            {
                x = pair.into();
                continue;
            }
            if !found && !stuck {
                work.hold = true;
                pieces.clone_from(&before);
                found = self.direction(problem, &r, (&x, &v), &mut pieces, &mut work, &mut step)?;
                work.hold = false;
            }
            if !found {
                let status = match stuck {
                    true => Status::Stalled,
                    false => problem.singular(),
                };
                return Ok(End { status, at: x });
            }

            let mut t = 1.0;
            if self.line_search {
                search.record(merit.unwrap_or_else(|| self.merit(problem, &r, &x.p, &v)));
                let Work { trial, jump, .. } = &mut work;
                let mut last = (f64::NAN, f64::NAN);
                t = search.length(|t| {
                    problem.jump_after(&x, t, &step, trial, jump);
                    last = (t, self.merit(problem, &r, &trial.p, jump));
                    last.1
                });
                tried = (last.0 == t && !problem.corrects_steps()).then_some(last.1);
            }
            problem.move_along(&mut x, t, &step)?;
        }
    }

    fn direction(
        &mut self,
        problem: &mut ContactProblem<'_>,
        r: &[f64],
        (x, v): (&Forces, &[f64]),
        pieces: &mut [S::Piece],
        work: &mut Work,
        step: &mut Forces,
    ) -> Result<bool, MethodError> {
        let tangent = &mut self.tangent;
        let mut at = At {
            problem,
            tangent,
            work,
            r,
            x,
            v,
        };
        self.scheme.direction(&mut at, pieces, step)
    }

    fn pieces(
        &self,
        problem: &ContactProblem<'_>,
        r: &[f64],
        P: &[f64],
        v: &[f64],
        pieces: &mut Vec<S::Piece>,
    ) {
        let point = |i| ContactPoint::of(problem, i, r, (P, v));
        let points = 0..problem.rows.points();
        refill(pieces, points.map(|i| self.scheme.piece(&point(i))));
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

/// What steps are computed in.
#[derive(Default)]
pub(crate) struct Work {
    /// Loose pieces are held by springs.
    hold: bool,
    rows: Vec<[PointRow; 3]>,
    /// An iterate that is tried, and its jump.
    trial: Forces,
    pub jump: Vec<f64>,
}

/// Where the iteration stands.
pub(crate) struct At<'p, 'i> {
    pub problem: &'p mut ContactProblem<'i>,
    pub tangent: &'p mut Tangent,
    pub work: &'p mut Work,
    /// Scale by row that turns jumps into forces.
    pub r: &'p [f64],
    pub x: &'p Forces,
    pub v: &'p [f64],
}

impl At<'_, '_> {
    /// Point `i` of the iterate.
    pub fn point(&self, i: usize) -> ContactPoint<'_> {
        ContactPoint::of(self.problem, i, self.r, (&self.x.p, self.v))
    }

    /// The step of the given pieces, regularised if their tangent is singular.
    pub fn step<S: Scheme + ?Sized>(
        &mut self,
        scheme: &S,
        pieces: &[S::Piece],
        step: &mut Forces,
    ) -> Result<bool, MethodError> {
        self.linearise(scheme, pieces);
        if self.solve(step)? {
            return Ok(true);
        }
        self.linearise(scheme, pieces);
        let ridge = RIDGE / self.problem.operator.rho;
        for row in self.work.rows.iter_mut().flatten() {
            for l in 0..3 {
                row.a[l] += ridge * row.c[l];
            }
        }
        self.solve(step)
    }

    fn solve(&mut self, step: &mut Forces) -> Result<bool, MethodError> {
        let Work { rows, hold, .. } = &mut *self.work;
        self.tangent.solve(self.problem, self.x, rows, *hold, step)
    }

    fn linearise<S: Scheme + ?Sized>(&mut self, scheme: &S, pieces: &[S::Piece]) {
        let x = (&*self.x.p, self.v);
        let rows = &mut self.work.rows;
        rows.resize(pieces.len(), PointRow::reading([0.0; 3]));
        for (i, (&piece, rows)) in pieces.iter().zip(rows).enumerate() {
            let at = ContactPoint::of(self.problem, i, self.r, x);
            *rows = PointRow::reading(scheme.equations(&at));
            scheme.linearise(&at, piece, rows);
        }
    }
}
