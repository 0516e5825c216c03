//! The increment seen from the contact points, and the pieces that methods on them are built from.

pub(crate) mod branches;
pub mod forces;
pub(crate) mod local;
pub mod local_form;
pub mod method;
pub(crate) mod point_row;
pub mod problem;
pub(crate) mod saddle;
pub(crate) mod stages;
pub mod starts;
pub(crate) mod sweeps;
pub mod uniqueness;
pub(crate) mod unloaded;
pub(crate) mod whole_body;
