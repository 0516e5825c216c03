//! Friction loops: the shear force that a plane crack carries against its mean slip, increment after increment.

use super::agreement::agreement;
use super::runs::problem;
use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::plot::{
    Axis, Draw, Figure, Panel, Series, italic, plain, prefixed, rank, subscript,
};
use crate::report::standard::problem_name;
use crate::run::record::{QuantityRow, Results, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// What it is.
pub static KIND: Kind = Kind {
    file: "*.loop.svg",
    question: "How much energy does friction take on this load path, and do the methods agree on it?",
    shows: "Shear force −P_a on a plane crack against its mean slip, from the unloaded crack through all increments; numbers are \
            increments at which force or slip turn back. Drawn where there are at least four increments and something runs \
            back; runs that end before the others are left out.",
};

/// Paths of fewer increments are no loops.
const LEAST: usize = 4;
/// Paths of fewer increments have all of them numbered.
const FEW: usize = 8;
/// Changes below this fraction of the range are no turn.
const NO_CHANGE: f64 = 1e-6;

/// Mean slip [m] and shear force [N/m] of a run, unloaded and after every increment.
type Path = Vec<[f64; 2]>;

/// One figure per problem and plane crack.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    // A solid has slip along b too, which is no loop in a plane.
    let solid =
        |row: &&QuantityRow| row.quantity.name == "mean_slip" && row.quantity.component == "b";
    let solids = results.quantities.iter().filter(solid);
    let solids: BTreeSet<String> = solids.map(|row| problem_name(&row.key)).collect();
    type Runs<'a> = BTreeMap<(usize, &'a str), (&'a RunKey, BTreeMap<usize, [Option<f64>; 2]>)>;
    let mut found: BTreeMap<(String, &str), Runs<'_>> = BTreeMap::new();
    for row in results
        .quantities
        .iter()
        .filter(|row| row.quantity.component == "a")
    {
        let which = ["mean_slip", "contact_force"]
            .iter()
            .position(|name| *name == row.quantity.name);
        let (Some(which), name) = (which, problem_name(&row.key)) else {
            continue;
        };
        if !solids.contains(&name) && row.quantity.at.starts_with("crack-") {
            let runs = found.entry((name, &row.quantity.at)).or_default();
            let run = runs.entry((rank(&row.key.method), &row.key.method));
            let (key, path) = run.or_insert_with(|| (&row.key, BTreeMap::new()));
            *key = if row.key.increment > key.increment {
                &row.key
            } else {
                *key
            };
            let sign = [1.0, -1.0][which];
            path.entry(row.key.increment).or_default()[which] = Some(sign * row.quantity.value);
        }
    }
    for ((name, crack), runs) in found {
        let mut paths: Vec<(&RunKey, Path)> = Vec::new();
        for (key, path) in runs.into_values() {
            let after = path.into_values().map_while(|[x, y]| Some([x?, y?]));
            let path: Path = std::iter::once([0.0; 2]).chain(after).collect();
            if path.iter().flatten().all(|v| v.is_finite()) {
                paths.push((key, path));
            }
        }
        let longest = paths.iter().map(|(_, path)| path.len()).max().unwrap_or(0);
        paths.retain(|(_, path)| path.len() == longest);
        let back = paths
            .first()
            .is_some_and(|(_, path)| !turns(path).is_empty());
        if longest > LEAST && back {
            KIND.add(
                bundle,
                &format!("{name}.{crack}"),
                figure(&paths, crack, results).svg()?,
            )?;
        }
    }
    Ok(())
}

