//! Time to accuracy: the error of the discretisation beside what it takes to have the answer, mesh by mesh.

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::value;
use crate::report::{Bundle, ReportError};
use crate::studies::convergence::Variant;
use crate::studies::convergence::orders::ErrorRow;
use crate::studies::sweep::analysis::accuracy::refinements;

/// Adds `time_to_accuracy.csv`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let all = refinements(sweep.records);
    let errors = all.iter().flat_map(|one| &one.errors);
    let rows: Vec<AccuracyRow> = errors.map(AccuracyRow).collect();
    Ok(bundle.add(AccuracyRow::FILE, csv::file(&rows)?)?)
}

/// A row of `convergence.csv` without the enrichment of the tips, which the records do not know.
struct AccuracyRow<'a>(&'a ErrorRow);

impl Row for AccuracyRow<'_> {
    const FILE: &'static str = "time_to_accuracy.csv";
    const LEADING: &'static [&'static str] = &["case", "space", "method", "friction"];
    const COLUMNS: &'static [&'static str] = ErrorRow::COLUMNS;

    fn leading(&self) -> Vec<String> {
        let Variant {
            case,
            space,
            tip: _,
            method,
            friction,
        } = &self.0.variant;
        vec![
            case.clone(),
            space.clone(),
            method.clone(),
            value(*friction),
        ]
    }

    fn cells(&self) -> Vec<String> {
        self.0.cells()
    }

    fn order(&self, other: &Self) -> std::cmp::Ordering {
        Row::order(self.0, other.0)
    }
}
