//! Studies: many runs, and what they say together.

pub mod atlas;
pub mod conformance;
pub mod convergence;
pub mod exchange;
pub mod memory;
pub mod paper;
pub mod robustness;
pub mod stress;
pub mod sweep;
pub mod worker;
