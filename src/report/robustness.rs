//! The random robustness study: success rates with their confidence intervals, and every failure.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::csv::{self, Row};
use super::number::{fixed, residual, significant, time, value};
use super::tables::{Align, Column, Table};
use super::{Bundle, Provenance, ReportError, figures, tables};
use crate::studies::stress::robustness::{FailureRow, RobustnessRow, failures, rows};
use crate::studies::stress::{StressPlan, Trial};

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
    figures::robustness::add(&mut bundle, &rows)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
