//! Every case by every method: what all meshes, friction coefficients and increments come to.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::run::verdict::Verdict;
use crate::studies::rows::RunRow;
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

/// The verdict farthest from `solved`; of equally far ones the first by name, so that the order of the runs does not
/// matter.
fn worst<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> Option<&'a Verdict> {
    verdicts.max_by_key(|verdict| (verdict.rank(), Reverse(verdict.to_string())))
}

/// Sums the runs up by case and method.
pub fn comparison<'a>(runs: impl IntoIterator<Item = &'a RunRow>) -> Vec<ComparisonRow> {
    let mut groups: BTreeMap<(&str, &str), Vec<&RunRow>> = BTreeMap::new();
    for run in runs {
        let key = (run.key.case.as_str(), run.key.method.as_str());
        groups.entry(key).or_default().push(run);
    }
    let row = |((case, method), group): ((&str, &str), Vec<&RunRow>)| {
        let honest = group.iter().all(|r| r.step.verdict.is_honest());
        Some(ComparisonRow {
            case: case.into(),
            method: method.into(),
            increments: group.len(),
            verdict: worst(group.iter().map(|r| &r.step.verdict))?.clone(),
            natural_map: group
                .iter()
                .map(|r| r.step.judge.natural_map)
                .fold(0.0, larger),
            iterations: group.iter().map(|r| r.step.iterations).sum(),
            tangent_factorisations: group.iter().map(|r| r.step.tangent_factorisations).sum(),
            local_solves: group.iter().map(|r| r.step.local_solves).sum(),
            solve_s: if honest {
                group.iter().map(|r| r.solve_s).sum()
            } else {
                f64::NAN
            },
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
