//! Work against precision: rows, and a figure per problem with time and iterations side by side.

use super::records::SweepRecords;
use crate::report::number::{RESIDUAL_FLOOR, value};
use crate::report::plot::{MethodCurve, MethodPanel, MethodPanels, italic, method_panels};
use crate::report::standard::file_name;
use crate::report::tables::sweep::PointRow;
use crate::report::{Bundle, ReportError, table};
use crate::studies::sweep::analysis::series::{Point, Series, Swept, series};
use crate::studies::sweep::analysis::{problem_names, problems};
use crate::studies::sweep::cell::Problem;

/// Points of a curve: problems that were solved at the three tiers alone have no figure.
const CURVE: usize = 4;

/// Adds `work_precision.csv` and a figure per problem with a curve.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let all = problems(sweep.records);
    let mut rows = Vec::new();
    for (problem, name) in all.iter().zip(problem_names(&all)) {
        let series = series(sweep.records, problem);
        let drawn = series.iter().any(|own| own.points.len() >= CURVE);
        let figure = figure(problem, &series, &sweep.caveat());
        if let (true, Some(svg)) = (drawn, method_panels(&figure)?) {
            let stem = file_name(&["work_precision", &name]);
            bundle.add(format!("figures/{stem}.svg"), svg)?;
        }
        for own in series {
            let Series { label, swept, .. } = own;
            rows.extend(own.points.into_iter().map(|point| PointRow {
                problem: name.clone(),
                label: label.clone(),
                swept: swept.clone(),
                exact: own.exact,
                point,
            }));
        }
    }
    table::add(bundle, &rows, "")
}

fn figure(problem: &Problem, series: &[Series<'_>], caveat: &str) -> MethodPanels {
    // A curve along options replaces the one along the tolerance, which ends at the modelling error at once.
    let name = |label: &str| label.split('[').next().unwrap_or(label).to_owned();
    let replaced = |own: &&Series<'_>| {
        own.swept == Swept::Tolerance
            && !own.exact
            && series
                .iter()
                .any(|other| other.swept != Swept::Tolerance && name(&other.label) == own.label)
    };
    let shown: Vec<&Series> = series.iter().filter(|own| !replaced(own)).collect();
    let error = |point: &Point<'_>| point.error.max(RESIDUAL_FLOOR);
    let by_time = |own: &&Series<'_>| {
        let timed = own.points.iter().filter_map(|p| Some((p, p.time?)));
        let (points, whiskers) = timed
            .map(|(p, t)| ([t.median_s, error(p)], [t.low_s, t.high_s]))
            .unzip();
        MethodCurve {
            method: own.label.clone(),
            points,
            whiskers,
        }
    };
    let by_iterations = |own: &&Series<'_>| MethodCurve {
        method: own.label.clone(),
        points: own
            .points
            .iter()
            .map(|p| [p.record.found.sum(|i| i.iterations) as f64, error(p)])
            .collect(),
        whiskers: Vec::new(),
    };
    let panel = |x_label: &str, curves| MethodPanel {
        heading: String::new(),
        x_label: x_label.to_owned(),
        curves,
        guides: Vec::new(),
    };
    let first = series.iter().flat_map(|own| &own.points).next();
    let size = first.and_then(|point| point.record.found.problem.as_ref());
    let (mesh, space) = size.map_or(("", ""), |size| (&size.mesh, &size.space));
    let friction = problem.friction.first().copied().unwrap_or(0.0);
    MethodPanels {
        title: format!("Work against precision: {}", problem.case),
        caption: format!(
            "{}, {mesh}, {space}, {} = {}{caveat}\nerror: distance from the converged solution of the same discrete problem, at {} also what is smaller\nhollow markers: laws of their own, with options in brackets along the first of these",
            problem.case,
            italic("μ"),
            value(friction),
            value(RESIDUAL_FLOOR),
        ),
        y_label: format!("solver error, energy norm of {} [-]", italic("u")),
        logarithmic: true,
        every_point: true,
        columns: 2,
        height: 70.0,
        panels: vec![
            panel(
                "time of the method [s]",
                shown.iter().map(by_time).collect(),
            ),
            panel("iterations [-]", shown.iter().map(by_iterations).collect()),
        ],
    }
}
