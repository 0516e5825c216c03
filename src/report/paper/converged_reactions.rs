//! Converged reactions of the paper's plate: every mesh, the limits of three meshes beside the printed numbers, figures.

use std::cmp::Ordering;

use crate::report::csv::Row;
use crate::report::number::{fixed, significant, value};
use crate::report::tables::{Align, Column, Table};
use crate::report::{Bundle, ReportError, csv, figures, tables};
use crate::studies::paper::converged_reactions::{ConvergedRow, SequenceRow, agreements};
use crate::studies::paper::plate_series::RefinementRow;

/// Digits of orders, error bars and differences: they are estimates.
const ORDER_DIGITS: usize = 3;
const BAR_DIGITS: usize = 2;

impl Row for SequenceRow {
    const FILE: &'static str = "converged_meshes.csv";
    const COLUMNS: &'static [&'static str] = &[
        "mesh",
        "cells",
        "h_m",
        "friction",
        "dofs",
        "points",
        "reaction_mn_per_m",
        "order",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.mesh.clone(),
            self.cells.clone(),
            value(self.h_m),
            value(self.friction),
            self.dofs.to_string(),
            self.points.to_string(),
            value(self.reaction_mn_per_m),
            significant(self.order, ORDER_DIGITS),
            self.verdict.to_string(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let friction = self.friction.total_cmp(&other.friction);
        friction
            .then_with(|| self.mesh.cmp(&other.mesh))
            .then(other.h_m.total_cmp(&self.h_m))
    }
}

impl Row for ConvergedRow {
    const FILE: &'static str = "converged.csv";
    const COLUMNS: &'static [&'static str] = &[
        "friction",
        "mesh",
        "finest_h_m",
        "order",
        "limit_mn_per_m",
        "error_bar_mn_per_m",
        "printed_mn_per_m",
        "printed_difference",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let optional = |number: Option<f64>, digits| {
            number.map_or_else(String::new, |x| significant(x, digits))
        };
        vec![
            value(self.friction),
            self.mesh.clone(),
            value(self.finest_h_m),
            significant(self.order, ORDER_DIGITS),
            // One digit more than the error bar can use.
            fixed(self.limit_mn_per_m, 3),
            significant(self.error_bar_mn_per_m, BAR_DIGITS),
            optional(self.printed_mn_per_m, 5),
            optional(self.printed_difference(), ORDER_DIGITS),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let friction = self.friction.total_cmp(&other.friction);
        friction.then_with(|| self.mesh.cmp(&other.mesh))
    }
}

/// One paragraph on the agreement of the meshes.
pub fn summary(rows: &[ConvergedRow]) -> String {
    let lines = agreements(rows).into_iter().map(|found| {
        format!(
            "μ = {}: {} limits within {} MN/m of each other, {} their smallest error bar of {} MN/m",
            value(found.friction),
            found.meshes,
            significant(found.spread_mn_per_m, BAR_DIGITS),
            if found.holds() { "inside" } else { "NOT inside" },
            significant(found.smallest_bar_mn_per_m, BAR_DIGITS),
        )
    });
    let lines: Vec<String> = lines.collect();
    format!("Converged reactions of the plate: {}", lines.join("; "))
}

/// A number for reading; a dash where there is none.
fn shown(x: f64, text: impl Fn(f64) -> String) -> String {
    if x.is_finite() { text(x) } else { "–".into() }
}

/// Limits beside the printed numbers for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn converged_table(rows: &[ConvergedRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Plate, converged reactions beside Table 1: star multipliers, tips enriched within a fixed radius, limits for h → 0 \
         from the three finest meshes",
        vec![
            Column::new("friction", "", Align::Decimal),
            Column::new("mesh", "", Align::Left),
            Column::new("finest h", "m", Align::Decimal),
            Column::new("order", "", Align::Decimal),
            Column::new("limit", "MN/m", Align::Decimal),
            Column::new("error bar", "MN/m", Align::Decimal),
            Column::new("printed", "MN/m", Align::Decimal),
            Column::new("printed − limit", "%", Align::Decimal),
        ],
    );
    let mut sorted: Vec<&ConvergedRow> = rows.iter().collect();
    sorted.sort_by(|a, b| Row::order(*a, *b));
    for row in sorted {
        let percent = row.printed_difference().map_or(f64::NAN, |d| 100.0 * d);
        table.push(vec![
            value(row.friction),
            row.mesh.clone(),
            shown(row.finest_h_m, |h| fixed(h, 4)),
            shown(row.order, |p| fixed(p, 2)),
            shown(row.limit_mn_per_m, |r| fixed(r, 3)),
            shown(row.error_bar_mn_per_m, |e| fixed(e, 3)),
            shown(row.printed_mn_per_m.unwrap_or(f64::NAN), |r| fixed(r, 1)),
            shown(percent, |p| fixed(p, 2)),
        ])?;
    }
    Ok(table)
}

