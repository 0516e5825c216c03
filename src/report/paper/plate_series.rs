//! The plate over one parameter: penalty error against the stiffness, reaction against the cell width.

use crate::report::number::value;
use crate::report::plot::{Curve, CurvePlot, error_plot};
use crate::report::{Bundle, ReportError, table};
use crate::studies::paper::plate_series::{LimitRow, PenaltyRow, RefinementRow};

/// Adds `penalty.csv`, `.md`, `.tex` and the figure of the error against the parameter.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figure.
pub fn add_penalty(bundle: &mut Bundle, rows: &[PenaltyRow]) -> Result<(), ReportError> {
    table::add(bundle, rows, "")?;
    let plot = CurvePlot {
        caption: "plate, Mesh I, penalty method".into(),
        x_label: "penalty stiffness / natural scale".into(),
        y_label: "relative error of the reaction".into(),
        curves: curves(
            rows,
            |r| (r.friction, String::new()),
            |r| [r.parameter, r.relative_error],
        ),
    };
    Ok(bundle.add("figures/penalty.svg", error_plot(&plot, Some(-1.0))?)?)
}

/// Adds `refinement.*`, `limits.*` and the figure of the distance from the common limit.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figure.
pub fn add_refinement(
    bundle: &mut Bundle,
    rows: &[RefinementRow],
    limits: &[LimitRow],
) -> Result<(), ReportError> {
    table::add(bundle, rows, "")?;
    table::add(bundle, limits, "")?;
    let distance = |r: &RefinementRow| {
        let limit = limits.iter().find(|l| l.friction == r.friction);
        let mean = limit.map_or(f64::NAN, |l| 0.5 * (l.mesh_1_mn_per_m + l.mesh_2_mn_per_m));
        [r.h_m, ((r.reaction_mn_per_m - mean) / mean).abs()]
    };
    let plot = CurvePlot {
        caption: "plate, b-newton, edge pairs".into(),
        x_label: "cell width h [m]".into(),
        y_label: "relative distance to limit".into(),
        curves: curves(
            rows,
            |r| (r.friction, format!("Mesh {}, ", r.family)),
            distance,
        ),
    };
    Ok(bundle.add("figures/refinement.svg", error_plot(&plot, Some(1.0))?)?)
}

/// One curve per friction value and prefix, in order of appearance.
fn curves<R>(
    rows: &[R],
    name: impl Fn(&R) -> (f64, String),
    point: impl Fn(&R) -> [f64; 2],
) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        let (friction, prefix) = name(row);
        let label = format!("{prefix}μ = {}", value(friction));
        match curves.iter_mut().find(|c| c.label == label) {
            Some(curve) => curve.points.push(point(row)),
            None => curves.push(Curve {
                label,
                points: vec![point(row)],
            }),
        }
    }
    curves
}
