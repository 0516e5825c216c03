//! Cases, load paths, runs, verdicts.

pub mod body;
pub mod boundary;
pub mod case;
pub mod record;
