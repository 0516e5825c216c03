//! Loops: the reaction of what moves the body against its displacement, and the shear force that a plane crack carries against
//! its mean slip, increment after increment.

use super::agreement::agreement;
use super::kind::Kind;
use super::runs::{Run, distinct, problem};
use crate::report::names::problem_name;
use crate::report::number::significant;
use crate::report::plot::subscript;
use crate::report::plot::{Axis, Draw, Figure, Panel, Series, italic, plain, prefixed, rank};
use crate::report::{Bundle, ReportError};
use crate::studies::results::Results;
use crate::studies::rows::{QuantityRow, RunKey};
use std::collections::BTreeMap;

/// The kind.
pub static KIND: Kind = Kind {
    file: "*.loop.svg",
    question: "How much energy does friction take on this load path, and do the methods agree on it?",
    shows: "Left, where a support moves: the reaction against the mean displacement of the component that does most work. \
            Right: shear force −P_a on a plane crack against its mean slip. From the unloaded body through all \
            increments, where there are at least four and something runs back; runs that end before the others \
            are left out.",
};

/// Paths of fewer increments are no loops.
const LEAST: usize = 4;
/// Changes below this fraction of the range are no turn.
const NO_CHANGE: f64 = 1e-6;

/// Two quantities of a run [m and N/m], unloaded and after every increment.
type Path = Vec<[f64; 2]>;

/// A quantity: name, place, component.
type Name<'a> = [&'a str; 3];

/// One figure per problem and plane crack.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    // By problem, then by method.
    type Runs<'a> = BTreeMap<(usize, &'a str), Run<'a, QuantityRow<'a>>>;
    let mut found: BTreeMap<String, Runs<'_>> = BTreeMap::new();
    let quantities = results.quantities();
    for row in &quantities {
        let name = row.quantity.name.as_str();
        if ["mean_slip", "contact_force", "reaction", "displacement"].contains(&name) {
            let method = &row.key.method;
            let runs = found.entry(problem_name(&row.key)).or_default();
            let run = runs.entry((rank(method), method));
            let (key, rows) = run.or_insert((&row.key, Vec::new()));
            if row.key.increment > key.increment {
                *key = &row.key;
            }
            rows.push(row);
        }
    }
    for (name, runs) in found {
        let runs: Vec<Run<'_, QuantityRow<'_>>> = runs.into_values().collect();
        let slips = runs[0].1.iter().map(|row| row.quantity);
        let slips: Vec<_> = slips.filter(|q| q.name == "mean_slip").collect();
        // A solid has slip along b too, which is no loop in a plane.
        if slips.iter().any(|q| q.component == "b") {
            continue;
        }
        let moved = mover(&runs[0].1);
        for crack in distinct(slips.iter().map(|q| q.at.as_str())) {
            let names = [["mean_slip", crack, "a"], ["contact_force", crack, "a"]];
            let shear = paths(&runs, names, -1.0);
            let Some((key, path)) = shear.first() else {
                continue;
            };
            if path.len() > LEAST && runs_back(path) {
                let slip = panel(&shear, ["mean slip", "shear force −"], ("P", "a"));
                let mut panels = vec![slip];
                if let Some([_, at, component]) = moved {
                    let names = [["displacement", at, component], ["reaction", at, component]];
                    let words = [format!("{at} displacement"), format!("{at} reaction ")];
                    let words = words.each_ref().map(String::as_str);
                    let pulled = paths(&runs, names, 1.0);
                    panels.insert(0, panel(&pulled, words, ("R", component)));
                }
                let figure = figure(panels, &shear, key, crack, results, &quantities);
                KIND.add(bundle, &format!("{name}.{crack}"), figure.svg()?)?;
            }
        }
    }
    Ok(())
}

/// The component of a place that supports move, with most work: range of displacement times range of reaction, once loaded.
fn mover<'a>(rows: &[&'a QuantityRow<'_>]) -> Option<Name<'a>> {
    let names = rows.iter().map(|row| row.quantity);
    let names = names.filter(|q| q.name == "reaction");
    let names = distinct(names.map(|q| [q.name.as_str(), &q.at, &q.component]));
    let works = names.into_iter().map(|name @ [_, at, component]| {
        let path = path(rows, [["displacement", at, component], name], 1.0);
        let [moved, force] = [0, 1].map(|c| {
            let own = || path[1..].iter().map(|p| p[c]);
            (own().fold(f64::NEG_INFINITY, f64::max) - own().fold(f64::INFINITY, f64::min)).max(0.0)
        });
        (moved * force, name)
    });
    let most = works.max_by(|a, b| a.0.total_cmp(&b.0));
    most.filter(|(work, _)| *work > 0.0).map(|(_, name)| name)
}

/// The paths of the runs that go as far as any.
fn paths<'a>(
    runs: &[Run<'a, QuantityRow<'a>>],
    names: [Name<'_>; 2],
    sign: f64,
) -> Vec<(&'a RunKey, Path)> {
    let paths = runs
        .iter()
        .map(|(key, rows)| (*key, path(rows, names, sign)));
    let mut paths: Vec<(&RunKey, Path)> = paths.collect();
    let longest = paths.iter().map(|(_, path)| path.len()).max().unwrap_or(0);
    paths.retain(|(_, path)| path.len() == longest);
    paths
}

