//! Legends: samples and labels in rows below a figure.

use super::canvas::{Anchor, Canvas, TICK_PT, text_width, wrapped};
use super::colour::BLACK;
use super::series::{Draw, Panel, Series};
use super::style::draw_marker;

const ROW_MM: f64 = 3.6;
/// Room for the sample before a label, and between columns [mm].
const SAMPLE_MM: f64 = 8.5;
const GAP_MM: f64 = 2.0;
/// Least width of a column [mm].
const COLUMN_MM: f64 = 27.0;

/// Meaning of the labels of panels, each told once.
pub struct Legend<'a> {
    /// The sample, the lines of its label, and its place [mm].
    entries: Vec<(&'a Series, Vec<String>, [f64; 2])>,
    /// Room that it takes [mm].
    pub height: f64,
}

impl<'a> Legend<'a> {
    /// In rows as wide as the room [mm]; methods that do not stand out come last.
    pub fn of(panels: &[&'a Panel], room: f64) -> Self {
        let mut samples: Vec<&Series> = Vec::new();
        for series in panels.iter().flat_map(|panel| &panel.series) {
            let told = samples.iter().any(|s| s.label == series.label);
            if !series.label.is_empty() && !told {
                samples.push(series);
            }
        }
        samples.sort_by_key(|s| s.style.width == super::style::OTHER_MM);
        // Entries take as many columns as their labels need.
        let column = room / (room / COLUMN_MM).floor().max(1.0);
        let (mut entries, mut end) = (Vec::new(), 0.0);
        let (mut y, mut deepest) = (0.0, 0.0);
        for series in samples {
            let width = SAMPLE_MM + text_width(&series.label, TICK_PT) + GAP_MM;
            let width = (column * (width / column).ceil()).min(room);
            if end + width > room + 1e-6 {
                y += std::mem::take(&mut deepest);
                end = 0.0;
            }
            let lines = wrapped(&series.label, TICK_PT, width - SAMPLE_MM);
            deepest = f64::max(deepest, ROW_MM * lines.len() as f64);
            entries.push((series, lines, [end, y]));
            end += width;
        }
        let height = y + deepest + 0.5;
        Self { entries, height }
    }

    /// Draws it with the middle of its first row at `origin` [mm].
    pub fn draw(&self, canvas: &mut Canvas, [left, top]: [f64; 2]) {
        for (series, lines, [x, y]) in &self.entries {
            let ([x, y], style) = ([left + x, top + y], &series.style);
            let (from, to) = (x + 0.5, x + SAMPLE_MM - 1.5);
            if series.draw == Draw::Bars {
                canvas.boxed([from, y - 1.2], [to, y + 1.2], style.colour, 0.15);
            } else if style.width > 0.0 {
                let ends = [[from, y], [to, y]];
                canvas.dashed(&ends, style.colour, style.width, style.dashes);
            }
            if let Some(marker) = style.marker {
                let look = (marker, style.filled);
                draw_marker(
                    canvas,
                    [0.5 * (from + to), y],
                    look,
                    style.size,
                    style.colour,
                );
            }
            for (index, line) in lines.iter().enumerate() {
                let at = [x + SAMPLE_MM, y + ROW_MM * index as f64];
                canvas.text(line, at, TICK_PT, Anchor::Start, BLACK);
            }
        }
    }
}
