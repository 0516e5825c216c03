//! Legends: samples and labels in rows below a figure.

use super::canvas::{Anchor, Canvas, TICK_PT, text_width, wrapped};
use super::figure::{Draw, Panel, Series};
use super::style::{BLACK, draw_marker};

const ROW_MM: f64 = 3.6;
/// Room for the sample before a label, and between columns [mm].
const SAMPLE_MM: f64 = 8.5;
const GAP_MM: f64 = 3.0;

/// What the labels of panels mean, each told once.
pub struct Legend<'a> {
    /// The sample, the lines of its label, and its place [mm].
    entries: Vec<(&'a Series, Vec<String>, [f64; 2])>,
    /// Room that it takes [mm].
    pub height: f64,
}

impl<'a> Legend<'a> {
    /// Columns as far as the room [mm] goes; what stands behind comes last.
    pub fn of(panels: &[&'a Panel], room: f64) -> Self {
        let mut samples: Vec<&Series> = Vec::new();
        for series in panels.iter().flat_map(|panel| &panel.series) {
            let told = samples.iter().any(|s| s.label == series.label);
            if !series.label.is_empty() && !told {
                samples.push(series);
            }
        }
        samples.sort_by_key(|s| s.style.width == super::style::OTHER_MM);
        let widths = samples.iter().map(|s| text_width(&s.label, TICK_PT));
        let column = SAMPLE_MM + widths.fold(0.0, f64::max) + GAP_MM;
        let most = samples.len().max(1) as f64;
        let columns = ((room + GAP_MM) / column).floor().clamp(1.0, most);
        let share = room / columns;
        let (mut entries, mut y, mut deepest) = (Vec::new(), 0.0, 0.0);
        for (index, series) in samples.into_iter().enumerate() {
            let column = index % columns as usize;
            if column == 0 {
                y += std::mem::take(&mut deepest);
            }
            let lines = wrapped(&series.label, TICK_PT, share - SAMPLE_MM);
            deepest = f64::max(deepest, ROW_MM * lines.len() as f64);
            entries.push((series, lines, [share * column as f64, y]));
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
