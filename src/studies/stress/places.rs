//! Ladders: one parameter at a time of a body with plain cracks through its decades: where these lie, what they are measured in.
//!
//! Random scenes say how often something breaks; a ladder says where it begins to. A step is a scene like any other.

use std::fmt::Write;
use std::sync::LazyLock;

use super::pairs;
use super::uniform::sides;

/// How answers are compared, by the default method alone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Compared {
    /// Whether the cracks slip.
    pub slips: bool,
    /// Whether their space or tips may step where a tip leaves a cell.
    pub may_step: bool,
}

/// A value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The value.
    pub value: f64,
    /// The case.
    pub text: String,
    /// The case in other cells, where its answer is compared with that.
    pub other: Option<String>,
    /// Whether it is tried by default.
    pub usual: bool,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Name in tables.
    pub name: String,
    /// The parameter that changes, with its unit.
    pub parameter: String,
    /// Space dimension.
    pub dim: usize,
    /// How its answers are compared with those of neighbours and other cells; none: every one is judged alone.
    pub compared: Option<Compared>,
    /// Its steps.
    pub steps: Vec<Step>,
}

impl Ladder {
    fn new(
        name: &str,
        parameter: &str,
        dim: usize,
        values: impl IntoIterator<Item = f64>,
        text: impl Fn(f64) -> String,
    ) -> Self {
        let step = |value: f64| Step {
            value,
            text: text(value),
            other: None,
            usual: true,
        };
        Ladder {
            name: name.into(),
            parameter: parameter.into(),
            dim,
            compared: None,
            steps: values.into_iter().map(step).collect(),
        }
    }
}

/// All: of plane bodies, of solids, of pairs.
static LADDERS: LazyLock<Vec<Ladder>> = LazyLock::new(|| {
    let mut all = places();
    all.extend(units());
    all.extend(solids());
    all.extend(pairs::ladders());
    all
});

/// All steps with the place of their ladder.
static STEPS: LazyLock<Vec<(usize, &Ladder, &Step)>> = LazyLock::new(|| {
    let ladders = LADDERS.iter().enumerate();
    let steps =
        ladders.flat_map(|(place, own)| own.steps.iter().map(move |step| (place, own, step)));
    steps.collect()
});

/// Number of steps of the ladders whose answers may not step, which come first, or of all.
pub fn count(full: bool) -> u64 {
    let may_step = |own: &Ladder| own.compared.is_some_and(|own| own.may_step);
    let own = STEPS.iter().filter(|own| full || !may_step(own.1));
    own.count() as u64
}

/// The ladder of a step with a number below [`count`], after its place, and the step; of a number beyond the last one that.
pub fn step(number: u64) -> (usize, &'static Ladder, &'static Step) {
    STEPS[(STEPS.len() - 1).min(number as usize)]
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

/// A plate, at first of 4 × 3 in 16 × 12 cells, lengths in a unit, with cracks.
pub(super) struct Patch {
    pub(super) size: [f64; 2],
    pub(super) cells: [usize; 2],
    pub(super) unit: f64,
    pub(super) young: f64,
    pub(super) moved: f64,
    pub(super) twist: f64,
    /// Whether its cracks slip; they stick in uniform compression between rollers and pressures.
    pub(super) slips: bool,
    /// What is said of every crack beside.
    pub(super) form: &'static str,
    pub(super) cracks: Vec<Vec<[f64; 2]>>,
}

impl Patch {
    pub(super) fn new(cracks: &[Vec<[f64; 2]>]) -> Self {
        Patch {
            size: [4.0, 3.0],
            cells: [16, 12],
            unit: 1.0,
            young: 1e10,
            moved: 0.0,
            twist: 0.0,
            slips: false,
            form: "",
            cracks: cracks.to_vec(),
        }
    }

    pub(super) fn text(&self) -> String {
        let place = |v: f64| (v + self.size[0] * self.moved) * self.unit;
        let (low, high, cells) = (place(0.0), self.size.map(place), self.cells);
        let mut text = format!(
            "title = \"ladder\"\nmodel = \"plane-strain\"\ntolerance = 1e-12\n[material]\nyoung_pa = {:?}\npoisson = 0.3\n\
             [mesh.box]\nmin_m = [{low:?}, {low:?}]\nmax_m = {high:?}\ncells = {cells:?}\n",
            self.young
        );
        if self.twist != 0.0 {
            let _ = write!(text, "[mesh.twist]\nangle_deg = {:?}\n", self.twist);
        }
        // The pressures stand 2 : 3: with more than 0.21 a crack sticks at any angle.
        let friction = if self.slips { 0.1 } else { 0.5 };
        for crack in &self.cracks {
            let points: Vec<[f64; 2]> = crack.iter().map(|p| p.map(place)).collect();
            let form = self.form;
            let _ = write!(
                text,
                "[[crack]]\npoints_m = {points:?}\nfriction = {friction:?}\n{form}\n"
            );
        }
        let held = |(side, free): (&str, &str)| {
            format!("[[support]]\non = \"{side}\"\ndisplacement_m = [{free}]\n")
        };
        let loaded = |(side, load, shares): (&str, &str, &[f64])| {
            let pa: Vec<f64> = shares.iter().map(|share| share * self.young).collect();
            let pa = if let [one] = pa[..] {
                format!("{one:?}")
            } else {
                format!("{pa:?}")
            };
            format!("[[load]]\non = \"{side}\"\n{load}_pa = {pa}\n")
        };
        if self.slips {
            // Principal pressures of 3 and 1, the larger one 33 degrees from x.
            text += &held(("bottom", "0.0, 0.0"));
            for (side, [x, y]) in [
                ("left", [2.4, 0.9]),
                ("right", [-2.4, -0.9]),
                ("top", [-0.9, -1.6]),
            ] {
                text += &loaded((side, "traction", &[1e-4 * x, 1e-4 * y]));
            }
        } else {
            text.extend([("left", "0.0, \"free\""), ("bottom", "\"free\", 0.0")].map(held));
            text.extend(
                [
                    ("right", "pressure", &[2e-4][..]),
                    ("top", "pressure", &[3e-4]),
                ]
                .map(loaded),
            );
        }
        text
    }
}

/// Angles and the distance of cracks beside each other.
fn places() -> Vec<Ladder> {
    let small = [0.0, 1e-8, 1e-4, 1.0, 10.0, 27.0, 45.0];
    let angles = small.into_iter().chain(small.map(|angle| 90.0 - angle));
    vec![
        Ladder::new(
            "parallel cracks",
            "distance [cells]",
            2,
            decades(0, -14),
            |v| {
                let d = v / 4.0;
                let other = vec![[0.9, 0.9 + d], [2.9, 1.0 + d + 49.0 / 60.0]];
                Patch::new(&[vec![[0.7, 0.8], [3.1, 1.9]], other]).text()
            },
        ),
        Ladder::new("angle", "to the grid [degrees]", 2, angles, |v| {
            let (sin, cos) = v.to_radians().sin_cos();
            let ends = [-1.0, 1.0].map(|s| [2.1 + 1.2 * s * cos, 1.4 + 1.2 * s * sin]);
            Patch::new(&[ends.to_vec()]).text()
        }),
    ]
}

/// A crack that lies anyhow.
const ANYHOW: [[f64; 2]; 2] = [[0.93, 0.77], [2.87, 2.13]];

/// Where the body lies, how its mesh is turned, and what it is measured in.
fn units() -> Vec<Ladder> {
    let patch = || Patch::new(&[ANYHOW.to_vec()]);
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
