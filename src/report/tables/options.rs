//! How wrong options of methods may be.

use super::words::METHOD;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::analysis::options::{Sweep, Windows};

/// The ranges of an option.
pub struct OptionRow<'a> {
    sweep: &'a Sweep,
    windows: Windows,
}

impl<'a> OptionRow<'a> {
    /// Those of all sweeps whose default was tried.
    pub fn of(sweeps: &'a [Sweep]) -> Vec<Self> {
        let row = |sweep: &'a Sweep| {
            let windows = sweep.windows()?;
            Some(Self { sweep, windows })
        };
        sweeps.iter().filter_map(row).collect()
    }
}

fn end(range: Option<[f64; 2]>, which: usize) -> f64 {
    range.map_or(f64::NAN, |ends| ends[which])
}

impl Row for OptionRow<'_> {
    const NAME: &'static str = "options";
    const PRINTED: bool = true;
    const TITLE: &'static str = "Ranges of tried values of an option about its default in which every problem is solved (safe), and in which iterations on no problem exceed twice those at the default (fast)";
    const QUESTION: &'static str = "How wrong may a parameter of a method be on these problems?";
    const NOTES: &'static str = "Of runs of a method that differ in one option alone, with at least three values of it (of a switch, two), on the problems that every value was given. Solved: the contact laws hold to the tolerance, of methods with laws of their own these.";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "method" "" .shown() = r.sweep.method.clone(), METHOD;
            "option" "" .shown() = r.sweep.option, "name of the option, see `stickslip show METHOD`";
            "default" "–" .shown() = r.sweep.default, "its default";
            "tolerance" "–" .shown() = r.sweep.tolerance, "violation of the contact laws asked of the method and accepted by the judge";
            "problems" "" .shown() = r.sweep.problems, "problems that every value was given";
            "safe_from" "–" .named("safe from") = end(r.windows.safe, 0), "every problem is solved from this value on; `NaN` where the default does not solve them all";
            "safe_to" "–" .named("to") = end(r.windows.safe, 1), "up to this one";
            "most_increment" "" .named("most per increment") = r.windows.hardest, "most iterations of one increment at any value between them";
            "fast_from" "–" .named("fast from") = end(r.windows.fast, 0), "and on no problem iterations exceed twice those at the default from this value on";
            "fast_to" "–" .named("to") = end(r.windows.fast, 1), "up to this one";
            "tried_from" "–" .named("tried from") = r.windows.tried[0], "least value tried";
            "tried_to" "–" .named("to") = r.windows.tried[1], "largest";
        }
    }
}
