//! Curves of methods in panels side by side over a common legend: profiles, work against precision, time to accuracy.
//!
//! The x axis is logarithmic. Panels with the same x label share it, all panels share the y axis. A method looks the same in
//! every panel and figure.

use super::axis::{self, Axis};
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, TICK_PT, Width, caption_height, fitting_size, plain, wrapped,
};
use super::chart::{Frame, Markers, Panel, Series, draw_panel, room_for_labels};
use super::colour::{BLACK, GREY};
use super::errors::{Guide, Law, laws};
use super::legend::{self, Entry, LegendGrid};
use super::methods;
use super::style::Style;
use crate::report::ReportError;

const MARGIN_MM: f64 = 1.5;
const HEADING_MM: f64 = 4.5;
const GAP_MM: f64 = 3.0;
/// Room for the labels of an x axis, and below a panel without them.
const AXIS_MM: f64 = 11.0;
const BELOW_MM: f64 = 1.5;
const WHISKER_MM: f64 = 0.15;
/// Half the height of the ends of a whisker.
const END_MM: f64 = 0.5;

/// One curve of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodCurve {
    /// Method, options in brackets; the label in the legend.
    pub method: String,
    /// Points; what has no place on the axes is left out.
    pub points: Vec<[f64; 2]>,
    /// Ends in x of the interval about every point; empty without intervals.
    pub whiskers: Vec<[f64; 2]>,
}

/// One coordinate system.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodPanel {
    /// Above the panel; may be empty.
    pub heading: String,
    /// Label of the x axis with unit.
    pub x_label: String,
    /// The curves.
    pub curves: Vec<MethodCurve>,
    /// Power laws to compare with; logarithmic y only.
    pub guides: Vec<Guide>,
}

/// A whole figure.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodPanels {
    /// For screen readers and file browsers.
    pub title: String,
    /// Small text above the panels.
    pub caption: String,
    /// Label of the y axis with unit.
    pub y_label: String,
    /// Whether y is logarithmic; otherwise it goes from 0 to 1.
    pub logarithmic: bool,
    /// Whether every point has a marker; otherwise few on each curve, away from the others.
    pub every_point: bool,
    /// Panels of a row: one is 85 mm wide, more share 170 mm.
    pub columns: usize,
    /// Height of a panel [mm].
    pub height: f64,
    /// The panels, row by row.
    pub panels: Vec<MethodPanel>,
}

/// Corners of the curve that jumps at each step (x, y) to y and stays there up to `end`. It begins where it first rises from
/// 0: many curves along the axis could not be told apart.
pub fn stairs(steps: &[[f64; 2]], end: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    let mut last = 0.0;
    for [x, y] in steps.iter().filter(|step| step[1] > 0.0) {
        points.extend([[*x, last], [*x, *y]]);
        last = *y;
    }
    let highest = points.last().copied();
    points.extend(highest.map(|[x, y]| [end.max(x), y]));
    points.dedup();
    points
}

/// The figure as SVG; none where no point has a place.
///
/// # Errors
/// [`ReportError::Drawing`].
pub fn method_panels(figure: &MethodPanels) -> Result<Option<String>, ReportError> {
    let curves: Vec<Vec<Vec<[f64; 2]>>> = figure
        .panels
        .iter()
        .map(|panel| placed(panel, figure.logarithmic))
        .collect();
    let all = || curves.iter().flatten().flatten();
    let Some(upwards) = axis::range(all().map(|p| p[1])) else {
        return Ok(None);
    };
    let own_laws: Vec<Vec<Law>> = figure
        .panels
        .iter()
        .zip(&curves)
        .map(|(panel, curves)| {
            let across = axis::range(curves.iter().flatten().map(|p| p[0]));
            across.map_or_else(Vec::new, |across| {
                laws(&panel.guides, curves, across, upwards)
            })
        })
        .collect();
    let room = (upwards.1 / upwards.0).powf(0.06).max(1.3);
    let triangles = own_laws.iter().flatten().map(|law| &law.triangle);
    let lowest = triangles.map(|t| t.y.min(t.end()) / room);
    let y = if figure.logarithmic {
        Axis::log(&figure.y_label, all().map(|p| p[1]).chain(lowest))
    } else {
        Some(Axis::linear(&figure.y_label, [0.0, 1.0], 6))
    };
    let Some(y) = y else { return Ok(None) };
    let styles = Looks::of(figure);
    let mut panels = Vec::new();
    for ((panel, own), laws) in figure.panels.iter().zip(&curves).zip(&own_laws) {
        // Over all panels of the same label, whiskers included.
        let alike = figure.panels.iter().zip(&curves);
        let alike = alike.filter(|(other, _)| other.x_label == panel.x_label);
        let across = alike.flat_map(|(other, curves)| {
            let whiskers = other
                .curves
                .iter()
                .flat_map(|c| c.whiskers.iter().flatten());
            let points = curves.iter().flatten().map(|p| &p[0]);
            points.chain(whiskers).copied().collect::<Vec<f64>>()
        });
        let Some(x) = Axis::log(&panel.x_label, across).or_else(|| Axis::log("", [1.0, 10.0]))
        else {
            continue;
        };
        panels.push(chart_panel(
            figure,
            panel,
            own,
            laws,
            [x, y.clone()],
            &styles,
        ));
    }
    draw(figure, &panels, &styles).map(Some)
}

