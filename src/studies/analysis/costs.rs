//! Cost of a right answer, by problem and method: the time of the method, preparation and enforcement on all increments [s].

use super::test_set::TestSet;
use super::{is_correct, method_time, published_times};
use crate::studies::record::Record;
use crate::studies::statistics::median;

/// A time and the interval it is known to lie in [s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Median.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Cost {
    /// Of a cell whatever its answer is worth; none of a time that may not be shown.
    fn of(record: &Record) -> Option<Self> {
        let time = method_time(published_times(record)?);
        Some(Self {
            value: time.median_s,
            low: time.low_s,
            high: time.high_s,
        })
    }

    /// A cost without uncertainty.
    pub fn exactly(value: f64) -> Self {
        Self {
            value,
            low: value,
            high: value,
        }
    }

    /// Whether it is cheaper beyond the intervals.
    pub fn is_below(&self, other: &Self) -> bool {
        self.high < other.low
    }

    /// Width of the interval relative to the value.
    pub fn relative_width(&self) -> f64 {
        (self.high - self.low) / self.value
    }
}

/// Least of the right costs of a problem; infinite without any.
pub(super) fn least(row: &[Option<Cost>]) -> f64 {
    let values = row.iter().flatten().map(|cost| cost.value);
    values.fold(f64::INFINITY, f64::min)
}

/// Costs of the right answers of a test set.
#[derive(Debug, Clone)]
pub struct Costs<'a> {
    /// Methods, as in the test set.
    pub methods: Vec<&'a str>,
    /// By problem and method; none where the answer is not right to the tier.
    pub costs: Vec<Vec<Option<Cost>>>,
    /// Problems left out: a right answer has no time, or the times come from different machines.
    pub untimed: usize,
}

impl<'a> Costs<'a> {
    /// Costs of a test set.
    pub fn new(set: &TestSet<'a>) -> Self {
        let mut all = Self {
            methods: set.methods.clone(),
            costs: Vec::new(),
            untimed: 0,
        };
        for row in &set.records {
            let correct = |r: &&&Record| is_correct(r, set.tier);
            let right: Vec<&&Record> = row.iter().filter(correct).collect();
            let known = right.iter().all(|r| Cost::of(r).is_some());
            let on = |r: &'a Record| [&r.origin.machine, &r.origin.profile];
            if !known || right.windows(2).any(|r| on(r[0]) != on(r[1])) {
                all.untimed += 1;
                continue;
            }
            let cost = |r: &&Record| Cost::of(r).filter(|_| is_correct(r, set.tier));
            all.costs.push(row.iter().map(cost).collect());
        }
        all
    }

    /// How many problems.
    pub fn problems(&self) -> usize {
        self.costs.len()
    }

    /// How many problems no method solved.
    pub fn unsolved(&self) -> usize {
        let unsolved = |row: &&Vec<Option<Cost>>| row.iter().all(Option::is_none);
        self.costs.iter().filter(unsolved).count()
    }

    /// Median of the relative widths of all intervals; NaN without any.
    pub fn median_width(&self) -> f64 {
        let costs = self.costs.iter().flatten().flatten();
        median(costs.map(Cost::relative_width))
    }
}

#[cfg(test)]
mod tests {
    use super::super::support::{costs, failed, record, solved, timed};

    #[test]
    fn wrong_answers_have_no_cost() {
        let mut records = solved("plate", &[("b-newton", 1.0)]);
        records.push(failed("plate", "latin"));
        let costs = costs(&records).costs;
        assert!(costs[0][0].is_some() && costs[0][1].is_none());
    }

    #[test]
    fn a_right_answer_without_a_time_is_no_failure() {
        let mut records = solved("plate", &[("b-newton", 1.0)]);
        records.push(record("plate", "latin", 1e-6));
        let counts = |records: &[_]| {
            let costs = costs(records);
            (costs.problems(), costs.untimed)
        };
        assert_eq!(counts(&records), (0, 1));
        records[1] = timed(records[1].clone(), 2.0);
        assert_eq!(counts(&records), (1, 0));
        // Nor are two machines compared.
        records[1].origin.machine = "linux, two".into();
        assert_eq!(counts(&records), (0, 1));
    }

    #[test]
    fn methods_stand_in_the_order_of_the_registry() {
        // Intervals of ±10 %.
        let records = solved("plate", &[("b-newton", 1.0), ("pdas", 1.2), ("latin", 1.3)]);
        let costs = costs(&records);
        assert_eq!(costs.methods, ["b-newton", "pdas", "latin"]);
        assert!((costs.median_width() - 0.2).abs() < 1e-12);
    }
}
