//! One coordinate system: frame, grid, levels, power laws, series.

use super::axis::range;
use super::canvas::{Anchor, Canvas, SMALL_PT, text_width};
use super::colour::{BLACK, GREY, LIGHT, Rgb, WHITE};
use super::series::{Draw, Panel, Series};
use super::style::{Style, draw_marker};
use crate::report::number::significant;

const FRAME_MM: f64 = 0.2;
const TICK_MM: f64 = 1.2;
/// Least distance of two markers of one curve.
const MARKER_GAP_MM: f64 = 2.4;
/// Half the height of a bar and of the ends of an interval.
const BAR_MM: f64 = 1.6;
const END_MM: f64 = 0.6;
/// Pieces of a path shorter than this get no arrowhead.
const ARROW_MM: f64 = 5.0;

/// Where a panel is drawn: left and right, top and bottom [mm].
pub struct Place {
    pub x: [f64; 2],
    pub y: [f64; 2],
}

impl Place {
    /// Place of a point of a panel.
    pub fn at(&self, panel: &Panel, point: [f64; 2]) -> [f64; 2] {
        let [x, up] = [0, 1].map(|c| panel.axes[c].place(point[c]));
        // Names are read from the top.
        let down = if panel.axes[1].named().is_some() {
            up
        } else {
            1.0 - up
        };
        let part = |[a, b]: [f64; 2], t: f64| a + t * (b - a);
        [part(self.x, x), part(self.y, down)]
    }

    fn draw_frame(&self, canvas: &mut Canvas) {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]];
        let corners = corners.map(|[a, b]| [self.x[a], self.y[b]]);
        canvas.line(&corners, BLACK, FRAME_MM);
    }
}

/// The triangle of a power law.
pub struct Triangle {
    /// Start, end, right angle.
    corners: [[f64; 2]; 3],
    /// Numbers at the horizontal and the upright leg.
    legs: [f64; 2],
}

impl Triangle {
    /// Power laws below all points of a panel, each further one below those before, and dotted lines for those with a label;
    /// `extents`: of all panels.
    pub fn below(panel: &Panel, extents: [(f64, f64); 2]) -> (Vec<Self>, Vec<Series>) {
        let [across, upwards] = extents;
        let (mut triangles, mut lines) = (Vec::new(), Vec::new());
        let Some((first, last)) = range(panel.points().map(|p| p[0])) else {
            return (triangles, lines);
        };
        let apart = (upwards.1 / upwards.0).powf(0.05).max(1.15);
        let width = across.1 / across.0;
        for (index, guide) in panel.guides.iter().enumerate().filter(|_| last > first) {
            let slope = guide.rise / guide.run;
            // In logarithmic coordinates what lies below all points lies below all segments.
            let factors = panel.points().map(|p| p[1] / p[0].powf(slope));
            let factor = factors.fold(f64::INFINITY, f64::min) / apart.powi(1 + index as i32);
            let y = |x: f64| factor * x.powf(slope);
            // At the high end: the number of the upright leg stands away from the curves.
            let x = if slope < 0.0 {
                [0.1, 0.32].map(|part| first * width.powf(part))
            } else {
                [0.32, 0.1].map(|part| last / width.powf(part))
            };
            // The triangle stands clear of the line; the right angle is under its higher end.
            let [start, end] = x.map(|x| [x, y(x) / apart.powf(0.7)]);
            let corner = if slope > 0.0 {
                [end[0], start[1]]
            } else {
                [start[0], end[1]]
            };
            let (corners, legs) = ([start, end, corner], [guide.run, guide.rise.abs()]);
            triangles.push(Self { corners, legs });
            if !guide.label.is_empty() {
                // A line steeper than all curves would leave the panel; it spans its triangle in any case.
                let floor = (upwards.0 / apart).min(y(x[0])).min(y(x[1]));
                let inside = |x: f64| x * (floor / y(x)).max(1.0).powf(1.0 / slope);
                let ends = [first, last].map(|x| [inside(x), y(inside(x))]);
                lines.push(Series::new(&guide.label, Style::limit(), ends.into()));
            }
        }
        (triangles, lines)
    }

