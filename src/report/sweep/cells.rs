//! What was found: one row per cell, increment and quantity. No times.

use std::cmp::Ordering;

use super::records::{CELL_COLUMNS, SweepRecords, cell_columns, compare_cells};
use crate::model::errors::Deviation;
use crate::report::csv::{self, Row};
use crate::report::number::{residual, significant, value};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::accuracy::sequences;
use crate::studies::sweep::cell::Problem;
use crate::studies::sweep::record::{IncrementFound, Record};

/// Significant digits of discretisation errors.
const ERROR_DIGITS: usize = 4;

/// Kind of a quantity beside its closed form.
const EXACT: &str = "exact";

/// Adds `cells.csv`, `increments.csv` and `deviations.csv`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let records = sweep.sorted();
    let cells: Vec<CellRow> = records.iter().map(|record| CellRow(record)).collect();
    bundle.add(CellRow::FILE, csv::file(&cells)?)?;
    let increments = records.iter().flat_map(|record| {
        let all = record.found.increments.iter().enumerate();
        all.map(|(index, found)| IncrementRow {
            record,
            number: index + 1,
            found,
        })
    });
    let increments: Vec<IncrementRow> = increments.collect();
    bundle.add(IncrementRow::FILE, csv::file(&increments)?)?;
    // A quantity without exact value says something only beside that of another mesh.
    let refined: Vec<Problem> = sequences(sweep.records).into_iter().flatten().collect();
    let deviations = records.iter().flat_map(|record| {
        let several = refined.contains(&record.cell.problem());
        let rows = DeviationRow::all(record).into_iter();
        rows.filter(move |row| several || row.kind == EXACT)
    });
    let deviations: Vec<DeviationRow> = deviations.collect();
    Ok(bundle.add(DeviationRow::FILE, csv::file(&deviations)?)?)
}

fn optional(number: Option<f64>, text: impl Fn(f64) -> String) -> String {
    text(number.unwrap_or(f64::NAN))
}

fn counters(of: impl Fn(fn(&IncrementFound) -> usize) -> usize) -> Vec<String> {
    let all: [fn(&IncrementFound) -> usize; 7] = [
        |i| i.iterations,
        |i| i.solves,
        |i| i.tangent_factorisations,
        |i| i.global_factorisations,
        |i| i.local_solves,
        |i| i.state_changes,
        |i| i.final_changes,
    ];
    all.into_iter().map(|c| of(c).to_string()).collect()
}

struct CellRow<'a>(&'a Record);

impl Row for CellRow<'_> {
    const FILE: &'static str = "cells.csv";
    const COLUMNS: &'static [&'static str] = &[
        "digest",
        "exact",
        "verdict",
        "natural_map",
        "error_energy",
        "error_force",
        "error_jump",
        "reference",
        "reference_natural_map",
        "discretisation_error",
        "dim",
        "dofs",
        "points",
        "unknowns",
        "h_m",
        "increments",
        "iterations",
        "solves",
        "tangent_factorisations",
        "global_factorisations",
        "local_solves",
        "state_changes",
        "final_changes",
        "schema",
    ];
    const LEADING: &'static [&'static str] = &CELL_COLUMNS;

    fn leading(&self) -> Vec<String> {
        cell_columns(self.0)
    }

    fn cells(&self) -> Vec<String> {
        let record = self.0;
        let found = &record.found;
        let error = found.solver_error.as_ref();
        let energy = |d: &&Deviation| d.quantity == "energy" && d.at.is_empty();
        let energy = found.deviations.iter().find(energy).map(|d| d.error);
        let natural_map = match found.increments.is_empty() {
            true => f64::NAN,
            false => found.natural_map(),
        };
        let mut cells = Vec::new();
        cells.extend([
            record.cell.digest.clone(),
            found.exact.to_string(),
            found.verdict.to_string(),
            residual(natural_map),
            optional(error.map(|e| e.energy), residual),
            optional(error.map(|e| e.force), residual),
            optional(error.map(|e| e.jump), residual),
            error.map_or_else(String::new, |e| e.reference.clone()),
            optional(error.map(|e| e.reference_natural_map), residual),
            optional(energy, |e| significant(e, ERROR_DIGITS)),
        ]);
        let size = found.problem.as_ref();
        let counts = [
            size.map(|s| s.dim),
            size.map(|s| s.dofs),
            size.map(|s| s.points),
            size.map(|s| s.unknowns),
        ];
        cells.extend(counts.map(|n| n.map_or_else(|| "NaN".into(), |n| n.to_string())));
        cells.push(optional(size.map(|s| s.h_m), value));
        cells.push(found.increments.len().to_string());
        cells.extend(counters(|counter| found.sum(counter)));
        cells.push(record.schema.to_string());
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_cells(self.0, other.0)
    }
}

struct IncrementRow<'a> {
    record: &'a Record,
    number: usize,
    found: &'a IncrementFound,
}

impl Row for IncrementRow<'_> {
    const FILE: &'static str = "increments.csv";
    const COLUMNS: &'static [&'static str] = &[
        "increment",
        "verdict",
        "natural_map",
        "iterations",
        "solves",
        "tangent_factorisations",
        "global_factorisations",
        "local_solves",
        "state_changes",
        "final_changes",
    ];
    const LEADING: &'static [&'static str] = &CELL_COLUMNS;

    fn leading(&self) -> Vec<String> {
        cell_columns(self.record)
    }

    fn cells(&self) -> Vec<String> {
        let mut cells = Vec::new();
        cells.extend([
            self.number.to_string(),
            self.found.verdict.to_string(),
            optional(self.found.natural_map, residual),
        ]);
        cells.extend(counters(|counter| counter(self.found)));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_cells(self.record, other.record).then(self.number.cmp(&other.number))
    }
}

struct DeviationRow<'a> {
    record: &'a Record,
    kind: &'static str,
    quantity: &'a str,
    at: &'a str,
    found: f64,
    reference: f64,
    error: f64,
    norm: f64,
}

impl<'a> DeviationRow<'a> {
    fn all(record: &'a Record) -> Vec<Self> {
        let deviations = record.found.deviations.iter().map(|d| Self {
            record,
            kind: EXACT,
            quantity: &d.quantity,
            at: &d.at,
            found: d.found,
            reference: d.exact,
            error: d.error,
            norm: f64::NAN,
        });
        let values = record.found.values.iter().map(|v| Self {
            record,
            kind: "followed",
            quantity: &v.quantity,
            at: &v.at,
            found: v.value,
            reference: f64::NAN,
            error: f64::NAN,
            norm: v.norm,
        });
        deviations.chain(values).collect()
    }
}

impl Row for DeviationRow<'_> {
    const FILE: &'static str = "deviations.csv";
    const COLUMNS: &'static [&'static str] = &[
        "kind",
        "quantity",
        "at",
        "found",
        "reference",
        "error",
        "norm",
    ];
    const LEADING: &'static [&'static str] = &CELL_COLUMNS;

    fn leading(&self) -> Vec<String> {
        cell_columns(self.record)
    }

    fn cells(&self) -> Vec<String> {
        let mut cells = Vec::new();
        cells.extend([
            self.kind.into(),
            self.quantity.into(),
            self.at.into(),
            value(self.found),
            value(self.reference),
            significant(self.error, ERROR_DIGITS),
            value(self.norm),
        ]);
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_cells(self.record, other.record)
            .then_with(|| (self.quantity, self.at).cmp(&(other.quantity, other.at)))
    }
}
