//! The shipped cases against their sources.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use stickslip::case::{self, Case, CrackShape, Expect, ExpectKind, Tolerance};

fn case_dir() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases")
}

fn shipped() -> BTreeMap<String, Case> {
    let mut cases = BTreeMap::new();
    for entry in fs::read_dir(case_dir()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let case = case::read(&path).unwrap_or_else(|e| panic!("{e}"));
            cases.insert(case.name.clone(), case);
        }
    }
    cases
}

#[test]
fn every_shipped_case_is_accepted() {
    #[rustfmt::skip]
    let names = [
        "beam_model1", "beam_model1_gauss6", "beam_model2", "circular_interface", "closing_crack", "cyclic",
        "elliptic_crack", "frictionless", "inclined_crack", "manufactured_slip", "manufactured_slip_3d",
        "manufactured_slip_rotated", "open_crack", "partial_opening", "partial_slip", "partial_slip_cycle",
        "partial_slip_shakedown", "penny_crack", "plate_mesh1", "plate_mesh2", "sliding_block_conforming",
        "sliding_block_cycle", "sliding_block_cycle_conforming", "sliding_block_embedded", "sliding_block_off_grid",
        "sliding_block_star", "sloped_patch", "tension_open",
    ];
    let shipped = shipped();
    for name in names {
        assert!(shipped.contains_key(name), "{name} is missing");
    }
}

#[test]
fn boxes_symmetric_about_zero_have_symmetric_grid_lines() {
    for case in shipped().into_values() {
        let lines = case.mesh.grid.lines.iter();
        for line in lines.filter(|l| l[0] == -l[l.len() - 1]) {
            let mirrored: Vec<f64> = line.iter().rev().map(|x| -x).collect();
            assert_eq!(line, &mirrored, "{}", case.name);
        }
    }
}

#[test]
fn refinement_keeps_the_given_grid_lines_to_the_bit() {
    for case in shipped().into_values() {
        for factor in [1, 2, 3, 7] {
            let fine = case.mesh.grid.refined(factor);
            for (coarse, fine) in case.mesh.grid.lines.iter().zip(&fine.lines) {
                assert_eq!(fine.len(), (coarse.len() - 1) * factor + 1);
                let kept: Vec<f64> = fine.iter().copied().step_by(factor).collect();
                assert_eq!(&kept, coarse);
                assert!(fine.windows(2).all(|w| w[0] < w[1]));
                let width = |w: &[f64]| w[1] - w[0];
                for (i, w) in fine.windows(2).enumerate() {
                    let whole = width(&coarse[i / factor..i / factor + 2]);
                    assert!((width(w) * factor as f64 - whole).abs() <= 1e-12 * whole.max(1.0));
                }
            }
        }
    }
}

/// Expected value of a quantity.
fn expected(
    case: &Case,
    quantity: &str,
    component: &str,
    friction: Option<f64>,
    increment: Option<usize>,
) -> f64 {
    let found: Vec<&Expect> = case
        .expects
        .iter()
        .filter(|e| e.quantity == quantity && e.component == component)
        .filter(|e| e.friction == friction && e.increment == increment)
        .collect();
    assert_eq!(
        found.len(),
        1,
        "{} {quantity} {component} {friction:?} {increment:?}",
        case.name
    );
    found[0].value
}

fn assert_close(found: f64, wanted: f64, name: &str) {
    // The files carry 17 digits; the formulas lose two or three to cancellation.
    assert!(
        (found - wanted).abs() <= 1e-13 * wanted.abs(),
        "{name}: {found} is not {wanted}"
    );
}

/// State of the confined sliding block: vertical pressure, slip, dissipation since the start.
#[derive(Clone, Copy)]
struct Block {
    pressure: f64,
    slip: f64,
    dissipation: f64,
}

const ANGLE_DEG: f64 = 25.0;
const LATERAL: f64 = 0.01;
const NU: f64 = 0.3;

impl Block {
    fn start() -> Self {
        Block {
            pressure: NU / (1.0 - NU) * LATERAL,
            slip: 0.0,
            dissipation: 0.0,
        }
    }

    /// Coulomb's law on the interface, solved for the unknown of each of its three branches.
    fn pushed(self, by: f64, friction: f64) -> Self {
        let (sin, cos) = ANGLE_DEG.to_radians().sin_cos();
        let modulus = 1.0 / (1.0 - NU * NU);
        let stick = self.pressure + modulus * by;
        // t(s) = (s - q) sin cos and n(s) = s cos² + q sin²; |t| = mu n at the two limits.
        let forward = LATERAL * sin * (cos + friction * sin) / (cos * (sin - friction * cos));
        let reverse = LATERAL * sin * (cos - friction * sin) / (cos * (sin + friction * cos));
        let never = sin <= friction * cos;
        let pressure = if stick > forward && !never {
            forward
        } else {
            stick.max(reverse)
        };
        let slip = (by - (pressure - self.pressure) / modulus) / sin;
        let slip = if pressure == stick { 0.0 } else { slip };
        Block {
            pressure,
            slip: self.slip + slip,
            dissipation: self.dissipation + (pressure - LATERAL) * sin * slip,
        }
    }
}

