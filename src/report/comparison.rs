//! Method against method: every case times every method, and the paper's two problems by every method and variant.

use std::cmp::{Ordering, Reverse};
use std::collections::BTreeMap;

use super::csv::{self, Row};
use super::number::{residual, significant, time, value};
use super::plot::method_cost;
use super::tables::{Align, Column, Table};
use super::{Bundle, ReportError, tables};
use crate::run::record::RunRow;
use crate::run::verdict::Verdict;
use crate::studies::paper::variants::VariantRow;

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
        let all_solved = group.iter().all(|r| r.verdict == Verdict::Solved);
        Some(ComparisonRow {
            case: case.into(),
            method: method.into(),
            increments: group.len(),
            verdict: worst(group.iter().map(|r| &r.verdict))?.clone(),
            natural_map: group.iter().map(|r| r.natural_map).fold(0.0, worse),
            iterations: group.iter().map(|r| r.iterations).sum(),
            tangent_factorisations: group.iter().map(|r| r.tangent_factorisations).sum(),
            local_solves: group.iter().map(|r| r.local_solves).sum(),
            solve_s: if all_solved {
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

impl Row for ComparisonRow {
    const FILE: &'static str = "comparison.csv";
    const COLUMNS: &'static [&'static str] = &[
        "case",
        "method",
        "increments",
        "verdict",
        "natural_map",
        "iterations",
        "tangent_factorisations",
        "local_solves",
        "solve_s",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.case.clone(),
            self.method.clone(),
            self.increments.to_string(),
            self.verdict.to_string(),
            residual(self.natural_map),
            self.iterations.to_string(),
            self.tangent_factorisations.to_string(),
            self.local_solves.to_string(),
            time(self.solve_s),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let case = self.case.cmp(&other.case);
        case.then_with(|| self.method.cmp(&other.method))
    }
}

/// The comparison for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn comparison_table(rows: &[ComparisonRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Every case by every method: all meshes, friction coefficients and increments",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("method", "", Align::Left),
            Column::new("increments", "", Align::Right),
            Column::new("verdict, worst", "", Align::Left),
            Column::new("natural map, largest", "", Align::Right),
            Column::new("iterations", "", Align::Right),
            Column::new("dense factorisations", "", Align::Right),
            Column::new("solve", "s", Align::Right),
        ],
    );
    for row in rows {
        table.push(vec![
            row.case.clone(),
            row.method.clone(),
            row.increments.to_string(),
            row.verdict.to_string(),
            residual(row.natural_map),
            row.iterations.to_string(),
            row.tangent_factorisations.to_string(),
            shown_time(row.solve_s),
        ])?;
    }
    Ok(table)
}

fn shown_time(seconds: f64) -> String {
    if seconds.is_nan() {
        "–".into()
    } else {
        time(seconds)
    }
}

impl Row for VariantRow {
    const FILE: &'static str = "variants.csv";
    const COLUMNS: &'static [&'static str] = &[
        "case",
        "friction",
        "method",
        "verdict",
        "quantity",
        "value",
        "deviation",
        "natural_map",
        "iterations",
        "tangent_factorisations",
        "global_factorisations",
        "solve_s",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.case.clone(),
            value(self.friction),
            self.method.clone(),
            Verdict::or_not_run(self.verdict.as_ref()),
            self.quantity.clone(),
            value(self.value),
            residual(self.deviation),
            residual(self.natural_map),
            self.iterations.to_string(),
            self.tangent_factorisations.to_string(),
            self.global_factorisations.to_string(),
            time(self.solve_s),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let case = self.case.cmp(&other.case);
        case.then(self.friction.total_cmp(&other.friction))
            .then_with(|| self.method.cmp(&other.method))
    }
}

/// The variants for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn variant_table(rows: &[VariantRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Plate and beam by every method and variant",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("μ", "", Align::Decimal),
            Column::new("method", "", Align::Left),
            Column::new("verdict", "", Align::Left),
            Column::new("quantity", "", Align::Left),
            Column::new("value", "SI", Align::Right),
            Column::new("deviation", "", Align::Right),
            Column::new("natural map", "", Align::Right),
            Column::new("iterations", "", Align::Right),
            Column::new("dense", "", Align::Right),
            Column::new("sparse", "", Align::Right),
            Column::new("solve", "s", Align::Right),
        ],
    );
    for row in rows {
        let honest = row.verdict.as_ref().is_some_and(Verdict::is_honest);
        table.push(vec![
            row.case.clone(),
            value(row.friction),
            row.method.clone(),
            Verdict::or_not_run(row.verdict.as_ref()),
            row.quantity.clone(),
            significant(row.value, 8),
            residual(row.deviation),
            residual(row.natural_map),
            row.iterations.to_string(),
            row.tangent_factorisations.to_string(),
            row.global_factorisations.to_string(),
            shown_time(if honest { row.solve_s } else { f64::NAN }),
        ])?;
    }
    Ok(table)
}

/// Adds both tables and the figure `cost` to a report.
///
/// # Errors
/// Those of the parts.
pub fn add(
    bundle: &mut Bundle,
    runs: &[RunRow],
    variants: &[VariantRow],
) -> Result<(), ReportError> {
    let rows = comparison(runs);
    bundle.add(ComparisonRow::FILE, csv::file(&rows)?)?;
    tables::add_readable(bundle, "comparison", &comparison_table(&rows)?)?;
    // Where nothing did what it claims there is nothing to draw.
    if rows.iter().any(|row| row.verdict.is_honest()) {
        bundle.add("figures/cost.svg", method_cost(&rows)?)?;
    }
    bundle.add(VariantRow::FILE, csv::file(variants)?)?;
    tables::add_readable(bundle, "variants", &variant_table(variants)?)
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
