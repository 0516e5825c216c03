//! Studies: tasks, measured, and what their records say together.
//!
//! ```text
//! source -> plan (tasks) -> lab -> measure -> record -> analysis
//! ```

pub mod analysis;
pub mod axes;
pub mod cases;
pub mod conformance;
pub mod convergence;
pub mod exact_curve;
pub mod exchange;
pub mod expect;
pub mod followed;
pub mod lab;
pub mod measure;
pub mod memory;
pub mod origin;
pub mod paper;
pub mod plan;
pub mod record;
pub mod records;
pub mod results;
pub mod rows;
pub mod several;
pub mod sources;
pub mod statistics;
pub mod stress;
pub mod task;
pub mod tips;
pub mod why;
pub mod worker;
