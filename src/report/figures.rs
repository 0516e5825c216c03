//! The kinds of figures, one file each: rows in, SVG files in a [`Bundle`] out.
//!
//! A kind declares itself in its `KIND` and is listed in [`CATALOGUE`]; manual and page follow from there. Times, profiles
//! and errors stand beside honest verdicts only: runs that solved the contact laws or, named as such, their own ones.

pub mod agreement;
pub mod converged;
pub mod cost;
pub mod error;
pub mod fastest;
pub mod fields;
pub mod friction_loop;
pub mod infsup;
pub mod performance;
pub mod profile;
mod quantity_name;
pub mod residual;
pub mod robustness;
mod runs;
pub mod stages;
pub mod table1;
pub mod time_to_accuracy;
pub mod work_precision;

use super::{Bundle, ReportError};

/// A kind of figure, as the reader knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// File name in `figures/`; `*` stands for what tells the files of a kind apart: case, mesh, contact space, method,
    /// friction coefficient, crack, quantity, tier.
    pub file: &'static str,
    /// The reader's question that it answers.
    pub question: &'static str,
    /// What is drawn, for the manual.
    pub shows: &'static str,
}

impl Kind {
    /// Whether a file of this name (without its folder) is of this kind.
    pub fn has(&self, name: &str) -> bool {
        match self.file.split_once('*') {
            Some((start, end)) => name.starts_with(start) && name.ends_with(end),
            None => name == self.file,
        }
    }

    /// Adds a figure of this kind, where there is something to draw.
    fn add(&self, bundle: &mut Bundle, own: &str, svg: Option<String>) -> Result<(), ReportError> {
        if let Some(svg) = svg {
            bundle.add(format!("figures/{}", self.file.replacen('*', own, 1)), svg)?;
        }
        Ok(())
    }
}

/// All kinds: the comparison of methods, problems, the founding paper, studies.
pub static CATALOGUE: [&Kind; 17] = [
    &cost::KIND,
    &residual::KIND,
    &profile::KIND,
    &friction_loop::KIND,
    &fields::CONTACT,
    &fields::DISPLACEMENT,
    &fields::VON_MISES,
    &table1::KIND,
    &converged::KIND,
    &robustness::KIND,
    &infsup::KIND,
    &error::KIND,
    &fastest::KIND,
    &performance::KIND,
    &work_precision::KIND,
    &time_to_accuracy::KIND,
    &stages::KIND,
];
