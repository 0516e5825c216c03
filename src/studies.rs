//! Studies: many runs, and what they say together.

pub mod convergence;
pub mod exchange;
pub mod paper;
pub mod spaces;
pub mod stress;
pub mod sweep;
