//! The problem every method solves, and everything methods share: system, states, law, judge, linear algebra.

pub(crate) mod b_equations;
pub(crate) mod branches;
pub(crate) mod central_path;
pub(crate) mod condensed;
mod elastic;
mod error;
mod judge;
pub mod law;
pub(crate) mod line_search;
pub(crate) mod linear;
pub(crate) mod local;
mod matrix;
mod options;
pub(crate) mod penalised;
mod point_status;
pub(crate) mod reduced;
pub(crate) mod saddle;
pub(crate) mod semismooth;
pub(crate) mod stages;
mod state;
pub(crate) mod sweeps;
mod system;
pub(crate) mod tangent;
mod tier;
mod uniqueness;

pub use elastic::{Elastic, ElasticCounters, ElasticParts, ElasticTimings};
pub use error::MethodError;
pub use judge::{Residuals, residuals, residuals_of};
pub use linear::delassus::MAX_CONDENSED_ROWS;
pub use matrix::{JumpOperator, SymmetricMatrix};
pub use options::{OptionError, OptionSpec, Options};
pub use point_status::{PointStatus, point_status};
pub use state::{Claim, ContactState, Counters, Iteration, Monitor, Outcome, Silent, Status};
pub use system::{ContactSystem, Increment, Load};
pub use tier::{Tier, UnknownTier};
pub use uniqueness::contact_wise_margin;
