//! How things look: colours, dashes, markers, and which methods stand out.

use super::canvas::{Canvas, plain};
use super::colour::{BLACK, GREY, MIDDLE, Rgb, WHITE};
use crate::run::choice::is_outside;
use crate::run::registry::methods;
use stickslip_methods::Method;

/// Okabe and Ito (2008) without the yellow, which vanishes on white paper.
const CURVES: [u32; 6] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9];

/// viridis (van der Walt and Smith 2015) at 0, 0.1, …, 1: its lightness rises steadily, so it orders in grey too.
const VIRIDIS: [u32; 11] = [
    0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151,
    0xbddf26, 0xfde725,
];

fn rgb(colour: u32) -> Rgb {
    [16, 8, 0].map(|shift| (colour >> shift) as u8)
}

/// Colour of a field at `fraction` of its range.
pub fn field(fraction: f64) -> Rgb {
    let position = fraction.clamp(0.0, 1.0) * 10.0;
    let index = (position.floor() as usize).min(9);
    let [low, high] = [index, index + 1].map(|i| rgb(VIRIDIS[i]));
    between(low, high, position - index as f64)
}

/// Mixture of two colours, `part` of the second.
pub fn between(a: Rgb, b: Rgb, part: f64) -> Rgb {
    std::array::from_fn(|c| {
        (f64::from(a[c]) + part * (f64::from(b[c]) - f64::from(a[c]))).round() as u8
    })
}

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
    Plus,
    Cross,
}

const MARKERS: [Marker; 7] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::TriangleDown,
    Marker::Plus,
    Marker::Cross,
];

/// Radius of a marker, about [mm].
pub const MARKER_MM: f64 = 0.85;
const CURVE_MM: f64 = 0.45;
/// Width of the lines of methods that do not stand out [mm].
pub const OTHER_MM: f64 = 0.25;

/// Dashes [mm], marker, its size [mm] and filling of curves that may lie on each other: what is drawn later leaves the
/// earlier ones visible.
const OVER: [(&[f64], Marker, f64, bool); 4] = [
    (&[], Marker::Disc, 1.35, false),
    (&[4.0, 0.8], Marker::Square, 0.95, false),
    (&[1.6, 0.8], Marker::Diamond, 0.65, false),
    (&[0.8, 1.6], Marker::Disc, 0.55, true),
];

/// Dashes of methods that stand out in one figure only, in turn [mm].
const FURTHER: [&[f64]; 4] = [&[3.0, 0.7, 0.7, 0.7], &[1.5, 0.9], &[0.7, 0.7], &[5.0, 1.0]];

/// How a curve looks.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// Of line and marker.
    pub colour: Rgb,
    /// Drawn and left out in turn [mm]; empty for a solid line.
    pub dashes: &'static [f64],
    /// Of the line [mm]; 0 for none.
    pub width: f64,
    /// At every point with room.
    pub marker: Option<Marker>,
    /// Radius of the marker, about [mm].
    pub size: f64,
    /// Whether the marker is filled.
    pub filled: bool,
    /// Whether it stands behind all others.
    pub behind: bool,
}

impl Style {
    /// A line without markers.
    pub fn line(colour: Rgb, width: f64, dashes: &'static [f64]) -> Self {
        Self {
            colour,
            dashes,
            width,
            marker: None,
            size: MARKER_MM,
            filled: true,
            behind: false,
        }
    }

    fn marked(self, marker: Marker, size: f64, filled: bool) -> Self {
        let marker = Some(marker);
        Self {
            marker,
            size,
            filled,
            ..self
        }
    }

    /// Look of the n-th curve of a figure; the first four stay visible where they lie on each other.
    pub fn curve(index: usize) -> Self {
        // Black as the fourth: its turn in the palette is lost in grey.
        let colour = match index {
            3 => BLACK,
            _ => rgb(CURVES[(index - usize::from(index > 3)) % 6]),
        };
        let further = (FURTHER[index % 4], MARKERS[index % 7], MARKER_MM, true);
        let (dashes, marker, size, filled) = OVER.get(index).copied().unwrap_or(further);
        Self::line(colour, CURVE_MM, dashes).marked(marker, size, filled)
    }

    /// A wide band that several methods share, on which thin lines are seen.
    pub fn band() -> Self {
        let line = Self::line(MIDDLE, 1.1, &[]);
        Self {
            behind: true,
            ..line
        }
    }

    /// A method that does not stand out.
    pub fn other() -> Self {
        let line = Self::line(MIDDLE, OTHER_MM, &[]);
        Self {
            behind: true,
            ..line
        }
    }

    /// A closed form.
    pub fn exact() -> Self {
        Self::line(BLACK, 0.2, &[])
    }

    /// A bound that curves may reach, or a slope to compare with: dots.
    pub fn limit() -> Self {
        Self::line(GREY, 0.35, &[0.35, 0.65])
    }

    /// A marker alone, black.
    pub fn mark(marker: Marker, filled: bool) -> Self {
        Self::line(BLACK, 0.0, &[]).marked(marker, MARKER_MM, filled)
    }