#[test]
fn sliding_block_expectations_are_the_closed_form() {
    let (sin, cos) = ANGLE_DEG.to_radians().sin_cos();
    for name in [
        "sliding_block_conforming",
        "sliding_block_embedded",
        "sliding_block_star",
    ] {
        let case = &shipped()[name];
        for &friction in &case.sweep.friction {
            let block = Block::start().pushed(0.06, friction);
            let value =
                |quantity, component| expected(case, quantity, component, Some(friction), None);
            assert_close(value("reaction", "y"), -block.pressure, "reaction");
            let normal = (block.pressure * cos * cos + LATERAL * sin * sin) / cos;
            assert_close(value("contact_force", "n"), normal, "normal force");
            let along = (block.pressure - LATERAL) * sin;
            assert_close(value("contact_force", "a"), along, "friction force");
            assert!(along <= friction * normal * (1.0 + 1e-13));
            assert_close(
                value("displacement", "x"),
                -block.slip * cos,
                "displacement",
            );
            assert_close(value("dissipation", ""), block.dissipation, "dissipation");
            // Work of the top and lateral forces up to the end of the one increment, by Hooke's law.
            let (s, q, r) = (block.pressure, LATERAL, NU / (1.0 - NU));
            let energy = (s * s + q * q - 2.0 * r * s * q) * (1.0 - NU * NU) / 2.0;
            assert_close(value("strain_energy", ""), energy, "strain energy");
        }
        assert!(expected(case, "displacement", "x", Some(0.2), None) < -0.09);
        assert_eq!(expected(case, "displacement", "x", Some(0.5), None), 0.0);
    }
}

#[test]
fn sliding_block_cycle_expectations_are_the_closed_form() {
    for name in ["sliding_block_cycle", "sliding_block_cycle_conforming"] {
        let case = &shipped()[name];
        let support = case.supports.last().unwrap();
        let mut block = Block::start();
        let mut pushed = 0.0;
        for k in 1..=case.path.increments {
            let time = case.path.end * k as f64 / case.path.increments as f64;
            let depth = 0.01 * support.history.factor(time, case.path.end);
            block = block.pushed(depth - pushed, 0.2);
            pushed = depth;
            assert_close(
                expected(case, "reaction", "y", None, Some(k)),
                -block.pressure,
                "reaction",
            );
            if [6, 11, 16].contains(&k) {
                let dissipated = expected(case, "dissipation", "", None, Some(k));
                assert_close(dissipated, block.dissipation, "dissipation");
            }
        }
        let loop_area = expected(case, "dissipation", "", None, Some(16))
            - expected(case, "dissipation", "", None, Some(6));
        assert!((loop_area - 0.00049083688066).abs() < 1e-14, "{loop_area}");
    }
}

/// Rows of a file of printed numbers.
fn printed(file: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(case_dir().join("reference").join(file)).unwrap();
    text.lines()
        .skip(1)
        .map(|l| l.split(',').map(str::to_string).collect())
        .collect()
}

#[test]
fn published_expectations_are_the_printed_numbers() {
    let cases = shipped();
    let mut count = 0;
    // The second mesh of the paper is lost: its numbers are printed beside ours, not expected of them.
    for row in printed("plate_table1.csv")
        .iter()
        .filter(|row| row[0] == "I")
    {
        let case = &cases["plate_mesh1"];
        let friction = row[1].parse().unwrap();
        let found = expected(case, "reaction", "y", Some(friction), None);
        assert_eq!(found, format!("-{}e6", row[2]).parse::<f64>().unwrap());
        count += 1;
    }
    for row in printed("beam_table2.csv") {
        let first = row[0] == "I";
        let case = &cases[if first {
            "beam_model1_gauss6"
        } else {
            "beam_model2"
        }];
        for (i, number) in row[2..].iter().enumerate() {
            let at = format!("P{}", i + 1);
            let found: Vec<&Expect> = case
                .expects
                .iter()
                .filter(|e| e.at == at && e.component == row[1] && e.friction == Some(0.0))
                .collect();
            assert_eq!(found.len(), 1);
            assert_eq!(
                found[0].value,
                format!("{number}e-3").parse::<f64>().unwrap()
            );
            assert_eq!(found[0].tolerance, Tolerance::Absolute(1e-9));
            count += 1;
        }
    }
    assert_eq!(count, 3 + 42);
    let published = cases
        .values()
        .flat_map(|c| &c.expects)
        .filter(|e| e.kind == ExpectKind::Published);
    assert_eq!(published.count(), count);
}

#[test]
fn cracks_of_the_sliding_blocks_lie_on_the_followed_line() {
    for (name, case) in shipped()
        .iter()
        .filter(|(name, _)| name.starts_with("sliding_block"))
    {
        let Some(follow) = case.mesh.grid.follow.as_ref() else {
            assert!(["sliding_block_off_grid", "sliding_block_star"].contains(&name.as_str()));
            continue;
        };
        let CrackShape::Polyline(ends) = &case.cracks[0].geometry else {
            panic!("{name}")
        };
        for end in ends {
            let height = follow.point[1] + (end[0] - follow.point[0]) * follow.angle.tan();
            assert!((end[1] - height).abs() < 1e-15, "{name}");
            assert!(
                !(0.0..=1.0).contains(&end[0]),
                "{name}: the crack leaves the block"
            );
        }
        let conforming = case.mesh.grid.lines[1].contains(&follow.point[1]);
        assert_eq!(conforming, name.contains("conforming"), "{name}");
    }
}
