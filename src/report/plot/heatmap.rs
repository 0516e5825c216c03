//! The one heat map: a number and a text per row and column, tinted on a logarithmic or linear scale.

use super::canvas::*;
use super::colour::{BLACK, LIGHT, Rgb, WHITE};
use super::style::between;
use crate::report::ReportError;

/// The darkest tint: on paper it still lets black text be read.
const FULL: Rgb = [230, 130, 60];

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// 0 for white to 1 for the full tint; not finite for grey.
    pub tint: f64,
    /// Large first line.
    pub text: String,
    /// Small second line; may be empty.
    pub below: String,
}

/// A table of tinted cells, 170 mm wide.
#[derive(Debug, Clone)]
pub struct HeatMap {
    /// The finding as a sentence, where the data say one.
    pub title: String,
    /// Meaning of tints and signs.
    pub caption: String,
    /// Headings above groups of columns, and how many columns each has.
    pub groups: Vec<(String, usize)>,
    /// Above the columns; long names are turned upwards.
    pub columns: Vec<String>,
    /// Names of the rows with their cells, one per column.
    pub rows: Vec<(String, Vec<Cell>)>,
}

impl HeatMap {
    /// The SVG text; none without a row.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        if self.rows.is_empty() || self.columns.is_empty() {
            return Ok(None);
        }
        let widths = |texts: Vec<&String>| -> f64 {
            let widths = texts.iter().map(|text| text_width(text, TICK_PT));
            widths.fold(0.0, f64::max)
        };
        let left = MARGIN_MM + widths(self.rows.iter().map(|row| &row.0).collect()) + 1.5;
        let width = (PAGE - MARGIN_MM - left) / self.columns.len() as f64;
        let longest = widths(self.columns.iter().collect());
        let upwards = longest > width - 0.5;
        let mut cells = self.rows.iter().flat_map(|(_, cells)| cells);
        let row = if cells.any(|cell| !cell.below.is_empty()) {
            6.4
        } else {
            4.4
        };
        let head = Head::new(&self.title, &self.caption, PAGE);
        let above = if self.groups.is_empty() { 0.0 } else { 4.0 };
        let top = head.height() + above + if upwards { longest + 1.5 } else { 4.0 };
        let bottom = top + row * self.rows.len() as f64;
        let mut canvas = Canvas::new(PAGE, bottom + 1.0);
        head.draw(&mut canvas);
        for (column, name) in self.columns.iter().enumerate() {
            let x = left + width * (column as f64 + 0.5);
            let (up, anchor) = if upwards {
                (0.5 * text_width(name, TICK_PT) + 1.0, Anchor::Upwards)
            } else {
                (2.0, Anchor::Middle)
            };
            canvas.text(name, [x, top - up], TICK_PT, anchor, BLACK);
        }
        for (index, (name, cells)) in self.rows.iter().enumerate() {
            let y = top + row * index as f64;
            let at = [left - 1.0, y + 0.5 * row];
            canvas.text(name, at, TICK_PT, Anchor::End, BLACK);
            for (column, cell) in cells.iter().enumerate() {
                let x = left + width * column as f64;
                let tint = if cell.tint.is_finite() {
                    between(WHITE, FULL, cell.tint.clamp(0.0, 1.0))
                } else {
                    LIGHT
                };
                canvas.boxed([x, y], [x + width, y + row], tint, 0.05);
                let parts = if cell.below.is_empty() {
                    [0.5, 0.5]
                } else {
                    [0.3, 0.72]
                };
                for (text, part) in [&cell.text, &cell.below].into_iter().zip(parts) {
                    let at = [x + 0.5 * width, y + part * row];
                    let size = fitting_size(text, SMALL_PT, width - 0.2);
                    canvas.text(text, at, size, Anchor::Middle, BLACK);
                }
            }
        }
        let mut x = left;
        for (name, count) in &self.groups {
            let end = x + width * *count as f64;
            let at = [0.5 * (x + end), head.height() + 2.0];
            canvas.text(name, at, LABEL_PT, Anchor::Middle, BLACK);
            canvas.line(&[[x, top], [x, bottom]], BLACK, 0.3);
            x = end;
        }
        canvas.finish(&self.title).map(Some)
    }
}
