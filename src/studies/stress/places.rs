//! Ladders: one parameter at a time of a body in uniform compression whose cracks stick, through its decades: where these lie, what
//! they are measured in.
//!
//! Random scenes say how often something breaks; a ladder says where it begins to. A step is a scene like any other.

use std::fmt::Write;
use std::sync::LazyLock;

use super::uniform::sides;

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Name in tables.
    pub name: String,
    /// The parameter that changes, with its unit.
    pub parameter: String,
    /// Space dimension.
    pub dim: usize,
    /// Values and cases.
    steps: Vec<(f64, String)>,
}

impl Ladder {
    fn new(
        name: &str,
        parameter: &str,
        dim: usize,
        values: impl IntoIterator<Item = f64>,
        text: impl Fn(f64) -> String,
    ) -> Self {
        Ladder {
            name: name.into(),
            parameter: parameter.into(),
            dim,
            steps: values.into_iter().map(|v| (v, text(v))).collect(),
        }
    }
}

/// All: of plane bodies, of solids.
static LADDERS: LazyLock<Vec<Ladder>> = LazyLock::new(|| {
    let mut all = places();
    all.extend(units());
    all.extend(solids());
    all
});

/// All ladders.
pub fn ladders() -> &'static [Ladder] {
    &LADDERS
}

/// Number of steps of all ladders.
pub fn count() -> u64 {
    LADDERS.iter().map(|own| own.steps.len() as u64).sum()
}

/// The ladder of a step with a number below [`count`], the value of its parameter there, and its case; of a number beyond the last
/// one that.
pub fn step(number: u64) -> (&'static Ladder, f64, &'static str) {
    let all = LADDERS
        .iter()
        .flat_map(|own| own.steps.iter().map(move |step| (own, step)));
    let last = (count() - 1).min(number) as usize;
    let own = all
        .skip(last)
        .map(|(own, step)| (own, step.0, step.1.as_str()));
    own.into_iter()
        .next()
        .unwrap_or((&LADDERS[0], f64::NAN, ""))
}

/// 10^from, …, 10^to.
fn decades(from: i32, to: i32) -> Vec<f64> {
    let step = if from <= to { 1 } else { -1 };
    let count = (to - from).abs() + 1;
    (0..count).map(|k| power(from + step * k)).collect()
}

/// 10^k, correctly rounded.
fn power(k: i32) -> f64 {
    format!("1e{k}").parse().unwrap_or(f64::NAN)
}

/// Both signs of 1, 0.1, …, 1e-14, and 0.
fn from_both_sides() -> Vec<f64> {
    let below = decades(0, -14).into_iter().map(|v| -v);
    let above = decades(-14, 0);
    below.chain([0.0]).chain(above).collect()
}

/// A plate of 4 × 3 in 16 × 12 cells, lengths in a unit, in uniform compression between rollers and pressures.
#[derive(Clone)]
struct Patch {
    unit: f64,
    young: f64,
    moved: f64,
    twist: f64,
    cracks: Vec<Vec<[f64; 2]>>,
}

impl Patch {
    fn new(cracks: &[&[[f64; 2]]]) -> Self {
        Patch {
            unit: 1.0,
            young: 1e10,
            moved: 0.0,
            twist: 0.0,
            cracks: cracks.iter().map(|c| c.to_vec()).collect(),
        }
    }

