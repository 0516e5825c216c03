//! The one frame of all figures made of lines, markers and bars: panels in a grid over shared axes, and a legend.
//!
//! A kind of figure says what is drawn; ranges, ticks, room for labels and the legend follow from it. Panels whose axes have
//! the same label share range and tick labels. Series with the same label share a line of the legend.

use super::axis::{Axis, range};
use super::canvas::{
    Anchor, COLUMN, Canvas, Head, LABEL_PT, MARGIN_MM, PAGE, SMALL_PT, TICK_PT, fitting_size,
    text_width, wrapped,
};
use super::legend::Legend;
use super::panel::{Law, Place, draw_panel};
use super::style::{BLACK, Marker, Style};
use crate::report::ReportError;

/// Room for the tick labels and the label of an x axis, and below a panel without them [mm].
const AXIS_MM: f64 = 10.0;
const GAP_MM: f64 = 3.0;
const HEADING_MM: f64 = 3.0;
/// Height of a row of a named axis [mm].
pub const ROW_MM: f64 = 4.4;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Draw {
    /// Points joined in their order.
    Line,
    /// The value of a point holds until the next, the last one to the end of the axis.
    Stairs,
    /// Like [`Draw::Line`], with arrows in its direction.
    Path,
    /// Bars along x at each point, from and to the ends of its interval.
    Bars,
}

/// Points of one look.
#[derive(Debug, Clone)]
pub struct Series {
    /// In the legend; empty for none.
    pub label: String,
    pub style: Style,
    pub draw: Draw,
    /// x and y; what has no place on the axes is left out.
    pub points: Vec<[f64; 2]>,
    /// Ends in x of the interval about every point; empty without intervals.
    pub intervals: Vec<[f64; 2]>,
    /// Marker and filling per point, or none; empty where all are the style's.
    pub marks: Vec<Option<(Marker, bool)>>,
    /// Texts at the points; empty without.
    pub texts: Vec<String>,
}

impl Series {
    /// Points joined in their order, with the markers of the style.
    pub fn new(label: impl Into<String>, style: Style, points: Vec<[f64; 2]>) -> Self {
        let (intervals, marks, texts) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            label: label.into(),
            style,
            draw: Draw::Line,
            points,
            intervals,
            marks,
            texts,
        }
    }
}

/// A power law to compare with: y ~ x^(rise/run), as a triangle below all curves; with a label also as a dotted line.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// Number at the upright leg, positive where y grows with x.
    pub rise: f64,
    /// Number at the horizontal leg.
    pub run: f64,
    /// In the legend; empty for the triangle alone.
    pub label: String,
}

/// One coordinate system.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Above the panel; may be empty.
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    /// Of the frame [mm]; named y axes take what their names need.
    pub height: f64,
    pub series: Vec<Series>,
    /// Horizontal lines.
    pub levels: Vec<f64>,
    /// Both axes logarithmic.
    pub guides: Vec<Guide>,
}

impl Panel {
    /// A panel of these axes and this height [mm].
    pub fn new(x: Axis, y: Axis, height: f64) -> Self {
        let (series, levels, guides) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            heading: String::new(),
            x,
            y,
            height,
            series,
            levels,
            guides,
        }
    }

    /// Points with a place.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        let all = self.series.iter().flat_map(|s| s.points.iter().copied());
        all.filter(|p| self.x.has(p[0]) && self.y.has(p[1]))
    }

    fn values(&self, c: usize, laws: &[Law]) -> Vec<f64> {
        let mut values: Vec<f64> = self.points().map(|p| p[c]).collect();
        if c == 0 {
            values.extend(
                self.series
                    .iter()
                    .flat_map(|s| s.intervals.iter().flatten()),
            );
        } else {
            values.extend(&self.levels);
            values.extend(laws.iter().map(Law::lowest));
        }
        values
    }

    fn height(&self) -> f64 {
        if self.y.is_named() {
            let names = self.y.fitted([0.0], 1).map_or(1, |axis| axis.major.len());
            return ROW_MM * names as f64;
        }
        self.height
    }

    fn axis(&self, c: usize) -> &Axis {
        if c == 0 { &self.x } else { &self.y }
    }
}

