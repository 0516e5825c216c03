//! The increment seen from the contact points, and the pieces that methods on them are built from.

pub(crate) mod acceleration;
pub(crate) mod anchor;
pub(crate) mod anderson;
pub(crate) mod branches;
#[cfg(test)]
pub(crate) mod fixture;
pub(crate) mod forces;
pub(crate) mod gauge;
pub(crate) mod local;
pub(crate) mod local_form;
pub(crate) mod method;
pub(crate) mod pair;
pub(crate) mod point_row;
pub(crate) mod problem;
pub(crate) mod recovery;
pub(crate) mod saddle;
pub(crate) mod stages;
pub(crate) mod starts;
pub(crate) mod sweeps;
pub(crate) mod whole_body;

pub use forces::{End, Ended, Forces};
pub use gauge::Gauge;
pub use local_form::LocalForm;
pub use method::CondensedMethod;
pub use problem::{Check, ContactProblem, Limits};
pub use starts::{contact_wise_margin, guess};
