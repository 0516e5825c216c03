//! Two sets of records beside each other: what changed beyond noise.
//!
//! ```text
//!   ℓ_i = ln(t_i^B / t_i^A)     drift = median ℓ     noise = 1.4826 median |ℓ − drift|
//! ```
//!
//! The drift is what the machine did to all cells alike; the time of a cell changed if the intervals of the two medians, the
//! drift taken out, are disjoint and |ℓ − drift| > max(3 noise, ln 1.1). 1.4826 makes the median absolute deviation that of
//! a normal distribution. Times of different machines or build profiles are not compared.
//!
//! Reference: P. J. Rousseeuw, C. Croux, J. Am. Stat. Assoc. 88 (1993) 1273.

use std::collections::BTreeMap;

use super::analysis::{method_time, published_times};
use super::record::{IncrementFound, Record};
use super::statistics::{Timing, median};
use crate::case::named;

/// Change of a solver error that is told, relative.
const ERROR_CHANGE: f64 = 0.01;
/// Solver errors below are round-off.
const ROUND_OFF: f64 = 1e-12;
/// Least change of a time that is told, as a ratio.
const TIME_CHANGE: f64 = 1.1;
/// Median absolute deviation to standard deviation, of a normal distribution.
const NORMAL: f64 = 1.4826;

named! {
    /// Which way something went, from A to B.
    pub enum Direction {
        /// B is better.
        Better = "better",
        /// B is worse.
        Worse = "worse",
        /// Neither.
        Other = "other",
    }
}

/// What of a cell changed.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// The cell is in A alone.
    OnlyA,
    /// The cell is in B alone.
    OnlyB,
    /// The verdict.
    Verdict,
    /// A counter, summed over the increments.
    Counter(&'static str),
    /// The solver error by more than 1 %.
    SolverError,
    /// Something in what was found, and none of the above: not the same bits.
    Bits,
    /// The time of the method, beyond drift and noise.
    Time,
}

impl What {
    /// Name in tables.
    pub fn name(&self) -> &'static str {
        match self {
            What::OnlyA => "only in A",
            What::OnlyB => "only in B",
            What::Verdict => "verdict",
            What::Counter(name) => name,
            What::SolverError => "solver_error",
            What::Bits => "bits",
            What::Time => "time",
        }
    }
}

/// One change of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Id of the cell.
    pub id: String,
    /// What changed.
    pub what: What,
    /// Which way.
    pub direction: Direction,
    /// In A, as text; empty where there is none.
    pub a: String,
    /// In B.
    pub b: String,
    /// B over A; of times with the drift taken out; NaN where there is no ratio.
    pub ratio: f64,
}

/// Two sets of records beside each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Changes by id.
    pub changes: Vec<Change>,
    /// Cells in both.
    pub common: usize,
    /// Of these, cells whose found part is the same bit by bit.
    pub identical: usize,
    /// Of these, cells whose times can be compared.
    pub timed: usize,
    /// Median log ratio of the times; NaN without any.
    pub drift: f64,
    /// Spread of the log ratios about it; NaN without any.
    pub noise: f64,
}

impl Comparison {
    /// Whether a verdict got worse.
    pub fn worse(&self) -> bool {
        let mut verdicts = self.changes.iter().filter(|c| c.what == What::Verdict);
        verdicts.any(|change| change.direction == Direction::Worse)
    }
}

impl Change {
    fn new(record: &Record, what: What, direction: Direction, texts: [String; 2]) -> Self {
        let [a, b] = texts;
        Self {
            id: record.id.clone(),
            what,
            direction,
            a,
            b,
            ratio: f64::NAN,
        }
    }
}

/// Compares `b` with `a`, cell by cell.
pub fn compare(a: &[Record], b: &[Record]) -> Comparison {
    fn by_id(records: &[Record]) -> BTreeMap<&str, &Record> {
        records.iter().map(|r| (r.id.as_str(), r)).collect()
    }
    let (a, b) = (by_id(a), by_id(b));
    let pairs: Vec<[&Record; 2]> = (a.iter())
        .filter_map(|(id, record)| Some([*record, *b.get(id)?]))
        .collect();
    let mut changes = Vec::new();
    for (own, other, what) in [(&a, &b, What::OnlyA), (&b, &a, What::OnlyB)] {
        for (_, record) in own.iter().filter(|(id, _)| !other.contains_key(*id)) {
            let mut texts = [record.found.verdict.to_string(), String::new()];
            if what == What::OnlyB {
                texts.reverse();
            }
            changes.push(Change::new(record, what.clone(), Direction::Other, texts));
        }
    }
    let mut identical = 0;
    for [a, b] in &pairs {
        let found = found_changes([a, b]);
        if a.found.same_bits(&b.found) {
            identical += 1;
        } else if found.is_empty() {
            let texts = [String::new(), String::new()];
            changes.push(Change::new(a, What::Bits, Direction::Other, texts));
        }
        changes.extend(found);
    }
    let timed: Vec<Timed> = pairs.iter().filter_map(|pair| Timed::of(*pair)).collect();
    let [drift, noise] = drift_and_noise(&timed);
    changes.extend(timed.iter().filter_map(|t| t.change(drift, noise)));
    // Changes of one cell stay in the order in which they were found.
    changes.sort_by(|x, y| x.id.cmp(&y.id));
    Comparison {
        changes,
        common: pairs.len(),
        identical,
        timed: timed.len(),
        drift,
        noise,
    }
}

