//! Bodies and supports that once went wrong: slender bodies, floating blocks on a slope, supports that overlap.

use crate::common::*;
use stickslip::run::progress::Quiet;
use stickslip::run::verdict::Verdict;
use stickslip::studies::cases::{Settings, run_case};

const EXACT: [&str; 3] = ["b-newton", "augmented-lagrangian", "latin"];

fn assert_solved(text: &str) {
    let results = run(&parse(text), &EXACT);
    for row in results.increments() {
        assert_eq!(
            row.step.verdict,
            Verdict::Solved,
            "{}: {row:?}",
            row.key.method
        );
    }
    assert_eq!(results.increments().len(), EXACT.len());
}

/// Source: rounding of K u is relative to |K| |u|. Goal: a cantilever, whose |K| |u| is 10⁶ times |K u|, is solved and
/// judged so. 20 × 1.1 m, 200 × 11 cells, crack along the middle, pressure on the top.
#[test]
fn a_slender_body_is_judged_by_its_backward_error() {
    let rest = crack([5.0, 0.55], [10.0, 0.55], 0.3, "branch")
        + &support("\"left\"", "[0, 0]")
        + &load("top", "pressure_pa = 1e-6");
    assert_solved(&plane([0.0, 0.0], [20.0, 1.1], [200, 11], &rest));
}

/// Source: Coulomb friction on a slope is not convex. Goal: the upper block of a cube, free in x, pushed down and
/// sideways on a plane through its centre, sticks; Newton's method must not follow a slide that never ends.
#[test]
fn a_floating_block_pushed_on_a_slope_is_held_by_every_exact_method() {
    assert_solved(
        r#"
title = "cube"
model = "solid"
[material]
young_pa = 1e9
poisson = 0.2
[mesh.box]
min_m = [0, 0, 0]
max_m = [1, 1, 1]
cells = [5, 5, 5]
[[crack]]
plane = { point_m = [0.5, 0.5, 0.5], normal = [0.2, 0.1, 1] }
friction = 0.3
contact = "edge-pairs"
[[support]]
on = "bottom"
displacement_m = [0, 0, 0]
[[support]]
on = "top"
displacement_m = ["free", 0, -1e-3]
[[load]]
on = "left"
traction_pa = [1e5, 0, 0]
"#,
    );
}

/// Source: statics. Goal: supports that share nodes and two supports on one side: every reaction is counted once, and
/// all of them balance the load, 2 m × (3e-3, −1e-3) N/m².
#[test]
fn overlapping_supports_balance_the_load_once() {
    let rest = crack([-0.45, 0.23], [0.68, 0.31], 0.3, "branch")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"left\"", "[0, \"free\"]")
        + &support("\"right\"", "[\"free\", 0]")
        + &support("\"right\"", "[1e-3, \"free\"]")
        + &load("top", "traction_pa = [3e-3, -1e-3]");
    let results = run(
        &parse(&plane([-1.0, -1.0], [1.0, 1.0], [8, 8], &rest)),
        &["b-newton"],
    );
    let quantities = results.quantities();
    for (component, applied) in [("x", 6e-3), ("y", -2e-3)] {
        let rows = || {
            let all = quantities.iter();
            all.filter(|q| q.quantity.name == "reaction" && q.quantity.component == component)
        };
        let total: f64 = rows().map(|q| q.quantity.value).sum();
        assert!((total + applied).abs() < 1e-14, "{component}: {total:e}");
        let places: std::collections::BTreeSet<&str> =
            rows().map(|q| q.quantity.at.as_str()).collect();
        assert_eq!(places.len(), rows().count(), "one row per place");
    }
}

/// Three cracks with μ about 3.5, of which two solutions are known: dissipation 7.84 and 0.59 J/m. Goal: who looks from
/// several starts is told that there are several; with little friction there is one.
#[test]
fn who_finds_different_answers_is_told_so() {
    let places = [
        [
            [0.7202793371410585, -0.7884440400482011],
            [-0.5374913459088968, 0.7286018586705387],
        ],
        [
            [0.32392600918648823, 0.2553051358035423],
            [0.42355700305704497, 1.217523253503631],
        ],
        [
            [1.3229537322258984, 0.15191983720880686],
            [-0.6263509877101769, 0.409202772627397],
        ],
    ];
    let body = |mu: [f64; 3]| {
        let cracks = places
            .iter()
            .zip(mu)
            .map(|(points, mu)| format!("[[crack]]\npoints_m = {points:?}\nfriction = {mu:?}\n"));
        let held = support("\"bottom\"", "[0.0, 0.0]")
            + &support("\"top\"", "[0.001103203483182878, -6.87398768484061e-05]");
        let rest = cracks.collect::<String>() + &held;
        plane([-2.0, -2.0], [2.0, 2.0], [27, 27], &rest)
            .replace("young_pa = 1,", "young_pa = 1e10,")
    };
    let verdicts = |mu, methods: &[&str], starts| -> Vec<Verdict> {
        let settings = Settings {
            starts,
            ..Settings::PLAIN
        };
        let results = run_case(&parse(&body(mu)), &choices(methods), settings, &Quiet).unwrap();
        results
            .records()
            .flat_map(|run| &run.found.increments)
            .map(|step| step.verdict.clone())
            .collect()
    };
    let steep = [3.760629542764099, 3.36346893277615, 3.3810203294188796];
    let two = ["hybrid", "b-newton"];
    assert_eq!(
        verdicts(steep, &two, 8),
        [Verdict::Several, Verdict::Several]
    );
    assert_eq!(verdicts(steep, &two[1..], 8), [Verdict::Several]);
    assert_eq!(
        verdicts([0.2; 3], &two, 8),
        [Verdict::Solved, Verdict::Solved]
    );
}
