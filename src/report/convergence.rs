//! The convergence study: errors of every mesh, observed beside theoretical orders, errors against unknowns and time.

use std::cmp::Ordering;

use super::csv::{self, Row};
use super::number::{fixed, significant, time, value};
use super::tables::{self, Align, Column, Table};
use super::{Bundle, Provenance, ReportError, figures};
use crate::studies::convergence::Variant;
use crate::studies::convergence::orders::{ErrorRow, Kind, OrderRow, ROUND_OFF};

/// Significant digits of errors: they are no better than the order of the method.
const ERROR_DIGITS: usize = 4;

/// Columns of a sequence of meshes.
const VARIANT_COLUMNS: [&str; 5] = ["case", "space", "tip", "method", "friction"];

fn variant_cells(variant: &Variant) -> Vec<String> {
    let Variant {
        case,
        space,
        tip,
        method,
        friction,
    } = variant;
    vec![
        case.clone(),
        space.clone(),
        tip.clone(),
        method.clone(),
        value(*friction),
    ]
}

fn compare_variants(a: &Variant, b: &Variant) -> Ordering {
    (&a.case, &a.space, &a.tip, &a.method)
        .cmp(&(&b.case, &b.space, &b.tip, &b.method))
        .then(a.friction.total_cmp(&b.friction))
}

impl Row for ErrorRow {
    const FILE: &'static str = "convergence.csv";
    const COLUMNS: &'static [&'static str] = &[
        "mesh",
        "refine",
        "h_m",
        "dofs",
        "points",
        "verdict",
        "quantity",
        "at",
        "found",
        "reference",
        "error_bar",
        "error",
        "kind",
        "order",
        "total_s",
        "setup_s",
        "assembly_s",
        "factorisation_s",
        "condensation_s",
        "prepare_s",
        "solve_s",
    ];
    const LEADING: &'static [&'static str] = &VARIANT_COLUMNS;

    fn leading(&self) -> Vec<String> {
        variant_cells(&self.variant)
    }

    fn cells(&self) -> Vec<String> {
        let ErrorRow {
            variant: _,
            mesh,
            refine,
            h,
            dofs,
            points,
            verdict,
            quantity,
            at,
            found,
            reference,
            error_bar,
            error,
            kind,
            order,
            seconds,
        } = self;
        let mut cells = vec![
            mesh.clone(),
            refine.to_string(),
            value(*h),
            dofs.to_string(),
            points.to_string(),
            verdict.to_string(),
            quantity.clone(),
            at.clone(),
            value(*found),
            value(*reference),
            significant(*error_bar, ERROR_DIGITS),
            significant(above_round_off(*error), ERROR_DIGITS),
            kind.map_or("", Kind::name).to_owned(),
            significant(*order, ERROR_DIGITS),
            time(seconds.total()),
        ];
        cells.extend(seconds.split().map(time));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_variants(&self.variant, &other.variant)
            .then(self.refine.cmp(&other.refine))
            .then_with(|| (&self.quantity, &self.at).cmp(&(&other.quantity, &other.at)))
    }
}

impl Row for OrderRow {
    const FILE: &'static str = "orders.csv";
    const COLUMNS: &'static [&'static str] = &[
        "quantity",
        "at",
        "kind",
        "meshes",
        "finest_h_m",
        "reference",
        "error_bar",
        "error",
        "order",
        "theoretical_order",
    ];
    const LEADING: &'static [&'static str] = &VARIANT_COLUMNS;

    fn leading(&self) -> Vec<String> {
        variant_cells(&self.variant)
    }

    fn cells(&self) -> Vec<String> {
        let OrderRow {
            variant: _,
            quantity,
            at,
            kind,
            meshes,
            finest_h,
            reference,
            error_bar,
            error,
            order,
            theory,
            dim: _,
        } = self;
        vec![
            quantity.clone(),
            at.clone(),
            kind.name().to_owned(),
            meshes.to_string(),
            value(*finest_h),
            value(*reference),
            significant(*error_bar, ERROR_DIGITS),
            significant(above_round_off(*error), ERROR_DIGITS),
            significant(*order, ERROR_DIGITS),
            value(theory.unwrap_or(f64::NAN)),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        compare_variants(&self.variant, &other.variant)
            .then_with(|| (&self.quantity, &self.at).cmp(&(&other.quantity, &other.at)))
    }
}

/// A number for reading; a dash where there is none.
fn shown(x: f64, text: impl Fn(f64) -> String) -> String {
    if x.is_finite() { text(x) } else { "–".into() }
}

/// An error with three digits.
fn scientific(error: f64) -> String {
    if error == 0.0 {
        "0".into()
    } else {
        format!("{error:.2e}")
    }
}

