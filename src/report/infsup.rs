//! The inf-sup test of the contact spaces: β on every mesh, what becomes of it under refinement.

use std::cmp::Ordering;

use super::csv::{self, Row};
use super::number::{fixed, significant, value};
use super::tables::{self, Align, Column, Table};
use super::{Bundle, ReportError, figures};
use crate::studies::spaces::infsup::{LARGEST_SLOPE, LEAST_SHARE, Sample, Sequence};

/// Significant digits of β: some of its square is rounding.
const BETA_DIGITS: usize = 4;

/// One contact space on one mesh of one body.
#[derive(Debug, Clone)]
pub struct InfSupRow {
    /// How the crack lies in the grid.
    pub crack: &'static str,
    /// Space dimension.
    pub dimension: usize,
    /// Contact space.
    pub space: &'static str,
    /// The mesh and its β.
    pub sample: Sample,
    /// Slope of the sequence the mesh belongs to.
    pub slope: f64,
    /// Least share of that sequence.
    pub share: f64,
    /// Whether the space passes on that sequence.
    pub stable: bool,
}

fn verdict(stable: bool) -> &'static str {
    if stable { "stable" } else { "not stable" }
}

/// A row per mesh.
pub fn rows(sequences: &[Sequence]) -> Vec<InfSupRow> {
    let of = |s: &Sequence, sample: &Sample| InfSupRow {
        crack: s.scene.name,
        dimension: s.scene.dim,
        space: s.space.name(),
        sample: *sample,
        slope: s.slope,
        share: s.share,
        stable: s.is_stable(),
    };
    let mut all = Vec::new();
    for s in sequences {
        all.extend(s.samples.iter().map(|sample| of(s, sample)));
    }
    all
}

impl Row for InfSupRow {
    const FILE: &'static str = "infsup.csv";
    const COLUMNS: &'static [&'static str] = &[
        "dimension",
        "crack",
        "space",
        "cells",
        "h_m",
        "dofs",
        "points",
        "beta",
        "kernel",
        "slope",
        "share",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let InfSupRow {
            crack,
            dimension,
            space,
            sample,
            slope,
            share,
            stable,
        } = self;
        let Sample {
            cells,
            h,
            unknowns,
            points,
            beta,
            kernel,
        } = sample;
        vec![
            dimension.to_string(),
            (*crack).to_owned(),
            (*space).to_owned(),
            cells.to_string(),
            value(*h),
            unknowns.to_string(),
            points.to_string(),
            significant(*beta, BETA_DIGITS),
            kernel.to_string(),
            significant(*slope, BETA_DIGITS),
            significant(*share, BETA_DIGITS),
            verdict(*stable).to_owned(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        (self.dimension, self.crack, self.space, self.sample.cells).cmp(&(
            other.dimension,
            other.crack,
            other.space,
            other.sample.cells,
        ))
    }
}

/// Every sequence for reading, a column of β per mesh, coarse to fine.
///
/// # Errors
/// Those of [`Table::push`].
pub fn table(sequences: &[Sequence]) -> Result<Table, ReportError> {
    let most = sequences.iter().map(|s| s.samples.len()).max().unwrap_or(0);
    // Cells per axis in 2D and 3D.
    let mesh = |k: usize| {
        let counts = [2, 3].map(|dim| {
            let first = sequences.iter().find(|s| s.scene.dim == dim);
            let sample = first.and_then(|s| s.samples.get(k));
            sample.map_or_else(|| "–".into(), |p| p.cells.to_string())
        });
        format!("β ({})", counts.join(", "))
    };
    let title = format!(
        "Inf-sup numbers of the contact spaces (in brackets: cells per axis in 2D and in 3D; slope: d log β / d log h, above \
         {LARGEST_SLOPE} not stable; share: least β over that of star on a crack along the grid, below {LEAST_SHARE} not \
         stable; kernel: tractions without any effect, largest number)"
    );
    let mut columns = vec![
        Column::new("crack", "", Align::Left),
        Column::new("space", "", Align::Left),
    ];
    columns.extend((0..most).map(|k| Column::new(mesh(k), "", Align::Right)));
    columns.extend([
        Column::new("kernel", "", Align::Right),
        Column::new("slope", "", Align::Decimal),
        Column::new("share", "", Align::Right),
        Column::new("verdict", "", Align::Left),
    ]);
    let mut table = Table::new(title, columns);
    let number = |x: f64, digits: usize| {
        if x.is_finite() {
            significant(x, digits)
        } else {
            "–".into()
        }
    };
    for s in sequences {
        let mut cells = vec![s.scene.name.to_owned(), s.space.name().to_owned()];
        let beta = |k: usize| s.samples.get(k).map_or(f64::NAN, |p| p.beta);
        cells.extend((0..most).map(|k| number(beta(k), 3)));
        let kernel = s.samples.iter().map(|p| p.kernel).max().unwrap_or(0);
        let slope = if s.slope.is_finite() {
            fixed(s.slope, 2)
        } else {
            "–".into()
        };
        cells.extend([
            kernel.to_string(),
            slope,
            number(s.share, 2),
            verdict(s.is_stable()).to_owned(),
        ]);
        table.push(cells)?;
    }
    Ok(table)
}

/// Adds `infsup.csv`, `infsup.md`, `infsup.tex` and `figures/infsup.svg`.
///
/// # Errors
/// Those of [`Bundle::add`], of the table and the figure.
pub fn add_to(bundle: &mut Bundle, sequences: &[Sequence]) -> Result<(), ReportError> {
    bundle.add(InfSupRow::FILE, csv::file(&rows(sequences))?)?;
    tables::add_readable(bundle, "infsup", &table(sequences)?)?;
    figures::infsup::add(bundle, sequences)
}
