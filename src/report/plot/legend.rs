//! Legends: samples and labels in rows below a chart.

use super::canvas::{Anchor, Canvas, SMALL_PT, TICK_PT, fitted, text_width};
use super::colour::BLACK;
use super::style::{Style, draw_mark};

/// Distance of rows [mm].
pub const ROW_MM: f64 = 3.7;
/// Room for the sample before a label [mm].
const SAMPLE_MM: f64 = 8.5;
/// Least room between columns [mm].
const GAP_MM: f64 = 2.0;

/// A line of the legend.
#[derive(Debug, Clone)]
pub struct Entry {
    pub label: String,
    pub style: Style,
    /// A sample of the line, or the marker alone.
    pub line: bool,
}

/// Legend entries one below the other, columns as wide as they need to be.
pub struct LegendGrid<'a> {
    entries: &'a [Entry],
    rows: usize,
    /// Where each column starts [mm].
    starts: Vec<f64>,
    size_pt: f64,
    available: f64,
}

impl<'a> LegendGrid<'a> {
    /// Small text where that saves rows.
    pub fn new(entries: &'a [Entry], available: f64) -> Self {
        let [large, small] =
            [TICK_PT, SMALL_PT].map(|size| Self::of_size(entries, available, size));
        if small.rows < large.rows {
            small
        } else {
            large
        }
    }

    /// All entries in one column, whatever their length.
    pub fn column(entries: &'a [Entry], available: f64) -> Self {
        Self {
            entries,
            rows: entries.len().max(1),
            starts: vec![0.0],
            size_pt: TICK_PT,
            available,
        }
    }

    fn of_size(entries: &'a [Entry], available: f64, size_pt: f64) -> Self {
        let width = |entry: &Entry| SAMPLE_MM + text_width(&entry.label, size_pt) + GAP_MM;
        let widths = |rows: usize| -> Vec<f64> {
            let columns = entries.chunks(rows);
            columns
                .map(|column| column.iter().map(width).fold(0.0, f64::max))
                .collect()
        };
        // As few rows as fit; one column in any case, its labels are cut.
        let most = entries.len().max(1);
        let rows = (1..most)
            .find(|rows| widths(*rows).iter().sum::<f64>() - GAP_MM <= available)
            .unwrap_or(most);
        let widths = widths(rows);
        // A single column starts at the left, several are spread over the width.
        let spare =
            (available + GAP_MM - widths.iter().sum::<f64>()).max(0.0) / widths.len() as f64;
        let mut end = 0.0;
        let starts = widths.iter().map(|width| {
            let start = end;
            end += width + spare.min(12.0);
            start
        });
        Self {
            entries,
            rows,
            starts: starts.collect(),
            size_pt,
            available,
        }
    }

    /// How many rows it has.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Draws it with the middle of its first row at `origin` [mm].
    pub fn draw(&self, canvas: &mut Canvas, origin: [f64; 2]) {
        for (index, entry) in self.entries.iter().enumerate() {
            let start = self.starts[index / self.rows];
            let x = origin[0] + start;
            let y = origin[1] + (index % self.rows) as f64 * ROW_MM;
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
            draw_mark(canvas, [0.5 * (from + to), y], style);
            let room = self.available - start - SAMPLE_MM;
            let label = fitted(&entry.label, self.size_pt, room);
            let at = [x + SAMPLE_MM, y];
            canvas.text(&label, at, self.size_pt, Anchor::Start, BLACK);
        }
    }
}
