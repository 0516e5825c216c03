//! Profiles along a 2D crack: traction and slip, with the contact status at every point.

use super::agreement::difference;
use super::axis::{Axis, prefixed};
use super::canvas::{Width, italic, subscript};
use super::chart::{Chart, Markers, Panel, Series};
use super::colour::{BLACK, GREY, Rgb};
use super::legend::Entry;
use super::method_curves::{MethodCurve, method_curves};
use super::names::{Names, by_run};
use super::style::{Style, status_marker};
use crate::report::ReportError;
use crate::run::record::{ExactRow, PointRow, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// Jumps below this fraction of the crack's length are what the tolerance of a method leaves.
const ROUND_OFF: f64 = 1e-10;

/// Tractions below this fraction of the largest are nothing to compare.
const NEGLIGIBLE: f64 = 1e-6;

/// Difference that can be seen, as a fraction of the range.
const VISIBLE: f64 = 0.01;

/// Contact traction p_n and |p_t| (force per tributary length) along one 2D crack; markers tell stick, slip and open,
/// dots the slip limit μ p_n. Runs with one friction coefficient by exact methods whose curves cannot be told apart are
/// drawn once, all others get curves of their own. `exact`: closed forms, of which those of the runs' cases, friction
/// coefficients and increments are drawn as thin lines.
///
/// # Errors
/// [`ReportError::Figure`] when `rows` has no point of a 2D crack with this number.
pub fn contact_traction(
    rows: &[PointRow],
    exact: &[ExactRow],
    crack: usize,
) -> Result<String, ReportError> {
    let normal = |row: &PointRow| row.point.p_n / row.point.weight;
    let tangential = |row: &PointRow| row.point.p_a.hypot(row.point.p_b) / row.point.weight;
    let limit = |row: &PointRow| row.key.friction * normal(row).max(0.0);
    let figure = "contact traction";
    let profile = Profile::new(figure, (rows, exact), crack, "Pa", &[&normal, &tangential])?;

    let symbol = italic("p");
    let mut upper = profile.panel(&format!("{symbol}{}", subscript("n")), &[&normal], &|row| {
        row.p_n_pa
    });
    let label = format!("|{symbol}{}|", subscript("t"));
    let mut lower = profile.panel(&label, &[&tangential, &limit], &|row| row.p_a_pa.abs());
    let largest = profile.largest(&limit).max(f64::MIN_POSITIVE);
    let limits = |curve: &ProfileCurve<'_>| -> Vec<f64> {
        let values = curve.points.iter().map(|row| limit(row) / largest);
        values.collect()
    };
    let shared = profile.by_method.then(|| limits(&profile.curves[0]));
    for (index, curve) in profile.curves.iter().enumerate() {
        upper.curve(&profile, index, &normal);
        // One limit for all methods that agree on it.
        let own = |shared: &Vec<f64>| difference(shared, &limits(curve)) > VISIBLE;
        match &shared {
            Some(_) if index == 0 => lower.reference(curve, GREY, &limit),
            Some(shared) if !own(shared) => {}
            _ => lower.reference(curve, curve.style.colour, &limit),
        }
        lower.curve(&profile, index, &tangential);
    }
    upper.exact();
    lower.exact();
    let limit = Entry {
        label: format!("slip limit {} {symbol}{}", italic("μ"), subscript("n")),
        style: Style::limit(if profile.by_method { GREY } else { BLACK }),
        line: true,
    };
    profile.chart(
        "Contact traction",
        vec![upper.panel, lower.panel],
        vec![limit],
    )
}

