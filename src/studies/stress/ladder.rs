//! Ladders: one parameter of a simple scene at a time, through its decades, and every parameter of every method.
//!
//! Random scenes say how often something breaks; a ladder says where it begins to. A rung is a scene like any other.

use std::fmt::Write;

use stickslip_methods::OptionSpec;

use super::scene::{Family, Scene, Truth};
use crate::run::registry::methods;

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Name in tables.
    pub name: String,
    /// What changes, with its unit.
    pub parameter: String,
    /// The method whose option it is; none of a ladder of the scene.
    pub method: Option<&'static str>,
    /// Values and scenes.
    rungs: Vec<(f64, Content)>,
}

/// A case and what its answer is held to.
#[derive(Debug, Clone, PartialEq)]
struct Content {
    text: String,
    dim: usize,
    truth: Truth,
    method: Option<String>,
}

/// A rung: a ladder, and one value of its parameter.
pub struct Rung {
    /// The ladder.
    pub ladder: Ladder,
    /// The value.
    pub value: f64,
}

/// Number of rungs of all ladders.
pub fn count() -> u64 {
    ladders().iter().map(|l| l.rungs.len() as u64).sum()
}

/// The rung with a number, from 0; the last one beyond it.
pub fn rung(number: u64) -> Rung {
    let (ladder, index) = find(number);
    let value = ladder.rungs[index].0;
    Rung { ladder, value }
}

/// Its scene.
pub fn scene(number: u64) -> Scene {
    let (ladder, index) = find(number);
    let content = ladder.rungs[index].1.clone();
    Scene {
        family: Family::Ladder,
        number,
        category: ladder.name,
        dim: content.dim,
        text: content.text,
        truth: content.truth,
        methods: content.method.into_iter().collect(),
        beyond: false,
    }
}

fn find(number: u64) -> (Ladder, usize) {
    let mut left = number as usize;
    let mut all = ladders();
    let last = all.len() - 1;
    for index in 0..last {
        let own = all[index].rungs.len();
        if left < own {
            return (all.swap_remove(index), left);
        }
        left -= own;
    }
    let ladder = all.swap_remove(last);
    let index = left.min(ladder.rungs.len() - 1);
    (ladder, index)
}

/// All ladders: of plane bodies that stick, of plane bodies that slip, of solids, of methods.
pub fn ladders() -> Vec<Ladder> {
    let mut all = places();
    all.extend(units());
    all.extend(slips());
    all.extend(solids());
    all.extend(options());
    all
}

impl Ladder {
    fn new(
        name: &str,
        parameter: &str,
        values: impl IntoIterator<Item = f64>,
        content: impl Fn(f64) -> Content,
    ) -> Self {
        Ladder {
            name: name.into(),
            parameter: parameter.into(),
            method: None,
            rungs: values.into_iter().map(|v| (v, content(v))).collect(),
        }
    }
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

    fn content(&self) -> Content {
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
        Content {
            text,
            dim: 2,
            truth: Truth::Uniform,
            method: None,
        }
    }
}

/// Side of a cell of [`Patch`].
const H: f64 = 0.25;

