//! Work against precision: what a method spends for the error it leaves.
//!
//! The error is the distance from the converged solution of the same discrete problem, so it says nothing about the mesh. A
//! method that solves the contact laws goes along its curve by the tolerance asked for; a method with laws of its own ends at
//! its modelling error, and goes along its curve by the parameter of that error.

use std::collections::BTreeMap;

use crate::run::choice::Choice;
use crate::run::registry;

use super::{compare_methods, has_defaults, method_name, method_time, published_times};
use crate::studies::record::Record;
use crate::studies::statistics::Timing;

/// The parameter along a curve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Swept {
    /// The tolerance asked for.
    Tolerance,
    /// An option, and those that follow from its value.
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
    /// Method; of a curve along options these in brackets, then others that are not the default.
    pub label: String,
    /// Whether its limit are the contact laws.
    pub exact: bool,
    /// The parameter along it.
    pub swept: Swept,
    /// From coarse to fine tolerance, or by the value of the option.
    pub points: Vec<Point<'a>>,
}

/// The curves of one problem, given its records, in the order of the methods. A method with laws of its own has a curve along the tolerance with
/// its defaults, and curves along the option that takes most values, at the finest tolerance: options that follow from its
/// value change with it, others tell curves apart.
pub fn series<'a>(of_problem: &[&'a Record]) -> Vec<Series<'a>> {
    let mut by_method: BTreeMap<&str, Vec<Point<'a>>> = BTreeMap::new();
    for record in of_problem {
        if let Some(point) = point(record) {
            let own = by_method.entry(record.asked.method.as_str());
            own.or_default().push(point);
        }
    }
    for points in by_method.values_mut() {
        points.sort_by(|a, b| b.value.total_cmp(&a.value));
    }
    let mut all: Vec<Series> = Vec::new();
    let mut approximate: BTreeMap<&str, Vec<Setting<'a>>> = BTreeMap::new();
    for (method, points) in &by_method {
        let Some(first) = points.first().map(|p| p.record) else {
            continue;
        };
        let exact = first.found.exact;
        if exact || has_defaults(&first.asked) {
            all.push(Series {
                label: first.found.method.clone(),
                exact,
                swept: Swept::Tolerance,
                points: points.clone(),
            });
        }
        if let (false, Some(finest)) = (exact, points.last()) {
            let group = approximate.entry(method_name(&first.asked)).or_default();
            group.push((options(method), finest.clone()));
        }
    }
    for (method, group) in &approximate {
        all.extend(along_options(method, group));
    }
    all.sort_by(|a, b| compare_methods(&a.label, &b.label));
    all
}

/// All options with their values, and the cell that has them.
type Setting<'a> = (Vec<(String, f64)>, Point<'a>);

/// The curves of one method with laws of its own, given by cells with different options; none where all are the same.
fn along_options<'a>(method: &str, cells: &[Setting<'a>]) -> Vec<Series<'a>> {
    let value = |cell: &Setting<'a>, name: &str| {
        let own = cell.0.iter().find(|(option, _)| option == name);
        own.map(|(_, value)| *value)
    };
    let values = |name: &str| {
        let mut all: Vec<f64> = cells.iter().filter_map(|cell| value(cell, name)).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all.len()
    };
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in cells.iter().flat_map(|(options, _)| options) {
        if !names.contains(&name.as_str()) && values(name) > 1 {
            names.push(name);
        }
    }
    // The first of those with most values.
    let most = names.iter().map(|name| values(name)).max();
    let Some(along) = names.iter().find(|n| Some(values(n)) == most).copied() else {
        return Vec::new();
    };
    let follows = |name: &&str| {
        cells.iter().all(|a| {
            let alike = cells.iter().filter(|b| value(a, along) == value(b, along));
            alike.into_iter().all(|b| value(a, name) == value(b, name))
        })
    };
    let (changing, apart): (Vec<&str>, Vec<&str>) = names.iter().partition(|n| follows(n));
    let mut curves: BTreeMap<String, Vec<Point<'a>>> = BTreeMap::new();
    for cell in cells {
        let stays = apart.iter().filter_map(|name| {
            let value = value(cell, name)?;
            (default(method, name) != Some(value)).then(|| format!("{name}={value:e}"))
        });
        let parts = changing.iter().map(|name| (*name).to_owned()).chain(stays);
        let label = format!("{method}[{}]", parts.collect::<Vec<_>>().join(","));
        let point = Point {
            value: value(cell, along).unwrap_or(f64::NAN),
            ..cell.1.clone()
        };
        curves.entry(label).or_default().push(point);
    }
    let curve = |(label, mut points): (String, Vec<Point<'a>>)| {
        points.sort_by(|a, b| a.value.total_cmp(&b.value));
        Series {
            label,
            exact: false,
            swept: Swept::Options(changing.join(",")),
            points,
        }
    };
    curves.into_iter().map(curve).collect()
}

fn point(record: &Record) -> Option<Point<'_>> {
    let error = record.found.solver_error.as_ref()?.energy;
    record.is_honest().then(|| Point {
        record,
        value: record.asked.tolerance,
        error,
        time: published_times(record).map(method_time),
    })
}

/// Options of a method as on the command line, the rest as the registry has them; none of a method it does not have.
fn options(method: &str) -> Vec<(String, f64)> {
    let Ok(choice) = Choice::parse(method) else {
        return Vec::new();
    };
    let all = choice.options().into_iter();
    all.map(|(spec, value)| (spec.name().to_owned(), value.number()))
        .collect()
}

fn default(method: &str, option: &str) -> Option<f64> {
    let method = registry::method(method)?;
    let spec = method.options.iter().find(|spec| spec.name() == option)?;
    Some(spec.default().number())
}

#[cfg(test)]
mod tests {
    use super::super::by_problem;
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
        let found = series(&by_problem(&records)[0]);
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

    /// Goal: γ takes most values, θ tells curves apart, and the default of γ is a point of each.
    #[test]
    fn an_option_that_stays_tells_curves_apart() {
        let of = |method: &str| timed(record("a", method, 1e-9), 1.0);
        let records = vec![
            of("nitsche"),
            of("nitsche:gamma=4"),
            of("nitsche:gamma=16,theta=-1"),
            of("nitsche:theta=-1"),
        ];
        let found = series(&by_problem(&records)[0]);
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
                ("nitsche[gamma,theta=-1e0]", "gamma", vec![2.0, 16.0]),
                ("nitsche[gamma]", "gamma", vec![2.0, 4.0]),
            ]
        );
    }

    #[test]
    fn a_false_claim_has_no_place_on_a_curve() {
        let mut wrong = timed(record("a", "latin", 1e-9), 3.0);
        wrong.found.verdict = crate::run::verdict::Verdict::FalseClaim;
        let records = [wrong];
        assert!(series(&by_problem(&records)[0]).is_empty());
    }
}
