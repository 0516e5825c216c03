//! Work against precision: what a method spends for the error it leaves.
//!
//! The error is the distance from the converged solution of the same discrete problem, so it says nothing about the mesh. A
//! method that solves the contact laws goes along its curve by the tolerance asked for; a method with laws of its own ends at
//! its modelling error, and goes along its curve by the parameter of that error.

use std::collections::BTreeMap;

use stickslip_methods::METHODS;

use super::{compare_methods, has_defaults, is_honest, method_name, method_time, published_times};
use crate::sweep::cell::Problem;
use crate::sweep::record::Record;
use crate::sweep::statistics::Timing;

/// What changes along a curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Swept {
    /// The tolerance asked for.
    Tolerance,
    /// The first of these options, all of which change.
    Options(String),
}

impl Swept {
    /// Name in tables: `tolerance` or the options.
    pub fn name(&self) -> &str {
        match self {
            Swept::Tolerance => "tolerance",
            Swept::Options(names) => names,
        }
    }
}

/// One cell on a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Point<'a> {
    /// The cell; honest, with a solver error.
    pub record: &'a Record,
    /// Tolerance or value of the first option.
    pub value: f64,
    /// ‖u − u*‖_K, relative.
    pub error: f64,
    /// Time of the method, if it may be shown.
    pub time: Option<Timing>,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Series<'a> {
    /// Method; of a curve along options these in brackets, with the values of those that stay.
    pub label: String,
    /// Whether its limit are the contact laws.
    pub exact: bool,
    /// What changes along it.
    pub swept: Swept,
    /// From coarse to fine tolerance, or by the value of the option.
    pub points: Vec<Point<'a>>,
}

/// The curves of one problem, in the order of the methods. A method with laws of its own has a curve along the tolerance with
/// its defaults, and one along each set of options that was changed, at the finest tolerance; options that are the same all
/// along stand in the label, and the defaults have a point on the curve where they agree with these.
pub fn series<'a>(records: &'a [Record], problem: &Problem) -> Vec<Series<'a>> {
    let mut by_method: BTreeMap<&str, Vec<Point<'a>>> = BTreeMap::new();
    for record in records.iter().filter(|r| r.cell.problem() == *problem) {
        if let Some(point) = point(record) {
            let own = by_method.entry(record.cell.method.as_str());
            own.or_default().push(point);
        }
    }
    for points in by_method.values_mut() {
        points.sort_by(|a, b| b.value.total_cmp(&a.value));
    }
    let mut all: Vec<Series> = Vec::new();
    let mut along_options: BTreeMap<(&str, String), Vec<Choice<'a>>> = BTreeMap::new();
    for (method, points) in &by_method {
        let Some(first) = points.first().map(|p| p.record) else {
            continue;
        };
        let exact = first.found.exact;
        if exact || has_defaults(&first.cell) {
            all.push(Series {
                label: first.found.method.clone(),
                exact,
                swept: Swept::Tolerance,
                points: points.clone(),
            });
        }
        let changed = options(method);
        if let (false, false, Some(finest)) = (exact, changed.is_empty(), points.last()) {
            let names: Vec<&str> = changed.iter().map(|(name, _)| *name).collect();
            let key = (method_name(&first.cell), names.join(","));
            let group = along_options.entry(key).or_default();
            group.push((changed, finest.clone()));
        }
    }
    for ((method, _), group) in along_options {
        let finest = by_method.get(method).and_then(|points| points.last());
        all.extend(along(method, group, finest));
    }
    all.sort_by(|a, b| compare_methods(&a.label, &b.label));
    all
}

/// Options and the cell that has them.
type Choice<'a> = (Vec<(&'a str, f64)>, Point<'a>);

/// The curve of cells with the same options in other values.
fn along<'a>(
    method: &str,
    mut group: Vec<Choice<'a>>,
    defaults: Option<&Point<'a>>,
) -> Option<Series<'a>> {
    let first = group.first()?.0.clone();
    let varies = |k: &usize| {
        group
            .iter()
            .any(|(options, _)| options[*k].1 != first[*k].1)
    };
    let mut varying: Vec<usize> = (0..first.len()).filter(varies).collect();
    if varying.is_empty() {
        varying = (0..first.len()).collect();
    }
    let stays = |k: usize| !varying.contains(&k);
    let parts = first.iter().enumerate().map(|(k, (name, value))| {
        if stays(k) {
            format!("{name}={value:e}")
        } else {
            (*name).to_owned()
        }
    });
    let label = format!("{method}[{}]", parts.collect::<Vec<_>>().join(","));
    let agrees = |k: usize| default(method, first[k].0) == Some(first[k].1);
    if (0..first.len()).filter(|k| stays(*k)).all(agrees) {
        let own: Option<Vec<(&str, f64)>> = first
            .iter()
            .map(|(name, _)| Some((*name, default(method, name)?)))
            .collect();
        group.extend(own.zip(defaults.cloned()));
    }
    let along = *varying.first()?;
    let mut points: Vec<Point> = group
        .into_iter()
        .map(|(options, point)| Point {
            value: options[along].1,
            ..point
        })
        .collect();
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    let names: Vec<&str> = varying.iter().map(|k| first[*k].0).collect();
    Some(Series {
        label,
        exact: false,
        swept: Swept::Options(names.join(",")),
        points,
    })
}

