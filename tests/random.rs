//! Random cracked bodies: whatever the case, no method claims what does not hold, and exact methods agree.

mod common;

use std::collections::BTreeMap;

use common::*;
use stickslip::harness::body::BodyError;
use stickslip::harness::record::Results;
use stickslip::harness::run::{Fields, Quiet, RunError, Settings, run_case};
use stickslip_methods::METHODS;

const SETTINGS: Settings = Settings {
    tier: None,
    jobs: 1,
    fields: Fields::None,
};

const EXACT: [&str; 3] = ["b-newton", "augmented-lagrangian", "latin"];

/// Friction coefficients tried; beyond 1 Coulomb's law may have several solutions.
const FRICTION: [f64; 5] = [0.0, 0.1, 0.3, 0.6, 1.0];

fn pick<const N: usize>(random: &mut Random, values: [f64; N]) -> f64 {
    values[(random.next() * N as f64) as usize]
}

/// A plate with one crack in any position: free ends, through the plate, or between grid points.
fn random_plate(random: &mut Random) -> String {
    let cells = [0, 1].map(|_| 4 + (random.next() * 6.0) as usize);
    let tip = if random.next() < 0.6 {
        "branch"
    } else {
        "none"
    };
    let friction = pick(random, FRICTION);
    let (p, q) = match (random.next() * 3.0) as usize {
        0 => (
            [random.between(-0.3, 0.9), random.between(0.1, 0.9)],
            [random.between(0.1, 1.3), random.between(0.1, 0.9)],
        ),
        1 => (
            [-0.1, random.between(0.2, 0.8)],
            [1.1, random.between(0.2, 0.8)],
        ),
        _ => {
            let mut on_grid =
                |a: usize| (random.next() * cells[a] as f64).floor() / cells[a] as f64;
            let p = [on_grid(0), on_grid(1)];
            // Ends of a crack must differ.
            (p, [on_grid(0) + 1.0, on_grid(1)])
        }
    };
    let top = [random.between(-1e-3, 1e-3), random.between(-2e-3, 5e-4)];
    let side = if random.next() < 0.5 { "left" } else { "right" };
    let traction = [0, 1].map(|_| random.between(-1e-4, 1e-4));
    let rest = crack(p, q, friction, tip)
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", &format!("{top:?}"))
        + &load(side, &format!("traction_pa = {traction:?}"));
    plane([0.0, 0.0], [1.0, 1.0], cells, &rest) + "[path]\nincrements = 2\n"
}

/// A block parted by a plane in any position, every fifth through nodes.
fn random_block(random: &mut Random) -> String {
    let cells = [0, 1, 2].map(|_| 2 + (random.next() * 2.0) as usize);
    let friction = pick(random, FRICTION);
    let normal = if random.next() < 0.2 {
        [0.0, 0.0, 1.0]
    } else {
        [random.between(-0.5, 0.5), random.between(-0.5, 0.5), 1.0]
    };
    let height = if random.next() < 0.2 {
        1.0 / cells[2] as f64
    } else {
        random.between(0.4, 0.6)
    };
    let top: [f64; 3] = [
        random.between(-1e-3, 1e-3),
        random.between(-1e-3, 1e-3),
        random.between(-2e-3, 5e-4),
    ];
    let traction = [0, 1, 2].map(|_| random.between(-1e-4, 1e-4));
    let rest = support("\"bottom\"", "[0, 0, 0]")
        + &support("\"top\"", &format!("{top:?}"))
        + &load("right", &format!("traction_pa = {traction:?}"));
    solid(
        [1.0, 1.0, 1.0],
        cells,
        &[([0.5, 0.5, height], normal, friction)],
        &rest,
    ) + "[path]\nincrements = 2\n"
}

/// Reaction at the top of the runs whose last increment was solved exactly.
fn reactions(results: &Results, dim: usize) -> Vec<(String, Vec<f64>)> {
    let rows = results.runs.iter();
    rows.filter(|r| r.verdict == "solved" && r.key.increment == 2)
        .filter(|r| EXACT.contains(&r.key.method.as_str()))
        .map(|r| {
            let of = |c: &str| value(results, |k| *k == r.key, ["reaction", "top", c]);
            (
                r.key.method.clone(),
                ["x", "y", "z"][..dim].iter().map(|c| of(c)).collect(),
            )
        })
        .collect()
}

/// Runs bodies until `count` were accepted; counts verdicts by method.
fn run_random(
    seed: u64,
    count: usize,
    dim: usize,
    make: impl Fn(&mut Random) -> String,
) -> BTreeMap<String, usize> {
    let mut random = Random(seed);
    let mut verdicts = BTreeMap::new();
    let methods: Vec<&str> = METHODS.iter().map(|m| m.name).collect();
    let mut accepted = 0;
    while accepted < count {
        let text = make(&mut random);
        let results = match run_case(&parse(&text), &choices(&methods), SETTINGS, &Quiet) {
            Ok(results) => results,
            Err(RunError::Body(BodyError::Case(_))) => continue,
            Err(other) => panic!("no position: {other}\n{text}"),
        };
        accepted += 1;
        for row in &results.runs {
            let bad = ["false-claim", "crashed", "refused"];
            assert!(
                !bad.iter().any(|b| row.verdict.starts_with(b)),
                "{}: {}\n{text}",
                row.key.method,
                row.verdict
            );
            if row.verdict.starts_with("gave-up") {
                println!("{}: {}\n{text}", row.key.method, row.verdict);
            }
            *verdicts
                .entry(format!("{} {}", row.key.method, row.verdict))
                .or_default() += 1;
        }
        let found = reactions(&results, dim);
        for pair in found.windows(2) {
            let difference = pair[0].1.iter().zip(&pair[1].1).map(|(a, b)| (a - b).abs());
            let worst = difference.fold(0.0, f64::max);
            assert!(worst < 1e-10, "{pair:?}: {worst:e}\n{text}");
        }
    }
    println!("{verdicts:#?}");
    verdicts
}

/// At least 95 of 100 increments solved, by every exact method: what is missing gave up and said so.
fn assert_solved(verdicts: &BTreeMap<String, usize>, count: usize) {
    for method in EXACT {
        let solved = verdicts[&format!("{method} solved")];
        assert!(
            solved * 100 >= 2 * count * 95,
            "{method}: {solved} of {}",
            2 * count
        );
    }
}

/// 150 plates 1 × 1 m, E = 1, pushed, pulled and sheared in two increments. Tolerance 1e-10 N/m on reactions of 1e-3:
/// natural map 1e-9 times the forces of 1e-4 per point, a few points.
#[test]
fn exact_methods_agree_on_random_plates_and_nobody_claims_too_much() {
    let verdicts = run_random(99, 150, 2, random_plate);
    assert_solved(&verdicts, 150);
}

/// 40 blocks 1 × 1 × 1 m under a random push, pull and shear in two increments.
#[test]
fn exact_methods_agree_on_random_blocks_and_nobody_claims_too_much() {
    let verdicts = run_random(7, 40, 3, random_block);
    assert_solved(&verdicts, 40);
}
