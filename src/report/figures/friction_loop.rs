//! Friction loops: the shear force that a plane crack carries against its mean slip, increment after increment.

use super::agreement::agreement;
use super::kind::Kind;
use super::runs::{Run, problem};
use crate::report::names::problem_name;
use crate::report::number::significant;
use crate::report::plot::subscript;
use crate::report::plot::{Axis, Draw, Figure, Panel, Series, italic, plain, prefixed, rank};
use crate::report::{Bundle, ReportError};
use crate::studies::results::Results;
use crate::studies::rows::{QuantityRow, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// The kind.
pub static KIND: Kind = Kind {
    file: "*.loop.svg",
    question: "How much energy does friction take on this load path, and do the methods agree on it?",
    shows: "Shear force −P_a on a plane crack against its mean slip, from the unloaded crack through all \
            increments, where there are at least four and something runs back; runs that end before the others \
            are left out.",
};

/// Paths of fewer increments are no loops.
const LEAST: usize = 4;
/// Changes below this fraction of the range are no turn.
const NO_CHANGE: f64 = 1e-6;

/// Mean slip [m] and shear force [N/m] of a run, unloaded and after every increment.
type Path = Vec<[f64; 2]>;

/// One figure per problem and plane crack.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    // By problem and crack, then by method.
    type Runs<'a> = BTreeMap<(usize, &'a str), Run<'a, QuantityRow<'a>>>;
    let mut found: BTreeMap<(String, &str), Runs<'_>> = BTreeMap::new();
    let mut solids = BTreeSet::new();
    let quantities = results.quantities();
    for row in &quantities {
        let (quantity, method) = (&row.quantity, &row.key.method);
        if !["mean_slip", "contact_force"].contains(&quantity.name.as_str()) {
            continue;
        }
        let name = problem_name(&row.key);
        match quantity.component.as_str() {
            "a" => {
                let runs = found.entry((name, &quantity.at)).or_default();
                let run = runs.entry((rank(method), method));
                let (key, rows) = run.or_insert((&row.key, Vec::new()));
                if row.key.increment > key.increment {
                    *key = &row.key;
                }
                rows.push(row);
            }
            // A solid has slip along b too, which is no loop in a plane.
            "b" => _ = solids.insert(name),
            _ => {}
        }
    }
    for ((name, crack), runs) in found {
        let paths = runs.into_values().map(|(key, rows)| (key, path(&rows)));
        let mut paths: Vec<(&RunKey, Path)> = paths.collect();
        let longest = paths.iter().map(|(_, path)| path.len()).max().unwrap_or(0);
        paths.retain(|(_, path)| path.len() == longest);
        if longest > LEAST && runs_back(&paths[0].1) && !solids.contains(&name) {
            let figure = figure(&paths, crack, results, &quantities);
            KIND.add(bundle, &format!("{name}.{crack}"), figure.svg()?)?;
        }
    }
    Ok(())
}

/// As far as both quantities are known.
fn path(rows: &[&QuantityRow<'_>]) -> Path {
    let mut values: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for row in rows {
        let place = values.entry(row.key.increment).or_insert([f64::NAN; 2]);
        match row.quantity.name.as_str() {
            "mean_slip" => place[0] = row.quantity.value,
            _ => place[1] = -row.quantity.value,
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

fn figure(
    paths: &[(&RunKey, Path)],
    crack: &str,
    results: &Results,
    quantities: &[QuantityRow<'_>],
) -> Figure {
    let all = || paths.iter().flat_map(|(_, path)| path);
    let largest = [0, 1].map(|c| all().map(|p| p[c].abs()).fold(f64::MIN_POSITIVE, f64::max));
    let scaled = |(_, path): &(_, Path)| -> Vec<f64> {
        let part = |p: &[f64; 2]| [0, 1].map(|c| p[c] / largest[c]);
        path.iter().flat_map(part).collect()
    };
    let scaled: Vec<Vec<f64>> = paths.iter().map(scaled).collect();
    let methods: Vec<&str> = paths.iter().map(|(key, _)| key.method.as_str()).collect();
    let found = agreement(&methods, &scaled, |_, _| true);
    let [slip, force] = [prefixed(largest[0], "m"), prefixed(largest[1], "N/m")];
    let symbol = format!("{}{}", italic("P"), subscript("a"));
    let y = format!("shear force −{symbol} [{}]", force.1);
    let x = Axis::linear(&format!("mean slip [{}]", slip.1));
    let mut panel = Panel::new(x, Axis::linear(&y), 56.0);
    for (run, label, style) in found.curves {
        let points = paths[run].1.iter().map(|p| [p[0] * slip.0, p[1] * force.0]);
        let mut series = Series::new(label, style, points.collect());
        if panel.series.is_empty() {
            series.draw = Draw::Path;
        }
        panel.series.push(series);
    }
    let key = paths[0].0;
    let title = dissipation(key, results, quantities).unwrap_or(found.title);
    let path = format!("increments 1 to {}", key.increment);
    let caption = format!("{}, {}, {path}", problem(key), crack.replace('-', " "));
    Figure::new(&title, &caption, 1, vec![panel])
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
