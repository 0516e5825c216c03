//! Charts: panels one above the other over a shared legend.

use super::axis::Axis;
use super::canvas::{
    Anchor, CAPTION_PT, Canvas, LABEL_PT, SMALL_PT, TICK_PT, Width, caption_height, fitted,
    fitting_size, text_width, wrapped,
};
use super::colour::{BLACK, LIGHT};
use super::legend::{self, Entry, LegendGrid};
use super::style::{Marker, Style, draw_mark, draw_marker};
use super::{curve_direction, marks};
use crate::report::ReportError;

const FRAME_MM: f64 = 0.2;
const TICK_MM: f64 = 1.2;
const MARGIN_MM: f64 = 1.5;
/// Least distance of two markers of one curve.
const MARKER_GAP_MM: f64 = 2.6;

/// A curve; points without a place on the axes (not finite, not positive on a logarithmic axis) are left out.
#[derive(Debug, Clone)]
pub struct Series {
    pub points: Vec<[f64; 2]>,
    pub style: Style,
    /// Marker and filling per point, or none; empty where all are the style's.
    pub markers: Vec<Option<(Marker, bool)>>,
}

/// A right-angled triangle that shows the slope of a power law y ~ x^slope, both axes logarithmic.
#[derive(Debug, Clone, Copy)]
pub struct SlopeTriangle {
    /// Ends of the horizontal leg.
    pub x: [f64; 2],
    /// y at `x[0]` on the sloped side.
    pub y: f64,
    pub slope: f64,
    /// Number at the horizontal leg; the upright leg has `run` times the slope.
    pub run: f64,
}

impl SlopeTriangle {
    /// y at `x[1]` on the sloped side.
    pub fn end(&self) -> f64 {
        self.y * (self.x[1] / self.x[0]).powf(self.slope)
    }
}

/// One coordinate system with its curves.
#[derive(Debug, Clone)]
pub struct Panel {
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    /// Horizontal lines in [`Style::level`].
    pub levels: Vec<f64>,
    pub slopes: Vec<SlopeTriangle>,
    pub markers: Markers,
}

/// Where markers stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Markers {
    /// At points that are not crowded.
    Sparse,
    /// Few on each curve, away from those of the others.
    Spread,
    /// At every point, those of later curves on top.
    Every,
    /// At points that are not crowded; the first curve shows in which direction it is run through.
    Direction,
}

/// A whole figure.
#[derive(Debug, Clone)]
pub struct Chart {
    pub title: String,
    pub caption: String,
    pub width: Width,
    /// Height of one panel's frame [mm].
    pub height: f64,
    pub panels: Vec<Panel>,
    /// Groups of entries; each starts a new row.
    pub legend: Vec<Vec<Entry>>,
}

impl Chart {
    /// The SVG text.
    pub fn svg(&self) -> Result<String, ReportError> {
        let width = self.width.mm();
        let axes = self.panels.iter().map(|panel| room_for_labels(&panel.y));
        let left = axes.fold(0.0, f64::max);
        let right = width - 4.0;
        let caption = wrapped(&self.caption, CAPTION_PT, width - 2.0 * MARGIN_MM);
        let gap = 5.0;
        let count = self.panels.len() as f64;
        let grids: Vec<LegendGrid> = self
            .legend
            .iter()
            .filter(|group| !group.is_empty())
            .map(|group| LegendGrid::new(group, width - 2.0 * MARGIN_MM))
            .collect();
        let legend_rows: usize = grids.iter().map(LegendGrid::rows).sum();
        let panels_height = count * self.height + (count - 1.0) * gap;
        let top = caption_height(&caption) + 1.0;
        let legend_top = top + panels_height + 11.0;
        let height = legend_top + legend::ROW_MM * legend_rows as f64 + 0.5;

        let mut canvas = Canvas::new(width, height);
        canvas.caption(&caption);
        for (index, panel) in self.panels.iter().enumerate() {
            let y = top + index as f64 * (self.height + gap);
            let frame = Frame {
                left,
                right,
                top: y,
                bottom: y + self.height,
                y_labels: true,
                x_labels: index + 1 == self.panels.len(),
            };
            draw_panel(&mut canvas, panel, &frame);
        }
        let mut y = legend_top;
        for grid in &grids {
            grid.draw(&mut canvas, [MARGIN_MM, y]);
            y += legend::ROW_MM * grid.rows() as f64;
        }
        canvas.finish(&self.title)
    }
}

