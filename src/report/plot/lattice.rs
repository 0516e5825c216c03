//! Small logarithmic panels side by side over common axes: the same curves on many bodies.

use super::axis::Axis;
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, LABEL_PT, SMALL_PT, TICK_PT, Width, caption_height, fitting_size,
    plain, text_width, wrapped,
};
use super::colour::{BLACK, GREY, LIGHT};
use super::legend::{self, Entry, LegendGrid};
use super::style::{Style, draw_marker};
use crate::report::ReportError;

const MARGIN_MM: f64 = 1.5;
const FRAME_MM: f64 = 0.2;
const TICK_MM: f64 = 1.0;
/// Height of a panel, of a line of its heading, and the gap beside it.
const PANEL_MM: f64 = 31.0;
const HEADING_MM: f64 = 2.9;
const GAP_MM: f64 = 2.5;
/// Room below a panel, and below one with an axis.
const BELOW_MM: f64 = 2.0;
const AXIS_MM: f64 = 10.0;

/// One panel.
#[derive(Debug, Clone)]
pub struct SmallPanel {
    /// What is shown; lines.
    pub heading: Vec<String>,
    /// A curve per entry of [`Lattice::curves`]; points (x, y).
    pub curves: Vec<Vec<[f64; 2]>>,
    /// A bound, drawn in dots.
    pub bound: Vec<[f64; 2]>,
}

/// Rows of panels; the panels of one group share their x axis, all panels the y axis.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// For screen readers and file browsers.
    pub title: String,
    /// Above the figure.
    pub caption: String,
    /// Panels of a row.
    pub columns: usize,
    /// Names of the curves.
    pub curves: Vec<String>,
    /// Name of the bounds.
    pub bound: String,
    /// Label of the x axes with unit.
    pub x_label: String,
    /// Label of the y axis with unit.
    pub y_label: String,
    /// Smaller y, zero too, stand on the lower edge.
    pub floor: f64,
    /// Groups of panels; each starts a new row.
    pub groups: Vec<Vec<SmallPanel>>,
}

/// The figure, 170 mm wide.
///
/// # Errors
/// [`ReportError::Figure`] without a point.
pub fn lattice(lattice: &Lattice) -> Result<String, ReportError> {
    let nothing = || ReportError::figure("lattice", "nothing to draw");
    let panels = || lattice.groups.iter().flatten();
    let points = |panel: &SmallPanel| -> Vec<[f64; 2]> {
        let own = panel.curves.iter().flatten();
        own.chain(&panel.bound).copied().collect()
    };
    let heights = panels().flat_map(points).map(|p| p[1]);
    let heights = heights
        .chain([lattice.floor])
        .filter(|y| *y >= lattice.floor);
    let y = Axis::log(&lattice.y_label, heights).ok_or_else(nothing)?;
    let width = Width::Page.mm();
    let labels = y.major.iter().map(|(_, label)| text_width(label, TICK_PT));
    let left = MARGIN_MM + 5.0 + labels.fold(0.0, f64::max);
    let columns = lattice.columns.max(1);
    let panel_width = (width - MARGIN_MM - left - GAP_MM * (columns - 1) as f64) / columns as f64;

    let caption = wrapped(&lattice.caption, CAPTION_PT, width - 2.0 * MARGIN_MM);
    let top = caption_height(&caption);
    let lines = panels().map(|p| p.heading.len()).max().unwrap_or(0) as f64;
    let head = 1.0 + HEADING_MM * lines;
    let rows = |group: &[SmallPanel]| group.len().div_ceil(columns) as f64;
    let filled = |group: &&Vec<SmallPanel>| group.iter().any(|p| !points(p).is_empty());
    let groups = lattice.groups.iter().filter(filled);
    if groups.clone().next().is_none() {
        return Err(nothing());
    }
    let body: f64 = groups
        .clone()
        .map(|g| rows(g) * (head + PANEL_MM + BELOW_MM) + AXIS_MM - BELOW_MM)
        .sum();
    let entries = entries(lattice);
    let grid = LegendGrid::new(&entries, width - 2.0 * MARGIN_MM);
    let legend_top = top + body + 2.0;
    let height = legend_top + legend::ROW_MM * grid.rows() as f64;
    let mut canvas = Canvas::new(width, height);
    canvas.caption(&caption);

    let mut row_top = top + head;
    for group in groups {
        let across = group.iter().flat_map(points).map(|p| p[0]);
        let x = Axis::log(&lattice.x_label, across).ok_or_else(nothing)?;
        for (row, panels) in group.chunks(columns).enumerate() {
            for (column, panel) in panels.iter().enumerate() {
                let start = left + (panel_width + GAP_MM) * column as f64;
                let frame = Frame {
                    x: [start, start + panel_width],
                    y: [row_top, row_top + PANEL_MM],
                };
                // No panel of the group below it: its axis has labels.
                let lowest = (row + 1) * columns + column >= group.len();
                draw_axes(&mut canvas, &frame, [&x, &y], column == 0, lowest);
                draw_heading(&mut canvas, &frame, &panel.heading);
                draw_curves(&mut canvas, &frame, [&x, &y], panel, lattice.floor);
            }
            row_top += head + PANEL_MM + BELOW_MM;
        }
        row_top += AXIS_MM - BELOW_MM;
    }
    grid.draw(&mut canvas, [MARGIN_MM, legend_top]);
    canvas.finish(&lattice.title)
}