/// Tangential jump, and the normal gap where the crack opens, along one 2D crack, with curves as in
/// [`contact_traction`].
///
/// # Errors
/// Those of [`contact_traction`].
pub fn contact_slip(
    rows: &[PointRow],
    exact: &[ExactRow],
    crack: usize,
) -> Result<String, ReportError> {
    let slip = |row: &PointRow| row.point.slip_a_m;
    let gap = |row: &PointRow| row.point.gap_m;
    let profile = Profile::new("contact slip", (rows, exact), crack, "m", &[&slip, &gap])?;
    // Gaps of closed points are round-off; a panel of round-off says nothing.
    let opens = profile.rows().any(|row| row.point.status == "open")
        || profile.largest(&gap) > 1e-6 * profile.largest(&slip);

    let mut panels = vec![profile.panel("slip", &[&slip], &|row| row.slip_a_m)];
    if opens {
        panels.push(profile.panel("normal gap", &[&gap], &|row| row.gap_m));
    }
    for index in 0..profile.curves.len() {
        panels[0].curve(&profile, index, &slip);
        if let Some(panel) = panels.get_mut(1) {
            panel.curve(&profile, index, &gap);
        }
    }
    panels.iter_mut().for_each(ProfilePanel::exact);
    let panels = panels.into_iter().map(|panel| panel.panel).collect();
    profile.chart("Slip", panels, Vec::new())
}

/// A function of a contact point.
type Of<'f> = &'f dyn Fn(&PointRow) -> f64;

/// The same of the closed form.
type ExactOf<'f> = &'f dyn Fn(&ExactRow) -> f64;

/// One curve: points of the run that is drawn.
struct ProfileCurve<'a> {
    points: Vec<&'a PointRow>,
    style: Style,
    /// Look of its line in the legend.
    sample: Style,
    label: String,
}

/// Points of one crack, by curve.
struct Profile<'a> {
    /// All runs, also those that another one stands for.
    runs: Vec<Vec<&'a PointRow>>,
    curves: Vec<ProfileCurve<'a>>,
    /// Closed forms, one per friction coefficient.
    exact: Vec<Vec<&'a ExactRow>>,
    /// Whether methods are compared; otherwise each run is a curve.
    by_method: bool,
    /// What all runs share.
    common: String,
    /// Methods that a curve stands for.
    notes: Vec<String>,
    crack: usize,
    unit: &'static str,
}

/// A panel with the factor that its unit needs.
struct ProfilePanel {
    panel: Panel,
    factor: f64,
    /// Points of the closed forms.
    exact: Vec<Vec<[f64; 2]>>,
}