fn point(record: &Record) -> Option<Point<'_>> {
    let error = record.found.solver_error.as_ref()?.energy;
    is_honest(record).then(|| Point {
        record,
        value: record.cell.tolerance,
        error,
        time: published_times(record).map(method_time),
    })
}

/// Options of a method as on the command line.
fn options(method: &str) -> Vec<(&str, f64)> {
    let list = method.split_once(':').map_or("", |(_, list)| list);
    let pairs = list.split(',').filter_map(|part| part.split_once('='));
    pairs
        .filter_map(|(name, value)| Some((name.trim(), value.trim().parse().ok()?)))
        .collect()
}

fn default(method: &str, option: &str) -> Option<f64> {
    let method = METHODS.iter().find(|m| m.name == method)?;
    let spec = method.options.iter().find(|spec| spec.name == option)?;
    Some(spec.default)
}

#[cfg(test)]
mod tests {
    use super::super::support::{record, timed};
    use super::*;

    #[test]
    fn exact_methods_go_by_tolerance_and_approximate_ones_by_their_parameter() {
        let approximate = |method: &str, tolerance, energy| {
            let mut record = timed(record("a", method, tolerance), 1.0);
            record.found.solver_error.as_mut().unwrap().energy = energy;
            record
        };
        let records = vec![
            timed(record("a", "latin", 1e-9), 3.0),
            timed(record("a", "latin", 1e-3), 1.0),
            timed(record("b", "latin", 1e-3), 1.0),
            approximate("penalty:normal=1e6,tangential=1e6", 1e-9, 1e-7),
            approximate("penalty:normal=1e2,tangential=1e2", 1e-9, 1e-3),
            approximate("penalty:normal=1e2,tangential=1e2", 1e-3, 2e-3),
            approximate("penalty", 1e-9, 1e-5),
        ];
        let problem = records[0].cell.problem();
        let found = series(&records, &problem);
        let lines: Vec<(&str, &str, Vec<f64>)> = found
            .iter()
            .map(|s| {
                let errors = s.points.iter().map(|p| p.error).collect();
                (s.label.as_str(), s.swept.name(), errors)
            })
            .collect();
        let options = "normal,tangential";
        assert_eq!(
            lines,
            [
                ("latin", "tolerance", vec![1e-3, 1e-9]),
                ("penalty", "tolerance", vec![1e-5]),
                // The default, 1e4, stands between.
                (
                    "penalty[normal,tangential]",
                    options,
                    vec![1e-3, 1e-5, 1e-7]
                ),
            ]
        );
    }

    /// Goal: with θ = −1 the default of γ is another method: θ is 1 there.
    #[test]
    fn an_option_that_stays_tells_curves_apart() {
        let of = |method: &str| timed(record("a", method, 1e-9), 1.0);
        let records = vec![
            of("nitsche"),
            of("nitsche:gamma=4"),
            of("nitsche:theta=-1,gamma=16"),
            of("nitsche:theta=-1,gamma=4"),
        ];
        let found = series(&records, &records[0].cell.problem());
        let lines: Vec<(&str, &str, Vec<f64>)> = found
            .iter()
            .map(|s| {
                let values = s.points.iter().map(|p| p.value).collect();
                (s.label.as_str(), s.swept.name(), values)
            })
            .collect();
        assert_eq!(
            lines,
            [
                ("nitsche", "tolerance", vec![1e-9]),
                ("nitsche[gamma]", "gamma", vec![2.0, 4.0]),
                ("nitsche[theta=-1e0,gamma]", "gamma", vec![4.0, 16.0]),
            ]
        );
    }

    #[test]
    fn a_false_claim_has_no_place_on_a_curve() {
        let mut wrong = timed(record("a", "latin", 1e-9), 3.0);
        wrong.found.verdict = "false-claim".into();
        let records = [wrong];
        assert!(series(&records, &records[0].cell.problem()).is_empty());
    }
}
