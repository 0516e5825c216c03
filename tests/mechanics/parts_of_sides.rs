//! Loads and supports on parts of sides: facets cut by the bounds of a region, lips of cracks, displacements that vary.

use crate::common::*;
use stickslip::case::Case;
use stickslip::model::body::{Body, Needs};
use stickslip::model::extent::{load_extents, support_extents};

fn bodies(text: &str) -> (Case, Body) {
    let case = parse(text);
    let body = Body::new(&case, 1, &Needs::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    (case, body)
}

/// A crack in the default contact space.
fn star(crack: String) -> String {
    crack.replace("contact = \"edge-pairs\"\n", "")
}

/// External forces of some loads on a body, over all unknowns.
fn forces(body: &str, loads: &str) -> Vec<f64> {
    let (case, body) = bodies(&(body.to_owned() + loads));
    loading(&body, &case).external_force(1)
}

fn on(side: &str, condition: &str, what: &str) -> String {
    format!("[[load]]\non = \"{side}\"\nwhere = {condition}\n{what}\n")
}

fn held(side: &str, condition: &str, displacement: &str) -> String {
    format!(
        "[[support]]\non = \"{side}\"\nwhere = \"{condition}\"\ndisplacement_m = {displacement}\n"
    )
}

/// Goal: a load on two parts of a side is the load on the whole, for every function on it, wherever they meet; overlaps and
/// bounds that lie on grid lines to a billionth of a cell change nothing. Plane and solid, cut facets, tips beside the side.
/// Tolerance: rounding; beside tips the 1e-9 and 1e-5 of the rules on edges and faces.
#[test]
fn loads_on_parts_of_a_side_add_up_to_that_on_the_whole() {
    let flat = |tip| {
        let rest = crack([0.31, 1.2], [0.47, 0.72], 0.3, tip) + &support("\"bottom\"", "[0, 0]");
        plane([0.0, 0.0], [1.0, 1.0], [7, 7], &rest)
    };
    let planes = [([0.5, 0.45, 0.5], [1.0, 0.3, 0.2], 0.3)];
    let solid = solid(
        [1.0, 1.0, 1.0],
        [3, 4, 3],
        &planes,
        &support("\"bottom\"", "[0, 0, 0]"),
    );
    let disc = "title = \"t\"\nmodel = \"solid\"\nmaterial = { young_pa = 1, poisson = 0.3 }\n\
                mesh = { box = { min_m = [0, 0, 0], max_m = [1, 1, 1], cells = [5, 5, 5] } }\n\
                [[crack]]\ndisc = { centre_m = [0.5, 0.5, 1], normal = [1, 0.2, 0.1], radius_m = 0.33 }\nfriction = 0\n"
        .to_owned()
        + &support("\"bottom\"", "[0, 0, 0]");
    for (body, what, tolerance) in [
        (flat("none"), "traction_pa = [2, \"1 - 3 x + x^2\"]", 1e-14),
        (flat("branch"), "traction_pa = [2, \"1 - 3 x + x^2\"]", 1e-9),
        (solid, "pressure_pa = \"2 - x + 3 x*y\"", 1e-14),
        (disc, "pressure_pa = \"2 - x + 3 x*y\"", 1e-5),
    ] {
        let whole = forces(&body, &format!("[[load]]\non = \"top\"\n{what}\n"));
        let size = whole.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        for [one, other] in [
            ["\"x <= 0.4\"", "\"x > 0.4\""],
            [
                "\"x <= 0.123 or x >= 0.457 and x <= 0.9\"",
                "[\"x >= 0.9\", \"x >= 0.123 and x <= 0.457\"]",
            ],
            ["\"x >= 0.3999999999\"", "\"x < 0.3999999999\""],
            [
                "[\"x <= 0.37\", \"x >= 0.1 and x <= 0.37\", \"x == 0.7\"]",
                "\"x >= 0.37\"",
            ],
        ] {
            let parts = forces(&body, &(on("top", one, what) + &on("top", other, what)));
            for (whole, parts) in whole.iter().zip(&parts) {
                let off = (whole - parts).abs() / size;
                assert!(off < tolerance, "{one} {off:e}\n{body}");
            }
        }
    }
}

/// Source: Code_Aster, test SSNV510: blocks between frictionless cracks under pressures of their own, stress uniform in each,
/// energy 2.6e7 J/m. Goal: exact where the pressures change within cells, on every mesh. Tolerance: rounding.
#[test]
fn blocks_under_pressures_of_their_own_have_the_energy_of_their_stresses() {
    for cells in [[3, 10], [2, 7], [4, 13]] {
        let mut rest = String::new();
        for y in [0.5, 1.5, 2.5, 3.5] {
            rest += &star(crack([-1.0, y], [3.0, y], 0.0, "none"));
        }
        rest += &(support("\"bottom\"", "[\"free\", 0]") + &support("\"right\"", "[0, \"free\"]"));
        for k in 1..5 {
            let (low, high) = (k as f64 - 0.5, k as f64 + 0.5);
            let pressure = format!("pressure_pa = {k}e7");
            rest += &on(
                "left",
                &format!("\"y >= {low} and y <= {high}\""),
                &pressure,
            );
        }
        rest += &load("top", "pressure_pa = 1e7");
        let text = plane([0.0, 0.0], [2.0, 4.0], cells, &rest)
            .replace("plane-strain", "plane-stress")
            .replace("young_pa = 1,", "young_pa = 1e8,")
            .replace("poisson = 0.3", "poisson = 0");
        let found = solve(&text);
        let half = 0.5 * work(&found);
        assert!(
            (half / exact_energy() - 1.0).abs() < 1e-10,
            "{cells:?}: {half}"
        );
    }
}

/// ½ Σ σ²/E over the blocks: pressures 0, 1, 2, 3, 4 on heights ½, 1, 1, 1, ½ and 1 from above, 2 m wide.
fn exact_energy() -> f64 {
    let blocks = [(0.0, 0.5), (1.0, 1.0), (2.0, 1.0), (3.0, 1.0), (4.0, 0.5)];
    let sum: f64 = blocks.iter().map(|(p, h)| (p * p + 1.0) * h).sum();
    0.5 * 1e14 / 1e8 * 2.0 * sum
}

fn work(found: &Solved) -> f64 {
    let inner = found.body.stiffness.mul(&found.u);
    inner.iter().zip(&found.u).map(|(f, u)| f * u).sum()
}

/// u = (−1e-4 x, −2e-4 y) on all sides: polynomials, and node by node.
fn outline(cells: usize, nodes: bool) -> String {
    let sides = ["bottom", "top", "left", "right"];
    if !nodes {
        let all = sides.map(|s| support(&format!("\"{s}\""), "[\"-1e-4 x\", \"-2e-4 y\"]"));
        return all.concat();
    }
    let mut text = String::new();
    for side in sides {
        for i in 0..=cells {
            let s = i as f64 / cells as f64;
            let (axis, x) = match side {
                "bottom" => ("x", [s, 0.0]),
                "top" => ("x", [s, 1.0]),
                "left" => ("y", [0.0, s]),
                _ => ("y", [1.0, s]),
            };
            let u = format!("[{}, {}]", -1e-4 * x[0], -2e-4 * x[1]);
            text += &held(side, &format!("{axis} == {s}"), &u);
        }
    }
    text
}

/// Source: uniform strain −1e-4, −2e-4 that friction 1 sticks to everywhere. Goal: with all sides held, by polynomials or node
/// by node, the crack carries its uniform traction up to its mouth, whether that lies between nodes or at one.
/// Tolerance 1e-9: the method ends in rounding.
#[test]
fn a_crack_mouth_on_held_sides_carries_the_uniform_stress() {
    for (p, q, tip) in [
        ([0.4958, 0.0], [0.4437, 0.8312], "none"),
        ([0.4958, -0.1], [0.4437, 0.8312], "auto"),
        ([0.5, 0.0], [0.53, 1.0], "none"),
        ([-0.2, 0.41], [1.2, 0.59], "none"),
    ] {
        for nodes in [false, true] {
            let rest = star(crack(p, q, 1.0, tip)) + &outline(8, nodes);
            let found = solve(&plane([0.0, 0.0], [1.0, 1.0], [8, 8], &rest));
            let uniform = |x: &[f64; 3]| [-1e-4 * x[0], -2e-4 * x[1], 0.0];
            assert!(found.displacement_error(uniform) < 1e-15, "{p:?} {nodes}");
            let traction = found.traction(0);
            assert!(!traction.is_empty());
            for t in &traction {
                assert!(
                    (t / traction[0] - 1.0).abs() < 1e-9,
                    "{p:?} {nodes}: {traction:?}"
                );
            }
        }
    }
}

/// A frictionless crack through the body that leaves on the left at y = 5; the top goes up by 1e-3, the bottom stays.
fn opened(rows: usize, rest: &str) -> String {
    let rest = crack([-1.0, 4.9], [6.0, 5.6], 0.0, "none")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[\"free\", 1e-3]")
        + rest;
    plane([0.0, 0.0], [5.0, 10.0], [5, rows], &rest)
}

/// Source: rigid motion of the upper half. Goal: a support on part of a side holds the lips that lie beside it and no others,
/// at a node (10 rows) and between nodes (11): the halves move apart without strain. Tolerance: rounding.
#[test]
fn supports_hold_the_lip_beside_them_only() {
    let upper = held("left", "y >= 5", "[1e-3, \"free\"]");
    let lower = held("left", "y <= 5", "[0, 0]");
    let corner = held("left", "y == 5", "[1e-3, 1e-3]");
    for rows in [10, 11] {
        let variants = [
            upper.clone(),
            upper.clone() + &lower,
            lower.clone() + &upper,
            // Touches the lip without a facet of its own.
            held("left", "y >= 5 and y <= 5.1 or y > 9", "[1e-3, \"free\"]"),
            if rows == 10 {
                corner.clone() + "crack_side = 1\n"
            } else {
                upper.clone()
            },
        ];
        for text in variants {
            let found = solve(&opened(rows, &text));
            let energy = work(&found);
            assert!(energy.abs() < 1e-20, "{rows} {energy:e}\n{text}");
            let jump = found.jump.chunks_exact(2);
            for (jump, point) in jump.zip(&found.body.points) {
                let normal: f64 = 1e-3 * (point.frame[0][0] + point.frame[0][1]);
                assert!((jump[0] - normal).abs() < 1e-15, "{rows} {jump:?}\n{text}");
            }
        }
    }
    // The other lip cannot follow.
    let found = solve(&opened(10, &(corner + "crack_side = 2\n" + &upper)));
    assert!(work(&found) > 1e-8);
}

/// Goal: supports on both lips of a node carry what acts on their lip: the forces of all supports balance the load.
#[test]
fn supports_on_both_lips_carry_their_own() {
    let text = opened(
        10,
        &(held("left", "y >= 5", "[1e-3, \"free\"]") + &held("left", "y <= 5", "[2e-3, 0]")),
    ) + &load("right", "traction_pa = [\"3e-4 - 2e-5 y\", 0]");
    let results = run(&parse(&text), &[METHOD]);
    let rows = results.quantities();
    let reactions = rows.iter().filter(|r| r.quantity.name == "reaction");
    let x = reactions.filter(|r| r.quantity.component == "x");
    let sum: f64 = x.map(|r| r.quantity.value).sum();
    // ∫ 3e-4 − 2e-5 y over 0..10.
    assert!((sum + 2e-3).abs() < 1e-14, "{sum:e}");
}

/// Goal: `check` can tell what acts: resultants over the part of the side, held nodes and lengths, in the plane and a solid.
#[test]
fn extents_are_those_of_the_regions() {
    let rest = crack([0.3, 0.4], [0.7, 0.6], 0.3, "auto")
        + &held("bottom", "x <= 0.6", "[0, 0]")
        + &on(
            "top",
            "\"x >= 0.3 and x <= 0.63\"",
            "traction_pa = [0, -1e6]",
        )
        + "[[load]]\nbody_n_per_m3 = [1, 2]\n";
    let (case, body) = bodies(&plane([0.0, 0.0], [1.0, 1.0], [37, 37], &rest));
    let loads = load_extents(&case, &loading(&body, &case)).unwrap();
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs().max(1.0);
    assert!(close(loads[0].force[1], -330_000.0) && loads[0].force[0] == 0.0);
    assert!(close(loads[0].measure, 0.33) && loads[0].power == 1);
    assert!(close(loads[1].measure, 1.0) && close(loads[1].force[1], 2.0));
    let support = &support_extents(&case, &body)[0];
    // 22 cells of 1/37 m fit into 0.6 m.
    assert_eq!((support.nodes, support.power), (23, 1));
    assert!(close(support.measure, 22.0 / 37.0) && close(support.ends[1][0], 22.0 / 37.0));
    let planes = [([0.5, 0.5, 0.55], [0.6, 0.2, 1.0], 0.3)];
    let rest = support_on_edge()
        + &on(
            "top",
            "\"x <= 0.4 and y >= 0.7\"",
            "pressure_pa = \"1 + z\"",
        )
        + "[[load]]\non = [\"right\", \"back\"]\nwhere = \"z >= 0.9\"\nline_n_per_m = [1, 0, 0]\n"
        + &clamped(3);
    let (case, body) = bodies(&solid([1.0, 1.0, 1.0], [3, 3, 3], &planes, &rest));
    let loads = load_extents(&case, &loading(&body, &case)).unwrap();
    assert!(close(loads[0].force[2], -0.24) && close(loads[0].measure, 0.12));
    assert!(close(loads[1].force[0], 0.1) && close(loads[1].measure, 0.1));
    let supports = support_extents(&case, &body);
    assert!(close(supports[0].measure, 2.0 / 3.0) && supports[0].power == 1);
    assert_eq!(supports[0].nodes, 3);
}

fn support_on_edge() -> String {
    "[[support]]\non = [\"left\", \"top\"]\nwhere = \"y <= 0.7\"\ndisplacement_m = [0, 0, 0]\n"
        .into()
}
