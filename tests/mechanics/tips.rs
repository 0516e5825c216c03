//! Cracks that end inside the body: tips anywhere in a cell, on an edge, at a node; opening against the closed form.

use crate::common::*;
use stickslip::model::body::{Body, BodyError};
use stickslip_xfem::enrichment::basis::FunctionKind;

/// A plate 4 × 4 m in 8 × 8 cells under compression and shear, with one crack.
fn sheared(crack: &str) -> String {
    let rest =
        crack.to_owned() + &support("\"bottom\"", "[0, 0]") + &support("\"top\"", "[1e-3, -2e-3]");
    plane([-2.0, -2.0], [2.0, 2.0], [8, 8], &rest)
}

/// Reaction at the top, x and y.
fn answer(text: &str) -> [f64; 2] {
    let found = solve(text);
    [found.reaction("top", 0), found.reaction("top", 1)]
}

fn count(body: &Body, branch: bool) -> usize {
    let functions = body.enrichment.functions.iter();
    functions
        .filter(|f| match f.kind {
            FunctionKind::Standard => false,
            FunctionKind::Heaviside { .. } => !branch,
            FunctionKind::Branch { .. } => branch,
        })
        .count()
}

/// Source: definition of the enrichment. Goal: four branch functions on the nodes of each tip cell, none elsewhere; an
/// end outside the body is no tip; more points for a longer crack.
#[test]
fn a_tip_inside_the_body_gets_branch_functions_and_an_end_outside_does_not() {
    let text = |p, q, tip| sheared(&crack(p, q, 0.3, tip));
    let none = body(&text([-3.0, 0.3], [3.0, 0.7], "branch"));
    assert_eq!((count(&none, true), none.enrichment.tips.len()), (0, 0));
    let one = body(&text([-3.0, 0.3], [0.7, 0.6], "branch"));
    assert_eq!((count(&one, true), one.enrichment.tips.len()), (16, 1));
    let two = body(&text([-1.2, 0.3], [0.7, 0.6], "branch"));
    assert_eq!((count(&two, true), two.enrichment.tips.len()), (32, 2));
    assert!(two.points.len() < one.points.len() && one.points.len() < none.points.len());
    let closed = body(&text([-1.2, 0.3], [0.7, 0.6], "none"));
    assert_eq!((count(&closed, true), closed.enrichment.tips.len()), (0, 0));
    assert!(count(&closed, false) > 0);
    // Ends exactly on the outline, and exactly in a corner of it, are outside.
    for q in [[2.0, 0.7], [2.0, 2.0]] {
        let body = body(&text([-3.0, 0.3], q, "branch"));
        assert_eq!(count(&body, true), 0, "{q:?}");
    }
}

/// Source: elasticity. Goal: the longer the crack, the softer the plate, with or without branch functions; the uncracked
/// plate is the stiffest. Strict inequalities, no tolerance.
#[test]
fn a_longer_crack_makes_the_plate_softer() {
    let shear = |p, q, tip| answer(&sheared(&crack(p, q, 0.0, tip)))[0];
    let lengths = [0.4, 0.9, 1.4, 1.9, 2.6];
    for tip in ["branch", "none"] {
        let found: Vec<f64> = lengths
            .iter()
            .map(|&l| shear([-3.0, 0.1], [-1.8 + l, 0.13], tip))
            .collect();
        for pair in found.windows(2) {
            assert!(pair[1].abs() < pair[0].abs(), "{tip}: {found:?}");
        }
    }
    // Four more functions per node can only soften.
    for &l in &lengths {
        let q = [-1.8 + l, 0.13];
        assert!(shear([-3.0, 0.1], q, "branch").abs() < shear([-3.0, 0.1], q, "none").abs());
    }
}

