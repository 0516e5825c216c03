//! The main job: the two tables of the founding paper, our values beside the printed ones, and all that stands with them.
//!
//! Table 1: vertical reaction at the top of the plate. Table 2: displacement of seven points of the beam. Lines
//! with the method [`PRINTED`] carry the printed numbers.

pub mod converged_reactions;
pub mod plate_series;

use self::plate_series::{
    add_penalty, add_refinement, limit_table, penalty_table, refinement_table,
};
use super::csv::{self, Row};
use super::number::{fixed, significant, value};
use super::tables::{Align, Column, Table};
use super::{Bundle, Provenance, ReportError, comparison, figures, standard, tables};
use crate::run::verdict::Verdict;
use crate::studies::paper::Paper;
use crate::studies::paper::printed_tables::{PRINTED, Table1Row, Table2Row};
use std::cmp::Ordering;

/// Decimals of a reaction: the paper prints one, two more are shown.
const REACTION_DECIMALS: usize = 3;

/// Digits of relative differences and of the largest difference.
const DIFFERENCE_DIGITS: usize = 3;

/// What a table shows where a run has no value.
const NO_VALUE: &str = "–";

impl Row for Table1Row {
    const FILE: &'static str = "table1.csv";
    const COLUMNS: &'static [&'static str] = &[
        "mesh",
        "friction",
        "method",
        "reaction_mn_per_m",
        "printed_mn_per_m",
        "relative_difference",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.mesh.clone(),
            value(self.friction),
            self.method.clone(),
            optional(self.reaction_mn_per_m, value),
            optional(self.printed_mn_per_m, value),
            optional(self.relative_difference, |d| {
                significant(d, DIFFERENCE_DIGITS)
            }),
            Verdict::or_not_run(self.verdict.as_ref()),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        self.mesh
            .cmp(&other.mesh)
            .then(self.friction.total_cmp(&other.friction))
            .then_with(|| compare_methods(&self.method, &other.method))
    }
}

/// Printed numbers were not run here, and nobody expects it.
fn verdict_cell(row: &Table2Row) -> String {
    if row.method == PRINTED {
        return String::new();
    }
    Verdict::or_not_run(row.verdict.as_ref())
}

impl Row for Table2Row {
    const FILE: &'static str = "table2.csv";
    const COLUMNS: &'static [&'static str] = &[
        "model",
        "variant",
        "component",
        "method",
        "p1_mm",
        "p2_mm",
        "p3_mm",
        "p4_mm",
        "p5_mm",
        "p6_mm",
        "p7_mm",
        "max_difference_mm",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![
            self.model.clone(),
            self.variant.clone(),
            self.component.clone(),
            self.method.clone(),
        ];
        cells.extend(self.p_mm.map(value));
        cells.push(optional(self.max_difference_mm, |d| {
            significant(d, DIFFERENCE_DIGITS)
        }));
        cells.push(verdict_cell(self));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        (&self.model, &self.variant, &self.component)
            .cmp(&(&other.model, &other.variant, &other.component))
            .then_with(|| compare_methods(&self.method, &other.method))
    }
}

/// The printed line comes before the computed ones.
fn compare_methods(a: &str, b: &str) -> Ordering {
    (a != PRINTED, a).cmp(&(b != PRINTED, b))
}

fn optional(number: Option<f64>, text: impl Fn(f64) -> String) -> String {
    number.map(text).unwrap_or_default()
}

fn shown(number: Option<f64>, text: impl Fn(f64) -> String) -> String {
    match number {
        Some(number) if number.is_finite() => text(number),
        _ => NO_VALUE.into(),
    }
}

/// A difference with two digits.
fn short(difference: f64) -> String {
    if difference == 0.0 {
        "0".into()
    } else {
        format!("{difference:.1e}")
    }
}

/// Table 1 for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn table1(rows: &[Table1Row]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Table 1 of the founding paper: vertical reaction at the top of the plate",
        vec![
            Column::new("mesh", "", Align::Left),
            Column::new("friction", "", Align::Decimal),
            Column::new("method", "", Align::Left),
            Column::new("reaction", "MN/m", Align::Decimal),
            Column::new("printed", "MN/m", Align::Decimal),
            Column::new("rel. difference", "", Align::Right),
            Column::new("verdict", "", Align::Left),
        ],
    );
    for row in sorted(rows) {
        table.push(vec![
            row.mesh.clone(),
            value(row.friction),
            row.method.clone(),
            shown(row.reaction_mn_per_m, |r| fixed(r, REACTION_DECIMALS)),
            shown(row.printed_mn_per_m, |r| fixed(r, REACTION_DECIMALS - 2)),
            shown(row.relative_difference, short),
            Verdict::or_not_run(row.verdict.as_ref()),
        ])?;
    }
    Ok(table)
}

