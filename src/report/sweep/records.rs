//! What the tables and figures of a sweep share: records in order, columns that name a cell, sets of problems.

use stickslip_methods::Tier;

use crate::report::number::significant;
use crate::report::tables::sweep::{SummaryRow, compare_cells};
use crate::studies::sweep::analysis::problems;
use crate::studies::sweep::analysis::test_set::TestSet;
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

/// A tier in figures.
pub fn tier_heading(tier: Tier) -> String {
    let exponent = significant(tier.tolerance(), 1);
    format!("tier {tier}: natural map ≤ {exponent}")
}
