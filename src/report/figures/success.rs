//! Success rates of the methods by class of problems.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::fixed;
use crate::report::plot::{Cell, HeatMap, is_exact, plain, rank};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::success::{BY_FRICTION, SuccessRow};

/// The kind.
pub static KIND: Kind = Kind {
    file: "success.svg",
    question: "Which method can be relied on for which problems?",
    shows: "Percentage of the problems of a class solved, or (≈, approximate methods) of own laws kept, by method, at the finest \
            tier asked for; below it the lower end of the 95 % confidence interval.",
};

/// Rate with the full tint [%]: what lies below does not differ in use.
const WORST: f64 = 50.0;

/// The figure, where problems have classes.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[SuccessRow], caveat: &str) -> Result<(), ReportError> {
    let of_classes = || {
        rows.iter()
            .filter(|row| !row.class.is_empty() && row.defaults)
    };
    let tolerance = of_classes()
        .map(|row| row.tier.tolerance())
        .fold(1.0, f64::min);
    let rated: Vec<&SuccessRow> = of_classes()
        .filter(|row| row.tier.tolerance() == tolerance)
        .collect();
    let Some(most) = rated.iter().map(|row| row.cells).max() else {
        return Ok(());
    };
    let mut names = distinct(rated.iter().map(|row| row.method.as_str()));
    names.sort_by_key(|name| (rank(name), *name));
    let mut classes = distinct(rated.iter().map(|row| row.class.as_str()));
    classes.sort_unstable();
    // 99.96 % is not 100.
    let percent = |rate: f64| {
        let percent = (1e3 * rate).floor() / 10.0;
        fixed(percent, usize::from(percent.fract() != 0.0))
    };
    let cell = |name: &str, class: &str| {
        let own = rated
            .iter()
            .find(|row| row.method == name && row.class == class);
        let [rate, low, _] = own.map_or([f64::NAN; 3], |row| row.kept());
        let (text, below) = if rate.is_finite() {
            (percent(rate), format!("≥{}", percent(low)))
        } else {
            ("–".into(), String::new())
        };
        let tint = 100.0 * (1.0 - rate) / (100.0 - WORST);
        Cell { tint, text, below }
    };
    let line = |name: &&str| {
        let sign = if is_exact(name) { "" } else { "≈ " };
        let cells = classes.iter().map(|class| cell(name, class));
        (format!("{sign}{}", plain(name)), cells.collect())
    };
    let fails = |name: &str| {
        let mut own = rated.iter().filter(|row| row.method == name);
        own.any(|row| row.kept()[0] < 1.0)
    };
    let exact = names.iter().filter(|name| is_exact(name));
    let (failing, perfect): (Vec<&str>, Vec<&str>) = exact.partition(|name| fails(name));
    let perfect: Vec<String> = perfect.into_iter().map(plain).collect();
    let others = failing.len();
    let title = if perfect.is_empty() {
        format!("None of {others} exact methods solves every problem")
    } else {
        format!(
            "Every problem is solved by {}, not by {others} others",
            perfect.join(", ")
        )
    };
    // Friction coefficients of a class stand side by side below its name.
    let parts = |class: &&str| match class.split_once(BY_FRICTION) {
        Some((class, mu)) => (class.to_owned(), format!("μ {mu}")),
        None => (String::new(), (*class).to_owned()),
    };
    let groups = classes.chunk_by(|a, b| parts(a).0 == parts(b).0);
    let map = HeatMap {
        title,
        caption: format!(
            "solved, or (≈) own laws kept [%] of up to {most} problems by class; ≥: lower end of the 95 % confidence \
             interval{caveat}"
        ),
        groups: groups.map(|own| (parts(&own[0]).0, own.len())).collect(),
        columns: classes.iter().map(|own| parts(own).1).collect(),
        rows: names.iter().map(line).collect(),
    };
    KIND.add(bundle, "", map.svg()?)
}
