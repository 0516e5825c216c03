//! What the methods cost: iterations and solve time on every case, one lane per case.

use super::axis::{Axis, range};
use super::canvas::{
    Anchor, Canvas, LABEL_PT, SMALL_PT, TICK_PT, Width, caption_height, plain, text_width, wrapped,
};
use super::colour::{BLACK, LIGHT};
use super::legend::{self, Entry, LegendGrid};
use super::methods;
use super::style::draw_marker;
use crate::report::ReportError;
use crate::studies::paper::comparison::ComparisonRow;

const LANE_MM: f64 = 8.8;
/// Heights in a lane over which methods in the order of the registry are spread in turn: equal costs stay apart [mm].
const TURNS_MM: [f64; 8] = [-3.5, 0.5, -1.5, 2.5, -2.5, 1.5, -0.5, 3.5];
const MARGIN_MM: f64 = 1.5;
const FRAME_MM: f64 = 0.2;

/// A quantity with its axis.
struct Column {
    axis: Axis,
    of: fn(&ComparisonRow) -> f64,
}

/// Iterations and solve time by case and method, all meshes, friction coefficients and increments together. A method
/// that did not do what it claims has no place on a case, one that solved an approximation no time.
///
/// # Errors
/// [`ReportError::Figure`] without any run that did what it claims.
pub fn method_cost(rows: &[ComparisonRow]) -> Result<String, ReportError> {
    let rows: Vec<&ComparisonRow> = rows.iter().filter(|row| row.verdict.is_honest()).collect();
    let mut cases: Vec<&str> = rows.iter().map(|row| row.case.as_str()).collect();
    cases.sort_unstable();
    cases.dedup();
    let mut names: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    names.sort_by_key(|name| (methods::rank(name), *name));
    names.dedup();
    let Some((_, most)) = range(rows.iter().map(|row| row.iterations as f64)) else {
        return Err(ReportError::figure("cost", "no run did what it claims"));
    };
    let times = rows.iter().map(|row| row.solve_s);
    let times = Axis::log("solve time [s]", times).map(|axis| Column {
        axis,
        of: |row| row.solve_s,
    });
    let iterations = Column {
        axis: Axis::many_counts("iterations [-]", most as usize),
        of: |row| row.iterations as f64,
    };
    let columns: Vec<Column> = std::iter::once(iterations).chain(times).collect();

    let styles = methods::styles(&names);
    let legend: Vec<Entry> = names
        .iter()
        .zip(&styles)
        .map(|(name, style)| Entry {
            label: plain(name),
            style: style.clone(),
            line: false,
        })
        .collect();
    let width = Width::Page.mm();
    let grid = LegendGrid::new(&legend, width - 2.0 * MARGIN_MM);
    let caption = "all meshes, friction coefficients and increments of a case together, times of solved runs only";
    let caption = wrapped(caption, SMALL_PT, width - 2.0 * MARGIN_MM);
    let widths = cases.iter().map(|case| text_width(&plain(case), TICK_PT));
    let left = MARGIN_MM + widths.fold(0.0, f64::max) + 4.0;
    let top = caption_height(&caption) + 1.0;
    let bottom = top + LANE_MM * cases.len() as f64;
    let legend_top = bottom + 11.0;
    let height = legend_top + legend::ROW_MM * grid.rows() as f64 + 0.5;
    let mut canvas = Canvas::new(width, height);
    canvas.caption(&caption);
    let middle = |lane: usize| top + LANE_MM * (lane as f64 + 0.5);
    for (lane, case) in cases.iter().enumerate() {
        let at = [MARGIN_MM, middle(lane)];
        canvas.text(&plain(case), at, TICK_PT, Anchor::Start, BLACK);
    }
    let share = (width - MARGIN_MM - left) / columns.len() as f64;
    for (column, Column { axis, of }) in columns.iter().enumerate() {
        let start = left + share * column as f64;
        let x = [start, start + share - 4.0];
        draw_frame(&mut canvas, axis, x, [top, bottom], cases.len());
        for row in &rows {
            let lane = cases.partition_point(|case| *case < row.case.as_str());
            let method = names.iter().position(|name| *name == row.method);
            let place = x[0] + axis.place(of(row)) * (x[1] - x[0]);
            let Some(method) = method.filter(|_| place.is_finite()) else {
                continue;
            };
            let style = &styles[method];
            let at = [place, middle(lane) + TURNS_MM[method % TURNS_MM.len()]];
            if let Some(marker) = style.marker {
                draw_marker(&mut canvas, at, marker, style.filled, style.colour);
            }
        }
    }
    grid.draw(&mut canvas, [MARGIN_MM, legend_top]);
    canvas.finish("Iterations and solve time by case and method")
}

fn draw_frame(canvas: &mut Canvas, axis: &Axis, x: [f64; 2], y: [f64; 2], lanes: usize) {
    let across = |value: f64| x[0] + axis.place(value) * (x[1] - x[0]);
    for (value, label) in &axis.major {
        let at = across(*value);
        canvas.line(&[[at, y[0]], [at, y[1]]], LIGHT, 0.1);
        canvas.line(&[[at, y[1]], [at, y[1] - 1.2]], BLACK, FRAME_MM);
        canvas.text(label, [at, y[1] + 2.2], TICK_PT, Anchor::Middle, BLACK);
    }
    for value in &axis.minor {
        let at = across(*value);
        canvas.line(&[[at, y[1]], [at, y[1] - 0.6]], BLACK, FRAME_MM);
    }
    for lane in 1..lanes {
        let at = y[0] + LANE_MM * lane as f64;
        canvas.line(&[[x[0], at], [x[1], at]], LIGHT, 0.2);
    }
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]].map(|[a, b]| [x[a], y[b]]);
    canvas.line(&corners, BLACK, FRAME_MM);
    let below = [0.5 * (x[0] + x[1]), y[1] + 6.3];
    canvas.text(&axis.label, below, LABEL_PT, Anchor::Middle, BLACK);
}
