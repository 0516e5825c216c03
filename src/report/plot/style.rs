//! How curves look: colours, dashes, widths, markers.

use super::canvas::Canvas;
use super::colour::{self, METHOD_COLOURS, Rgb, WHITE};

const CURVE_MM: f64 = 0.3;
/// 1.3 pt: equal for all methods.
const METHOD_MM: f64 = 0.45;
const MARKER_MM: f64 = 0.85;

/// Difference that can be seen, as a fraction of the range.
const VISIBLE: f64 = 0.01;

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
    Cross,
    TriangleDown,
    Plus,
    Star,
}

const MARKERS: [Marker; 8] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::TriangleDown,
    Marker::Cross,
    Marker::Plus,
    Marker::Star,
];

/// Markers that are told from their filled twins, in an order in which they do not meet a twin of their own colour.
const HOLLOW: [Marker; 5] = [
    Marker::Diamond,
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::TriangleDown,
];

/// Dashes of exact methods by their round through the colours, and of approximate methods [mm].
const ROUNDS: [&[f64]; 3] = [&[], &[3.0, 0.7, 0.7, 0.7], &[3.0, 0.7, 0.7, 0.7, 0.7, 0.7]];
const APPROXIMATE: &[f64] = &[1.5, 0.9];

/// Dashes of curves that lie on each other and take turns [mm]: the drawn parts of one fill gaps of the others.
const TURNS: [&[f64]; 3] = [&[1.7, 3.4], &[0.0, 1.7, 1.7, 1.7], &[0.0, 3.4, 1.7, 0.0]];

/// Dash patterns: drawn and left out in turn [mm].
const DASHES: [&[f64]; 7] = [
    &[],
    &[2.2, 1.0],
    &[0.7, 0.7],
    &[3.0, 0.8, 0.7, 0.8],
    &[1.3, 0.6],
    &[4.0, 1.0],
    &[2.0, 0.6, 0.6, 0.6, 0.6, 0.6],
];

/// Dashes [mm], marker, its size [mm] and filling of curves that may lie on each other.
const OVER: [(&[f64], Marker, f64, bool); 4] = [
    (&[], Marker::Disc, 1.35, false),
    (&[4.0, 0.8], Marker::Square, 0.95, false),
    (&[1.6, 0.8], Marker::Diamond, 0.65, false),
    (&[0.8, 1.6], Marker::Disc, 0.55, true),
];

/// Every n-th point of a curve, from the given one on.
#[derive(Debug, Clone, Copy)]
pub struct Stagger {
    every: usize,
    from: usize,
}

impl Stagger {
    const EVERY_POINT: Self = Self { every: 1, from: 0 };

    /// Whether the point with this index is meant.
    pub fn picks(self, index: usize) -> bool {
        index % self.every == self.from
    }
}

/// How a curve looks: colour, dashes, marker and whether the marker is filled.
#[derive(Debug, Clone)]
pub struct Style {
    pub colour: Rgb,
    pub dashes: &'static [f64],
    pub width: f64,
    pub marker: Option<Marker>,
    /// Radius of the marker, about [mm].
    pub size: f64,
    pub filled: bool,
    /// Which points get markers.
    pub stagger: Stagger,
}

impl Style {
    /// Look of the n-th curve of a figure. Later curves are thinner, so one that covers another leaves its edges visible.
    pub fn of_curve(index: usize) -> Self {
        Self {
            colour: colour::curve(index),
            dashes: DASHES[index % DASHES.len()],
            width: (CURVE_MM + 0.25 - 0.08 * index as f64).max(CURVE_MM - 0.05),
            marker: Some(MARKERS[index % 7]),
            size: MARKER_MM,
            filled: index.is_multiple_of(2),
            stagger: Stagger::EVERY_POINT,
        }
    }

    /// Look of the n-th curve over common points. Where the first four lie on each other all of them stay visible: markers
    /// are smaller one after the other, and so are the parts of a common period that the dashes fill.
    pub fn over_common_points(index: usize) -> Self {
        let look = OVER.get(index);
        let (dashes, marker, size, filled) = look.copied().unwrap_or((
            DASHES[index % DASHES.len()],
            MARKERS[index % MARKERS.len()],
            MARKER_MM,
            true,
        ));
        // Black as the fourth: the lightest of the first four colours is lost in grey.
        let colour = match index {
            3 => colour::BLACK,
            _ => colour::curve(index - usize::from(index > 3)),
        };
        Self {
            colour,
            dashes,
            width: METHOD_MM,
            marker: Some(marker),
            size,
            filled,
            stagger: Stagger::EVERY_POINT,
        }
    }

    /// Look of the n-th exact method: after the colours come the dashes, the filled markers have a period of their own, so
    /// neither colour and marker nor marker and dashes come twice.
    pub fn of_exact(index: usize) -> Self {
        Self {
            colour: colour::curve(index % METHOD_COLOURS),
            dashes: ROUNDS[index / METHOD_COLOURS % ROUNDS.len()],
            width: METHOD_MM,
            marker: Some(MARKERS[index % MARKERS.len()]),
            size: MARKER_MM,
            filled: true,
            stagger: Stagger::EVERY_POINT,
        }
    }

    /// Look of the n-th approximate method: short dashes and hollow markers.
    pub fn of_approximate(index: usize) -> Self {
        Self {
            colour: colour::curve((index + 1) % METHOD_COLOURS),
            dashes: APPROXIMATE,
            marker: Some(HOLLOW[index % HOLLOW.len()]),
            filled: false,
            ..Self::of_exact(0)
        }
    }

    /// A curve that stands for several methods.
    pub fn shared() -> Self {
        Self {
            colour: colour::BLACK,
            width: 1.6 * METHOD_MM,
            ..Self::of_exact(0)
        }
    }

