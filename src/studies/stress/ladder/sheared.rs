//! Ladders of a sheared plate whose cracks slip: its material, friction, load, mesh and path, and the options of methods on it.

use stickslip_methods::OptionSpec;

use super::rung::{Content, Ladder, decades};
use crate::run::registry::methods;
use crate::studies::stress::truth::Truth;

/// A plate of 4 × 3 whose bottom is held, its top pushed and sheared: a crack inside slips in part, a second one at its side.
#[derive(Clone)]
struct Sheared {
    poisson: f64,
    friction: f64,
    cells: [usize; 2],
    height: f64,
    shear: f64,
    path: Option<Path>,
    method: Option<String>,
}

/// A load path: the last support has the history.
#[derive(Clone)]
struct Path {
    history: Vec<[f64; 2]>,
    end: f64,
    increments: f64,
}

impl Path {
    /// Goes on in the table of that support.
    fn text(&self) -> String {
        let Path {
            history,
            end,
            increments,
        } = self;
        format!("history = {history:?}\n[path]\nincrements = {increments}\nend = {end:?}\n")
    }
}

impl Default for Sheared {
    fn default() -> Self {
        Sheared {
            poisson: 0.3,
            friction: 0.3,
            cells: [33, 25],
            height: 3.0,
            shear: 6e-4,
            path: None,
            method: None,
        }
    }
}

impl Sheared {
    fn text(&self) -> String {
        let (h, mu) = (self.height, self.friction);
        let cells = self.cells;
        let path = self.path.as_ref().map_or_else(String::new, Path::text);
        format!(
            "title = \"ladder\"\nmodel = \"plane-strain\"\ntolerance = 1e-12\n\
             [material]\nyoung_pa = 1e10\npoisson = {:?}\n\
             [mesh.box]\nmin_m = [0.0, 0.0]\nmax_m = [4.0, {h:?}]\ncells = {cells:?}\n\
             [[crack]]\npoints_m = [[0.61, {:?}], [2.53, {:?}]]\nfriction = {mu:?}\n\
             [[crack]]\npoints_m = [[3.0, {:?}], [4.5, {:?}]]\nfriction = {mu:?}\n\
             [[support]]\non = \"bottom\"\ndisplacement_m = [0.0, 0.0]\n\
             [[support]]\non = \"top\"\ndisplacement_m = [\"free\", {:?}]\n\
             [[support]]\non = \"top\"\ndisplacement_m = [{:?}, \"free\"]\n{path}",
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
pub fn slips() -> Vec<Ladder> {
    let base = Sheared::default();
    let energy = |scene: Sheared| scene.content(Truth::Energy);
    let ratios = [0.0, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.49999, 0.499999];
    let frictions = [0.0].into_iter().chain(decades(-6, 10));
    let cells = [5.0, 10.0, 20.0, 40.0, 80.0];
    let path = |history: &[[f64; 2]], end: f64, increments: f64| {
        let history = history.to_vec();
        Some(Path {
            history,
            end,
            increments,
        })
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

/// Every parameter of every method but its limits of iterations, from a 10 000th to 10 000 times its default, as far as it is
/// allowed.
pub fn options() -> Vec<Ladder> {
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
            ladder.option = Some((method.name, option.name()));
            if ladder.rungs.len() > 1 {
                all.push(ladder);
            }
        }
    }
    all
}
