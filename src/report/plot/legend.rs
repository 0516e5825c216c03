//! Legends: samples and labels in rows below a figure.

use super::canvas::{Anchor, Canvas, SMALL_PT, TICK_PT, text_width, wrapped};
use super::figure::{Draw, Panel, Series};
use super::style::{BLACK, Style, draw_marker};

const ROW_MM: f64 = 3.6;
/// Room for the sample before a label, and between columns [mm].
const SAMPLE_MM: f64 = 8.5;
const GAP_MM: f64 = 3.0;

/// Entries by label, placed.
pub struct Legend<'a> {
    /// The sample, the lines of its label, and its place [mm].
    entries: Vec<(&'a Series, Vec<String>, [f64; 2])>,
    /// Guides have no series of their own.
    limits: Vec<(String, [f64; 2])>,
    height: f64,
}

impl<'a> Legend<'a> {
    /// What the labels of these panels say, in columns as far as the room [mm] goes.
    pub fn of(panels: &[&'a Panel], room: f64) -> Self {
        let mut samples: Vec<&Series> = Vec::new();
        for series in panels.iter().flat_map(|panel| &panel.series) {
            if !series.label.is_empty() && samples.iter().all(|s| s.label != series.label) {
                samples.push(series);
            }
        }
        let mut guides: Vec<&str> = Vec::new();
        for guide in panels.iter().flat_map(|panel| &panel.guides) {
            if !guide.label.is_empty() && !guides.contains(&guide.label.as_str()) {
                guides.push(&guide.label);
            }
        }
        let labels = samples
            .iter()
            .map(|s| s.label.as_str())
            .chain(guides.iter().copied());
        let longest = labels
            .clone()
            .map(|l| text_width(l, TICK_PT))
            .fold(0.0, f64::max);
        let column = (SAMPLE_MM + longest + GAP_MM).min(room);
        let columns = ((room + GAP_MM) / column)
            .floor()
            .clamp(1.0, samples.len().max(1) as f64);
        let share = room / columns;
        let mut places = Vec::new();
        let (mut y, mut deepest) = (0.0, 0.0_f64);
        for (index, label) in labels.enumerate() {
            let column = index % columns as usize;
            if column == 0 {
                y += deepest;
                deepest = 0.0;
            }
            let lines = wrapped(label, TICK_PT, share - SAMPLE_MM);
            deepest = deepest.max(ROW_MM * lines.len() as f64);
            places.push((lines, [share * column as f64, y]));
        }
        let guided = places.split_off(samples.len());
        Self {
            entries: samples
                .into_iter()
                .zip(places)
                .map(|(s, (lines, at))| (s, lines, at))
                .collect(),
            limits: guided
                .into_iter()
                .map(|(lines, at)| (lines.join(" "), at))
                .collect(),
            height: y + deepest + 0.5,
        }
    }

    /// Room that it takes [mm].
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Draws it with the middle of its first row at `origin` [mm].
    pub fn draw(&self, canvas: &mut Canvas, [left, top]: [f64; 2]) {
        for (series, lines, [x, y]) in &self.entries {
            let [x, y] = [left + x, top + y];
            let style = &series.style;
            match series.draw {
                Draw::Bars => {
                    canvas.boxed([x + 1.0, y - 1.2], [x + 6.5, y + 1.2], style.colour, 0.15)
                }
                _ => draw_sample(canvas, [x, y], style),
            }
            for (index, line) in lines.iter().enumerate() {
                let at = [x + SAMPLE_MM, y + ROW_MM * index as f64];
                canvas.text(line, at, TICK_PT, Anchor::Start, BLACK);
            }
        }
        for (label, [x, y]) in &self.limits {
            draw_sample(canvas, [left + x, top + y], &Style::limit());
            canvas.text(
                label,
                [left + x + SAMPLE_MM, top + y],
                SMALL_PT,
                Anchor::Start,
                BLACK,
            );
        }
    }
}

fn draw_sample(canvas: &mut Canvas, [x, y]: [f64; 2], style: &Style) {
    let (from, to) = (x + 0.5, x + SAMPLE_MM - 1.5);
    if style.width > 0.0 {
        canvas.dashed(
            &[[from, y], [to, y]],
            style.colour,
            style.width,
            style.dashes,
        );
    }
    if let Some(marker) = style.marker {
        draw_marker(
            canvas,
            [0.5 * (from + to), y],
            (marker, style.filled),
            style.size,
            style.colour,
        );
    }
}
