//! The random robustness study: success rates with their confidence intervals, and every failure.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use stickslip_methods::Tier;

use super::csv::{self, Row};
use super::number::{fixed, residual, significant, time, value};
use super::plot::success_rates;
use super::tables::{Align, Column, Table};
use super::{Bundle, Provenance, ReportError, tables};
use crate::run::verdict::{GIVE_UPS, Verdict};
use crate::studies::stress::{StressPlan, Trial};
use crate::studies::sweep::analysis::proportion::wilson;

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
    /// Own laws solved, the contact laws held to each tier of `GRADES`, but not to the one asked for.
    pub approximate: [usize; 4],
    /// Ended without a claim.
    pub gave_up: usize,
    /// Those of them with each of [`GIVE_UPS`] but the last: nobody stops a trial.
    pub gave_up_by: [usize; 5],
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
}

/// The smallest value that a fraction `q` of the values does not exceed; NaN of nothing.
fn quantile(q: f64, values: impl Iterator<Item = f64>) -> f64 {
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
        let (mut approximate, mut gave_up_by, mut gave_up) = ([0; 4], [0; 5], 0);
        for trial in trials {
            match &trial.verdict {
                Verdict::Solved => solved += 1,
                Verdict::Approximate(tier) => count(&mut approximate, &GRADES, tier),
                Verdict::GaveUp(status) => {
                    gave_up += 1;
                    count(&mut gave_up_by, &GIVE_UPS, status);
                }
                Verdict::FalseClaim => false_claims += 1,
                Verdict::Crashed(_) | Verdict::TimedOut | Verdict::OutOfMemory => crashed += 1,
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
pub fn rows(plan: &StressPlan, trials: &[Trial]) -> Vec<RobustnessRow> {
    let mut sorted: Vec<&Trial> = trials.iter().collect();
    let key = |t: &Trial| (t.dim, t.method.clone());
    sorted.sort_by(|a, b| key(a).cmp(&key(b)).then(a.friction.total_cmp(&b.friction)));
    sorted
        .chunk_by(|a, b| key(a) == key(b) && a.friction == b.friction)
        .filter_map(|group| RobustnessRow::of(group, plan.tier))
        .collect()
}

/// Everything that was neither solved nor declined.
pub fn failures(plan: &StressPlan, trials: &[Trial]) -> Vec<FailureRow> {
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
        })
        .collect()
}

impl Row for RobustnessRow {
    const FILE: &'static str = "robustness.csv";
    const COLUMNS: &'static [&'static str] = &[
        "dimension",
        "method",
        "friction",
        "tier",
        "problems",
        "solved",
        "approximate_high",
        "approximate_mid",
        "approximate_low",
        "approximate_none",
        "gave_up",
        "max_iterations",
        "stalled",
        "singular_tangent",
        "mechanism",
        "diverged",
        "false_claims",
        "crashed",
        "refused",
        "success",
        "success_rate",
        "success_low",
        "success_high",
        "iterations_median",
        "iterations_p90",
        "iterations_max",
        "factorisations_median",
        "solve_s_median",
        "natural_map_median",
        "unique_share",
        "open_share",
        "stick_share",
        "slip_share",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![
            self.dimension.to_string(),
            self.method.clone(),
            value(self.friction),
            self.tier.to_string(),
        ];
        let ends = [self.false_claims, self.crashed, self.refused];
        let counts = [self.problems, self.solved].into_iter();
        let counts = counts.chain(self.approximate).chain([self.gave_up]);
        let counts = counts.chain(self.gave_up_by).chain(ends);
        cells.extend(counts.map(|n| n.to_string()));
        cells.push(counted(self.exact).into());
        cells.extend(self.success.map(|x| significant(x, 4)));
        cells.extend(self.iterations.map(value));
        cells.push(value(self.factorisations));
        cells.push(time(self.solve_s));
        cells.push(residual(self.natural_map));
        cells.push(significant(self.unique_share, 4));
        cells.extend(self.shares.map(|x| significant(x, 4)));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        (self.dimension, &self.method)
            .cmp(&(other.dimension, &other.method))
            .then(self.friction.total_cmp(&other.friction))
    }
}

