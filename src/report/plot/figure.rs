//! The one frame of all figures made of lines, markers and bars: panels in a grid over shared axes, and a legend.
//!
//! A kind of figure says what is drawn; ranges, ticks, room for labels and the legend follow from it. Panels whose axes have
//! the same label share range and tick labels. Series with the same label share a line of the legend.

use super::axis::{Axis, range};
use super::canvas::*;
use super::colour::BLACK;
use super::legend::Legend;
use super::panel::{Place, Triangle, draw_panel};
use super::series::Panel;
use crate::report::ReportError;

/// Room for the tick labels and the label of an x axis, and below a panel without them [mm].
const AXIS_MM: f64 = 10.0;
const BELOW_MM: f64 = 2.0;
const GAP_MM: f64 = 5.0;
const HEADING_MM: f64 = 3.0;

/// Values that an axis must cover.
fn values(panel: &Panel, c: usize, triangles: &[Triangle]) -> Vec<f64> {
    let mut values: Vec<f64> = panel.points().map(|p| p[c]).collect();
    if c == 1 {
        values.extend(&panel.levels);
        values.extend(triangles.iter().map(Triangle::lowest));
    } else if panel.axes[1].named().is_some() {
        // Elsewhere intervals say how sure a point is; the points alone make the range.
        let intervals = panel.series.iter().flat_map(|s| &s.intervals);
        values.extend(intervals.flatten());
    }
    values
}

/// A whole figure. Labels may hold [`subscript`](super::subscript) and [`italic`](super::italic).
#[derive(Debug, Clone)]
pub struct Figure {
    /// The finding as a sentence, where the data say one.
    pub title: String,
    /// Further facts for the reader: case, mesh, what was left out.
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
    /// A figure with at most this many panels in a row.
    pub fn new(title: &str, caption: &str, columns: usize, panels: Vec<Panel>) -> Self {
        Self {
            title: title.to_owned(),
            caption: caption.to_owned(),
            columns: columns.clamp(1, panels.len().max(1)),
            wide: columns > 1,
            own_legends: false,
            panels,
        }
    }

    /// Whether two panels have the same axis.
    fn same(&self, a: usize, b: usize, c: usize) -> bool {
        self.panels[a].axes[c].label == self.panels[b].axes[c].label
    }

    /// Whether a panel has labels of its x and its y axis.
    fn labels(&self, i: usize) -> [bool; 2] {
        let below = i + self.columns;
        let x = below >= self.panels.len() || !self.same(i, below, 0);
        [x, i.is_multiple_of(self.columns) || !self.same(i, i - 1, 1)]
    }

