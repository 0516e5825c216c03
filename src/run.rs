//! Runs of methods on a model: increment after increment, judged, and kept as rows.

pub mod choice;
pub mod judged;
pub mod loads;
pub mod local_problem;
pub mod outside;
pub mod path;
pub mod progress;
pub mod provenance;
pub mod registry;
pub mod verdict;