    /// The same where a closed form is drawn over it: a band on which a thin black line is seen.
    pub fn shared_below_exact() -> Self {
        Self {
            colour: colour::MIDDLE,
            ..Self::shared()
        }
    }

    /// Markers on a band are black, or they would be lost on it.
    pub fn marker_colour(&self) -> Rgb {
        if self.colour == colour::MIDDLE {
            colour::BLACK
        } else {
            self.colour
        }
    }

    /// A closed form: thin, black, without markers.
    pub fn exact() -> Self {
        Self {
            dashes: &[],
            ..Self::reference(colour::BLACK)
        }
    }

    /// A marker alone, black.
    pub fn mark(marker: Marker, filled: bool) -> Self {
        Self {
            marker: Some(marker),
            size: MARKER_MM,
            filled,
            ..Self::reference(colour::BLACK)
        }
    }

    /// The n-th of the curves drawn on a [`shared`](Self::shared) one: narrower, the dashes taking turns.
    pub fn on_shared(self, index: usize) -> Self {
        Self {
            dashes: TURNS[index % TURNS.len()],
            width: 0.8 * METHOD_MM,
            ..self
        }
    }

    /// Looks of curves given by their values, scaled to at most 1: nested where two of them lie on each other.
    pub fn of_curves(values: &[Vec<f64>]) -> Vec<Self> {
        let agree = |a: &[f64], b: &[f64]| {
            a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() < VISIBLE)
        };
        let count = values.len();
        let hidden = (0..count).any(|i| (0..i).any(|j| agree(&values[i], &values[j])));
        let style = |i| {
            if hidden {
                Self::nested(i, count)
            } else {
                Self::of_curve(i)
            }
        };
        (0..count).map(style).collect()
    }

    /// Look of the n-th of `count` curves that lie on each other: each later one is drawn thinner and dashed on the earlier
    /// ones, and they take turns with the markers.
    fn nested(index: usize, count: usize) -> Self {
        let outer = count.saturating_sub(index + 1) as f64;
        Self {
            width: 0.25 + 0.25 * outer,
            stagger: Stagger {
                every: count,
                from: index,
            },
            ..Self::of_curve(index)
        }
    }

    /// A horizontal line such as a tolerance.
    pub fn level() -> Self {
        Self {
            dashes: &[1.5, 1.0],
            ..Self::reference(colour::GREY)
        }
    }

    /// A bound that curves may reach: dots, no markers.
    pub fn limit(colour: Rgb) -> Self {
        Self {
            dashes: &[0.35, 0.65],
            width: 0.35,
            ..Self::reference(colour)
        }
    }

    /// A thin line without markers.
    pub fn reference(colour: Rgb) -> Self {
        Self {
            colour,
            dashes: &[0.5, 0.5],
            width: 0.2,
            marker: None,
            size: 0.0,
            filled: false,
            stagger: Stagger::EVERY_POINT,
        }
    }
}

/// Marker of a contact status and whether it is filled.
pub fn status_marker(status: &str) -> (Marker, bool) {
    match status {
        "stick" => (Marker::Disc, true),
        "slip" => (Marker::Triangle, false),
        _ => (Marker::Cross, false),
    }
}

/// A marker centred at `at`; an unfilled one is white inside.
pub fn draw_marker(canvas: &mut Canvas, at: [f64; 2], marker: Marker, filled: bool, colour: Rgb) {
    draw_sized(canvas, at, MARKER_MM, marker, filled, colour);
}

/// The marker of a style in its size, if it has one.
pub fn draw_mark(canvas: &mut Canvas, at: [f64; 2], style: &Style) {
    if let Some(marker) = style.marker {
        let colour = style.marker_colour();
        draw_sized(canvas, at, style.size, marker, style.filled, colour);
    }
}

fn draw_sized(
    canvas: &mut Canvas,
    at: [f64; 2],
    r: f64,
    marker: Marker,
    filled: bool,
    colour: Rgb,
) {
    let around = |offsets: &[[f64; 2]]| -> Vec<[f64; 2]> {
        offsets
            .iter()
            .map(|o| [at[0] + r * o[0], at[1] + r * o[1]])
            .collect()
    };
    let outline = match marker {
        Marker::Disc => {
            canvas.disc(at, r, colour);
            if !filled {
                canvas.disc(at, r - 0.3, WHITE);
            }
            return;
        }
        Marker::Cross => {
            canvas.line(&around(&[[-0.9, -0.9], [0.9, 0.9]]), colour, CURVE_MM);
            canvas.line(&around(&[[-0.9, 0.9], [0.9, -0.9]]), colour, CURVE_MM);
            return;
        }
        Marker::Plus => {
            canvas.line(&around(&[[-1.1, 0.0], [1.1, 0.0]]), colour, CURVE_MM);
            canvas.line(&around(&[[0.0, -1.1], [0.0, 1.1]]), colour, CURVE_MM);
            return;
        }
        Marker::Star => (0..10)
            .map(|k| {
                let (angle, r) = (
                    std::f64::consts::PI * f64::from(k) / 5.0,
                    if k % 2 == 0 { 1.45 * r } else { 0.6 * r },
                );
                [at[0] + r * angle.sin(), at[1] - r * angle.cos()]
            })
            .collect(),
        Marker::Square => around(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        Marker::Triangle => around(&[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]]),
        Marker::TriangleDown => around(&[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]]),
        Marker::Diamond => around(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
    };
    canvas.fill(&outline, if filled { colour } else { WHITE });
    let mut closed = outline;
    closed.push(closed[0]);
    canvas.line(&closed, colour, 0.25);
}
