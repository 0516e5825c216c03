//! Profiles along a 2D crack: traction and slip, with the contact status at every point.

use super::axis::{Axis, prefixed};
use super::canvas::{Width, italic, subscript};
use super::chart::{Chart, Panel, Series};
use super::colour::BLACK;
use super::legend::Entry;
use super::names::{Names, by_run};
use super::style::{Marker, Style};
use crate::harness::record::{PointRow, RunKey};
use crate::report::ReportError;

/// Jumps below this fraction of the crack's length are round-off.
const ROUND_OFF: f64 = 1e-13;

/// Contact traction p_n and |p_t| (force per tributary length) along one 2D crack, one curve per run in `rows`;
/// markers tell stick, slip and open, dotted lines the slip limit μ p_n.
///
/// # Errors
/// [`ReportError::Figure`] when `rows` has no point of a 2D crack with this number.
pub fn contact_traction(rows: &[PointRow], crack: usize) -> Result<String, ReportError> {
    let profile = Profile::new("contact traction", rows, crack)?;
    let normal = |row: &PointRow| row.p_n / row.weight;
    let tangential = |row: &PointRow| row.p_a.hypot(row.p_b) / row.weight;
    let limit = |row: &PointRow| row.key.friction * normal(row).max(0.0);

    let symbol = italic("p");
    let mut upper = profile.panel(&format!("{symbol}{}", subscript("n")), "Pa", &[&normal]);
    let label = format!("|{symbol}{}|", subscript("t"));
    let mut lower = profile.panel(&label, "Pa", &[&tangential, &limit]);
    let styles = profile.styles(&[&normal, &tangential]);
    for (run, style) in profile.runs.iter().zip(&styles) {
        upper.curve(run, style, &normal);
        lower.reference(run, style, &limit);
        lower.curve(run, style, &tangential);
    }
    let limit = Entry {
        label: format!("slip limit {} {symbol}{}", italic("μ"), subscript("n")),
        style: Style::reference(BLACK),
        line: true,
    };
    profile.chart(
        "Contact traction",
        vec![upper.panel, lower.panel],
        &styles,
        vec![limit],
    )
}

/// Tangential jump, and the normal gap where the crack opens, along one 2D crack, one curve per run in `rows`.
///
/// # Errors
/// Those of [`contact_traction`].
pub fn contact_slip(rows: &[PointRow], crack: usize) -> Result<String, ReportError> {
    let profile = Profile::new("contact slip", rows, crack)?;
    let slip = |row: &PointRow| row.slip_a_m;
    let gap = |row: &PointRow| row.gap_m;
    // Gaps of closed points are round-off; a panel of round-off says nothing.
    let opens = profile
        .runs
        .iter()
        .flatten()
        .any(|row| row.status == "open")
        || profile.largest(&gap) > 1e-6 * profile.largest(&slip);

    let mut panels = vec![profile.panel("slip", "m", &[&slip])];
    if opens {
        panels.push(profile.panel("normal gap", "m", &[&gap]));
    }
    let styles = profile.styles(&[&slip]);
    for (run, style) in profile.runs.iter().zip(&styles) {
        panels[0].curve(run, style, &slip);
        if let Some(panel) = panels.get_mut(1) {
            panel.curve(run, style, &gap);
        }
    }
    let panels = panels.into_iter().map(|panel| panel.panel).collect();
    profile.chart("Slip", panels, &styles, Vec::new())
}

/// Points of one crack, by run.
struct Profile<'a> {
    runs: Vec<Vec<&'a PointRow>>,
    names: Names,
    crack: usize,
}

/// A panel with the factor that its unit needs.
struct ProfilePanel {
    panel: Panel,
    factor: f64,
}

impl<'a> Profile<'a> {
    fn new(figure: &'static str, rows: &'a [PointRow], crack: usize) -> Result<Self, ReportError> {
        let mut runs = by_run(rows, |row| &row.key, |a, b| a.s_m.total_cmp(&b.s_m));
        for run in &mut runs {
            run.retain(|row| row.crack == crack);
        }
        runs.retain(|run| !run.is_empty());
        if runs.is_empty() {
            return Err(ReportError::figure(
                figure,
                format!("crack {crack} has no points"),
            ));
        }
        if runs.iter().flatten().all(|row| row.force_unit != "N/m") {
            let reason = "points of a 3D crack have no distance along it";
            return Err(ReportError::figure(figure, reason));
        }
        let keys: Vec<&RunKey> = runs.iter().map(|run| &run[0].key).collect();
        let names = Names::of(&keys);
        Ok(Self { runs, names, crack })
    }

