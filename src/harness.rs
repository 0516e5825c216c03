//! Cases, load paths, runs, verdicts.

pub mod case;
pub mod record;
