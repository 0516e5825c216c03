//! The random robustness study: the same on any number of threads, complete, and every problem can be run again alone.

use std::collections::BTreeMap;

use crate::common::*;
use stickslip::report::table::readable;
use stickslip::report::{Provenance, robustness as report};
use stickslip::run::record::RunKey;
use stickslip::run::registry::methods;
use stickslip::run::run_case::Quiet;
use stickslip::run::verdict::Verdict;
use stickslip::studies::robustness::summary as summed;
use stickslip::studies::robustness::{self, RobustnessPlan, Trial};
use stickslip_methods::{Status, Tier};

const FRICTION: [f64; 3] = [0.0, 0.6, 5.0];

fn study() -> RobustnessPlan {
    RobustnessPlan {
        seed: 7,
        dims: vec![2, 3],
        problems: 6,
        only: None,
        friction: FRICTION.to_vec(),
        tier: Tier::High,
        jobs: 2,
    }
}

fn trials(study: &RobustnessPlan, methods: &[&str]) -> Vec<Trial> {
    robustness::run(study, &choices(methods), &Quiet).unwrap_or_else(|e| panic!("{e}"))
}

/// Times are NaN, which is unequal to itself.
fn shown(trials: &[Trial]) -> Vec<String> {
    trials.iter().map(|t| format!("{t:?}")).collect()
}

/// Goal: no method claims what does not hold, and every run is counted once.
#[test]
fn every_run_of_every_method_is_counted_and_no_claim_is_false() {
    let names: Vec<&str> = methods().iter().map(|m| m.name).collect();
    let study = study();
    let trials = trials(&study, &names);
    assert_eq!(trials.len(), 2 * 6 * FRICTION.len() * names.len());
    let wrong: Vec<&Trial> = trials.iter().filter(|t| t.is_wrong()).collect();
    assert!(
        wrong.is_empty() && robustness::as_expected(&trials),
        "{wrong:#?}"
    );
    let rows = summed::rows(&study, &trials);
    assert_eq!(rows.len(), 2 * FRICTION.len() * names.len());
    for row in &rows {
        let approximate = row.approximate.iter().sum::<usize>();
        let ends = row.solved + approximate + row.gave_up + row.refused;
        assert_eq!((row.problems, ends), (6, 6), "{row:?}");
        assert_eq!(row.gave_up_by.iter().sum::<usize>(), row.gave_up, "{row:?}");
    }
    // The problems must be worth solving: closed and open points, stick and slip.
    let b_newton = trials
        .iter()
        .filter(|t| t.method == METHOD && t.friction == 0.6);
    let mixed = b_newton.fold([0; 3], |sum: [usize; 3], t| {
        std::array::from_fn(|k| sum[k] + t.statuses[k])
    });
    assert!(
        mixed.iter().all(|&n| 20 * n > mixed.iter().sum()),
        "{mixed:?}"
    );
    let failed = trials.iter().filter(|t| t.verdict.is_failure()).count();
    assert_eq!(summed::failures(&study, &trials).len(), failed);
}

/// Goal: a failure found in a study is found again by its number alone, and in its case file by `stickslip run`, also by a
/// method that asks for more of a body than the others.
#[test]
fn a_problem_taken_alone_gives_the_same_bits() {
    for methods in [&["b-newton", "penalty"][..], &["nitsche"]] {
        let (whole, problem) = (study(), 5);
        let mut expected = trials(&whole, methods);
        expected.retain(|t| t.problem == problem);
        let alone = RobustnessPlan {
            only: Some(problem),
            problems: 1,
            ..study()
        };
        // Nitsche's method counts the factorisation of its constant with the problem that comes first.
        if methods.len() > 1 {
            assert_eq!(shown(&trials(&alone, methods)), shown(&expected));
        }
        for dim in [2, 3] {
            let text = robustness::case_of(&whole, &choices(methods), dim, problem).unwrap();
            let results = run(&parse(&text), methods);
            let own: Vec<&Trial> = expected.iter().filter(|t| t.dim == dim).collect();
            // Its load acts at time 0, too, and stays: there the problem is solved.
            let first = || results.runs.iter().filter(|row| row.key.increment == 0);
            assert_eq!(first().count(), own.len());
            for trial in own {
                let same =
                    |key: &RunKey| key.method == trial.method && key.friction == trial.friction;
                let row = first().find(|r| same(&r.key)).unwrap();
                let found = (row.natural_map, row.iterations, row.points, &row.verdict);
                let alone = (
                    trial.natural_map,
                    trial.iterations,
                    trial.points,
                    &trial.verdict,
                );
                assert_eq!(found, alone);
            }
        }
    }
}

