//! Traction, slip and gap along a plane crack, with the contact status at every point.

use super::agreement::agreement;
use super::runs::{Run, body, by_problem, friction, problem};
use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::plot::{
    Axis, Figure, Panel, Series, Style, italic, plain, prefixed, rank, status_marker, subscript,
};
use crate::report::standard::file_name;
use crate::run::record::{ExactRow, PointRow, Results, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// What it is.
pub static KIND: Kind = Kind {
    file: "*.profile.svg",
    question: "What happens along the crack, and do the methods agree on it?",
    shows: "Contact traction p_n and |p_t| with the slip limit μ p_n, slip and, where the crack opens, normal gap along a plane \
            crack in the last increment; markers tell stick, slip and open, thin black lines a closed form. One file per \
            problem with all methods, and one per body with all friction coefficients by the first exact method.",
};

/// Jumps below this fraction of the crack's length are what the tolerance of a method leaves.
const ROUND_OFF: f64 = 1e-10;
/// Difference that can be seen, as a fraction of the largest value.
const VISIBLE: f64 = 0.01;
/// Height of a panel [mm].
const HEIGHT_MM: f64 = 34.0;

/// A quantity along the crack.
struct Along {
    name: String,
    unit: &'static str,
    of: fn(&PointRow) -> f64,
    exact: fn(&ExactRow) -> f64,
}

fn quantities() -> [Along; 4] {
    let p = |index: &str| format!("{}{}", italic("p"), subscript(index));
    [
        Along {
            name: p("n"),
            unit: "Pa",
            of: |row| row.point.p_n / row.point.weight,
            exact: |row| row.p_n_pa,
        },
        Along {
            name: format!("|{}|", p("t")),
            unit: "Pa",
            of: |row| row.point.p_a.hypot(row.point.p_b) / row.point.weight,
            exact: |row| row.p_a_pa.abs(),
        },
        Along {
            name: "slip".into(),
            unit: "m",
            of: |row| row.point.slip_a_m,
            exact: |row| row.slip_a_m,
        },
        Along {
            name: "normal gap".into(),
            unit: "m",
            of: |row| row.point.gap_m,
            exact: |row| row.gap_m,
        },
    ]
}

/// One figure per problem and crack with all methods that did what they claim, and per body and crack one with all friction
/// coefficients by the first method that has several.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    let honest = |key: &RunKey| {
        results
            .runs
            .iter()
            .any(|row| row.key == *key && row.verdict.is_honest())
    };
    // By body, crack and method.
    type Sweeps<'a> = BTreeMap<(String, usize, usize, &'a str), Vec<Run<'a, PointRow>>>;
    let mut sweeps: Sweeps<'_> = BTreeMap::new();
    for (name, mut runs) in by_problem(&results.points, |row: &PointRow| &row.key) {
        runs.retain(|run| {
            run.rows.iter().all(|row| row.point.force_unit == "N/m") && honest(run.key)
        });
        let points = runs.iter().flat_map(|run| &run.rows);
        let cracks: BTreeSet<usize> = points.map(|row| row.point.crack).collect();
        for crack in cracks {
            let mut curves: Vec<(&RunKey, Vec<&PointRow>)> = Vec::new();
            for run in &runs {
                let mut rows = run.rows.clone();
                rows.retain(|row| row.point.crack == crack);
                rows.sort_by(|a, b| a.point.s_m.total_cmp(&b.point.s_m));
                if !rows.is_empty() {
                    curves.push((run.key, rows));
                }
            }
            let figure = Profile::new(&curves, &results.exact, crack).by_method();
            KIND.add(bundle, &format!("{name}.crack-{crack}"), figure.svg()?)?;
            for (key, rows) in curves {
                let body = file_name(&[&key.case, &key.mesh, &key.space]);
                let sweep = sweeps.entry((body, crack, rank(&key.method), &key.method));
                sweep.or_default().push(Run { key, rows });
            }
        }
    }
    let mut done = BTreeSet::new();
    for ((body, crack, _, method), runs) in sweeps {
        if runs.len() > 1 && done.insert((body.clone(), crack)) {
            let mut curves: Vec<_> = runs.into_iter().map(|run| (run.key, run.rows)).collect();
            curves.sort_by(|a, b| a.0.friction.total_cmp(&b.0.friction));
            let figure = Profile::new(&curves, &results.exact, crack).by_friction();
            let name = format!("{body}.{}.crack-{crack}", file_name(&[method]));
            KIND.add(bundle, &name, figure.svg()?)?;
        }
    }
    Ok(())
}

