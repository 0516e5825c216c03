//! Why methods gave up, by method and cause, and what published stopping tests are worth, by method and test; of the records
//! that were asked.

use std::collections::BTreeMap;

use crate::studies::record::Record;
use crate::studies::statistics::quantile;
use crate::studies::why::Explanation;
use crate::studies::why::cause::Cause;
use crate::studies::why::stopping::{CRITERIA, Criterion, Stop};

/// All failures of one method by one cause.
#[derive(Debug, Clone, PartialEq)]
pub struct CauseRow {
    /// Method label.
    pub method: String,
    /// Why.
    pub cause: Cause,
    /// Runs of the method that gave up for this cause.
    pub count: usize,
    /// Of all runs of the method that gave up.
    pub share: f64,
    /// Median of what the cause is decided by.
    pub measure: f64,
    /// Median period of cycles.
    pub period: f64,
    /// Median of the iterations left, where it still falls.
    pub more: f64,
    /// Runs on problems of which several solutions are known.
    pub several: usize,
    /// Runs with a remedy.
    pub remedied: usize,
    /// The remedy that worked most often.
    pub remedy: Option<String>,
    /// The problem with the fewest contact points: name, friction, points.
    pub example: (String, f64, usize),
}

/// One stopping test on all runs of one method in one dimension.
#[derive(Debug, Clone)]
pub struct StoppingRow {
    /// Space dimension.
    pub dimension: usize,
    /// Method label.
    pub method: String,
    /// The test.
    pub criterion: &'static Criterion,
    /// Runs.
    pub runs: usize,
    /// Share of the runs that it stops too early.
    pub early: f64,
    /// Median and largest number of decades by which the violation then exceeds what was asked for.
    pub decades: [f64; 2],
    /// Share of the runs that it never stops.
    pub never: f64,
    /// Median iteration at which it stops.
    pub stopped: f64,
    /// Median iteration at which the violation is what was asked for.
    pub reached: f64,
    /// The run of the largest number of decades: name of the problem and friction.
    pub worst: Option<(String, f64)>,
}

/// Runs on which a test was evaluated.
type Watched<'a> = Vec<(&'a Record, &'a Stop)>;

/// Why the runs of a method gave up: rows by method and cause.
pub fn causes(records: &[Record]) -> Vec<CauseRow> {
    let mut groups: BTreeMap<(&str, Cause), Vec<(&Record, &Explanation)>> = BTreeMap::new();
    let mut totals: BTreeMap<&str, usize> = BTreeMap::new();
    for record in records {
        if let Some(own) = &record.found.why {
            let method = record.found.method.as_str();
            let key = (method, own.diagnosis.cause);
            groups.entry(key).or_default().push((record, own));
            *totals.entry(method).or_default() += 1;
        }
    }
    let row = |((method, cause), runs): ((&str, Cause), Vec<(&Record, &Explanation)>)| {
        let of = |get: fn(&Explanation) -> Option<f64>| {
            quantile(0.5, runs.iter().filter_map(|(_, own)| get(own)))
        };
        let points = |r: &Record| r.found.problem.as_ref().map_or(0, |size| size.points);
        let key = |r: &Record| (points(r), r.asked.case.clone());
        let smallest = runs.iter().map(|run| run.0);
        let order = |a: &&Record, b: &&Record| {
            let mu = a.asked.mu().total_cmp(&b.asked.mu());
            key(a).cmp(&key(b)).then(mu)
        };
        let smallest = smallest.min_by(order)?;
        let total = totals.get(method).copied().unwrap_or(runs.len());
        Some(CauseRow {
            method: method.to_owned(),
            cause,
            count: runs.len(),
            share: runs.len() as f64 / total as f64,
            measure: of(|own| Some(own.diagnosis.measure).filter(|m| !m.is_nan())),
            period: of(|own| own.diagnosis.period.map(|p| p as f64)),
            more: of(|own| own.diagnosis.more),
            several: runs.iter().filter(|(_, own)| own.solutions > 1).count(),
            remedied: runs.iter().filter(|(_, own)| own.remedy.is_some()).count(),
            remedy: most_often(runs.iter().filter_map(|(_, own)| own.remedy.as_deref())),
            example: (
                smallest.asked.case.clone(),
                smallest.asked.mu(),
                points(smallest),
            ),
        })
    };
    groups.into_iter().filter_map(row).collect()
}

/// The text that comes most often, of several the first by name.
fn most_often<'a>(texts: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    texts.for_each(|text| *counts.entry(text).or_default() += 1);
    let most = counts.values().copied().max()?;
    let mut best = counts.into_iter().filter(|(_, count)| *count == most);
    best.next().map(|(text, _)| text.to_owned())
}

/// Stopping tests: rows by dimension, method and test.
pub fn stopping(records: &[Record]) -> Vec<StoppingRow> {
    let mut groups: BTreeMap<(usize, &str, usize), Watched<'_>> = BTreeMap::new();
    for record in records {
        let dim = record.found.problem.as_ref().map_or(0, |size| size.dim);
        for stop in &record.found.stops {
            let place = CRITERIA.iter().position(|c| c.name == stop.criterion);
            let Some(place) = place else { continue };
            let key = (dim, record.found.method.as_str(), place);
            groups.entry(key).or_default().push((record, stop));
        }
    }
    let row = |((dimension, method, place), runs): ((usize, &str, usize), Watched<'_>)| {
        let early = || runs.iter().filter(|(_, stop)| stop.decades > 0.0);
        let share = |count: usize| count as f64 / runs.len() as f64;
        let worst = early().max_by(|a, b| {
            let later = |run: &(&Record, &Stop)| {
                let asked = &run.0.asked;
                (asked.case.clone(), asked.mu().to_bits())
            };
            (a.1.decades.total_cmp(&b.1.decades)).then_with(|| later(b).cmp(&later(a)))
        });
        let iterations = |get: fn(&Stop) -> Option<usize>| {
            let all = runs.iter().filter_map(|(_, stop)| get(stop));
            quantile(0.5, all.map(|k| k as f64))
        };
        StoppingRow {
            dimension,
            method: method.to_owned(),
            criterion: &CRITERIA[place],
            runs: runs.len(),
            early: share(early().count()),
            decades: [0.5, 1.0].map(|q| quantile(q, early().map(|(_, stop)| stop.decades))),
            never: share(runs.iter().filter(|(_, stop)| stop.at.is_none()).count()),
            stopped: iterations(|stop| stop.at),
            reached: iterations(|stop| stop.reached),
            worst: worst.map(|(record, _)| (record.asked.case.clone(), record.asked.mu())),
        }
    };
    groups.into_iter().map(row).collect()
}
