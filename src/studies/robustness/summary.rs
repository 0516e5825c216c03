//! The random trials summed up: success rates with their confidence intervals, and every failure.

use stickslip_methods::Tier;

use crate::run::verdict::{GIVE_UPS, Verdict};
use crate::studies::atlas::Explanation;
use crate::studies::robustness::{RobustnessPlan, Trial};
use crate::studies::sweep::statistics::wilson;

/// Tiers that contact laws held to beside an approximate method's own laws; none comes last.
const GRADES: [Option<Tier>; 4] = [Some(Tier::High), Some(Tier::Mid), Some(Tier::Low), None];

/// One method on all problems of one dimension and friction coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustnessRow {
    /// Space dimension.
    pub dimension: usize,
    /// Friction coefficient.
    pub friction: f64,
    /// Method label.
    pub method: String,
    /// Whether the method's limit are the contact laws: what its rate counts.
    pub exact: bool,
    /// Accuracy asked for.
    pub tier: Tier,
    /// Problems posed.
    pub problems: usize,
    /// Contact laws solved.
    pub solved: usize,
    /// Those of them on problems to which another answer is known.
    pub several: usize,
    /// Own laws solved, the contact laws held to each tier of `GRADES`, but not to the one asked for.
    pub approximate: [usize; 4],
    /// Ended without a claim.
    pub gave_up: usize,
    /// Those of them with each of [`GIVE_UPS`].
    pub gave_up_by: [usize; GIVE_UPS.len()],
    /// Claims the judge refuted.
    pub false_claims: usize,
    /// Errors, out of memory among them.
    pub crashed: usize,
    /// Problems declined; they count neither as success nor as failure.
    pub refused: usize,
    /// Successes/(problems − refused), with Wilson's 95 % interval. Exact methods succeed where they solved the contact
    /// laws, approximate ones where they kept their claim, whatever that is worth: see `approximate`.
    pub success: [f64; 3],
    /// Median, 90 % quantile and largest number of iterations of the successful runs.
    pub iterations: [f64; 3],
    /// Median number of factorisations of the successful runs.
    pub factorisations: f64,
    /// Median time of the successful runs [s].
    pub solve_s: f64,
    /// Median natural map of the successful runs.
    pub natural_map: f64,
    /// Share of problems where every point alone has one solution.
    pub unique_share: f64,
    /// Shares of open, sticking and slipping points in the successful runs.
    pub shares: [f64; 3],
}

/// One problem that one method did not solve.
#[derive(Debug, Clone, PartialEq)]
pub struct FailureRow {
    /// Seed of the study.
    pub seed: u64,
    /// Space dimension.
    pub dimension: usize,
    /// Number of the problem.
    pub problem: usize,
    /// Friction coefficient.
    pub friction: f64,
    /// Method label.
    pub method: String,
    /// Claim × check.
    pub verdict: Verdict,
    /// Natural map found by the judge.
    pub natural_map: f64,
    /// Whether every contact point alone has one solution.
    pub unique: bool,
    /// Contact points.
    pub points: usize,
    /// Why a run that gave up did so.
    pub explanation: Option<Explanation>,
}

/// The smallest value that a fraction `q` of the values does not exceed; NaN of nothing.
pub(super) fn quantile(q: f64, values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let rank = (q * sorted.len() as f64).ceil() as usize;
    sorted
        .get(rank.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

/// Counts one of those that have a column of their own.
fn count<T: PartialEq>(counts: &mut [usize], columns: &[T], own: &T) {
    let place = columns.iter().position(|column| column == own);
    if let Some(count) = place.and_then(|place| counts.get_mut(place)) {
        *count += 1;
    }
}

impl RobustnessRow {
    /// Sums up the trials of one dimension, friction coefficient and method.
    fn of(trials: &[&Trial], tier: Tier) -> Option<Self> {
        let first = trials.first()?;
        let (mut solved, mut refused, mut false_claims, mut crashed) = (0, 0, 0, 0);
        let (mut approximate, mut gave_up_by, mut gave_up) = ([0; 4], [0; GIVE_UPS.len()], 0);
        for trial in trials {
            match &trial.verdict {
                Verdict::Solved | Verdict::Several => solved += 1,
                Verdict::Approximate(tier) => count(&mut approximate, &GRADES, tier),
                Verdict::GaveUp(status) => {
                    gave_up += 1;
                    count(&mut gave_up_by, GIVE_UPS, status);
                }
                Verdict::FalseClaim => false_claims += 1,
                Verdict::Suspect(_)
                | Verdict::Crashed(_)
                | Verdict::TimedOut
                | Verdict::OutOfMemory => crashed += 1,
                Verdict::Refused(_) => refused += 1,
            }
        }
        let good = || trials.iter().filter(|t| t.succeeded());
        let iterations = |q| quantile(q, good().map(|t| t.iterations as f64));
        let statuses = good().fold([0; 3], |sum: [usize; 3], t| {
            std::array::from_fn(|k| sum[k] + t.statuses[k])
        });
        let points: usize = good().map(|t| t.points).sum();
        Some(Self {
            dimension: first.dim,
            friction: first.friction,
            method: first.method.clone(),
            exact: first.exact,
            tier,
            problems: trials.len(),
            solved,
            several: trials
                .iter()
                .filter(|t| t.verdict == Verdict::Several)
                .count(),
            approximate,
            gave_up,
            gave_up_by,
            false_claims,
            crashed,
            refused,
            success: wilson(good().count(), trials.len() - refused),
            iterations: [iterations(0.5), iterations(0.9), iterations(1.0)],
            factorisations: quantile(0.5, good().map(|t| t.factorisations as f64)),
            solve_s: quantile(0.5, good().map(|t| t.solve_s)),
            natural_map: quantile(0.5, good().map(|t| t.natural_map)),
            unique_share: trials.iter().filter(|t| t.unique).count() as f64 / trials.len() as f64,
            shares: statuses.map(|s| s as f64 / points as f64),
        })
    }
}

/// Sums the study up: rows by dimension, method and friction.
pub fn rows(plan: &RobustnessPlan, trials: &[Trial]) -> Vec<RobustnessRow> {
    let mut sorted: Vec<&Trial> = trials.iter().collect();
    let key = |t: &Trial| (t.dim, t.method.clone());
    sorted.sort_by(|a, b| key(a).cmp(&key(b)).then(a.friction.total_cmp(&b.friction)));
    sorted
        .chunk_by(|a, b| key(a) == key(b) && a.friction == b.friction)
        .filter_map(|group| RobustnessRow::of(group, plan.tier))
        .collect()
}

/// Everything that was neither solved nor declined.
pub fn failures(plan: &RobustnessPlan, trials: &[Trial]) -> Vec<FailureRow> {
    let failed = trials.iter().filter(|t| t.verdict.is_failure());
    failed
        .map(|t| FailureRow {
            seed: plan.seed,
            dimension: t.dim,
            problem: t.problem,
            friction: t.friction,
            method: t.method.clone(),
            verdict: t.verdict.clone(),
            natural_map: t.natural_map,
            unique: t.unique,
            points: t.points,
            explanation: t.explanation.clone(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_the_sample() {
        let sample = || [4.0, 1.0, 3.0, 2.0].into_iter();
        assert_eq!(
            [0.5, 0.9, 1.0].map(|q| quantile(q, sample())),
            [2.0, 4.0, 4.0]
        );
        assert!(quantile(0.5, std::iter::empty()).is_nan());
    }
}
