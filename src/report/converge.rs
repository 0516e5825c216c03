//! The convergence study: errors of every mesh, observed beside theoretical orders, errors against unknowns and time.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::csv::{self, Row};
use super::number::{fixed, significant, time, value};
use super::plot::{Curve, CurvePlot, convergence_plot, error_plot};
use super::standard::file_name;
use super::tables::{Align, Column, Table};
use super::{Bundle, Provenance, ReportError, paper};
use crate::harness::converge::Variant;
use crate::harness::converge::orders::{ErrorRow, Kind, OrderRow, ROUND_OFF};

/// Significant digits of errors: they are no better than the order of the method.
const ERROR_DIGITS: usize = 4;

fn variant_cells(variant: &Variant) -> [String; 5] {
    let Variant {
        case,
        space,
        tip,
        method,
        friction,
    } = variant;
    [
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
        "case",
        "space",
        "tip",
        "method",
        "friction",
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
    const KEYED: bool = false;

    fn cells(&self) -> Vec<String> {
        let ErrorRow {
            variant,
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
        let mut cells = variant_cells(variant).to_vec();
        cells.extend([
            mesh.clone(),
            refine.to_string(),
            value(*h),
            dofs.to_string(),
            points.to_string(),
            verdict.clone(),
            quantity.clone(),
            at.clone(),
            value(*found),
            value(*reference),
            significant(*error_bar, ERROR_DIGITS),
            significant(above_round_off(*error), ERROR_DIGITS),
            kind.map_or("", Kind::name).to_owned(),
            significant(*order, ERROR_DIGITS),
            time(seconds.total()),
        ]);
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
        "case",
        "space",
        "tip",
        "method",
        "friction",
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
    const KEYED: bool = false;

    fn cells(&self) -> Vec<String> {
        let OrderRow {
            variant,
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
        let mut cells = variant_cells(variant).to_vec();
        cells.extend([
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
        ]);
        cells
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
            row.verdict.clone(),
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

/// What a figure shows: one case, method, friction coefficient and quantity.
type Figure = (String, String, String, String, String);

/// `figures/<case>.<method>.mu-<friction>.<quantity>.error.svg` and `….error-time.svg`.
fn add_figures(
    bundle: &mut Bundle,
    errors: &[ErrorRow],
    orders: &[OrderRow],
) -> Result<(), ReportError> {
    let mut figures: BTreeMap<Figure, Vec<&OrderRow>> = BTreeMap::new();
    for row in orders {
        let variant = &row.variant;
        let figure = (
            variant.case.clone(),
            variant.method.clone(),
            value(variant.friction),
            row.quantity.clone(),
            row.at.clone(),
        );
        figures.entry(figure).or_default().push(row);
    }
    for ((case, method, friction, quantity, at), mut sequences) in figures {
        sequences.sort_by(|a, b| Row::order(*a, *b));
        let curve = |order: &OrderRow, x: fn(&ErrorRow) -> f64, label: String| {
            let own = errors.iter().filter(|row| {
                row.variant == order.variant && (&row.quantity, &row.at) == (&quantity, &at)
            });
            let mut own: Vec<&ErrorRow> =
                own.filter(|row| above_round_off(row.error) > 0.0).collect();
            own.sort_by_key(|row| row.refine);
            Curve {
                label,
                points: own.iter().map(|row| [x(row), row.error]).collect(),
            }
        };
        let name = |row: &OrderRow| match row.variant.tip.as_str() {
            "no-tips" => row.variant.space.clone(),
            tip => format!("{}, tips {tip}", row.variant.space),
        };
        let labelled = |row: &&OrderRow| match (row.order.is_finite(), row.theory) {
            (true, Some(theory)) => {
                format!("{}: {} ({})", name(row), fixed(row.order, 2), value(theory))
            }
            (true, None) => format!("{}: {}", name(row), fixed(row.order, 2)),
            (false, _) if row.kind == Kind::Finest => format!("{}: no power law", name(row)),
            (false, _) => name(row),
        };
        let theories: Vec<Option<f64>> = sequences.iter().map(|row| row.theory).collect();
        let known = theories.iter().flatten().next().is_some();
        let what = place(&quantity, &at);
        let note = if known {
            "orders in h over the last two halvings, in brackets and dotted the theoretical ones"
        } else {
            "orders in h over the last two halvings; triangle: order 1"
        };
        // A figure belongs to one case.
        let dim = sequences.iter().map(|row| row.dim).max().unwrap_or(2);
        let common = format!("{case}, {method}, μ = {friction}");
        let y_label = if sequences.iter().all(|row| row.kind == Kind::Exact) {
            format!("error: {what}")
        } else {
            format!("relative error: {what}")
        };
        let size = CurvePlot {
            caption: format!("{common}; {note}"),
            x_label: format!("unknowns N ∝ {}", if dim == 2 { "h⁻²" } else { "h⁻³" }),
            y_label: y_label.clone(),
            curves: sequences
                .iter()
                .map(|row| curve(row, |r| r.dofs as f64, labelled(row)))
                .collect(),
        };
        let spent = CurvePlot {
            caption: common,
            x_label: "total time [s]".into(),
            y_label,
            curves: sequences
                .iter()
                .map(|row| curve(row, |r| r.seconds.total(), name(row)))
                .collect(),
        };
        let drawable = |plot: &CurvePlot| {
            let points = plot.curves.iter().flat_map(|curve| &curve.points);
            points
                .into_iter()
                .any(|p| p.iter().all(|c| c.is_finite() && *c > 0.0))
        };
        let stem = file_name(&[&case, &method, &format!("mu-{friction}"), &what]);
        // Errors that are all zero have no place on a logarithmic axis.
        if drawable(&size) {
            let svg = convergence_plot(&size, &theories, dim)?;
            bundle.add(format!("figures/{stem}.error.svg"), svg)?;
        }
        if drawable(&spent) {
            let svg = error_plot(&spent, None)?;
            bundle.add(format!("figures/{stem}.error-time.svg"), svg)?;
        }
    }
    Ok(())
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
    paper::add_readable(&mut bundle, "convergence", &error_table(errors)?)?;
    paper::add_readable(&mut bundle, "orders", &order_table(orders)?)?;
    add_figures(&mut bundle, errors, orders)?;
    provenance.add_to(&mut bundle)?;
    Ok(bundle)
}
