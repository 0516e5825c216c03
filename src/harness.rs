//! Cases, load paths, runs, verdicts.

pub mod attempt;
pub mod body;
pub mod boundary;
pub mod case;
pub mod expect;
pub mod picture;
pub mod quantities;
pub mod random;
pub mod record;
pub mod refusals;
pub mod run;
pub mod shipped;
pub mod stress;
pub mod verdict;