/// Runs on one crack.
struct Profile<'a> {
    runs: &'a [(&'a RunKey, Vec<&'a PointRow>)],
    /// Closed forms, one per friction coefficient.
    exact: Vec<Vec<&'a ExactRow>>,
    crack: usize,
    /// Length of the crack as far as it has points [m].
    length: f64,
}

impl<'a> Profile<'a> {
    fn new(
        runs: &'a [(&'a RunKey, Vec<&'a PointRow>)],
        exact: &'a [ExactRow],
        crack: usize,
    ) -> Self {
        let mut closed: BTreeMap<u64, Vec<&ExactRow>> = BTreeMap::new();
        let belongs = |row: &ExactRow, key: &RunKey| {
            key.case == row.case && key.friction == row.friction && key.increment == row.increment
        };
        for row in exact.iter().filter(|row| row.crack == crack) {
            if runs.iter().any(|(key, _)| belongs(row, key)) {
                closed.entry(row.friction.to_bits()).or_default().push(row);
            }
        }
        let mut exact: Vec<Vec<&ExactRow>> = closed.into_values().collect();
        exact
            .iter_mut()
            .for_each(|curve| curve.sort_by(|a, b| a.s_m.total_cmp(&b.s_m)));
        let places = runs
            .iter()
            .flat_map(|(_, rows)| rows)
            .map(|row| row.point.s_m.abs());
        Self {
            runs,
            exact,
            crack,
            length: places.fold(0.0, f64::max),
        }
    }

