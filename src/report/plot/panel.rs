//! One coordinate system: frame, grid, levels, power laws, series.

use super::axis::range;
use super::canvas::{Anchor, Canvas, SMALL_PT, text_width};
use super::figure::{Draw, Guide, Panel, Series};
use super::style::{BLACK, GREY, LIGHT, Style, WHITE, draw_marker};
use crate::report::number::significant;

const FRAME_MM: f64 = 0.2;
const TICK_MM: f64 = 1.2;
/// Least distance of two markers of one curve.
const MARKER_GAP_MM: f64 = 2.4;
/// Height of a bar.
const BAR_MM: f64 = 3.2;
/// Pieces of a path shorter than this get no arrowhead.
const ARROW_MM: f64 = 5.0;

/// Where a panel is drawn [mm].
pub struct Place {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Place {
    /// Place of a point of a panel.
    pub fn at(&self, panel: &Panel, [x, y]: [f64; 2]) -> [f64; 2] {
        let up = panel.y.place(y);
        // Names are read from the top.
        let up = if panel.y.is_named() { 1.0 - up } else { up };
        [
            self.left + panel.x.place(x) * (self.right - self.left),
            self.bottom - up * (self.bottom - self.top),
        ]
    }
}

/// A power law below the curves of a panel: y = factor · x^slope.
pub struct Law {
    /// Ends of the dotted line; empty without a label.
    line: Vec<[f64; 2]>,
    /// Corners of the triangle: start, end, right angle.
    triangle: [[f64; 2]; 3],
    /// Numbers at the horizontal and the upright leg.
    legs: [f64; 2],
}

impl Law {
    /// Power laws below all points of a panel, each further one below those before; `extents`: of all panels.
    pub fn below(panel: &Panel, [across, upwards]: [(f64, f64); 2]) -> Vec<Self> {
        let Some((first, last)) = range(panel.points().map(|p| p[0])).filter(|(a, b)| b > a) else {
            return Vec::new();
        };
        let apart = (upwards.1 / upwards.0).powf(0.05).max(1.15);
        let width = across.1 / across.0;
        let law = |(index, guide): (usize, &Guide)| {
            let slope = guide.rise / guide.run;
            // In logarithmic coordinates what lies below all points lies below all segments.
            let factor = panel.points().map(|p| p[1] / p[0].powf(slope));
            let factor = factor.fold(f64::INFINITY, f64::min) / apart.powi(1 + index as i32);
            let y = |x: f64| factor * x.powf(slope);
            // At the high end: the number of the upright leg stands away from the curves.
            let x = if slope < 0.0 {
                [first * width.powf(0.1), first * width.powf(0.32)]
            } else {
                [last / width.powf(0.32), last / width.powf(0.1)]
            };
            // The triangle stands clear of the line; the right angle is under its higher end.
            let [start, end] = x.map(|x| [x, y(x) / apart.powf(0.7)]);
            let corner = if slope > 0.0 {
                [end[0], start[1]]
            } else {
                [start[0], end[1]]
            };
            // A line steeper than all curves would leave the panel; it spans its triangle in any case.
            let floor = (upwards.0 / apart).min(y(x[0])).min(y(x[1]));
            let inside = |x: f64| x * (floor / y(x)).max(1.0).powf(1.0 / slope);
            let line = [first, last].map(|x| [inside(x), y(inside(x))]);
            Self {
                line: if guide.label.is_empty() {
                    Vec::new()
                } else {
                    line.to_vec()
                },
                triangle: [start, end, corner],
                legs: [guide.run, guide.rise.abs()],
            }
        };
        panel.guides.iter().enumerate().map(law).collect()
    }

    /// y that leaves room for the number below the triangle.
    pub fn lowest(&self) -> f64 {
        self.triangle
            .iter()
            .chain(&self.line)
            .map(|p| p[1])
            .fold(f64::INFINITY, f64::min)
            / 1.5
    }

