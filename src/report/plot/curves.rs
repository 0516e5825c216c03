//! The figures made of curves: residual histories, errors, loops.

use super::axis::Axis;
use super::canvas::{Width, plain};
use super::chart::{Chart, Markers, Panel, Series, SlopeTriangle};
use super::legend::Entry;
use super::methods;
use super::names::{Names, by_run};
use super::style::Style;
use crate::report::ReportError;
use crate::run::record::{HistoryRow, RunKey};

/// Residuals below this are drawn here: a logarithmic axis has no zero.
const RESIDUAL_SHOWN: f64 = 1e-16;

/// A horizontal line in the residual figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Tier {
    /// Its text, e.g. `tier high`.
    pub label: String,
    /// Residual that the tier allows [-].
    pub residual: f64,
}

impl Tier {
    /// The tiers of the harness: low 1e-3, mid 1e-6, high 1e-9; none for another name.
    pub fn named(name: &str) -> Option<Self> {
        let residual = match name {
            "low" => 1e-3,
            "mid" => 1e-6,
            "high" => 1e-9,
            _ => return None,
        };
        Some(Self {
            label: format!("tier {name}"),
            residual,
        })
    }
}

/// Natural-map residual against iteration, one curve per run in `rows`.
///
/// # Errors
/// [`ReportError::Figure`] when there are no finite residuals.
pub fn residual_history(rows: &[HistoryRow], tier: Option<&Tier>) -> Result<String, ReportError> {
    const FIGURE: &str = "residual history";
    let runs = by_run(rows, |row| &row.key, |a, b| a.iteration.cmp(&b.iteration));
    let keys: Vec<&RunKey> = runs.iter().map(|run| &run[0].key).collect();
    let names = Names::of(&keys);
    let counts = runs
        .iter()
        .map(|run| run.iter().map(|row| row.iteration).max().unwrap_or(0));
    let most = counts.clone().max().unwrap_or(0);
    // Newton needs ten iterations where an alternating method needs hundreds: only a logarithmic axis shows both.
    let logarithmic = most > 30 * counts.min().unwrap_or(0).max(1);
    let iteration = |row: &HistoryRow| row.iteration as f64;
    let residual = |row: &HistoryRow| {
        if row.natural_map.is_finite() {
            row.natural_map.max(RESIDUAL_SHOWN)
        } else {
            f64::NAN
        }
    };

    let x = if logarithmic {
        Axis::many_counts("iteration [-]", most)
    } else {
        Axis::counts("iteration [-]", most)
    };
    let shown = rows
        .iter()
        .map(residual)
        .chain(tier.map(|tier| tier.residual));
    let y = Axis::log("natural-map residual [-]", shown);
    let y = y.ok_or_else(|| ReportError::figure(FIGURE, "no finite residual"))?;
    let curves = runs
        .iter()
        .map(|run| {
            run.iter()
                .map(|row| [iteration(row), residual(row)])
                .collect()
        })
        .collect();
    let level = |tier: &Tier| Entry {
        label: format!("{} ({:e})", plain(&tier.label), tier.residual),
        style: Style::level(),
        line: true,
    };
    let marks = tier.map(level).into_iter().collect();
    let levels = tier.map(|tier| tier.residual).into_iter().collect();
    let panel = Panel {
        x,
        y,
        series: Vec::new(),
        levels,
        slopes: Vec::new(),
        markers: Markers::Spread,
    };
    let methods: Vec<&str> = keys.iter().map(|key| key.method.as_str()).collect();
    let figure = Figure {
        title: format!("Residual against iteration: {}", names.common),
        caption: names.common,
        // Room for the curves of many methods.
        height: if runs.len() > 6 { 62.0 } else { 46.0 },
        styles: methods::styles(&methods),
        labels: names.labels,
        marks,
    };
    draw(figure, panel, curves)
}

