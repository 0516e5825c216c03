//! Differences of the Newton methods: the equations of a point and the pieces of their derivative; and the step that these give.

#![allow(non_snake_case)]

use crate::condensed::forces::Forces;
use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::condensed::starts::RIDGE;
use crate::contract::law::return_map;
use crate::error::MethodError;
use crate::newton::contact_point::ContactPoint;
use crate::newton::step::Tangent;

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

/// The form in which steps are computed.
#[derive(Default)]
pub(crate) struct Work {
    /// Loose pieces are held by springs.
    pub hold: bool,
    /// Whether a singular tangent is regularised.
    pub regularise: bool,
    rows: Vec<[PointRow; 3]>,
    /// An iterate that is tried, and its jump.
    pub trial: Forces,
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

    /// The step of the given pieces, regularised if their tangent is singular and that is wanted.
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
        if !self.work.regularise {
            return Ok(false);
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
