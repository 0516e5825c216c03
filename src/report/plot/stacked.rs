//! Stacked bars: how a total is made up of parts, one lane per bar, the parts as shares of the total.
//!
//! Parts differ in lightness and hatching, so they stay apart in grey; large ones have their share printed inside.

use super::canvas::{
    Anchor, CAPTION_PT, Canvas, LABEL_PT, SMALL_PT, TICK_PT, Width, caption_height, plain,
    text_width, wrapped,
};
use super::colour::{BLACK, Rgb, WHITE};
use crate::report::ReportError;
use crate::report::number::fixed;

const MARGIN_MM: f64 = 1.5;
const LANE_MM: f64 = 4.6;
const BAR_MM: f64 = 3.4;
const GROUP_MM: f64 = 5.0;
const FRAME_MM: f64 = 0.15;
/// Distance of hatching lines.
const HATCH_MM: f64 = 1.1;
/// Shares from here on are printed.
const PRINTED: f64 = 0.08;

/// Lines in a part: slope (x per y), or none.
#[derive(Clone, Copy, PartialEq)]
enum Hatch {
    Plain,
    Rising,
    Falling,
    Upright,
}

/// Fill, hatching and colour of the text of the parts in turn.
const LOOKS: [(Rgb, Hatch, Rgb); 7] = [
    ([225, 225, 225], Hatch::Plain, BLACK),
    ([240, 228, 66], Hatch::Rising, BLACK),
    ([0, 114, 178], Hatch::Plain, WHITE),
    ([86, 180, 233], Hatch::Falling, BLACK),
    ([255, 255, 255], Hatch::Upright, BLACK),
    ([213, 94, 0], Hatch::Plain, WHITE),
    ([255, 255, 255], Hatch::Plain, BLACK),
];

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// To its left.
    pub label: String,
    /// Parts in the order of [`Stacked::parts`], not negative; what is not finite counts as nothing.
    pub values: Vec<f64>,
    /// To its right, e.g. the total.
    pub note: String,
}

/// Bars in groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Stacked {
    /// For screen readers and file browsers.
    pub title: String,
    /// Small text above.
    pub caption: String,
    /// Label of the scale with unit.
    pub scale: String,
    /// Names of the parts; up to seven look different.
    pub parts: Vec<String>,
    /// Groups with their headings.
    pub groups: Vec<(String, Vec<Bar>)>,
}

/// The figure, 170 mm wide.
///
/// # Errors
/// [`ReportError::Figure`] without a bar.
pub fn stacked(figure: &Stacked) -> Result<String, ReportError> {
    let bars = || figure.groups.iter().flat_map(|(_, bars)| bars);
    let widest = |text: fn(&Bar) -> &str| {
        let widths = bars().map(|bar| text_width(&plain(text(bar)), TICK_PT));
        widths.fold(0.0, f64::max)
    };
    if bars().next().is_none() {
        return Err(ReportError::figure("stacked bars", "no bar"));
    }
    let width = Width::Page.mm();
    let caption = wrapped(&figure.caption, CAPTION_PT, width - 2.0 * MARGIN_MM);
    let left = MARGIN_MM + widest(|bar| &bar.label) + 2.0;
    let right = width - MARGIN_MM - widest(|bar| &bar.note) - 2.0;
    let lanes: f64 = figure
        .groups
        .iter()
        .map(|(_, bars)| GROUP_MM + LANE_MM * bars.len() as f64)
        .sum();
    let top = caption_height(&caption);
    let bottom = top + lanes;
    let mut canvas = Canvas::new(width, bottom + 15.5);
    canvas.caption(&caption);
    let mut y = top;
    for (heading, bars) in &figure.groups {
        let at = [left, y + 0.5 * GROUP_MM + 0.3];
        canvas.text(&plain(heading), at, TICK_PT, Anchor::Start, BLACK);
        y += GROUP_MM;
        for bar in bars {
            let middle = y + 0.5 * LANE_MM;
            let label = plain(&bar.label);
            canvas.text(&label, [left - 1.5, middle], TICK_PT, Anchor::End, BLACK);
            draw_bar(&mut canvas, bar, [left, right], middle);
            let note = plain(&bar.note);
            canvas.text(&note, [right + 1.5, middle], TICK_PT, Anchor::Start, BLACK);
            y += LANE_MM;
        }
    }
    for percent in [0.0, 20.0, 40.0, 60.0, 80.0, 100.0] {
        let x = left + percent / 100.0 * (right - left);
        canvas.line(&[[x, bottom], [x, bottom + 1.0]], BLACK, 0.2);
        canvas.text(
            &fixed(percent, 0),
            [x, bottom + 2.8],
            TICK_PT,
            Anchor::Middle,
            BLACK,
        );
    }
    canvas.line(&[[left, bottom], [right, bottom]], BLACK, 0.2);
    let middle = [0.5 * (left + right), bottom + 6.8];
    canvas.text(&figure.scale, middle, LABEL_PT, Anchor::Middle, BLACK);
    draw_legend(&mut canvas, &figure.parts, width, bottom + 12.5);
    canvas.finish(&figure.title)
}

