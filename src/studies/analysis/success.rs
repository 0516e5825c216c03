//! How often methods claim success, and how often they are right: two rates, kept apart.

use std::collections::{BTreeMap, BTreeSet};

use stickslip_methods::Tier;

use super::{claims, compare_methods, has_defaults, is_correct};
use crate::run::verdict::Verdict;
use crate::studies::record::Record;
use crate::studies::statistics::{quantile, wilson};

/// How a cell missed the tier: in the order of [`FAILURES`].
pub const FAILURES: [&str; 15] = [
    "inaccurate",
    "false_claim",
    "max_iterations",
    "stalled",
    "singular_tangent",
    "mechanism",
    "no_equilibrium",
    "diverged",
    "stopped",
    "rounding",
    "unexplained",
    "refused",
    "crashed",
    "timed_out",
    "out_of_memory",
];

/// Place of what was stopped in [`FAILURES`].
const STOPPED: usize = 8;

/// One method at one tier on the problems of a class.
#[derive(Debug, Clone, PartialEq)]
pub struct SuccessRow {
    /// Class of the problems; empty: all.
    pub class: String,
    /// Method, options other than the default in brackets.
    pub method: String,
    /// Whether its limit are the contact laws.
    pub exact: bool,
    /// Whether all options have their default.
    pub defaults: bool,
    /// Accuracy asked for.
    pub tier: Tier,
    /// Cells, each on a problem of its own.
    pub cells: usize,
    /// Cells that end with a claim, right or wrong.
    pub claimed: usize,
    /// Cells that are right to the tier.
    pub correct: usize,
    /// Those of them on problems to which another answer is known.
    pub several: usize,
    /// Cells that are not, by [`FAILURES`].
    pub failures: [usize; FAILURES.len()],
    /// Median, 90 % quantile and largest number of iterations of those that did what they claim.
    pub iterations: [f64; 3],
}

impl SuccessRow {
    /// Rate of claims with Wilson's 95 % interval.
    pub fn success(&self) -> [f64; 3] {
        wilson(self.claimed, self.cells)
    }

    /// Rate of runs that gave what their method is for, with Wilson's 95 % interval: an exact one the contact laws, another one
    /// the laws it claims.
    pub fn kept(&self) -> [f64; 3] {
        let kept = if self.exact {
            self.correct
        } else {
            self.claimed - self.failures[1]
        };
        wilson(kept, self.cells)
    }

    /// Rate of right answers with Wilson's 95 % interval.
    pub fn correctness(&self) -> [f64; 3] {
        wilson(self.correct, self.cells)
    }
}

/// Separator of a class and the friction coefficient of its problems, where these have several.
pub const BY_FRICTION: &str = " μ=";

/// Rates of all methods at the three tiers, those with options too: on all problems, then on those of every class, and of every
/// friction coefficient where a class has several; in the order of classes, methods, then tiers.
pub fn success(records: &[Record]) -> Vec<SuccessRow> {
    // An axis of the sweep: problems of files have each their own coefficients.
    let mut frictions: BTreeMap<&str, BTreeSet<u64>> = BTreeMap::new();
    for record in records {
        let own = frictions.entry(record.asked.case.as_str()).or_default();
        own.insert(record.asked.mu().to_bits());
    }
    let several = |record: &&Record| frictions[record.asked.case.as_str()].len() > 1;
    let swept = records.iter().filter(several).map(|r| r.class.as_str());
    let swept: BTreeSet<&str> = swept.filter(|class| !class.is_empty()).collect();
    let class_of = |record: &Record| {
        if swept.contains(record.class.as_str()) {
            format!("{}{BY_FRICTION}{}", record.class, record.asked.mu())
        } else {
            record.class.clone()
        }
    };
    let mut groups: BTreeMap<(String, usize, &str), Vec<&Record>> = BTreeMap::new();
    for record in records {
        let tiers = Tier::ALL.iter();
        let tier = tiers
            .enumerate()
            .find(|(_, t)| t.tolerance() == record.asked.tolerance);
        if let Some((index, _)) = tier {
            let classes = BTreeSet::from([String::new(), class_of(record)]);
            for class in classes {
                let key = (class, index, record.found.method.as_str());
                groups.entry(key).or_default().push(record);
            }
        }
    }
    let mut rows: Vec<SuccessRow> = groups
        .iter()
        .filter_map(|((class, tier, _), own)| row(class, own, Tier::ALL[*tier]))
        .collect();
    rows.sort_by(|a, b| {
        (a.class.cmp(&b.class))
            .then_with(|| compare_methods(&a.method, &b.method))
            .then(a.tier.tolerance().total_cmp(&b.tier.tolerance()).reverse())
    });
    rows
}

fn row(class: &str, own: &[&Record], tier: Tier) -> Option<SuccessRow> {
    let first = own.first()?;
    let honest = || own.iter().filter(|r| r.is_honest());
    let iterations = |q| quantile(q, honest().map(|r| r.found.sum(|i| i.iterations) as f64));
    let mut row = SuccessRow {
        class: class.to_owned(),
        iterations: [0.5, 0.9, 1.0].map(iterations),
        method: first.found.method.clone(),
        exact: first.found.exact,
        defaults: has_defaults(&first.asked),
        tier,
        cells: own.len(),
        claimed: own.iter().filter(|r| claims(r)).count(),
        correct: 0,
        several: 0,
        failures: [0; FAILURES.len()],
    };
    for record in own {
        if is_correct(record, tier) {
            row.correct += 1;
            row.several += usize::from(record.found.verdict == Verdict::Several);
        } else {
            row.failures[failure(&record.found.verdict)] += 1;
        }
    }
    Some(row)
}