    /// y that leaves room for the number below.
    pub fn lowest(&self) -> f64 {
        let heights = self.corners.iter().map(|p| p[1]);
        heights.fold(f64::INFINITY, f64::min) / 1.5
    }

    fn draw(&self, canvas: &mut Canvas, at: impl Fn([f64; 2]) -> [f64; 2]) {
        let [start, end, corner] = self.corners.map(at);
        canvas.line(&[start, end, corner, start], BLACK, 0.2);
        let [run, rise] = self.legs.map(|leg| significant(leg, 3));
        let [x, y] = [0, 1].map(|c| 0.5 * (start[c] + end[c]));
        let below = [x, start[1].max(end[1]) + 1.7];
        canvas.text(&run, below, SMALL_PT, Anchor::Middle, BLACK);
        let (off, anchor) = if corner[0] < end[0] {
            (-0.8, Anchor::End)
        } else {
            (0.8, Anchor::Start)
        };
        canvas.text(&rise, [corner[0] + off, y], SMALL_PT, anchor, BLACK);
    }
}

/// Draws a panel without the labels of its axes: what stands behind first, markers last, so that no line runs over one.
pub fn draw_panel(canvas: &mut Canvas, panel: &Panel, triangles: &[Triangle], place: &Place) {
    let at = |point: [f64; 2]| place.at(panel, point);
    draw_grid(canvas, panel, place);
    for level in &panel.levels {
        let line = place.x.map(|x| [x, at([0.0, *level])[1]]);
        canvas.dashed(&line, GREY, 0.2, &[1.5, 1.0]);
    }
    triangles
        .iter()
        .for_each(|triangle| triangle.draw(canvas, at));
    let (behind, before): (Vec<&Series>, _) = panel.series.iter().partition(|s| s.style.behind);
    let ordered: Vec<&Series> = behind.into_iter().chain(before).collect();
    for series in &ordered {
        draw_intervals(canvas, panel, series, place);
        draw_lines(canvas, panel, series, place);
    }
    for series in &ordered {
        draw_marks(canvas, panel, series, place);
    }
    place.draw_frame(canvas);
    for series in &ordered {
        draw_texts(canvas, panel, series, place);
    }
}

fn draw_grid(canvas: &mut Canvas, panel: &Panel, place: &Place) {
    for (c, axis) in panel.axes.iter().enumerate() {
        let minor = axis.minor.iter().map(|v| (*v, 0.5 * TICK_MM));
        let major = axis.major.iter().map(|(v, _)| (*v, TICK_MM));
        for (value, tick) in major.chain(minor) {
            let [x, y] = place.at(panel, [value; 2]);
            let (grid, short) = match c {
                0 => (
                    place.y.map(|y| [x, y]),
                    [0.0, tick].map(|t| [x, place.y[1] - t]),
                ),
                _ => (
                    place.x.map(|x| [x, y]),
                    [0.0, tick].map(|t| [place.x[0] + t, y]),
                ),
            };
            if tick == TICK_MM {
                canvas.line(&grid, LIGHT, 0.1);
            }
            if axis.named().is_none() {
                canvas.line(&short, BLACK, FRAME_MM);
            }
        }
    }
}

/// Points on paper, in pieces where one has no place.
fn pieces(panel: &Panel, series: &Series, place: &Place) -> Vec<Vec<[f64; 2]>> {
    let pieces = series.points.split(|p| !panel.has(p));
    let on_paper = |p: &[f64; 2]| place.at(panel, *p);
    let pieces = pieces.map(|piece| piece.iter().map(on_paper).collect());
    pieces.filter(|piece: &Vec<_>| !piece.is_empty()).collect()
}