/// A curve of [`error_plot`] and [`line_plot`].
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Label in the legend.
    pub label: String,
    /// x and y.
    pub points: Vec<[f64; 2]>,
}

/// What [`error_plot`] and [`line_plot`] draw. Labels may hold [`subscript`](super::subscript) and
/// [`italic`](super::italic).
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePlot {
    /// Small text above the axes, e.g. the case.
    pub caption: String,
    /// Label with unit.
    pub x_label: String,
    /// Label with unit.
    pub y_label: String,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// Both axes logarithmic, with a triangle of the given slope below the part of the first curve that is closest to it.
///
/// # Errors
/// [`ReportError::Figure`] when no point has two positive coordinates.
pub fn error_plot(plot: &CurvePlot, slope: Option<f64>) -> Result<String, ReportError> {
    let curves = positive(plot);
    let triangle = slope.and_then(|slope| {
        let middle = steadiest(curves.first()?, slope)?;
        triangle_below(&curves, slope, middle)
    });
    logarithmic(plot, curves, triangle.into_iter().collect())
}

/// Points with two positive coordinates, by curve.
fn positive(plot: &CurvePlot) -> Vec<Vec<[f64; 2]>> {
    let positive = |p: &&[f64; 2]| p.iter().all(|c| c.is_finite() && *c > 0.0);
    plot.curves
        .iter()
        .map(|curve| curve.points.iter().filter(positive).copied().collect())
        .collect()
}

/// Both axes logarithmic.
fn logarithmic(
    plot: &CurvePlot,
    curves: Vec<Vec<[f64; 2]>>,
    slopes: Vec<SlopeTriangle>,
) -> Result<String, ReportError> {
    let points = || curves.iter().flatten();
    // The factor leaves room for the number below the triangle.
    let lowest = slopes.iter().map(|t| t.y.min(t.end()) / 2.0);
    let x = Axis::log(&plot.x_label, points().map(|p| p[0]));
    let y = points().map(|p| p[1]).chain(lowest);
    let (Some(x), Some(y)) = (x, Axis::log(&plot.y_label, y)) else {
        return Err(ReportError::figure(
            "error plot",
            "no point with two positive coordinates",
        ));
    };
    generic(plot, curves, x, y, slopes)
}

/// Both axes linear, points joined in their order, e.g. force against displacement over a cycle.
///
/// # Errors
/// [`ReportError::Figure`] when there is no finite point.
pub fn line_plot(plot: &CurvePlot) -> Result<String, ReportError> {
    let finite = |p: &&[f64; 2]| p.iter().all(|c| c.is_finite());
    let points = || {
        plot.curves
            .iter()
            .flat_map(|curve| &curve.points)
            .filter(finite)
    };
    if points().next().is_none() {
        return Err(ReportError::figure("line plot", "no finite point"));
    }
    let x = Axis::linear(&plot.x_label, points().map(|p| p[0]), 6);
    let y = Axis::linear(&plot.y_label, points().map(|p| p[1]), 5);
    let curves = plot
        .curves
        .iter()
        .map(|curve| curve.points.clone())
        .collect();
    generic(plot, curves, x, y, Vec::new())
}

fn generic(
    plot: &CurvePlot,
    curves: Vec<Vec<[f64; 2]>>,
    x: Axis,
    y: Axis,
    slopes: Vec<SlopeTriangle>,
) -> Result<String, ReportError> {
    let panel = Panel {
        x,
        y,
        series: Vec::new(),
        levels: Vec::new(),
        slopes,
        markers: Markers::Sparse,
    };
    let labels = plot
        .curves
        .iter()
        .map(|curve| curve.label.clone())
        .collect();
    let places = |curve: &Vec<[f64; 2]>| -> Vec<f64> {
        let at = |p: &[f64; 2]| [panel.x.place(p[0]), panel.y.place(p[1])];
        curve.iter().flat_map(at).collect()
    };
    let styles = Style::of_curves(&curves.iter().map(places).collect::<Vec<_>>());
    let figure = Figure {
        title: format!("{} against {}", plot.y_label, plot.x_label),
        caption: plain(&plot.caption),
        height: 46.0,
        styles,
        labels,
        marks: Vec::new(),
    };
    draw(figure, panel, curves)
}

/// What surrounds a panel: one style and one label per curve, and what the legend tells besides.
struct Figure {
    title: String,
    caption: String,
    height: f64,
    styles: Vec<Style>,
    labels: Vec<String>,
    marks: Vec<Entry>,
}

/// One panel with its curves over the lines it has already.
fn draw(
    figure: Figure,
    mut panel: Panel,
    curves: Vec<Vec<[f64; 2]>>,
) -> Result<String, ReportError> {
    let entry = |(label, style): (String, &Style)| Entry {
        label,
        style: style.clone(),
        line: true,
    };
    let legend = figure.labels.into_iter().zip(&figure.styles).map(entry);
    let legend = vec![legend.collect(), figure.marks];
    let own = curves.into_iter().zip(figure.styles);
    panel.series.extend(own.map(|(points, style)| Series {
        points,
        style,
        markers: Vec::new(),
    }));
    let chart = Chart {
        title: figure.title,
        caption: figure.caption,
        width: Width::Column,
        height: figure.height,
        panels: vec![panel],
        legend,
    };
    chart.svg()
}

/// Where a curve agrees best with a slope.
fn steadiest(curve: &[[f64; 2]], slope: f64) -> Option<f64> {
    let mut first = curve.to_vec();
    first.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let deviation = |pair: &&[[f64; 2]]| {
        let [a, b] = [pair[0], pair[1]];
        ((b[1] / a[1]).ln() / (b[0] / a[0]).ln() - slope).abs()
    };
    let best = first
        .windows(2)
        .filter(|pair| pair[1][0] > pair[0][0])
        .min_by(|a, b| deviation(a).total_cmp(&deviation(b)))?;
    Some((best[0][0] * best[1][0]).sqrt())
}

/// A slope triangle a quarter of the x range wide, below all curves about `middle`.
fn triangle_below(curves: &[Vec<[f64; 2]>], slope: f64, middle: f64) -> Option<SlopeTriangle> {
    let all = || curves.iter().flatten();
    let (low, high) = super::axis::range(all().map(|p| p[0]))?;
    let half = (high / low).powf(0.11);
    // Kept inside the axis, with room for the number beside the upright leg.
    let middle = middle.clamp(low * half.powf(1.3), high / half.powf(1.3));
    let x = [middle / half, middle * half];
    let (bottom, top) = super::axis::range(all().map(|p| p[1]))?;
    let below = (top / bottom).powf(0.07).max(1.2);
    // The lowest curve over the triangle, brought to x[0] along the slope.
    let lowest = curves
        .iter()
        .flat_map(|curve| curve.windows(2))
        .flat_map(|pair| x.map(|at| interpolate(pair, at).map(|y| y * (x[0] / at).powf(slope))))
        .flatten()
        .chain(
            all()
                .filter(|p| p[0] >= x[0] && p[0] <= x[1])
                .map(|p| p[1] * (x[0] / p[0]).powf(slope)),
        )
        .fold(f64::INFINITY, f64::min);
    lowest.is_finite().then_some(SlopeTriangle {
        x,
        y: lowest / below,
        slope,
        run: 1.0,
    })
}

/// y at `at` on the segment in logarithmic coordinates; none outside.
fn interpolate(pair: &[[f64; 2]], at: f64) -> Option<f64> {
    let [a, b] = [pair[0], pair[1]];
    let t = (at / a[0]).ln() / (b[0] / a[0]).ln();
    (0.0..=1.0)
        .contains(&t)
        .then(|| a[1] * (b[1] / a[1]).powf(t))
}