/// Where cracks lie: distances in cells, to what they nearly touch.
fn places() -> Vec<Ladder> {
    let sided = |name: &str, what: &str, cracks: &dyn Fn(f64) -> Vec<Vec<[f64; 2]>>| {
        let parameter = format!("{what} [cells]");
        Ladder::new(name, &parameter, from_both_sides(), |v| {
            let cracks = cracks(v * H);
            Patch {
                cracks,
                ..Patch::new(&[])
            }
            .content()
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
            decades(0, -14),
            |v| {
                let d = v * H;
                Patch::new(&[
                    &[[0.7, 0.8], [3.1, 1.9]],
                    &[[0.9, 0.9 + d], [2.9, 1.0 + d + 49.0 / 60.0]],
                ])
                .content()
            },
        ),
        Ladder::new("angle", "to the grid [degrees]", angles, |v| {
            let (sin, cos) = v.to_radians().sin_cos();
            let ends = [-1.0, 1.0].map(|s| [2.1 + 1.2 * s * cos, 1.4 + 1.2 * s * sin]);
            Patch::new(&[&ends]).content()
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
        Ladder::new("body moved", "distance [sizes]", moved, |moved| {
            Patch { moved, ..patch() }.content()
        }),
        Ladder::new(
            "mesh twisted",
            "angle at the centre [degrees]",
            twists,
            |twist| Patch { twist, ..patch() }.content(),
        ),
        Ladder::new("unit of length", "factor [-]", every(-12, 12, 3), |unit| {
            Patch { unit, ..patch() }.content()
        }),
        Ladder::new("unit of stress", "E [Pa]", every(-24, 24, 4), |young| {
            Patch { young, ..patch() }.content()
        }),
    ]
}

/// A plate of 4 × 3 whose bottom is held, its top pushed and sheared: a crack inside slips in part, a second one at its side.
#[derive(Clone)]
struct Sheared {
    poisson: f64,
    friction: f64,
    cells: [usize; 2],
    height: f64,
    shear: f64,
    /// `history` of the shear and `[path]`.
    path: String,
    method: Option<String>,
}

impl Default for Sheared {
    fn default() -> Self {
        Sheared {
            poisson: 0.3,
            friction: 0.3,
            cells: [33, 25],
            height: 3.0,
            shear: 6e-4,
            path: String::new(),
            method: None,
        }
    }
}

impl Sheared {
    fn text(&self) -> String {
        let (h, mu) = (self.height, self.friction);
        let (history, path) = self.path.split_once('|').unwrap_or(("", ""));
        let cells = self.cells;
        format!(
            "title = \"ladder\"\nmodel = \"plane-strain\"\ntolerance = 1e-12\n\
             [material]\nyoung_pa = 1e10\npoisson = {:?}\n\
             [mesh.box]\nmin_m = [0.0, 0.0]\nmax_m = [4.0, {h:?}]\ncells = {cells:?}\n\
             [[crack]]\npoints_m = [[0.61, {:?}], [2.53, {:?}]]\nfriction = {mu:?}\n\
             [[crack]]\npoints_m = [[3.0, {:?}], [4.5, {:?}]]\nfriction = {mu:?}\n\
             [[support]]\non = \"bottom\"\ndisplacement_m = [0.0, 0.0]\n\
             [[support]]\non = \"top\"\ndisplacement_m = [\"free\", {:?}]\n\
             [[support]]\non = \"top\"\ndisplacement_m = [{:?}, \"free\"]\n{history}{path}",
            self.poisson,
            0.31 * h,
            0.62 * h,
            0.56 * h,
            0.43 * h,
            -1e-3 * h,
            self.shear * h,
        )
    }

    fn content(&self, truth: Truth) -> Content {
        Content {
            text: self.text(),
            dim: 2,
            truth,
            method: self.method.clone(),
        }
    }
}

/// Bodies that slip: material, friction, load, mesh and load path.
fn slips() -> Vec<Ladder> {
    let base = Sheared::default();
    let energy = |scene: Sheared| scene.content(Truth::Energy);
    let ratios = [0.0, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.49999, 0.499999];
    let frictions = [0.0].into_iter().chain(decades(-6, 10));
    let cells = [5.0, 10.0, 20.0, 40.0, 80.0];
    let path = |history: &[[f64; 2]], end: f64, increments: f64| {
        format!("history = {history:?}\n|[path]\nincrements = {increments}\nend = {end:?}\n")
    };
    vec![
        Ladder::new("Poisson's ratio", "ν [-]", ratios, |poisson| {
            energy(Sheared {
                poisson,
                ..base.clone()
            })
        }),
        Ladder::new("friction", "μ [-]", frictions, |friction| {
            energy(Sheared {
                friction,
                ..base.clone()
            })
        }),
        Ladder::new(
            "load",
            "relative change of the shear [-]",
            decades(-2, -14),
            |v| {
                let changed = Sheared {
                    shear: base.shear * (1.0 + v),
                    ..base.clone()
                };
                changed.content(Truth::Case(base.text()))
            },
        ),
        Ladder::new("slender cells", "height/width [-]", decades(-3, 3), |v| {
            energy(Sheared {
                height: 3.0 * v,
                ..base.clone()
            })
        }),
        Ladder::new("finer mesh", "cells along x [-]", cells, |n| {
            let cells = [n as usize, (0.75 * n).round() as usize];
            energy(Sheared {
                cells,
                ..base.clone()
            })
        }),
        Ladder::new(
            "increments",
            "to the same load [-]",
            [1.0, 2.0, 5.0, 10.0, 100.0],
            |n| {
                let path = path(&[[0.0, 0.0], [1.0, 1.0]], 1.0, n);
                energy(Sheared {
                    path,
                    ..base.clone()
                })
            },
        ),
        Ladder::new(
            "cycles",
            "of the shear, 8 increments each [-]",
            [1.0, 2.0, 4.0, 8.0],
            |n| {
                let turns = (0..2 * n as usize).map(|k| [1.0 + 2.0 * k as f64, [1.0, -1.0][k % 2]]);
                let history: Vec<[f64; 2]> = [[0.0, 0.0]].into_iter().chain(turns).collect();
                let path = path(&history, 4.0 * n, 8.0 * n);
                energy(Sheared {
                    path,
                    ..base.clone()
                })
            },
        ),
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
        for (a, [low, high]) in super::uniform::sides(3).iter().enumerate() {
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
        Content {
            text,
            dim: 3,
            truth: Truth::Uniform,
            method: None,
        }
    };
    let plane = |point: [f64; 3], n: [f64; 3]| {
        format!("[crack.plane]\npoint_m = {point:?}\nnormal = {n:?}\n")
    };
    let sided: Vec<f64> = from_both_sides().into_iter().skip(1).step_by(2).collect();
    vec![
        Ladder::new(
            "plane along a layer of nodes",
            "distance to it [cells]",
            sided.clone(),
            |d| text(&plane([1.5, 1.5, 1.0 + d], [0.0, 0.0, 1.0]), 0.0),
        ),
        Ladder::new(
            "plane through a node",
            "distance to it [cells]",
            sided,
            |d| text(&plane([1.0, 1.0, 1.0 + d], [0.31, 0.17, 0.93]), 0.0),
        ),
        Ladder::new(
            "solid moved",
            "distance [sizes]",
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

/// Every parameter of every method but its limits of iterations, from a 10 000th to 10 000 times its default, as far as it is
/// allowed.
fn options() -> Vec<Ladder> {
    let mut all = Vec::new();
    for method in methods() {
        for option in method.options {
            let (default, least, most) = match option {
                OptionSpec::Real(o) => (o.default, o.min, o.max),
                OptionSpec::Whole(o) if !o.name.starts_with("max") => {
                    (o.default as f64, o.min as f64, o.max as f64)
                }
                _ => continue,
            };
            let whole = matches!(option, OptionSpec::Whole(_));
            // Nothing is a multiple of nothing.
            let of = if default == 0.0 { 1.0 } else { default };
            let values = decades(-4, 4).into_iter().map(|factor| of * factor);
            let values =
                values.filter(|v| (least..=most).contains(v) && (!whole || v.fract() == 0.0));
            let name = format!("{} {}", method.name, option.name());
            let mut ladder = Ladder::new(&name, "value [-]", values, |value| {
                let own = format!("{}:{}={value}", method.name, option.name());
                let scene = Sheared {
                    method: Some(own),
                    ..Sheared::default()
                };
                scene.content(Truth::Energy)
            });
            ladder.method = Some(method.name);
            if ladder.rungs.len() > 1 {
                all.push(ladder);
            }
        }
    }
    all
}