/// Every mesh for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn sequence_table(rows: &[SequenceRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Plate under refinement, star multipliers, tips enriched within a fixed radius: vertical reaction at the top",
        vec![
            Column::new("friction", "", Align::Decimal),
            Column::new("mesh", "", Align::Left),
            Column::new("cells", "", Align::Right),
            Column::new("h", "m", Align::Decimal),
            Column::new("unknowns", "", Align::Right),
            Column::new("points", "", Align::Right),
            Column::new("reaction", "MN/m", Align::Decimal),
            Column::new("order", "", Align::Decimal),
            Column::new("verdict", "", Align::Left),
        ],
    );
    let mut sorted: Vec<&SequenceRow> = rows.iter().collect();
    sorted.sort_by(|a, b| Row::order(*a, *b));
    for row in sorted {
        table.push(vec![
            value(row.friction),
            row.mesh.clone(),
            row.cells.clone(),
            fixed(row.h_m, 4),
            row.dofs.to_string(),
            row.points.to_string(),
            shown(row.reaction_mn_per_m, |r| fixed(r, 3)),
            shown(row.order, |p| fixed(p, 2)),
            row.verdict.to_string(),
        ])?;
    }
    Ok(table)
}

/// Adds `converged.*`, `converged_meshes.*` and their figure, where the same plate with edge pairs and enriched tip cells
/// stands beside them.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figures.
pub fn add(
    bundle: &mut Bundle,
    sequences: &[SequenceRow],
    limits: &[ConvergedRow],
    edge_pairs: &[RefinementRow],
) -> Result<(), ReportError> {
    bundle.add(SequenceRow::FILE, csv::file(sequences)?)?;
    tables::add_readable(bundle, "converged_meshes", &sequence_table(sequences)?)?;
    bundle.add(ConvergedRow::FILE, csv::file(limits)?)?;
    tables::add_readable(bundle, "converged", &converged_table(limits)?)?;
    figures::converged::add(bundle, sequences, limits, edge_pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(mesh: &str, limit: f64, bar: f64) -> ConvergedRow {
        ConvergedRow {
            friction: 0.3,
            mesh: mesh.into(),
            finest_h_m: 0.1,
            order: 1.4,
            limit_mn_per_m: limit,
            error_bar_mn_per_m: bar,
            printed_mn_per_m: (mesh == "I").then_some(99.0),
        }
    }

    /// Goal: meshes agree only if every limit lies within the smallest bar; without a limit they never do.
    #[test]
    fn meshes_agree_within_the_smallest_error_bar() {
        let of = |limits: [f64; 3]| {
            let rows = [
                row("I", limits[0], 0.2),
                row("II", limits[1], 0.5),
                row("I turned", limits[2], 0.1),
            ];
            let found = agreements(&rows);
            assert_eq!((found.len(), found[0].meshes), (1, 3));
            assert_eq!(summary(&rows).contains("NOT"), !found[0].holds());
            found[0].clone()
        };
        let close = of([100.0, 100.06, 99.97]);
        assert!(close.holds() && (close.spread_mn_per_m - 0.09).abs() < 1e-12);
        assert!((close.mean_mn_per_m - 100.01).abs() < 1e-12);
        assert!(!of([100.0, 100.08, 99.97]).holds());
        let missing = of([100.0, f64::NAN, 100.0]);
        assert!(!missing.holds() && missing.spread_mn_per_m.is_nan());
    }

    #[test]
    fn the_printed_number_stands_beside_the_limit_of_its_mesh_only() {
        let table = converged_table(&[row("I turned", 100.0, 0.1), row("I", 100.0, 0.1)]);
        let text = table.expect("a table").markdown();
        let lines: Vec<&str> = text.lines().filter(|l| l.contains("100.000")).collect();
        assert!(
            lines[0].contains("99.0") && lines[0].contains("-1.00"),
            "{text}"
        );
        assert!(
            !lines[1].contains("99.0") && lines[1].contains('–'),
            "{text}"
        );
    }
}
