//! Contents of a figure before it is drawn: series of points, power laws to compare with, and the axes they share.

use super::axis::Axis;
use super::style::{Marker, Style};

/// Height of a row of a named axis [mm].
const ROW_MM: f64 = 4.4;

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
    /// Of line and markers.
    pub style: Style,
    /// The line that joins the points.
    pub draw: Draw,
    /// x and y; what has no place on the axes is left out.
    pub points: Vec<[f64; 2]>,
    /// Ends in x of the interval about every point; empty without intervals.
    pub intervals: Vec<[f64; 2]>,
    /// Marker and filling per point, or none; empty where all are the style's.
    pub marks: Vec<Option<(Marker, bool)>>,
    /// Texts in bars or behind points and their intervals; empty without.
    pub texts: Vec<String>,
}

impl Series {
    /// Points joined in their order, with the markers of the style.
    pub fn new(label: impl Into<String>, style: Style, points: Vec<[f64; 2]>) -> Self {
        Self {
            label: label.into(),
            style,
            draw: Draw::Line,
            points,
            intervals: Vec::new(),
            marks: Vec::new(),
            texts: Vec::new(),
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

impl Guide {
    /// A power law y ~ x^(rise/run).
    pub fn new(rise: f64, run: f64, label: &str) -> Self {
        let label = label.to_owned();
        Self { rise, run, label }
    }
}

/// One coordinate system.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Above the panel; may be empty.
    pub heading: String,
    /// x and y.
    pub axes: [Axis; 2],
    /// Of the frame [mm]; named y axes take what their names need.
    pub height: f64,
    /// Curves, the last on top.
    pub series: Vec<Series>,
    /// Horizontal lines.
    pub levels: Vec<f64>,
    /// Both axes logarithmic.
    pub guides: Vec<Guide>,
}

impl Panel {
    /// A panel of these axes and this height [mm].
    pub fn new(x: Axis, y: Axis, height: f64) -> Self {
        Self {
            heading: String::new(),
            height: y.named().map_or(height, |names| ROW_MM * names as f64),
            axes: [x, y],
            series: Vec::new(),
            levels: Vec::new(),
            guides: Vec::new(),
        }
    }

    pub(super) fn has(&self, point: &[f64; 2]) -> bool {
        (0..2).all(|c| self.axes[c].has(point[c]))
    }

    /// Points with a place.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        let all = self.series.iter().flat_map(|s| s.points.iter().copied());
        all.filter(|p| self.has(p))
    }
}