    /// The SVG text; none where nothing has a place on the axes.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        let (width, columns) = (if self.wide { PAGE } else { COLUMN }, self.columns);
        let Some(fitted) = self.fitted(width / columns as f64) else {
            return Ok(None);
        };
        let panels: Vec<&Panel> = fitted.iter().map(|(panel, _)| panel).collect();
        // Widths: room for the labels of every column, the rest shared.
        let room = |i: usize| {
            if self.labels(i)[1] {
                room_for_labels(&panels[i].axes[1])
            } else {
                GAP_MM
            }
        };
        let most = |column: usize| (column..panels.len()).step_by(columns).map(room);
        let rooms: Vec<f64> = (0..columns).map(|c| most(c).fold(0.0, f64::max)).collect();
        let frame = (width - 3.0 - rooms.iter().sum::<f64>()) / columns as f64;
        // Heights: head, rows with headings, axes and own legends, common legend.
        let head = Head::new(&self.title, &self.caption, width);
        let heading = |p: &&Panel| wrapped(&p.heading, TICK_PT, frame);
        let headings: Vec<Vec<String>> = panels.iter().map(heading).collect();
        let legends: Vec<Legend> = if self.own_legends {
            panels.chunks(1).map(|own| Legend::of(own, frame)).collect()
        } else {
            vec![Legend::of(&panels, width - 2.0 * MARGIN_MM)]
        };
        let (mut tops, mut end) = (Vec::new(), head.height());
        for first in (0..panels.len()).step_by(columns) {
            let row = first..(first + columns).min(panels.len());
            let largest = |of: &dyn Fn(usize) -> f64| row.clone().map(of).fold(0.0, f64::max);
            end += 1.0 + largest(&|i| HEADING_MM * headings[i].len() as f64);
            tops.push(end);
            let axis = |i: usize| if self.labels(i)[0] { AXIS_MM } else { BELOW_MM };
            end += largest(&|i| panels[i].height) + largest(&axis);
            if self.own_legends {
                end += largest(&|i| legends[i].height);
            }
        }
        let common = legends.first().filter(|_| !self.own_legends);
        let bottom = end + common.map_or(0.0, |legend| legend.height);
        let mut canvas = Canvas::new(width, bottom + 0.5);
        head.draw(&mut canvas);
        for (index, (panel, triangles)) in fitted.iter().enumerate() {
            let column = index % columns;
            let left = rooms[..=column].iter().sum::<f64>() + frame * column as f64;
            let top = tops[index / columns];
            let (x, y) = ([left, left + frame], [top, top + panel.height]);
            let place = Place { x, y };
            draw_panel(&mut canvas, panel, triangles, &place);
            draw_labels(&mut canvas, panel, &place, self.labels(index));
            for (line, text) in headings[index].iter().rev().enumerate() {
                let at = [left + 0.5 * frame, top - 2.0 - HEADING_MM * line as f64];
                canvas.text(text, at, TICK_PT, Anchor::Middle, BLACK);
            }
            if self.own_legends {
                legends[index].draw(&mut canvas, [left, y[1] + AXIS_MM + 1.0]);
            }
        }
        if let Some(legend) = common {
            legend.draw(&mut canvas, [MARGIN_MM, end + 1.5]);
        }
        canvas.finish(&self.title).map(Some)
    }

    /// Panels with their ranges and power laws; none where no panel has a point.
    fn fitted(&self, width: f64) -> Option<Vec<(Panel, Vec<Triangle>)>> {
        let all = || self.panels.iter().flat_map(Panel::points);
        let extents = [range(all().map(|p| p[0]))?, range(all().map(|p| p[1]))?];
        let mut fitted = Vec::new();
        for panel in &self.panels {
            let (triangles, lines) = Triangle::below(panel, extents);
            let mut panel = panel.clone();
            panel.series.extend(lines);
            fitted.push((panel, triangles));
        }
        let fit = |(panel, _): &(Panel, _), c: usize| {
            let axis = &panel.axes[c];
            let alike = fitted.iter().filter(|(p, _)| p.axes[c].label == axis.label);
            let values: Vec<f64> = alike.flat_map(|(p, laws)| values(p, c, laws)).collect();
            let room = [width / 14.0, panel.height / 8.0][c];
            let count = (room as usize).clamp(2, 7);
            let found = axis.fitted(values, count);
            found.or_else(|| axis.fitted([1.0, 10.0], count))
        };
        let axes = fitted.iter().map(|own| Some([fit(own, 0)?, fit(own, 1)?]));
        let axes: Vec<[Axis; 2]> = axes.collect::<Option<_>>()?;
        for (own, axes) in fitted.iter_mut().zip(axes) {
            own.0.axes = axes;
        }
        Some(fitted)
    }
}

/// Room to the left of a frame for the labels of its y axis and the margin [mm].
pub fn room_for_labels(y: &Axis) -> f64 {
    let labels = y.major.iter().map(|(_, label)| text_width(label, TICK_PT));
    let name = if y.label.is_empty() { 1.0 } else { 5.5 };
    MARGIN_MM + name + labels.fold(0.0, f64::max)
}

/// Tick labels and labels of the axes, where they are wanted.
pub fn draw_labels(canvas: &mut Canvas, panel: &Panel, place: &Place, wanted: [bool; 2]) {
    let (left, bottom) = (place.x[0], place.y[1]);
    let [middle, half_up] = [place.x, place.y].map(|[a, b]| 0.5 * (a + b));
    let [x, y] = &panel.axes;
    if wanted[0] {
        for (value, label) in &x.major {
            let at = [place.at(panel, [*value, 0.0])[0], bottom + 2.2];
            canvas.text(label, at, TICK_PT, Anchor::Middle, BLACK);
        }
        let size = fitting_size(&x.label, LABEL_PT, place.x[1] - left + 4.0);
        canvas.text(
            &x.label,
            [middle, bottom + 6.0],
            size,
            Anchor::Middle,
            BLACK,
        );
    }
    if wanted[1] {
        for (value, label) in &y.major {
            let at = [left - 1.0, place.at(panel, [0.0, *value])[1]];
            canvas.text(label, at, TICK_PT, Anchor::End, BLACK);
        }
        let at = [left - room_for_labels(y) + MARGIN_MM + 1.5, half_up];
        // A long label may stand a little above and below its panel.
        let size = fitting_size(&y.label, LABEL_PT, bottom - place.y[0] + 5.0);
        canvas.text(&y.label, at, size, Anchor::Upwards, BLACK);
    }
}
