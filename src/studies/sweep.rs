//! Sweeps: many cells (case × mesh × space × friction × method × tolerance), each measured by itself and kept as a record.
//!
//! ```text
//! sweep file -> plan -> conduct -> (worker: measure -> record) -> store -> merge -> analysis -> report
//! ```

pub mod analysis;
mod block;
pub mod bodies;
pub mod cell;
pub mod conduct;
pub mod files;
pub mod measure;
pub mod merge;
mod options;
pub mod plan;
pub mod record;
pub mod statistics;
pub mod store;
