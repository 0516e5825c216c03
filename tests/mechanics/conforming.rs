//! A crack through cells against the same crack on cell edges: with exact sub-cells one discrete problem, two codes.
//!
//! A cell cut parallel to its edges carries on each side the linear functions of that side, four coefficients each: the
//! functions of the half cell. So reactions, jumps and contact forces agree to rounding.

use crate::common::*;

/// Equal to rounding times the conditioning of a few hundred unknowns.
const EQUAL: f64 = 1e-10;

fn assert_equal(cut: &Solved, conforming: &Solved, sides: &[&str]) {
    assert_eq!(cut.body.space, "edge-pairs");
    assert_eq!(conforming.body.space, "node-pairs");
    assert_eq!(cut.body.points.len(), conforming.body.points.len());
    for (a, b) in cut.body.points.iter().zip(&conforming.body.points) {
        assert!((0..3).all(|i| (a.x[i] - b.x[i]).abs() < 1e-12));
        assert!((a.weight - b.weight).abs() < 1e-12 && a.crack == b.crack);
    }
    let forces = relative_difference(cut.p(), conforming.p());
    assert!(forces < EQUAL, "forces {forces:e}");
    let jumps = relative_difference(&cut.jump, &conforming.jump);
    assert!(jumps < EQUAL, "jumps {jumps:e}");
    let dim = cut.body.mesh.dim();
    for side in sides {
        let of = |s: &Solved| (0..dim).map(|a| s.reaction(side, a)).collect::<Vec<_>>();
        let reaction = relative_difference(&of(cut), &of(conforming));
        assert!(reaction < EQUAL, "{side}: {reaction:e}");
    }
}

/// Open, sticking and slipping points in one answer, or the comparison proves little.
fn assert_mixed(found: &Solved) {
    let dim = found.body.mesh.dim();
    let points = found.p().chunks_exact(dim);
    let open = found
        .jump
        .chunks_exact(dim)
        .filter(|jump| jump[0] > 1e-9)
        .count();
    let ratio = |p: &[f64]| p[1..].iter().map(|v| v * v).sum::<f64>().sqrt() / p[0];
    let slip = points
        .clone()
        .filter(|p| p[0] > 1e-12 && ratio(p) > 0.2999)
        .count();
    let all = points.len();
    println!("{open} open, {slip} slip, {all} in all");
    assert!(slip > 0 && open > 0 && open + slip < all);
}

/// A plate on its base, a horizontal crack at mid-row, pushed unevenly: open, sticking and slipping pairs.
///
/// ```text
///   ↓↓↓↓↓    →     pressure on the top, shear on the left
///   ————————       y = 0.3 (held at the right above it)
///   ////////
/// ```
#[test]
fn a_plate_with_a_crack_through_cells_equals_one_with_node_pairs() {
    let held = "[[support]]\non = \"right\"\nwhere = \"y > 0.39 and y < 0.61 or y > 0.99\"\ndisplacement_m = [0, 0]\n";
    let rest = crack([-0.1, 0.3], [1.6, 0.3], 0.3, "none")
        + &support("\"bottom\"", "[0, 0]")
        + held
        + "[[load]]\non = \"top\"\nwhere = \"x >= 0.8\"\ntraction_pa = [2e-4, -1e-3]\n"
        + &load("left", "traction_pa = [2e-4, 1e-4]");
    let text = plane([0.0, 0.0], [1.5, 1.0], [9, 5], &rest);
    let cut = solve(&text);
    let y = [0.0, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0];
    let x: Vec<f64> = (0..=9).map(|i| 1.5 * f64::from(i) / 9.0).collect();
    let mesh = format!("mesh = {{ lines_m = [{x:?}, {y:?}] }}\n");
    let start = text.find("mesh = ").unwrap();
    let end = start + text[start..].find('\n').unwrap() + 1;
    let on_lines = text[..start].to_owned() + &mesh + &text[end..];
    let conforming = solve(&in_space(&on_lines, "node-pairs"));
    assert_mixed(&cut);
    assert_equal(&cut, &conforming, &["bottom", "right"]);
}

/// The same in 3D: two blocks on each other, the upper one pressed and sheared obliquely to the mesh.
#[test]
fn a_stack_of_blocks_cut_through_cells_equals_one_on_faces() {
    let planes = [([0.0, 0.0, 0.5], [0.0, 0.0, 1.0], 0.3)];
    let rest = support("\"bottom\"", "[0, 0, 0]")
        + "[[support]]\non = \"left\"\nwhere = \"z > 0.6\"\ndisplacement_m = [0, 0, \"free\"]\n"
        + "[[load]]\non = \"top\"\nwhere = \"x <= 0.7\"\ntraction_pa = [2e-4, 1e-4, -1e-3]\n"
        + &load("right", "traction_pa = [0, 1e-4, 2e-4]");
    let text = solid([1.2, 0.8, 1.0], [4, 3, 3], &planes, &rest);
    let cut = solve(&text);
    let start = text.find("mesh = ").unwrap();
    let end = start + text[start..].find('\n').unwrap() + 1;
    let third = |n: usize, l: f64| (0..=n).map(|i| l * i as f64 / n as f64).collect::<Vec<_>>();
    let z = [0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0];
    let mesh = format!(
        "mesh = {{ lines_m = [{:?}, {:?}, {z:?}] }}\n",
        third(4, 1.2),
        third(3, 0.8)
    );
    let on_faces = text[..start].to_owned() + &mesh + &text[end..];
    let conforming = solve(&in_space(&on_faces, "node-pairs"));
    assert_mixed(&cut);
    assert_equal(&cut, &conforming, &["bottom", "left"]);
}
