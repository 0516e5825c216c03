//! How much methods depend on their options: every value, and the safe windows with a sentence each.

use super::words::METHOD;
use crate::report::number;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::analysis::sensitivity::{FAST, Step, Sweep, Windows};

/// A value as it is read: powers of ten where digits would have to be counted.
fn value(x: f64) -> String {
    match x == 0.0 || (1e-3..1e4).contains(&x.abs()) {
        true => number::value(x),
        false => format!("{x:e}"),
    }
}

/// A value of an option on a class of problems.
pub struct SensitivityRow<'a> {
    sweep: &'a Sweep,
    step: &'a Step,
}

impl<'a> SensitivityRow<'a> {
    /// Those of a sweep.
    pub fn of(sweep: &'a Sweep) -> impl Iterator<Item = Self> {
        sweep.steps.iter().map(move |step| Self { sweep, step })
    }

    fn share(&self) -> f64 {
        self.step.solved as f64 / self.sweep.problems as f64
    }
}

const CLASS: &str = "case, or seeded suite of problems; `all`: all problems of the method";
const OTHERS: &str = "method, other options than this one that are not the default in brackets";
const OPTION: &str = "name of the option, see methods.md";
const TOLERANCE: &str =
    "violation of the contact laws asked of the method and accepted by the judge";
const SOLVED: &str =
    "problems solved: the contact laws to the tolerance, by methods with laws of their own these";
const PROBLEMS: &str = "problems that every value was given";

fn class(sweep: &Sweep) -> &str {
    sweep.class.as_deref().unwrap_or("all")
}

impl Row for SensitivityRow<'_> {
    const NAME: &'static str = "sensitivity";
    const TITLE: &'static str =
        "Options of methods, value by value: how many problems are solved, in how many iterations";
    const QUESTION: &'static str = "What does a parameter of a method change?";
    const NOTES: &'static str = "Cells of a method that differ in one option alone, with at least three values of it (of a switch, two).";
    // They come by method, option, class and value.
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "class" "" .named("problems of") = class(r.sweep), CLASS;
            "method" "" .shown() = r.sweep.method.clone(), OTHERS;
            "option" "" .shown() = r.sweep.option, OPTION;
            "value" "–" .shown() = r.step.value, "its value";
            "is_default" "" = r.step.value == r.sweep.default, "whether that is the default";
            "tolerance" "–" .shown() = r.sweep.tolerance, TOLERANCE;
            "problems" "" .shown() = r.sweep.problems, PROBLEMS;
            "left_out" "" = r.sweep.left_out, "problems that some value was not given";
            "solved" "" .shown() = r.step.solved, SOLVED;
            "share" "–" .significant(4).named("solved").percent(1) = r.share(), "solved / problems";
            "false_claims" "" .named("false claims") = r.step.false_claims, "claims that the judge refuted";
            "iterations" "" .named("iterations").digits(4) = r.step.iterations, "of the whole path, median over the problems solved";
            "most_iterations" "" .named("most").digits(6) = r.step.most, "most on a problem solved";
            "most_increment" "" = r.step.hardest, "most in one increment of a problem solved";
            "ratio" "–" .significant(4).named("over those at the default").digits(3) = r.step.ratio[0], "iterations over those at the default, median over the problems solved at both; `NaN` where the default was not tried";
            "most_ratio" "–" .significant(4).named("most").digits(3) = r.step.ratio[1], "largest such ratio";
            "spent" "" = r.step.spent, "iterations on the problems not solved, median; `NaN` without any";
            "violation" "–" .residual() = r.step.violation, "largest violation of the contact laws on a problem solved";
        }
    }
}

/// The safe windows of an option.
pub struct WindowRow<'a> {
    sweep: &'a Sweep,
    windows: Windows,
}

impl<'a> WindowRow<'a> {
    /// Those of a method on all of its problems; none where the default was not tried.
    pub fn of(sweeps: &'a [Sweep]) -> Vec<Self> {
        let whole = |sweep: &&Sweep| {
            let same = |o: &&Sweep| o.method == sweep.method && o.option == sweep.option;
            let alike = |o: &&Sweep| same(o) && o.tolerance == sweep.tolerance;
            sweep.class.is_none() || sweeps.iter().filter(alike).count() == 1
        };
        let row = |sweep: &'a Sweep| Sweep::windows(sweep).map(|windows| Self { sweep, windows });
        sweeps.iter().filter(whole).filter_map(row).collect()
    }

    /// Whether every value tried solves every problem.
    pub fn is_safe_throughout(&self) -> bool {
        self.windows.safe == Some(self.windows.tried)
    }

    /// Name of the method.
    pub fn method(&self) -> &str {
        &self.sweep.method
    }

