//! Traction, slip and gap along a plane crack, with the contact status at every point.

use super::agreement::agreement;
use super::kind::Kind;
use super::runs::{Run, body, by_problem, friction, problem};
use crate::report::number::significant;
use crate::report::plot::{Axis, Figure, Panel, Series, Style, italic, plain, prefixed, rank};
use crate::report::plot::{status_marker, subscript};
use crate::report::standard::file_name;
use crate::report::{Bundle, ReportError};
use crate::run::record::{ExactRow, PointRow, Results, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// What it is.
pub static KIND: Kind = Kind {
    file: "*.profile.svg",
    question: "What happens along the crack, and do the methods agree on it?",
    shows: "Contact traction p_n and |p_t| with the slip limit μ p_n, slip and, where the crack opens, normal \
            gap along a plane crack in the last increment, with a closed form where there is one; markers tell \
            stick, slip and open. A file per problem with all methods that did what they claim, and one per body \
            with all friction coefficients by the first exact method.",
};

/// Jumps below this fraction of the crack's length are what the tolerance of a method leaves.
const ROUND_OFF: f64 = 1e-10;
/// Difference that can be seen, as a fraction of the largest value.
const VISIBLE: f64 = 0.01;

/// A quantity along the crack: name, unit, its value at a point and in closed form.
type Along = (
    String,
    &'static str,
    fn(&PointRow) -> f64,
    fn(&ExactRow) -> f64,
);

fn quantities() -> [Along; 4] {
    let p = |index: &str| format!("{}{}", italic("p"), subscript(index));
    let normal = |row: &PointRow| row.point.p_n / row.point.weight;
    let tangential = |row: &PointRow| row.point.p_a.hypot(row.point.p_b) / row.point.weight;
    [
        (p("n"), "Pa", normal, |row| row.p_n_pa),
        (format!("|{}|", p("t")), "Pa", tangential, |row| {
            row.p_a_pa.abs()
        }),
        (
            "slip".into(),
            "m",
            |row| row.point.slip_a_m,
            |row| row.slip_a_m,
        ),
        (
            "normal gap".into(),
            "m",
            |row| row.point.gap_m,
            |row| row.gap_m,
        ),
    ]
}

/// One figure per problem and crack with all methods that did what they claim, and per body and crack one with all friction
/// coefficients by the first method that has several.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    let mut honest = results.runs.iter().filter(|row| row.verdict.is_honest());
    let honest: Vec<&RunKey> = honest.by_ref().map(|row| &row.key).collect();
    // By body, crack and method.
    type Sweeps<'a> = BTreeMap<(String, usize, usize, &'a str), Vec<Run<'a, PointRow>>>;
    let mut sweeps: Sweeps<'_> = BTreeMap::new();
    for (name, mut runs) in by_problem(&results.points, |row: &PointRow| &row.key) {
        runs.retain(|(key, _)| honest.contains(key));
        let points = runs.iter().flat_map(|(_, rows)| rows);
        let plane = points.filter(|row| row.point.force_unit == "N/m");
        for crack in plane
            .map(|row| row.point.crack)
            .collect::<BTreeSet<usize>>()
        {
            let mut own = runs.clone();
            for (_, rows) in &mut own {
                rows.retain(|row| row.point.crack == crack);
                rows.sort_by(|a, b| a.point.s_m.total_cmp(&b.point.s_m));
            }
            own.retain(|(_, rows)| !rows.is_empty());
            let figure = Profile::new(&own, &results.exact, crack).by_method();
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
            let figure = Profile::new(&runs, &results.exact, crack).by_friction();
            let name = format!("{body}.{}.crack-{crack}", file_name(&[method]));
            KIND.add(bundle, &name, figure.svg()?)?;
        }
    }
    Ok(())
}

/// Runs on one crack.
struct Profile<'a> {
    runs: &'a [Run<'a, PointRow>],
    /// Closed forms by friction coefficient.
    exact: BTreeMap<u64, Vec<&'a ExactRow>>,
    crack: usize,
    /// What the tolerance of a method leaves of a jump [m].
    round_off: f64,
}

