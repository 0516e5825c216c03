//! Runs as curves: grouping of rows, and labels that say what tells the runs of a figure apart.

use super::canvas::{italic, plain};
use super::methods;
use crate::report::number::value;
use crate::run::record::RunKey;

/// Rows grouped by run, runs in the order of the registry of methods, then of the tables, rows by `order`.
pub fn by_run<R>(
    rows: &[R],
    key: impl Fn(&R) -> &RunKey,
    order: impl Fn(&R, &R) -> std::cmp::Ordering,
) -> Vec<Vec<&R>> {
    let mut sorted: Vec<&R> = rows.iter().collect();
    sorted.sort_by(|a, b| RunKey::order(key(a), key(b)).then_with(|| order(a, b)));
    let mut runs: Vec<Vec<&R>> = sorted
        .chunk_by(|a, b| key(a) == key(b))
        .map(<[&R]>::to_vec)
        .collect();
    runs.sort_by_key(|run| methods::rank(&key(run[0]).method));
    runs
}

/// What the runs of a figure have in common, and what tells them apart.
pub struct Names {
    /// Case, mesh, … that all runs share.
    pub common: String,
    /// One label per run.
    pub labels: Vec<String>,
}

impl Names {
    pub fn of(keys: &[&RunKey]) -> Self {
        let parts = |key: &RunKey| {
            [
                plain(&key.case),
                plain(&key.mesh),
                plain(&key.space),
                plain(&key.method),
                format!("{} = {}", italic("μ"), value(key.friction)),
                format!("increment {}", key.increment),
            ]
        };
        let all: Vec<[String; 6]> = keys.iter().map(|key| parts(key)).collect();
        let Some(first) = all.first() else {
            return Self {
                common: String::new(),
                labels: Vec::new(),
            };
        };
        let shared: Vec<bool> = (0..6)
            .map(|i| all.iter().all(|p| p[i] == first[i]))
            .collect();
        let joined = |parts: &[String; 6], wanted: bool| {
            let chosen = parts.iter().zip(&shared).filter(|(_, s)| **s == wanted);
            chosen
                .map(|(part, _)| part.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        };
        let labels = all.iter().map(|parts| match joined(parts, false) {
            // A single run has nothing to tell it apart from.
            label if label.is_empty() => parts[3].clone(),
            label => label,
        });
        Self {
            common: joined(first, true),
            labels: labels.collect(),
        }
    }
}
