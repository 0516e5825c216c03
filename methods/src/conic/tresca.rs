//! Tresca fixed point: contact with a given friction bound, again and again.
//!
//! Nečas, Jarušek & Haslinger, Boll. Un. Mat. Ital. B 17 (1980) 796, for the existence of Coulomb solutions; as algorithm
//! Haslinger, Hlaváček & Nečas, Handbook of Numerical Analysis IV (1996) 313. Problems: MPRGP,
//! Dostál & Schöberl, Comput. Optim. Appl. 30 (2005) 23 (`conic/mprgp.rs`). Acceleration: Walker & Ni, SIAM J. Numer. Anal.
//! 49 (2011) 1715.
//!
//! ```text
//! min ½ P·W P + q·P    over P_n >= 0, |P_t| <= g at every point,   Qᵀ P = c
//! g <- μ P_n
//! ```
//! Each problem is convex: Tresca's friction with the bound g. Its solution with g = μ P_n is one of Coulomb's. The first
//! bound is that of the increment's start: from rest it is 0, and the first problem is frictionless. Each problem is solved by
//! projected and conjugate gradients on active sets (MPRGP), from the last one's forces, far from the fixed point to 1e-3 of
//! the natural map. Near it, at a natural map of 1e-6 or where the problems make no more progress, a few steps of the
//! Alart–Curnier method (see `newton-ac`) polish the result. Problems and Newton steps count as iterations.
//!
//! # Options
//! `max_iterations`. `anderson`: differences kept by the acceleration of g; 0 is the plain iteration. `polish`: 0 ends at
//! what gradients reach, with status `stalled` if that is not enough.
//!
//! # Guarantees
//! Without friction one problem is the solution. The fixed point contracts for small μ. Measured on random, strongly
//! coupled systems of 12 points (100 per entry, tolerance 1e-9, `tests/robustness.rs`), median iterations and failures:
//!
//! | μ                 | 0.1   | 0.3   | 0.6     | 1       | 2           | 5             |
//! |-------------------|-------|-------|---------|---------|-------------|---------------|
//! | 2D, `anderson` 5  | 6     | 8     | 9       | 10      | 11          | 10, 1 fails  |
//! | 2D, `anderson` 0  | 6     | 8     | 11      | 16      | 20, 12 fail | 5, 44 fail   |
//! | 3D, `anderson` 5  | 6     | 7     | 9       | 10      | 13, 1 fails | 13, 3 fail   |
//! | 3D, `anderson` 0  | 6     | 8     | 12      | 16      | 19, 15 fail | 8, 50 fail   |
//!
//! # Failure modes
//! Where friction locks a wedge (μ above the tangent of its angle) μ P_n exceeds the bound it came from until all sticks: the
//! acceleration drops differences along which the iteration expands, their secant would lead back. Without progress for 15
//! steps the iteration starts once more from the forces of a tied crack. For μ > 1 the plain fixed point cycles between bounds;
//! acceleration breaks nearly all cycles. The rest is reported as `stalled`: above a natural map of 1e-3 nothing is polished.
//!
//! # Skips
//! An open crack is one linear solve. Problems are factored nowhere; polishing factors a tangent per step.

#![allow(non_snake_case)]

use crate::condensed::problem::ContactProblem;
use crate::conic::fixed_point::{FixedPoint, Program, Settings};
use crate::conic::mprgp::Mprgp;
use crate::contract::registry::Method;
use crate::error::MethodError;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "tresca",
    label: "Tresca fixed point",
    reference: "Haslinger, Hlaváček & Nečas, Handbook of Numerical Analysis IV (1996) 313",
    summary: "contact with a given friction bound, taken from the normal forces of the problem before",
    exact: true,
    options: Settings::OPTIONS,
    source: include_str!("tresca.rs"),
    build: |options| Box::new(FixedPoint::new(options, program, bound)),
};

fn program(problem: &ContactProblem<'_>) -> Result<Box<dyn Program>, MethodError> {
    Ok(Box::new(Mprgp::new(problem)))
}

/// g of a point.
fn bound(mu: f64, P: &[f64], _: &[f64]) -> f64 {
    mu * P[0].max(0.0)
}
