//! The kinds of figures, one file each: rows in, SVG files in a [`Bundle`](super::Bundle) out.
//!
//! A kind declares itself in its `KIND` and is listed in [`CATALOGUE`]; manual and page follow from there. Times, profiles
//! and errors stand beside honest verdicts only: runs that solved the contact laws or, named as such, their own ones.

pub mod agreement;
pub mod cost;
pub mod error;
pub mod fields;
pub mod friction_loop;
mod kind;
pub mod options;
pub mod performance;
pub mod profile;
mod quantity_name;
pub mod residual;
mod runs;
pub use runs::distinct;
pub mod scaling;
pub mod stages;
pub mod success;
pub mod time_against_solver_error;
pub mod time_against_total_error;

use super::tables::Chapter;
pub use kind::Kind;

/// All kinds with the chapter they belong to, in the order of the page.
pub static CATALOGUE: [(Chapter, &Kind); 14] = [
    (Chapter::Methods, &cost::KIND),
    (Chapter::Study, &success::KIND),
    (Chapter::Study, &scaling::CLASSES),
    (Chapter::Study, &scaling::TIME),
    (Chapter::Study, &options::KIND),
    (Chapter::Study, &time_against_solver_error::KIND),
    (Chapter::Study, &time_against_total_error::KIND),
    (Chapter::Study, &performance::KIND),
    (Chapter::Study, &stages::KIND),
    (Chapter::Accuracy, &error::KIND),
    (Chapter::Runs, &fields::KIND),
    (Chapter::Runs, &residual::KIND),
    (Chapter::Runs, &profile::KIND),
    (Chapter::Runs, &friction_loop::KIND),
];
