//! Rows grouped by problem and run, and words for them.

use crate::report::names::problem_name;
use crate::report::number::value;
use crate::report::plot::{italic, plain, rank};
use crate::studies::record::Record;
use crate::studies::rows::RunKey;
use std::collections::BTreeMap;

/// A run with its rows, in one increment.
pub type Run<'a, R> = (&'a RunKey, Vec<&'a R>);

/// Rows of the last increment of every run by the name of its problem, runs in the order of the registry of methods.
pub fn by_problem<'a, R>(
    rows: &'a [R],
    key: fn(&R) -> &RunKey,
) -> BTreeMap<String, Vec<Run<'a, R>>> {
    type Found<'a, R> = BTreeMap<(usize, &'a str), Run<'a, R>>;
    let mut problems: BTreeMap<String, Found<'a, R>> = BTreeMap::new();
    for row in rows {
        let own = key(row);
        let runs = problems.entry(problem_name(own)).or_default();
        let run = runs.entry((rank(&own.method), &own.method));
        let (last, rows) = run.or_insert((own, Vec::new()));
        if own.increment > last.increment {
            (*last, *rows) = (own, Vec::new());
        }
        if own.increment == last.increment {
            rows.push(row);
        }
    }
    let runs = |runs: Found<'a, R>| runs.into_values().collect();
    problems
        .into_iter()
        .map(|(name, own)| (name, runs(own)))
        .collect()
}

/// Case, mesh, contact space and friction coefficient of a problem.
pub fn problem(key: &RunKey) -> String {
    format!("{}, {}", body(key), friction(key.friction))
}

/// The same at the end of an increment, where it is not the first.
pub fn moment(key: &RunKey) -> String {
    match key.increment {
        ..=1 => problem(key),
        later => format!("{}, increment {later}", problem(key)),
    }
}

/// Case, mesh and contact space.
pub fn body(key: &RunKey) -> String {
    plain(&format!("{}, {}, {}", key.case, key.mesh, key.space))
}

/// μ = 0.3.
pub fn friction(mu: f64) -> String {
    format!("{} = {}", italic("μ"), value(mu))
}

/// `1 method`, `2 methods`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// In order, each once.
pub fn distinct<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for one in all {
        if !found.contains(&one) {
            found.push(one);
        }
    }
    found
}

/// The one with the least number, the first of equal ones.
pub fn least<T>(all: impl IntoIterator<Item = T>, of: impl Fn(&T) -> f64) -> Option<T> {
    let all = all.into_iter();
    all.min_by(|a, b| of(a).total_cmp(&of(b)))
}

/// Mesh and contact space that a record was made with.
pub fn made_with(record: &Record) -> (&str, &str) {
    let problem = record.found.problem.as_ref();
    problem.map_or(("?", ""), |p| (&p.mesh, &p.space))
}
