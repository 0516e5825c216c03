//! Records of a sweep as tables and figures.
//!
//! Files that hold no times are the same on every machine: `cells.csv`, `increments.csv`, `deviations.csv`, `study.csv`,
//! `success.*`, `profiles.csv`, `data_profiles.csv` and their figures. All others belong to the machine. Times stand beside
//! honest verdicts only, see [`published_times`](crate::studies::sweep::analysis::published_times).

mod accuracy;
mod cells;
mod compare;
mod pairwise;
mod profiles;
mod ranking;
mod recommendations;
mod records;
mod success;
mod times;
mod work_precision;

pub use compare::{ChangeRow, bundle as comparison_bundle, table as comparison_table};

use super::csv::{self, Row};
use super::{Bundle, Provenance, ReportError, figures};
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
    pairwise::add(&mut bundle, &sweep)?;
    ranking::add(&mut bundle, &sweep)?;
    work_precision::add(&mut bundle, &sweep)?;
    accuracy::add(&mut bundle, &sweep)?;
    recommendations::add(&mut bundle, &sweep)?;
    let caveat = sweep.caveat();
    figures::fastest::add(&mut bundle, &sweep.sets, &caveat)?;
    figures::performance::add(&mut bundle, &sweep.sets, &caveat)?;
    figures::work_precision::add(&mut bundle, records, &caveat)?;
    figures::time_to_accuracy::add(&mut bundle, records, &caveat)?;
    figures::stages::add(&mut bundle, records, &caveat)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

#[cfg(test)]
mod tests;
