//! Converged reactions of the paper's plate: every mesh, the limits of three meshes beside the printed numbers, figures.

use crate::report::number::{significant, value};
use crate::report::plot::{ErrorCurve, ErrorFigure, ErrorPanel, Guide, error_figure, italic};
use crate::report::{Bundle, ReportError, table};
use crate::studies::paper::converged_reactions::{
    Agreement, ConvergedRow, SequenceRow, agreements,
};
use crate::studies::paper::plate_series::RefinementRow;

/// Digits of error bars: they are estimates.
const BAR_DIGITS: usize = 2;

/// Order that the corners of the plate allow, drawn as a triangle.
const CORNER_ORDER: f64 = 1.4;

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

/// Adds `converged.*`, `converged_meshes.*` and a figure per friction coefficient: the distance from the mean of the limits,
/// beside that of the same plate with edge pairs and enriched tip cells.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figures.
pub fn add(
    bundle: &mut Bundle,
    sequences: &[SequenceRow],
    limits: &[ConvergedRow],
    edge_pairs: &[RefinementRow],
) -> Result<(), ReportError> {
    table::add(bundle, sequences, "")?;
    table::add(bundle, limits, "")?;
    let sorted = table::sorted(sequences);
    for Agreement {
        friction,
        mean_mn_per_m: mean,
        ..
    } in agreements(limits)
    {
        let distance = |h: f64, reaction: f64| [h, ((reaction - mean) / mean).abs()];
        // The same mesh looks the same in both panels.
        let mut looks: Vec<String> = Vec::new();
        let mut panel = |heading: &str, points: Vec<(String, [f64; 2])>| {
            let mut curves: Vec<ErrorCurve> = Vec::new();
            for (mesh, point) in points {
                let label = format!("Mesh {mesh}");
                if let Some(curve) = curves.iter_mut().find(|curve| curve.label == label) {
                    curve.points.push(point);
                    continue;
                }
                let known = looks.iter().position(|look| *look == mesh);
                let look = known.unwrap_or(looks.len());
                if known.is_none() {
                    looks.push(mesh);
                }
                curves.push(ErrorCurve {
                    label,
                    look,
                    points: vec![point],
                });
            }
            ErrorPanel {
                heading: heading.to_owned(),
                curves,
                guides: vec![Guide {
                    rise: CORNER_ORDER,
                    run: 1.0,
                    label: Some(format!("order {CORNER_ORDER} of the corners")),
                }],
            }
        };
        let star = sorted.iter().filter(|row| row.friction == friction);
        let star = star.map(|row| (row.mesh.clone(), distance(row.h_m, row.reaction_mn_per_m)));
        let pairs = edge_pairs.iter().filter(|row| row.friction == friction);
        let pairs = pairs.map(|row| {
            let point = distance(row.h_m, row.reaction_mn_per_m);
            (row.family.to_string(), point)
        });
        let panels = vec![
            panel("star, tips enriched within a fixed radius", star.collect()),
            panel("edge pairs, tip cells enriched", pairs.collect()),
        ];
        let y_label = "relative distance to limit";
        let figure = ErrorFigure {
            title: format!("Plate: {y_label} against cell width"),
            caption: format!("plate, {} = {}", italic("μ"), value(friction)),
            x_label: format!("cell width {} [m]", italic("h")),
            y_label: y_label.into(),
            columns: 2,
            panels,
        };
        if let Some(svg) = error_figure(&figure)? {
            bundle.add(format!("figures/converged.mu-{}.svg", value(friction)), svg)?;
        }
    }
    Ok(())
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
        let rows = [row("I turned", 100.0, 0.1), row("I", 100.0, 0.1)];
        let text = table::readable(&rows, "").markdown();
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