/// An error without round-off, which would differ between machines.
fn above_round_off(error: f64) -> f64 {
    if error < ROUND_OFF { 0.0 } else { error }
}

/// A quantity with its place.
fn place(quantity: &str, at: &str) -> String {
    format!("{quantity} {at}").trim().to_owned()
}

/// What the kinds of reference in a table mean.
fn footnote(kinds: impl Iterator<Item = Kind>) -> String {
    let mut kinds: Vec<&str> = kinds.map(Kind::name).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let meaning = |kind: &&str| match *kind {
        "exact" => "exact: closed form",
        "richardson" => {
            "richardson: limit extrapolated from the three finest meshes, whose errors are correlated with it"
        }
        _ => "finest: no power law, distance from the finest mesh",
    };
    kinds.iter().map(meaning).collect::<Vec<_>>().join("; ")
}

/// Every mesh for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn error_table(rows: &[ErrorRow]) -> Result<Table, ReportError> {
    let note = footnote(rows.iter().filter_map(|row| row.kind));
    let mut table = Table::new(
        format!("Errors under refinement ({note})"),
        vec![
            Column::new("case", "", Align::Left),
            Column::new("space", "", Align::Left),
            Column::new("tip", "", Align::Left),
            Column::new("μ", "", Align::Decimal),
            Column::new("quantity", "", Align::Left),
            Column::new("h", "m", Align::Decimal),
            Column::new("unknowns", "", Align::Right),
            Column::new("points", "", Align::Right),
            Column::new("verdict", "", Align::Left),
            Column::new("error", "", Align::Right),
            Column::new("order", "", Align::Decimal),
            Column::new("reference", "", Align::Left),
            Column::new("time", "s", Align::Right),
        ],
    );
    let mut sorted: Vec<&ErrorRow> = rows.iter().collect();
    sorted.sort_by(|a, b| {
        compare_variants(&a.variant, &b.variant)
            .then_with(|| (&a.quantity, &a.at).cmp(&(&b.quantity, &b.at)))
            .then(a.refine.cmp(&b.refine))
    });
    for row in sorted {
        table.push(vec![
            row.variant.case.clone(),
            row.variant.space.clone(),
            row.variant.tip.clone(),
            value(row.variant.friction),
            place(&row.quantity, &row.at),
            significant(row.h, 4),
            row.dofs.to_string(),
            row.points.to_string(),
            row.verdict.to_string(),
            shown(above_round_off(row.error), scientific),
            shown(row.order, |p| fixed(p, 2)),
            row.kind.map_or("–", Kind::name).into(),
            shown(row.seconds.total(), |s| significant(s, 2)),
        ])?;
    }
    Ok(table)
}

/// Observed beside theoretical orders for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn order_table(rows: &[OrderRow]) -> Result<Table, ReportError> {
    let note = footnote(rows.iter().map(|row| row.kind));
    let mut table = Table::new(
        format!("Orders of convergence over the last two halvings ({note})"),
        vec![
            Column::new("case", "", Align::Left),
            Column::new("space", "", Align::Left),
            Column::new("tip", "", Align::Left),
            Column::new("μ", "", Align::Decimal),
            Column::new("quantity", "", Align::Left),
            Column::new("reference", "", Align::Left),
            Column::new("value", "", Align::Right),
            Column::new("error bar", "", Align::Right),
            Column::new("finest error", "", Align::Right),
            Column::new("order", "", Align::Decimal),
            Column::new("theory", "", Align::Decimal),
        ],
    );
    let mut sorted: Vec<&OrderRow> = rows.iter().collect();
    sorted.sort_by(|a, b| Row::order(*a, *b));
    for row in sorted {
        table.push(vec![
            row.variant.case.clone(),
            row.variant.space.clone(),
            row.variant.tip.clone(),
            value(row.variant.friction),
            place(&row.quantity, &row.at),
            row.kind.name().into(),
            significant(row.reference, 7),
            shown(row.error_bar, |e| significant(e, 2)),
            shown(above_round_off(row.error), scientific),
            shown(row.order, |p| fixed(p, 2)),
            row.theory.map_or_else(|| "–".into(), |p| fixed(p, 1)),
        ])?;
    }
    Ok(table)
}

/// Files of the study: `convergence.*`, `orders.*`, figures, provenance.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figures.
pub fn bundle(
    errors: &[ErrorRow],
    orders: &[OrderRow],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    bundle.add(ErrorRow::FILE, csv::file(errors)?)?;
    bundle.add(OrderRow::FILE, csv::file(orders)?)?;
    tables::add_readable(&mut bundle, "convergence", &error_table(errors)?)?;
    tables::add_readable(&mut bundle, "orders", &order_table(orders)?)?;
    figures::error::add(&mut bundle, errors, orders)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