/// Points with a place, by curve.
fn placed(panel: &MethodPanel, logarithmic: bool) -> Vec<Vec<[f64; 2]>> {
    let has_place = |p: &&[f64; 2]| {
        let [x, y] = **p;
        x.is_finite() && y.is_finite() && x > 0.0 && (y > 0.0 || !logarithmic)
    };
    let own = |curve: &MethodCurve| curve.points.iter().filter(has_place).copied().collect();
    panel.curves.iter().map(own).collect()
}

/// The look of every method of a figure.
struct Looks {
    names: Vec<String>,
    styles: Vec<Style>,
}

impl Looks {
    fn of(figure: &MethodPanels) -> Self {
        let curves = figure.panels.iter().flat_map(|panel| &panel.curves);
        let mut names: Vec<String> = curves.map(|curve| curve.method.clone()).collect();
        names.sort_by_key(|name| (methods::rank(name), name.clone()));
        names.dedup();
        let labels: Vec<&str> = names.iter().map(String::as_str).collect();
        let styles = methods::styles(&labels);
        Self { names, styles }
    }

    fn get(&self, method: &str) -> Option<&Style> {
        let place = self.names.iter().position(|name| name == method)?;
        self.styles.get(place)
    }

    fn entries(&self) -> Vec<Entry> {
        let own = self.names.iter().zip(&self.styles);
        own.map(|(name, style)| Entry {
            label: plain(name),
            style: style.clone(),
            line: true,
        })
        .collect()
    }
}

fn chart_panel(
    figure: &MethodPanels,
    panel: &MethodPanel,
    points: &[Vec<[f64; 2]>],
    laws: &[Law],
    [x, y]: [Axis; 2],
    looks: &Looks,
) -> Panel {
    let series = |points: &Vec<[f64; 2]>, style| Series {
        points: points.clone(),
        style,
        markers: Vec::new(),
    };
    let dotted = laws.iter().filter(|law| !law.line.is_empty());
    let dotted = dotted.map(|law| series(&law.line, Style::limit(GREY)));
    let curves = panel.curves.iter().zip(points);
    let curves = curves
        .filter_map(|(curve, points)| Some(series(points, looks.get(&curve.method)?.clone())));
    Panel {
        x,
        y,
        series: dotted.chain(curves).collect(),
        levels: Vec::new(),
        slopes: laws.iter().map(|law| law.triangle).collect(),
        markers: if figure.every_point {
            Markers::Every
        } else {
            Markers::Spread
        },
    }
}