/// B against A where less is better.
fn towards_less<T: PartialOrd>(a: T, b: T) -> Direction {
    if b < a {
        Direction::Better
    } else if b > a {
        Direction::Worse
    } else {
        Direction::Other
    }
}

/// A counter with its name.
type Counter = (&'static str, fn(&IncrementFound) -> usize);

const COUNTERS: [Counter; 7] = [
    ("iterations", |i| i.iterations),
    ("solves", |i| i.solves),
    ("tangent_factorisations", |i| i.tangent_factorisations),
    ("global_factorisations", |i| i.global_factorisations),
    ("local_solves", |i| i.local_solves),
    ("state_changes", |i| i.state_changes),
    ("final_changes", |i| i.final_changes),
];

/// Changes of what was found.
fn found_changes([a, b]: [&Record; 2]) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut tell = |what, direction, texts, ratio| {
        changes.push(Change {
            ratio,
            ..Change::new(a, what, direction, texts)
        });
    };
    let [x, y] = [a, b].map(|r| &r.found.verdict);
    if x != y {
        let texts = [x, y].map(|verdict| verdict.to_string());
        let direction = towards_less(x.rank(), y.rank());
        tell(What::Verdict, direction, texts, f64::NAN);
    }
    for (name, of) in COUNTERS {
        let [x, y] = [a, b].map(|r| r.found.sum(of));
        if x != y {
            // How the states of the points change is neither good nor bad.
            let direction = match name.ends_with("_changes") {
                true => Direction::Other,
                false => towards_less(x, y),
            };
            let texts = [x, y].map(|n| n.to_string());
            tell(What::Counter(name), direction, texts, y as f64 / x as f64);
        }
    }
    let errors = [a, b].map(|r| r.found.solver_error.as_ref().map(|e| e.energy));
    if let [Some(x), Some(y)] = errors
        && x.max(y) > ROUND_OFF
        && (x - y).abs() > ERROR_CHANGE * x.min(y)
    {
        let texts = [x, y].map(|e| format!("{e:.2e}"));
        tell(What::SolverError, towards_less(x, y), texts, y / x);
    }
    changes
}

/// A cell with two times that can be compared.
struct Timed<'a> {
    record: &'a Record,
    a: Timing,
    b: Timing,
}

