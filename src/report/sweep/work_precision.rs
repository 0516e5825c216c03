//! Work against precision: a row per problem, method and tolerance or option.

use std::cmp::Ordering;

use super::records::SweepRecords;
use crate::report::csv::{self, Row};
use crate::report::number::{residual, time, value};
use crate::report::{Bundle, ReportError};
use crate::studies::sweep::analysis::series::{Point, Series, Swept, series};
use crate::studies::sweep::analysis::{problem_names, problems};

/// Adds `work_precision.csv`.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let all = problems(sweep.records);
    let mut rows = Vec::new();
    for (problem, name) in all.iter().zip(problem_names(&all)) {
        let series = series(sweep.records, problem);
        for own in series {
            let Series { label, swept, .. } = own;
            rows.extend(own.points.into_iter().map(|point| PointRow {
                problem: name.clone(),
                label: label.clone(),
                swept: swept.clone(),
                exact: own.exact,
                point,
            }));
        }
    }
    Ok(bundle.add(PointRow::FILE, csv::file(&rows)?)?)
}

struct PointRow<'a> {
    problem: String,
    label: String,
    swept: Swept,
    exact: bool,
    point: Point<'a>,
}

impl Row for PointRow<'_> {
    const FILE: &'static str = "work_precision.csv";
    const COLUMNS: &'static [&'static str] = &[
        "problem",
        "series",
        "swept",
        "value",
        "exact",
        "id",
        "verdict",
        "error_energy",
        "iterations",
        "local_solves",
        "tangent_factorisations",
        "method_median_s",
        "method_low_s",
        "method_high_s",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let Point {
            record,
            value: swept_value,
            error,
            time: spent,
        } = &self.point;
        let found = &record.found;
        let seconds = |t: Option<f64>| time(t.unwrap_or(f64::NAN));
        vec![
            self.problem.clone(),
            self.label.clone(),
            self.swept.name().to_owned(),
            value(*swept_value),
            self.exact.to_string(),
            record.id.clone(),
            found.verdict.to_string(),
            residual(*error),
            found.sum(|i| i.iterations).to_string(),
            found.sum(|i| i.local_solves).to_string(),
            found.sum(|i| i.tangent_factorisations).to_string(),
            seconds(spent.map(|t| t.median_s)),
            seconds(spent.map(|t| t.low_s)),
            seconds(spent.map(|t| t.high_s)),
        ]
    }

    fn order(&self, _: &Self) -> Ordering {
        // They come by problem, series and value, which the stable sort keeps.
        Ordering::Equal
    }
}
