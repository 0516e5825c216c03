//! How curves look: colours, dashes, widths, markers.

use super::canvas::Canvas;
use super::colour::{self, Rgb, WHITE};

const CURVE_MM: f64 = 0.3;
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
}

const MARKERS: [Marker; 7] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::TriangleDown,
    Marker::Cross,
    Marker::Plus,
];

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
            marker: Some(MARKERS[index % MARKERS.len()]),
            filled: index.is_multiple_of(2),
            stagger: Stagger::EVERY_POINT,
        }
    }

    /// Look of the n-th of many curves whose points stand beside each other: thin dashed lines, the markers tell.
    pub fn beside_others(index: usize) -> Self {
        Self {
            width: 0.15,
            // Every second time round the palette the markers are not those of the first.
            marker: Some(MARKERS[(index + index / MARKERS.len()) % MARKERS.len()]),
            filled: (index / MARKERS.len()).is_multiple_of(2),
            ..Self::of_curve(index)
        }
    }

    /// A line of the same colour without markers.
    pub fn bar(&self) -> Self {
        Self {
            dashes: &[],
            width: 0.2,
            marker: None,
            ..self.clone()
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

    /// A thin line without markers.
    pub fn reference(colour: Rgb) -> Self {
        Self {
            colour,
            dashes: &[0.5, 0.5],
            width: 0.2,
            marker: None,
            filled: false,
            stagger: Stagger::EVERY_POINT,
        }
    }
}

/// A marker centred at `at`; an unfilled one is white inside.
pub fn draw_marker(canvas: &mut Canvas, at: [f64; 2], marker: Marker, filled: bool, colour: Rgb) {
    let r = MARKER_MM;
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
                canvas.disc(at, 0.65 * r, WHITE);
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