    /// The same without its markers.
    pub fn bare(self) -> Self {
        Self {
            marker: None,
            size: MARKER_MM,
            ..self
        }
    }

    /// Look of a method: those that stand out have a colour and a marker of their own in every figure, the n-th of all
    /// others is black; methods with laws of their own have short dashes and hollow markers.
    pub fn of_method(label: &str, further: usize) -> Self {
        let own = HIGHLIGHTED.iter().position(|name| *name == base(label));
        let exact = is_exact(label);
        let (colour, marker, dashes) = match own {
            Some(i) if exact => (rgb(CURVES[i]), MARKERS[i], &[][..]),
            Some(i) => (rgb(CURVES[i]), MARKERS[i], FURTHER[1]),
            None => (BLACK, MARKERS[6 - further % 7], FURTHER[further % 4]),
        };
        Self::line(colour, CURVE_MM, dashes).marked(marker, MARKER_MM, exact)
    }
}

/// So many methods that were chosen all stand out.
const FEW: usize = 8;

/// Methods that stand out in every figure: those of the founding paper, and the fast and the known ones beside them.
pub const HIGHLIGHTED: [&str; 6] = [
    "b-newton",
    "hybrid",
    "nsgs",
    "latin",
    "augmented-lagrangian",
    "penalty",
];

/// Name of a method in a label that may carry options in brackets.
pub fn base(label: &str) -> &str {
    label.split('[').next().unwrap_or(label)
}

/// Order of methods in figures: that of the registry, then what it does not know.
pub fn rank(label: &str) -> usize {
    let own = |method: &&Method| method.name == base(label);
    methods().iter().position(own).unwrap_or(methods().len())
}

/// Whether the method solves the contact laws themselves, as those from outside are to; false for what the registry does
/// not know.
pub fn is_exact(label: &str) -> bool {
    let known = methods().get(rank(label));
    known.map_or(is_outside(label), |method| method.exact)
}

/// Marker of a contact status and whether it is filled.
pub fn status_marker(status: &str) -> (Marker, bool) {
    match status {
        "stick" => (Marker::Disc, true),
        "slip" => (Marker::Triangle, false),
        _ => (Marker::Cross, false),
    }
}

/// A marker centred at `at`, `size` about its radius [mm]; an unfilled one is white inside.
pub fn draw_marker(
    canvas: &mut Canvas,
    at: [f64; 2],
    (marker, filled): (Marker, bool),
    size: f64,
    colour: Rgb,
) {
    let around = |offsets: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let place = |o: &[f64; 2]| [at[0] + size * o[0], at[1] + size * o[1]];
        offsets.iter().map(place).collect()
    };
    let outline = match marker {
        Marker::Disc => {
            canvas.disc(at, size, colour);
            if !filled {
                canvas.disc(at, size - 0.3, WHITE);
            }
            return;
        }
        Marker::Cross | Marker::Plus => {
            let lines = match marker {
                Marker::Cross => [[[-0.9, -0.9], [0.9, 0.9]], [[-0.9, 0.9], [0.9, -0.9]]],
                _ => [[[-1.1, 0.0], [1.1, 0.0]], [[0.0, -1.1], [0.0, 1.1]]],
            };
            for line in lines {
                canvas.line(&around(&line), colour, 0.3);
            }
            return;
        }
        Marker::Square => around(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        Marker::Triangle => around(&[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]]),
        Marker::TriangleDown => around(&[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]]),
        Marker::Diamond => around(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
    };
    canvas.fill(&outline, if filled { colour } else { WHITE });
    let closed: Vec<[f64; 2]> = outline.iter().chain(outline.first()).copied().collect();
    canvas.line(&closed, colour, 0.25);
}

/// Labels and looks of the curves of methods in one figure: `HIGHLIGHTED` methods, programs from outside and `further` ones
/// stand out, all others share grey and one label.
pub fn looks(labels: &[&str], further: &[&str]) -> Vec<(String, Style)> {
    let mut extra = 0;
    let mut style = |index: usize| {
        let name = base(labels[index]);
        let first = labels[..index].iter().all(|label| base(label) != name);
        let named = first && HIGHLIGHTED.contains(&name);
        // Who brings a program looks for it.
        let few = labels.len() <= FEW;
        let shown = named || few || is_outside(name) || further.contains(&labels[index]);
        extra += usize::from(shown && !named);
        shown.then(|| Style::of_method(labels[index], extra.saturating_sub(1)))
    };
    let chosen: Vec<Option<Style>> = (0..labels.len()).map(&mut style).collect();
    let others = chosen.iter().filter(|style| style.is_none()).count();
    let look = |(label, style): (&&str, Option<Style>)| match style {
        Some(style) => (plain(label), style),
        None if others == 1 => (plain(label), Style::other()),
        None => (format!("{others} other methods"), Style::other()),
    };
    labels.iter().zip(chosen).map(look).collect()
}
