//! Violation of the contact laws against iteration: all methods on one problem.

use super::kind::Kind;
use super::runs::{Run, by_problem, distinct, problem};
use crate::report::plot::{Axis, Figure, Panel, Series, looks, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::results::Results;
use crate::studies::rows::{HistoryRow, IncrementRow};

/// The kind.
pub static KIND: Kind = Kind {
    file: "*.residual.svg",
    question: "How does every method converge on this problem?",
    shows: "Largest violation of the contact laws by the recorded iterates of the last increment, a curve per method; the \
            dashed line is the tolerance that was asked for.",
};

/// Residuals below this are drawn here: a logarithmic axis has no zero.
const SHOWN: f64 = 1e-16;

/// One figure per problem.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    let (history, increments) = (results.history(), results.increments());
    for (name, runs) in by_problem(&history, |row: &HistoryRow| &row.key) {
        let own = |row: &&IncrementRow<'_>| runs.iter().any(|(key, _)| **key == row.key);
        let found: Vec<&IncrementRow<'_>> = increments.iter().filter(own).collect();
        KIND.add(bundle, &name, figure(&runs, &found).svg()?)?;
    }
    Ok(())
}

/// The figure of one problem; `found`: what became of its runs.
fn figure(runs: &[Run<'_, HistoryRow>], found: &[&IncrementRow<'_>]) -> Figure {
    let (solved, others): (Vec<_>, Vec<_>) =
        found.iter().partition(|row| row.step.verdict.is_solved());
    // Iterations of different methods are no common unit: who ends is said, not who needs fewer.
    let name = |row: &&IncrementRow<'_>| plain(&row.key.method);
    let title = match (&solved[..], &others[..]) {
        ([], _) => "No method solves the contact laws".to_owned(),
        ([one], []) => format!("{} solves the contact laws", name(one)),
        (all, []) => format!("All {} methods solve the contact laws", all.len()),
        (_, few @ ([_] | [_, _] | [_, _, _])) => {
            let names: Vec<String> = few.iter().map(name).collect();
            format!("All but {} solve the contact laws", names.join(", "))
        }
        _ => format!(
            "{} of {} methods solve the contact laws",
            solved.len(),
            found.len()
        ),
    };
    let mut caption = problem(runs[0].0);
    let y = Axis::log("violation of the contact laws [-]");
    let mut panel = Panel::new(Axis::counts("iteration [-]"), y, 62.0);
    let methods: Vec<&str> = runs.iter().map(|(key, _)| key.method.as_str()).collect();
    let unsolved = others.iter().map(|row| row.key.method.as_str());
    let unsolved: Vec<&str> = unsolved.take(3).collect();
    for ((_, rows), (label, style)) in runs.iter().zip(looks(&methods, &unsolved)) {
        let known = rows.iter().filter(|row| row.violation.is_finite());
        let point = |row: &&HistoryRow| [row.iteration as f64, row.violation.max(SHOWN)];
        let mut points: Vec<[f64; 2]> = known.map(point).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        panel.series.push(Series::new(label, style, points));
    }
    let asked = found.iter().map(|row| row.record.asked.tolerance);
    if let [tolerance] = distinct(asked)[..] {
        panel.levels.push(tolerance);
        caption += &format!("; tolerance {tolerance:e}");
    }
    Figure::new(&title, &caption, 1, vec![panel])
}
