//! Errors of sequences of meshes: logarithmic panels side by side over common axes, each with a legend of its own below.
//!
//! One panel holds what is compared directly. A curve has a marker on every mesh; curves that lie on each other show all
//! their markers and dashes ([`Style::over_common_points`]). The order p of theory is a dotted line below all curves and a
//! triangle on it: error ~ h^p is the slope p against the cell size h and −p/dim against the number N ~ h^−dim of unknowns.

use super::axis::{self, Axis};
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, TICK_PT, Width, caption_height, fitting_size, wrapped,
};
use super::chart::{Frame, Markers, Panel, Series, SlopeTriangle, draw_panel, room_for_labels};
use super::colour::{BLACK, GREY};
use super::legend::{self, Entry, LegendGrid};
use super::style::Style;
use crate::report::ReportError;

const MARGIN_MM: f64 = 1.5;
const HEIGHT_MM: f64 = 48.0;
const HEADING_MM: f64 = 4.0;
/// Gap between panels.
const GAP_MM: f64 = 3.5;
/// Room for the labels of an x axis.
const AXIS_MM: f64 = 11.0;

/// One sequence of meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCurve {
    /// Label in the legend.
    pub label: String,
    /// Curves of different panels with the same number look the same.
    pub look: usize,
    /// Cell size, unknowns or time, and error; what is not positive is left out.
    pub points: Vec<[f64; 2]>,
}

/// A power law to compare with: y ~ x^(rise/run).
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// Number at the upright leg of the triangle, positive where y grows with x.
    pub rise: f64,
    /// Number at the horizontal leg.
    pub run: f64,
    /// Label in the legend of a dotted line; without one there is the triangle alone.
    pub label: Option<String>,
}

/// One coordinate system.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorPanel {
    /// Above the panel; may be empty.
    pub heading: String,
    /// The curves.
    pub curves: Vec<ErrorCurve>,
    /// Power laws.
    pub guides: Vec<Guide>,
}

/// A whole figure. Labels may hold [`subscript`](super::subscript) and [`italic`](super::italic).
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorFigure {
    /// For screen readers and file browsers.
    pub title: String,
    /// Small text above the panels.
    pub caption: String,
    /// Label with unit.
    pub x_label: String,
    /// Label with unit.
    pub y_label: String,
    /// Panels of a row: one is 85 mm wide, more share 170 mm.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<ErrorPanel>,
}

/// The figure as SVG; none where no point has two positive coordinates: errors that are all zero have no place on a
/// logarithmic axis.
///
/// # Errors
/// [`ReportError::Drawing`].
pub fn error_figure(figure: &ErrorFigure) -> Result<Option<String>, ReportError> {
    let points: Vec<Vec<Vec<[f64; 2]>>> = figure.panels.iter().map(positive).collect();
    let all = || points.iter().flatten().flatten();
    let ends = axis::range(all().map(|p| p[0])).zip(axis::range(all().map(|p| p[1])));
    let Some((across, upwards)) = ends else {
        return Ok(None);
    };
    let laws: Vec<Vec<Law>> = figure
        .panels
        .iter()
        .zip(&points)
        .map(|(panel, curves)| laws(&panel.guides, curves, across, upwards))
        .collect();
    let triangles = laws.iter().flatten().map(|law| &law.triangle);
    // Room for the number below a triangle.
    let room = (upwards.1 / upwards.0).powf(0.06).max(1.3);
    let lowest = triangles.map(|t| t.y.min(t.end()) / room);
    let lines = laws.iter().flatten().flat_map(|law| &law.line);
    let y = all().map(|p| p[1]).chain(lowest).chain(lines.map(|p| p[1]));
    let x = Axis::log(&figure.x_label, all().map(|p| p[0]));
    let (Some(x), Some(y)) = (x, Axis::log(&figure.y_label, y)) else {
        return Ok(None);
    };
    let panels: Vec<Panel> = points
        .into_iter()
        .zip(&laws)
        .zip(&figure.panels)
        .map(|((points, laws), panel)| chart_panel(panel, points, laws, [&x, &y]))
        .collect();
    draw(figure, &panels, room_for_labels(&y)).map(Some)
}

fn chart_panel(
    panel: &ErrorPanel,
    points: Vec<Vec<[f64; 2]>>,
    laws: &[Law],
    [x, y]: [&Axis; 2],
) -> Panel {
    let series = |points, style| Series {
        points,
        style,
        markers: Vec::new(),
    };
    let dotted = laws
        .iter()
        .filter(|law| !law.line.is_empty())
        .map(|law| series(law.line.clone(), Style::limit(GREY)));
    let mut curves: Vec<(usize, Vec<[f64; 2]>)> =
        panel.curves.iter().map(|c| c.look).zip(points).collect();
    // Large markers and full lines below small ones and dashes.
    curves.sort_by_key(|(look, _)| *look);
    let curves = curves
        .into_iter()
        .map(|(look, points)| series(points, Style::over_common_points(look)));
    Panel {
        x: x.clone(),
        y: y.clone(),
        series: dotted.chain(curves).collect(),
        levels: Vec::new(),
        slopes: laws.iter().map(|law| law.triangle).collect(),
        markers: Markers::Every,
    }
}

