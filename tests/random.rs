//! Random cracked bodies: whatever the case, no method claims what does not hold, and exact methods agree.

mod common;

use std::collections::BTreeMap;

use common::*;
use stickslip::harness::body::BodyError;
use stickslip::harness::random::{Kind, Specimen, Stream};
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

/// A body with two loads, one after the other.
fn random_case(kind: &Kind, stream: &mut Stream) -> String {
    let friction = FRICTION[stream.whole(0, FRICTION.len() - 1)];
    Specimen::draw(kind, 2, stream).case(&[0, 1], &[friction])
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
fn run_random(seed: u64, count: usize, kind: &Kind) -> BTreeMap<String, usize> {
    let mut stream = Stream::new(seed);
    let mut verdicts = BTreeMap::new();
    let methods: Vec<&str> = METHODS.iter().map(|m| m.name).collect();
    let mut accepted = 0;
    while accepted < count {
        let text = random_case(kind, &mut stream);
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
        let found = reactions(&results, kind.dim);
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
    let kind = Kind {
        dim: 2,
        cells: 4..=9,
        slope: 0.0,
    };
    let verdicts = run_random(99, 150, &kind);
    assert_solved(&verdicts, 150);
}

/// 40 blocks 1 × 1 × 1 m under a random push, pull and shear in two increments.
#[test]
fn exact_methods_agree_on_random_blocks_and_nobody_claims_too_much() {
    let kind = Kind {
        dim: 3,
        cells: 2..=3,
        slope: 0.5,
    };
    let verdicts = run_random(7, 40, &kind);
    assert_solved(&verdicts, 40);
}
