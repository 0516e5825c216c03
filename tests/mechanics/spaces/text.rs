//! Pieces of the case files of patch tests.

use std::fmt::Write;

use crate::common::{load, support};
use stickslip_xfem::geometry::Point;

use super::catalogue::{Loaded, State};

/// Pressure, or size of a stress [Pa].
pub const PRESSURE: f64 = 1e6;

/// Young's modulus [Pa].
pub const YOUNG: f64 = 1e10;

/// Poisson's ratio.
pub const POISSON: f64 = 0.3;

/// Model, material and mesh.
pub fn head(model: &str, mesh: &str) -> String {
    format!(
        "title = \"Patch test\"\nmodel = \"{model}\"\ntolerance = 1e-13\n\
         material = {{ young_pa = {YOUNG:e}, poisson = {POISSON:?} }}\n{mesh}"
    )
}

/// A crack through given points, as TOML.
pub fn chain(points: &[Point], friction: f64) -> String {
    let points: Vec<[f64; 2]> = points.iter().map(|x| [x[0], x[1]]).collect();
    format!("[[crack]]\npoints_m = {points:?}\nfriction = {friction:?}\ntip = \"none\"\n")
}

pub fn uniform(stress: &[(&str, f64)]) -> String {
    let mut text = "[exact]\nsolution = \"uniform-stress\"\n".to_owned();
    for (component, value) in stress {
        writeln!(text, "stress_{component}_pa = {value:e}").unwrap();
    }
    text
}

/// The opening of an open crack beside its stress.
pub fn parted(state: State) -> String {
    /// δ [m]: of the size of the displacements.
    const OPENING: f64 = 1e-4;
    match state {
        State::Open => format!("opening_m = {OPENING:e}\n"),
        _ => String::new(),
    }
}

/// Supports and loads of uniform stress; `free_to_slide`: the crack bears no shear, so the supports must.
pub fn boundary(dim: usize, loaded: Loaded, free_to_slide: bool) -> String {
    let sides: &[&str] = if dim == 2 {
        &["left", "bottom", "right", "top"]
    } else {
        &["left", "front", "bottom", "right", "back", "top"]
    };
    let only = |axes: std::ops::RangeInclusive<usize>| -> String {
        let entry = |axis| {
            if axes.contains(&axis) {
                "\"exact\""
            } else {
                "\"free\""
            }
        };
        format!("[{}]", (0..dim).map(entry).collect::<Vec<_>>().join(", "))
    };
    let push = |side: &&str| load(side, "traction_pa = \"exact\"");
    match (loaded, free_to_slide) {
        (Loaded::Displacement, _) => sides
            .iter()
            .map(|side| support(&format!("\"{side}\""), "\"exact\""))
            .collect(),
        (Loaded::Traction, true) => {
            // Every axis along which a piece may slide needs a roller that the piece touches.
            let held: &[(usize, &str)] = if dim == 2 {
                &[(0, "left"), (1, "bottom")]
            } else {
                &[(0, "left"), (0, "right"), (1, "front"), (2, "bottom")]
            };
            let rollers = held
                .iter()
                .map(|&(axis, side)| support(&format!("\"{side}\""), &only(axis..=axis)));
            let free = |side: &&&str| !held.iter().any(|h| h.1 == **side);
            rollers.chain(sides.iter().filter(free).map(push)).collect()
        }
        (Loaded::Traction, false) => {
            // Three points hold the body; every piece must touch a support, so a fourth one repeats the closed form.
            // Where the crack leaves through such a corner they hold side 1.
            let corner = |on: &str, axes| support(on, &only(axes)) + "crack_side = 1\n";
            let points = if dim == 2 {
                corner("[\"left\", \"bottom\"]", 0..=1)
                    + &corner("[\"right\", \"bottom\"]", 1..=1)
                    + &corner("[\"left\", \"top\"]", 0..=0)
            } else {
                corner("[\"left\", \"front\", \"bottom\"]", 0..=2)
                    + &corner("[\"right\", \"front\", \"bottom\"]", 1..=2)
                    + &corner("[\"left\", \"back\", \"bottom\"]", 2..=2)
                    + &corner("[\"right\", \"back\", \"top\"]", 0..=0)
            };
            sides.iter().map(push).chain([points]).collect()
        }
    }
}
