//! Friction loops: the shear force that a crack carries against its mean slip, increment after increment.

use super::axis::{Axis, prefixed, range};
use super::canvas::{Width, italic, plain, subscript};
use super::chart::{Chart, Markers, Panel, Series};
use super::curve_direction;
use super::legend::Entry;
use super::method_curves::method_curves;
use super::names::by_run;
use super::style::Style;
use crate::report::ReportError;
use crate::report::number::value;
use crate::run::record::{QuantityRow, RunKey};
use std::collections::BTreeMap;

/// Paths of fewer increments are no loops.
const LEAST: usize = 4;

/// Difference that can be seen, as a fraction of the range.
const VISIBLE: f64 = 0.01;

/// A run: the crack unloaded, and after every increment, as [mean slip, shear force].
struct Run<'a> {
    key: &'a RunKey,
    path: Vec<[f64; 2]>,
}

/// Shear force −Σ p_a on a 2D crack against its mean slip, a curve per method, from the quantities `mean_slip` and
/// `contact_force` of runs of one problem. Runs that end before the others are left out. `notes` stand below the caption.
/// `None` where there are fewer than four increments, or no force and no slip that runs back.
///
/// # Errors
/// Those of drawing.
pub fn friction_loop(
    rows: &[QuantityRow],
    crack: usize,
    notes: &[String],
) -> Result<Option<String>, ReportError> {
    let runs = runs(rows, crack);
    let back = |run: &Run<'_>| !curve_direction::turns(&run.path).is_empty();
    let Some(first) = runs
        .first()
        .filter(|run| run.path.len() > LEAST && back(run))
    else {
        return Ok(None);
    };
    let largest = [0, 1].map(|c| {
        let values = runs.iter().flat_map(|run| &run.path).map(|p| p[c].abs());
        values.fold(0.0, f64::max)
    });
    let (slip, slip_unit) = prefixed(largest[0], "m");
    let (force, force_unit) = prefixed(largest[1], "N/m");
    let scaled = |run: &Run<'_>| -> Vec<f64> {
        let parts = [0, 1].map(|c| largest[c].max(f64::MIN_POSITIVE));
        let values = run
            .path
            .iter()
            .flat_map(|p| [p[0] / parts[0], p[1] / parts[1]]);
        values.collect()
    };
    let scaled: Vec<Vec<f64>> = runs.iter().map(scaled).collect();
    let methods: Vec<&str> = runs.iter().map(|run| run.key.method.as_str()).collect();
    let found = method_curves(&methods, &scaled, &Style::shared_below_exact(), |_, _| true);

    // Room for the numbers beside the points.
    let shown = |c: usize, factor: f64| {
        let values = runs.iter().flat_map(|run| &run.path).map(|p| p[c] * factor);
        let (low, high) = range(values).unwrap_or((0.0, 0.0));
        let room = [0.12, 0.08][c] * (high - low);
        [low - room, high + room]
    };
    let y_label = format!(
        "shear force −{}{} [{force_unit}]",
        italic("P"),
        subscript("a")
    );
    let drawn = found.curves.first().map_or(0, |curve| curve.run);
    let series = found.curves.iter().map(|curve| {
        // Marks that would lie on those of the first curve are left out, so that both can be seen.
        let own = |point: usize| {
            let apart = |c: usize| scaled[curve.run][2 * point + c] - scaled[drawn][2 * point + c];
            let seen = curve.run == drawn || (0..2).any(|c| apart(c).abs() > VISIBLE);
            let marker = curve.style.marker.filter(|_| seen)?;
            Some((marker, curve.style.filled))
        };
        let path = &runs[curve.run].path;
        Series {
            points: path.iter().map(|p| [p[0] * slip, p[1] * force]).collect(),
            style: curve.style.clone(),
            markers: (0..path.len()).map(own).collect(),
        }
    });
    let panel = Panel {
        x: Axis::linear(&format!("mean slip [{slip_unit}]"), shown(0, slip), 6),
        y: Axis::linear(&y_label, shown(1, force), 5),
        series: series.collect(),
        levels: Vec::new(),
        slopes: Vec::new(),
        markers: Markers::Direction,
    };
    let RunKey {
        case,
        mesh,
        space,
        friction,
        ..
    } = first.key;
    let mut caption = format!(
        "{}, {}, {}, {} = {}, crack {crack}, numbers: increments",
        plain(case),
        plain(mesh),
        plain(space),
        italic("μ"),
        value(*friction)
    );
    for note in found.notes.iter().chain(notes) {
        caption += &format!("\n{note}");
    }
    let entry = |(label, style): (&String, &Style)| Entry {
        label: label.clone(),
        style: style.clone(),
        line: true,
    };
    let entries = found.curves.iter().map(|c| entry((&c.label, &c.sample)));
    let mut entries: Vec<Entry> = entries.collect();
    // What stands for many methods has a long label: a row of its own.
    let rest = entries.split_off(found.notes.len().min(1));
    let chart = Chart {
        title: format!("Friction loop: {}, crack {crack}", plain(case)),
        caption,
        width: Width::Column,
        height: 56.0,
        panels: vec![panel],
        legend: vec![entries, rest],
    };
    chart.svg().map(Some)
}

/// Paths of the runs that go as far as any.
fn runs(rows: &[QuantityRow], crack: usize) -> Vec<Run<'_>> {
    let at = format!("crack-{crack}");
    let plane: Vec<&QuantityRow> = rows
        .iter()
        .filter(|row| row.quantity.at == at && row.quantity.component == "a")
        .collect();
    // The increment is no part of the run here.
    let name = |key: &RunKey| RunKey {
        increment: 0,
        ..key.clone()
    };
    let named: Vec<(RunKey, &QuantityRow)> =
        plane.into_iter().map(|row| (name(&row.key), row)).collect();
    let grouped = by_run(&named, |row| &row.0, |_, _| std::cmp::Ordering::Equal);
    let run = |rows: &Vec<&(RunKey, &'_ QuantityRow)>| {
        let mut values: BTreeMap<usize, [Option<f64>; 2]> = BTreeMap::new();
        for (_, row) in rows {
            let place = values.entry(row.key.increment).or_default();
            match row.quantity.name.as_str() {
                "mean_slip" => place[0] = Some(row.quantity.value),
                "contact_force" => place[1] = Some(-row.quantity.value),
                _ => {}
            }
        }
        let after = values.into_values().map_while(|[x, y]| Some([x?, y?]));
        std::iter::once([0.0; 2]).chain(after).collect::<Vec<_>>()
    };
    let mut runs: Vec<Run<'_>> = Vec::new();
    for rows in &grouped {
        let key = rows.iter().map(|(_, row)| &row.key).next();
        runs.extend(key.map(|key| Run {
            key,
            path: run(rows),
        }));
    }
    let longest = runs.iter().map(|run| run.path.len()).max().unwrap_or(0);
    let finite = |run: &Run<'_>| run.path.iter().flatten().all(|v| v.is_finite());
    runs.retain(|run| run.path.len() == longest && finite(run));
    runs
}
