//! Success rates of the methods on random problems.

use super::{Bundle, Kind, ReportError};
use crate::report::number::{fixed, value};
use crate::report::plot::{Cell, HeatMap, is_exact, italic, plain, rank};
use crate::studies::stress::robustness::RobustnessRow;

/// What it is.
pub static KIND: Kind = Kind {
    file: "robustness.svg",
    question: "Which method can be relied on at which friction coefficient?",
    shows: "Percentage of random problems solved (exact methods) or of own laws kept (≈, approximate methods) by method and friction \
            coefficient in 2D and 3D, below it the lower end of the 95 % confidence interval; –: all problems declined.",
};

/// Rate with the full tint: what lies below does not differ in use.
const WORST: f64 = 50.0;

/// The figure of both dimensions.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[RobustnessRow]) -> Result<(), ReportError> {
    // Where every method declines every problem there is nothing to draw.
    let rated = |row: &&RobustnessRow| row.success[0].is_finite();
    if !rows.iter().any(|row| rated(&row)) {
        return Ok(());
    }
    let mut names: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    names.sort_by_key(|name| (rank(name), *name));
    names.dedup();
    let mut columns: Vec<(usize, f64)> = rows
        .iter()
        .map(|row| (row.dimension, row.friction))
        .collect();
    columns.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    columns.dedup();
    // 99.96 % is not 100.
    let percent = |rate: f64| {
        let percent = (1e3 * rate).floor() / 10.0;
        fixed(percent, usize::from(percent.fract() != 0.0))
    };
    let cell = |name: &str, (dim, mu): (usize, f64)| {
        let own = rows
            .iter()
            .find(|row| row.method == name && (row.dimension, row.friction) == (dim, mu));
        match own.filter(rated) {
            Some(RobustnessRow {
                success: [rate, low, _],
                ..
            }) => Cell {
                tint: (100.0 - 100.0 * rate) / (100.0 - WORST),
                text: percent(*rate),
                below: format!("≥{}", percent(*low)),
            },
            None => Cell {
                tint: f64::NAN,
                text: "–".into(),
                below: String::new(),
            },
        }
    };
    let line = |name: &&str| {
        let sign = if is_exact(name) { "" } else { "≈ " };
        (
            format!("{sign}{}", plain(name)),
            columns.iter().map(|column| cell(name, *column)).collect(),
        )
    };
    let always = |name: &&&str| {
        let own = rows.iter().filter(|row| row.method == **name).filter(rated);
        is_exact(name)
            && own.clone().next().is_some()
            && own.into_iter().all(|row| row.success[0] == 1.0)
    };
    let perfect: Vec<String> = names
        .iter()
        .filter(always)
        .map(|name| plain(name))
        .collect();
    let exact = names.iter().filter(|name| is_exact(name)).count();
    let title = match &perfect[..] {
        [] => format!("None of {exact} exact methods solves every random problem"),
        [one] => format!("Only {one} solves every random problem"),
        several => format!(
            "{} solve every random problem, {} exact methods do not",
            several.join(", "),
            exact - several.len()
        ),
    };
    let most = rows.iter().map(|row| row.problems).max().unwrap_or(0);
    let caption = format!(
        "solved, or (≈) own laws kept [%] of up to {most} random problems by friction coefficient {}; ≥: lower end of the 95 % \
         confidence interval; –: all problems declined",
        italic("μ")
    );
    let groups = columns
        .chunk_by(|a, b| a.0 == b.0)
        .map(|own| (format!("{}D", own[0].0), own.len()));
    let map = HeatMap {
        title,
        caption,
        groups: groups.collect(),
        columns: columns.iter().map(|(_, mu)| value(*mu)).collect(),
        rows: names.iter().map(line).collect(),
    };
    KIND.add(bundle, "", map.svg()?)
}
