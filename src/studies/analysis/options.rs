//! How much a method depends on one of its options: cells that differ in that option alone.
//!
//! A problem is solved where the method keeps its claim: exact methods solve the contact laws to the tolerance, others their
//! own laws. Of the problems those enter that every value was given, or their absence would count as a failure.
//!
//! ```text
//!   ratio(v)  = iterations(v) / iterations(default)       of a problem
//!   safe      = the widest range of tried values about the default at which every problem is solved
//!   fast      = the widest such range in which also ratio ≤ 2 for every problem
//! ```

use std::collections::BTreeMap;

use stickslip_methods::OptionSpec;

use super::{claims, compare_methods, compare_problems, problems};
use crate::run::choice::Choice;
use crate::studies::record::Record;
use crate::studies::statistics::median;

/// Iterations over those at the default up to which a value counts as fast.
pub const FAST: f64 = 2.0;

/// A method on some problems with several values of one of its options.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Method, other options that are not the default in brackets.
    pub method: String,
    /// Whether the limit of the method are the contact laws.
    pub exact: bool,
    /// Name of the option.
    pub option: &'static str,
    /// Its default.
    pub default: f64,
    /// Tolerance asked for.
    pub tolerance: f64,
    /// Problems that every value was given.
    pub problems: usize,
    /// The values, increasing.
    pub steps: Vec<Step>,
}

/// One value.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The value.
    pub value: f64,
    /// Problems solved.
    pub solved: usize,
    /// Most iterations of one increment of a problem solved; NaN without any.
    pub hardest: f64,
    /// Iterations over those at the default, of problems solved at both: median and largest; NaN without any.
    pub ratio: [f64; 2],
}

/// Ranges of an option about its default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Windows {
    /// Least and largest value tried.
    pub tried: [f64; 2],
    /// In which every problem is solved; none where the default does not.
    pub safe: Option<[f64; 2]>,
    /// Most iterations of one increment in there; NaN without.
    pub hardest: f64,
    /// In which iterations on no problem exceed [`FAST`] times those at the default, too.
    pub fast: Option<[f64; 2]>,
}

impl Sweep {
    /// The ranges; none where the default was not tried.
    pub fn windows(&self) -> Option<Windows> {
        let steps = &self.steps;
        let default = steps.iter().position(|s| s.value == self.default)?;
        let about = |good: &dyn Fn(&Step) -> bool| {
            let low = (0..=default)
                .rev()
                .take_while(|k| good(&steps[*k]))
                .last()?;
            let high = (default..steps.len())
                .take_while(|k| good(&steps[*k]))
                .last()?;
            Some([steps[low].value, steps[high].value])
        };
        let safe = |s: &Step| s.solved == self.problems;
        let range = about(&safe);
        let within = |s: &&Step| range.is_some_and(|[a, b]| (a..=b).contains(&s.value));
        let hardest = steps.iter().filter(within).map(|s| s.hardest);
        Some(Windows {
            tried: [steps.first()?.value, steps.last()?.value],
            safe: range,
            hardest: hardest.reduce(f64::max).unwrap_or(f64::NAN),
            fast: about(&|s| safe(s) && s.ratio[1] <= FAST),
        })
    }
}

/// All sweeps.
pub fn sweeps(records: &[Record]) -> Vec<Sweep> {
    let mut groups: BTreeMap<Key, (OptionSpec, Vec<Setting<'_>>)> = BTreeMap::new();
    for record in records {
        let Ok(choice) = Choice::parse(&record.asked.method) else {
            continue; // A method that this program does not know.
        };
        for (spec, value) in choice.options() {
            let key = Key {
                method: others(&choice, spec.name()),
                option: spec.name(),
                tolerance: record.asked.tolerance.to_bits(),
            };
            let setting = (value.number(), record);
            groups
                .entry(key)
                .or_insert((spec, Vec::new()))
                .1
                .push(setting);
        }
    }
    let of = |(key, (spec, own)): (&Key, &(OptionSpec, Vec<Setting<'_>>))| {
        sweep(key, (spec.default().number(), fewest(spec)), own)
    };
    let mut all: Vec<Sweep> = groups.iter().filter_map(of).collect();
    all.sort_by(|a, b| {
        let methods = compare_methods(&a.method, &b.method);
        methods.then(b.tolerance.total_cmp(&a.tolerance))
    });
    all
}

/// Common data of the cells of a sweep.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    method: String,
    option: &'static str,
    /// Bits: tolerances are positive.
    tolerance: u64,
}

/// A value of an option, and a cell that has it.
type Setting<'a> = (f64, &'a Record);

/// Label of a method without one of its options.
fn others(choice: &Choice, option: &str) -> String {
    let changed = choice.options().into_iter();
    let changed = changed.filter(|(spec, v)| spec.name() != option && *v != spec.default());
    let list: Vec<String> = changed
        .map(|(spec, v)| format!("{}={v:e}", spec.name()))
        .collect();
    if list.is_empty() {
        choice.name().to_owned()
    } else {
        format!("{}[{}]", choice.name(), list.join(","))
    }
}

/// How many values make a sweep: three, or all there are.
fn fewest(spec: &OptionSpec) -> usize {
    match spec {
        OptionSpec::Switch(_) => 2,
        OptionSpec::Whole(w) if w.max - w.min == 1 => 2,
        _ => 3,
    }
}

