//! Records of a sweep as tables and figures.
//!
//! Files that hold no times are the same on every machine: `cells.csv`, `increments.csv`, `deviations.csv`, `study.csv`,
//! `success.*`. All others belong to the machine. Times stand beside
//! honest verdicts only, see [`published_times`](crate::studies::sweep::analysis::published_times).

mod accuracy;
mod cells;
mod compare;
mod profiles;
mod ranking;
mod recommendations;
mod records;
mod success;
mod times;
mod work_precision;

pub use compare::{ChangeRow, bundle as comparison_bundle, table as comparison_table};

use super::csv::{self, Row};
use super::{Bundle, Provenance, ReportError};
use crate::studies::sweep::record::Record;
use records::{SummaryRow, SweepRecords};

/// Files of a sweep; `total`: cells that the sweep has in all. Paths have no common folder.
///
/// # Errors
/// Those of the parts.
pub fn bundle(
    records: &[Record],
    total: usize,
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let sweep = SweepRecords::new(records, total);
    let mut bundle = Bundle::new();
    bundle.add(SummaryRow::FILE, csv::file(&sweep.rows())?)?;
    cells::add(&mut bundle, &sweep)?;
    times::add(&mut bundle, &sweep)?;
    success::add(&mut bundle, &sweep)?;
    profiles::add(&mut bundle, &sweep)?;
    ranking::add(&mut bundle, &sweep)?;
    work_precision::add(&mut bundle, &sweep)?;
    accuracy::add(&mut bundle, &sweep)?;
    recommendations::add(&mut bundle, &sweep)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

#[cfg(test)]
mod tests;