fn draw(figure: &MethodPanels, panels: &[Panel], looks: &Looks) -> Result<String, ReportError> {
    let columns = figure.columns.clamp(1, panels.len().max(1));
    let width = match columns {
        1 => Width::Column.mm(),
        _ => Width::Page.mm(),
    };
    let left = panels
        .first()
        .map_or(0.0, |panel| room_for_labels(&panel.y));
    let free = width - MARGIN_MM - 2.5 - left - GAP_MM * (columns - 1) as f64;
    let panel_width = free / columns as f64;
    let caption = wrapped(&figure.caption, CAPTION_PT, width - 2.0 * MARGIN_MM);
    let entries = looks.entries();
    let grid = LegendGrid::new(&entries, width - 2.0 * MARGIN_MM);
    // Below a panel of the same x axis there are no labels.
    let shared = figure
        .panels
        .windows(2)
        .all(|p| p[0].x_label == p[1].x_label);
    let rows = panels.len().div_ceil(columns);
    let below = |row: usize| {
        let last = row + 1 == rows;
        if last || !shared { AXIS_MM } else { BELOW_MM }
    };
    let head = match figure.panels.iter().any(|p| !p.heading.is_empty()) {
        true => HEADING_MM,
        false => 1.0,
    };
    let mut tops = Vec::new();
    let mut end = caption_height(&caption);
    for row in 0..rows {
        tops.push(end + head);
        end += head + figure.height + below(row);
    }
    let height = end + legend::ROW_MM * grid.rows() as f64 + 0.5;
    let mut canvas = Canvas::new(width, height);
    canvas.caption(&caption);
    for (index, panel) in panels.iter().enumerate() {
        let (row, column) = (index / columns, index % columns);
        let start = left + (panel_width + GAP_MM) * column as f64;
        let frame = Frame {
            left: start,
            right: start + panel_width,
            top: tops[row],
            bottom: tops[row] + figure.height,
            y_labels: column == 0,
            x_labels: !shared || index + columns >= panels.len(),
        };
        draw_panel(&mut canvas, panel, &frame);
        let Some(told) = figure.panels.get(index) else {
            continue;
        };
        for curve in &told.curves {
            if let Some(style) = looks.get(&curve.method) {
                draw_whiskers(&mut canvas, panel, &frame, curve, style);
            }
        }
        let at = [0.5 * (frame.left + frame.right), frame.top - 2.2];
        let heading = plain(&told.heading);
        let size = fitting_size(&heading, TICK_PT, panel_width);
        canvas.text(&heading, at, size, Anchor::Middle, BLACK);
    }
    grid.draw(&mut canvas, [MARGIN_MM, end + 1.0]);
    canvas.finish(&figure.title)
}

fn draw_whiskers(
    canvas: &mut Canvas,
    panel: &Panel,
    frame: &Frame,
    curve: &MethodCurve,
    style: &Style,
) {
    for (point, ends) in curve.points.iter().zip(&curve.whiskers) {
        let places = ends.map(|x| frame.at(panel, [x, point[1]]));
        if places.iter().flatten().all(|c| c.is_finite()) {
            canvas.line(&places, style.colour, WHISKER_MM);
            for [x, y] in places {
                canvas.line(
                    &[[x, y - END_MM], [x, y + END_MM]],
                    style.colour,
                    WHISKER_MM,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stairs_jump_where_they_rise_and_stay_to_the_end() {
        let corners = stairs(&[[1.0, 0.5], [2.0, 1.0]], 8.0);
        let expected = [[1.0, 0.0], [1.0, 0.5], [2.0, 0.5], [2.0, 1.0], [8.0, 1.0]];
        assert_eq!(corners, expected);
        // Nothing is drawn along the axis.
        let late = stairs(&[[1.0, 0.0], [3.0, 1.0]], 3.0);
        assert_eq!(late, [[3.0, 0.0], [3.0, 1.0]]);
        assert!(stairs(&[[1.0, 0.0]], 8.0).is_empty());
        assert!(stairs(&[], 8.0).is_empty());
    }

    #[test]
    fn nothing_to_draw_is_no_figure() {
        let mut figure = MethodPanels {
            title: "t".into(),
            caption: String::new(),
            y_label: "error [-]".into(),
            logarithmic: true,
            every_point: true,
            columns: 2,
            height: 40.0,
            panels: vec![MethodPanel {
                heading: String::new(),
                x_label: "time [s]".into(),
                curves: vec![MethodCurve {
                    method: "latin".into(),
                    points: vec![[1.0, 0.0], [f64::NAN, 1.0]],
                    whiskers: Vec::new(),
                }],
                guides: Vec::new(),
            }],
        };
        assert_eq!(method_panels(&figure).expect("no error"), None);
        figure.panels[0].curves[0].points = vec![[1.0, 1e-3], [2.0, 1e-6]];
        let svg = method_panels(&figure).expect("no error").expect("points");
        assert!(svg.contains("latin") && svg.contains("time [s]"));
    }
}