/// Digits of a displacement in Table 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// As many decimals as the paper: for a terminal.
    Printed,
    /// Two more: for files.
    TwoMore,
}

/// Table 2 for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn table2(rows: &[Table2Row], digits: Digits) -> Result<Table, ReportError> {
    let mut columns = vec![
        Column::new("model", "", Align::Left),
        Column::new("variant", "", Align::Left),
        Column::new("comp.", "", Align::Left),
        Column::new("method", "", Align::Left),
    ];
    columns.extend((1..=7).map(|p| Column::new(format!("P{p}"), "", Align::Decimal)));
    columns.push(Column::new("max. diff.", "", Align::Right));
    columns.push(Column::new("verdict", "", Align::Left));
    let mut table = Table::new(
        "Table 2 of the founding paper: displacement of the points P1 to P7 of the beam [mm]",
        columns,
    );
    for row in sorted(rows) {
        // The paper prints seven decimals for the small y components, six for the others.
        let printed = if row.component == "y" { 7 } else { 6 };
        let decimals = match digits {
            Digits::TwoMore if row.method != PRINTED => printed + 2,
            _ => printed,
        };
        let mut cells = vec![
            row.model.clone(),
            row.variant.clone(),
            row.component.clone(),
            row.method.clone(),
        ];
        cells.extend(row.p_mm.map(|p| shown(Some(p), |p| fixed(p, decimals))));
        cells.push(shown(row.max_difference_mm, short));
        cells.push(verdict_cell(row));
        table.push(cells)?;
    }
    Ok(table)
}

fn sorted<R: Row>(rows: &[R]) -> Vec<&R> {
    let mut sorted: Vec<&R> = rows.iter().collect();
    sorted.sort_by(|a, b| a.order(b));
    sorted
}

/// Adds `table1.csv`, `table1.md` and `table1.tex`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_table1(bundle: &mut Bundle, rows: &[Table1Row]) -> Result<(), ReportError> {
    bundle.add(Table1Row::FILE, csv::file(rows)?)?;
    tables::add_readable(bundle, "table1", &table1(rows)?)?;
    figures::table1::add(bundle, rows)
}

/// Adds `table2.csv`, `table2.md` and `table2.tex`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_table2(bundle: &mut Bundle, rows: &[Table2Row]) -> Result<(), ReportError> {
    bundle.add(Table2Row::FILE, csv::file(rows)?)?;
    tables::add_readable(bundle, "table2", &table2(rows, Digits::TwoMore)?)
}

/// All files of the report of the main job.
///
/// # Errors
/// Those of the parts.
pub fn bundle(paper: &Paper, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = standard::bundle(&paper.results, provenance)?;
    add_table1(&mut bundle, &paper.table1)?;
    add_table2(&mut bundle, &paper.table2)?;
    add_penalty(&mut bundle, &paper.penalty)?;
    add_refinement(&mut bundle, &paper.refinement, &paper.limits)?;
    converged_reactions::add(
        &mut bundle,
        &paper.converged_meshes,
        &paper.converged,
        &paper.refinement,
    )?;
    comparison::add(&mut bundle, &paper.results.runs, &paper.variants)?;
    Ok(bundle)
}

/// What the terminal shows of the main job.
///
/// # Errors
/// Those of the tables.
pub fn text(paper: &Paper) -> Result<String, ReportError> {
    let mut text = String::new();
    for table in [
        table1(&paper.table1)?,
        table2(&paper.table2, Digits::Printed)?,
        penalty_table(&paper.penalty)?,
        refinement_table(&paper.refinement)?,
        limit_table(&paper.limits)?,
        converged_reactions::converged_table(&paper.converged)?,
        comparison::variant_table(&paper.variants)?,
        standard::expectation_summary(&paper.results.expectations)?,
    ] {
        text.push_str(&table.terminal());
        text.push('\n');
    }
    text.push_str(&format!(
        "{}\n\nModel I with exact sub-cells against Model II: {:.1e} mm\n{}\n",
        converged_reactions::summary(&paper.converged),
        paper.beam_models_mm,
        standard::summary(&paper.results)
    ));
    Ok(text)
}
