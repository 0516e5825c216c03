//! Violation of the contact laws against iteration: all methods on one problem.

use super::kind::Kind;
use super::runs::{Run, by_problem, counted, distinct, problem};
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
    let mut solved = found.to_vec();
    solved.retain(|row| row.step.verdict.is_solved());
    solved.sort_by_key(|row| row.step.iterations);
    let ends = [solved.first(), solved.last()].into_iter().flatten();
    let ends: Vec<(&str, usize)> = ends
        .map(|row| (row.key.method.as_str(), row.step.iterations))
        .collect();
    let title = match ends[..] {
        [(a, few), (b, many)] if few < many => {
            let few = counted(few, "iteration");
            format!("{} needs {few}, {} {many}", plain(a), plain(b))
        }
        [(a, few), (b, _)] if a == b => format!("{} needs {}", plain(a), counted(few, "iteration")),
        [(_, few), _] => format!("All that solve it need {}", counted(few, "iteration")),
        _ => "No method solves the contact laws".to_owned(),
    };
    let mut caption = problem(runs[0].0);
    if found.len() > solved.len() {
        let tried = counted(found.len(), "method");
        caption += &format!("; {} of {tried} solve the contact laws", solved.len());
    }
    let y = Axis::log("violation of the contact laws [-]");
    let mut panel = Panel::new(Axis::counts("iteration [-]"), y, 62.0);
    let methods: Vec<&str> = runs.iter().map(|(key, _)| key.method.as_str()).collect();
    let extremes: Vec<&str> = ends.iter().map(|end| end.0).collect();
    for ((_, rows), (label, style)) in runs.iter().zip(looks(&methods, &extremes)) {
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
