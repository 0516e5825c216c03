//! Alart–Curnier generalised Newton method.
//!
//! Alart & Curnier, Comput. Meth. Appl. Mech. Engng 92 (1991) 353: the stationarity conditions of the augmented
//! Lagrangian, solved for displacements and forces together.
//!
//! ```text
//! v = (g, d) = q + W P + Q β                     condensed equilibrium, solved exactly at every step
//! z_n = P_n − r_n g,   z_t = P_t − r_t d,   s = μ max(z_n, 0)
//! H_n = P_n − max(z_n, 0),   H_t = P_t − proj_s(z_t);   proj_s projects on the ball of radius s
//! ```
//!
//! | point                                         | rows of V (δP, δv) = −H                                       |
//! |-----------------------------------------------|---------------------------------------------------------------|
//! | open,  z_n <= 0                               | δP = −P                                                       |
//! | stick, \|z_t\| <= s                           | r_n δg = −r_n g,   r_t δd = −r_t d                            |
//! | slip,  \|z_t\| > s,  e = z_t/\|z_t\|          | r_n δg = −r_n g,   δP_t − μ e (δP_n − r_n δg) − S (δP_t − r_t δd) = −H_t |
//!
//! with S = (s/\|z_t\|) (I − e eᵀ). The friction bound follows the augmented force z_n where the B-differentiable method
//! takes P_n: a point on the way to opening loses its friction at once, and stick and open rows are symmetric.
//!
//! # Options
//! `r`: r_n = r/W_nn and r_t = r/mean(W_tt) per point. Safe from 1e-3 to 1e3; the limit does not depend on it.
//! `max_iterations`. `monolithic`: 1 solves each step on all unknowns of the body, as papers
//! usually run the method; the iterates are the same.
//!
//! # Guarantees
//! Locally quadratic at points where no state changes; in 2D and without friction the last linear problem is the
//! solution, so it ends after finitely many steps. Full steps first, a non-monotone line search after a rise of the merit
//! Σ H²/r above the last five. No global guarantee.
//!
//! # Failure modes
//! Cycling or stalling for large μ, outside the range where the solution is unique. Redundant contact points make the
//! tangent singular: it is then regularised by 1e-10/ρ, which leaves the solution untouched. A floating piece whose points
//! all open or slide on the way makes it singular too: a few local and global stages (as in LATIN) move the iterate on,
//! also after 15 steps without progress; a piece that gets loose again and again is reported as a mechanism.
//!
//! # Skips
//! An open crack is one linear solve. Open points leave the dense LU, and in 2D the tangential rows of slipping ones; without friction
//! there are none.
//! On 256 active rows and more, a tangent of which few rows have changed is not factored again.

#![allow(non_snake_case)]

use crate::condensed::point_row::PointRow;
use crate::contract::law::{Branch, ball_derivative};
use crate::contract::options::options;
use crate::contract::registry::Method;
use crate::newton::contact_point::ContactPoint;
use crate::newton::iteration::{Newton, scheme_options};
use crate::newton::scheme::Scheme;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "newton-ac",
    label: "Alart–Curnier Newton",
    reference: "Alart & Curnier, Comput. Meth. Appl. Mech. Engng 92 (1991) 353",
    summary: "Newton's method on the stationarity conditions of the augmented Lagrangian",
    exact: true,
    options: &scheme_options(MAX_ITERATIONS),
    source: include_str!("newton_ac.rs"),
    build: |options| Box::new(Newton::new(AlartCurnier, options, &MAX_ITERATIONS)),
};

options! {
    MAX_ITERATIONS: Whole("max_iterations", 100, 1, 1_000_000): "Newton steps before giving up";
}

/// H and V; the loop is [`Newton::run`].
#[derive(Clone, Copy)]
pub(crate) struct AlartCurnier;

impl Scheme for AlartCurnier {
    type Piece = Branch;

    fn piece(&self, at: &ContactPoint<'_>) -> Branch {
        at.branch()
    }

    fn linearise(&self, at: &ContactPoint<'_>, piece: Branch, rows: &mut [PointRow; 3]) {
        match piece {
            Branch::Open => at.open(rows),
            Branch::Stick => at.stick(rows),
            Branch::Slip => {
                let z = at.trial();
                let (e, S) = ball_derivative(at.mu * z[0], &z[1..at.size()]);
                at.slip(e, S, rows);
            }
        }
    }
}
