//! Traction, slip and gap along a plane crack, with the contact status at every point.

use super::agreement::agreement;
use super::kind::Kind;
use super::runs::{Run, body, by_problem, friction, moment};
use crate::model::quantities::PointState;
use crate::report::names::file_name;
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, italic, plain, prefixed, rank};
use crate::report::plot::{status_marker, subscript};
use crate::report::{Bundle, ReportError};
use crate::studies::results::Results;
use crate::studies::rows::{ExactPoint, IncrementRow, PointRow, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// The kind.
pub static KIND: Kind = Kind {
    file: "*.profile.svg",
    question: "What happens along the crack, and do the methods agree on it?",
    shows: "Contact traction p_n and |p_t| with the slip limit μ p_n, slip and, where the crack opens, normal \
            gap along a plane crack in the last increment and in those chosen, with a closed form where there is one; markers tell \
            stick, slip and open. A file per problem with all methods that did what they claim, and one per body \
            with all friction coefficients by the first exact method.",
};

/// Jumps below this fraction of the crack's length are round-off.
const ROUND_OFF: f64 = 1e-10;
/// Difference that can be seen, as a fraction of the largest value.
const VISIBLE: f64 = 0.01;

/// Quantities along the crack by number: p_n, |p_t|, slip, normal gap.
const UNITS: [&str; 4] = ["Pa", "Pa", "m", "m"];

fn name(quantity: usize) -> String {
    let p = |index: &str| format!("{}{}", italic("p"), subscript(index));
    match quantity {
        0 => p("n"),
        1 => format!("|{}|", p("t")),
        2 => "slip".into(),
        _ => "normal gap".into(),
    }
}

fn found(point: &PointState, quantity: usize) -> f64 {
    match quantity {
        0 => point.p_n / point.weight,
        1 => point.p_a.hypot(point.p_b) / point.weight,
        2 => point.slip_a_m,
        _ => point.gap_m,
    }
}

/// One figure per problem and crack with all methods that did what they claim, and per body and crack one with all friction
/// coefficients by the first method that has several.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    let (increments, points) = (results.increments(), results.points());
    let honest = increments.iter().filter(|row| row.step.verdict.is_honest());
    let honest: Vec<&RunKey> = honest.map(|row| &row.key).collect();
    let sizes = (&results.exact[..], &increments[..]);
    // By body, crack and method.
    type Sweeps<'a> = BTreeMap<(String, usize, usize, &'a str), Vec<Run<'a, PointRow<'a>>>>;
    let mut sweeps: Sweeps<'_> = BTreeMap::new();
    for (name, mut runs) in by_problem(&points, |row: &PointRow<'_>| &row.key) {
        runs.retain(|(key, _)| honest.contains(key));
        let points = runs.iter().flat_map(|(_, rows)| rows);
        let plane = points.filter(|row| row.point.force_unit == "N/m");
        let cracks: BTreeSet<usize> = plane.map(|row| row.point.crack).collect();
        for crack in cracks {
            let mut own = runs.clone();
            for (_, rows) in &mut own {
                rows.retain(|row| row.point.crack == crack);
                rows.sort_by(|a, b| a.point.s_m.total_cmp(&b.point.s_m));
            }
            own.retain(|(_, rows)| !rows.is_empty());
            let figure = Profile::new(&own, sizes, crack).by_method();
            KIND.add(bundle, &format!("{name}.crack-{crack}"), figure.svg()?)?;
            for (key, rows) in own {
                let body = file_name(&[&key.case, &key.mesh, &key.space]);
                let sweep = sweeps.entry((body, crack, rank(&key.method), &key.method));
                sweep.or_default().push((key, rows));
            }
        }
    }
    let mut done = BTreeSet::new();
    for ((body, crack, _, method), mut runs) in sweeps {
        if runs.len() > 1 && done.insert((body.clone(), crack)) {
            runs.sort_by(|a, b| a.0.friction.total_cmp(&b.0.friction));
            let figure = Profile::new(&runs, sizes, crack).by_friction();
            let name = format!("{body}.{}.crack-{crack}", file_name(&[method]));
            KIND.add(bundle, &name, figure.svg()?)?;
        }
    }
    Ok(())
}

/// Runs on one crack.
struct Profile<'a> {
    runs: &'a [Run<'a, PointRow<'a>>],
    /// Closed forms by friction coefficient.
    exact: BTreeMap<u64, Vec<&'a ExactPoint>>,
    crack: usize,
    /// Round-off of a jump [m].
    round_off: f64,
    /// Rest that the tolerance leaves of contact forces [N/m] and of jumps [m], by run.
    left: Vec<[f64; 2]>,
}