    fn text(&self) -> String {
        let place = |v: f64| (v + 4.0 * self.moved) * self.unit;
        let mut text = format!(
            "title = \"ladder\"\nmodel = \"plane-strain\"\ntolerance = 1e-12\n[material]\nyoung_pa = {:?}\npoisson = 0.3\n",
            self.young
        );
        let (low, high) = (place(0.0), [place(4.0), place(3.0)]);
        let _ = write!(
            text,
            "[mesh.box]\nmin_m = [{low:?}, {low:?}]\nmax_m = [{:?}, {:?}]\ncells = [16, 12]\n",
            high[0], high[1]
        );
        if self.twist != 0.0 {
            let _ = write!(text, "[mesh.twist]\nangle_deg = {:?}\n", self.twist);
        }
        for crack in &self.cracks {
            let points: Vec<[f64; 2]> = crack.iter().map(|p| p.map(place)).collect();
            // The stresses stand 2 : 3; more than that sticks at any angle.
            let _ = write!(text, "[[crack]]\npoints_m = {points:?}\nfriction = 0.5\n");
        }
        for (side, free) in [("left", "0.0, \"free\""), ("bottom", "\"free\", 0.0")] {
            let _ = write!(
                text,
                "[[support]]\non = \"{side}\"\ndisplacement_m = [{free}]\n"
            );
        }
        for (side, share) in [("right", 2e-4), ("top", 3e-4)] {
            let pressure = share * self.young;
            let _ = write!(
                text,
                "[[load]]\non = \"{side}\"\npressure_pa = {pressure:?}\n"
            );
        }
        text
    }
}

/// Side of a cell of [`Patch`].
const H: f64 = 0.25;

/// Where cracks lie: distances in cells, to what they nearly touch.
fn places() -> Vec<Ladder> {
    let sided = |name: &str, what: &str, cracks: &dyn Fn(f64) -> Vec<Vec<[f64; 2]>>| {
        let parameter = format!("{what} [cells]");
        Ladder::new(name, &parameter, 2, from_both_sides(), |v| {
            let cracks = cracks(v * H);
            Patch {
                cracks,
                ..Patch::new(&[])
            }
            .text()
        })
    };
    let inner = vec![[0.9, 0.8], [2.9, 2.1]];
    let node = [2.25, 1.75];
    let angles = [
        0.0,
        1e-8,
        1e-4,
        1.0,
        10.0,
        27.0,
        45.0,
        63.0,
        80.0,
        89.0,
        89.9999,
        89.99999999,
        90.0,
    ];
    vec![
        sided("along a grid line", "distance to it", &|d| {
            vec![vec![[-1.0, 1.5 + d], [5.0, 1.5 + d]]]
        }),
        sided("through a node", "distance to it", &|d| {
            let at = [node[0], node[1] + d];
            vec![vec![[at[0] - 4.0, at[1] - 1.7], [at[0] + 4.0, at[1] + 1.7]]]
        }),
        sided("tip beside a node", "distance to it", &|d| {
            vec![vec![[0.9, 0.9], [node[0] + d, node[1]]]]
        }),
        sided("tip beside a side", "distance inside it", &|d| {
            vec![vec![[1.4, 1.1], [4.0 - d, 1.9]]]
        }),
        sided("tip beside a crack", "distance beyond it", &|d| {
            vec![inner.clone(), vec![[2.6, 0.3], [1.9 - 0.5 * d, 1.45 + d]]]
        }),
        sided("kink beside a crossing", "distance beyond it", &|d| {
            let kink = vec![[0.4, 1.1], [1.9 + d, 1.45], [3.3, 2.6]];
            vec![kink, vec![[1.9, 0.5], [1.9, 2.5]]]
        }),
        sided("three cracks beside a point", "distance to it", &|d| {
            let through = |x: f64, y: f64, a: f64, b: f64| vec![[x - a, y - b], [x + a, y + b]];
            vec![
                through(2.1, 1.4, 1.3, 0.2),
                through(2.1, 1.4, 0.5, 1.1),
                through(2.1 + d, 1.4, -0.8, 0.9),
            ]
        }),
        Ladder::new(
            "parallel cracks",
            "distance [cells]",
            2,
            decades(0, -14),
            |v| {
                let d = v * H;
                Patch::new(&[
                    &[[0.7, 0.8], [3.1, 1.9]],
                    &[[0.9, 0.9 + d], [2.9, 1.0 + d + 49.0 / 60.0]],
                ])
                .text()
            },
        ),
        Ladder::new("angle", "to the grid [degrees]", 2, angles, |v| {
            let (sin, cos) = v.to_radians().sin_cos();
            let ends = [-1.0, 1.0].map(|s| [2.1 + 1.2 * s * cos, 1.4 + 1.2 * s * sin]);
            Patch::new(&[&ends]).text()
        }),
    ]
}

