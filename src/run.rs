//! Runs of methods on a model: increment after increment, judged, and kept as rows.

pub mod attempt;
pub mod choice;
pub mod exact_curve;
pub mod expect;
pub mod path;
pub mod provenance;
pub mod record;
pub mod registry;
pub mod run_case;
pub mod step;
pub mod verdict;