    /// What a paper would print.
    pub fn sentence(&self) -> String {
        let Sweep {
            method,
            option,
            default,
            problems,
            ..
        } = self.sweep;
        let Windows {
            tried, safe, fast, ..
        } = self.windows;
        let what = match (self.sweep.exact, problems) {
            (true, 1) => format!("the problem to {:e}", self.sweep.tolerance),
            (true, n) => format!("all {n} problems to {:e}", self.sweep.tolerance),
            (false, n) => format!("its own laws on all {n} problems"),
        };
        let from_to = |[a, b]: [f64; 2]| format!("from {} to {}", value(a), value(b));
        let Some(range) = safe else {
            let solved = |s: &&Step| s.value == *default;
            let solved = self.sweep.steps.iter().find(solved).map_or(0, |s| s.solved);
            let best = self.sweep.steps.iter().rev().max_by_key(|s| s.solved);
            let best = best.map_or(String::new(), |s| {
                format!("; most, {}, at {}", s.solved, value(s.value))
            });
            return format!(
                "{method}: {option} = {}, the default, solves {solved} of {problems} problems{best}",
                value(*default)
            );
        };
        let safe = match range {
            [a, b] if a == b => format!("only {option} = {}, the default, solves {what}", value(a)),
            _ => format!("any {option} {} solves {what}", from_to(range)),
        };
        let tried = match range == tried {
            true => String::new(),
            false => format!(" (tried: {})", from_to(tried)),
        };
        let fast = match fast {
            Some(own) if own == range && range[0] < range[1] => {
                format!(
                    "; iterations on each stay within a factor {FAST} of the default's throughout"
                )
            }
            Some([a, b]) if a < b => format!(
                "; iterations on each stay within a factor {FAST} of the default's {}",
                from_to([a, b])
            ),
            _ if range[0] < range[1] => {
                "; beside the default iterations on some more than double".to_owned()
            }
            _ => String::new(),
        };
        format!("{method}: {safe}{tried}{fast}")
    }
}

fn end(range: Option<[f64; 2]>, which: usize) -> f64 {
    range.map_or(f64::NAN, |ends| ends[which])
}

impl Row for WindowRow<'_> {
    const NAME: &'static str = "safe_windows";
    const TITLE: &'static str = "Safe windows of the options of methods: the widest ranges of tried values about the default in which every problem is solved, and in which iterations on no problem exceed twice those at the default";
    const QUESTION: &'static str = "How wrong may a parameter of a method be on these problems?";
    const NOTES: &'static str =
        "Read off `sensitivity.csv`, over all problems that every value was given.";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "method" "" .shown() = r.sweep.method.clone(), METHOD;
            "option" "" .shown() = r.sweep.option, OPTION;
            "default" "–" .shown() = r.sweep.default, "its default";
            "tolerance" "–" .shown() = r.sweep.tolerance, TOLERANCE;
            "problems" "" .shown() = r.sweep.problems, PROBLEMS;
            "safe_from" "–" .named("safe from") = end(r.windows.safe, 0), "every problem is solved from this value on; `NaN` where the default does not solve them all";
            "safe_to" "–" .named("to") = end(r.windows.safe, 1), "up to this one";
            "most_increment" "" .named("most per increment") = r.windows.hardest, "most iterations of one increment at any value between them";
            "fast_from" "–" .named("fast from") = end(r.windows.fast, 0), "and on no problem iterations exceed twice those at the default from this value on";
            "fast_to" "–" .named("to") = end(r.windows.fast, 1), "up to this one";
            "tried_from" "–" .named("tried from") = r.windows.tried[0], "least value tried";
            "tried_to" "–" .named("to") = r.windows.tried[1], "largest";
            "sentence" "" = r.sentence(), "the same in words";
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::analysis::sensitivity::sweeps;
    use crate::studies::analysis::support::{end_with, record};
    use crate::studies::record::Record;

    fn cell(method: &str, iterations: usize, solved: bool) -> Record {
        let mut cell = record("plate", method, 1e-6);
        cell.found.increments[0].iterations = iterations;
        if !solved {
            end_with(&mut cell, "gave-up: max-iterations");
        }
        cell
    }

    /// Goal: what a paper would print, word by word, of a wide, a narrow and no window.
    #[test]
    fn sentences_say_windows() {
        let sentence = |cells: &[Record]| {
            let sweeps = sweeps(cells);
            let rows = WindowRow::of(&sweeps);
            assert_eq!(rows.len(), 1);
            rows[0].sentence()
        };
        let mut cells = vec![
            cell("newton-ac:r=1e-1", 30, true),
            cell("newton-ac", 10, true),
            cell("newton-ac:r=1e1", 20, true),
        ];
        assert_eq!(
            sentence(&cells),
            "newton-ac: any r from 0.1 to 10 solves the problem to 1e-6; iterations on each stay within a factor 2 of the \
             default's from 1 to 10"
        );
        end_with(&mut cells[0], "gave-up: stalled");
        end_with(&mut cells[2], "false-claim");
        assert_eq!(
            sentence(&cells),
            "newton-ac: only r = 1, the default, solves the problem to 1e-6 (tried: from 0.1 to 10)"
        );
        cells[2] = cell("newton-ac:r=1e1", 20, true);
        cells[1] = cell("newton-ac", 10, false);
        assert_eq!(
            sentence(&cells),
            "newton-ac: r = 1, the default, solves 0 of 1 problems; most, 1, at 10"
        );
    }
}