/// A crack that lies anyhow.
const ANYHOW: [[f64; 2]; 2] = [[0.93, 0.77], [2.87, 2.13]];

/// Where the body lies, how its mesh is turned, and what it is measured in.
fn units() -> Vec<Ladder> {
    let patch = || Patch::new(&[&ANYHOW]);
    let every = |from: i32, to: i32, step: usize| decades(from, to).into_iter().step_by(step);
    let twists = (-6..=6).map(|k| 20.0 * f64::from(k));
    let moved = [0.0].into_iter().chain(decades(0, 6));
    vec![
        Ladder::new("body moved", "distance [sizes]", 2, moved, |moved| {
            Patch { moved, ..patch() }.text()
        }),
        Ladder::new(
            "mesh twisted",
            "angle at the centre [degrees]",
            2,
            twists,
            |twist| Patch { twist, ..patch() }.text(),
        ),
        Ladder::new(
            "unit of length",
            "factor [-]",
            2,
            every(-12, 12, 3),
            |unit| Patch { unit, ..patch() }.text(),
        ),
        Ladder::new("unit of stress", "E [Pa]", 2, every(-24, 24, 4), |young| {
            Patch { young, ..patch() }.text()
        }),
    ]
}

/// Solids in uniform compression.
fn solids() -> Vec<Ladder> {
    let text = |crack: &str, moved: f64| {
        let [low, high] = [0.0, 3.0].map(|v| v + 3.0 * moved);
        let mut text = format!(
            "title = \"ladder\"\nmodel = \"solid\"\ntolerance = 1e-12\n[material]\nyoung_pa = 1e10\npoisson = 0.3\n\
             [mesh.box]\nmin_m = [{low:?}, {low:?}, {low:?}]\nmax_m = [{high:?}, {high:?}, {high:?}]\ncells = [3, 3, 3]\n\
             [[crack]]\nfriction = 0.6\n{crack}"
        );
        for (a, [low, high]) in sides(3).iter().enumerate() {
            let roller: Vec<&str> = (0..3)
                .map(|b| if a == b { "0.0" } else { "\"free\"" })
                .collect();
            let roller = roller.join(", ");
            let pressure = 1e6 * (2.0 + 0.5 * a as f64);
            let _ = write!(
                text,
                "[[support]]\non = \"{low}\"\ndisplacement_m = [{roller}]\n[[load]]\non = \"{high}\"\npressure_pa = {pressure:?}\n"
            );
        }
        text
    };
    let plane = |point: [f64; 3], n: [f64; 3]| {
        format!("[crack.plane]\npoint_m = {point:?}\nnormal = {n:?}\n")
    };
    let sided: Vec<f64> = from_both_sides().into_iter().skip(1).step_by(2).collect();
    vec![
        Ladder::new(
            "plane along a layer of nodes",
            "distance to it [cells]",
            3,
            sided.clone(),
            |d| text(&plane([1.5, 1.5, 1.0 + d], [0.0, 0.0, 1.0]), 0.0),
        ),
        Ladder::new(
            "plane through a node",
            "distance to it [cells]",
            3,
            sided,
            |d| text(&plane([1.0, 1.0, 1.0 + d], [0.31, 0.17, 0.93]), 0.0),
        ),
        Ladder::new(
            "solid moved",
            "distance [sizes]",
            3,
            [0.0, 1e2, 1e4, 1e6],
            |moved| {
                let at = |v: f64| v + 3.0 * moved;
                text(
                    &plane([at(1.43), at(1.61), at(1.37)], [0.31, 0.17, 0.93]),
                    moved,
                )
            },
        ),
    ]
}
