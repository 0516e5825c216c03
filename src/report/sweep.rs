//! A study: records of a sweep as tables and figures.
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
mod success;
mod times;
mod work_precision;

pub use compare::{ChangeRow, bundle as comparison_bundle, table as comparison_table};

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::csv::{self, Row};
use super::number::value;
use super::{Bundle, Provenance, ReportError};
use crate::studies::sweep::analysis::test_set::TestSet;
use crate::studies::sweep::analysis::{compare_methods, compare_problems, problems};
use crate::studies::sweep::record::{Record, SCHEMA};

/// Files of a study; `total`: cells that the sweep has in all. Paths have no common folder.
///
/// # Errors
/// Those of the parts.
pub fn bundle(
    records: &[Record],
    total: usize,
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let study = Study::new(records, total);
    let mut bundle = Bundle::new();
    bundle.add(StudyRow::FILE, csv::file(&study.rows())?)?;
    cells::add(&mut bundle, &study)?;
    times::add(&mut bundle, &study)?;
    success::add(&mut bundle, &study)?;
    profiles::add(&mut bundle, &study)?;
    pairwise::add(&mut bundle, &study)?;
    ranking::add(&mut bundle, &study)?;
    work_precision::add(&mut bundle, &study)?;
    accuracy::add(&mut bundle, &study)?;
    recommendations::add(&mut bundle, &study)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// What the parts share.
struct Study<'a> {
    records: &'a [Record],
    total: usize,
    /// One per tier, coarsest first.
    sets: Vec<TestSet<'a>>,
}

impl<'a> Study<'a> {
    fn new(records: &'a [Record], total: usize) -> Self {
        let sets = Tier::ALL.map(|tier| TestSet::new(records, tier));
        Self {
            records,
            total,
            sets: sets.into(),
        }
    }

    /// Records in the order of the tables.
    fn sorted(&self) -> Vec<&'a Record> {
        let mut sorted: Vec<&Record> = self.records.iter().collect();
        sorted.sort_by(|a, b| compare_cells(a, b));
        sorted
    }

    /// What a caption says of a sweep that is not complete.
    fn caveat(&self) -> String {
        let found = self.records.len();
        if found < self.total {
            format!("; incomplete, {found} of {} cells", self.total)
        } else {
            String::new()
        }
    }

    fn rows(&self) -> Vec<StudyRow> {
        let set = |tier: Tier| self.sets.iter().find(move |set| set.tier == tier);
        let sizes = Tier::ALL.into_iter().flat_map(|tier| {
            let [compared, left_out] =
                set(tier).map_or([0, 0], |set| [set.problems.len(), set.left_out]);
            [
                (format!("problems_compared_{tier}"), compared),
                (format!("problems_left_out_{tier}"), left_out),
            ]
        });
        let own = [
            ("cells".to_owned(), self.records.len()),
            ("cells_of_the_sweep".to_owned(), self.total),
            ("problems".to_owned(), problems(self.records).len()),
            ("schema".to_owned(), SCHEMA as usize),
        ];
        let row = |(quantity, value)| StudyRow { quantity, value };
        own.into_iter().chain(sizes).map(row).collect()
    }
}

/// A number about the study as a whole.
struct StudyRow {
    quantity: String,
    value: usize,
}

impl Row for StudyRow {
    const FILE: &'static str = "study.csv";
    const COLUMNS: &'static [&'static str] = &["quantity", "value"];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![self.quantity.clone(), self.value.to_string()]
    }

    fn order(&self, other: &Self) -> Ordering {
        self.quantity.cmp(&other.quantity)
    }
}

/// Order of cells: problem, method, tolerance from coarse to fine.
fn compare_cells(a: &Record, b: &Record) -> Ordering {
    compare_problems(&a.cell.problem(), &b.cell.problem())
        .then_with(|| compare_methods(&a.found.method, &b.found.method))
        .then(b.cell.tolerance.total_cmp(&a.cell.tolerance))
        .then_with(|| a.id.cmp(&b.id))
}

/// Columns that say which cell a row is about.
const CELL_COLUMNS: [&str; 8] = [
    "id",
    "case",
    "refine",
    "mesh",
    "space",
    "friction",
    "method",
    "tolerance",
];

/// Their contents.
fn cell_columns(record: &Record) -> Vec<String> {
    let cell = &record.cell;
    let size = record.found.problem.as_ref();
    let own = cell.space.as_deref().unwrap_or("own");
    vec![
        record.id.clone(),
        cell.case.clone(),
        cell.refine.to_string(),
        size.map_or_else(String::new, |size| size.mesh.clone()),
        size.map_or(own, |size| &size.space).to_owned(),
        value(cell.mu()),
        record.found.method.clone(),
        value(cell.tolerance),
    ]
}

/// A tier in figures.
fn tier_heading(tier: Tier) -> String {
    let exponent = super::number::significant(tier.tolerance(), 1);
    format!("tier {tier}: natural map ≤ {exponent}")
}

#[cfg(test)]
mod tests;
