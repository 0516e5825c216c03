//! Records of a sweep as tables and figures.
//!
//! Files that hold no times are the same on every machine: `cells.csv`, `increments.csv`, `deviations.csv`, `study.csv`,
//! `success.*`. All others belong to the machine. Times stand beside
//! honest verdicts only, see [`published_times`](crate::studies::sweep::analysis::published_times).

mod accuracy;
mod profiles;
mod records;
mod times;
mod work_precision;

use super::number::{fixed, significant};
use super::table::{self, Readable, readable};
use super::tables::sweep::{CellRow, ChangeRow, DeviationRow, IncrementRow, RankingRow};
use super::{Bundle, Provenance, ReportError};
use crate::studies::sweep::analysis::accuracy::sequences;
use crate::studies::sweep::analysis::costs::Costs;
use crate::studies::sweep::analysis::ranking::ranking;
use crate::studies::sweep::analysis::recommendation::recommendations;
use crate::studies::sweep::analysis::success::success;
use crate::studies::sweep::cell::Problem;
use crate::studies::sweep::compare::{Change, Comparison, What};
use crate::studies::sweep::record::Record;
use records::SweepRecords;

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
    let caveat = sweep.caveat();
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &sweep.rows(), "")?;
    add_cells(&mut bundle, &sweep)?;
    times::add(&mut bundle, &sweep)?;
    table::add(&mut bundle, &success(records), &caveat)?;
    profiles::add(&mut bundle, &sweep)?;
    table::add(&mut bundle, &rankings(&sweep), &caveat)?;
    work_precision::add(&mut bundle, &sweep)?;
    accuracy::add(&mut bundle, &sweep)?;
    table::add(&mut bundle, &recommendations(records), &caveat)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// Adds `cells.csv`, `increments.csv` and `deviations.csv`.
fn add_cells(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let records = sweep.sorted();
    let cells: Vec<CellRow> = records.iter().map(|record| CellRow(record)).collect();
    table::add(bundle, &cells, "")?;
    let increments = records.iter().flat_map(|record| IncrementRow::of(record));
    table::add(bundle, &increments.collect::<Vec<_>>(), "")?;
    // A quantity without exact value says something only beside that of another mesh.
    let refined: Vec<Problem> = sequences(sweep.records).into_iter().flatten().collect();
    let deviations = records.iter().flat_map(|record| {
        let several = refined.contains(&record.cell.problem());
        DeviationRow::of(record).filter(move |row| several || row.is_exact())
    });
    table::add(bundle, &deviations.collect::<Vec<_>>(), "")
}

/// Methods by mean time, tier after tier.
fn rankings(sweep: &SweepRecords<'_>) -> Vec<RankingRow> {
    let of = |set| Some((set, ranking(&Costs::new(set))?));
    let all = sweep.sets.iter().filter_map(of);
    all.flat_map(|(set, own)| RankingRow::of(set.tier, &own))
        .collect()
}

/// All changes for reading. What differs only in its bits is counted in the title.
pub fn comparison_table(comparison: &Comparison) -> Readable {
    let Comparison {
        changes,
        common,
        identical,
        timed,
        drift,
        noise,
    } = comparison;
    let mut note = format!(": {common} cells in both, {identical} found the same bit by bit");
    if *timed > 0 {
        note += &format!(
            ", {timed} with comparable times: the machine took {} times as long, noise {} %",
            significant(drift.exp(), 3),
            fixed(100.0 * noise.exp_m1(), 1),
        );
    }
    let seen = |change: &&Change| change.what != What::Bits;
    let rows: Vec<ChangeRow> = changes.iter().filter(seen).map(ChangeRow).collect();
    readable(&rows, &note)
}

/// `compare.csv`, and the table as `compare.md`.
///
/// # Errors
/// Those of [`table::add`].
pub fn comparison_bundle(comparison: &Comparison) -> Result<Bundle, ReportError> {
    let rows: Vec<ChangeRow> = comparison.changes.iter().map(ChangeRow).collect();
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &rows, "")?;
    bundle.add("compare.md", comparison_table(comparison).markdown())?;
    Ok(bundle)
}

#[cfg(test)]
mod tests;