fn sweep(key: &Key, (default, fewest): (f64, usize), settings: &[Setting<'_>]) -> Option<Sweep> {
    let mut values: Vec<f64> = settings.iter().map(|s| s.0).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() < fewest {
        return None;
    }
    // Cells by problem and value.
    let all = problems(settings.iter().map(|s| s.1));
    let mut table: Vec<Vec<Option<&Record>>> = vec![vec![None; values.len()]; all.len()];
    for (value, record) in settings {
        let row = all.binary_search_by(|p| compare_problems(p, &record.asked));
        let row = row.ok()?;
        let column = values.binary_search_by(|v| v.total_cmp(value)).ok()?;
        table[row][column] = Some(record);
    }
    let rows = table.iter().filter_map(|row| row.iter().copied().collect());
    let rows: Vec<Vec<&Record>> = rows.collect();
    let first = rows.first()?.first()?;
    let place = values.iter().position(|v| *v == default);
    let step = |(column, value): (usize, &f64)| step(*value, &rows, column, place);
    Some(Sweep {
        method: key.method.clone(),
        exact: first.found.exact,
        option: key.option,
        default,
        tolerance: f64::from_bits(key.tolerance),
        problems: rows.len(),
        steps: values.iter().enumerate().map(step).collect(),
    })
}

fn is_solved(record: &Record) -> bool {
    record.is_honest() && claims(record)
}

fn iterations(record: &Record) -> f64 {
    record.found.sum(|i| i.iterations) as f64
}

/// One column of the cells by problem and value; `default`: the column of the default.
fn step(value: f64, rows: &[Vec<&Record>], column: usize, default: Option<usize>) -> Step {
    let solved = || rows.iter().filter(move |row| is_solved(row[column]));
    let ratio = |row: &Vec<&Record>| {
        let before = row[default?];
        // A problem without contact takes no iteration at any value.
        is_solved(before).then(|| iterations(row[column]).max(1.0) / iterations(before).max(1.0))
    };
    let ratios = || solved().filter_map(ratio);
    let each = solved().flat_map(|row| &row[column].found.increments);
    let hardest = each.map(|increment| increment.iterations as f64);
    Step {
        value,
        solved: solved().count(),
        hardest: hardest.reduce(f64::max).unwrap_or(f64::NAN),
        ratio: [
            median(ratios()),
            ratios().reduce(f64::max).unwrap_or(f64::NAN),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::support::{end_with, record};
    use super::*;

    fn cell(case: &str, method: &str, iterations: usize) -> Record {
        let mut cell = record(case, method, 1e-6);
        cell.found.increments[0].iterations = iterations;
        cell
    }

    /// Source: hand calculation. Two cases; at r = 100 one is lost, at r = 0.01 both take more than twice as long.
    #[test]
    fn windows_are_the_values_next_to_each_other_about_the_default() {
        let values = ["r=1e-3", "r=1e-2", "r=1e-1", "", "r=1e1", "r=1e2", "r=1e3"];
        let counts = [9, 30, 19, 10, 10, 10, 10];
        let mut records = Vec::new();
        for case in ["a", "b"] {
            for (value, count) in values.iter().zip(counts) {
                let method = format!("newton-ac:{value}");
                records.push(cell(case, method.trim_end_matches(':'), count));
            }
        }
        end_with(&mut records[5], "false-claim");
        let whole = |records: &[Record]| sweeps(records).swap_remove(0);
        let both = whole(&records);
        assert_eq!((both.problems, both.steps.len()), (2, 7));
        assert_eq!(both.steps[5].solved, 1);
        let windows = |sweep: &Sweep| {
            let own = sweep.windows().unwrap();
            (own.tried, own.safe, own.fast)
        };
        let (tried, lost) = ([1e-3, 1e3], Some([1e-3, 10.0]));
        // That r = 0.001 is fast and r = 1000 solves does not widen a range that is broken before.
        assert_eq!(windows(&both), (tried, lost, Some([0.1, 10.0])));
        let second = whole(&records[7..]);
        assert_eq!(windows(&second), (tried, Some(tried), Some([0.1, 1e3])));
        // Twice the iterations is fast, more is not.
        let ratios = [1, 2].map(|k| second.steps[k].ratio);
        assert_eq!(ratios, [[3.0; 2], [1.9; 2]]);
        end_with(&mut records[3], "gave-up: stalled");
        assert_eq!(whole(&records).windows().unwrap().safe, None);
    }

    #[test]
    fn problems_that_some_value_was_not_given_are_left_out() {
        let mut records: Vec<Record> = ["latin", "latin:relaxation=5e-1", "latin:relaxation=1e0"]
            .map(|method| cell("a", method, 10))
            .to_vec();
        records.extend([
            cell("b", "latin", 40),
            cell("b", "latin:relaxation=1e0", 40),
        ]);
        let all = sweeps(&records);
        let whole = &all[0];
        assert_eq!((whole.problems, all.len()), (1, 1));
        assert!(whole.steps.iter().all(|s| s.hardest == 10.0));
        // A switch has no more than two.
        let switch = ["b-newton", "b-newton:monolithic=1e0"].map(|m| cell("a", m, 10));
        assert_eq!(sweeps(&switch)[0].option, "monolithic");
    }

    #[test]
    fn other_options_tell_sweeps_apart_and_name_them() {
        let mut records = Vec::new();
        for cap in ["", "max_iterations=8.01e2,"] {
            for r in ["r=1e-1", "r=1e0", "r=1e1"] {
                records.push(cell("a", &format!("pdas:{cap}{r}"), 10));
            }
        }
        let names: Vec<(String, &str)> = (sweeps(&records).into_iter())
            .map(|s| (s.method, s.option))
            .collect();
        let expected = ["pdas", "pdas[max_iterations=8.01e2]"];
        assert_eq!(names, expected.map(|name| (name.to_owned(), "r")));
    }
}