/// Place in [`FAILURES`] of a verdict that is not right to the tier.
fn failure(verdict: &Verdict) -> usize {
    let name = match verdict {
        Verdict::Solved | Verdict::Several | Verdict::Approximate(_) => "inaccurate",
        Verdict::GaveUp(status) => status.as_str(),
        other => other.kind().name(),
    };
    let place = FAILURES
        .iter()
        .position(|own| *own == name.replace('-', "_"));
    // A status that is not known here ended without a claim, like one that was stopped.
    place.unwrap_or(STOPPED)
}

#[cfg(test)]
mod tests {
    use super::super::support::{end_with, lying, of_case, record};
    use super::*;
    use crate::run::verdict::GIVE_UPS;

    #[test]
    fn claims_and_right_answers_are_counted_apart() {
        let mut records: Vec<Record> = [
            "false-claim",
            "gave-up: max-iterations",
            "gave-up: singular-tangent",
            "refused: needs friction",
            "timed-out",
            "out-of-memory",
            "crashed: no memory",
        ]
        .iter()
        .enumerate()
        .map(|(i, verdict)| of_case(lying(verdict), &format!("case-{i}")))
        .collect();
        records.push(record("plate", "latin", 1e-6));
        let rows = success(&records);
        let [row] = &rows[..] else {
            panic!("one method at one tier: {rows:?}");
        };
        assert_eq!((row.cells, row.claimed, row.correct), (8, 2, 1));
        let expected = [0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1];
        assert_eq!(row.failures, expected);
        assert_eq!(row.failures.iter().sum::<usize>() + row.correct, row.cells);
    }

    #[test]
    fn a_class_with_several_friction_coefficients_is_rated_by_them() {
        let own = |class: &str, mu: f64| {
            let mut own = of_case(record("plate", "latin", 1e-6), class);
            (own.class, own.asked.friction) = (class.into(), vec![mu]);
            own
        };
        let rows = success(&[own("2d", 0.1), own("2d", 0.3), own("3d", 0.3)]);
        let classes: Vec<(&str, usize)> =
            rows.iter().map(|r| (r.class.as_str(), r.cells)).collect();
        let expected = [("", 3), ("2d μ=0.1", 1), ("2d μ=0.3", 1), ("3d", 1)];
        assert_eq!(classes, expected);
    }

    #[test]
    fn an_approximate_answer_succeeds_and_is_right_only_to_its_tier() {
        let mut records = Vec::new();
        for tier in Tier::ALL {
            let mut record = record("plate", "penalty", tier.tolerance());
            record.found.increments[0].judge.violation = 1e-5;
            let verdict = if tier == Tier::Low {
                "solved"
            } else {
                "approximate: low"
            };
            end_with(&mut record, verdict);
            records.push(record);
        }
        let rows = success(&records);
        let tiers: Vec<Tier> = rows.iter().map(|r| r.tier).collect();
        assert_eq!(tiers, Tier::ALL);
        let correct: Vec<usize> = rows.iter().map(|r| r.correct).collect();
        assert_eq!(correct, [1, 0, 0]);
        assert!(rows.iter().all(|r| r.claimed == 1));
        assert_eq!(rows[2].failures[0], 1, "inaccurate");
    }

    /// Goal: laws of a method's own do not count as the contact laws, and keeping them counts for it.
    #[test]
    fn exact_methods_are_rated_by_solutions_and_others_by_kept_claims() {
        for (method, kept) in [("latin", 1), ("penalty", 3)] {
            let mut records = Vec::new();
            for (index, verdict) in ["solved", "approximate: none", "approximate: low"]
                .into_iter()
                .chain(["false-claim", "gave-up: stalled"])
                .enumerate()
            {
                let mut own = of_case(record("plate", method, 1e-6), &format!("case-{index}"));
                if verdict != "solved" {
                    own.found.increments[0].judge.violation = 1e-2;
                }
                end_with(&mut own, verdict);
                records.push(own);
            }
            let row = &success(&records)[0];
            assert_eq!(row.kept()[0], kept as f64 / 5.0, "{row:?}");
        }
    }

    #[test]
    fn every_end_has_a_column_of_its_own() {
        let mut places: Vec<usize> = (GIVE_UPS.iter())
            .map(|status| failure(&Verdict::GaveUp(*status)))
            .collect();
        let others = ["solved", "false-claim", "refused: why", "crashed: why"];
        let limits = ["timed-out", "out-of-memory"];
        let others = others.iter().chain(&limits);
        places.extend(others.map(|text| failure(&text.parse().unwrap())));
        places.sort();
        assert_eq!(places, (0..FAILURES.len()).collect::<Vec<_>>());
        assert_eq!(FAILURES[STOPPED], "stopped");
    }
}
