//! Natural-map residual against iteration: all methods on one problem.

use super::runs::{Run, by_problem, counted, problem};
use super::{Bundle, Kind, ReportError};
use crate::report::plot::{Axis, Figure, Panel, Series, looks, plain};
use crate::run::record::{HistoryRow, Results, RunRow};
use crate::run::verdict::Verdict;
use stickslip_methods::Tier;

/// What it is.
pub static KIND: Kind = Kind {
    file: "*.residual.svg",
    question: "How does every method converge on this problem?",
    shows: "Natural-map residual of the iterates of the last increment, one curve per method, as far as methods record it; \
            the dashed line is the tolerance that was asked for. Few methods stand out, the others are grey.",
};

/// Residuals below this are drawn here: a logarithmic axis has no zero.
const SHOWN: f64 = 1e-16;

/// One figure per problem.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    for (name, runs) in by_problem(&results.history, |row: &HistoryRow| &row.key) {
        let found = |run: &Run<'_, HistoryRow>| results.runs.iter().find(|row| row.key == *run.key);
        let found: Vec<Option<&RunRow>> = runs.iter().map(found).collect();
        KIND.add(bundle, &name, figure(&runs, &found).svg()?)?;
    }
    Ok(())
}

/// The figure of one problem; `found`: the row of every run.
fn figure(runs: &[Run<'_, HistoryRow>], found: &[Option<&RunRow>]) -> Figure {
    let mut solved: Vec<&RunRow> = found.iter().flatten().copied().collect();
    let tried = solved.len();
    solved.retain(|row| row.verdict == Verdict::Solved);
    solved.sort_by_key(|row| row.iterations);
    let needs = |row: &RunRow| (plain(&row.key.method), counted(row.iterations, "iteration"));
    let title = match &solved[..] {
        [] => "Residual against iteration".to_owned(),
        [first, .., last] if first.iterations < last.iterations => {
            let ((a, few), (b, _)) = (needs(first), needs(last));
            format!("{a} needs {few}, {b} {}", last.iterations)
        }
        [first, rest @ ..] if rest.is_empty() => {
            format!("{} needs {}", needs(first).0, needs(first).1)
        }
        [first, ..] => format!("All methods that solve it need {}", needs(first).1),
    };
    let mut caption = problem(runs[0].key);
    if tried > solved.len() {
        caption += &format!(
            "; {} of {} solve the contact laws",
            solved.len(),
            counted(tried, "method")
        );
    }
    let extremes = [solved.first(), solved.last()].into_iter().flatten();
    let extremes: Vec<&str> = extremes.map(|row| row.key.method.as_str()).collect();
    let methods: Vec<&str> = runs.iter().map(Run::method).collect();
    let most =
        |run: &Run<'_, HistoryRow>| run.rows.iter().map(|row| row.iteration).max().unwrap_or(0);
    let (fewest, most) = (runs.iter().map(most).min(), runs.iter().map(most).max());
    // Newton needs ten iterations where an alternating method needs hundreds: only a logarithmic axis shows both.
    let many = most.unwrap_or(0) > 8 * fewest.unwrap_or(0).max(1);
    let y = Axis::log("natural-map residual [-]");
    let mut panel = Panel::new(Axis::counts("iteration [-]", many), y, 62.0);
    for (run, (label, style)) in runs.iter().zip(looks(&methods, &extremes)) {
        let mut rows = run.rows.clone();
        rows.sort_by_key(|row| row.iteration);
        let point = |row: &&HistoryRow| [row.iteration as f64, row.natural_map.max(SHOWN)];
        let known = rows.iter().filter(|row| row.natural_map.is_finite());
        panel
            .series
            .push(Series::new(label, style, known.map(point).collect()));
    }
    let mut tiers: Vec<&str> = found
        .iter()
        .flatten()
        .map(|row| row.tier.as_str())
        .collect();
    tiers.dedup();
    let asked = |tier: &Tier| tiers == [tier.to_string().as_str()];
    if let Some(tier) = Tier::ALL.into_iter().find(asked) {
        panel.levels.push(tier.tolerance());
        caption += &format!("; tolerance {:e}", tier.tolerance());
    }
    Figure::new(title, caption, vec![panel])
}