/// Goal: any number of threads writes the same bytes, apart from the times.
#[test]
fn the_program_writes_the_same_files_whatever_the_threads() {
    let dir = tempfile::tempdir().unwrap();
    let [one, two, three] = ["1", "2", "3"].map(|jobs| {
        let study = [
            "stress",
            "methods",
            "--problems",
            "5",
            "--seed",
            "3",
            "--friction",
            "0.3,5",
        ];
        let methods = ["--method", "b-newton", "--method", "penalty:normal=1e3"];
        let arguments = [&study[..], &methods, &["--jobs", jobs, "--out", jobs]].concat();
        assert!(ends_with(0, &arguments, dir.path()).1.is_empty());
        let text = |(name, bytes)| (name, String::from_utf8(bytes).unwrap());
        let files = files(&dir.path().join(jobs)).into_iter();
        files.map(text).collect::<BTreeMap<_, _>>()
    });
    for file in [
        "robustness.csv",
        "failures.csv",
        "atlas.csv",
        "stopping.csv",
        "robustness.md",
        "robustness.tex",
        "figures/robustness.svg",
    ] {
        assert_eq!(two[file], three[file], "{file}");
        assert!(file == "robustness.csv" || two[file] == one[file], "{file}");
    }
    let records = |files: &BTreeMap<String, String>| csv_rows(&files["robustness.csv"]);
    for (mut one, mut two) in records(&one).into_iter().zip(records(&two)) {
        let [alone, beside] = [&mut one, &mut two].map(|row| row.remove("solve_s_median").unwrap());
        assert!(alone.parse::<f64>().unwrap() > 0.0 && beside == "NaN");
        assert_eq!(one, two);
    }
    assert!(one["robustness.csv"].contains("penalty[normal=1e3]"));
    assert!(one["figures/robustness.svg"].contains("own laws kept [%]"));
}

#[test]
fn a_problem_run_alone_comes_with_its_case_file() {
    let dir = tempfile::tempdir().unwrap();
    let problem = [
        "stress",
        "methods",
        "--only",
        "9",
        "--dim",
        "2",
        "--friction",
        "0.3",
    ];
    let arguments = [&problem[..], &["--method", "b-newton"]].concat();
    ends_with(0, &arguments, dir.path());
    let case = std::fs::read_to_string(dir.path().join("results/stress-methods/problem-2d-9.toml"))
        .unwrap();
    assert_eq!(parse(&case).sweep.friction, [0.3]);
}

#[test]
fn bad_arguments_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    for bad in [
        ["--friction", "-1"],
        ["--friction", "nan"],
        ["--dim", "4"],
        ["--problems", "0"],
        ["--method", "nobody"],
        ["--tier", "perfect"],
    ] {
        let (shown, complaints) = ends_with(2, &["stress", "methods", bad[0], bad[1]], dir.path());
        assert!(shown.is_empty() && !complaints.is_empty(), "{bad:?}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

/// Goal: the exit code tells a wrong claim and an error from giving up.
#[test]
fn false_claims_and_crashes_are_failures_and_giving_up_is_a_result() {
    let mut trial = trials(
        &RobustnessPlan {
            problems: 1,
            dims: vec![2],
            ..study()
        },
        &[METHOD],
    )
    .swap_remove(0);
    for (verdict, expected) in [
        (Verdict::Solved, true),
        (Verdict::GaveUp(Status::Stalled), true),
        (Verdict::Refused("no".into()), true),
        (Verdict::FalseClaim, false),
        (Verdict::Crashed("oh".into()), false),
        // Nobody limits a trial.
        (Verdict::OutOfMemory, false),
    ] {
        trial.verdict = verdict;
        assert_eq!(
            robustness::as_expected(std::slice::from_ref(&trial)),
            expected
        );
    }
}

/// Goal: problems that a method declines are neither successes nor failures, and a study of refusals only is still written.
#[test]
fn refused_problems_have_no_rate() {
    let study = RobustnessPlan {
        problems: 1,
        dims: vec![2],
        friction: vec![0.3],
        ..study()
    };
    let mut trials = trials(&study, &[METHOD]);
    trials[0].verdict = Verdict::Refused("no".into());
    let rows = summed::rows(&study, &trials);
    assert_eq!((rows.len(), rows[0].refused), (1, 1));
    assert!(rows[0].success.iter().all(|rate| rate.is_nan()));
    assert!(summed::failures(&study, &trials).is_empty());
    let bundle = report::bundle(&study, &trials, &rows, &Provenance::collect(1)).unwrap();
    assert!(bundle.get("robustness.csv").is_some());
    assert!(bundle.get("figures/robustness.svg").is_none());
}

/// Goal: laws of a method's own do not count as the contact laws, and what they are worth shows.
#[test]
fn exact_methods_are_rated_by_solutions_and_approximate_ones_by_kept_claims() {
    let study = RobustnessPlan {
        problems: 6,
        dims: vec![2],
        friction: vec![0.3],
        ..study()
    };
    let verdicts = [
        Verdict::Solved,
        Verdict::Approximate(Some(Tier::Mid)),
        Verdict::Approximate(Some(Tier::Low)),
        Verdict::Approximate(None),
        Verdict::Approximate(None),
        Verdict::GaveUp(Status::Stalled),
    ];
    let mut rows = Vec::new();
    for method in [METHOD, "penalty"] {
        let mut trials = trials(&study, &[method]);
        assert_eq!(trials.len(), verdicts.len());
        for (trial, verdict) in trials.iter_mut().zip(&verdicts) {
            trial.verdict = verdict.clone();
        }
        rows.extend(summed::rows(&study, &trials));
    }
    for (row, kept) in rows.iter().zip([1, 5]) {
        assert_eq!((row.solved, row.approximate), (1, [0, 1, 1, 2]), "{row:?}");
        assert_eq!(row.success[0], kept as f64 / 6.0, "{row:?}");
    }
    let table = readable(&rows, "");
    let place = |name: &str| table.columns.iter().position(|c| c.name == name).unwrap();
    let places = ["rate of", "success", "laws to no tier"].map(place);
    let read = |row: usize| places.map(|column| table.rows[row][column].clone());
    assert_eq!(read(0), ["solved", "16.7", "2"]);
    assert_eq!(read(1), ["kept", "83.3", "2"]);
}