impl<'a> Profile<'a> {
    /// `of` are the functions that will be drawn, all in one unit.
    fn new(
        figure: &'static str,
        (rows, exact): (&'a [PointRow], &'a [ExactRow]),
        crack: usize,
        unit: &'static str,
        of: &[Of<'_>],
    ) -> Result<Self, ReportError> {
        let mut runs = by_run(
            rows,
            |row| &row.key,
            |a, b| a.point.s_m.total_cmp(&b.point.s_m),
        );
        for run in &mut runs {
            run.retain(|row| row.point.crack == crack);
        }
        runs.retain(|run| !run.is_empty());
        if runs.is_empty() {
            return Err(ReportError::figure(
                figure,
                format!("crack {crack} has no points"),
            ));
        }
        if runs
            .iter()
            .flatten()
            .all(|row| row.point.force_unit != "N/m")
        {
            let reason = "points of a 3D crack have no distance along it";
            return Err(ReportError::figure(figure, reason));
        }
        let keys: Vec<&RunKey> = runs.iter().map(|run| &run[0].key).collect();
        let names = Names::of(&keys);
        let methods: BTreeSet<&str> = keys.iter().map(|key| key.method.as_str()).collect();
        let mut profile = Self {
            exact: exact_of(&keys, exact, crack),
            curves: Vec::new(),
            // One run per method: nothing else tells the runs apart.
            by_method: methods.len() == runs.len(),
            common: names.common,
            notes: Vec::new(),
            crack,
            unit,
            runs,
        };
        let scaled = profile.scaled(of);
        if profile.by_method {
            profile.add_groups(&scaled);
        } else {
            let styles = Style::of_curves(&scaled);
            let curves = profile.runs.iter().zip(styles).zip(names.labels);
            let curve =
                |((points, style), label): ((&Vec<&'a PointRow>, Style), String)| ProfileCurve {
                    points: points.clone(),
                    sample: style.clone(),
                    style,
                    label,
                };
            profile.curves = curves.map(curve).collect();
        }
        Ok(profile)
    }

    /// One curve per group of methods that agree.
    fn add_groups(&mut self, scaled: &[Vec<f64>]) {
        let methods: Vec<&str> = (self.runs.iter())
            .map(|run| run[0].key.method.as_str())
            .collect();
        let statuses = |run: usize| self.runs[run].iter().map(|row| &row.point.status);
        let shared = if self.exact.is_empty() {
            Style::shared()
        } else {
            Style::shared_below_exact()
        };
        let alike = |a, b| statuses(a).eq(statuses(b));
        let found = method_curves(&methods, scaled, &shared, alike);
        self.notes = found.notes;
        let curve = |curve: MethodCurve| ProfileCurve {
            points: self.runs[curve.run].clone(),
            style: curve.style,
            sample: curve.sample,
            label: curve.label,
        };
        self.curves = found.curves.into_iter().map(curve).collect();
    }

    /// All points of all runs.
    fn rows(&self) -> impl Iterator<Item = &'a PointRow> {
        self.runs.iter().flatten().copied()
    }

    /// Length of the crack as far as it has points [m].
    fn length(&self) -> f64 {
        self.rows()
            .map(|row| row.point.s_m.abs())
            .fold(0.0, f64::max)
    }

    /// Values of the functions along each run, divided by the largest or by what counts as round-off.
    fn scaled(&self, of: &[Of<'_>]) -> Vec<Vec<f64>> {
        let largest = of.iter().map(|f| self.largest(f));
        let floor = match self.unit {
            "m" => ROUND_OFF * self.length(),
            _ => NEGLIGIBLE * largest.clone().fold(0.0, f64::max),
        };
        let scale = largest.map(|largest| largest.max(floor).max(f64::MIN_POSITIVE));
        let scale: Vec<f64> = scale.collect();
        let scaled = |run: &Vec<&PointRow>| {
            let parts = of.iter().zip(&scale);
            let values = parts.flat_map(|(f, scale)| run.iter().map(move |row| f(row) / scale));
            values.collect()
        };
        self.runs.iter().map(scaled).collect()
    }

    /// Largest |f| over all points.
    fn largest(&self, of: Of<'_>) -> f64 {
        let values = self.rows().map(|row| of(row).abs());
        values.filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// An empty panel whose y axis covers the functions `of`, the closed form and zero.
    fn panel(&self, name: &str, of: &[Of<'_>], exact: ExactOf<'_>) -> ProfilePanel {
        let closed = || self.exact.iter().flatten().map(|row| exact(row));
        let largest = of.iter().map(|f| self.largest(f)).fold(0.0, f64::max);
        let largest = closed().map(f64::abs).fold(largest, f64::max);
        // Jumps of sticking points are round-off: they are drawn as zero, not on an axis of attometres.
        let round_off = self.unit == "m" && largest < ROUND_OFF * self.length();
        let (factor, unit) = if round_off {
            (0.0, self.unit.to_owned())
        } else {
            prefixed(largest, self.unit)
        };
        let values = (self.rows()).flat_map(|row| of.iter().map(|f| f(row) * factor));
        let shown = values.chain([0.0]).chain(closed().map(|v| v * factor));
        let ends = self.exact.iter().flatten().map(|row| row.s_m);
        let along = self.rows().map(|row| row.point.s_m).chain(ends);
        let panel = Panel {
            x: Axis::linear("distance along the crack [m]", along, 6),
            y: Axis::linear(&format!("{name} [{unit}]"), shown, 4),
            series: Vec::new(),
            levels: Vec::new(),
            slopes: Vec::new(),
            markers: Markers::Sparse,
        };
        let place = |row: &&ExactRow| [row.s_m, exact(row) * factor];
        let exact = self.exact.iter();
        let exact = exact
            .map(|curve| curve.iter().map(place).collect())
            .collect();
        ProfilePanel {
            panel,
            factor,
            exact,
        }
    }

    fn chart(
        &self,
        title: &str,
        panels: Vec<Panel>,
        mut marks: Vec<Entry>,
    ) -> Result<String, ReportError> {
        let entry = |curve: &ProfileCurve<'_>| Entry {
            label: curve.label.clone(),
            style: Style {
                marker: None,
                ..curve.sample.clone()
            },
            line: true,
        };
        let mut entries = self.curves.iter().map(entry);
        // What stands for many methods has a long label: a row of its own.
        let shared = self.notes.len().min(1);
        let shared: Vec<Entry> = entries.by_ref().take(shared).collect();
        if !self.exact.is_empty() {
            marks.push(Entry {
                label: "exact".into(),
                style: Style::exact(),
                line: true,
            });
        }
        for status in ["stick", "slip", "open"] {
            if self.rows().any(|row| row.point.status == status) {
                let (marker, filled) = status_marker(status);
                marks.push(Entry {
                    label: status.to_owned(),
                    style: Style::mark(marker, filled),
                    line: false,
                });
            }
        }
        let run = format!("{}, crack {}", self.common, self.crack);
        let notes = self.notes.iter().map(|note| format!("\n{note}"));
        let chart = Chart {
            title: format!("{title} along the crack: {run}"),
            caption: run + &notes.collect::<String>(),
            width: Width::Column,
            height: if panels.len() > 1 { 32.0 } else { 42.0 },
            panels,
            legend: vec![shared, entries.collect(), marks],
        };
        chart.svg()
    }
}

impl ProfilePanel {
    fn points(&self, curve: &ProfileCurve<'_>, of: Of<'_>) -> Vec<[f64; 2]> {
        let point = |row: &&PointRow| [row.point.s_m, of(row) * self.factor];
        curve.points.iter().map(point).collect()
    }

    fn curve(&mut self, profile: &Profile<'_>, index: usize, of: Of<'_>) {
        let curve = &profile.curves[index];
        // Marks that would lie on those of the first curve are left out, so that both can be seen.
        let seen = VISIBLE * profile.largest(of);
        let first = &profile.curves[0].points;
        let hidden = |(n, row): (usize, &&PointRow)| {
            let below = first.get(n).filter(|_| index > 0 && profile.by_method);
            below.is_some_and(|b| {
                b.point.status == row.point.status && (of(b) - of(row)).abs() < seen
            })
        };
        let look = |(n, row)| (!hidden((n, row))).then(|| status_marker(&row.point.status));
        self.panel.series.push(Series {
            points: self.points(curve, of),
            style: curve.style.clone(),
            markers: curve.points.iter().enumerate().map(look).collect(),
        });
    }

    /// The closed forms over what has been drawn.
    fn exact(&mut self) {
        let curves = std::mem::take(&mut self.exact).into_iter();
        self.panel.series.extend(curves.map(|points| Series {
            points,
            style: Style::exact(),
            markers: Vec::new(),
        }));
    }

    fn reference(&mut self, curve: &ProfileCurve<'_>, colour: Rgb, of: Of<'_>) {
        self.panel.series.push(Series {
            points: self.points(curve, of),
            style: Style::limit(colour),
            markers: Vec::new(),
        });
    }
}

/// Closed forms that belong to the runs, one curve per case, friction coefficient and increment.
fn exact_of<'a>(keys: &[&RunKey], exact: &'a [ExactRow], crack: usize) -> Vec<Vec<&'a ExactRow>> {
    type Name<'a> = (&'a str, u64, usize);
    let own = |row: &ExactRow| {
        let of = |key: &&RunKey| {
            key.case == row.case && key.friction == row.friction && key.increment == row.increment
        };
        row.crack == crack && keys.iter().any(of)
    };
    let mut curves: BTreeMap<Name<'a>, Vec<&'a ExactRow>> = BTreeMap::new();
    for row in exact.iter().filter(|row| own(row)) {
        let name = (row.case.as_str(), row.friction.to_bits(), row.increment);
        curves.entry(name).or_default().push(row);
    }
    let mut curves: Vec<Vec<&ExactRow>> = curves.into_values().collect();
    for curve in &mut curves {
        curve.sort_by(|a, b| a.s_m.total_cmp(&b.s_m));
    }
    curves
}