/// As far as both quantities are known, the second times a sign.
fn path(rows: &[&QuantityRow<'_>], names: [Name<'_>; 2], sign: f64) -> Path {
    let mut values: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for row in rows {
        let q = row.quantity;
        let own = [q.name.as_str(), &q.at, &q.component];
        if let Some(c) = names.iter().position(|name| *name == own) {
            let place = values.entry(row.key.increment).or_insert([f64::NAN; 2]);
            place[c] = [1.0, sign][c] * q.value;
        }
    }
    let known = |p: &[f64; 2]| p.iter().all(|v| v.is_finite());
    let after = values.into_values().take_while(known);
    std::iter::once([0.0; 2]).chain(after).collect()
}

/// Whether slip or force turns back by more than round-off.
fn runs_back(path: &Path) -> bool {
    (0..2).any(|c| {
        let changes = path.windows(2).map(|pair| pair[1][c] - pair[0][c]);
        let largest = path.iter().map(|p| p[c].abs()).fold(0.0, f64::max);
        let beyond = |sign: f64| changes.clone().any(|d| sign * d > NO_CHANGE * largest);
        beyond(1.0) && beyond(-1.0)
    })
}

/// Values of all runs over the largest of each axis, for comparison, and these.
fn scaled(paths: &[(&RunKey, Path)]) -> (Vec<Vec<f64>>, [f64; 2]) {
    let all = || paths.iter().flat_map(|(_, path)| path);
    let largest = [0, 1].map(|c| all().map(|p| p[c].abs()).fold(f64::MIN_POSITIVE, f64::max));
    let of = |(_, path): &(_, Path)| -> Vec<f64> {
        let part = |p: &[f64; 2]| [0, 1].map(|c| p[c] / largest[c]);
        path.iter().flat_map(part).collect()
    };
    (paths.iter().map(of).collect(), largest)
}

/// Curves that agree as one band, others beside it.
fn panel(paths: &[(&RunKey, Path)], words: [&str; 2], symbol: (&str, &str)) -> Panel {
    let (scaled, largest) = scaled(paths);
    let methods: Vec<&str> = paths.iter().map(|(key, _)| key.method.as_str()).collect();
    let [x, y] = [prefixed(largest[0], "m"), prefixed(largest[1], "N/m")];
    let symbol = format!("{}{}", italic(symbol.0), subscript(symbol.1));
    let axes = [
        format!("{} [{}]", words[0], x.1),
        format!("{}{symbol} [{}]", words[1], y.1),
    ];
    let mut panel = Panel::new(Axis::linear(&axes[0]), Axis::linear(&axes[1]), 56.0);
    for (run, label, style) in agreement(&methods, &scaled, |_, _| true).curves {
        let points = paths[run].1.iter().map(|p| [p[0] * x.0, p[1] * y.0]);
        let mut series = Series::new(label, style, points.collect());
        if panel.series.is_empty() {
            series.draw = Draw::Path;
        }
        panel.series.push(series);
    }
    panel
}

fn figure(
    panels: Vec<Panel>,
    shear: &[(&RunKey, Path)],
    key: &RunKey,
    crack: &str,
    results: &Results,
    quantities: &[QuantityRow<'_>],
) -> Figure {
    let methods: Vec<&str> = shear.iter().map(|(key, _)| key.method.as_str()).collect();
    let agreed = || agreement(&methods, &scaled(shear).0, |_, _| true).title;
    let title = dissipation(key, results, quantities).unwrap_or_else(agreed);
    let path = format!("increments 1 to {}", key.increment);
    let caption = format!("{}, {}, {path}", problem(key), crack.replace('-', " "));
    Figure {
        own_legends: true,
        ..Figure::new(&title, &caption, panels.len(), panels)
    }
}

/// Dissipation of a run over the path, beside the closed form if the case states it.
fn dissipation(key: &RunKey, results: &Results, quantities: &[QuantityRow<'_>]) -> Option<String> {
    let own = |row: &&QuantityRow<'_>| {
        let quantity = row.quantity;
        row.key == *key && quantity.name == "dissipation" && quantity.at.is_empty()
    };
    let quantity = quantities.iter().find(own)?.quantity;
    let found = significant(quantity.value, 4);
    let mut stated = results.expectations.iter().filter(|row| row.key == *key);
    let stated = stated
        .find(|row| row.kind == "analytic" && row.quantity == "dissipation" && row.at.is_empty());
    let stated = stated.map(|row| format!(", closed form {}", significant(row.expected, 4)));
    let (unit, stated) = (plain(&quantity.unit), stated.unwrap_or_default());
    Some(format!("Friction takes {found} {unit}{stated}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resting_force_does_not_run_back() {
        assert!(!runs_back(&vec![
            [0.0, 0.0],
            [1.0, 1.0],
            [2.0, 1.0 - 1e-9],
            [3.0, 2.0]
        ]));
        assert!(runs_back(&vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.5]]));
    }
}