/// Where a panel is drawn [mm].
pub struct Frame {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    /// Whether the y axis has labels.
    pub y_labels: bool,
    /// Whether the x axis has labels.
    pub x_labels: bool,
}

impl Frame {
    /// Place of a point of a panel.
    pub fn at(&self, panel: &Panel, point: [f64; 2]) -> [f64; 2] {
        [
            self.left + panel.x.place(point[0]) * (self.right - self.left),
            self.bottom - panel.y.place(point[1]) * (self.bottom - self.top),
        ]
    }
}

/// Room to the left of a frame for the labels of its y axis and the margin [mm].
pub fn room_for_labels(y: &Axis) -> f64 {
    let labels = y.major.iter().map(|(_, label)| text_width(label, TICK_PT));
    MARGIN_MM + 4.5 + labels.fold(0.0, f64::max) + TICK_MM
}

/// Draws axes and curves; labels of the y axis stand at the left margin of the canvas.
pub fn draw_panel(canvas: &mut Canvas, panel: &Panel, frame: &Frame) {
    draw_axes(canvas, panel, frame);
    for value in &panel.levels {
        let [_, y] = frame.at(panel, [0.0, *value]);
        let Style {
            colour,
            width,
            dashes,
            ..
        } = Style::level();
        canvas.dashed(&[[frame.left, y], [frame.right, y]], colour, width, dashes);
    }
    for slope in &panel.slopes {
        draw_slope(canvas, panel, frame, slope);
    }
    // All lines first: none runs over a marker.
    let places: Vec<Places> = panel
        .series
        .iter()
        .map(|series| draw_line(canvas, panel, frame, series))
        .collect();
    match panel.markers {
        Markers::Spread => {
            for (series, chosen) in panel.series.iter().zip(marks::spread(&places)) {
                for at in chosen {
                    draw_mark(canvas, at, &series.style);
                }
            }
        }
        Markers::Every => {
            for (series, places) in panel.series.iter().zip(&places) {
                for at in places.iter().flatten() {
                    draw_mark(canvas, *at, &series.style);
                }
            }
        }
        Markers::Sparse | Markers::Direction => {
            for (series, places) in panel.series.iter().zip(&places) {
                draw_markers(canvas, series, places);
            }
        }
    }
    if let (Markers::Direction, Some(first)) = (panel.markers, places.first()) {
        let points: Vec<[f64; 2]> = first.iter().flatten().copied().collect();
        let corners = [[frame.left, frame.top], [frame.right, frame.bottom]];
        curve_direction::draw(canvas, corners, &points);
    }
}

/// Points of a curve on paper; none where the axes have no place for one.
type Places = Vec<Option<[f64; 2]>>;

