//! Newton's method on non-smooth contact equations, the loop that the methods of this kind share.
//! ```text
//! H(P, v) = 0 at every point,  v = q + W P + Q β,  Qᵀ P = c
//! V (δP, δv) = −H,  δv = W δP + Q δβ,  x <- x + t δ,   x = (P, β),  V an element of the generalised derivative of H
//! ```
//! What H and V are is the [`Scheme`]. Full steps are tried first; the non-monotone line search on the energy-scaled
//! merit Σ H²/r steps in only after a rise above the last five merits. A singular V is regularised once by 1e-10/ρ on
//! the diagonal of W: redundant points make W singular, and this picks one of the possible P.

#![allow(non_snake_case)]

use crate::condensed::problem::{Limits, Reduced};
use crate::condensed::stages::rescue;
use crate::contract::law::{Branch, return_map};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;
use crate::newton::b_equations::Row;
use crate::newton::line_search::LineSearch;
use crate::newton::step::Tangent;

/// Regularisation of a singular tangent of redundant points, relative to 1/ρ.
pub(crate) const RIDGE: f64 = 1e-10;

/// Unknowns of the method.
#[derive(Debug, Clone)]
pub(crate) struct Iterate {
    pub P: Vec<f64>,
    pub beta: Vec<f64>,
}

impl Iterate {
    /// The iterate every increment starts from.
    pub fn start(problem: &Reduced<'_>) -> Self {
        let P = problem.start_forces();
        let beta = problem.start_amplitudes(&P);
        Self { P, beta }
    }

    fn moved(&self, t: f64, step: &Iterate) -> Iterate {
        let add = |x: &[f64], s: &[f64]| x.iter().zip(s).map(|(x, s)| x + t * s).collect();
        Iterate {
            P: add(&self.P, &step.P),
            beta: add(&self.beta, &step.beta),
        }
    }
}

/// The equations of one point and the pieces of their derivative. `r`, `P`, `v` are the rows of the point.
pub(crate) trait Scheme {
    /// Which smooth piece of H a point is on.
    type Piece: Copy + PartialEq;

    /// H.
    fn equations(&self, mu: f64, r: &[f64], P: &[f64], v: &[f64]) -> [f64; 3];

    /// The piece at (P, v).
    fn piece(&self, mu: f64, r: &[f64], P: &[f64], v: &[f64]) -> Self::Piece;

    /// V (δP, δv) = −H on a piece.
    fn linearise(&self, mu: f64, r: &[f64], P: &[f64], v: &[f64], piece: Self::Piece) -> [Row; 3];

    /// The Newton direction; `None` if the tangent is singular. `pieces` are those at x.
    fn direction(
        &self,
        at: &mut At<'_, '_>,
        pieces: &[Self::Piece],
    ) -> Result<Option<Iterate>, MethodError> {
        at.step(self, pieces)
    }
}

/// Where the iteration stands.
pub(crate) struct At<'p, 'i> {
    pub problem: &'p mut Reduced<'i>,
    pub tangent: &'p mut Tangent,
    /// Scale by row that turns jumps into forces.
    pub r: &'p [f64],
    pub x: &'p Iterate,
    pub v: &'p [f64],
}

impl At<'_, '_> {
    /// The step of the given pieces, regularised if their tangent is singular.
    pub fn step<S: Scheme + ?Sized>(
        &mut self,
        scheme: &S,
        pieces: &[S::Piece],
    ) -> Result<Option<Iterate>, MethodError> {
        let mut rows = self.rows(scheme, pieces);
        if let Some(step) = self.tangent.solve(self.problem, self.x, &mut rows)? {
            return Ok(Some(step));
        }
        let mut rows = self.rows(scheme, pieces);
        let ridge = RIDGE / self.problem.condensed.rho;
        for row in rows.iter_mut().flatten() {
            for l in 0..3 {
                row.a[l] += ridge * row.c[l];
            }
        }
        self.tangent.solve(self.problem, self.x, &mut rows)
    }

    fn rows<S: Scheme + ?Sized>(&self, scheme: &S, pieces: &[S::Piece]) -> Vec<[Row; 3]> {
        (0..pieces.len())
            .map(|i| {
                let (own, mu) = (self.problem.rows.of(i), self.problem.friction(i));
                let (r, P) = (&self.r[own.clone()], &self.x.P[own.clone()]);
                scheme.linearise(mu, r, P, &self.v[own], pieces[i])
            })
            .collect()
    }
}

