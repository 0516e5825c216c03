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
//! [`Increment`] per load. Any entry of [`METHODS`] solves the increment; [`residuals`] judges the answer. One point on
//! two springs, pressed by 4 N and pulled sideways by 3 N, slips at μ = 0.5 with P_t = −2 N:
//! ```
//! use stickslip_methods::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let elastic = Elastic::new(ElasticParts {
//!     dim: 2,
//!     stiffness: SymmetricMatrix::new(2, vec![0, 1, 2], vec![0, 1], vec![2.0, 5.0])?,
//!     jump: JumpOperator::new(2, 2, vec![0, 1, 2], vec![0, 1], vec![1.0, 1.0])?,
//!     weight: vec![1.0],
//!     order: vec![0, 1],
//!     floating: vec![],
//!     frictionless: false,
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
//!     index: 0,
//!     tolerance: Tier::High.tolerance(),
//! };
//! for method in METHODS.iter().filter(|m| m.exact) {
//!     let mut solver = (method.build)(&Options::new(method.options, &[])?)?;
//!     let outcome = solver.solve(&increment, &mut Silent)?;
//!     assert_eq!(outcome.status, Status::Converged);
//!     assert!((outcome.state.p[1] + 2.0).abs() < 1e-8);
//!     assert!(residuals(&increment, &outcome.state)?.natural_map <= increment.tolerance);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Add a method
//!
//! One file beside this one that exports `METHOD`, and two lines here: `mod` and the [`METHODS`] entry.

mod algebra;
mod condensed;
mod contract;
mod error;

pub mod conic;
pub mod newton;
pub mod own_laws;
pub mod splitting;

pub use algebra::delassus::MAX_CONDENSED_ROWS;
pub use algebra::matrix::{JumpOperator, SymmetricMatrix};
pub use condensed::local_form::LocalForm;
pub use condensed::starts::{Start, Uniqueness, from_all_starts};
pub use condensed::uniqueness::contact_wise_margin;
pub use contract::elastic::{Elastic, ElasticCounters, ElasticParts, ElasticTimings};
pub use contract::judge::{Residuals, consistency, residuals, residuals_of};
pub use contract::law;
pub use contract::options::{OptionError, OptionSpec, Options};
pub use contract::point_status::{PointStatus, point_status};
pub use contract::state::{
    Claim, ContactState, Counters, Iteration, Monitor, Outcome, Silent, Status,
};
pub use contract::system::{ContactSystem, Increment, Load};
pub use contract::tier::{Tier, UnknownTier};
pub use error::MethodError;

/// A method of enforcing the contact laws.
///
/// It may keep factorisations between calls, never history: the same increment twice gives the same bits.
pub trait Enforcement: Send {
    /// Why the method cannot treat this system; `None` if it can.
    fn refuses(&self, _system: &ContactSystem) -> Option<String> {
        None
    }

    /// Whether the method works with the stress at the contact points, [`ElasticParts::traction`].
    fn needs_traction(&self) -> bool {
        false
    }

    /// Factors what any load needs: K. `solve` does it if it was not done before. The condensation to the contact
    /// points waits for the first load that closes the contact, because an open crack does not need it;
    /// [`ContactSystem::condense`] brings it forward, [`Elastic::timings`] tells its time apart.
    ///
    /// # Errors
    /// Input that no method could treat; see [`MethodError`].
    fn prepare(&mut self, system: &ContactSystem) -> Result<(), MethodError>;

    /// Solves one increment. Failure to converge is a [`Status`].
    ///
    /// # Errors
    /// Input that no method could treat; see [`MethodError`].
    fn solve(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError>;
}

/// A registered method.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Name on the command line and in tables.
    pub name: &'static str,
    /// Name in plots.
    pub label: &'static str,
    /// Where it was published.
    pub reference: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// Whether its limit is the solution of the contact laws; otherwise a parameter is a modelling error.
    pub exact: bool,
    /// Options it takes.
    pub options: &'static [OptionSpec],
    /// Its own file, whose head is its page; see [`page`](Method::page).
    pub source: &'static str,
    /// Makes an instance.
    pub build: fn(&Options) -> Result<Box<dyn Enforcement>, MethodError>,
}

impl Method {
    /// What there is to know about the method, in Markdown: equations, options, guarantees, failure modes, what it skips.
    /// It is the documentation at the head of the method's file, so that there is one text.
    pub fn page(&self) -> String {
        let head = self.source.lines().map_while(|l| l.strip_prefix("//!"));
        let lines: Vec<&str> = head.map(|l| l.strip_prefix(' ').unwrap_or(l)).collect();
        lines.join("\n") + "\n"
    }
}

/// All methods: Newton methods, the interior point, multiplier and splitting methods, sweeps, fixed points, and those that
/// solve laws of their own.
pub static METHODS: &[&Method] = &[
    &newton::b_newton::METHOD,
    &newton::newton_ac::METHOD,
    &newton::pdas::METHOD,
    &newton::hybrid::METHOD,
    &newton::interior_point::METHOD,
    &splitting::augmented_lagrangian::METHOD,
    &splitting::latin::METHOD,
    &splitting::admm::METHOD,
    &splitting::nsgs::METHOD,
    &splitting::projection::METHOD,
    &conic::socp::METHOD,
    &conic::tresca::METHOD,
    &own_laws::penalty::METHOD,
    &own_laws::barrier::METHOD,
    &own_laws::nitsche::METHOD,
];

/// The method of that name.
pub fn method(name: &str) -> Option<&'static Method> {
    METHODS.iter().copied().find(|m| m.name == name)
}
