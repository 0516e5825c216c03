//! Iterations and success over the options of methods.

use super::kind::Kind;
use super::runs::{counted, distinct};
use crate::report::number::fixed;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, base, looks, plain};
use crate::report::tables::sensitivity::WindowRow;
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::sensitivity::{Step, Sweep};

/// What it is.
pub static KIND: Kind = Kind {
    file: "sensitivity.svg",
    question: "How do iterations and success depend on the parameter of a method?",
    shows: "Median iterations over an option of the methods, a multiple of its natural scale, by class of problems; hollow, \
            with the share that is solved: values at which not every problem is. Classes that a single method was put to have \
            their table, where others compare methods.",
};

/// Least ratio of the ends of a range that is drawn: switches and counts have their table.
const WIDEST: f64 = 99.0;

/// Sweeps in one panel: problems of a class at one tolerance, no curve twice.
struct Group<'a> {
    class: &'a str,
    tolerance: f64,
    sweeps: Vec<&'a Sweep>,
}

/// Those of all sweeps that are drawn: over two decades at least, of positive values.
fn groups(sweeps: &[Sweep]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for sweep in sweeps {
        let values = || sweep.steps.iter().map(|s| s.value);
        let low = values().fold(f64::INFINITY, f64::min);
        let wide = low > 0.0 && values().fold(0.0, f64::max) >= WIDEST * low;
        let (Some(class), true) = (&sweep.class, wide && sweep.problems > 0) else {
            continue;
        };
        let tolerance = sweep.tolerance;
        let fits = |group: &&mut Group<'_>| {
            let here = group.class == class && group.tolerance == tolerance;
            here && group.sweeps.iter().all(|o| curve(o) != curve(sweep))
        };
        match groups.iter_mut().find(fits) {
            Some(group) => group.sweeps.push(sweep),
            None => groups.push(Group {
                class,
                tolerance,
                sweeps: vec![sweep],
            }),
        }
    }
    // A curve alone compares nothing; it has its table.
    if groups.iter().any(|group| group.sweeps.len() > 1) {
        groups.retain(|group| group.sweeps.len() > 1);
    }
    // The classes at a tolerance next to each other.
    groups.sort_by(|a, b| b.tolerance.total_cmp(&a.tolerance));
    groups
}

/// Method and option.
fn curve(sweep: &Sweep) -> String {
    format!("{}[{}]", base(&sweep.method), sweep.option)
}

/// Adds the figure, where some option was swept over two decades; `caveat`: what the caption says of a sweep that is not
/// complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, sweeps: &[Sweep], caveat: &str) -> Result<(), ReportError> {
    let groups = groups(sweeps);
    let tolerances = distinct(groups.iter().map(|g| g.tolerance)).len();
    let all = groups.iter().flat_map(|g| &g.sweeps);
    let names = distinct(all.map(|sweep| curve(sweep)));
    let labels: Vec<&str> = names.iter().map(String::as_str).collect();
    let looks = looks(&labels, &labels);
    let look = |sweep: &Sweep| {
        let at = names.iter().position(|name| *name == curve(sweep));
        at.and_then(|at| looks.get(at))
    };
    let panel = |group: &Group<'_>| {
        let mut heading = vec![group.class.to_owned()];
        if tolerances > 1 {
            heading.push(format!("to {:e}", group.tolerance));
        }
        let problems = group.sweeps.iter().map(|s| s.problems).max();
        heading.push(counted(problems.unwrap_or(0), "problem"));
        let x = Axis::log("value of the option [-]");
        let mut panel = Panel::new(x, Axis::log("iterations [-]"), 40.0);
        panel.heading = plain(&heading.join(", "));
        let own = group.sweeps.iter();
        let own = own.filter_map(|sweep| Some(line(sweep, look(sweep)?)));
        panel.series = own.collect();
        panel
    };
    let caption = format!(
        "median iterations over the problems solved; hollow, with their share: not all are, and where none is, iterations \
         spent; the option, in brackets, is a multiple of its natural scale{caveat}"
    );
    let panels = groups.iter().map(panel).collect();
    let figure = Figure::new(&title(sweeps), &caption, 3, panels);
    KIND.add(bundle, "", figure.svg()?)
}

/// The curve of a method.
fn line(sweep: &Sweep, (label, style): &(String, Style)) -> Series {
    let count = |s: &Step| match s.solved {
        0 => s.spent,
        _ => s.iterations,
    };
    let all = |s: &Step| s.solved == sweep.problems;
    let steps = || sweep.steps.iter();
    // What takes no iteration has its place at one.
    let points = steps().map(|s| [s.value, count(s).max(1.0)]).collect();
    let mut series = Series::new(label.clone(), style.clone(), points);
    let mark = |s: &Step| style.marker.map(|marker| (marker, style.filled && all(s)));
    series.marks = steps().map(mark).collect();
    let share = |s: &Step| 100.0 * s.solved as f64 / sweep.problems as f64;
    let text = |s: &Step| match all(s) {
        true => String::new(),
        false => format!("{} %", fixed(share(s).floor(), 0)),
    };
    series.texts = steps().map(text).collect();
    series
}

/// The sentence: who does not care, and who does.
fn title(sweeps: &[Sweep]) -> String {
    let rows = WindowRow::of(sweeps);
    let (safe, lost): (Vec<&WindowRow<'_>>, Vec<&WindowRow<'_>>) =
        rows.iter().partition(|row| row.is_safe_throughout());
    let names = |rows: &[&WindowRow<'_>]| distinct(rows.iter().map(|r| plain(base(r.method()))));
    let lost = names(&lost);
    let mut safe = names(&safe);
    safe.retain(|name| !lost.contains(name));
    match (safe.is_empty(), lost.is_empty()) {
        (true, true) => "Iterations over the options of methods".to_owned(),
        (true, false) => "Every method loses problems at some value of its option".to_owned(),
        (false, true) => "No value of an option that was tried costs a method a problem".to_owned(),
        (false, false) => format!(
            "Solved at every value tried by {}; {} have a window",
            safe.join(", "),
            lost.join(", ")
        ),
    }
}
