//! Generalised Newton method with return mapping (GNM-RM).
//!
//! Nevland, Stefansson & Keilegavlen, Augmented Lagrangian solvers for poroelasticity with fracture contact mechanics,
//! arXiv:2508.11508 (2025); the complementarity functions are those of Hüeber, Stadler & Wohlmuth, SIAM J. Sci. Comput. 30
//! (2008) 572, as codes for fractured rock use them.
//!
//! ```text
//! v = (g, d) = q + W P + Q β                     condensed equilibrium, solved exactly at every step
//! z_n = P_n − r_n g,   z_t = P_t − r_t d,   b = μ max(z_n, 0)
//! C_n = P_n − max(z_n, 0)
//! C_t = max(b, |z_t|) P_t − b z_t
//! return map, before a step:   P_n <- max(P_n, 0),   P_t <- proj_{μ P_n}(P_t)     v stays: the step itself restores equilibrium
//! ```
//!
//! | point                                 | rows of the derivative, those of C_t divided by max(b, \|z_t\|)                     |
//! |---------------------------------------|-------------------------------------------------------------------------------------|
//! | open,  z_n <= 0                       | δP = −P                                                                             |
//! | stick, \|z_t\| <= b                   | r_n δg = −r_n g,   r_t δd + (r_t d/b) δb = −r_t d                                   |
//! | slip,  \|z_t\| > b,  e = z_t/\|z_t\|  | r_n δg = −r_n g,   δP_t + (P_t/\|z_t\|) e·δz_t − e δb − (b/\|z_t\|) δz_t = b e − P_t |
//!
//! with δz = δP − r δv and δb = μ δz_n. This is the whole derivative of the product: `newton-ac` differentiates P_t −
//! proj_b(z_t), which has b e in place of P_t in the second term of slip and no second term in stick; `pdas` damps the
//! former and drops the latter. All agree at the solution. Far from it the product feels how wrong P_t is, and the return
//! map bounds that. The paper's third method, the implicit return map, is Uzawa's: `augmented-lagrangian`.
//!
//! # Options
//! `r`: r_n = r/W_nn and r_t = r/mean(W_tt) per point, the paper's c. `max_iterations`. `monolithic`: 1 solves each step on all unknowns
//! of the body. `return_map`: 0 never (the paper's GNM), 1 before every
//! step that follows one without progress, 2 before every step but the first (GNM-RM).
//!
//! # Guarantees
//! Locally superlinear where no state changes. None beyond; steps are full. That what converged is a solution is
//! checked on iterates that were not returned.
//!
//! # Failure modes
//! Where the states are far off, the product makes steps longer than `newton-ac` and `pdas` need, the more the larger μ.
//! After 15 steps without progress local and global stages (as in LATIN) move the iterate on: medians of 19 and more are
//! such rescues. On random problems (`stickslip study random`, 200 per entry, tier high) median steps and how many gave up:
//!
//! | μ                  | 0 | 0.1 | 0.3 | 0.6 | 1     | 2     | 5     |
//! |--------------------|---|-----|-----|-----|-------|-------|-------|
//! | 2D, `return_map` 0 | 2 | 5   | 7   | 10  | 15, 1 | 19, 2 | 21, 2 |
//! | 2D, `return_map` 1 | 2 | 5   | 6   | 8   | 10    | 12    | 19, 3 |
//! | 2D, `return_map` 2 | 3 | 5   | 6   | 7   | 9     | 11    | 19, 3 |
//! | 2D, `newton-ac`    | 2 | 3   | 3   | 3   | 3     | 2     | 2     |
//! | 3D, `return_map` 0 | 3 | 5   | 6   | 9   | 16, 3 | 21, 8 | 23, 9 |
//! | 3D, `return_map` 1 | 3 | 6   | 6   | 8   | 10    | 17, 3 | 23, 6 |
//! | 3D, `return_map` 2 | 5 | 7   | 8   | 8   | 11    | 17, 2 | 22, 5 |
//! | 3D, `newton-ac`    | 3 | 5   | 5   | 6   | 6     | 6, 1  | 6     |
//!
//! The return map helps, as the paper found, and does not make up for the product. If v followed the mapped forces instead of
//! waiting for the step, the map would hurt: in 2D at μ = 1 median steps rise to 21. A singular tangent is tried again without
//! (r_t d/b) δb, which asks of redundant points what contradicts itself.
//!
//! # Skips
//! An open crack is one linear solve. Open points leave the dense LU; without friction there are no tangential rows.

#![allow(non_snake_case)]