fn draw_intervals(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    let colour = series.style.colour;
    for (point, ends) in series.points.iter().zip(&series.intervals) {
        let [a, b] = ends.map(|x| place.at(panel, [x, point[1]]));
        if series.draw == Draw::Bars {
            let corner = [b[0], b[1] + BAR_MM];
            canvas.boxed([a[0], a[1] - BAR_MM], corner, colour, 0.15);
            continue;
        }
        let inside = [a, b].map(|[x, y]| [x.clamp(place.x[0], place.x[1]), y]);
        canvas.line(&inside, colour, 0.2);
        for [x, y] in [a, b].into_iter().filter(|p| inside.contains(p)) {
            canvas.line(&[[x, y - END_MM], [x, y + END_MM]], colour, 0.2);
        }
    }
}

fn draw_lines(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    let style = &series.style;
    for mut line in pieces(panel, series, place) {
        if let ([alone], None, true) = (&line[..], style.marker, style.width > 0.0) {
            canvas.disc(*alone, 0.4, style.colour);
        }
        if series.draw == Draw::Stairs {
            // Up at the point, then along to the next; nothing is drawn along the lower edge.
            let first = [line[0][0], place.y[1]];
            line.extend(line.last().map(|p| [place.x[1], p[1]]));
            let steps = line.windows(2).flat_map(|p| [p[0], [p[1][0], p[0][1]]]);
            line = std::iter::once(first).chain(steps).collect();
        }
        if style.width > 0.0 && series.draw != Draw::Bars {
            canvas.dashed(&line, style.colour, style.width, style.dashes);
        }
    }
}

fn draw_marks(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    let style = &series.style;
    if series.draw == Draw::Path {
        for pair in pieces(panel, series, place)
            .iter()
            .flat_map(|piece| piece.windows(2))
        {
            let d = [0, 1].map(|c| pair[1][c] - pair[0][c]);
            let length = d[0].hypot(d[1]);
            let at = |mm: f64| [0, 1].map(|c| pair[0][c] + (0.5 + mm / length) * d[c]);
            if length >= ARROW_MM {
                canvas.arrow(at(-1.1), at(1.1));
            }
        }
    }
    let own = style.marker.map(|marker| (marker, style.filled));
    // On a band markers are black, or they would be lost on it.
    let colour = if style.behind { BLACK } else { style.colour };
    let mut last = None;
    for (index, point) in series.points.iter().enumerate() {
        let look = series.marks.get(index).copied().unwrap_or(own);
        let Some(look) = look.filter(|_| panel.has(point)) else {
            continue;
        };
        let at = place.at(panel, *point);
        // Dense curves get few markers, but a change of marker is always shown.
        let crowded = last.is_some_and(|(before, [x, y]): (_, [f64; 2])| {
            before == look && (x - at[0]).hypot(y - at[1]) < MARKER_GAP_MM
        });
        if !crowded {
            draw_marker(canvas, at, look, style.size, colour);
            last = Some((look, at));
        }
    }
}

/// Texts inside bars, where they fit, and behind points and their intervals.
fn draw_texts(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    for (index, (text, point)) in series.texts.iter().zip(&series.points).enumerate() {
        let ends = series.intervals.get(index).copied();
        let ends = ends.unwrap_or([point[0]; 2]);
        let [[a, y], [b, _]] = ends.map(|x| place.at(panel, [x, point[1]]));
        if series.draw != Draw::Bars {
            canvas.text(text, [b + 1.4, y], SMALL_PT, Anchor::Start, GREY);
        } else if b - a > text_width(text, SMALL_PT) + 0.6 {
            let at = [0.5 * (a + b), y];
            canvas.text(
                text,
                at,
                SMALL_PT,
                Anchor::Middle,
                readable(series.style.colour),
            );
        }
    }
}

/// Colour of text on this one.
fn readable(colour: Rgb) -> Rgb {
    let light = colour.iter().map(|c| u32::from(*c)).sum::<u32>();
    if light < 380 { WHITE } else { BLACK }
}