/// A whole figure. Labels may hold [`subscript`](super::subscript) and [`italic`](super::italic).
#[derive(Debug, Clone)]
pub struct Figure {
    /// What it shows, as a sentence where the data say one.
    pub title: String,
    /// What the reader must know besides: case, mesh, what was left out.
    pub caption: String,
    /// Panels of a row: one is 85 mm wide, more share 170 mm.
    pub columns: usize,
    /// Whether a single column is 170 mm wide too.
    pub wide: bool,
    /// Whether every panel has a legend of its own.
    pub own_legends: bool,
    /// Row by row.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// A figure of one panel per row.
    pub fn new(title: impl Into<String>, caption: impl Into<String>, panels: Vec<Panel>) -> Self {
        let (title, caption) = (title.into(), caption.into());
        Self {
            title,
            caption,
            columns: 1,
            wide: false,
            own_legends: false,
            panels,
        }
    }

    /// The same with this many panels in a row.
    pub fn columns(self, columns: usize) -> Self {
        Self {
            columns: columns.clamp(1, self.panels.len().max(1)),
            ..self
        }
    }

    /// The SVG text; none where nothing has a place on the axes.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        let width = if self.columns > 1 || self.wide {
            PAGE
        } else {
            COLUMN
        };
        let Some(fitted) = self.fitted(width / self.columns as f64) else {
            return Ok(None);
        };
        let panels: Vec<&Panel> = fitted.iter().map(|(panel, _)| panel).collect();
        let columns = self.columns;
        let same = |a: usize, b: usize, c: usize| {
            self.panels[a].axis(c).label == self.panels[b].axis(c).label
        };
        let y_labels = |i: usize| i % columns == 0 || !same(i, i - 1, 1);
        let x_labels = |i: usize| i + columns >= panels.len() || !same(i, i + columns, 0);
        // Widths: room for the labels of every column, the rest shared.
        let room = |column: usize| {
            let own = (column..panels.len()).step_by(columns);
            let rooms = own.map(|i| {
                if y_labels(i) {
                    room_for_labels(&panels[i].y)
                } else {
                    GAP_MM
                }
            });
            rooms.fold(0.0, f64::max)
        };
        let rooms: Vec<f64> = (0..columns).map(room).collect();
        let frame = (width - 3.0 - rooms.iter().sum::<f64>()) / columns as f64;
        let left = |column: usize| rooms[..=column].iter().sum::<f64>() + frame * column as f64;
        // Heights: head, rows with headings, axes and own legends, common legend.
        let head = Head::new(&self.title, &self.caption, width);
        let headings: Vec<Vec<String>> = panels
            .iter()
            .map(|p| wrapped(&p.heading, TICK_PT, frame))
            .collect();
        let legends: Vec<Legend> = match self.own_legends {
            true => panels.iter().map(|p| Legend::of(&[p], frame)).collect(),
            false => vec![Legend::of(&panels, width - 2.0 * MARGIN_MM)],
        };
        let mut tops = Vec::new();
        let mut end = head.height();
        for row in 0..panels.len().div_ceil(columns) {
            let own = row * columns..((row + 1) * columns).min(panels.len());
            let largest = |of: &dyn Fn(usize) -> f64| own.clone().map(of).fold(0.0, f64::max);
            tops.push(end + 1.0 + largest(&|i| HEADING_MM * headings[i].len() as f64));
            end = tops[row] + largest(&|i| panels[i].height());
            end += largest(&|i| if x_labels(i) { AXIS_MM } else { 2.0 });
            if self.own_legends {
                end += largest(&|i| legends[i].height());
            }
        }
        let common = if self.own_legends {
            0.0
        } else {
            legends[0].height()
        };
        let mut canvas = Canvas::new(width, end + common + 0.5);
        head.draw(&mut canvas);
        for (index, (panel, laws)) in fitted.iter().enumerate() {
            let (left, top) = (left(index % columns), tops[index / columns]);
            let place = Place {
                left,
                right: left + frame,
                top,
                bottom: top + panel.height(),
            };
            draw_panel(&mut canvas, panel, laws, &place);
            draw_labels(
                &mut canvas,
                panel,
                &place,
                [x_labels(index), y_labels(index)],
            );
            for (line, text) in headings[index].iter().rev().enumerate() {
                let at = [
                    0.5 * (left + place.right),
                    top - 2.0 - HEADING_MM * line as f64,
                ];
                canvas.text(text, at, TICK_PT, Anchor::Middle, BLACK);
            }
            if self.own_legends {
                legends[index].draw(&mut canvas, [left, place.bottom + AXIS_MM + 1.0]);
            }
        }
        if !self.own_legends {
            legends[0].draw(&mut canvas, [MARGIN_MM, end + 1.5]);
        }
        canvas.finish(&self.title).map(Some)
    }

    /// Panels with their ranges and power laws; none where no panel has a point.
    fn fitted(&self, width: f64) -> Option<Vec<(Panel, Vec<Law>)>> {
        let extent = |c: usize| {
            range(
                self.panels
                    .iter()
                    .flat_map(|p| p.points().map(move |q| q[c])),
            )
        };
        let extents = [extent(0)?, extent(1)?];
        let laws: Vec<Vec<Law>> = self.panels.iter().map(|p| Law::below(p, extents)).collect();
        let fit = |panel: &Panel, c: usize| {
            let axis = panel.axis(c);
            let alike = self
                .panels
                .iter()
                .zip(&laws)
                .filter(|(p, _)| p.axis(c).label == axis.label);
            let values: Vec<f64> = alike.flat_map(|(p, laws)| p.values(c, laws)).collect();
            let room = if c == 0 {
                width / 14.0
            } else {
                panel.height() / 8.0
            };
            let count = (room as usize).clamp(2, 7);
            axis.fitted(values, count)
                .or_else(|| axis.fitted([1.0, 10.0], count))
        };
        let fitted = self.panels.iter().map(|panel| {
            let (x, y) = (fit(panel, 0)?, fit(panel, 1)?);
            Some(Panel {
                x,
                y,
                ..panel.clone()
            })
        });
        Some(
            fitted
                .collect::<Option<Vec<Panel>>>()?
                .into_iter()
                .zip(laws)
                .collect(),
        )
    }
}