fn draw(figure: &ErrorFigure, panels: &[Panel], left: f64) -> Result<String, ReportError> {
    let columns = figure.columns.clamp(1, panels.len().max(1));
    let width = if columns == 1 {
        Width::Column.mm()
    } else {
        Width::Page.mm()
    };
    let free = width - MARGIN_MM - 2.5 - left - GAP_MM * (columns - 1) as f64;
    let panel_width = free / columns as f64;
    let caption = wrapped(&figure.caption, CAPTION_PT, width - 2.0 * MARGIN_MM);
    let head = if figure.panels.iter().any(|p| !p.heading.is_empty()) {
        HEADING_MM
    } else {
        1.0
    };
    let entries: Vec<Vec<Entry>> = figure.panels.iter().map(entries).collect();
    let told = |panel: &ErrorPanel| -> Vec<(usize, String)> {
        let curves = panel.curves.iter().map(|c| (c.look, c.label.clone()));
        let guides = panel.guides.iter().filter_map(|g| g.label.clone());
        curves.chain(guides.map(|label| (0, label))).collect()
    };
    // One legend is enough where all say the same.
    let common = figure.panels.windows(2).all(|p| told(&p[0]) == told(&p[1]));
    let room = if common {
        width - 2.0 * MARGIN_MM
    } else {
        panel_width
    };
    let grid = if common {
        LegendGrid::new
    } else {
        LegendGrid::column
    };
    let grids: Vec<LegendGrid> = entries.iter().map(|e| grid(e, room)).collect();
    let height_of = |grids: &[LegendGrid]| {
        let rows = grids.iter().map(LegendGrid::rows).max().unwrap_or(0);
        legend::ROW_MM * rows as f64 + 1.0
    };
    let mut tops = Vec::new();
    let mut end = caption_height(&caption);
    for row in grids.chunks(columns) {
        tops.push(end + head);
        end += head + HEIGHT_MM + AXIS_MM;
        end += if common { 0.0 } else { height_of(row) };
    }
    let shared = grids.first().filter(|_| common);
    let height = end + shared.map_or(0.0, |grid| height_of(std::slice::from_ref(grid)));

    let mut canvas = Canvas::new(width, height);
    canvas.caption(&caption);
    for (index, (panel, grid)) in panels.iter().zip(&grids).enumerate() {
        let (row, column) = (index / columns, index % columns);
        let start = left + (panel_width + GAP_MM) * column as f64;
        let frame = Frame {
            left: start,
            right: start + panel_width,
            top: tops[row],
            bottom: tops[row] + HEIGHT_MM,
            y_labels: column == 0,
            x_labels: true,
        };
        draw_panel(&mut canvas, panel, &frame);
        let heading = &figure.panels[index].heading;
        let at = [0.5 * (frame.left + frame.right), frame.top - 2.0];
        let size = fitting_size(heading, TICK_PT, panel_width);
        canvas.text(heading, at, size, Anchor::Middle, BLACK);
        if !common {
            grid.draw(&mut canvas, [start, frame.bottom + AXIS_MM]);
        }
    }
    if let Some(grid) = shared {
        grid.draw(&mut canvas, [MARGIN_MM, end]);
    }
    canvas.finish(&figure.title)
}

fn entries(panel: &ErrorPanel) -> Vec<Entry> {
    let entry = |label: &str, style| Entry {
        label: label.to_owned(),
        style,
        line: true,
    };
    let own = panel
        .curves
        .iter()
        .map(|curve| entry(&curve.label, Style::over_common_points(curve.look)));
    let labels = panel.guides.iter().filter_map(|g| g.label.as_deref());
    own.chain(labels.map(|label| entry(label, Style::limit(GREY))))
        .collect()
}

/// Points with two positive coordinates, by curve.
fn positive(panel: &ErrorPanel) -> Vec<Vec<[f64; 2]>> {
    let positive = |p: &&[f64; 2]| p.iter().all(|c| c.is_finite() && *c > 0.0);
    let curves = panel.curves.iter();
    curves
        .map(|curve| curve.points.iter().filter(positive).copied().collect())
        .collect()
}

/// A power law below the curves of a panel.
pub struct Law {
    /// Empty where it has no label.
    pub line: Vec<[f64; 2]>,
    pub triangle: SlopeTriangle,
}

