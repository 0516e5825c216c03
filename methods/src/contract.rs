//! The seam of a method, its answer, and its judge: body, increment, state, laws, judge, options, registry.

pub(crate) mod barrier_law;
pub(crate) mod body_work;
pub(crate) mod elastic;
pub(crate) mod free_jump;
pub(crate) mod judge;
pub mod law;
pub(crate) mod operator;
pub(crate) mod options;
pub(crate) mod point_status;
pub(crate) mod products;
pub(crate) mod registry;
pub(crate) mod state;
pub(crate) mod system;
pub(crate) mod tier;

pub use body_work::{ElasticCost, ElasticCounters, ElasticTimings};
pub use elastic::{Elastic, ElasticParts};
pub use judge::{Residuals, consistency, residuals, residuals_of};
pub use operator::{ContactOperator, DelassusForm, SWAYING};
pub use options::{OptionError, OptionSpec, OptionValue, Options, Real, Switch, Whole};
pub use point_status::{PointStatus, point_status};
pub use registry::{Enforcement, Method, NameTaken, Needs, OperatorKind, Registry};
pub use state::{Claim, ContactState, Counters, Iteration, Monitor, Outcome, Silent, Status};
pub use system::{ContactSystem, Increment, Load};
pub use tier::{Tier, UnknownTier};
