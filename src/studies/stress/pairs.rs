//! Ladders of pairs: a feature of cracks is moved past another one, or past one of the mesh or the body; all else stays.
//!
//! ```text
//!   −1, −1/3, … −3⁻²⁷, 0, 3⁻²⁷, … 1    distance in cells, before and beyond where they meet
//!   16, 15, … 2                        digits that all coordinates are rounded to at distance 0
//! ```
//!
//! Every pair is loaded twice: by pressures under which all cracks stick, the answer being known, and so that all slip.

use super::places::{Compared, Ladder, Patch, Step};
use crate::case::even_lines;

type Place = [f64; 2];

/// Cells along a side of the body, and of those that answers far from a meeting are compared with.
const CELLS: [usize; 2] = [18, 25];

/// Side of a cell [m]; the body is a square of 1 m.
const H: f64 = 1.0 / CELLS[0] as f64;

/// Distances on one side.
const DISTANCES: usize = 28;

/// Every so many steps are tried by default, with that at distance 0.
const USUAL: usize = 3;

/// Distance up to which a body is as good as that where its features meet [cells].
const NEAR: f64 = 1e-3;

/// A foot is an end on another crack, a mouth one on a side, a point an inner one of a straight crack.
const MOVING: &str = "end bend crossing foot mouth point";

/// An edge is crossed; along a line of the grid the crack runs; of a crack an inner point is met.
const TARGETS: &str = "node edge line side corner end bend crossing crack";

/// Spaces and tips that may step where a tip leaves a cell.
const FORMS: [&str; 3] = [
    "tip = \"none\"",
    "tip = \"branch\"",
    "contact = \"edge-pairs\"",
];

// Directions of cracks, 45 degrees from each other; the larger pressure of the load that makes them slip lies between.
const M: Place = [0.57, 0.82];
const M_BENT: Place = [0.22, 0.98];
const T: Place = [0.98, 0.17];
const T_BENT: Place = [0.98, -0.22];

/// Ladders of the default space and tips, and those of others, which differ at ends.
pub fn ladders() -> Vec<Ladder> {
    let mut all = Vec::new();
    for form in [""].into_iter().chain(FORMS) {
        for slips in [false, true] {
            for moving in MOVING.split(' ') {
                let met = TARGETS.split(' ').filter(|target| meet(moving, target));
                let asked = form.is_empty() || slips && moving == "end";
                let pairs = met.filter(|_| asked).map(|target| Pair { moving, target });
                all.extend(pairs.map(|pair| pair.ladder(slips, form)));
            }
        }
    }
    all
}

/// A mouth is on a side; a straight crack crosses an edge or another crack anywhere, and without ends no side.
fn meet(moving: &str, target: &str) -> bool {
    match moving {
        "mouth" => !["edge", "side"].contains(&target),
        "point" => !["edge", "side", "corner", "crack"].contains(&target),
        _ => true,
    }
}

fn turned(d: Place) -> Place {
    [-d[1], d[0]]
}

/// A place so many cells away.
fn beside(x: Place, cells: f64, d: Place) -> Place {
    [0, 1].map(|a| x[a] + cells * H * d[a])
}

/// A straight crack to both sides of a place.
fn through(x: Place, cells: f64, d: Place) -> Vec<Place> {
    vec![beside(x, -cells, d), beside(x, cells, d)]
}

/// A feature and what it is moved past.
struct Pair {
    moving: &'static str,
    target: &'static str,
}

