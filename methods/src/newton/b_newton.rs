//! B-differentiable Newton method.
//!
//! Pang, Math. Oper. Res. 15 (1990) 311; Christensen, Klarbring, Pang & Strömberg, Int. J. Numer. Meth. Engng 42
//! (1998) 145; on crack faces the method of the founding paper of this code (its Eqs. 5 to 7, with the bound
//! μ max(P_n, 0): as printed, min(P_n, 0), friction would vanish).
//!
//! ```text
//! v = (g, d) = q + W P + Q β             condensed equilibrium, solved exactly at every step
//! H_n = min(r_n g, P_n)                  Signorini
//! H_t = P_t − proj_{μ max(P_n, 0)}(P_t − r_t d)     Coulomb; proj_s projects on the ball of radius s
//! H(x) + H'(x; δ) = 0,  x <- x + t δ     x = (P, β), together with Qᵀ P = c
//! ```
//!
//! | point                             | row of H'(x; δ)                                                        |
//! |-----------------------------------|------------------------------------------------------------------------|
//! | open,   P_n − r_n g < 0           | δP_n                                                                   |
//! | closed                            | r_n δg                                                                 |
//! | stick,  \|z\| < s                 | r_t δd                                                                 |
//! | slip,   \|z\| > s, e = z/\|z\|    | δP_t − e δs − (s/\|z\|)(I − e eᵀ)(δP_t − r_t δd), δs = μ δP_n if P_n > 0 |
//!
//! with z = P_t − r_t d and s = μ max(P_n, 0). On a kink H' is piecewise linear in δ: a branch is tried, and the one
//! the direction itself asks for is taken (the *B*-derivative, not just one element of a generalised Jacobian).
//! Rows that read δP = −H are eliminated before the dense LU.
//!
//! # Options
//! `r`: r_n = r/W_nn and r_t = r/mean(W_tt) per point. Safe from 1e-3 to 1e3; the limit does not depend on it.
//! `max_iterations`. `monolithic`: 1 solves each step on all unknowns of the body, as papers
//! usually run the method; the iterates are the same.
//!
//! # Guarantees
//! Full steps are tried first; a non-monotone line search on the energy-scaled merit Σ H²/r steps in only after a rise
//! above the last five merits. Locally quadratic at regular points; in 2D and without friction the last linear
//! problem is the solution, so it ends after finitely many steps. No global guarantee: Coulomb friction is no minimisation.
//!
//! # Skips
//! An open crack is one linear solve. Open points leave the dense LU, and in 2D the tangential rows of slipping ones; without friction
//! there are none.
//! On 256 active rows and more, a tangent of which few rows have changed is not factored again.
//!
//! # Failure modes
//! Cycling or stalling for large μ, outside the range where the solution is unique (of 200 random, strongly coupled
//! systems per μ none fails up to μ = 2 and one at μ = 5: `tests/robustness.rs`); a singular tangent at P_n = 0, d = 0
//! corners. If contact points are redundant, W is singular and so is the tangent of sticking points: the step is then
//! regularised by 1e-10/ρ, which leaves the solution untouched and picks one of the possible P. If all points of a
//! floating piece open or slide on the way, the tangent cannot hold it: a few local and global stages (as in LATIN)
//! move the iterate on, and if that happens again and again the piece is reported as a mechanism. The same stages move
//! it on after 15 steps without progress.
//!
//! Steps may grow with the number of points beside a junction, where points open and close on the way: the bound μ max(P_n, 0)
//! follows the pressure of the last iterate, so that shear is right a step late, and merits rise and fall in turn. A
//! T-junction at μ = 0.2 and 0.3 takes 6, 7 and 41 steps on 41, 82 and 164 cells; `newton-ac`, whose bound is that of the trial
//! pressure P_n − r_n g, takes 4, 5 and 7.

#![allow(non_snake_case)]

use crate::algebra::dense::zero;
use crate::condensed::forces::Forces;
use crate::condensed::point_row::PointRow;
use crate::contract::law::{ball_derivative, project_ball, tangential_norm};
use crate::contract::options::options;
use crate::contract::registry::Method;
use crate::error::MethodError;
use crate::newton::contact_point::ContactPoint;
use crate::newton::iteration::{Newton, scheme_options};
use crate::newton::scheme::{At, Scheme};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "b-newton",
    label: "B-differentiable Newton",
    reference: "Christensen, Klarbring, Pang & Strömberg, Int. J. Numer. Meth. Engng 42 (1998) 145",
    summary: "Newton's method on the non-smooth equations min(r g, P_n) = 0 and P_t = proj(P_t - r d)",
    exact: true,
    options: &scheme_options(MAX_ITERATIONS),
    source: include_str!("b_newton.rs"),
    build: |options| Box::new(Newton::new(BEquations, options, &MAX_ITERATIONS)),
};

options! {
    MAX_ITERATIONS: Whole("max_iterations", 100, 1, 1_000_000): "Newton steps before giving up";
}

/// Rounds of branch correction at kinks within one step.
const BRANCH_ROUNDS: usize = 10;

/// H and the pieces of H'; the loop is [`Newton::run`].
#[derive(Clone, Copy)]
pub(crate) struct BEquations;

/// Pieces of H' in use at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Piece {
    closed: bool,
    /// δs = μ δP_n instead of 0.
    bound_moves: bool,
    slip: bool,
}

impl Scheme for BEquations {
    type Piece = Piece;

