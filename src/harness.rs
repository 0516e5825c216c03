//! Cases, load paths, runs, verdicts.

pub mod attempt;
pub mod body;
pub mod boundary;
pub mod case;
pub mod converge;
pub mod errors;
pub mod exchange;
pub mod expect;
pub mod export;
pub mod infsup;
pub mod loading;
pub mod nodal_forces;
pub mod patch;
pub mod path;
pub mod picture;
pub mod problem_file;
pub mod quantities;
pub mod random;
pub mod record;
pub mod refusals;
pub mod run;
pub mod shipped;
pub mod sides;
pub mod step;
pub mod stress;
pub mod verdict;
