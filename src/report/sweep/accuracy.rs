//! Time to accuracy: the error of the discretisation beside what it takes to have the answer, mesh by mesh.

use super::records::SweepRecords;
use crate::report::number::value;
use crate::report::plot::{Guide, MethodCurve, MethodPanel, MethodPanels, italic, method_panels};
use crate::report::standard::file_name;
use crate::report::tables::sweep::AccuracyRow;
use crate::report::{Bundle, ReportError, quantity_name, table};
use crate::studies::convergence::orders::{Kind, ROUND_OFF};
use crate::studies::sweep::analysis::accuracy::{Refinement, refinements};
use crate::studies::sweep::analysis::problem_names;
use crate::studies::sweep::cell::Problem;

/// Orders that a triangle may show.
const ORDERS: [f64; 3] = [0.5, 1.0, 2.0];

/// Adds `time_to_accuracy.csv` and a figure per case, contact space and friction.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let all = refinements(sweep.records);
    let coarsest: Vec<Problem> = all.iter().map(|one| one.coarsest.clone()).collect();
    let mut rows = Vec::new();
    for (one, name) in all.iter().zip(problem_names(&coarsest)) {
        // The name tells everything but the mesh.
        let name = name.replacen(&format!(".r{}.", one.coarsest.refine), ".", 1);
        if let Some(svg) = method_panels(&figure(one, &sweep.caveat()))? {
            let stem = file_name(&["time_to_accuracy", &name]);
            bundle.add(format!("figures/{stem}.svg"), svg)?;
        }
        rows.extend(one.errors.iter().map(AccuracyRow));
    }
    table::add(bundle, &rows, "")
}

fn figure(one: &Refinement, caveat: &str) -> MethodPanels {
    // Against its own finest mesh a sequence says nothing.
    let first = one.orders.iter().find(|row| row.kind != Kind::Finest);
    let mut methods: Vec<&str> = Vec::new();
    for row in &one.errors {
        if !methods.contains(&row.variant.method.as_str()) {
            methods.push(&row.variant.method);
        }
    }
    let curve = |method: &&str| MethodCurve {
        method: (*method).to_owned(),
        points: one
            .errors
            .iter()
            .filter(|row| row.variant.method == *method && row.error >= ROUND_OFF)
            .filter(|row| row.kind != Some(Kind::Finest))
            .map(|row| [row.seconds.total(), row.error])
            .collect(),
        whiskers: Vec::new(),
    };
    let observed = first.map_or(f64::NAN, |row| row.order);
    let off = |order: &f64| (order - observed).abs();
    let nearest = ORDERS.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    let nearest = nearest.filter(|order| off(order) < 0.5 * order);
    let guide = nearest.map(|order| Guide {
        rise: -order,
        run: one.dim as f64,
        label: None,
    });
    let name = first.map_or_else(String::new, |row| {
        quantity_name::name(&row.quantity, &row.at)
    });
    let against = match first.map(|row| row.kind) {
        Some(Kind::Exact) => "against the closed form",
        _ => "against the extrapolated limit",
    };
    let space = first.map_or("", |row| row.variant.space.as_str());
    let friction = one.coarsest.friction.first().copied().unwrap_or(0.0);
    let triangle = match &guide {
        Some(guide) => format!(
            "\ntriangle: order {} in h, time proportional to the unknowns",
            value(-guide.rise)
        ),
        None => String::new(),
    };
    MethodPanels {
        title: format!("Time to accuracy: {}", one.coarsest.case),
        caption: format!(
            "{}, {space}, {} = {}, {against}{caveat}{triangle}",
            one.coarsest.case,
            italic("μ"),
            value(friction)
        ),
        y_label: format!("error: {name}"),
        logarithmic: true,
        every_point: true,
        columns: 1,
        height: 56.0,
        panels: vec![MethodPanel {
            heading: String::new(),
            x_label: "total time [s]".into(),
            curves: methods.iter().map(curve).collect(),
            guides: guide.into_iter().collect(),
        }],
    }
}
