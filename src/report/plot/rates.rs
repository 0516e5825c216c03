//! Success rates of the robustness study against friction: one column per dimension, one lane per method.

use super::axis::Axis;
use super::canvas::{
    Anchor, Canvas, LABEL_PT, SMALL_PT, TICK_PT, Width, caption_height, text_width, wrapped,
};
use super::colour::{BLACK, GREY, LIGHT};
use super::methods;
use super::style::{Style, draw_marker};
use crate::report::ReportError;
use crate::report::number::{fixed, value};
use crate::studies::stress::robustness::RobustnessRow;

/// Heights of a lane and of its part that holds the scale [mm].
const LANE_MM: f64 = 7.0;
const SCALE_MM: f64 = 5.0;
/// Levels drawn in every lane [%].
const LEVELS: [f64; 3] = [0.0, 90.0, 100.0];
/// Room for a printed rate behind the last friction coefficient [mm].
const ROOM_MM: f64 = 4.0;
const MARGIN_MM: f64 = 1.5;
const FRAME_MM: f64 = 0.2;

/// Success rate of every method at every friction coefficient, with its confidence interval. Methods have a lane each:
/// most rates are equal. The friction coefficients stand at equal distances, the scale is stretched towards 100 %, and
/// lower rates are printed.
///
/// # Errors
/// [`ReportError::Figure`] without any rate.
pub fn success_rates(rows: &[RobustnessRow]) -> Result<String, ReportError> {
    let mut friction: Vec<f64> = rows.iter().map(|row| row.friction).collect();
    friction.sort_by(f64::total_cmp);
    friction.dedup();
    let mut names: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    names.sort_by_key(|name| (methods::rank(name), *name));
    names.dedup();
    let mut dims: Vec<usize> = rows.iter().map(|row| row.dimension).collect();
    dims.sort_unstable();
    dims.dedup();
    if !rows.iter().any(rated) {
        return Err(ReportError::figure("success rates", "no problem was tried"));
    }

    let most = rows.iter().map(|row| row.problems).max().unwrap_or(0);
    let caption = format!(
        "{most} random problems per point, bars: 95 % confidence, rates below 100 % are printed, –: all problems declined"
    );
    let width = Width::Page.mm();
    let caption = wrapped(&caption, SMALL_PT, width - 2.0 * MARGIN_MM);
    let widths = names.iter().map(|name| text_width(name, TICK_PT));
    let left = MARGIN_MM + widths.fold(0.0, f64::max) + 12.0;
    let top = caption_height(&caption) + 6.0;
    let bottom = top + LANE_MM * names.len() as f64;
    let mut canvas = Canvas::new(width, bottom + 9.0);
    canvas.caption(&caption);

    let styles = methods::styles(&names);
    for (lane, (name, style)) in names.iter().zip(&styles).enumerate() {
        let y = top + LANE_MM * (lane as f64 + 0.5);
        canvas.text(name, [MARGIN_MM, y], TICK_PT, Anchor::Start, BLACK);
        let at = [left - 6.0, y];
        let ends = [[at[0] - 2.8, y], [at[0] + 2.8, y]];
        canvas.dashed(&ends, style.colour, style.width, style.dashes);
        draw_own(&mut canvas, style, at);
    }
    let share = (width - MARGIN_MM - left) / dims.len() as f64;
    for (column, dim) in dims.iter().enumerate() {
        let own: Vec<&RobustnessRow> = rows.iter().filter(|r| r.dimension == *dim).collect();
        let start = left + share * column as f64;
        // Room for the labels of the levels on the right.
        let frame = Frame {
            x: [start, start + share - 7.0],
            y: [top, bottom],
        };
        draw_frame(&mut canvas, &frame, &friction, names.len(), *dim);
        for (lane, (name, style)) in names.iter().zip(&styles).enumerate() {
            let rows = own.iter().filter(|row| row.method == *name).copied();
            draw_lane(&mut canvas, &frame, &friction, lane, rows.collect(), style);
        }
    }
    canvas.finish("Success rate against friction coefficient")
}

fn rated(row: &RobustnessRow) -> bool {
    row.success[0].is_finite()
}

/// Where one dimension is drawn [mm].
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
}