use crate::condensed::forces::Forces;
use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::contract::law::{Branch, return_map, tangential_norm};
use crate::contract::options::{OptionSpec, options};
use crate::contract::registry::Method;
use crate::error::MethodError;
use crate::newton::contact_point::ContactPoint;
use crate::newton::iteration::{Newton, scheme_options};
use crate::newton::scheme::{At, Scheme};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "gnm",
    label: "Generalised Newton with return map",
    reference: "Nevland, Stefansson & Keilegavlen, arXiv:2508.11508 (2025)",
    summary: "Newton's method on complementarity functions, with forces mapped back to Coulomb's bound where it makes no progress",
    exact: true,
    options: &{
        let [r, steps, monolithic] = scheme_options(MAX_ITERATIONS);
        [r, steps, monolithic, OptionSpec::Whole(RETURN_MAP)]
    },
    source: include_str!("gnm.rs"),
    build: |options| {
        let scheme = Complementarity {
            return_map: options.whole(&RETURN_MAP),
            mapped: false,
            bound_moves: true,
        };
        Box::new(Newton {
            // Steps are full.
            line_search: false,
            ..Newton::new(scheme, options, &MAX_ITERATIONS)
        })
    },
};

options! {
    MAX_ITERATIONS: Whole("max_iterations", 200, 1, 1_000_000): "Newton steps before giving up";
    RETURN_MAP: Whole("return_map", 1, 0, 2): "forces are mapped back to the friction bound: 0 never, 1 where there is no progress, 2 before every step";
}

/// Steps without progress after which forces are mapped back.
const SLOW: usize = 1;

/// C_n and C_t, the latter divided by max(b, |z_t|) so that it is a force; the loop is [`Newton::run`].
#[derive(Clone, Copy)]
struct Complementarity {
    return_map: i64,
    /// Whether the next step is taken from mapped forces.
    mapped: bool,
    /// Whether sticking points have the term (r_t d/b) δb.
    bound_moves: bool,
}

impl Scheme for Complementarity {
    type Piece = Branch;

    fn piece(&self, at: &ContactPoint<'_>) -> Branch {
        at.branch()
    }

    fn linearise(&self, at: &ContactPoint<'_>, piece: Branch, rows: &mut [PointRow; 3]) {
        if !self.mapped {
            return self.coefficients(at, piece, rows);
        }
        let (mut P, size) = ([0.0; 3], at.size());
        P[..size].copy_from_slice(at.P);
        return_map(at.mu, &mut P[..size]);
        let mapped = ContactPoint {
            P: &P[..size],
            ..*at
        };
        *rows = PointRow::reading(self.equations(&mapped));
        self.coefficients(&mapped, mapped.branch(), rows);
        // The step counts from the forces before.
        for row in rows {
            row.h -= (0..size).map(|l| row.a[l] * (P[l] - at.P[l])).sum::<f64>();
        }
    }

    /// Without (r_t d/b) δb where the tangent is singular: of redundant points it asks what contradicts itself.
    fn direction(
        &self,
        at: &mut At<'_, '_>,
        pieces: &mut [Branch],
        step: &mut Forces,
    ) -> Result<bool, MethodError> {
        if at.step(self, pieces, step)? {
            return Ok(true);
        }
        let stiff = Self {
            bound_moves: false,
            ..*self
        };
        at.step(&stiff, pieces, step)
    }

    fn prepare(&mut self, problem: &ContactProblem<'_>, _violation: f64) -> bool {
        self.mapped = match self.return_map {
            0 => false,
            1 => problem.idle() > SLOW,
            _ => problem.counters.iterations > 1,
        };
        false
    }
}

impl Complementarity {
    /// The table.
    fn coefficients(&self, at: &ContactPoint<'_>, piece: Branch, rows: &mut [PointRow; 3]) {
        if piece == Branch::Open {
            return at.open(rows);
        }
        let ContactPoint { mu, r, P, v } = *at;
        let (z, size) = (at.trial(), at.size());
        rows[0].c[0] = r[0];
        let (b, t) = (mu * z[0], tangential_norm(&z[..size]));
        for k in 1..size {
            // Coefficient of δb.
            let bound = if piece == Branch::Stick {
                rows[k].c[k] = r[k];
                let moves = f64::from(u8::from(self.bound_moves));
                moves * r[k] * v[k] / b
            } else {
                rows[k].a[k] = 1.0;
                for l in 1..size {
                    let unit = f64::from(u8::from(k == l));
                    let of_z = (P[k] * z[l] / t - b * unit) / t;
                    rows[k].a[l] += of_z;
                    rows[k].c[l] -= of_z * r[l];
                }
                -z[k] / t
            };
            rows[k].a[0] = mu * bound;
            rows[k].c[0] = -mu * bound * r[0];
        }
    }
}
