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

use std::collections::{BTreeMap, BTreeSet};

use stickslip_methods::OptionSpec;

use super::{claims, compare_methods, compare_problems, problems};
use crate::run::choice::Choice;
use crate::run::verdict::Verdict;
use crate::studies::record::Record;
use crate::studies::statistics::{larger, median};

/// Iterations over those at the default up to which a value counts as fast.
pub const FAST: f64 = 2.0;

/// A method on some problems with several values of one of its options.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Case, or seeded suite of problems; none: all problems of the method.
    pub class: Option<String>,
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
    /// Problems that some value was not given.
    pub left_out: usize,
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
    /// Claims that the judge refuted.
    pub false_claims: usize,
    /// Median of the iterations over the problems solved; NaN without any.
    pub iterations: f64,
    /// Most iterations on a problem solved; NaN without any.
    pub most: f64,
    /// Most iterations of one increment of a problem solved; NaN without any.
    pub hardest: f64,
    /// Median of the iterations over the problems not solved; NaN without any.
    pub spent: f64,
    /// Iterations over those at the default, of problems solved at both: median and largest; NaN without any.
    pub ratio: [f64; 2],
    /// Largest violation of the contact laws on a problem solved; NaN without any.
    pub violation: f64,
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

/// All sweeps: those of every class of problems, and before them where there are several that of all problems.
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
    let mut all = Vec::new();
    for (key, (spec, own)) in &groups {
        let classes: BTreeSet<&str> = own.iter().map(|(_, r)| class(&r.asked.case)).collect();
        let several = classes.len() > 1;
        let of = |class, own: &[Setting<'_>]| {
            let known = (spec.default().number(), fewest(spec));
            sweep(key, known, class, own)
        };
        let whole = several.then(|| of(None, own)).flatten();
        all.extend(whole);
        for name in classes {
            let of_class = |s: &&Setting<'_>| class(&s.1.asked.case) == name;
            let own: Vec<Setting<'_>> = own.iter().filter(of_class).copied().collect();
            all.extend(of(Some(name), &own));
        }
    }
    all.sort_by(|a, b| {
        let methods = compare_methods(&a.method, &b.method);
        methods.then(b.tolerance.total_cmp(&a.tolerance))
    });
    all
}

/// What the cells of a sweep share.
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
    match list.is_empty() {
        true => choice.name().to_owned(),
        false => format!("{}[{}]", choice.name(), list.join(",")),
    }
}

/// The suite that a problem with a seed and a number belongs to, or the case itself.
pub fn class(case: &str) -> &str {
    match case.rsplit_once('-') {
        Some((suite, number))
            if suite.contains("-seed-") && number.chars().all(|c| c.is_ascii_digit()) =>
        {
            suite
        }
        _ => case,
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

fn sweep(
    key: &Key,
    (default, fewest): (f64, usize),
    class: Option<&str>,
    settings: &[Setting<'_>],
) -> Option<Sweep> {
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
        class: class.map(str::to_owned),
        method: key.method.clone(),
        exact: first.found.exact,
        option: key.option,
        default,
        tolerance: f64::from_bits(key.tolerance),
        problems: rows.len(),
        left_out: all.len() - rows.len(),
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
    let counts = || solved().map(move |row| iterations(row[column]));
    let ratio = |row: &Vec<&Record>| {
        let before = row[default?];
        // A problem without contact takes no iteration at any value.
        is_solved(before).then(|| iterations(row[column]).max(1.0) / iterations(before).max(1.0))
    };
    let ratios = || solved().filter_map(ratio);
    let lost = rows.iter().filter(|row| !is_solved(row[column]));
    let lost = lost.map(|row| iterations(row[column]));
    let wrong = |row: &&Vec<&Record>| row[column].found.verdict == Verdict::FalseClaim;
    let each = solved().flat_map(|row| &row[column].found.increments);
    let hardest = each.map(|increment| increment.iterations as f64);
    let violations = solved().map(|row| row[column].found.violation());
    Step {
        value,
        solved: solved().count(),
        false_claims: rows.iter().filter(wrong).count(),
        iterations: median(counts()),
        most: counts().reduce(f64::max).unwrap_or(f64::NAN),
        hardest: hardest.reduce(f64::max).unwrap_or(f64::NAN),
        spent: median(lost),
        ratio: [
            median(ratios()),
            ratios().reduce(f64::max).unwrap_or(f64::NAN),
        ],
        violation: violations.reduce(larger).unwrap_or(f64::NAN),
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
        let all = sweeps(&records);
        let classes: Vec<Option<&str>> = all.iter().map(|s| s.class.as_deref()).collect();
        assert_eq!(classes, [None, Some("a"), Some("b")]);
        let [whole, a, b] = &all[..] else { panic!() };
        assert_eq!(
            (whole.problems, whole.left_out, whole.steps.len()),
            (2, 0, 7)
        );
        assert_eq!(whole.steps[5].solved, 1);
        let wrong: Vec<usize> = whole.steps.iter().map(|s| s.false_claims).collect();
        assert_eq!(wrong, [0, 0, 0, 0, 0, 1, 0]);
        let windows = |sweep: &Sweep| {
            let own = sweep.windows().unwrap();
            (own.tried, own.safe, own.fast)
        };
        let (tried, lost) = ([1e-3, 1e3], Some([1e-3, 10.0]));
        // That r = 0.001 is fast and r = 1000 solves does not widen a range that is broken before.
        assert_eq!(windows(whole), (tried, lost, Some([0.1, 10.0])));
        assert_eq!(windows(a), (tried, lost, Some([0.1, 10.0])));
        assert_eq!(windows(b), (tried, Some(tried), Some([0.1, 1e3])));
        // Twice the iterations is fast, more is not.
        assert_eq!((b.steps[1].ratio, b.steps[2].ratio), ([3.0; 2], [1.9; 2]));
        end_with(&mut records[3], "gave-up: stalled");
        assert_eq!(sweeps(&records)[0].windows().unwrap().safe, None);
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
        assert_eq!((whole.problems, whole.left_out), (1, 1));
        assert!(whole.steps.iter().all(|s| s.iterations == 10.0));
        // Two values are no sweep of b.
        assert_eq!(all.len(), 2);
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

    #[test]
    fn numbered_problems_of_a_seed_are_one_class() {
        for (case, expected) in [
            ("random-2d-seed-1-003", "random-2d-seed-1"),
            ("bodies-3d-00100-seed-1-4", "bodies-3d-00100-seed-1"),
            ("plate_mesh1", "plate_mesh1"),
            ("plate-2", "plate-2"),
        ] {
            assert_eq!(class(case), expected);
        }
    }
}
