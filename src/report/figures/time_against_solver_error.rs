//! Work against precision: solver error against time and iterations, problem by problem.

use super::kind::Kind;
use super::runs::{friction, least, made_with};
use crate::report::number::{RESIDUAL_FLOOR, significant, value};
use crate::report::plot::{Axis, Figure, Panel, Series, base, italic, looks, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::series::{Point, Series as Sequence, Swept, series};
use crate::studies::analysis::{by_problem, problem_names, problems};
use crate::studies::record::Record;
use crate::studies::statistics::Timing;
use crate::studies::task::Problem;

/// The kind.
pub static KIND: Kind = Kind {
    file: "time_against_solver_error.*.svg",
    question: "What does every digit cost with every method?",
    shows: "Distance of the answer from the converged solution of the same discrete problem (energy norm) against \
            the time of the method, along the tolerance, or along an option for methods with laws of their own.",
};

/// Points of a curve: problems that were solved at the three tiers alone have no figure.
const CURVE: usize = 4;
/// Solver error at which times are compared in the title.
const COMPARED: f64 = 1e-6;

/// A figure per problem with a curve; `caveat`: what the caption says of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let all = problems(records);
    let own = all.iter().zip(by_problem(records));
    for ((problem, of_problem), name) in own.zip(problem_names(&all)) {
        let found = series(&of_problem);
        if found.iter().any(|own| own.points.len() >= CURVE) {
            KIND.add(bundle, &name, figure(problem, &found, caveat).svg()?)?;
        }
    }
    Ok(())
}

fn figure(problem: &Problem, found: &[Sequence<'_>], caveat: &str) -> Figure {
    // A curve along options replaces the one along the tolerance, which ends at the modelling error at once.
    let replaced = |own: &&Sequence<'_>| {
        let by_option = |other: &Sequence<'_>| {
            other.swept != Swept::Tolerance && base(&other.label) == own.label
        };
        own.swept == Swept::Tolerance && !own.exact && found.iter().any(by_option)
    };
    let shown: Vec<&Sequence> = found.iter().filter(|own| !replaced(own)).collect();
    let error = |point: &Point<'_>| point.error.max(RESIDUAL_FLOOR);
    let fastest = shown.iter().filter(|own| own.exact).flat_map(|own| {
        let right = own.points.iter().filter(|p| p.error <= COMPARED);
        right.filter_map(move |p| Some((own.label.as_str(), p.time?.median_s)))
    });
    let fastest = least(fastest, |own| own.1);
    let labels: Vec<&str> = shown.iter().map(|own| own.label.as_str()).collect();
    let further: Vec<&str> = fastest.iter().map(|(label, _)| *label).collect();
    let y = Axis::log(&format!("solver error, energy norm of {} [-]", italic("u")));
    let mut panel = Panel::new(Axis::log("time of the method [s]"), y, 80.0);
    for (own, (label, style)) in shown.iter().zip(looks(&labels, &further)) {
        let timed: Vec<(&Point<'_>, Timing)> = own
            .points
            .iter()
            .filter_map(|p| Some((p, p.time?)))
            .collect();
        let points = timed.iter().map(|(p, t)| [t.median_s, error(p)]).collect();
        let mut by_time = Series::new(label, style.clone(), points);
        if !style.behind {
            by_time.intervals = timed.iter().map(|(_, t)| [t.low_s, t.high_s]).collect();
        }
        panel.series.push(by_time);
    }
    let title = fastest.map_or("Work against precision".to_owned(), |(label, seconds)| {
        let ms = significant(1e3 * seconds, 2);
        format!(
            "{} reaches an error of {COMPARED:e} first, in {ms} ms",
            plain(label)
        )
    });
    let first = found.iter().flat_map(|own| &own.points).next();
    let (mesh, space) = first.map_or(("", ""), |point| made_with(point.record));
    let caption = format!(
        "{}, {mesh}, {space}, {}{caveat}; error: distance from the converged solution of the same discrete \
         problem, at {} also what is smaller; hollow: laws of their own",
        problem.case,
        friction(problem.friction.first().copied().unwrap_or(0.0)),
        value(RESIDUAL_FLOOR),
    );
    Figure::new(&title, &caption, 1, vec![panel])
}
