//! The two tables of the founding paper, our values beside the printed ones.
//!
//! Table 1: vertical reaction at the top of the plate. Table 2: displacement of seven points of the beam. The printed
//! numbers come from the caller (`cases/reference/`); lines with the method [`PRINTED`] carry them.

use super::csv::{self, Row};
use super::number::{fixed, significant, value};
use super::tables::{Align, Column, Table};
use super::{Bundle, ReportError};
use crate::harness::verdict::Verdict;
use std::cmp::Ordering;

/// Method name of lines that repeat the published numbers.
pub const PRINTED: &str = "printed";

/// Decimals of a reaction: the paper prints one, two more are shown.
const REACTION_DECIMALS: usize = 3;

/// Digits of relative differences and of the largest difference.
const DIFFERENCE_DIGITS: usize = 3;

/// What a table shows where a run has no value.
const NO_VALUE: &str = "–";

/// One line of Table 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Table1Row {
    /// Mesh of the paper: `I` or `II`.
    pub mesh: String,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Method label.
    pub method: String,
    /// Computed reaction [MN/m]; none where the method gave no solution.
    pub reaction_mn_per_m: Option<f64>,
    /// Printed reaction [MN/m]; none where the paper has none.
    pub printed_mn_per_m: Option<f64>,
    /// (computed − printed) / printed [-].
    pub relative_difference: Option<f64>,
    /// Claim × check; none where there is no such run.
    pub verdict: Option<Verdict>,
}

impl Table1Row {
    /// A line with its relative difference computed.
    pub fn new(
        mesh: impl Into<String>,
        friction: f64,
        method: impl Into<String>,
        reaction_mn_per_m: Option<f64>,
        printed_mn_per_m: Option<f64>,
        verdict: Option<Verdict>,
    ) -> Self {
        let relative_difference = match (reaction_mn_per_m, printed_mn_per_m) {
            (Some(ours), Some(theirs)) => Some((ours - theirs) / theirs),
            _ => None,
        };
        Self {
            mesh: mesh.into(),
            friction,
            method: method.into(),
            reaction_mn_per_m,
            printed_mn_per_m,
            relative_difference,
            verdict,
        }
    }
}

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

/// One line of Table 2: the displacement component of the seven points.
#[derive(Debug, Clone, PartialEq)]
pub struct Table2Row {
    /// Model of the paper: `I` or `II`.
    pub model: String,
    /// `as-printed` (μ = 0) or `as-stated` (μ = 0.1).
    pub variant: String,
    /// `x`, `y` or `z`.
    pub component: String,
    /// Method label, or [`PRINTED`].
    pub method: String,
    /// Displacement of P1 … P7 (mm); NaN where the method gave no solution.
    pub p_mm: [f64; 7],
    /// Largest |computed − printed| over the seven points (mm); none for the printed line itself.
    pub max_difference_mm: Option<f64>,
    /// Claim × check; none where there is no such run, as for the printed line.
    pub verdict: Option<Verdict>,
}

impl Table2Row {
    /// The line that repeats the published numbers.
    pub fn printed(
        model: impl Into<String>,
        variant: impl Into<String>,
        component: impl Into<String>,
        p_mm: [f64; 7],
    ) -> Self {
        Self {
            model: model.into(),
            variant: variant.into(),
            component: component.into(),
            method: PRINTED.into(),
            p_mm,
            max_difference_mm: None,
            verdict: None,
        }
    }

    /// A computed line to stand below the printed line `reference`.
    pub fn computed(
        reference: &Self,
        method: impl Into<String>,
        p_mm: [f64; 7],
        verdict: Option<Verdict>,
    ) -> Self {
        // `f64::max` would swallow the NaN of a run without a solution.
        let solved = p_mm.iter().all(|p| p.is_finite());
        let difference = || {
            p_mm.iter()
                .zip(reference.p_mm)
                .map(|(ours, theirs)| (ours - theirs).abs())
                .fold(0.0, f64::max)
        };
        Self {
            method: method.into(),
            p_mm,
            max_difference_mm: solved.then(difference),
            verdict,
            ..reference.clone()
        }
    }

    /// Printed numbers were not run here, and nobody expects it.
    fn verdict_cell(&self) -> String {
        if self.method == PRINTED {
            return String::new();
        }
        Verdict::or_not_run(self.verdict.as_ref())
    }
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
        cells.push(self.verdict_cell());
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
        cells.push(row.verdict_cell());
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
    add_readable(bundle, "table1", &table1(rows)?)
}

/// Adds `table2.csv`, `table2.md` and `table2.tex`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_table2(bundle: &mut Bundle, rows: &[Table2Row]) -> Result<(), ReportError> {
    bundle.add(Table2Row::FILE, csv::file(rows)?)?;
    add_readable(bundle, "table2", &table2(rows, Digits::TwoMore)?)
}

/// Adds a table as `<stem>.md` and `<stem>.tex`, its LaTeX label `tab:<stem>`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_readable(bundle: &mut Bundle, stem: &str, table: &Table) -> Result<(), ReportError> {
    bundle.add(format!("{stem}.md"), table.markdown())?;
    bundle.add(format!("{stem}.tex"), table.latex(&format!("tab:{stem}")))
}