impl Row for FailureRow {
    const FILE: &'static str = "failures.csv";
    const COLUMNS: &'static [&'static str] = &[
        "seed",
        "dimension",
        "problem",
        "friction",
        "method",
        "verdict",
        "natural_map",
        "unique",
        "points",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.seed.to_string(),
            self.dimension.to_string(),
            self.problem.to_string(),
            value(self.friction),
            self.method.clone(),
            self.verdict.to_string(),
            residual(self.natural_map),
            self.unique.to_string(),
            self.points.to_string(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        (self.dimension, self.problem)
            .cmp(&(other.dimension, other.problem))
            .then(self.friction.total_cmp(&other.friction))
            .then_with(|| self.method.cmp(&other.method))
    }
}

/// What the rate of a method counts.
fn counted(exact: bool) -> &'static str {
    if exact { "solved" } else { "kept" }
}

/// Success rates for reading: one line per dimension and method, one column per friction coefficient.
///
/// # Errors
/// Those of [`Table::push`].
pub fn table(rows: &[RobustnessRow]) -> Result<Table, ReportError> {
    let mut friction: Vec<f64> = rows.iter().map(|row| row.friction).collect();
    friction.sort_by(f64::total_cmp);
    friction.dedup();
    let most = rows.iter().map(|row| row.problems).max().unwrap_or(0);
    let mut columns = vec![
        Column::new("dim", "", Align::Right),
        Column::new("method", "", Align::Left),
        Column::new("rate of", "", Align::Left),
    ];
    let rate = |mu: &f64| Column::new(format!("μ = {}", value(*mu)), "%", Align::Decimal);
    columns.extend(friction.iter().map(rate));
    columns.extend([
        Column::new("iterations, worst median", "", Align::Right),
        Column::new("laws to no tier", "", Align::Right),
        Column::new("false claims", "", Align::Right),
        Column::new("crashed", "", Align::Right),
    ]);
    let title = format!(
        "Random problems, {most} per friction coefficient and dimension: rate of those solved (exact methods) or of \
         claims kept (approximate methods)"
    );
    let mut table = Table::new(title, columns);
    let lines: BTreeSet<(usize, &str)> = rows
        .iter()
        .map(|r| (r.dimension, r.method.as_str()))
        .collect();
    for (dimension, method) in lines {
        let own = || {
            rows.iter()
                .filter(|r| r.dimension == dimension && r.method == method)
        };
        let exact = own().all(|r| r.exact);
        let mut cells = vec![
            dimension.to_string(),
            method.to_owned(),
            counted(exact).into(),
        ];
        cells.extend(friction.iter().map(|mu| {
            let found = own()
                .find(|r| r.friction == *mu)
                .map(|r| 100.0 * r.success[0]);
            match found {
                Some(rate) if rate.is_finite() => fixed(rate, 1),
                _ => "refused".into(),
            }
        }));
        let iterations = own().map(|r| r.iterations[0]).filter(|i| i.is_finite());
        cells.push(
            iterations
                .fold(None, |m: Option<f64>, i| Some(m.map_or(i, |m| m.max(i))))
                .map_or_else(String::new, value),
        );
        cells.push(own().map(|r| r.approximate[3]).sum::<usize>().to_string());
        cells.push(own().map(|r| r.false_claims).sum::<usize>().to_string());
        cells.push(own().map(|r| r.crashed).sum::<usize>().to_string());
        table.push(cells)?;
    }
    Ok(table)
}

/// Files of the study: `robustness.*`, `failures.csv`, the figure, provenance.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figure.
pub fn bundle(
    plan: &StressPlan,
    trials: &[Trial],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let rows = rows(plan, trials);
    let mut bundle = Bundle::new();
    bundle.add(RobustnessRow::FILE, csv::file(&rows)?)?;
    bundle.add(FailureRow::FILE, csv::file(&failures(plan, trials))?)?;
    tables::add_readable(&mut bundle, "robustness", &table(&rows)?)?;
    // Where every method declines every problem there is nothing to draw.
    if rows.iter().any(|row| row.success[0].is_finite()) {
        bundle.add("figures/robustness.svg", success_rates(&rows)?)?;
    }
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
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
