//! Geometries that once gave wrong answers, or none: a tip beside a node or a side, cracks closer than two cells, zones of branch
//! functions that reach too far, arcs, distorted and distant bodies, pieces that contact alone holds.

use std::fs;
use std::path::Path;

use crate::common::*;
use stickslip_xfem::geometry::Point;

/// Every case of the folder, by name.
fn texts() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geometry");
    let files = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut found: Vec<(String, String)> = files
        .map(|path| {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            (name, fs::read_to_string(path).unwrap())
        })
        .collect();
    found.sort();
    found
}

fn text(name: &str) -> String {
    let mut all = texts().into_iter().filter(|(own, _)| own == name);
    all.next().unwrap_or_else(|| panic!("no {name}")).1
}

/// Source: elasticity, uniform stress. Goal: every function of every body is in balance under uniform stress, so that no
/// crack, tip or junction is felt by it. Tolerance: rounding; far from the origin coordinates hold fewer digits.
#[test]
fn uniform_stress_is_in_balance_on_every_mesh() {
    let all = texts();
    assert!(all.len() > 20);
    for (name, text) in all {
        let body = try_body(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
        println!("{name} {:.1e}", body.checks.uniform);
        let suspect = body.suspect(0.0);
        assert!(suspect.is_none(), "{name}: {suspect:?}");
        assert_below(body.checks.uniform, 1e-12, &name);
    }
}

/// Goal: functions that follow their crack around bends on a grid line take the side of what each region borders on. Tolerance: the rule
/// beside bends; a wrong side is off by 0.2.
#[test]
fn functions_follow_bends_on_a_grid_line() {
    let body = body(include_str!("../data/zigzag_on_lines.toml"));
    assert_below(body.checks.uniform, 1e-11, "uniform stress");
}

/// Source: uniaxial strain of a plane body between rollers, σ_yy = −E/(1 − ν²) u/H, σ_xx = 0; both cracks stick. Goal: the
/// pressure on a crack at an angle θ is |σ_yy| cos² θ, the shear |σ_yy| sin θ cos θ, at every contact point: with zones that meet
/// in a cell, with a tip beside a crossing crack, on a crack of 1.4 cells, beside a roller. Tolerance 1e-9.
#[test]
fn sticking_cracks_feel_the_uniform_stress() {
    let stress = 1e10 / (1.0 - 0.09) * 1e-3 / 4.0;
    for name in [
        "two_cracks_in_a_cell_radius",
        "crossing_beside_tip_default",
        "short_crack_default",
        "radius_zone_at_roller",
    ] {
        let found = solve(&text(name));
        let points = &found.body.points;
        assert!(!points.is_empty());
        let on_normal = |n: &Point| stress * n[1] * n[1];
        for (point, p) in points.iter().zip(found.p().chunks(2)) {
            let [n, a, _] = &point.frame;
            let exact = [on_normal(n), stress * n[1] * a[1]];
            for (found, exact) in p.iter().zip(exact) {
                assert_near(
                    found / point.weight / stress,
                    exact / stress,
                    1e-9,
                    (name, point.x),
                );
            }
        }
    }
}

/// Source: code_aster SSNV195: a middle piece that touches no support, pressed by two others; ν = 0, so the stress is
/// −E u/H throughout. Goal: contact and friction alone hold it.
#[test]
fn a_piece_held_by_contact_alone_carries_the_load() {
    let text = text("ssnv195_floating_middle");
    let found = solve(&text);
    assert_eq!(found.body.elastic.floating().len(), 3);
    let total: f64 = found.p().iter().step_by(2).sum();
    let pressed = found.reaction("bottom", 1);
    // Both cracks carry all of it.
    assert_near(total / pressed, 2.0, 1e-9, total);
}

/// Goal: where three cracks meet within a fifth of a cell, but not in one point, a loose piece between them has its rigid motions.
#[test]
fn a_loose_piece_between_three_crossings_in_a_cell_moves_rigidly() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/nearly_one_place.toml");
    let text = fs::read_to_string(path).unwrap();
    let body = try_body(&text).unwrap();
    assert!(!body.elastic.floating().is_empty());
    assert_below(body.checks.uniform, 1e-9, "uniform stress");
}

/// Goal: on an edge, too, a bend carries no pair: its normal would be that of the leg that is read first.
#[test]
fn no_pair_stands_on_a_bend() {
    let crack = "[[crack]]\npoints_m = [[4, 5], [1, 5.47], [1, 4.5]]\ncontact = \"edge-pairs\"\nfriction = 0.3\n";
    let rest = crack.to_owned() + &support("\"bottom\"", "[0, 0]");
    let found = body(&plane([0.0, 0.0], [7.0, 6.0], [7, 6], &rest));
    let places: Vec<[f64; 2]> = found.points.iter().map(|p| [p.x[0], p.x[1]]).collect();
    assert!(
        places.len() > 1 && !places.contains(&[1.0, 5.47]),
        "{places:?}"
    );
}