impl Frame {
    /// Place of a friction coefficient.
    fn across(&self, friction: &[f64], mu: f64) -> f64 {
        let class = friction.partition_point(|other| *other < mu) as f64;
        // Room for a rate beside the last.
        let width = self.x[1] - self.x[0] - ROOM_MM;
        self.x[0] + (class + 0.5) / friction.len() as f64 * width
    }

    /// Place of a rate in a lane.
    fn up(&self, lane: usize, percent: f64) -> f64 {
        let axis = Axis::towards_hundred("");
        let [low, high] = [0.0, 100.0].map(|p| axis.place(p));
        let part = (axis.place(percent) - low) / (high - low);
        let bottom = self.y[0] + LANE_MM * (lane as f64 + 1.0) - 0.5 * (LANE_MM - SCALE_MM);
        bottom - part * SCALE_MM
    }
}

fn draw_frame(canvas: &mut Canvas, frame: &Frame, friction: &[f64], lanes: usize, dim: usize) {
    let Frame { x, y } = *frame;
    for lane in 0..lanes {
        for level in LEVELS {
            let at = frame.up(lane, level);
            canvas.line(&[[x[0], at], [x[1], at]], LIGHT, 0.1);
            // Labels of neighbouring lanes would touch: 0 has none.
            if level > 0.0 {
                let text = fixed(level, 0);
                canvas.text(&text, [x[1] + 0.8, at], SMALL_PT, Anchor::Start, GREY);
            }
        }
        if lane > 0 {
            let at = y[0] + LANE_MM * lane as f64;
            canvas.line(&[[x[0], at], [x[1], at]], GREY, 0.1);
        }
    }
    for mu in friction {
        let at = frame.across(friction, *mu);
        let label = value(*mu);
        canvas.line(&[[at, y[1]], [at, y[1] - 1.0]], BLACK, FRAME_MM);
        canvas.text(&label, [at, y[1] + 2.2], TICK_PT, Anchor::Middle, BLACK);
    }
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]].map(|[a, b]| [x[a], y[b]]);
    canvas.line(&corners, BLACK, FRAME_MM);
    let middle = 0.5 * (x[0] + x[1]);
    let heading = format!("solved, or own laws kept, in {dim}D [%]");
    canvas.text(
        &heading,
        [middle, y[0] - 3.0],
        LABEL_PT,
        Anchor::Middle,
        BLACK,
    );
    let label = "friction coefficient [-]";
    canvas.text(label, [middle, y[1] + 6.3], LABEL_PT, Anchor::Middle, BLACK);
}

fn draw_lane(
    canvas: &mut Canvas,
    frame: &Frame,
    friction: &[f64],
    lane: usize,
    mut rows: Vec<&RobustnessRow>,
    style: &Style,
) {
    rows.sort_by(|a, b| a.friction.total_cmp(&b.friction));
    let at = |row: &RobustnessRow, which: usize| {
        let x = frame.across(friction, row.friction);
        [x, frame.up(lane, 100.0 * row.success[which])]
    };
    for piece in rows.split(|row| !rated(row)) {
        let points: Vec<[f64; 2]> = piece.iter().map(|row| at(row, 0)).collect();
        canvas.dashed(&points, style.colour, style.width, style.dashes);
    }
    for (index, row) in rows.iter().enumerate() {
        if !rated(row) {
            let place = [frame.across(friction, row.friction), frame.up(lane, 90.0)];
            canvas.text("–", place, TICK_PT, Anchor::Middle, BLACK);
            continue;
        }
        canvas.line(&[at(row, 1), at(row, 2)], style.colour, FRAME_MM);
        draw_own(canvas, style, at(row, 0));
        if row.success[0] < 1.0 {
            // On the side of the next piece of the curve that is free; behind the last point where the lane has room.
            let next = rows.get(index + 1).map(|next| next.success[0]);
            let above = next.map_or(row.success[0] <= 0.8, |next| next < row.success[0]);
            let [x, y] = at(row, 0);
            let place = [x + 1.2, y + if above { -1.3 } else { 1.3 }];
            // 99.96 % is not 100.
            let percent = (1e3 * row.success[0]).floor() / 10.0;
            let text = fixed(percent, usize::from(percent.fract() != 0.0));
            canvas.text(&text, place, SMALL_PT, Anchor::Start, BLACK);
        }
    }
}

fn draw_own(canvas: &mut Canvas, style: &Style, at: [f64; 2]) {
    if let Some(marker) = style.marker {
        draw_marker(canvas, at, marker, style.filled, style.colour);
    }
}