    fn rows(&self) -> impl Iterator<Item = &'a PointRow> {
        self.runs.iter().flat_map(|(_, rows)| rows).copied()
    }

    fn largest(&self, along: &Along) -> f64 {
        let closed = self
            .exact
            .iter()
            .flatten()
            .map(|row| (along.exact)(row).abs());
        let values = self.rows().map(|row| (along.of)(row).abs()).chain(closed);
        values.filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// All methods on one problem.
    fn by_method(&self) -> Figure {
        let all = quantities();
        let methods: Vec<&str> = self
            .runs
            .iter()
            .map(|(key, _)| key.method.as_str())
            .collect();
        let traction = self.largest(&all[0]).max(self.largest(&all[1]));
        let scale = |along: &Along| {
            let nothing = if along.unit == "m" {
                ROUND_OFF * self.length
            } else {
                1e-6 * traction
            };
            self.largest(along).max(nothing).max(f64::MIN_POSITIVE)
        };
        let scaled: Vec<Vec<f64>> = self
            .runs
            .iter()
            .map(|(_, rows)| {
                all.iter()
                    .flat_map(|along| rows.iter().map(|row| (along.of)(row) / scale(along)))
                    .collect()
            })
            .collect();
        let status = |run: usize| self.runs[run].1.iter().map(|row| row.point.status.as_str());
        let found = agreement(&methods, &scaled, |a, b| status(a).eq(status(b)));
        let caption = format!(
            "{}, crack {}\n{}",
            problem(self.runs[0].0),
            self.crack,
            found.caption
        );
        self.figure(&found.title, caption, &found.curves)
    }

    /// One method with several friction coefficients.
    fn by_friction(&self) -> Figure {
        let key = self.runs[0].0;
        let slip = |rows: &Vec<&PointRow>| {
            rows.iter()
                .map(|row| row.point.slip_a_m.abs())
                .fold(0.0, f64::max)
        };
        let largest = self
            .runs
            .iter()
            .map(|(_, rows)| slip(rows))
            .fold(0.0, f64::max);
        let told = |(key, rows): &(&RunKey, Vec<&PointRow>)| {
            let own = if slip(rows) < ROUND_OFF * self.length {
                0.0
            } else {
                slip(rows)
            };
            let (factor, unit) = prefixed(largest, "m");
            format!(
                "{} {unit} at {}",
                significant(own * factor, 3),
                friction(key.friction)
            )
        };
        let ends =
            [self.runs.first(), self.runs.last()].map(|run| run.map(told).unwrap_or_default());
        let curve = |(i, (key, _)): (usize, &(&RunKey, _))| {
            (
                i,
                friction(key.friction),
                Style {
                    marker: None,
                    ..Style::curve(i)
                },
            )
        };
        let curves: Vec<_> = self.runs.iter().enumerate().map(curve).collect();
        let caption = format!(
            "{}, {}, crack {}",
            body(key),
            plain(&key.method),
            self.crack
        );
        self.figure(
            &format!("Largest slip {}, {}", ends[0], ends[1]),
            caption,
            &curves,
        )
    }

    fn figure(&self, title: &str, caption: String, curves: &[(usize, String, Style)]) -> Figure {
        let all = quantities();
        // Gaps of closed points are round-off; a panel of round-off says nothing.
        let opens = self.rows().any(|row| row.point.status == "open")
            || self.largest(&all[3]) > 1e-6 * self.largest(&all[2]);
        let shown = if opens { 4 } else { 3 };
        let panels = all[..shown]
            .iter()
            .enumerate()
            .map(|(i, along)| self.panel(along, i == 1, curves));
        let mut panels: Vec<Panel> = panels.collect();
        for status in ["stick", "slip", "open"] {
            if self.rows().any(|row| row.point.status == status) {
                let (marker, filled) = status_marker(status);
                panels[0]
                    .series
                    .push(Series::new(status, Style::mark(marker, filled), Vec::new()));
            }
        }
        let columns = if opens { 2 } else { 3 };
        Figure::new(title, caption, panels).columns(columns)
    }

    fn panel(&self, along: &Along, with_limit: bool, curves: &[(usize, String, Style)]) -> Panel {
        let largest = self.largest(along);
        // Jumps of sticking points are round-off: they are drawn as zero, not on an axis of attometres.
        let (factor, unit) = match along.unit == "m" && largest < ROUND_OFF * self.length {
            true => (0.0, along.unit.to_owned()),
            false => prefixed(largest, along.unit),
        };
        let y = Axis::linear(&format!("{} [{unit}]", along.name)).through(0.0);
        let mut panel = Panel::new(Axis::linear("distance along the crack [m]"), y, HEIGHT_MM);
        let value = |row: &PointRow| (along.of)(row) * factor;
        let first = &self.runs[curves[0].0].1;
        let band = curves[0].2.behind;
        for (index, (run, label, style)) in curves.iter().enumerate() {
            let (key, rows) = &self.runs[*run];
            let places = |of: &dyn Fn(&PointRow) -> f64| {
                rows.iter().map(|row| [row.point.s_m, of(row)]).collect()
            };
            if with_limit && key.friction > 0.0 && (index == 0 || !band) {
                let limit = |row: &PointRow| {
                    key.friction * (row.point.p_n / row.point.weight).max(0.0) * factor
                };
                let label = format!(
                    "slip limit {} {}{}",
                    italic("μ"),
                    italic("p"),
                    subscript("n")
                );
                let dots = Style {
                    colour: if band {
                        Style::limit().colour
                    } else {
                        style.colour
                    },
                    ..Style::limit()
                };
                panel.series.push(Series::new(
                    if index == 0 { label } else { String::new() },
                    dots,
                    places(&limit),
                ));
            }
            let mut series = Series::new(label, style.clone(), places(&value));
            // Marks that would lie on those of the first curve are left out, so that both can be seen.
            let seen = VISIBLE * largest * factor;
            let hidden = |n: usize, row: &PointRow| {
                let below = first.get(n).filter(|_| index > 0 && band);
                below.is_some_and(|b| {
                    b.point.status == row.point.status && (value(b) - value(row)).abs() < seen
                })
            };
            let marks = rows.iter().enumerate();
            series.marks = marks
                .map(|(n, row)| (!hidden(n, row)).then(|| status_marker(&row.point.status)))
                .collect();
            panel.series.push(series);
        }
        for curve in &self.exact {
            let points = curve
                .iter()
                .map(|row| [row.s_m, (along.exact)(row) * factor]);
            panel
                .series
                .push(Series::new("closed form", Style::exact(), points.collect()));
        }
        panel
    }
}
