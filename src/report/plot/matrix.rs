//! A square of numbers, row against column: the darker, the more.

use super::canvas::{
    Anchor, CAPTION_PT, Canvas, SMALL_PT, TICK_PT, Width, caption_height, plain, text_width,
    wrapped,
};
use super::colour::{BLACK, GREY, Rgb, WHITE};
use crate::report::ReportError;
use crate::report::number::fixed;

const MARGIN_MM: f64 = 1.5;
const ROW_MM: f64 = 4.6;
/// A cell with 1 [darkest], one with 0 is white.
const DARK: Rgb = [0, 68, 106];
/// From here on text is white.
const TURN: f64 = 0.55;

/// Fractions, row against column.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// For screen readers and file browsers.
    pub title: String,
    /// Small text above.
    pub caption: String,
    /// Names of the rows, which are those of the columns.
    pub names: Vec<String>,
    /// Fractions from 0 to 1 by row and column; none where there is nothing to compare.
    pub fractions: Vec<Vec<Option<f64>>>,
}

/// The figure, 170 mm wide, percentages in the cells.
///
/// # Errors
/// [`ReportError::Figure`] without names.
pub fn matrix(figure: &Matrix) -> Result<String, ReportError> {
    let names: Vec<String> = figure.names.iter().map(|name| plain(name)).collect();
    if names.is_empty() {
        return Err(ReportError::figure("matrix", "nothing to compare"));
    }
    let widths = || names.iter().map(|name| text_width(name, TICK_PT));
    let longest = widths().fold(0.0, f64::max);
    let width = Width::Page.mm();
    let caption = wrapped(&figure.caption, CAPTION_PT, width - 2.0 * MARGIN_MM);
    let left = MARGIN_MM + longest + 2.0;
    let top = caption_height(&caption) + longest + 3.0;
    let count = names.len() as f64;
    let cell = ((width - MARGIN_MM - left) / count).min(12.0);
    let mut canvas = Canvas::new(width, top + ROW_MM * count + MARGIN_MM);
    canvas.caption(&caption);
    for (index, name) in names.iter().enumerate() {
        let middle = index as f64 + 0.5;
        let at = [left - 1.5, top + ROW_MM * middle];
        canvas.text(name, at, TICK_PT, Anchor::End, BLACK);
        // Reads upwards and ends at the cells.
        let length = text_width(name, TICK_PT);
        let at = [left + cell * middle, top - 1.5 - 0.5 * length];
        canvas.text_upwards(name, at, TICK_PT, BLACK);
    }
    for (row, fractions) in figure.fractions.iter().enumerate() {
        for (column, fraction) in fractions.iter().enumerate() {
            let x = [column, column + 1].map(|c| left + cell * c as f64);
            let y = [row, row + 1].map(|r| top + ROW_MM * r as f64);
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| [x[a], y[b]]);
            let at = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
            match fraction {
                Some(fraction) => {
                    canvas.fill(&corners, shade(*fraction));
                    let ink = if *fraction > TURN { WHITE } else { BLACK };
                    let text = fixed(100.0 * fraction, 0);
                    canvas.text(&text, at, SMALL_PT, Anchor::Middle, ink);
                }
                None => canvas.text("–", at, SMALL_PT, Anchor::Middle, GREY),
            }
        }
    }
    let far = [left + cell * count, top + ROW_MM * count];
    for line in 0..=names.len() {
        let [x, y] = [left + cell * line as f64, top + ROW_MM * line as f64];
        canvas.line(&[[x, top], [x, far[1]]], GREY, 0.1);
        canvas.line(&[[left, y], [far[0], y]], GREY, 0.1);
    }
    canvas.finish(&figure.title)
}

fn shade(fraction: f64) -> Rgb {
    let mix = |c: usize| {
        let (white, dark) = (f64::from(WHITE[c]), f64::from(DARK[c]));
        (white + fraction.clamp(0.0, 1.0) * (dark - white)).round() as u8
    };
    std::array::from_fn(mix)
}