impl<'a> Timed<'a> {
    fn of([a, b]: [&'a Record; 2]) -> Option<Self> {
        let place = |r: &'a Record| [&r.origin.machine, &r.origin.profile];
        let time = |r: &Record| published_times(r).map(method_time);
        let timed = Self {
            record: a,
            a: time(a)?,
            b: time(b)?,
        };
        let positive = timed.a.median_s > 0.0 && timed.b.median_s > 0.0;
        (place(a) == place(b) && positive).then_some(timed)
    }

    fn log_ratio(&self) -> f64 {
        (self.b.median_s / self.a.median_s).ln()
    }

    fn change(&self, drift: f64, noise: f64) -> Option<Change> {
        let beyond = self.log_ratio() - drift;
        let factor = (-drift).exp();
        let b = Timing {
            low_s: factor * self.b.low_s,
            high_s: factor * self.b.high_s,
            ..self.b
        };
        let least = (3.0 * noise).max(TIME_CHANGE.ln());
        let changed = !self.a.overlaps(&b) && beyond.abs() > least;
        changed.then(|| {
            let texts = [self.a, self.b].map(|t| format!("{:.3e} s", t.median_s));
            let direction = towards_less(0.0, beyond);
            Change {
                ratio: beyond.exp(),
                ..Change::new(self.record, What::Time, direction, texts)
            }
        })
    }
}

fn drift_and_noise(timed: &[Timed<'_>]) -> [f64; 2] {
    let ratios = || timed.iter().map(Timed::log_ratio);
    let drift = median(ratios());
    [
        drift,
        NORMAL * median(ratios().map(|ratio| (ratio - drift).abs())),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::analysis::support::{lying, record, timed};
    use super::*;
    use crate::run::verdict::Verdict;

    fn cells(times: &[f64]) -> Vec<Record> {
        let cell = |(i, t): (usize, &f64)| timed(record(&format!("case-{i}"), "latin", 1e-6), *t);
        times.iter().enumerate().map(cell).collect()
    }

    fn told(comparison: &Comparison) -> Vec<(&'static str, Direction)> {
        let changes = comparison.changes.iter();
        changes.map(|c| (c.what.name(), c.direction)).collect()
    }

    #[test]
    fn the_same_records_do_not_differ() {
        let records = cells(&[1.0, 2.0, 3.0]);
        let found = compare(&records, &records);
        assert!(found.changes.is_empty() && !found.worse());
        let counts = (found.common, found.identical, found.timed);
        assert_eq!((counts, found.drift, found.noise), ((3, 3, 3), 0.0, 0.0));
    }

    /// Source: hand calculation. All cells take 1.5 times as long, which is the machine; one of them 3 times, twice the rest.
    #[test]
    fn what_happens_to_all_cells_is_the_machine() {
        let a = cells(&[1.0, 1.0, 1.0, 1.0, 1.0]);
        let b = cells(&[1.5, 1.5, 1.5, 1.5, 3.0]);
        let found = compare(&a, &b);
        assert!((found.drift - 1.5f64.ln()).abs() < 1e-12 && found.noise < 1e-12);
        assert_eq!(told(&found), [("time", Direction::Worse)]);
        assert_eq!(found.changes[0].id, a[4].id);
        assert!((found.changes[0].ratio - 2.0).abs() < 1e-12);
        assert!(!found.worse(), "a time is no verdict");
    }

    /// Source: hand calculation. Log ratios 0, ±0.2, ±0.4: noise 1.4826 · 0.2, three times that is 0.89 < 1.
    #[test]
    fn changes_within_the_noise_are_not_told() {
        let a = cells(&[1.0; 6]);
        let times = |last: f64| [-0.4, -0.2, 0.0, 0.2, 0.4, last].map(f64::exp);
        assert!(compare(&a, &cells(&times(0.0)[..])).changes.is_empty());
        let found = compare(&a[..5], &cells(&times(0.0)[..5]));
        assert!((found.noise - 1.4826 * 0.2).abs() < 1e-12);
        // A seventh cell far outside of it.
        let found = compare(&a, &cells(&times(-1.5)));
        assert_eq!(told(&found), [("time", Direction::Better)]);
    }

    /// Goal: intervals of ±10 % overlap where the ratio is 1.15, although that is more than 1.1.
    #[test]
    fn overlapping_intervals_are_no_change() {
        let a = cells(&[1.0; 5]);
        assert!(
            compare(&a, &cells(&[1.0, 1.0, 1.0, 1.0, 1.15]))
                .changes
                .is_empty()
        );
        assert_eq!(
            compare(&a, &cells(&[1.0, 1.0, 1.0, 1.0, 1.25]))
                .changes
                .len(),
            1
        );
    }

    #[test]
    fn times_of_two_machines_or_of_liars_are_not_compared() {
        let a = cells(&[1.0, 1.0]);
        let mut b = cells(&[5.0, 1.0]);
        b[0].origin.machine = "linux, two".into();
        b[1].origin.profile = "debug".into();
        let found = compare(&a, &b);
        assert!(found.timed == 0 && found.changes.is_empty() && found.drift.is_nan());
        let mut wrong = lying("false-claim");
        wrong.id = a[0].id.clone();
        assert_eq!(compare(&a[..1], &[wrong]).timed, 0);
    }

    #[test]
    fn verdicts_counters_errors_and_bits_are_told_apart() {
        let a = cells(&[1.0]);
        let changed = |change: fn(&mut Record)| {
            let mut b = a.clone();
            change(&mut b[0]);
            compare(&a, &b)
        };
        let verdict = changed(|r| {
            r.found.verdict = Verdict::FalseClaim;
            r.found.increments[0].verdict = Verdict::FalseClaim;
        });
        assert_eq!(told(&verdict), [("verdict", Direction::Worse)]);
        assert!(verdict.worse());
        let counter = changed(|r| r.found.increments[0].iterations = 5);
        assert_eq!(told(&counter), [("iterations", Direction::Better)]);
        assert_eq!(counter.changes[0].ratio, 0.5);
        let states = changed(|r| r.found.increments[0].state_changes = 9);
        assert_eq!(told(&states), [("state_changes", Direction::Other)]);
        let error = changed(|r| r.found.solver_error.as_mut().unwrap().energy *= 1.02);
        assert_eq!(told(&error), [("solver_error", Direction::Worse)]);
        let bits = changed(|r| r.found.solver_error.as_mut().unwrap().energy *= 1.005);
        assert_eq!(told(&bits), [("bits", Direction::Other)]);
        assert_eq!((bits.common, bits.identical), (1, 0));
        for same in [&verdict, &counter, &error] {
            assert!(!same.changes.iter().any(|c| c.what == What::Bits));
        }
    }

    #[test]
    fn cells_of_one_side_are_listed() {
        let all = cells(&[1.0, 1.0, 1.0]);
        let found = compare(&all[..2], &all[1..]);
        let expected = [
            ("only in A", Direction::Other),
            ("only in B", Direction::Other),
        ];
        assert_eq!(told(&found), expected);
        assert_eq!((found.common, found.identical), (1, 1));
    }
}