    fn draw(&self, canvas: &mut Canvas, at: impl Fn([f64; 2]) -> [f64; 2]) {
        let Style {
            colour,
            width,
            dashes,
            ..
        } = Style::limit();
        let line: Vec<[f64; 2]> = self.line.iter().map(|p| at(*p)).collect();
        canvas.dashed(&line, colour, width, dashes);
        let [start, end, corner] = self.triangle.map(at);
        canvas.line(&[start, end, corner, start], BLACK, 0.2);
        let [run, rise] = self.legs.map(|leg| significant(leg, 3));
        let below = [0.5 * (start[0] + end[0]), start[1].max(end[1]) + 1.7];
        canvas.text(&run, below, SMALL_PT, Anchor::Middle, BLACK);
        let falling = corner[0] < end[0];
        let (off, anchor) = if falling {
            (-0.8, Anchor::End)
        } else {
            (0.8, Anchor::Start)
        };
        let beside = [corner[0] + off, 0.5 * (start[1] + end[1])];
        canvas.text(&rise, beside, SMALL_PT, anchor, BLACK);
    }
}

/// Draws a panel without the labels of its axes: what stands behind first, markers last, so that no line runs over one.
pub fn draw_panel(canvas: &mut Canvas, panel: &Panel, laws: &[Law], place: &Place) {
    let at = |point: [f64; 2]| place.at(panel, point);
    draw_grid(canvas, panel, place);
    for level in &panel.levels {
        let Style {
            colour,
            width,
            dashes,
            ..
        } = Style::level();
        let y = at([0.0, *level])[1];
        canvas.dashed(&[[place.left, y], [place.right, y]], colour, width, dashes);
    }
    for law in laws {
        law.draw(canvas, at);
    }
    let (behind, before): (Vec<&Series>, _) = panel.series.iter().partition(|s| s.style.behind);
    let ordered: Vec<&Series> = behind.into_iter().chain(before).collect();
    for series in &ordered {
        draw_lines(canvas, panel, series, place);
    }
    for series in &ordered {
        draw_marks(canvas, panel, series, place);
    }
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]];
    let (x, y) = ([place.left, place.right], [place.top, place.bottom]);
    canvas.line(&corners.map(|[a, b]| [x[a], y[b]]), BLACK, FRAME_MM);
    for series in &ordered {
        draw_texts(canvas, panel, series, place);
    }
}

fn draw_grid(canvas: &mut Canvas, panel: &Panel, place: &Place) {
    let Place {
        left,
        right,
        top,
        bottom,
    } = *place;
    for (axis, upright) in [(&panel.x, true), (&panel.y, false)] {
        let minor = axis.minor.iter().map(|v| (*v, 0.5 * TICK_MM));
        for (value, tick) in axis.major.iter().map(|(v, _)| (*v, TICK_MM)).chain(minor) {
            let [x, y] = place.at(panel, [value; 2]);
            let (grid, short) = match upright {
                true => ([[x, top], [x, bottom]], [[x, bottom], [x, bottom - tick]]),
                false => ([[left, y], [right, y]], [[left, y], [left + tick, y]]),
            };
            if tick == TICK_MM {
                canvas.line(&grid, LIGHT, 0.1);
            }
            if !axis.is_named() {
                canvas.line(&short, BLACK, FRAME_MM);
            }
        }
    }
}

/// Points on paper, in pieces where one has no place.
fn pieces(panel: &Panel, series: &Series, place: &Place) -> Vec<Vec<[f64; 2]>> {
    let has = |p: &[f64; 2]| panel.x.has(p[0]) && panel.y.has(p[1]);
    let pieces = series.points.split(|p| !has(p));
    let on_paper = |piece: &[[f64; 2]]| piece.iter().map(|p| place.at(panel, *p)).collect();
    pieces
        .filter(|piece| !piece.is_empty())
        .map(on_paper)
        .collect()
}

