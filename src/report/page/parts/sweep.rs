//! The study of run time against error: rates, ranks, profiles, work against precision.

use super::blocks::{figures, made, tables};
use crate::report::page::{Budget, Folder, Kind, PageError, Section, Show};

const SUCCESS: [Show; 13] = [
    Show::new("method", Kind::Text),
    Show::new("tier", Kind::Text),
    Show::new("cells", Kind::Number).titled("problems"),
    Show::new("success_rate", Kind::Percent(1)).titled("claimed"),
    Show::new("correct_rate", Kind::Percent(1)).titled("right"),
    Show::new("correct_low", Kind::Percent(1)).titled("from"),
    Show::new("correct_high", Kind::Percent(1)).titled("to"),
    Show::new("inaccurate", Kind::Number),
    Show::new("false_claim", Kind::Number).titled("false claims"),
    Show::new("max_iterations", Kind::Number),
    Show::new("stalled", Kind::Number),
    Show::new("timed_out", Kind::Number),
    Show::new("crashed", Kind::Number),
];

const RANKING: [Show; 10] = [
    Show::new("tier", Kind::Text),
    Show::new("rank_first", Kind::Number).titled("rank from"),
    Show::new("rank_last", Kind::Number).titled("to"),
    Show::new("method", Kind::Text),
    Show::new("mean_s", Kind::Digits(3)).titled("mean"),
    Show::new("low_s", Kind::Digits(3)).titled("from"),
    Show::new("high_s", Kind::Digits(3)).titled("to"),
    Show::new("correct", Kind::Number).titled("right"),
    Show::new("problems", Kind::Number),
    Show::new("shift_s", Kind::Digits(2)).titled("shift"),
];

/// Groups of figures: title, beginnings of the names.
const FIGURES: [(&str, &[&str]); 3] = [
    (
        "Performance profiles (Dolan & Moré): share of the problems solved within a factor of the best",
        &["profile."],
    ),
    (
        "Run time against error: solver error of every method over the tolerance asked for",
        &["work_precision."],
    ),
    (
        "Error of the mesh against the time of the whole run, and what the time goes into",
        &["time_to_accuracy.", "stages."],
    ),
];

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    if folder.named("ranking.csv").is_empty() {
        return Ok(None);
    }
    let mut blocks = Vec::new();
    let title = "Time of the method: shifted geometric mean over all problems; methods whose intervals overlap share a rank";
    blocks.extend(tables(folder, "ranking.csv", title, &RANKING)?);
    let title =
        "What methods claim and what the judge confirms, by accuracy, with Wilson's 95 % interval";
    blocks.extend(tables(folder, "success.csv", title, &SUCCESS)?);
    for (title, beginnings) in FIGURES {
        blocks.extend(figures(folder, budget, title, |name| {
            beginnings
                .iter()
                .any(|beginning| name.starts_with(beginning))
        })?);
    }
    let lead = "Every method on the same problems, asked for one accuracy after the other. Time of the method: preparation and \
                solution of all increments, K factored and condensed before; median of repetitions on one thread, with its \
                95 % interval. A time counts beside a right answer only. The repetitions of one run scatter less than two runs \
                differ: ranks of neighbours may change on another day or machine, counts of iterations do not.";
    Ok(made("study", "Run time against error", lead, blocks))
}
