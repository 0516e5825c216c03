//! Legends: samples and labels in rows below a chart.

use super::canvas::{Anchor, Canvas, fitted, text_width};
use super::chart::TICK_PT;
use super::colour::BLACK;
use super::style::{Style, draw_marker};

/// Distance of rows [mm].
pub const ROW_MM: f64 = 3.7;
/// Room for the sample before a label [mm].
const SAMPLE_MM: f64 = 8.5;

/// A line of the legend.
#[derive(Debug, Clone)]
pub struct Entry {
    pub label: String,
    pub style: Style,
    /// A sample of the line, or the marker alone.
    pub line: bool,
}

/// Legend entries in rows, columns as wide as they need to be.
pub struct LegendGrid<'a> {
    entries: &'a [Entry],
    columns: usize,
    /// Where each column starts [mm].
    starts: Vec<f64>,
    available: f64,
}

impl<'a> LegendGrid<'a> {
    pub fn new(entries: &'a [Entry], available: f64) -> Self {
        let width = |entry: &Entry| SAMPLE_MM + text_width(&entry.label, TICK_PT) + 2.0;
        let widths = |columns: usize| -> Vec<f64> {
            let column = |c: usize| entries.iter().skip(c).step_by(columns);
            (0..columns)
                .map(|c| column(c).map(width).fold(0.0, f64::max))
                .collect()
        };
        // As few rows as fit, then no more columns than these rows need; one column in any case, its labels are cut.
        let fitting = (2..=entries.len())
            .rev()
            .find(|columns| widths(*columns).iter().sum::<f64>() <= available)
            .unwrap_or(1);
        let rows = entries.len().div_ceil(fitting).max(1);
        let columns = entries.len().div_ceil(rows).max(1);
        let widths = widths(columns);
        // A single column starts at the left, several are spread over the width.
        let spare = (available - widths.iter().sum::<f64>()).max(0.0) / columns as f64;
        let mut end = 0.0;
        let starts = widths.iter().map(|width| {
            let start = end;
            end += width + spare.min(12.0);
            start
        });
        Self {
            entries,
            columns,
            starts: starts.collect(),
            available,
        }
    }

    /// How many rows it has.
    pub fn rows(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    /// Draws it with the middle of its first row at `origin` [mm].
    pub fn draw(&self, canvas: &mut Canvas, origin: [f64; 2]) {
        for (index, entry) in self.entries.iter().enumerate() {
            let start = self.starts[index % self.columns];
            let x = origin[0] + start;
            let y = origin[1] + (index / self.columns) as f64 * ROW_MM;
            let style = &entry.style;
            let (from, to) = (x + 0.5, x + SAMPLE_MM - 1.5);
            if entry.line {
                canvas.dashed(
                    &[[from, y], [to, y]],
                    style.colour,
                    style.width,
                    style.dashes,
                );
            }
            if let Some(marker) = style.marker {
                let middle = [0.5 * (from + to), y];
                draw_marker(canvas, middle, marker, style.filled, style.colour);
            }
            let room = self.available - start - SAMPLE_MM;
            let label = fitted(&entry.label, TICK_PT, room);
            canvas.text(&label, [x + SAMPLE_MM, y], TICK_PT, Anchor::Start, BLACK);
        }
    }
}
