//! Success and iterations over the options of methods.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::{fixed, significant};
use crate::report::plot::{Cell, HeatMap, base, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::options::{Step, Sweep};

/// The kind.
pub static KIND: Kind = Kind {
    file: "options.svg",
    question: "What does a parameter of a method change?",
    shows: "Iterations over those at the default, in the median over the problems, by method, option and value over the \
            default; in per cent the problems solved, where these are not all. Options without positive values have their \
            table.",
};

/// Iterations over those at the default with the full tint.
const MOST: f64 = 100.0;

/// Adds the figure, where values of some option were tried; `caveat`: what the caption says of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, sweeps: &[Sweep], caveat: &str) -> Result<(), ReportError> {
    let drawn = |sweep: &&Sweep| sweep.default > 0.0 && sweep.steps[0].value > 0.0;
    let drawn: Vec<&Sweep> = sweeps.iter().filter(drawn).collect();
    let factors = drawn.iter().flat_map(|sweep| {
        let of = |step: &Step| factor(sweep, step);
        sweep.steps.iter().map(of)
    });
    let mut factors = distinct(factors);
    factors.sort_by(f64::total_cmp);
    let row = |sweep: &&Sweep| {
        let of = |x: &f64| sweep.steps.iter().find(|step| factor(sweep, step) == *x);
        let cells = factors.iter().map(|x| cell(sweep, of(x)));
        (name(sweep), cells.collect())
    };
    let lost = drawn.iter().filter(|sweep| {
        let mut steps = sweep.steps.iter();
        steps.any(|step| step.solved < sweep.problems)
    });
    let lost = distinct(lost.map(|sweep| plain(base(&sweep.method))));
    let title = if lost.is_empty() {
        "No value that was tried costs a method a problem".to_owned()
    } else {
        format!("At some value problems are lost by {}", lost.join(", "))
    };
    let map = HeatMap {
        title,
        caption: format!(
            "iterations over those at the default, median over the problems solved; in per cent: problems solved, where not \
             all are{caveat}"
        ),
        groups: vec![("value of the option over its default".into(), factors.len())],
        columns: factors.iter().map(|x| format!("{x:e}")).collect(),
        rows: drawn.iter().map(row).collect(),
    };
    KIND.add(bundle, "", map.svg()?)
}

/// A value over the default, rounded: powers of ten in different units are one column.
fn factor(sweep: &Sweep, step: &Step) -> f64 {
    let digits = format!("{:.2e}", step.value / sweep.default);
    digits.parse().unwrap_or(f64::NAN)
}

fn name(sweep: &Sweep) -> String {
    let (method, option) = (base(&sweep.method), sweep.option);
    plain(&format!("{method}, {option}, {:e}", sweep.tolerance))
}

fn cell(sweep: &Sweep, step: Option<&Step>) -> Cell {
    let below = String::new();
    let Some(step) = step else {
        return Cell {
            tint: f64::NAN,
            text: String::new(),
            below,
        };
    };
    let share = step.solved as f64 / sweep.problems as f64;
    let ratio = step.ratio[0];
    let (tint, text) = if share < 1.0 {
        (1.0, format!("{} %", fixed((100.0 * share).floor(), 0)))
    } else {
        (ratio.ln() / MOST.ln() * 0.6, significant(ratio, 2))
    };
    Cell {
        tint: tint.clamp(0.0, 1.0),
        text,
        below,
    }
}
