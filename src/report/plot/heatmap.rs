//! The one heat map: a number and a text per row and column, tinted on a logarithmic or linear scale.

use super::canvas::{
    Anchor, Canvas, Head, LABEL_PT, MARGIN_MM, PAGE, SMALL_PT, TICK_PT, fitting_size, text_width,
};
use super::style::{BLACK, LIGHT, Rgb, WHITE, between};
use crate::report::ReportError;

/// The darkest tint: on paper it still lets black text be read.
const FULL: Rgb = [230, 130, 60];

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// 0 for white to 1 for the full tint; not finite for grey.
    pub tint: f64,
    pub text: String,
    /// Small second line; may be empty.
    pub below: String,
}

/// A table of tinted cells, 170 mm wide.
#[derive(Debug, Clone)]
pub struct HeatMap {
    /// What it shows, as a sentence where the data say one.
    pub title: String,
    /// What tints and signs mean.
    pub caption: String,
    /// What stands above groups of columns, and how many columns each has.
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
        let widest = |texts: &mut dyn Iterator<Item = &String>| {
            texts
                .map(|text| text_width(text, TICK_PT))
                .fold(0.0, f64::max)
        };
        let left = MARGIN_MM + widest(&mut self.rows.iter().map(|(name, _)| name)) + 1.5;
        let width = (PAGE - MARGIN_MM - left) / self.columns.len() as f64;
        let longest = widest(&mut self.columns.iter());
        let upwards = longest > width - 0.5;
        let two_lines = self
            .rows
            .iter()
            .flat_map(|(_, cells)| cells)
            .any(|c| !c.below.is_empty());
        let row = if two_lines { 6.4 } else { 4.4 };
        let head = Head::new(&self.title, &self.caption, PAGE);
        let groups = if self.groups.is_empty() { 0.0 } else { 4.0 };
        let top = head.height() + groups + if upwards { longest + 1.5 } else { 4.0 };
        let mut canvas = Canvas::new(PAGE, top + row * self.rows.len() as f64 + 1.0);
        head.draw(&mut canvas);
        let mut first = 0;
        for (name, count) in &self.groups {
            let x = left + width * (first as f64 + 0.5 * *count as f64);
            canvas.text(
                name,
                [x, head.height() + 2.0],
                LABEL_PT,
                Anchor::Middle,
                BLACK,
            );
            first += count;
        }
        for (column, name) in self.columns.iter().enumerate() {
            let x = left + width * (column as f64 + 0.5);
            let half = 0.5 * text_width(name, TICK_PT);
            let (y, anchor) = if upwards {
                (half + 1.0, Anchor::Upwards)
            } else {
                (2.0, Anchor::Middle)
            };
            canvas.text(name, [x, top - y], TICK_PT, anchor, BLACK);
        }
        for (index, (name, cells)) in self.rows.iter().enumerate() {
            let y = top + row * index as f64;
            canvas.text(
                name,
                [left - 1.0, y + 0.5 * row],
                TICK_PT,
                Anchor::End,
                BLACK,
            );
            for (column, cell) in cells.iter().enumerate() {
                let x = left + width * column as f64;
                let tint = match cell.tint.is_finite() {
                    true => between(WHITE, FULL, cell.tint.clamp(0.0, 1.0)),
                    false => LIGHT,
                };
                canvas.boxed([x, y], [x + width, y + row], tint, 0.05);
                let middle = x + 0.5 * width;
                let up = if cell.below.is_empty() { 0.5 } else { 0.32 };
                let size = fitting_size(&cell.text, SMALL_PT, width - 0.4);
                canvas.text(
                    &cell.text,
                    [middle, y + up * row],
                    size,
                    Anchor::Middle,
                    BLACK,
                );
                let size = fitting_size(&cell.below, SMALL_PT - 1.0, width - 0.4);
                if !cell.below.is_empty() {
                    canvas.text(
                        &cell.below,
                        [middle, y + 0.75 * row],
                        size,
                        Anchor::Middle,
                        BLACK,
                    );
                }
            }
        }
        first = 0;
        for (_, count) in &self.groups {
            let x = [first, first + count].map(|c| left + width * c as f64);
            let y = [top, top + row * self.rows.len() as f64];
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]].map(|[a, b]| [x[a], y[b]]);
            canvas.line(&corners, BLACK, 0.25);
            first += count;
        }
        canvas.finish(&self.title).map(Some)
    }
}
