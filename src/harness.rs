//! Cases, load paths, runs, verdicts.

pub mod body;
pub mod boundary;
pub mod case;
pub mod converge;
pub mod errors;
pub mod exact_curve;
pub mod exchange;
pub mod expect;
pub mod export;
pub mod increment;
pub mod infsup;
pub mod load_path;
pub mod loading;
pub mod nodal_forces;
pub mod patch;
pub mod picture;
pub mod problem_file;
pub mod quantities;
pub mod random;
pub mod record;
pub mod refusals;
pub mod run;
pub mod shipped;
pub mod sides;
pub mod stress;
pub mod verdict;
