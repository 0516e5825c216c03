//! De Saxcé fixed point: second-order cone programs with a shifted gap.
//!
//! Acary, Cadoux, Lemaréchal & Malick, Z. Angew. Math. Mech. 91 (2011) 155. Programs: clarabel, Goulart & Chen,
//! arXiv:2405.12762 (2024). Acceleration: Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715.
//!
//! ```text
//! min ½ P·W P + (q + μ s e_n)·P    over |P_t| <= μ P_n at every point,   Qᵀ P = c
//! s <- |d|,   v = (g, d) = q + W P + Q β,   β the multiplier of Qᵀ P = c
//! ```
//! The optimality conditions of the program are P ∈ K_μ, ṽ = (g + μ s, d) ∈ K_μ*, P·ṽ = 0: for s = |d| De Saxcé's form of
//! the contact laws. Each program is convex, so friction alone is left to the fixed point. Far from it the programs are
//! solved to 1e-3 of the natural map. Near it, at a natural map of 1e-6 or where clarabel makes no more progress, a few steps
//! of the Alart–Curnier method (see `newton-ac`) polish the result. Programs and Newton steps count as iterations, clarabel's own
//! steps as factorisations.
//!
//! # Options
//! `max_iterations`. `anderson`: differences kept by the acceleration of μ s; 0 is the published iteration. `polish`: 0
//! ends at what clarabel reaches, with status `stalled` if that is not enough.
//!
//! # Guarantees
//! Without friction one program is the solution. With friction the program has a solution for every s if the
//! load can be balanced; for the fixed point there is a criterion of existence, not of convergence. Measured on random,
//! strongly coupled systems of 12 points (100 per entry, tolerance 1e-9, `tests/robustness.rs`), median iterations and
//! failures:
//!
//! | μ                 | 0.1   | 0.3   | 0.6     | 1       | 2           | 5             |
//! |-------------------|-------|-------|---------|---------|-------------|---------------|
//! | 2D, `anderson` 5  | 6     | 7     | 10      | 13      | 17, 1 fails | 26, 10 fail   |
//! | 2D, `anderson` 0  | 6     | 9     | 14      | 25      | 51          | 76, 14 fail   |
//! | 3D, `anderson` 5  | 6     | 8     | 11      | 14      | 21, 1 fails | 37, 13 fail   |
//! | 3D, `anderson` 0  | 6     | 10    | 15      | 27      | 62, 4 fail  | 112, 32 fail  |
//!
//! # Failure modes
//! For μ > 1 the fixed point contracts slowly or cycles. After 15 steps without progress it starts once more from the
//! forces of a tied crack; cycles above a natural map of 1e-3 are then reported as `stalled`, not polished. Without
//! polishing clarabel's floor shows: mostly below 1e-9 in 2D, above in 3D. Where a point is at once at its bound and
//! without slip, the floor is the square root of clarabel's tolerance.
//!
//! # Skips
//! An open crack is one linear solve; without friction there is one program and no cone. Points without friction have none.

use crate::condensed::problem::ContactProblem;
use crate::conic::cone_program::ConeProgram;
use crate::conic::fixed_point::{FixedPoint, Program, Settings};
use crate::contract::law::tangential_norm;
use crate::contract::registry::Method;
use crate::error::MethodError;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "socp",
    label: "De Saxcé fixed point (SOCP)",
    reference: "Acary, Cadoux, Lemaréchal & Malick, Z. Angew. Math. Mech. 91 (2011) 155",
    summary: "second-order cone programs, each with the gap shifted by the slip that the one before has left",
    exact: true,
    options: Settings::OPTIONS,
    source: include_str!("socp.rs"),
    build: |options| Box::new(FixedPoint::new(options, program, shift)),
};

fn program(problem: &ContactProblem<'_>) -> Result<Box<dyn Program>, MethodError> {
    Ok(Box::new(ConeProgram::new(problem)?))
}

/// μ s of a point.
fn shift(mu: f64, _: &[f64], v: &[f64]) -> f64 {
    mu * tangential_norm(v)
}