fn draw_axes(canvas: &mut Canvas, panel: &Panel, frame: &Frame) {
    let Frame {
        left,
        right,
        top,
        bottom,
        y_labels,
        x_labels,
    } = *frame;
    for (value, _) in &panel.y.major {
        let [_, y] = frame.at(panel, [0.0, *value]);
        canvas.line(&[[left, y], [right, y]], LIGHT, 0.1);
    }
    for (value, _) in &panel.x.major {
        let x = left + panel.x.place(*value) * (right - left);
        canvas.line(&[[x, top], [x, bottom]], LIGHT, 0.1);
    }
    let ticks = |major: &[(f64, String)], minor: &[f64]| -> Vec<(f64, f64)> {
        let major = major.iter().map(|(value, _)| (*value, TICK_MM));
        major
            .chain(minor.iter().map(|value| (*value, 0.5 * TICK_MM)))
            .collect()
    };
    for (value, length) in ticks(&panel.x.major, &panel.x.minor) {
        let x = left + panel.x.place(value) * (right - left);
        canvas.line(&[[x, bottom], [x, bottom - length]], BLACK, FRAME_MM);
    }
    for (value, length) in ticks(&panel.y.major, &panel.y.minor) {
        let [_, y] = frame.at(panel, [0.0, value]);
        canvas.line(&[[left, y], [left + length, y]], BLACK, FRAME_MM);
    }
    let corners = [
        [left, top],
        [right, top],
        [right, bottom],
        [left, bottom],
        [left, top],
    ];
    canvas.line(&corners, BLACK, FRAME_MM);
    for (value, label) in panel.y.major.iter().filter(|_| y_labels) {
        let [_, y] = frame.at(panel, [0.0, *value]);
        canvas.text(label, [left - 1.0, y], TICK_PT, Anchor::End, BLACK);
    }
    if x_labels {
        for (value, label) in &panel.x.major {
            let x = left + panel.x.place(*value) * (right - left);
            canvas.text(label, [x, bottom + 2.2], TICK_PT, Anchor::Middle, BLACK);
        }
        let middle = [0.5 * (left + right), bottom + 6.3];
        let size = fitting_size(&panel.x.label, LABEL_PT, right - left);
        canvas.text(&panel.x.label, middle, size, Anchor::Middle, BLACK);
    }
    if !y_labels {
        return;
    }
    let middle = [MARGIN_MM + 1.5, 0.5 * (top + bottom)];
    // A long label may stand a little above and below its panel.
    let size = fitting_size(&panel.y.label, LABEL_PT, bottom - top + 5.0);
    let label = fitted(&panel.y.label, size, bottom - top + 6.0);
    canvas.text_upwards(&label, middle, size, BLACK);
}

fn draw_line(canvas: &mut Canvas, panel: &Panel, frame: &Frame, series: &Series) -> Places {
    let places: Places = series
        .points
        .iter()
        .map(|point| Some(frame.at(panel, *point)).filter(|p| p.iter().all(|c| c.is_finite())))
        .collect();
    for piece in places.split(Option::is_none) {
        let piece: Vec<[f64; 2]> = piece.iter().flatten().copied().collect();
        canvas.dashed(
            &piece,
            series.style.colour,
            series.style.width,
            series.style.dashes,
        );
    }
    places
}

fn draw_markers(canvas: &mut Canvas, series: &Series, places: &Places) {
    let Some(own) = series.style.marker else {
        return;
    };
    let mut last: Option<([f64; 2], (Marker, bool))> = None;
    for (index, place) in places.iter().enumerate() {
        let Some(place) = place else { continue };
        let own = (own, series.style.filled);
        let Some(look) = series.markers.get(index).copied().unwrap_or(Some(own)) else {
            continue;
        };
        // Dense curves get few markers, but a change of marker is always shown.
        let crowded = last.is_some_and(|(at, before)| {
            before == look && (place[0] - at[0]).hypot(place[1] - at[1]) < MARKER_GAP_MM
        });
        if !crowded && series.style.stagger.picks(index) {
            let colour = series.style.marker_colour();
            draw_marker(canvas, *place, look.0, look.1, colour);
            last = Some((*place, look));
        }
    }
}

fn draw_slope(canvas: &mut Canvas, panel: &Panel, frame: &Frame, slope: &SlopeTriangle) {
    let start = frame.at(panel, [slope.x[0], slope.y]);
    let end = frame.at(panel, [slope.x[1], slope.end()]);
    // The right angle is below the sloped side: under its higher end.
    let rising = slope.slope > 0.0;
    let corner = if rising {
        [end[0], start[1]]
    } else {
        [start[0], end[1]]
    };
    canvas.line(&[start, end, corner, start], BLACK, 0.2);
    let low = start[1].max(end[1]);
    let middle = [0.5 * (start[0] + end[0]), low + 1.7];
    let number = |x: f64| crate::report::number::significant(x, 3);
    canvas.text(&number(slope.run), middle, SMALL_PT, Anchor::Middle, BLACK);
    let (x, anchor) = if rising {
        (corner[0] + 0.8, Anchor::Start)
    } else {
        (corner[0] - 0.8, Anchor::End)
    };
    let text = number((slope.slope * slope.run).abs());
    canvas.text(
        &text,
        [x, 0.5 * (start[1] + end[1])],
        SMALL_PT,
        anchor,
        BLACK,
    );
}