impl<'a> Profile<'a> {
    fn new(runs: &'a [Run<'a, PointRow>], exact: &'a [ExactRow], crack: usize) -> Self {
        let mut closed: BTreeMap<u64, Vec<&ExactRow>> = BTreeMap::new();
        for row in exact.iter().filter(|row| row.crack == crack) {
            let of = (&row.case, row.friction, row.increment);
            if runs
                .iter()
                .any(|(key, _)| of == (&key.case, key.friction, key.increment))
            {
                closed.entry(row.friction.to_bits()).or_default().push(row);
            }
        }
        let by_place = |a: &&ExactRow, b: &&ExactRow| a.s_m.total_cmp(&b.s_m);
        closed
            .values_mut()
            .for_each(|curve| curve.sort_by(by_place));
        let places = runs
            .iter()
            .flat_map(|(_, rows)| rows)
            .map(|row| row.point.s_m.abs());
        let round_off = ROUND_OFF * places.fold(0.0, f64::max);
        Self {
            runs,
            exact: closed,
            crack,
            round_off,
        }
    }

    fn has(&self, status: &str) -> bool {
        let mut rows = self.runs.iter().flat_map(|(_, rows)| rows);
        rows.any(|row| row.point.status == status)
    }

    fn largest(&self, (_, _, of, exact): &Along) -> f64 {
        let closed = self.exact.values().flatten().map(|row| exact(row).abs());
        let rows = self.runs.iter().flat_map(|(_, rows)| rows);
        let values = rows.map(|row| of(row).abs()).chain(closed);
        values.filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// All methods on one problem; differences are compared with the largest traction and the largest jump.
    fn by_method(&self) -> Figure {
        let all = quantities();
        let largest: Vec<f64> = all.iter().map(|along| self.largest(along)).collect();
        let traction = largest[0].max(largest[1]).max(f64::MIN_POSITIVE);
        let jump = largest[2]
            .max(largest[3])
            .max(self.round_off)
            .max(f64::MIN_POSITIVE);
        let values = |(_, rows): &Run<'_, PointRow>| -> Vec<f64> {
            let scale = |unit: &str| if unit == "m" { jump } else { traction };
            let along = |(_, unit, of, _): &Along| -> Vec<f64> {
                rows.iter().map(|row| of(row) / scale(unit)).collect()
            };
            all.iter().flat_map(along).collect()
        };
        let scaled: Vec<Vec<f64>> = self.runs.iter().map(values).collect();
        let methods: Vec<&str> = self
            .runs
            .iter()
            .map(|(key, _)| key.method.as_str())
            .collect();
        let status = |run: usize| self.runs[run].1.iter().map(|row| &row.point.status);
        let found = agreement(&methods, &scaled, |a, b| status(a).eq(status(b)));
        let note = "differences as fractions of the largest traction or jump";
        let caption = format!("{}, crack {}; {note}", problem(self.runs[0].0), self.crack);
        self.figure(&found.title, &caption, &found.curves)
    }

    /// One method with several friction coefficients.
    fn by_friction(&self) -> Figure {
        let (factor, unit) = prefixed(self.largest(&quantities()[2]), "m");
        let told = |(key, rows): &Run<'_, PointRow>| {
            let slip = rows
                .iter()
                .map(|row| row.point.slip_a_m.abs())
                .fold(0.0, f64::max);
            let slip = if slip < self.round_off { 0.0 } else { slip };
            format!(
                "{} {unit} at {}",
                significant(slip * factor, 3),
                friction(key.friction)
            )
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
        let all = quantities();
        // Gaps of closed points are round-off; a panel of round-off says nothing.
        let opens = self.has("open") || self.largest(&all[3]) > 1e-6 * self.largest(&all[2]);
        let shown = &all[..if opens { 4 } else { 3 }];
        let mut panels: Vec<Panel> = shown
            .iter()
            .map(|along| self.panel(along, curves))
            .collect();
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

    fn panel(&self, along: &Along, curves: &[(usize, String, Style)]) -> Panel {
        let (name, unit, of, exact) = along;
        let largest = self.largest(along);
        // Jumps of sticking points are round-off: they are drawn as zero, not on an axis of attometres.
        let (factor, unit) = match *unit == "m" && largest < self.round_off {
            true => (0.0, unit.to_string()),
            false => prefixed(largest, unit),
        };
        let y = Axis::linear(&format!("{name} [{unit}]")).through(&[0.0]);
        let mut panel = Panel::new(Axis::linear("distance along the crack [m]"), y, 34.0);
        let (first, band) = (&self.runs[curves[0].0].1, curves[0].2.behind);
        for (index, (run, label, style)) in curves.iter().enumerate() {
            let (key, rows) = &self.runs[*run];
            if name.starts_with('|') && key.friction > 0.0 && (index == 0 || !band) {
                let limit = |row: &PointRow| key.friction * (quantities()[0].2)(row).max(0.0);
                let points = rows.iter().map(|row| [row.point.s_m, limit(row) * factor]);
                let label = format!(
                    "slip limit {} {}{}",
                    italic("μ"),
                    italic("p"),
                    subscript("n")
                );
                panel
                    .series
                    .push(Series::new(label, Style::limit(), points.collect()));
            }
            let points = rows.iter().map(|row| [row.point.s_m, of(row) * factor]);
            let mut series = Series::new(label, style.clone(), points.collect());
            // Marks that would lie on those of the first curve are left out, so that both can be seen.
            let hidden = |n: usize, row: &PointRow| {
                let below = first.get(n).filter(|_| index > 0 && band);
                below.is_some_and(|b| {
                    let near = (of(b) - of(row)).abs() < VISIBLE * largest;
                    near && b.point.status == row.point.status
                })
            };
            let mark = |(n, row): (usize, &&PointRow)| {
                (!hidden(n, row)).then(|| status_marker(&row.point.status))
            };
            series.marks = rows.iter().enumerate().map(mark).collect();
            panel.series.push(series);
        }
        for curve in self.exact.values() {
            let points = curve.iter().map(|row| [row.s_m, exact(row) * factor]);
            let series = Series::new("closed form", Style::exact(), points.collect());
            panel.series.push(series);
        }
        panel
    }
}