fn draw_lines(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    let Style {
        colour,
        width,
        dashes,
        ..
    } = series.style;
    for (point, ends) in series.points.iter().zip(&series.intervals) {
        let [a, b] = ends.map(|x| place.at(panel, [x, point[1]]));
        if a.iter().chain(&b).any(|c| !c.is_finite()) {
            continue;
        }
        if series.draw == Draw::Bars {
            canvas.boxed(
                [a[0], a[1] - 0.5 * BAR_MM],
                [b[0], b[1] + 0.5 * BAR_MM],
                colour,
                0.15,
            );
        } else {
            canvas.line(&[a, b], colour, 0.2);
            for [x, y] in [a, b] {
                canvas.line(&[[x, y - 0.6], [x, y + 0.6]], colour, 0.2);
            }
        }
    }
    if width == 0.0 || series.draw == Draw::Bars {
        return;
    }
    for piece in pieces(panel, series, place) {
        let mut line = piece.clone();
        if series.draw == Draw::Stairs {
            // Up at the point, then along to the next; nothing is drawn along the lower edge.
            line = piece
                .windows(2)
                .flat_map(|p| [p[0], [p[1][0], p[0][1]]])
                .collect();
            let end = piece.last().map(|p| [*p, [place.right, p[1]]]);
            line.extend(end.into_iter().flatten());
            line.insert(0, [piece[0][0], place.bottom]);
        }
        canvas.dashed(&line, colour, width, dashes);
        for pair in piece.windows(2).filter(|_| series.draw == Draw::Path) {
            let d = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let length = d[0].hypot(d[1]);
            if length >= ARROW_MM {
                let at = |mm: f64| [0, 1].map(|c| pair[0][c] + (0.5 + mm / length) * d[c]);
                canvas.arrow(at(-1.1), at(1.1));
            }
        }
    }
}

fn draw_marks(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    let style = &series.style;
    let own = style.marker.map(|marker| (marker, style.filled));
    // On a band markers are black, or they would be lost on it.
    let colour = if style.behind { BLACK } else { style.colour };
    let mut last = None;
    for (index, point) in series.points.iter().enumerate() {
        let look = series.marks.get(index).copied().unwrap_or(own);
        let Some(look) = look.filter(|_| panel.x.has(point[0]) && panel.y.has(point[1])) else {
            continue;
        };
        let at = place.at(panel, *point);
        // Dense curves get few markers, but a change of marker is always shown.
        let crowded = last.is_some_and(|(before, [x, y]): (_, [f64; 2])| {
            before == look && (x - at[0]).hypot(y - at[1]) < MARKER_GAP_MM
        });
        if !crowded || !series.intervals.is_empty() {
            draw_marker(canvas, at, look, style.size, colour);
            last = Some((look, at));
        }
    }
}

/// Texts inside bars, beside the points of a path away from its middle, otherwise to the right of the points.
fn draw_texts(canvas: &mut Canvas, panel: &Panel, series: &Series, place: &Place) {
    let count = series.points.len().max(1) as f64;
    let points: Vec<[f64; 2]> = series.points.iter().map(|p| place.at(panel, *p)).collect();
    let middle = [0, 1].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / count);
    for (index, (text, at)) in series.texts.iter().zip(&points).enumerate() {
        if text.is_empty() {
            continue;
        }
        let half = 0.5 * text_width(text, SMALL_PT);
        match series.draw {
            Draw::Bars => {
                let ends = series.intervals.get(index).copied().unwrap_or_default();
                let [a, b] = ends.map(|x| place.at(panel, [x, 0.0])[0]);
                let dark = series
                    .style
                    .colour
                    .iter()
                    .map(|c| u32::from(*c))
                    .sum::<u32>()
                    < 380;
                if b - a > 2.0 * half + 0.6 {
                    let colour = if dark { WHITE } else { BLACK };
                    canvas.text(
                        text,
                        [0.5 * (a + b), at[1]],
                        SMALL_PT,
                        Anchor::Middle,
                        colour,
                    );
                }
            }
            Draw::Path => {
                let away = [at[0] - middle[0], at[1] - middle[1]];
                let length = away[0].hypot(away[1]).max(f64::MIN_POSITIVE);
                let off = [2.2 + half, 2.6];
                let [x, y] = [0, 1].map(|c| at[c] + off[c] * away[c] / length);
                let x = x.clamp(place.left + half + 1.6, place.right - half - 1.6);
                let y = y.clamp(place.top + 2.7, place.bottom - 2.7);
                canvas.boxed([x - half, y - 1.1], [x + half, y + 1.1], WHITE, 0.0);
                canvas.text(text, [x, y], SMALL_PT, Anchor::Middle, BLACK);
            }
            _ => canvas.text(text, [at[0] + 1.4, at[1]], SMALL_PT, Anchor::Start, GREY),
        }
    }
}
