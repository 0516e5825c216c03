//! Overlap of the faces between contact points: `max_penetration_sampled`.

use crate::common::*;
use stickslip::case::{Case, ContactSpace};
use stickslip::model::body::{Body, Needs};
use stickslip::run::verdict::Verdict;
use stickslip_xfem::material::Dilatation;

/// A crack oblique to the grid, pulled open at one end and pressed together at the other: the pressure of the uncracked body
/// rises from −0.3 to 0.9 along it. The sides move as the closed form says.
fn half_open(cells: usize, space: ContactSpace) -> Case {
    let (s, c) = 27f64.to_radians().sin_cos();
    let end = |r: f64| [0.03 + r * c, 0.02 + r * s];
    let exact = "[exact]\nsolution = \"partial-opening\"\n\
                 pressure_pa = 0.3\npressure_rise_pa = 0.6\n";
    let sides = clamped(2).replace("[0, 0]", "\"exact\"");
    let rest = crack(end(-0.45), end(0.45), 0.3, "branch") + exact + &sides;
    let mut case = parse(&plane([-1.0, -1.0], [1.0, 1.0], [cells, cells], &rest));
    case.cracks[0].contact = space;
    case
}

/// Penetration of the points and of the samples over the largest gap.
fn overlaps(cells: usize, space: ContactSpace, stress: Option<Dilatation>) -> [f64; 2] {
    let mut case = half_open(cells, space);
    case.dilatation = stress;
    let results = run(&case, &["hybrid"]);
    let mut runs = results.records();
    assert!(runs.all(|run| run.found.verdict == Verdict::Solved));
    let found = |quantity| value(&results, |_| true, [quantity, "crack-1", ""]);
    let whole = |quantity| value(&results, |_| true, [quantity, "", ""]);
    let quantities = ["max_penetration", "max_penetration_sampled"];
    for quantity in quantities {
        assert_eq!(found(quantity), whole(quantity), "one crack is all cracks");
    }
    quantities.map(|q| found(q) / found("max_gap"))
}

/// Goal: neither space lets its contact points overlap; between edge pairs the faces overlap by a part of the gap that does
/// not fall with the cells, because the nodes beside the crack move the jump there freely. Star multipliers hold it down.
/// Bounds: with the stress of the gradient the edge pairs overlap by 0.30 to 1.1 of the gap on 10, 20 and 40 cells, the stars by
/// 0.22, 0.05 and 0.04; with assumed stress the stars by 0.07 on 20 cells.
#[test]
fn faces_overlap_between_edge_pairs_and_stars_bound_it() {
    for (stress, bounds) in [
        (None, [0.25, 0.08, 0.05]),
        (Some(Dilatation::Full), [0.25, 0.06, 0.05]),
    ] {
        for (cells, bound) in [10, 20, 40].into_iter().zip(bounds) {
            let [points, between] = overlaps(cells, ContactSpace::EdgePairs, stress);
            assert!(points < 1e-8, "{cells}: {points}");
            assert!(between > 0.2, "{cells}: {between}");
            let [points, between] = overlaps(cells, ContactSpace::Star, stress);
            println!("{cells}: {between}");
            assert!(points < 1e-8, "{cells}: {points}");
            assert!(between < bound, "{cells}: {between}");
        }
    }
}

/// Goal: ten samples per facet, all on the crack and up to its tips.
#[test]
fn samples_lie_on_the_crack_up_to_its_tips() {
    let case = half_open(10, ContactSpace::Star);
    let body = Body::new(&case, 1, &Needs::default()).unwrap();
    assert_eq!(body.samples.len(), 10 * body.surface.facets.len());
    let crack = &body.cracks[0];
    let s: Vec<f64> = body.samples.iter().map(|p| crack.abscissa(&p.x)).collect();
    let ends = [f64::min, f64::max].map(|end| s.iter().copied().reduce(end).unwrap());
    assert!((ends[1] - ends[0] - 0.9).abs() < 1e-12, "{ends:?}");
    for p in &body.samples {
        assert!(crack.distance(&p.x).abs() < 1e-12);
    }
}

/// A block of two halves pressed together by springs, which overlap.
fn pressed(height: f64, space: &str) -> [f64; 2] {
    let rest = support("\"bottom\"", "[0, 0, 0]") + &support("\"top\"", "[0, 0, -1e-3]");
    let cracks = [([0.5, 0.5, height], [0.0, 0.0, 1.0], 0.3)];
    let text = solid([1.0, 1.0, 1.0], [3, 3, 4], &cracks, &rest);
    let results = run(&parse(&in_space(&text, space)), &["penalty"]);
    ["max_penetration", "max_penetration_sampled"]
        .map(|quantity| value(&results, |_| true, [quantity, "crack-1", ""]))
}

/// Goal: in a solid the samples hold the corners of the facets, where the edge pairs are; along cell facets the jump is linear
/// between the points, and both numbers are the same.
#[test]
fn samples_of_a_plane_hold_its_edge_pairs() {
    let [points, sampled] = pressed(0.6, "edge-pairs");
    assert!(
        points > 0.0 && sampled >= points * (1.0 - 1e-12),
        "{points} {sampled}"
    );
    assert!(sampled < 2.0 * points, "{points} {sampled}");
    let [points, sampled] = pressed(0.5, "node-pairs");
    assert!(points > 0.0 && sampled == points, "{points} {sampled}");
}