/// What Newton's method may do besides full steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Safeguards {
    /// Shorten steps that raise the merit.
    pub line_search: bool,
    /// Move on by a few local and global stages where stuck.
    pub rescue: bool,
}

/// Newton's method from `x` until it ends. `multiple` scales r = multiple/W_ii.
pub(crate) fn newton<S: Scheme>(
    scheme: &S,
    problem: &mut Reduced<'_>,
    tangent: &mut Tangent,
    (mut x, multiple): (Iterate, f64),
    (limits, safeguards): (Limits, Safeguards),
    monitor: &mut dyn Monitor,
) -> Result<(Status, Iterate), MethodError> {
    let rigid_springs = vec![0.0; problem.len()];
    let mut r = problem.scales(&rigid_springs);
    r.iter_mut().for_each(|r| *r *= multiple);
    let mut search = LineSearch::default();
    let mut before: Vec<S::Piece> = Vec::new();
    loop {
        let v = problem.jump(&x.P, &x.beta);
        let pieces = classify(scheme, problem, &r, &x.P, &v);
        let changes = pieces.iter().zip(&before).filter(|(a, b)| a != b).count();
        let natural_map = problem.natural_map(&x.P, &v);
        if let Some(status) = problem.ends(natural_map, changes, limits, monitor) {
            match problem.confirm(status, &x.P, &x.beta)? {
                Some(status) => return Ok((status, x)),
                None => continue,
            }
        }
        let stuck = safeguards.rescue && problem.stagnates();
        let mut at = At {
            problem,
            tangent,
            r: &r,
            x: &x,
            v: &v,
        };
        let step = if stuck {
            None
        } else {
            scheme.direction(&mut at, &pieces)?
        };
        before = pieces;
        let Some(step) = step else {
            if safeguards.rescue
                && problem.rescue_left()
                && let Some(pair) = rescue(problem)?
            {
                x = Iterate {
                    P: pair.p,
                    beta: pair.beta,
                };
                continue;
            }
            let status = if stuck {
                Status::Stalled
            } else {
                problem.singular()
            };
            return Ok((status, x));
        };
        search.record(merit(scheme, problem, &r, &x.P, &v));
        let length = |t| {
            let trial = x.moved(t, &step);
            let v = problem.jump(&trial.P, &trial.beta);
            merit(scheme, problem, &r, &trial.P, &v)
        };
        let t = if safeguards.line_search {
            search.length(length)
        } else {
            1.0
        };
        x = x.moved(t, &step);
        problem.rebalance(&mut x.P);
    }
}

fn classify<S: Scheme>(
    scheme: &S,
    problem: &Reduced<'_>,
    r: &[f64],
    P: &[f64],
    v: &[f64],
) -> Vec<S::Piece> {
    (0..problem.rows.points())
        .map(|i| {
            let own = problem.rows.of(i);
            let (r, P) = (&r[own.clone()], &P[own.clone()]);
            scheme.piece(problem.friction(i), r, P, &v[own])
        })
        .collect()
}

/// Σ H²/r over all rows, an energy.
fn merit<S: Scheme>(scheme: &S, problem: &Reduced<'_>, r: &[f64], P: &[f64], v: &[f64]) -> f64 {
    let mut sum = 0.0;
    for i in 0..problem.rows.points() {
        let own = problem.rows.of(i);
        let (mu, range) = (problem.friction(i), own.clone());
        let H = scheme.equations(mu, &r[range.clone()], &P[range.clone()], &v[range]);
        sum += own.zip(H).map(|(k, h)| h * h / r[k]).sum::<f64>();
    }
    sum
}

/// P − Π(P − r v) at one point, Π the return mapping: the equations of the augmented Lagrangian.
pub(crate) fn augmented_equations(mu: f64, r: &[f64], P: &[f64], v: &[f64]) -> [f64; 3] {
    let mut H = trial(r, P, v);
    return_map(mu, &mut H[..P.len()]);
    for k in 0..P.len() {
        H[k] = P[k] - H[k];
    }
    H
}

/// The branch of Π(P − r v).
pub(crate) fn augmented_branch(mu: f64, r: &[f64], P: &[f64], v: &[f64]) -> Branch {
    return_map(mu, &mut trial(r, P, v)[..P.len()])
}

/// z = P − r v at one point, the trial force of the augmented Lagrangian.
pub(crate) fn trial(r: &[f64], P: &[f64], v: &[f64]) -> [f64; 3] {
    let mut z = [0.0; 3];
    for k in 0..P.len() {
        z[k] = P[k] - r[k] * v[k];
    }
    z
}