fn draw_bar(canvas: &mut Canvas, bar: &Bar, [left, right]: [f64; 2], middle: f64) {
    let part = |value: &f64| {
        if value.is_finite() {
            value.max(0.0)
        } else {
            0.0
        }
    };
    let total: f64 = bar.values.iter().map(part).sum();
    if total <= 0.0 {
        return;
    }
    let y = [middle - 0.5 * BAR_MM, middle + 0.5 * BAR_MM];
    let mut start = left;
    for (value, look) in bar.values.iter().zip(LOOKS.iter().cycle()) {
        let share = part(value) / total;
        let end = start + share * (right - left);
        if share > 0.0 {
            draw_part(canvas, [start, end], y, look);
        }
        if share >= PRINTED {
            let text = fixed(100.0 * share, 0);
            let at = [0.5 * (start + end), middle];
            // Hatching must not run through the number.
            if look.1 != Hatch::Plain {
                let half = 0.5 * text_width(&text, SMALL_PT) + 0.3;
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                let corners = corners.map(|[a, b]| [at[0] + a * half, at[1] + 1.15 * b]);
                canvas.fill(&corners, look.0);
            }
            canvas.text(&text, at, SMALL_PT, Anchor::Middle, look.2);
        }
        start = end;
    }
}

fn draw_part(canvas: &mut Canvas, x: [f64; 2], y: [f64; 2], look: &(Rgb, Hatch, Rgb)) {
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]].map(|[a, b]| [x[a], y[b]]);
    canvas.fill(&corners[..4], look.0);
    let lean = match look.1 {
        Hatch::Plain => None,
        Hatch::Rising => Some(-1.0),
        Hatch::Falling => Some(1.0),
        Hatch::Upright => Some(0.0),
    };
    if let Some(lean) = lean {
        let height = y[1] - y[0];
        // Feet on the line of the upper edge, counted from zero, so that neighbours hatch alike.
        let reach = [x[0] - height, x[1] + height].map(|x| (x / HATCH_MM) as i64);
        for step in reach[0]..=reach[1] {
            let foot = step as f64 * HATCH_MM;
            if let Some(line) = clipped(foot, lean, x, y) {
                canvas.line(&line, BLACK, 0.1);
            }
        }
    }
    canvas.line(&corners, BLACK, FRAME_MM);
}

/// The part inside a rectangle of the line that starts at (foot, y[0]) and leans by `lean` in x per y.
fn clipped(foot: f64, lean: f64, x: [f64; 2], y: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let height = y[1] - y[0];
    let (mut from, mut to): (f64, f64) = (0.0, height);
    if lean == 0.0 {
        return (foot > x[0] && foot < x[1]).then_some([[foot, y[0]], [foot, y[1]]]);
    }
    let ends = x.map(|edge| (edge - foot) / lean);
    from = from.max(ends[0].min(ends[1]));
    to = to.min(ends[0].max(ends[1]));
    (to > from).then(|| [from, to].map(|t| [foot + lean * t, y[0] + t]))
}

fn draw_legend(canvas: &mut Canvas, parts: &[String], width: f64, y: f64) {
    let sample = 5.0;
    let widths: Vec<f64> = parts
        .iter()
        .map(|part| sample + 1.2 + text_width(part, TICK_PT))
        .collect();
    let spare = (width - 2.0 * MARGIN_MM - widths.iter().sum::<f64>()).max(0.0);
    let gap = (spare / parts.len().max(1) as f64).min(6.0);
    let mut x = MARGIN_MM;
    for ((part, own), look) in parts.iter().zip(&widths).zip(LOOKS.iter().cycle()) {
        draw_part(canvas, [x, x + sample], [y - 1.3, y + 1.3], look);
        let at = [x + sample + 1.2, y];
        canvas.text(&plain(part), at, TICK_PT, Anchor::Start, BLACK);
        x += own + gap;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hatching_stays_inside_its_part() {
        let (x, y) = ([2.0, 3.0], [0.0, 4.0]);
        for lean in [-1.0, 0.0, 1.0] {
            let mut lines = 0;
            for step in -10..20 {
                let Some(line) = clipped(0.5 * f64::from(step), lean, x, y) else {
                    continue;
                };
                lines += 1;
                for [a, b] in line {
                    assert!((2.0 - 1e-12..=3.0 + 1e-12).contains(&a), "{line:?}");
                    assert!((0.0 - 1e-12..=4.0 + 1e-12).contains(&b), "{line:?}");
                }
            }
            assert!(lines > 0, "{lean}");
        }
    }
}