impl Pair {
    fn ladder(&self, slips: bool, form: &'static str) -> Ladder {
        let powers = (0..DISTANCES).map(|k| (0..k).fold(1.0, |d, _| d / 3.0));
        let powers: Vec<f64> = powers.collect();
        let before = powers.iter().map(|d| -d);
        let beyond = powers.iter().rev().copied();
        let digits = (2..=16).rev().map(f64::from);
        let values = before.chain([0.0]).chain(beyond).chain(digits);
        let step = |(place, value): (usize, f64)| {
            let cracks = self.cracks(value);
            let moved = self.cracks(0.0).concat().into_iter().zip(cracks.concat());
            let moved = moved.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]) / H);
            let text = |cells: usize| {
                Patch {
                    size: [1.0, 1.0],
                    cells: [cells, cells],
                    slips,
                    form,
                    ..Patch::new(&cracks)
                }
                .text()
            };
            Step {
                value,
                text: text(CELLS[0]),
                other: (moved.fold(0.0, f64::max) > NEAR).then(|| text(CELLS[1])),
                usual: place % USUAL == DISTANCES % USUAL,
            }
        };
        let load = if slips { "slips" } else { "sticks" };
        let comma = if form.is_empty() { "" } else { ", " };
        Ladder {
            name: format!("{} past {}, {load}{comma}{form}", self.moving, self.target),
            parameter: "distance [cells], 2 to 16: digits".into(),
            dim: 2,
            compared: Some(Compared {
                slips,
                may_step: !form.is_empty(),
            }),
            steps: values.enumerate().map(step).collect(),
        }
    }

    /// The cracks at a distance, or with so many digits.
    fn cracks(&self, value: f64) -> Vec<Vec<Place>> {
        let (x, direction) = self.meeting();
        let typed = value > 1.0;
        let mut all = self.moving(beside(x, if typed { 0.0 } else { value }, direction));
        all.extend(self.fixed(x));
        for v in all.iter_mut().flatten().flatten().filter(|_| typed) {
            *v = format!("{v:.*e}", value as usize - 1).parse().unwrap_or(*v);
        }
        all
    }

    /// Where the features meet, and the direction of positive distances.
    fn meeting(&self) -> (Place, Place) {
        let lines = even_lines(0.0, 1.0, CELLS[0]);
        let (across, between) = (8.41 * H, 9.37 * H);
        match (self.moving, self.target) {
            ("mouth", "node" | "line") => ([1.0, lines[10]], [0.0, 1.0]),
            ("mouth", "corner") => ([1.0, 1.0], [0.0, 1.0]),
            ("mouth", _) => ([1.0, between], [0.0, 1.0]),
            (_, "node") => ([lines[8], lines[10]], [0.87, 0.5]),
            (_, "edge" | "line") => ([lines[8], between], [1.0, 0.0]),
            (_, "side") => ([1.0, between], [-1.0, 0.0]),
            (_, "corner") => ([1.0, 1.0], [-0.6, -0.8]),
            (_, "crack") => ([across, between], turned(T)),
            _ => ([across, between], [0.87, 0.5]),
        }
    }

    /// Cracks through a place that is moved.
    fn moving(&self, a: Place) -> Vec<Vec<Place>> {
        let first = match (self.moving, self.target) {
            ("mouth", "line") => [1.0, 0.0],
            (_, "line") => [0.0, 1.0],
            _ => M,
        };
        // At a corner all lead into the body.
        let second = if self.target == "corner" {
            T.map(|v| -v)
        } else {
            turned(M)
        };
        let start = beside(a, -6.0, first);
        match self.moving {
            "bend" => vec![vec![start, a, beside(a, 6.0, M_BENT)]],
            "crossing" => vec![through(a, 6.0, first), through(a, 6.0, second)],
            "foot" => vec![through(a, 6.0, first), vec![beside(a, 6.0, second), a]],
            "point" => vec![through(a, 6.0, first)],
            _ => vec![vec![start, a]],
        }
    }

    /// Cracks through a place that stays.
    fn fixed(&self, x: Place) -> Vec<Vec<Place>> {
        let (inwards, other) = match self.moving {
            "mouth" => (-5.0, M),
            _ => (5.0, T),
        };
        match self.target {
            "end" => vec![vec![beside(x, inwards, T), x]],
            "bend" => vec![vec![beside(x, -5.0, T), x, beside(x, 5.0, T_BENT)]],
            "crossing" => vec![through(x, 5.0, T), through(x, 5.0, turned(other))],
            "crack" => vec![through(x, 5.0, T)],
            _ => Vec::new(),
        }
    }
}