    /// Largest |f| over all points.
    fn largest(&self, of: &dyn Fn(&PointRow) -> f64) -> f64 {
        let values = self.runs.iter().flatten().map(|row| of(row).abs());
        values.filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// Looks of the curves: nested where runs agree in all the functions `of`, so that none hides another.
    fn styles(&self, of: &[&dyn Fn(&PointRow) -> f64]) -> Vec<Style> {
        let scaled = |run: &Vec<&PointRow>| -> Vec<f64> {
            let parts = of.iter().flat_map(|f| {
                let largest = self.largest(f).max(f64::MIN_POSITIVE);
                run.iter().map(move |row| f(row) / largest)
            });
            parts.collect()
        };
        let curves: Vec<Vec<f64>> = self.runs.iter().map(scaled).collect();
        Style::of_curves(&curves)
    }

    /// An empty panel whose y axis covers the functions `of` and zero.
    fn panel(&self, name: &str, unit: &str, of: &[&dyn Fn(&PointRow) -> f64]) -> ProfilePanel {
        let rows = || self.runs.iter().flatten();
        let largest = of.iter().map(|f| self.largest(f)).fold(0.0, f64::max);
        // Jumps of sticking points are round-off: they are drawn as zero, not on an axis of attometres.
        let length = rows().map(|row| row.s_m.abs()).fold(0.0, f64::max);
        let round_off = unit == "m" && largest < ROUND_OFF * length;
        let (factor, unit) = if round_off {
            (0.0, unit.to_owned())
        } else {
            prefixed(largest, unit)
        };
        let values = rows().flat_map(|row| of.iter().map(|f| f(row) * factor));
        let shown = values.chain([0.0]);
        let panel = Panel {
            x: Axis::linear("distance along the crack [m]", rows().map(|row| row.s_m), 6),
            y: Axis::linear(&format!("{name} [{unit}]"), shown, 4),
            series: Vec::new(),
            levels: Vec::new(),
            slope: None,
        };
        ProfilePanel { panel, factor }
    }

    fn chart(
        &self,
        title: &str,
        panels: Vec<Panel>,
        styles: &[Style],
        mut marks: Vec<Entry>,
    ) -> Result<String, ReportError> {
        let curve = |(label, style): (&String, &Style)| Entry {
            label: label.clone(),
            style: Style {
                marker: None,
                ..style.clone()
            },
            line: true,
        };
        let curves = self.names.labels.iter().zip(styles).map(curve).collect();
        for status in ["stick", "slip", "open"] {
            if self.runs.iter().flatten().any(|row| row.status == status) {
                let (marker, filled) = status_marker(status);
                let mut style = Style::reference(BLACK);
                style.marker = Some(marker);
                style.filled = filled;
                marks.push(Entry {
                    label: status.to_owned(),
                    style,
                    line: false,
                });
            }
        }
        let caption = format!("{}, crack {}", self.names.common, self.crack);
        let chart = Chart {
            title: format!("{title} along the crack: {caption}"),
            caption,
            width: Width::Column,
            height: if panels.len() > 1 { 32.0 } else { 42.0 },
            panels,
            legend: vec![curves, marks],
        };
        chart.svg()
    }
}

impl ProfilePanel {
    fn points(&self, run: &[&PointRow], of: &dyn Fn(&PointRow) -> f64) -> Vec<[f64; 2]> {
        run.iter()
            .map(|row| [row.s_m, of(row) * self.factor])
            .collect()
    }

    fn curve(&mut self, run: &[&PointRow], style: &Style, of: &dyn Fn(&PointRow) -> f64) {
        self.panel.series.push(Series {
            points: self.points(run, of),
            style: style.clone(),
            markers: run.iter().map(|row| status_marker(&row.status)).collect(),
        });
    }

    fn reference(&mut self, run: &[&PointRow], style: &Style, of: &dyn Fn(&PointRow) -> f64) {
        self.panel.series.push(Series {
            points: self.points(run, of),
            style: Style::reference(style.colour),
            markers: Vec::new(),
        });
    }
}

fn status_marker(status: &str) -> (Marker, bool) {
    match status {
        "stick" => (Marker::Disc, true),
        "slip" => (Marker::Triangle, false),
        _ => (Marker::Cross, false),
    }
}
