//! How often methods claim success, how often they are right, and how they fail.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::{fixed, significant};
use crate::report::tables::add_readable;
use crate::report::tables::{Align, Column, Table};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::compare_methods;
use crate::studies::sweep::analysis::success::{FAILURES, SuccessRow, success};

/// Adds `success.csv`, `.md` and `.tex`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let rows = success(sweep.records);
    bundle.add(SuccessRow::FILE, csv::file(&rows)?)?;
    add_readable(bundle, "success", &table(&rows, &sweep.caveat())?)
}

impl Row for SuccessRow {
    const FILE: &'static str = "success.csv";
    const COLUMNS: &'static [&'static str] = &[
        "method",
        "exact",
        "defaults",
        "tier",
        "cells",
        "claimed",
        "success_rate",
        "success_low",
        "success_high",
        "correct",
        "correct_rate",
        "correct_low",
        "correct_high",
        FAILURES[0],
        FAILURES[1],
        FAILURES[2],
        FAILURES[3],
        FAILURES[4],
        FAILURES[5],
        FAILURES[6],
        FAILURES[7],
        FAILURES[8],
        FAILURES[9],
        FAILURES[10],
        FAILURES[11],
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![
            self.method.clone(),
            self.exact.to_string(),
            self.defaults.to_string(),
            self.tier.to_string(),
            self.cells.to_string(),
            self.claimed.to_string(),
        ];
        cells.extend(self.success().map(|x| significant(x, 4)));
        cells.push(self.correct.to_string());
        cells.extend(self.correctness().map(|x| significant(x, 4)));
        cells.extend(self.failures.iter().map(usize::to_string));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        let tolerance = |row: &Self| row.tier.tolerance();
        compare_methods(&self.method, &other.method)
            .then(tolerance(other).total_cmp(&tolerance(self)))
    }
}

/// One line per method with default options.
fn table(rows: &[SuccessRow], caveat: &str) -> Result<Table, ReportError> {
    let mut columns = vec![
        Column::new("method", "", Align::Left),
        Column::new("problems", "", Align::Right),
    ];
    for rate in ["success", "correct"] {
        let tiers = Tier::ALL.into_iter();
        columns.extend(tiers.map(|tier| Column::new(format!("{rate}, {tier}"), "%", Align::Left)));
    }
    columns.push(Column::new("failures at all tiers", "", Align::Left));
    let title = format!(
        "Success, what a method claims, and correctness, what the judge confirms, by tier, with 95 % intervals{caveat}"
    );
    let mut table = Table::new(title, columns);
    let defaults: Vec<&SuccessRow> = rows.iter().filter(|row| row.defaults).collect();
    for own in defaults.chunk_by(|a, b| a.method == b.method) {
        let at = |tier: Tier| own.iter().find(|row| row.tier == tier);
        let most = own.iter().map(|row| row.cells).max().unwrap_or(0);
        let mut cells = vec![own[0].method.clone(), most.to_string()];
        let success = Tier::ALL.map(|tier| at(tier).map(|row| row.success()));
        let correct = Tier::ALL.map(|tier| at(tier).map(|row| row.correctness()));
        cells.extend(success.map(|rate| rate.map_or("–".into(), |[rate, ..]| percent(rate))));
        cells.extend(correct.map(|rate| rate.map_or("–".into(), with_interval)));
        let count = |k: usize| own.iter().map(|row| row.failures[k]).sum::<usize>();
        let failures = FAILURES.iter().enumerate();
        let failures = failures.filter(|(k, _)| count(*k) > 0);
        let failures = failures.map(|(k, name)| format!("{} {}", count(k), name.replace('_', " ")));
        let failures: Vec<String> = failures.collect();
        cells.push(failures.join(", "));
        table.push(cells)?;
    }
    Ok(table)
}

/// A rate rounded down, so that only all are 100.
fn percent(rate: f64) -> String {
    let percent = (1e3 * rate + 1e-9).floor() / 10.0;
    fixed(percent, usize::from(percent.fract() != 0.0))
}

fn with_interval([rate, low, high]: [f64; 3]) -> String {
    format!(
        "{} ({} to {})",
        percent(rate),
        fixed(100.0 * low, 0),
        fixed(100.0 * high, 0)
    )
}
