//! What changed between two sets of records: rows, and a table for the terminal.

use std::cmp::Ordering;

use crate::report::csv::{self, Row};
use crate::report::number::{fixed, significant};
use crate::report::tables::{Align, Column, Table};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::compare::{Change, Comparison, What};

/// One change.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangeRow<'a>(pub &'a Change);

impl Row for ChangeRow<'_> {
    const FILE: &'static str = "compare.csv";
    const COLUMNS: &'static [&'static str] = &["id", "what", "direction", "a", "b", "ratio"];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let Change {
            id,
            what,
            direction,
            a,
            b,
            ratio,
        } = self.0;
        vec![
            id.clone(),
            what.name().to_owned(),
            direction.name().to_owned(),
            a.clone(),
            b.clone(),
            significant(*ratio, 4),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        self.0.id.cmp(&other.0.id)
    }
}

/// All changes for reading. What differs only in its bits is counted in the title.
///
/// # Errors
/// Those of [`Table::push`].
pub fn table(comparison: &Comparison) -> Result<Table, ReportError> {
    let Comparison {
        changes,
        common,
        identical,
        timed,
        drift,
        noise,
    } = comparison;
    let mut title = format!("{common} cells in A and B, {identical} found the same bit by bit");
    if *timed > 0 {
        title += &format!(
            ", {timed} with comparable times: the machine took {} times as long, noise {} %",
            significant(drift.exp(), 3),
            fixed(100.0 * noise.exp_m1(), 1),
        );
    }
    let mut table = Table::new(
        title,
        vec![
            Column::new("cell", "", Align::Left),
            Column::new("what", "", Align::Left),
            Column::new("direction", "", Align::Left),
            Column::new("A", "", Align::Left),
            Column::new("B", "", Align::Left),
            Column::new("ratio", "", Align::Right),
        ],
    );
    for change in changes.iter().filter(|change| change.what != What::Bits) {
        let ratio = match change.ratio.is_finite() {
            true => significant(change.ratio, 3),
            false => "–".into(),
        };
        table.push(vec![
            change.id.clone(),
            change.what.name().to_owned(),
            change.direction.name().to_owned(),
            change.a.clone(),
            change.b.clone(),
            ratio,
        ])?;
    }
    Ok(table)
}

/// `compare.csv`, and the table as `compare.md`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn bundle(comparison: &Comparison) -> Result<Bundle, ReportError> {
    let rows: Vec<ChangeRow> = comparison.changes.iter().map(ChangeRow).collect();
    let mut bundle = Bundle::new();
    bundle.add(ChangeRow::FILE, csv::file(&rows)?)?;
    bundle.add("compare.md", table(comparison)?.markdown())?;
    Ok(bundle)
}
