//! What the tables and figures of a sweep share: records in order, columns that name a cell, sets of problems.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use crate::report::csv::Row;
use crate::report::number::value;
use crate::studies::sweep::analysis::test_set::TestSet;
use crate::studies::sweep::analysis::{compare_methods, compare_problems, problems};
use crate::studies::sweep::record::{Record, SCHEMA};

/// Records of a sweep as its tables and figures need them.
pub struct SweepRecords<'a> {
    /// What was measured.
    pub records: &'a [Record],
    /// Cells that the sweep has in all.
    pub total: usize,
    /// One per tier, coarsest first.
    pub sets: Vec<TestSet<'a>>,
}

impl<'a> SweepRecords<'a> {
    pub fn new(records: &'a [Record], total: usize) -> Self {
        let sets = Tier::ALL.map(|tier| TestSet::new(records, tier));
        Self {
            records,
            total,
            sets: sets.into(),
        }
    }

    /// Records in the order of the tables.
    pub fn sorted(&self) -> Vec<&'a Record> {
        let mut sorted: Vec<&Record> = self.records.iter().collect();
        sorted.sort_by(|a, b| compare_cells(a, b));
        sorted
    }

    /// What a caption says of a sweep that is not complete.
    pub fn caveat(&self) -> String {
        let found = self.records.len();
        if found < self.total {
            format!("; incomplete, {found} of {} cells", self.total)
        } else {
            String::new()
        }
    }

    pub fn rows(&self) -> Vec<SummaryRow> {
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
        let row = |(quantity, value)| SummaryRow { quantity, value };
        own.into_iter().chain(sizes).map(row).collect()
    }
}

/// A number about the sweep as a whole.
pub struct SummaryRow {
    quantity: String,
    value: usize,
}

impl Row for SummaryRow {
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
pub fn compare_cells(a: &Record, b: &Record) -> Ordering {
    compare_problems(&a.cell.problem(), &b.cell.problem())
        .then_with(|| compare_methods(&a.found.method, &b.found.method))
        .then(b.cell.tolerance.total_cmp(&a.cell.tolerance))
        .then_with(|| a.id.cmp(&b.id))
}

/// Columns that say which cell a row is about.
pub const CELL_COLUMNS: [&str; 8] = [
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
pub fn cell_columns(record: &Record) -> Vec<String> {
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