/// Power laws below all curves, each further one below those before.
pub fn laws(
    guides: &[Guide],
    curves: &[Vec<[f64; 2]>],
    across: (f64, f64),
    upwards: (f64, f64),
) -> Vec<Law> {
    let points = || curves.iter().flatten();
    let Some((first, last)) = axis::range(points().map(|p| p[0])) else {
        return Vec::new();
    };
    let apart = (upwards.1 / upwards.0).powf(0.05).max(1.15);
    let width = across.1 / across.0;
    let guides = guides.iter().filter(|_| last > first).enumerate();
    let law = |(index, guide): (usize, &Guide)| {
        let slope = guide.rise / guide.run;
        // In logarithmic coordinates what lies below all points lies below all segments.
        let factor = points().map(|p| p[1] / p[0].powf(slope));
        let factor = factor.fold(f64::INFINITY, f64::min) / apart.powi(1 + index as i32);
        let y = |x: f64| factor * x.powf(slope);
        // At the high end: the number of the upright leg stands away from the curves.
        let x = if slope < 0.0 {
            [first * width.powf(0.1), first * width.powf(0.32)]
        } else {
            [last / width.powf(0.32), last / width.powf(0.1)]
        };
        let triangle = SlopeTriangle {
            x,
            // Its numbers stand clear of the line.
            y: y(x[0]) / apart.powf(0.7),
            slope,
            run: guide.run,
        };
        // A line steeper than all curves would leave the panel; it spans its triangle in any case.
        let floor = (upwards.0 / apart).min(y(x[0])).min(y(x[1]));
        let inside = |x: f64| x * (floor / y(x)).max(1.0).powf(1.0 / slope);
        let line = match guide.label {
            Some(_) => [first, last].map(|x| [inside(x), y(inside(x))]).to_vec(),
            None => Vec::new(),
        };
        Law { line, triangle }
    };
    guides.map(law).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(curves: Vec<Vec<[f64; 2]>>, rise: f64) -> ErrorPanel {
        let curve = |(look, points)| ErrorCurve {
            label: format!("curve {look}"),
            look,
            points,
        };
        ErrorPanel {
            heading: "heading".into(),
            curves: curves.into_iter().enumerate().map(curve).collect(),
            guides: vec![Guide {
                rise,
                run: 2.0,
                label: Some("theory".into()),
            }],
        }
    }

    /// Goal: the dotted line and its triangle have the slope and lie below every point, however the curves run.
    #[test]
    fn power_laws_lie_below_all_curves() {
        let curves = vec![
            vec![[10.0, 1.0], [100.0, 0.2], [1000.0, 0.15]],
            vec![[10.0, 0.3], [1000.0, 0.2]],
        ];
        for rise in [-1.0, -4.0, 1.0, 3.0] {
            let panel = panel(curves.clone(), rise);
            let found = laws(&panel.guides, &curves, (10.0, 1000.0), (0.15, 1.0));
            let [law] = &found[..] else { panic!("one law") };
            let [a, b] = [law.line[0], law.line[1]];
            let slope = (b[1] / a[1]).ln() / (b[0] / a[0]).ln();
            assert!((slope - rise / 2.0).abs() < 1e-12, "{rise}: {slope}");
            for p in curves.iter().flatten() {
                let below = a[1] * (p[0] / a[0]).powf(slope);
                assert!(below < p[1] / 1.1, "{rise}: {below} {p:?}");
            }
            let on_line = a[1] * (law.triangle.x[0] / a[0]).powf(slope);
            assert!(law.triangle.y < on_line && law.triangle.slope == rise / 2.0);
            let lowest = law.triangle.y.min(law.triangle.end()).min(0.1);
            for p in [a, b] {
                assert!(p[1] > lowest && p[0] >= 9.99 && p[0] <= 1000.1, "{p:?}");
            }
            assert!(b[0] > 2.0 * a[0], "{rise}: a line, not a point");
        }
    }

    /// Goal: every mesh has a marker, on curves that coincide too, and no line is wider than the others.
    #[test]
    fn coinciding_curves_keep_all_markers() {
        let line = vec![[10.0, 1.0], [40.0, 0.5], [45.0, 0.45], [160.0, 0.2]];
        let figure = ErrorFigure {
            title: "errors".into(),
            caption: String::new(),
            x_label: "x".into(),
            y_label: "y".into(),
            columns: 1,
            panels: vec![panel(vec![line; 4], -1.0)],
        };
        let svg = error_figure(&figure).expect("a figure").expect("points");
        // Discs of two curves, one of them with a hole; one more of each in the legend.
        assert_eq!(svg.matches("<circle").count(), 3 * 5);
        let widths: Vec<f64> = (0..4).map(|i| Style::over_common_points(i).width).collect();
        assert!(widths.iter().all(|w| *w == widths[0]));
        let empty = ErrorFigure {
            panels: vec![panel(vec![vec![[1.0, 0.0]]], -1.0)],
            ..figure
        };
        assert_eq!(error_figure(&empty).expect("no error"), None);
    }
}