    /// H_n = min(r_n g, P_n),  H_t = P_t − proj_s(P_t − r_t d),  s = μ max(P_n, 0)
    fn equations(&self, at: &ContactPoint<'_>) -> [f64; 3] {
        let ContactPoint { mu, r, P, v } = *at;
        let mut H = at.trial();
        H[0] = (r[0] * v[0]).min(P[0]);
        project_ball(mu * P[0].max(0.0), &mut H[1..P.len()]);
        for k in 1..P.len() {
            H[k] = P[k] - H[k];
        }
        H
    }

    /// Closed and sticking on a kink.
    fn piece(&self, at: &ContactPoint<'_>) -> Piece {
        let ContactPoint { r, P, v, .. } = *at;
        let (closed, kink) = (r[0] * v[0] <= P[0], Kink::of(at));
        let (s, t) = bound_and_trial(at);
        Piece {
            closed,
            bound_moves: P[0] > 0.0 || (kink.bound && closed),
            // At t = s = 0 an open point has to lose its tangential force, a closed one may stick.
            slip: t > s || (kink.tangential && s == 0.0 && !closed),
        }
    }

    /// The row of H' for each piece, as in the table above.
    fn linearise(&self, at: &ContactPoint<'_>, piece: Piece, rows: &mut [PointRow; 3]) {
        let ContactPoint { mu, r, P, .. } = *at;
        if piece.closed {
            rows[0].c[0] = r[0];
        } else {
            rows[0].a[0] = 1.0;
        }
        let z = at.trial();
        let z = &z[..P.len()];
        if !piece.slip {
            for k in 1..P.len() {
                rows[k].c[k] = r[k];
            }
        } else {
            let t = tangential_norm(z);
            let (e, S) = if t > 0.0 {
                ball_derivative(mu * P[0].max(0.0), &z[1..])
            } else {
                Default::default()
            };
            for k in 1..P.len() {
                rows[k].a[k] = 1.0;
                if piece.bound_moves {
                    rows[k].a[0] = -mu * e[k - 1];
                }
                for l in 1..P.len() {
                    rows[k].a[l] -= S[k - 1][l - 1];
                    rows[k].c[l] += S[k - 1][l - 1] * r[l];
                }
            }
        }
    }

    /// The direction that asks for the pieces it was computed with.
    fn direction(
        &self,
        at: &mut At<'_, '_>,
        pieces: &mut [Piece],
        step: &mut Forces,
    ) -> Result<bool, MethodError> {
        for _ in 0..BRANCH_ROUNDS {
            if !at.step(self, pieces, step)? {
                return Ok(false);
            }
            if !correct_pieces(at, step, pieces) {
                break;
            }
        }
        Ok(true)
    }
}

/// Which pieces of H' meet at the iterate, so that the direction decides.
#[derive(Debug, Clone, Copy)]
struct Kink {
    normal: bool,
    bound: bool,
    tangential: bool,
}

impl Kink {
    fn any(&self) -> bool {
        self.normal || self.bound || self.tangential
    }

    fn of(at: &ContactPoint<'_>) -> Self {
        let ContactPoint { r, P, v, .. } = *at;
        let (s, t) = bound_and_trial(at);
        Kink {
            normal: r[0] * v[0] == P[0],
            bound: P[0] == 0.0,
            tangential: t == s,
        }
    }
}

/// s and |z_t|.
fn bound_and_trial(at: &ContactPoint<'_>) -> (f64, f64) {
    let bound = at.mu * at.P[0].max(0.0);
    (bound, tangential_norm(&at.trial()[..at.size()]))
}

/// Switches every piece on a kink that the direction contradicts; says whether there was one.
fn correct_pieces(at: &mut At<'_, '_>, step: &Forces, pieces: &mut [Piece]) -> bool {
    let Some(first) = (0..pieces.len()).find(|&i| Kink::of(&at.point(i)).any()) else {
        return false;
    };
    let dv = &mut at.work.jump;
    zero(dv, step.p.len());
    at.problem.operator.w.apply_add(&step.p, dv);
    at.problem.operator.modes.add(&step.beta, dv);
    let (at, problem) = (&*at, &*at.problem);
    let mut contradicted = false;
    for (i, piece) in pieces.iter_mut().enumerate().skip(first) {
        let point = at.point(i);
        let change = ContactPoint::of(problem, i, at.r, (&step.p, &at.work.jump));
        let ContactPoint {
            mu,
            r,
            P: dP,
            v: dv,
        } = change;
        let kink = Kink::of(&point);
        let mut wanted = *piece;
        if kink.normal {
            wanted.closed = r[0] * dv[0] <= dP[0];
        }
        if kink.bound {
            wanted.bound_moves = dP[0] > 0.0;
        }
        if kink.tangential && point.size() > 1 {
            let (z, dz, size) = (point.trial(), change.trial(), point.size());
            let t = tangential_norm(&z[..size]);
            let outward = if t > 0.0 {
                (1..size).map(|k| z[k] * dz[k]).sum::<f64>() / t
            } else {
                tangential_norm(&dz[..size])
            };
            wanted.slip = outward > if piece.bound_moves { mu * dP[0] } else { 0.0 };
        }
        // Within rounding of the switching plane both pieces give the same step.
        let scale = dP
            .iter()
            .zip(dv)
            .zip(r)
            .map(|((p, v), r)| p.abs() + (r * v).abs())
            .sum::<f64>();
        let close = |a: f64| a.abs() <= 1e-12 * scale;
        if wanted.closed != piece.closed && close(r[0] * dv[0] - dP[0]) {
            wanted.closed = piece.closed;
        }
        if wanted.bound_moves != piece.bound_moves && close(dP[0]) {
            wanted.bound_moves = piece.bound_moves;
        }
        contradicted |= wanted != *piece;
        *piece = wanted;
    }
    contradicted
}