/// Room to the left of a frame for the labels of its y axis and the margin [mm].
fn room_for_labels(y: &Axis) -> f64 {
    let labels = y.major.iter().map(|(_, label)| text_width(label, TICK_PT));
    let name = if y.label.is_empty() { 1.0 } else { 5.5 };
    MARGIN_MM + name + labels.fold(0.0, f64::max)
}

/// Tick labels and labels of the axes.
fn draw_labels(canvas: &mut Canvas, panel: &Panel, place: &Place, [x_axis, y_axis]: [bool; 2]) {
    let Place {
        left,
        right,
        top,
        bottom,
    } = *place;
    if x_axis {
        for (value, label) in &panel.x.major {
            let [x, _] = place.at(panel, [*value, 0.0]);
            canvas.text(label, [x, bottom + 2.2], TICK_PT, Anchor::Middle, BLACK);
        }
        let size = fitting_size(&panel.x.label, LABEL_PT, right - left + 4.0);
        let middle = [0.5 * (left + right), bottom + 6.0];
        canvas.text(&panel.x.label, middle, size, Anchor::Middle, BLACK);
    }
    if y_axis {
        for (value, label) in &panel.y.major {
            let [_, y] = place.at(panel, [0.0, *value]);
            canvas.text(label, [left - 1.0, y], TICK_PT, Anchor::End, BLACK);
        }
        let x = left - room_for_labels(&panel.y) + MARGIN_MM + 1.5;
        // A long label may stand a little above and below its panel.
        let size = fitting_size(&panel.y.label, LABEL_PT, bottom - top + 5.0).max(SMALL_PT - 1.0);
        canvas.text(
            &panel.y.label,
            [x, 0.5 * (top + bottom)],
            size,
            Anchor::Upwards,
            BLACK,
        );
    }
}
