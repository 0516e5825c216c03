//! Everything a command found, before it is written.

use std::collections::BTreeSet;

use crate::studies::measure::Answer;
use crate::studies::record::Record;
use crate::studies::rows::{
    ExactPoint, ExpectRow, HistoryRow, IncrementRow, PointRow, QuantityRow, RunFields, RunKey,
    recorded_iterations,
};

/// Findings of runs, and the numbers they are held to.
#[derive(Debug, Clone, Default)]
pub struct Results {
    /// The runs.
    pub answers: Vec<Answer>,
    /// Closed forms of their cases.
    pub exact: Vec<ExactPoint>,
    /// Expected numbers.
    pub expectations: Vec<ExpectRow>,
    /// Increments that have pictures, besides the last.
    pub pictured: BTreeSet<usize>,
}

impl Results {
    /// Adds the results of other runs.
    pub fn append(&mut self, other: Results) {
        self.answers.extend(other.answers);
        self.exact.extend(other.exact);
        self.expectations.extend(other.expectations);
    }

    /// The runs as they were at the end of an increment; of those that came so far, the points and fields of it.
    pub fn until(&self, increment: usize) -> Self {
        // A path may begin with a state at rest, which is increment 0.
        let count = |own: &Answer| {
            let steps = own.record.found.increments.iter();
            steps.filter(|step| step.increment <= increment).count()
        };
        let until = |own: &Answer| {
            let (count, mut own) = (count(own), own.clone());
            own.record.found.increments.truncate(count);
            own.points.truncate(count);
            own.fields.truncate(count);
            own
        };
        let far = |own: &&Answer| own.record.found.increments.len() > count(own);
        let exact = self
            .exact
            .iter()
            .filter(|own| own.key.increment == increment);
        Self {
            answers: self.answers.iter().filter(far).map(until).collect(),
            exact: exact.cloned().collect(),
            ..Self::default()
        }
    }

    /// The part of these results that is about some cases.
    pub fn of_cases(&self, names: &[&str]) -> Self {
        fn part<R: Clone>(rows: &[R], wanted: impl Fn(&R) -> bool) -> Vec<R> {
            rows.iter().filter(|row| wanted(row)).cloned().collect()
        }
        let wanted = |name: &str| names.contains(&name);
        Self {
            answers: part(&self.answers, |own| wanted(&own.record.asked.case)),
            exact: part(&self.exact, |row| wanted(&row.key.case)),
            expectations: part(&self.expectations, |row| wanted(&row.key.case)),
            pictured: self.pictured.clone(),
        }
    }

    /// The records of the runs.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.answers.iter().map(|own| &own.record)
    }

    /// Findings of every increment.
    pub fn increments(&self) -> Vec<IncrementRow<'_>> {
        self.records().flat_map(IncrementRow::of).collect()
    }

    /// Quantities of interest at the end of every increment.
    pub fn quantities(&self) -> Vec<QuantityRow<'_>> {
        let rows = self.records().flat_map(IncrementRow::of);
        rows.flat_map(of_increment).collect()
    }

    /// Quantities of interest with a known error at the end of the path, by the first exact method on every problem.
    pub fn with_errors(&self) -> Vec<QuantityRow<'_>> {
        let mut seen = BTreeSet::new();
        let estimated =
            |record: &&Record| record.found.exact && record.found.energy_error.is_some();
        let ends = self
            .records()
            .filter(estimated)
            .filter_map(|record| IncrementRow::of(record).last());
        let first = ends.filter(|row| seen.insert(row.key.problem()));
        first
            .flat_map(of_increment)
            .filter(|row| row.quantity.error.is_finite())
            .collect()
    }

    /// Recorded iterations of every increment.
    pub fn history(&self) -> Vec<HistoryRow> {
        let all = self.answers.iter().flat_map(|own| {
            let named = IncrementRow::of(&own.record).map(|row| row.key);
            named.zip(&own.histories)
        });
        all.flat_map(|(key, history)| {
            let last = history.len().checked_sub(1);
            let recorded = last.map_or_else(Vec::new, recorded_iterations);
            recorded.into_iter().map(move |iteration| HistoryRow {
                key: key.clone(),
                iteration,
                violation: history[iteration],
            })
        })
        .collect()
    }

    /// Contact points at the end of every increment.
    pub fn points(&self) -> Vec<PointRow<'_>> {
        let all = self.answers.iter().flat_map(|own| {
            let named = IncrementRow::of(&own.record).map(|row| row.key);
            named.zip(&own.points)
        });
        all.flat_map(|(key, points)| {
            points.iter().map(move |point| PointRow {
                key: key.clone(),
                point,
            })
        })
        .collect()
    }

    /// Places of the closed forms.
    pub fn exact_points(&self) -> impl Iterator<Item = PointRow<'_>> {
        self.exact.iter().map(|ExactPoint { key, point }| PointRow {
            key: key.clone(),
            point,
        })
    }

    /// Fields of the runs whose fields were kept.
    pub fn fields(&self) -> impl Iterator<Item = RunFields<'_>> {
        self.answers.iter().filter_map(|own| {
            let last = own.record.found.increments.last()?;
            (!own.fields.is_empty()).then(|| RunFields {
                key: RunKey::of(&own.record, last.increment),
                steps: &own.fields,
            })
        })
    }

    /// Why runs gave up and what to change, a line each.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        self.records().filter_map(|record| {
            let found = &record.found;
            let (why, last) = (found.why.as_ref()?, found.increments.last()?);
            let RunKey {
                case,
                mesh,
                method,
                friction,
                increment,
                ..
            } = RunKey::of(record, last.increment);
            let verdict = &found.verdict;
            Some(format!(
                "{case} {mesh} mu={friction} {method} increment {increment}: {verdict}: {why}"
            ))
        })
    }

    /// Number of runs that were to solve a case and did not, for whatever reason; declined ones are none of them.
    pub fn failures(&self) -> usize {
        let failed = self.records().filter(|r| r.found.verdict.is_failure());
        failed.count()
    }

    /// True if no run failed and every expected number came out as stated: the exit code of what made these results.
    pub fn as_expected(&self) -> bool {
        self.failures() == 0 && self.expectations.iter().all(ExpectRow::as_stated)
    }
}

/// Quantities of interest at the end of an increment.
fn of_increment<'a>(
    IncrementRow { key, step, .. }: IncrementRow<'a>,
) -> impl Iterator<Item = QuantityRow<'a>> {
    step.quantities.iter().map(move |quantity| QuantityRow {
        key: key.clone(),
        quantity,
    })
}
