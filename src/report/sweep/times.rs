//! What was spent: the stages of every cell whose times may be shown.

use std::cmp::Ordering;

use super::records::{CELL_COLUMNS, SweepRecords, cell_columns, compare_cells};
use crate::report::csv::{self, Row};
use crate::report::number::{significant, time};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::{method_time, published_times};
use crate::studies::sweep::record::{Record, Spent};
use crate::studies::sweep::statistics::Timing;

/// Adds `times.csv`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let rows: Vec<TimeRow> = sweep.sorted().into_iter().filter_map(TimeRow::of).collect();
    Ok(bundle.add(TimeRow::FILE, csv::file(&rows)?)?)
}

struct TimeRow<'a> {
    record: &'a Record,
    spent: &'a Spent,
}

impl<'a> TimeRow<'a> {
    fn of(record: &'a Record) -> Option<Self> {
        let spent = published_times(record)?;
        Some(Self { record, spent })
    }

    /// Medians of all stages.
    fn stages(&self) -> [f64; 7] {
        let Spent {
            setup_s,
            assembly_s,
            factorisation_s,
            condensation_s,
            prepare,
            solve,
            output_s,
            peak_mb: _,
        } = self.spent;
        [
            *setup_s,
            *assembly_s,
            *factorisation_s,
            *condensation_s,
            prepare.median_s,
            solve.median_s,
            *output_s,
        ]
    }

    /// All stages.
    fn total(&self) -> f64 {
        self.stages().iter().sum()
    }
}

fn timing_cells(timing: &Timing) -> [String; 5] {
    let Timing {
        median_s,
        min_s,
        low_s,
        high_s,
        samples,
    } = *timing;
    let [median, min, low, high] = [median_s, min_s, low_s, high_s].map(time);
    [median, min, low, high, samples.to_string()]
}

impl Row for TimeRow<'_> {
    const FILE: &'static str = "times.csv";
    const COLUMNS: &'static [&'static str] = &[
        "verdict",
        "setup_s",
        "assembly_s",
        "factorisation_s",
        "condensation_s",
        "prepare_median_s",
        "prepare_min_s",
        "prepare_low_s",
        "prepare_high_s",
        "prepare_samples",
        "solve_median_s",
        "solve_min_s",
        "solve_low_s",
        "solve_high_s",
        "solve_samples",
        "method_median_s",
        "method_low_s",
        "method_high_s",
        "output_s",
        "total_s",
        "peak_mb",
        "machine",
        "profile",
    ];
    const LEADING: &'static [&'static str] = &CELL_COLUMNS;

    fn leading(&self) -> Vec<String> {
        cell_columns(self.record)
    }

    fn cells(&self) -> Vec<String> {
        let Spent { prepare, solve, .. } = self.spent;
        let method = method_time(self.spent);
        let mut cells = Vec::new();
        cells.push(self.record.found.verdict.to_string());
        cells.extend(self.stages()[..4].iter().map(|t| time(*t)));
        cells.extend(timing_cells(prepare));
        cells.extend(timing_cells(solve));
        cells.extend([method.median_s, method.low_s, method.high_s].map(time));
        cells.extend([self.spent.output_s, self.total()].map(time));
        cells.push(significant(self.spent.peak_mb.unwrap_or(f64::NAN), 4));
        cells.push(self.record.origin.machine.clone());
        cells.push(self.record.origin.profile.clone());
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_cells(self.record, other.record)
    }
}
