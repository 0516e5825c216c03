//! Algebraic methods for frictional contact: one problem, one judge, interchangeable solvers.
//!
//! # The problem
//!
//! A linear elastic body with contact points, each with a local frame `(n, a[, b])`; n points from side 2 to side 1.
//! ```text
//! K u = f + Bᵀ P            equilibrium; P acts on side 1
//! [[u]] = B u + offset      jump u₁ − u₂ at the contact points
//! g = [[u]]·n               gap, open > 0
//! d = [[u]]_t − [[u]]_t(start of the increment)        slip increment
//!
//! 0 <= g ⊥ P_n >= 0         Signorini; P_n > 0 is compression
//! |P_t| <= μ P_n            Coulomb, backward Euler
//! d ≠ 0  ⇒  P_t = −μ P_n d/|d|
//! ```
//! K does not change with the contact. It is factored once per [`Elastic`] and condensed to the contact points:
//! ```text
//! [[u]] = q + W P + N α,   Nᵀ P = −Rᵀ f,    W = B K⁻¹ Bᵀ  (Delassus operator),  q = B K⁻¹ f + offset
//! ```
//! R spans the kernel of K where the body floats, N = B R are the jumps of these rigid motions and α their
//! amplitudes; usually there are none.
//!
//! # Use
//!
//! Build an [`Elastic`] from [`ElasticParts`], a [`ContactSystem`] from it per set of friction coefficients, and an
//! [`Increment`] per load. Any method of a [`Registry`] solves the increment; [`residuals`] judges the answer. One point on
//! two springs, pressed by 4 N and pulled sideways by 3 N, slips at μ = 0.5 with P_t = −2 N:
//! ```
//! use stickslip_methods::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let elastic = Elastic::new(ElasticParts {
//!     dim: 2,
//!     stiffness: SquareMatrix::symmetric(2, vec![0, 1, 2], vec![0, 1], vec![2.0, 5.0])?,
//!     jump: JumpOperator::new(2, 2, vec![0, 1, 2], vec![0, 1], vec![1.0, 1.0])?,
//!     weight: vec![1.0],
//!     order: vec![0, 1],
//!     floating: vec![],
//!     frictionless: vec![],
//!     traction: None,
//! })?;
//! let system = ContactSystem::new(elastic, vec![0.5])?;
//! let rest = Load { force: vec![0.0, 0.0], offset: vec![0.0, 0.0], traction: vec![] };
//! let load = Load { force: vec![-4.0, 3.0], offset: vec![0.0, 0.0], traction: vec![] };
//! let start = ContactState::zero(&system);
//! let increment = Increment {
//!     system: &system,
//!     load: &load,
//!     start_load: &rest,
//!     start: &start,
//!     guess: None,
//!     index: 0,
//!     tolerance: Tier::High.tolerance(),
//! };
//! for method in Registry::standard().iter().filter(|m| m.exact) {
//!     let mut solver = (method.build)(&Options::new(method.options, &[])?);
//!     let outcome = solver.solve(&increment, &mut Silent)?;
//!     if outcome.status == Status::Converged {
//!         assert!((outcome.state.p[1] + 2.0).abs() < 1e-8);
//!         assert!(residuals(&increment, &outcome.state)?.violation <= increment.tolerance);
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Methods
//!
//! Each has a page with its equations, options, guarantees and failure modes: [`newton`], [`splitting`], [`conic`],
//! [`combined`], [`own_laws`].
//!
//! # Add a method
//!
//! Here: one file in the folder of its family that exports `METHOD`, and one line, its `mod` in the family's list. Elsewhere:
//! [`Registry::with`]. A method on the condensed increment implements [`CondensedMethod`]; [`ContactProblem`] says what it is
//! given. `splitting/nsgs.rs` and `splitting/latin.rs` are short models.

mod algebra;
mod condensed;
mod contract;
mod error;

pub mod combined;
pub mod conic;
pub mod newton;
pub mod own_laws;
pub mod splitting;

pub use algebra::delassus::{Delassus, check_rows};
pub use algebra::matrix::{JumpOperator, SquareMatrix};
pub use algebra::memory::machine_gb;
pub use algebra::rows::RowSet;
pub use condensed::*;
pub use contract::*;
pub use error::MethodError;

impl Registry {
    /// The methods of this package: Newton methods, multiplier and splitting methods, sweeps, fixed points, and those that
    /// solve laws of their own. A file of a family that exports `METHOD` is listed by its `mod` line, see `build.rs`.
    pub fn standard() -> Self {
        STANDARD.iter().copied().collect()
    }
}

include!(concat!(env!("OUT_DIR"), "/standard.rs"));
