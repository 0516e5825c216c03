//! Primal-dual active set method.
//!
//! Hüeber & Wohlmuth, Comput. Meth. Appl. Mech. Engng 194 (2005) 3147 (contact); Hüeber, Stadler & Wohlmuth, SIAM J.
//! Sci. Comput. 30 (2008) 572 (Coulomb friction in 3D).
//!
//! ```text
//! v = (g, d) = q + W P + Q β                     condensed equilibrium, solved exactly at every step
//! z_n = P_n − r_n g,   z_t = P_t − r_t d,   s = μ max(z_n, 0)
//! C_n = P_n − max(z_n, 0)                        inactive: z_n <= 0
//! C_t = max(s, |z_t|) P_t − s z_t                stick: |z_t| <= s,  slip: |z_t| > s
//! ```
//!
//! | set                                 | condition of the next iterate (P, v) + (δP, δv)                          |
//! |-------------------------------------|--------------------------------------------------------------------------|
//! | inactive                            | P = 0                                                                    |
//! | active                              | g = 0                                                                    |
//! | stick                               | d = 0                                                                    |
//! | slip, 2D, e = sign z_t              | P_t = e s                                                                |
//! | slip, 3D, e = z_t/\|z_t\|           | δP_t − M (δP_t − r_t δd) − e δs = s e − P_t,   δs = μ (δP_n − r_n δg)    |
//! ```text
//! M = (s/|z_t|) (I − γ π eᵀ),   π = P_t/max(s, |P_t|),   α = e·P_t/|P_t|,   γ = 1/(1 − α |π|) if α < 0, else 1
//! ```
//! M is the tangent of C_t with the force scaled back into the friction bound and damped where it opposes the trial:
//! the exact tangent, in the limit, but without its singular directions far from the solution. Sticking points drop the
//! term (d/s) δs of the exact tangent, which vanishes with d: where points are redundant it would contradict itself.
//! The sets are chosen anew from the signs after every step; steps are full. Where the sets stay and nothing slips in
//! 3D, the problem solved is linear, and its solution final.
//!
//! # Options
//! `r`: r_n = r/W_nn and r_t = r/mean(W_tt) per point. Safe from 1e-3 to 1e3; the limit does not depend on it.
//! `max_iterations`. `monolithic`: 1 solves each step on all unknowns of the body; the iterates
//! are the same.
//!
//! # Guarantees
//! Without friction, if W⁻¹ is an M-matrix: finite termination, from any start, and monotone from the second step on
//! (Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865). Membranes have that, elastic bodies in general do not.
//! Otherwise locally superlinear; no global guarantee, and no line search that could give one.
//!
//! # Failure modes
//! Cycling between sets for large μ, and where W⁻¹ is no M-matrix also without friction: three points are enough. After
//! 15 steps without progress a few local and global stages (as in LATIN) move the iterate on, as in the other Newton
//! methods here; a piece that gets loose again and again is reported as a mechanism.
//!
//! # Skips
//! An open crack is one linear solve. Inactive points leave the dense LU, and in 2D the tangential rows of slipping ones; without
//! friction there are none.
//! On 256 active rows and more, a tangent of which few rows have changed is not factored again.

#![allow(non_snake_case)]

use crate::condensed::point_row::PointRow;
use crate::contract::law::{Branch, tangential_norm};
use crate::contract::options::options;
use crate::contract::registry::Method;
use crate::newton::contact_point::ContactPoint;
use crate::newton::iteration::{Newton, scheme_options};
use crate::newton::scheme::Scheme;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "pdas",
    label: "Primal-dual active set",
    reference: "Hüeber, Stadler & Wohlmuth, SIAM J. Sci. Comput. 30 (2008) 572",
    summary: "guesses the open, sticking and slipping sets, solves for them, and reads the next sets from the signs",
    exact: true,
    options: &scheme_options(MAX_ITERATIONS),
    source: include_str!("pdas.rs"),
    build: |options| {
        Box::new(Newton {
            // Steps are full.
            line_search: false,
            ..Newton::new(Sets, options, &MAX_ITERATIONS)
        })
    },
};

options! {
    MAX_ITERATIONS: Whole("max_iterations", 200, 1, 1_000_000): "changes of the sets before giving up";
}

/// The sets and their conditions, C_t divided by max(s, |z_t|) so that it is a force; the loop is [`Newton::run`].
#[derive(Clone, Copy)]
pub(crate) struct Sets;

impl Scheme for Sets {
    type Piece = Branch;

    fn piece(&self, at: &ContactPoint<'_>) -> Branch {
        at.branch()
    }

    fn linearise(&self, at: &ContactPoint<'_>, set: Branch, rows: &mut [PointRow; 3]) {
        match set {
            Branch::Open => at.open(rows),
            Branch::Stick => at.stick(rows),
            Branch::Slip => {
                let (z, size) = (at.trial(), at.size());
                let (s, t) = (at.mu * z[0], tangential_norm(&z[..size]));
                let M = damped_tangent(s, t, &z[1..size], &at.P[1..]);
                at.slip([z[1] / t, z[2] / t], M, rows);
            }
        }
    }
}

/// M for |z_t| = t > s. In 2D slip has one direction, and the active set fixes its force: M = 0.
fn damped_tangent(s: f64, t: f64, z_t: &[f64], P_t: &[f64]) -> [[f64; 2]; 2] {
    let ([z_a, z_b], [P_a, P_b]) = (z_t, P_t) else {
        return [[0.0; 2]; 2];
    };
    let (e, size) = ([z_a / t, z_b / t], P_a.hypot(*P_b));
    let scale = s.max(size);
    if scale == 0.0 {
        return [[0.0; 2]; 2];
    }
    let pi = [P_a / scale, P_b / scale];
    // α |π| = e·π, |π| = `pi`.
    let along = e[0] * pi[0] + e[1] * pi[1];
    let gamma = if along < 0.0 {
        1.0 / (1.0 - along)
    } else {
        1.0
    };
    let entry = |k: usize, l: usize| s / t * (f64::from(u8::from(k == l)) - gamma * pi[k] * e[l]);
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}
