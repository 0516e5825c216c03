//! Time to accuracy: the error of the discretisation against what it takes to have the answer, mesh by mesh.

use super::quantity_name;
use super::runs::{distinct, friction, least};
use crate::report::number::{significant, value};
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style, looks, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::accuracy::{Refinement, refinements};
use crate::studies::analysis::problem_names;
use crate::studies::convergence::orders::{ErrorRow, Kind, ROUND_OFF};
use crate::studies::record::Record;
use crate::studies::task::Problem;

/// The kind.
pub static KIND: super::kind::Kind = super::kind::Kind {
    file: "time_against_total_error.*.svg",
    question: "How long does a wanted accuracy of the answer take, from mesh to method?",
    shows: "Discretisation error of one quantity against the total time of a run, mesh by mesh, a curve per \
            method; the triangle has the observed order if the time grows with the number of unknowns.",
};

/// Errors that the title may name.
const LEVELS: [f64; 4] = [0.01, 0.02, 0.05, 0.1];
/// Times within this factor are a tie: of the body each is measured once.
const TIE: f64 = 1.05;
/// Orders that a triangle may show.
const ORDERS: [f64; 3] = [0.5, 1.0, 2.0];

/// A figure per case, contact space and friction; `caveat`: what the caption says of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let mut all = refinements(records);
    all.retain(|one| one.shown().1.is_some());
    // The name tells everything but the mesh.
    let meshless: Vec<Problem> = all.iter().map(|one| one.coarsest.without_mesh()).collect();
    for (one, name) in all.iter().zip(problem_names(&meshless)) {
        KIND.add(
            bundle,
            &name.replacen(".r0.", ".", 1),
            figure(one, caveat).svg()?,
        )?;
    }
    Ok(())
}

fn figure(one: &Refinement, caveat: &str) -> Figure {
    let (mut shown, first) = one.shown();
    let first = first.map(|row| &row.finest);
    shown.retain(|row| row.error >= ROUND_OFF);
    let methods = distinct(shown.iter().map(|row| row.variant.method.as_str()));
    let finest = shown.iter().map(|row| row.refine).max();
    let timed = |row: &&&ErrorRow| Some(row.refine) == finest && total(row) > 0.0;
    let best = least(shown.iter().filter(timed), |row| total(row));
    let further: Vec<&str> = best.iter().map(|row| row.variant.method.as_str()).collect();
    let name = first.map_or_else(String::new, |row| {
        quantity_name::name(&row.quantity, &row.at)
    });
    let y = Axis::log(&format!("relative error: {name}"));
    let mut panel = Panel::new(Axis::log("total time [s]"), y, 56.0);
    for (method, (label, style)) in methods.iter().zip(looks(&methods, &further)) {
        let own = shown.iter().filter(|row| row.variant.method == *method);
        let points = own.map(|row| [total(row), row.error]).collect();
        panel.series.push(Series::new(label, style, points));
    }
    let best = Series::new("least time", Style::band(), envelope(&shown));
    panel.series.insert(0, best);
    let observed = first.map_or(f64::NAN, |row| row.order);
    let off = |order: &f64| (order - observed).abs();
    let nearest = least(ORDERS, off);
    let nearest = nearest.filter(|order| off(order) < 0.5 * order);
    let guide = |order: f64| Guide::new(-order, one.dim as f64, "");
    panel.guides.extend(nearest.map(guide));
    let title = title(&shown, observed, one.dim);
    let against = match first.and_then(|row| row.kind) {
        Some(Kind::Exact) => "against the closed form",
        _ => "estimated from the strain energies of the meshes",
    };
    let triangle = nearest.map_or(String::new(), |order| {
        let order = value(order);
        format!("; triangle: order {order} in h, time proportional to the unknowns")
    });
    let caption = format!(
        "{}, {}, {}, error {against}{caveat}; solver error below the tolerance of tier high{triangle}",
        one.coarsest.case,
        first.map_or("", |row| row.variant.space.as_str()),
        friction(one.coarsest.friction.first().copied().unwrap_or(0.0)),
    );
    Figure::new(&title, &caption, 1, vec![panel])
}

fn total(row: &ErrorRow) -> f64 {
    row.seconds.iter().sum()
}

/// Time and error of what nothing else beats in both, by time.
fn envelope(rows: &[&ErrorRow]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = rows.iter().map(|row| [total(row), row.error]).collect();
    points.retain(|point| point[0] > 0.0);
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut least = f64::INFINITY;
    points.retain(|point| {
        let better = point[1] < least;
        least = least.min(point[1]);
        better
    });
    points
}

/// Who reaches 1 % first, or the next level that somebody does, what a tenth of that costs, and which part of it is enforcement.
fn title(rows: &[&ErrorRow], order: f64, dim: usize) -> String {
    let timed = || rows.iter().filter(|row| total(row) > 0.0);
    let within = |level: f64| timed().filter(move |row| row.error <= level);
    let level = LEVELS
        .into_iter()
        .find(|level| within(*level).next().is_some());
    let first = level.and_then(|level| Some((level, least(within(level), |row| total(row))?)));
    let Some((level, first)) = first else {
        return "No mesh reaches an error of 10 %".into();
    };
    let alike = |row: &&&ErrorRow| row.refine == first.refine && total(row) <= TIE * total(first);
    let same: Vec<&&ErrorRow> = timed().filter(alike).collect();
    let by = match same.len() {
        1 => plain(&first.variant.method),
        n => format!("{n} methods alike"),
    };
    let percent = value(100.0 * level);
    let seconds = significant(total(first), 2);
    let mut title = format!(
        "{percent} % first on {}, in {seconds} s by {by}",
        first.mesh
    );
    // Time as the unknowns, error as h^order.
    let factor = 10f64.powf(dim as f64 / order);
    if factor.is_finite() && factor > 1.0 {
        title += &format!(
            "; a tenth of it takes {} times as long",
            significant(factor, 1)
        );
    }
    let share = |row: &&&ErrorRow| 100.0 * (row.seconds[4] + row.seconds[5]) / total(row);
    let own = || timed().filter(|row| row.refine == first.refine);
    let shares: Vec<f64> = own().map(|row| share(&row)).collect();
    let ends = [f64::min, f64::max].map(|f| shares.iter().copied().reduce(f).unwrap_or(f64::NAN));
    let [least, most] = ends.map(|share| significant(share, 1));
    let range = if least == most {
        most
    } else {
        format!("{least} to {most}")
    };
    title + &format!("; enforcement {range} % of it")
}
