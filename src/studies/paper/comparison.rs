//! Every case by every method: what all meshes, friction coefficients and increments come to.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::run::record::RunRow;
use crate::run::verdict::Verdict;

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

/// The verdict farthest from `solved`; of equally far ones the first by name, so that the order of the runs does not
/// matter.
fn worst<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> Option<&'a Verdict> {
    verdicts.max_by_key(|verdict| (verdict.rank(), Reverse(verdict.to_string())))
}

/// Sums the runs up by case and method.
pub fn comparison(runs: &[RunRow]) -> Vec<ComparisonRow> {
    let mut groups: BTreeMap<(&str, &str), Vec<&RunRow>> = BTreeMap::new();
    for run in runs {
        let key = (run.key.case.as_str(), run.key.method.as_str());
        groups.entry(key).or_default().push(run);
    }
    let row = |((case, method), group): ((&str, &str), Vec<&RunRow>)| {
        let honest = group.iter().all(|r| r.verdict.is_honest());
        Some(ComparisonRow {
            case: case.into(),
            method: method.into(),
            increments: group.len(),
            verdict: worst(group.iter().map(|r| &r.verdict))?.clone(),
            natural_map: group.iter().map(|r| r.natural_map).fold(0.0, worse),
            iterations: group.iter().map(|r| r.iterations).sum(),
            tangent_factorisations: group.iter().map(|r| r.tangent_factorisations).sum(),
            local_solves: group.iter().map(|r| r.local_solves).sum(),
            solve_s: if honest {
                group.iter().map(|r| r.solve_s).sum()
            } else {
                f64::NAN
            },
        })
    };
    groups.into_iter().filter_map(row).collect()
}

/// The larger residual; NaN, nothing judged, is worse than any.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_of_a_case_is_the_worst_of_its_runs() {
        let from_best = [
            "solved",
            "approximate: high",
            "approximate: mid",
            "approximate: low",
            "approximate: none",
            "refused: yes",
            "refused: no",
            "gave-up: stalled",
            "timed-out",
            "out-of-memory",
            "crashed: oh",
            "false-claim",
        ]
        .map(|text| text.parse::<Verdict>().unwrap());
        for pair in from_best.windows(2) {
            for order in [[&pair[0], &pair[1]], [&pair[1], &pair[0]]] {
                assert_eq!(worst(order.into_iter()), Some(&pair[1]));
            }
        }
    }
}