/// Source: the body does not change when a tip moves by 1e-8 of the crack's length. Goal: a tip on an edge or at a node,
/// and tips just before and just behind it, give one answer up to the discretisation error, or are refused at their
/// place; never something else.
///
/// Cracks horizontal, oblique, and through nodes; the tip on the edge x = 0.5, or at the node (0.5, 0.5). The enriched
/// nodes change as the tip crosses the edge, so the three answers differ by the discretisation error.
/// Tolerance 12 % on 8 × 8 cells (tip = "none" moves the end of the crack by a cell, of 7 in its length), and less on
/// 24 × 24. The forces of a tip on an edge are of the size of the load: nothing jumps at the tip itself.
#[test]
fn a_tip_on_an_edge_or_node_is_as_good_as_one_beside_it_or_refused() {
    let starts = [
        [-3.0, 0.2],
        [-3.0, -0.3],
        [-3.0, 0.5 - 3.5 * 0.13],
        [-3.0, -3.0],
    ];
    let tips = [[0.5, 0.2], [0.5, 0.12], [0.5, 0.5], [0.5, 0.5]];
    for (p, q) in starts.into_iter().zip(tips) {
        for tip in ["branch", "none"] {
            let spread = |cells: usize| {
                let solved = |shift: f64| {
                    let end = [0, 1].map(|a| q[a] + shift * (q[a] - p[a]));
                    let text = sheared(&crack(p, end, 0.1, tip));
                    let text = text.replace("[8, 8]", &format!("[{cells}, {cells}]"));
                    if let Err(error) = try_body(&text) {
                        assert!(shift == 0.0, "only a tip on an edge may be refused");
                        let BodyError::Case(error) = error else {
                            panic!("no position: {error}");
                        };
                        assert!(error.line() > 1, "{error}");
                        return None;
                    }
                    Some(solve_with(&text, METHOD, 1e-9))
                };
                let answer = |s: &Solved| [s.reaction("top", 0), s.reaction("top", 1)];
                let beside = [-1e-8, 1e-8].map(|shift| answer(&solved(shift).unwrap()));
                let mut worst = relative_difference(&beside[0], &beside[1]);
                if let Some(exact) = solved(0.0) {
                    let largest = exact.p().iter().fold(0.0f64, |m, p| m.max(p.abs()));
                    assert!(
                        largest < exact.reaction("top", 1).abs(),
                        "{q:?}: {largest:e}"
                    );
                    for other in beside {
                        worst = worst.max(relative_difference(&other, &answer(&exact)));
                    }
                }
                worst
            };
            let (coarse, fine) = (spread(8), spread(24));
            println!("{q:?} {tip}: {coarse:.1e}, {fine:.1e}");
            assert!(coarse < 0.12, "{q:?} {tip}: {coarse:e}");
            assert!(fine < 0.7 * coarse, "{q:?} {tip}: {coarse:e} {fine:e}");
        }
    }
}

