//! Success rates of the methods on random problems.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::{fixed, value};
use crate::report::plot::{Cell, HeatMap, is_exact, italic, plain, rank};
use crate::report::{Bundle, ReportError};
use crate::studies::robustness::summary::RobustnessRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "robustness.svg",
    question: "Which method can be relied on at which friction coefficient?",
    shows: "Percentage of random problems solved, or (≈, approximate methods) of own laws kept, by method and \
            friction coefficient in 2D and 3D, below it the lower end of the 95 % confidence interval; –: all \
            problems declined.",
};

/// Rate with the full tint [%]: what lies below does not differ in use.
const WORST: f64 = 50.0;

/// The figure of both dimensions.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[RobustnessRow]) -> Result<(), ReportError> {
    let rated: Vec<&RobustnessRow> = rows
        .iter()
        .filter(|row| row.success[0].is_finite())
        .collect();
    // Where every method declines every problem there is nothing to draw.
    let Some(most) = rated.iter().map(|row| row.problems).max() else {
        return Ok(());
    };
    let mut names = distinct(rows.iter().map(|row| row.method.as_str()));
    names.sort_by_key(|name| (rank(name), *name));
    let mut columns = distinct(rows.iter().map(|row| (row.dimension, row.friction)));
    columns.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // 99.96 % is not 100.
    let percent = |rate: f64| {
        let percent = (1e3 * rate).floor() / 10.0;
        fixed(percent, usize::from(percent.fract() != 0.0))
    };
    let cell = |name: &str, column: &(usize, f64)| {
        let own =
            |row: &&&RobustnessRow| row.method == name && (row.dimension, row.friction) == *column;
        let [rate, low, _] = rated
            .iter()
            .find(own)
            .map_or([f64::NAN; 3], |row| row.success);
        let (text, below) = match rate.is_finite() {
            true => (percent(rate), format!("≥{}", percent(low))),
            false => ("–".into(), String::new()),
        };
        let tint = 100.0 * (1.0 - rate) / (100.0 - WORST);
        Cell { tint, text, below }
    };
    let line = |name: &&str| {
        let sign = if is_exact(name) { "" } else { "≈ " };
        let cells = columns.iter().map(|column| cell(name, column));
        (format!("{sign}{}", plain(name)), cells.collect())
    };
    let own = |name: &&str| rated.iter().any(|row| row.method == *name);
    let exact: Vec<&str> = names
        .iter()
        .copied()
        .filter(|name| is_exact(name) && own(name))
        .collect();
    let fails = |name: &str| {
        rated
            .iter()
            .any(|row| row.method == name && row.success[0] < 1.0)
    };
    let perfect = exact.iter().filter(|name| !fails(name));
    let perfect: Vec<String> = perfect.map(|name| plain(name)).collect();
    let others = exact.len() - perfect.len();
    let title = match perfect.is_empty() {
        true => format!("None of {others} exact methods solves every random problem"),
        false => format!(
            "Every random problem is solved by {}, not by {others} others",
            perfect.join(", ")
        ),
    };
    let caption = format!(
        "solved, or (≈) own laws kept [%] of up to {most} random problems by friction coefficient {}; ≥: lower \
         end of the 95 % confidence interval; –: all problems declined",
        italic("μ")
    );
    let groups = columns.chunk_by(|a, b| a.0 == b.0);
    let map = HeatMap {
        title,
        caption,
        groups: groups
            .map(|own| (format!("{}D", own[0].0), own.len()))
            .collect(),
        columns: columns.iter().map(|(_, mu)| value(*mu)).collect(),
        rows: names.iter().map(line).collect(),
    };
    KIND.add(bundle, "", map.svg()?)
}