/// Tolerance × reference sizes of an increment.
fn left_by_tolerance(row: &IncrementRow<'_>) -> [f64; 2] {
    let judge = &row.step.judge;
    let left = [judge.reference_force, judge.reference_jump_m];
    left.map(|size| (row.record.asked.tolerance * size).max(0.0))
}

impl<'a> Profile<'a> {
    fn new(
        runs: &'a [Run<'a, PointRow<'a>>],
        (exact, increments): (&'a [ExactPoint], &[IncrementRow<'_>]),
        crack: usize,
    ) -> Self {
        let mut curves: BTreeMap<u64, Vec<&ExactPoint>> = BTreeMap::new();
        for row in exact.iter().filter(|row| row.point.crack == crack) {
            let of = (&row.key.case, row.key.friction, row.key.increment);
            let own = |(key, _): &Run<'_, _>| of == (&key.case, key.friction, key.increment);
            if runs.iter().any(own) {
                curves
                    .entry(row.key.friction.to_bits())
                    .or_default()
                    .push(row);
            }
        }
        for curve in curves.values_mut() {
            curve.sort_by(|a, b| a.point.s_m.total_cmp(&b.point.s_m));
        }
        let rows = runs.iter().flat_map(|(_, rows)| rows);
        let length = rows.map(|row| row.point.s_m.abs()).fold(0.0, f64::max);
        Self {
            runs,
            exact: curves,
            crack,
            round_off: ROUND_OFF * length,
            left: (runs.iter())
                .map(|(key, _)| {
                    let mut rows = increments.iter();
                    let own = rows.find(|row| row.key == **key);
                    own.map_or([0.0; 2], left_by_tolerance)
                })
                .collect(),
        }
    }

    /// Whether a quantity is nowhere more than round-off and what the tolerance leaves: its size says nothing.
    fn is_noise(&self, quantity: usize) -> bool {
        let jump = quantity >= 2;
        let mut exact = self.exact.values().flatten();
        let small = |row: &PointRow<'_>, [force, gap]: [f64; 2]| {
            if jump {
                found(row.point, quantity).abs() <= gap.max(self.round_off)
            } else {
                found(row.point, quantity).abs() * row.point.weight <= force
            }
        };
        let mut runs = self.runs.iter().zip(&self.left);
        exact
            .all(|row| found(&row.point, quantity).abs() <= if jump { self.round_off } else { 0.0 })
            && runs.all(|((_, rows), left)| rows.iter().all(|row| small(row, *left)))
    }

    fn has(&self, status: &str) -> bool {
        let mut rows = self.runs.iter().flat_map(|(_, rows)| rows);
        rows.any(|row| row.point.status == status)
    }

    fn largest(&self, quantity: usize) -> f64 {
        let exact = self.exact.values().flatten();
        let exact = exact.map(|row| found(&row.point, quantity));
        let rows = self.runs.iter().flat_map(|(_, rows)| rows);
        let values = rows.map(|row| found(row.point, quantity)).chain(exact);
        let values = values.filter(|v| v.is_finite());
        values.fold(0.0, |largest, v| v.abs().max(largest))
    }

    /// All methods on one problem; differences are compared with the largest traction and the largest jump.
    fn by_method(&self) -> Figure {
        let largest = [0, 1, 2, 3].map(|quantity| self.largest(quantity));
        // Noise is not compared with itself.
        let traction = if self.is_noise(0) && self.is_noise(1) {
            f64::INFINITY
        } else {
            largest[0].max(largest[1]).max(f64::MIN_POSITIVE)
        };
        let jump = largest[2]
            .max(largest[3])
            .max(self.round_off.max(f64::MIN_POSITIVE));
        let scale = [traction, traction, jump, jump];
        let values = |(_, rows): &Run<'_, PointRow<'_>>| -> Vec<f64> {
            let of = |q: usize| rows.iter().map(move |row| found(row.point, q) / scale[q]);
            (0..4).flat_map(of).collect()
        };
        let scaled: Vec<Vec<f64>> = self.runs.iter().map(values).collect();
        let methods = self.runs.iter().map(|(key, _)| key.method.as_str());
        let status = |run: usize| self.runs[run].1.iter().map(|row| &row.point.status);
        let alike = |a, b| status(a).eq(status(b));
        let found = agreement(&methods.collect::<Vec<_>>(), &scaled, alike);
        let note = "differences as fractions of the largest traction or jump";
        let caption = format!("{}, crack {}; {note}", moment(self.runs[0].0), self.crack);
        self.figure(&found.title, &caption, &found.curves)
    }

    /// One method with several friction coefficients.
    fn by_friction(&self) -> Figure {
        let (factor, unit) = prefixed(self.largest(2), "m");
        let told = |(key, rows): &Run<'_, PointRow<'_>>| {
            let slips = rows.iter().map(|row| row.point.slip_a_m.abs());
            let slip = slips
                .filter(|slip| *slip >= self.round_off)
                .fold(0.0, f64::max);
            let slip = significant(slip * factor, 3);
            format!("{slip} {unit} at {}", friction(key.friction))
        };
        let ends = [&self.runs[0], &self.runs[self.runs.len() - 1]].map(told);
        let title = format!("Largest slip {}", ends.join(", "));
        let looks = (0..).map(|i| Style::curve(i).bare());
        let curves = self.runs.iter().zip(looks).enumerate();
        let curves = curves.map(|(i, ((key, _), look))| (i, friction(key.friction), look));
        let key = self.runs[0].0;
        let caption = format!(
            "{}, {}, crack {}",
            body(key),
            plain(&key.method),
            self.crack
        );
        self.figure(&title, &caption, &curves.collect::<Vec<_>>())
    }

    fn figure(&self, title: &str, caption: &str, curves: &[(usize, String, Style)]) -> Figure {
        // Gaps of closed points are round-off; a panel of round-off says nothing.
        let opens = self.has("open") || self.largest(3) > 1e-6 * self.largest(2);
        let shown = if opens { 4 } else { 3 };
        let panels = (0..shown).map(|quantity| self.panel(quantity, curves));
        let mut panels: Vec<Panel> = panels.collect();
        for status in ["stick", "slip", "open"] {
            if self.has(status) {
                let (marker, filled) = status_marker(status);
                let sample = Series::new(status, Style::mark(marker, filled), Vec::new());
                panels[0].series.push(sample);
            }
        }
        let columns = if opens { 2 } else { 3 };
        Figure::new(title, caption, columns, panels)
    }

    fn panel(&self, quantity: usize, curves: &[(usize, String, Style)]) -> Panel {
        let (largest, unit) = (self.largest(quantity), UNITS[quantity]);
        // Jumps of sticking points and forces of open ones are drawn as zero, not on an axis of attometres or millipascals.
        let (factor, unit) = if self.is_noise(quantity) {
            (0.0, unit.to_owned())
        } else {
            prefixed(largest, unit)
        };
        let y = Axis::linear(&format!("{} [{unit}]", name(quantity))).through(&[0.0]);
        let mut panel = Panel::new(Axis::linear("distance along the crack [m]"), y, 34.0);
        let (first, band) = (&self.runs[curves[0].0].1, curves[0].2.behind);
        for (index, (run, label, style)) in curves.iter().enumerate() {
            let (key, rows) = &self.runs[*run];
            if quantity == 1 && key.friction > 0.0 && (index == 0 || !band) {
                let limit = |row: &PointRow<'_>| key.friction * found(row.point, 0).max(0.0);
                let points = rows.iter().map(|row| [row.point.s_m, limit(row) * factor]);
                let label = format!("slip limit {} {}", italic("μ"), name(0));
                let series = Series::new(label, Style::limit(), points.collect());
                panel.series.push(series);
            }
            let value = |row: &PointRow<'_>| found(row.point, quantity) * factor;
            let points = rows.iter().map(|row| [row.point.s_m, value(row)]);
            let mut series = Series::new(label, style.clone(), points.collect());
            // Marks that would lie on those of the first curve are left out, so that both can be seen.
            let hidden = |n: usize, row: &PointRow<'_>| {
                let below = first.get(n).filter(|_| index > 0 && band);
                below.is_some_and(|b| {
                    let near = (value(b) - value(row)).abs() < VISIBLE * largest * factor;
                    near && b.point.status == row.point.status
                })
            };
            for (n, row) in rows.iter().enumerate() {
                let mark = (!hidden(n, row)).then(|| status_marker(&row.point.status));
                series.marks.push(mark);
            }
            panel.series.push(series);
        }
        for curve in self.exact.values() {
            let points = curve
                .iter()
                .map(|row| [row.point.s_m, found(&row.point, quantity) * factor]);
            let series = Series::new("closed form", Style::exact(), points.collect());
            panel.series.push(series);
        }
        panel
    }
}