/// Source: Westergaard 1939 / Tada, Paris & Irwin: crack of length 2a in an infinite plate under remote tension σ opens
/// by 4 σ a/E' at its middle, E' = E/(1 − ν²) in plane strain; in a plate 20a wide by a factor 1.006 more, the finite
/// width factor √sec(π a/W) of K_I.
///
/// ```text
///   ↑↑↑↑↑↑↑   σ = 1e-3, E = 1, a = 1, W = H = 20
///      ——     cells of 0.25 around the crack, growing outwards
///   ↓↓↓↓↓↓↓
/// ```
/// Tolerance 3 %: topological enrichment at a/h = 4; without branch functions the crack ends at a cell edge and opens
/// less, by more than the error with them.
#[test]
fn an_open_crack_opens_as_in_the_infinite_plate_and_better_with_branch_functions() {
    let fine = (-6..=6).map(|i| f64::from(i) * 0.25 + 0.0);
    let x: Vec<f64> = [-10.0, -7.0, -5.0, -3.5, -2.5, -2.0]
        .into_iter()
        .chain(fine)
        .chain([2.0, 2.5, 3.5, 5.0, 7.0, 10.0])
        .collect();
    let y: Vec<f64> = [-10.0, -7.0, -5.0, -3.5, -2.5, -2.0]
        .into_iter()
        .chain((-6..6).map(|i| f64::from(i) * 0.25 + 0.125))
        .chain([2.0, 2.5, 3.5, 5.0, 7.0, 10.0])
        .collect();
    let opening = |a: f64, tip: &str| {
        let rest = crack([-a, 0.0], [a, 0.0], 0.3, tip)
            + &support("[\"left\", \"bottom\"]", "[0, 0]")
            + &support("[\"right\", \"bottom\"]", "[\"free\", 0]")
            + &load("bottom", "traction_pa = [0, -1e-3]")
            + &load("top", "traction_pa = [0, 1e-3]");
        let text = format!(
            "title = \"t\"\nmodel = \"plane-strain\"\nmaterial = {{ young_pa = 1, poisson = 0.3 }}\nmesh = {{ lines_m = [{x:?}, {y:?}] }}\n{rest}"
        );
        let found = solve(&text);
        assert!(found.p().iter().all(|&p| p == 0.0), "the crack is open");
        let gaps = found.jump.chunks_exact(2).map(|j| j[0]);
        assert!(gaps.clone().all(|g| g > 0.0));
        // The pair at x = 0.
        let middle = found.body.points.iter().position(|p| p.x[0].abs() < 1e-9);
        let gaps: Vec<f64> = gaps.collect();
        gaps[middle.unwrap()] / (4.0 * 1e-3 * 0.91 * a)
    };
    // Tips mid-cell.
    let a = 1.125;
    let finite = 1.0 / (std::f64::consts::PI * a / 20.0).cos().sqrt();
    let with = opening(a, "branch") / finite;
    let without = opening(a, "none") / finite;
    println!("opening over the closed form: {with:.4} with branch functions, {without:.4} without");
    assert!((with - 1.0).abs() < 0.03, "{with}");
    assert!(
        (without - 1.0).abs() > 2.0 * (with - 1.0).abs(),
        "{with} {without}"
    );
}

/// Source: superposition of separate bodies. Goal: three cracks one above the other are numbered, placed and solved each
/// on its own: points come in case order, equal cracks far apart carry equal forces, the order in the file does not
/// matter to the answer.
/// A plate 1 × 4 m, ν = 0, pushed and sheared uniformly along its height: all cracks see the same stress.
#[test]
fn parallel_cracks_share_the_load_and_their_order_does_not_matter() {
    let heights = [0.71, 2.05, 3.33];
    let held = |row: usize| {
        let y = 4.0 / 15.0 * row as f64;
        let line = format!("where = \"y > {} and y < {}\"", y - 0.1, y + 0.1);
        support("\"left\"", &format!("[{}, \"free\"]", 1e-4 * y)) + &line + "\n"
    };
    let text = |order: [usize; 3]| {
        let cracks: String = order
            .iter()
            .map(|&i| crack([-0.1, heights[i]], [1.1, heights[i]], 0.5, "none"))
            .collect();
        let rest = cracks
            + &support("\"bottom\"", "[0, 0]")
            + &support("\"top\"", "[4e-4, -4e-3]")
            // A node of each middle piece, which would float otherwise, where the exact field puts it.
            + &held(5)
            + &held(10)
            + &load("right", "traction_pa = [0, 5e-5]")
            + &load("left", "traction_pa = [0, -5e-5]");
        plane([0.0, 0.0], [1.0, 4.0], [3, 15], &rest).replace("poisson = 0.3", "poisson = 0")
    };
    let found = solve(&text([0, 1, 2]));
    assert_eq!(found.body.points.len(), 12);
    let cracks: Vec<usize> = found.body.points.iter().map(|p| p.crack).collect();
    assert_eq!(cracks, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]);
    for (n, t) in found.traction(0).iter().zip(found.traction(1)) {
        assert!(
            (n - 1e-3).abs() < 1e-13 && (t + 5e-5).abs() < 1e-13,
            "{n} {t}"
        );
    }
    let other = solve(&text([2, 0, 1]));
    let moved: Vec<f64> = [8..16, 16..24, 0..8]
        .into_iter()
        .flat_map(|r| other.p()[r].to_vec())
        .collect();
    assert!(relative_difference(&moved, found.p()) < 1e-10);
}
