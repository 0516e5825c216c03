//! Runs of methods on a model: increment after increment, judged, and kept as rows.

pub mod choice;
pub mod exact_curve;
pub mod expect;
pub mod increment;
pub mod load_path;
pub mod local_problem;
pub mod outside;
pub mod provenance;
pub mod record;
pub mod registry;
pub mod run_case;
pub mod several;
pub mod verdict;
