//! Time to accuracy: the error of the discretisation against what it takes to have the answer, mesh by mesh.

use super::quantity_name;
use super::runs::{distinct, friction, least};
use crate::report::number::{significant, value};
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, looks, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::accuracy::{Refinement, refinements};
use crate::studies::analysis::problem_names;
use crate::studies::convergence::orders::{ErrorRow, Kind, ROUND_OFF};
use crate::studies::record::Record;
use crate::studies::task::Problem;

/// What it is.
pub static KIND: super::kind::Kind = super::kind::Kind {
    file: "time_to_accuracy.*.svg",
    question: "How long does a wanted accuracy of the answer take, from mesh to method?",
    shows: "Discretisation error of one quantity against the total time of a run, mesh by mesh, a curve per \
            method; the triangle has the observed order if the time grows with the number of unknowns.",
};

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
    let total = |row: &ErrorRow| row.seconds.iter().sum::<f64>();
    let timed = |row: &&&ErrorRow| Some(row.refine) == finest && total(row) > 0.0;
    let best = least(shown.iter().filter(timed), |row| total(row));
    let further: Vec<&str> = best.iter().map(|row| row.variant.method.as_str()).collect();
    let name = first.map_or_else(String::new, |row| {
        quantity_name::name(&row.quantity, &row.at)
    });
    let y = Axis::log(&format!("error: {name}"));
    let mut panel = Panel::new(Axis::log("total time [s]"), y, 56.0);
    for (method, (label, style)) in methods.iter().zip(looks(&methods, &further)) {
        let own = shown.iter().filter(|row| row.variant.method == *method);
        let points = own.map(|row| [total(row), row.error]).collect();
        panel.series.push(Series::new(label, style, points));
    }
    let observed = first.map_or(f64::NAN, |row| row.order);
    let off = |order: &f64| (order - observed).abs();
    let nearest = least(ORDERS, off);
    let nearest = nearest.filter(|order| off(order) < 0.5 * order);
    let guide = |order: f64| Guide::new(-order, one.dim as f64, "");
    panel.guides.extend(nearest.map(guide));
    let title = best.map_or("Time to accuracy".to_owned(), |row| {
        let [error, seconds] = [row.error, total(row)].map(|x| significant(x, 2));
        let method = plain(&row.variant.method);
        format!("{method} is first at an error of {error}, in {seconds} s")
    });
    let against = match first.and_then(|row| row.kind) {
        Some(Kind::Exact) => "closed form",
        _ => "finest mesh",
    };
    let triangle = nearest.map_or(String::new(), |order| {
        let order = value(order);
        format!("; triangle: order {order} in h, time proportional to the unknowns")
    });
    let caption = format!(
        "{}, {}, {}, error against the {against}{caveat}{triangle}",
        one.coarsest.case,
        first.map_or("", |row| row.variant.space.as_str()),
        friction(one.coarsest.friction.first().copied().unwrap_or(0.0)),
    );
    Figure::new(&title, &caption, 1, vec![panel])
}
