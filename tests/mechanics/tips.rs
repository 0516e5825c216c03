//! Cracks that end inside the body: tips anywhere in a cell, on an edge, at a node.

use crate::common::*;
use stickslip::model::body::Body;
use stickslip_xfem::enrichment::basis::FunctionKind;

/// A plate 4 × 4 m in 8 × 8 cells under compression and shear, with one crack.
fn sheared(crack: &str) -> String {
    let rest =
        crack.to_owned() + &support("\"bottom\"", "[0, 0]") + &support("\"top\"", "[1e-3, -2e-3]");
    plane([-2.0, -2.0], [2.0, 2.0], [8, 8], &rest)
}

fn count(body: &Body, branch: bool) -> usize {
    let functions = body.enrichment.functions.iter();
    functions
        .filter(|f| match f.kind {
            FunctionKind::Standard => false,
            FunctionKind::Piece { .. } => !branch,
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

/// Source: the body does not change when a tip moves by 1e-5 of the crack's length. Goal: a tip on an edge or at a node,
/// and tips just before and just behind it, give one answer up to the discretisation error; tips nearer than 1e-8 give the same.
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
        // Not through a corner: the piece that a support holds in a point is free, and moves far.
        [-3.0, 4.0],
    ];
    let tips = [[0.5, 0.2], [0.5, 0.12], [0.5, 0.5], [0.5, 0.5]];
    for (p, q) in starts.into_iter().zip(tips) {
        for tip in ["branch", "none"] {
            let spread = |cells: usize| {
                let solved = |shift: f64| {
                    let end = [0, 1].map(|a| q[a] + shift * (q[a] - p[a]));
                    let text = sheared(&crack(p, end, 0.1, tip));
                    let text = text.replace("[8, 8]", &format!("[{cells}, {cells}]"));
                    solve_with(&text, METHOD, 1e-9)
                };
                let answer = |s: &Solved| [s.reaction("top", 0), s.reaction("top", 1)];
                let exact = solved(0.0);
                let largest = exact.p().iter().fold(0.0f64, |m, p| m.max(p.abs()));
                assert_below(largest, exact.reaction("top", 1).abs(), q);
                let off = |shift| relative_difference(&answer(&solved(shift)), &answer(&exact));
                assert!(off(-1e-8).max(off(1e-8)) < 1e-7, "{q:?} {tip}");
                off(-1e-5).max(off(1e-5))
            };
            let (coarse, fine) = (spread(8), spread(24));
            println!("{q:?} {tip}: {coarse:.1e}, {fine:.1e}");
            assert!(coarse < 0.12, "{q:?} {tip}: {coarse:e}");
            assert!(fine < 0.7 * coarse, "{q:?} {tip}: {coarse:e} {fine:e}");
        }
    }
}

/// Source: rounding; a plane patch test whose tip lay 1e-13 m before an edge of cells of 1 : 4 was wrong by 12 %. Goal: a tip
/// closer to an edge than 1e-9 of it, before or behind, lies on it, in cells of any shape: the same unknowns, points and
/// reactions. Tolerance 1e-7: what 1e-9 of a cell moves the end of a crack by, times a hundred.
#[test]
fn a_tip_within_rounding_of_an_edge_lies_on_it() {
    let [p, q] = [[-1.2, -0.3], [0.5, 0.37]];
    for cells in ["[8, 8]", "[16, 4]", "[4, 16]", "[40, 4]"] {
        let at = |shift: f64| {
            let end = [0, 1].map(|a| q[a] + shift * (q[a] - p[a]));
            let text = sheared(&crack(p, end, 0.1, "branch"));
            let found = solve_with(&text.replace("[8, 8]", cells), METHOD, 1e-9);
            let counts = [true, false].map(|branch| count(&found.body, branch));
            let reactions = [0, 1].map(|a| found.reaction("top", a));
            (counts, found.body.points.len(), reactions)
        };
        let on = at(0.0);
        for exponent in -16..=-10 {
            for side in [-1.0, 1.0] {
                let beside = at(side * 10f64.powi(exponent) * 0.2);
                assert_eq!(
                    (beside.0, beside.1),
                    (on.0, on.1),
                    "{cells} {side}e{exponent}"
                );
                assert_below(relative_difference(&beside.2, &on.2), 1e-7, cells);
            }
        }
    }
}

/// Goal: a tip beside another crack has its functions whichever crack comes first and however both are read.
#[test]
fn a_tip_beside_a_crack_has_its_functions_in_every_order() {
    let (a, b) = ([2.14, 1.684], [7.0, 1.4]);
    let (c, d) = ([-1.0, 2.6], [8.0, -0.26]);
    let [own, other] = [(a, b), (b, a)].map(|(p, q)| {
        [
            crack(p, q, 0.6, "branch"),
            crack(c, d, 0.6, "none"),
            crack(d, c, 0.6, "none"),
            crack(q, p, 0.6, "branch"),
        ]
    });
    let held = support("\"bottom\"", "[0, 0]") + &support("\"top\"", "[1e-3, -1e-2]");
    let unknowns = |cracks: [&String; 2]| {
        let rest = cracks[0].clone() + cracks[1] + &held;
        body(&plane([0.0, 0.0], [7.0, 5.0], [7, 5], &rest))
            .elastic
            .unknowns()
    };
    let counts = [
        [&own[0], &own[1]],
        [&own[1], &own[0]],
        [&own[2], &own[3]],
        [&other[0], &other[2]],
        [&other[1], &other[0]],
    ];
    assert_eq!(counts.map(unknowns), [184; 5]);
}

/// Source: superposition of separate bodies. Goal: three cracks one above the other are numbered, placed and solved each
/// on its own: points come in case order, equal cracks far apart carry equal forces, the order in the file does not
/// matter to the answer. A plate 1 × 4 m, ν = 0, pushed and sheared uniformly along its height: all cracks see the same stress.
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

/// Goal: where a crack runs into a corner of a support, the piece whose facets the support holds is held, and the one that
/// touches it in a point is not, whichever way the crack runs and whichever side of it is called the first.
#[test]
fn a_crack_into_the_corner_of_a_support_is_the_same_both_ways() {
    for (p, q) in [
        ([-2.0, -2.0], [2.0, 2.0]),
        ([-3.0, -3.0], [0.6, 0.6]),
        ([2.0, -2.0], [-2.0, 2.0]),
    ] {
        let solved = |p: [f64; 2], q: [f64; 2]| {
            let s = solve_with(&sheared(&crack(p, q, 0.3, "none")), METHOD, 1e-12);
            let own = |f: u32| s.body.enrichment.functions[f as usize].node;
            // Corners of the box, where the support of the bottom ends.
            let held = (0..s.body.numbers.len() as u32 / 2).filter(|&f| {
                let x = s.body.mesh.nodes[own(f) as usize];
                x[0].abs() == 2.0 && x[1] == -2.0 && s.body.numbers[2 * f as usize].is_none()
            });
            ([s.reaction("top", 0), s.reaction("top", 1)], held.count())
        };
        let (one, other) = (solved(p, q), solved(q, p));
        assert_below(relative_difference(&one.0, &other.0), 1e-9, (p, q));
        assert_eq!((one.1, other.1), (2, 2), "{p:?} {q:?}");
    }
}