fn figure(paths: &[(&RunKey, Path)], crack: &str, results: &Results) -> Figure {
    let all = || paths.iter().flat_map(|(_, path)| path);
    let largest = [0, 1].map(|c| all().map(|p| p[c].abs()).fold(f64::MIN_POSITIVE, f64::max));
    let scaled = |path: &Path| {
        path.iter()
            .flat_map(|p| [p[0] / largest[0], p[1] / largest[1]])
            .collect()
    };
    let scaled: Vec<Vec<f64>> = paths.iter().map(|(_, path)| scaled(path)).collect();
    let methods: Vec<&str> = paths.iter().map(|(key, _)| key.method.as_str()).collect();
    let found = agreement(&methods, &scaled, |_, _| true);
    let (slip, slip_unit) = prefixed(largest[0], "m");
    let (force, force_unit) = prefixed(largest[1], "N/m");
    let y = format!(
        "shear force −{}{} [{force_unit}]",
        italic("P"),
        subscript("a")
    );
    let x = Axis::linear(&format!("mean slip [{slip_unit}]"));
    let mut panel = Panel::new(x, Axis::linear(&y), 56.0);
    for (index, (run, label, style)) in found.curves.into_iter().enumerate() {
        let path = &paths[run].1;
        let mut series = Series::new(
            label,
            style,
            path.iter().map(|p| [p[0] * slip, p[1] * force]).collect(),
        );
        if index == 0 {
            series.draw = Draw::Path;
            series.texts = numbers(path, largest);
        }
        panel.series.push(series);
    }
    // Room for the numbers beside the points.
    for corner in [-1.0, 1.0] {
        let ends = [0, 1].map(|c| {
            all()
                .map(|p| corner * p[c])
                .fold(f64::NEG_INFINITY, f64::max)
        });
        let at =
            [0, 1].map(|c| corner * (ends[c] + [0.12, 0.08][c] * largest[c]) * [slip, force][c]);
        panel.series.push(Series::new(
            "",
            super::super::plot::Style::line([255; 3], 0.0, &[]),
            vec![at],
        ));
    }
    let title = dissipation(paths[0].0, results).unwrap_or(found.title);
    let caption = format!(
        "{}, {}; numbers: increments\n{}",
        problem(paths[0].0),
        crack.replace('-', " "),
        found.caption
    );
    Figure::new(title, caption, vec![panel])
}

/// What the first method dissipates over the path, beside the closed form if the case states it.
fn dissipation(key: &RunKey, results: &Results) -> Option<String> {
    let own = |row: &&QuantityRow| row.key == *key && row.quantity.name == "dissipation";
    let row = results.quantities.iter().find(own)?;
    let stated = results
        .expectations
        .iter()
        .find(|row| row.kind == "analytic" && row.quantity == "dissipation" && row.key == *key);
    let (value, unit) = (
        significant(row.quantity.value, 4),
        plain(&row.quantity.unit),
    );
    let stated = stated.map_or(String::new(), |row| {
        format!(", closed form {}", significant(row.expected, 4))
    });
    Some(format!("Friction takes {value} {unit}{stated}"))
}

/// Indices of the points behind which a coordinate changes the other way than before. Points that repeat a coordinate
/// change nothing: on a hysteresis loop the force turns after it has rested.
fn turns(path: &Path) -> Vec<usize> {
    let mut turns = Vec::new();
    for c in [0, 1] {
        let ends = path
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| {
                [a.min(p[c]), b.max(p[c])]
            });
        let mut before = 0.0;
        for (index, pair) in path.windows(2).enumerate() {
            let change = pair[1][c] - pair[0][c];
            if change.abs() > NO_CHANGE * (ends[1] - ends[0]) {
                if change * before < 0.0 {
                    turns.push(index);
                }
                before = change;
            }
        }
    }
    turns.sort_unstable();
    turns.dedup();
    turns
}

/// Numbers of the increments to name, those in one place at the first of them.
fn numbers(path: &Path, largest: [f64; 2]) -> Vec<String> {
    let mut named = if path.len() <= FEW {
        (0..path.len()).collect()
    } else {
        turns(path)
    };
    named.extend([0, path.len() - 1]);
    named.sort_unstable();
    named.dedup();
    let mut texts = vec![String::new(); path.len()];
    for index in named.iter().copied() {
        let near = |other: &&usize| {
            (0..2).all(|c| (path[**other][c] - path[index][c]).abs() < 0.05 * largest[c])
        };
        match named.iter().take_while(|other| **other < index).find(near) {
            Some(first) => texts[*first] += &format!(", {index}"),
            None => texts[index] = index.to_string(),
        }
    }
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_turns_where_a_coordinate_runs_back() {
        // A hysteresis loop: up, along the top, down, along the bottom, up.
        let path = [
            [0.0, 0.0],
            [0.0, 1.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [2.0, -1.0],
            [1.0, -1.0],
            [1.0, 0.0],
        ];
        assert_eq!(turns(&path.to_vec()), [3, 4, 5]);
        assert!(turns(&path[..4].to_vec()).is_empty());
        // Round-off of a resting force is no turn.
        assert!(turns(&vec![[0.0, 0.0], [1.0, 1.0], [2.0, 1.0 - 1e-9], [3.0, 2.0]]).is_empty());
    }
}
