//! Every case by every method: what all meshes, friction coefficients and increments come to.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::run::verdict::Verdict;
use crate::studies::analysis::published_times;
use crate::studies::record::{Record, Step};
use crate::studies::statistics::larger;

/// One method on one case: all meshes, friction coefficients and increments together.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonRow {
    /// Case.
    pub case: String,
    /// Method.
    pub method: String,
    /// Increments run.
    pub increments: usize,
    /// The verdict farthest from `solved` among them.
    pub verdict: Verdict,
    /// Largest natural map found by the judge [-].
    pub natural_map: f64,
    /// Iterations in all.
    pub iterations: usize,
    /// Dense factorisations of condensed matrices in all.
    pub tangent_factorisations: usize,
    /// Evaluations of the contact law at one point in all.
    pub local_solves: usize,
    /// Solve times in all [s]; NaN unless every increment was solved.
    pub solve_s: f64,
}

/// The verdict farthest from `solved`; of equally far ones the first by name, so that the order of the runs does not matter.
fn worst<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> Option<&'a Verdict> {
    verdicts.max_by_key(|verdict| (verdict.rank(), Reverse(verdict.to_string())))
}

/// Sums the runs up by case and method.
pub fn comparison<'a>(runs: impl IntoIterator<Item = &'a Record>) -> Vec<ComparisonRow> {
    let mut groups: BTreeMap<(&str, &str), Vec<&Record>> = BTreeMap::new();
    for run in runs {
        let key = (run.asked.case.as_str(), run.found.method.as_str());
        groups.entry(key).or_default().push(run);
    }
    let row = |((case, method), group): ((&str, &str), Vec<&Record>)| {
        let sum = |counter: fn(&Step) -> usize| group.iter().map(|r| r.found.sum(counter)).sum();
        let steps = group.iter().flat_map(|r| &r.found.increments);
        let verdicts = steps.map(|step| &step.verdict);
        let verdicts = verdicts.chain(group.iter().map(|r| &r.found.verdict));
        let times = group.iter().map(|r| match published_times(r) {
            Some(spent) => spent.steps.iter().map(|own| own.total_s).sum(),
            None => f64::NAN,
        });
        Some(ComparisonRow {
            case: case.into(),
            method: method.into(),
            increments: sum(|_| 1),
            verdict: worst(verdicts)?.clone(),
            natural_map: group
                .iter()
                .map(|r| r.found.natural_map())
                .fold(0.0, larger),
            iterations: sum(|step| step.iterations),
            tangent_factorisations: sum(|step| step.tangent_factorisations),
            local_solves: sum(|step| step.local_solves),
            solve_s: times.sum(),
        })
    };
    groups.into_iter().filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_of_a_case_is_the_worst_of_its_runs_in_any_order() {
        let verdicts = ["solved", "refused: yes", "refused: no"].map(|v| v.parse().unwrap());
        for order in [[0, 1, 2], [2, 1, 0]] {
            let worst = worst(order.iter().map(|k| &verdicts[*k]));
            assert_eq!(worst, Some(&verdicts[2]));
        }
    }
}
