//! Method against method: every case times every method, and the paper's two problems by every method and variant.

use std::cmp::Ordering;

use super::csv::{self, Row};
use super::number::{residual, significant, time, value};
use super::tables::{Align, Column, Table};
use super::{Bundle, ReportError, figures, tables};
use crate::run::record::RunRow;
use crate::run::verdict::Verdict;
use crate::studies::paper::comparison::{ComparisonRow, comparison};
use crate::studies::paper::variants::VariantRow;

impl Row for ComparisonRow {
    const FILE: &'static str = "comparison.csv";
    const COLUMNS: &'static [&'static str] = &[
        "case",
        "method",
        "increments",
        "verdict",
        "natural_map",
        "iterations",
        "tangent_factorisations",
        "local_solves",
        "solve_s",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.case.clone(),
            self.method.clone(),
            self.increments.to_string(),
            self.verdict.to_string(),
            residual(self.natural_map),
            self.iterations.to_string(),
            self.tangent_factorisations.to_string(),
            self.local_solves.to_string(),
            time(self.solve_s),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let case = self.case.cmp(&other.case);
        case.then_with(|| self.method.cmp(&other.method))
    }
}

/// The comparison for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn comparison_table(rows: &[ComparisonRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Every case by every method: all meshes, friction coefficients and increments",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("method", "", Align::Left),
            Column::new("increments", "", Align::Right),
            Column::new("verdict, worst", "", Align::Left),
            Column::new("natural map, largest", "", Align::Right),
            Column::new("iterations", "", Align::Right),
            Column::new("dense factorisations", "", Align::Right),
            Column::new("solve", "s", Align::Right),
        ],
    );
    for row in rows {
        table.push(vec![
            row.case.clone(),
            row.method.clone(),
            row.increments.to_string(),
            row.verdict.to_string(),
            residual(row.natural_map),
            row.iterations.to_string(),
            row.tangent_factorisations.to_string(),
            shown_time(row.solve_s),
        ])?;
    }
    Ok(table)
}

fn shown_time(seconds: f64) -> String {
    if seconds.is_nan() {
        "–".into()
    } else {
        time(seconds)
    }
}

impl Row for VariantRow {
    const FILE: &'static str = "variants.csv";
    const COLUMNS: &'static [&'static str] = &[
        "case",
        "friction",
        "method",
        "verdict",
        "quantity",
        "value",
        "deviation",
        "natural_map",
        "iterations",
        "tangent_factorisations",
        "global_factorisations",
        "solve_s",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.case.clone(),
            value(self.friction),
            self.method.clone(),
            Verdict::or_not_run(self.verdict.as_ref()),
            self.quantity.clone(),
            value(self.value),
            residual(self.deviation),
            residual(self.natural_map),
            self.iterations.to_string(),
            self.tangent_factorisations.to_string(),
            self.global_factorisations.to_string(),
            time(self.solve_s),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let case = self.case.cmp(&other.case);
        case.then(self.friction.total_cmp(&other.friction))
            .then_with(|| self.method.cmp(&other.method))
    }
}

/// The variants for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn variant_table(rows: &[VariantRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Plate and beam by every method and variant",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("μ", "", Align::Decimal),
            Column::new("method", "", Align::Left),
            Column::new("verdict", "", Align::Left),
            Column::new("quantity", "", Align::Left),
            Column::new("value", "SI", Align::Right),
            Column::new("deviation", "", Align::Right),
            Column::new("natural map", "", Align::Right),
            Column::new("iterations", "", Align::Right),
            Column::new("dense", "", Align::Right),
            Column::new("sparse", "", Align::Right),
            Column::new("solve", "s", Align::Right),
        ],
    );
    for row in rows {
        let honest = row.verdict.as_ref().is_some_and(Verdict::is_honest);
        table.push(vec![
            row.case.clone(),
            value(row.friction),
            row.method.clone(),
            Verdict::or_not_run(row.verdict.as_ref()),
            row.quantity.clone(),
            significant(row.value, 8),
            residual(row.deviation),
            residual(row.natural_map),
            row.iterations.to_string(),
            row.tangent_factorisations.to_string(),
            row.global_factorisations.to_string(),
            shown_time(if honest { row.solve_s } else { f64::NAN }),
        ])?;
    }
    Ok(table)
}

/// Adds both tables and the figure `cost` to a report.
///
/// # Errors
/// Those of the parts.
pub fn add(
    bundle: &mut Bundle,
    runs: &[RunRow],
    variants: &[VariantRow],
) -> Result<(), ReportError> {
    let rows = comparison(runs);
    bundle.add(ComparisonRow::FILE, csv::file(&rows)?)?;
    tables::add_readable(bundle, "comparison", &comparison_table(&rows)?)?;
    figures::cost::add(bundle, &rows)?;
    bundle.add(VariantRow::FILE, csv::file(variants)?)?;
    tables::add_readable(bundle, "variants", &variant_table(variants)?)
}