fn entries(lattice: &Lattice) -> Vec<Entry> {
    let own = lattice.curves.iter().enumerate().map(|(i, name)| Entry {
        label: plain(name),
        style: Style::of_curve(i),
        line: true,
    });
    let bound = Entry {
        label: plain(&lattice.bound),
        style: Style::limit(BLACK),
        line: true,
    };
    own.chain([bound]).collect()
}

/// Where a panel is drawn [mm].
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
}

impl Frame {
    fn at(&self, [x, y]: [&Axis; 2], point: [f64; 2]) -> [f64; 2] {
        [
            self.x[0] + x.place(point[0]) * (self.x[1] - self.x[0]),
            self.y[1] - y.place(point[1]) * (self.y[1] - self.y[0]),
        ]
    }
}

fn draw_axes(canvas: &mut Canvas, frame: &Frame, axes: [&Axis; 2], first: bool, lowest: bool) {
    let Frame {
        x: [left, right],
        y: [top, bottom],
    } = *frame;
    let [x, y] = axes;
    let up = |value: f64| bottom - y.place(value) * (bottom - top);
    let across = |value: f64| left + x.place(value) * (right - left);
    for (value, label) in &y.major {
        let at = up(*value);
        canvas.line(&[[left, at], [right, at]], LIGHT, 0.1);
        canvas.line(&[[left, at], [left + TICK_MM, at]], BLACK, FRAME_MM);
        if first {
            canvas.text(label, [left - 1.0, at], TICK_PT, Anchor::End, BLACK);
        }
    }
    for (value, label) in &x.major {
        let at = across(*value);
        canvas.line(&[[at, top], [at, bottom]], LIGHT, 0.1);
        canvas.line(&[[at, bottom], [at, bottom - TICK_MM]], BLACK, FRAME_MM);
        if lowest {
            canvas.text(label, [at, bottom + 2.2], TICK_PT, Anchor::Middle, BLACK);
        }
    }
    for value in &x.minor {
        let at = across(*value);
        canvas.line(
            &[[at, bottom], [at, bottom - 0.5 * TICK_MM]],
            BLACK,
            FRAME_MM,
        );
    }
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]];
    let corners = corners.map(|[a, b]| [frame.x[a], frame.y[b]]);
    canvas.line(&corners, BLACK, FRAME_MM);
    if first {
        let middle = [MARGIN_MM + 1.5, 0.5 * (top + bottom)];
        canvas.text_upwards(&y.label, middle, LABEL_PT, BLACK);
    }
    if lowest {
        let middle = [0.5 * (left + right), bottom + 5.8];
        let size = fitting_size(&x.label, LABEL_PT, right - left);
        canvas.text(&x.label, middle, size, Anchor::Middle, BLACK);
    }
}

fn draw_heading(canvas: &mut Canvas, frame: &Frame, lines: &[String]) {
    let middle = 0.5 * (frame.x[0] + frame.x[1]);
    for (above, line) in lines.iter().rev().enumerate() {
        let at = [middle, frame.y[0] - 1.9 - HEADING_MM * above as f64];
        let line = plain(line);
        let size = fitting_size(&line, SMALL_PT, frame.x[1] - frame.x[0]);
        canvas.text(&line, at, size, Anchor::Middle, BLACK);
    }
}

fn draw_curves(
    canvas: &mut Canvas,
    frame: &Frame,
    axes: [&Axis; 2],
    panel: &SmallPanel,
    floor: f64,
) {
    let dots = Style::limit(GREY);
    let bound: Vec<[f64; 2]> = panel.bound.iter().map(|p| frame.at(axes, *p)).collect();
    canvas.dashed(&bound, dots.colour, dots.width, dots.dashes);
    // What lies below the axis stands on its edge.
    let place = |p: &[f64; 2]| {
        if p[1] < floor {
            [frame.at(axes, [p[0], floor])[0], frame.y[1]]
        } else {
            frame.at(axes, *p)
        }
    };
    let curves = || panel.curves.iter().enumerate();
    for (i, points) in curves() {
        let style = Style::of_curve(i);
        let line: Vec<[f64; 2]> = points.iter().map(place).collect();
        canvas.dashed(&line, style.colour, style.width, style.dashes);
    }
    for (i, points) in curves() {
        let style = Style::of_curve(i);
        for point in points {
            if let Some(marker) = style.marker {
                draw_marker(canvas, place(point), marker, style.filled, style.colour);
            }
        }
    }
}
