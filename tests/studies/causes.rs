//! Why methods give up: every cause on a small problem of its own, its remedy, and stopping tests that lie.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use stickslip::run::choice::Choice;
use stickslip::run::path::Solver;
use stickslip::run::verdict::Verdict;
use stickslip::studies::why::answers::Answers;
use stickslip::studies::why::cause::{Cause, Diagnosis, Evidence};
use stickslip::studies::why::stopping::evaluate;
use stickslip::studies::why::watch::{Seen, Watch};
use stickslip::studies::why::{Explanation, explain, stops};
use stickslip_methods::{
    ContactState, ContactSystem, Elastic, Gauge, Increment, Load, SquareMatrix, Status,
};

/// A problem known by its Delassus operator, a method that gives up on it, and why.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fixture {
    title: String,
    dim: usize,
    friction: f64,
    /// W by rows.
    w: Vec<Vec<f64>>,
    /// Jump without contact forces.
    q: Vec<f64>,
    /// As on the command line.
    method: String,
    #[serde(default = "high")]
    tolerance: f64,
    cause: String,
    period: Option<usize>,
    flips: Option<Vec<usize>>,
    /// Range of the measure.
    measure: Option<[f64; 2]>,
    rate: Option<[f64; 2]>,
    solutions: usize,
    remedy: Option<String>,
}

fn high() -> f64 {
    1e-9
}

fn elastic(dim: usize, w: &[Vec<f64>]) -> Arc<Elastic> {
    let n = w.len();
    let symmetric = (0..n).all(|i| (0..n).all(|j| w[i][j] == w[j][i]));
    let (mut pointers, mut rows, mut values) = (vec![0], vec![], vec![]);
    for j in 0..n {
        for i in if symmetric { j } else { 0 }..n {
            rows.push(i);
            values.push(w[i][j]);
        }
        pointers.push(rows.len());
    }
    if symmetric {
        let w = SquareMatrix::symmetric(n, pointers, rows, values).unwrap();
        return Elastic::from_delassus(dim, w, vec![]).unwrap();
    }
    let w = SquareMatrix::general(n, pointers, rows, values).unwrap();
    Elastic::from_delassus(dim, w, vec![]).unwrap()
}

/// Poses a problem from rest.
fn posed<T>(f: &Fixture, run: impl FnOnce(&ContactSystem, &Increment<'_>) -> T) -> T {
    let body = elastic(f.dim, &f.w);
    let system = ContactSystem::new(body.clone(), vec![f.friction; body.points()]).unwrap();
    let (rest, start) = (Load::zero(&body), ContactState::zero(&system));
    let load = Load {
        offset: f.q.clone(),
        ..rest.clone()
    };
    let increment = Increment {
        system: &system,
        load: &load,
        start_load: &rest,
        start: &start,
        guess: None,
        index: 0,
        tolerance: f.tolerance,
    };
    run(&system, &increment)
}

fn judged(method: &str, f: &Fixture) -> Verdict {
    let choice = Choice::parse(method).unwrap();
    posed(f, |system, increment| {
        let mut solver = Solver::new(&choice, system).unwrap();
        solver.judge(increment, f.tolerance).verdict
    })
}

fn explained(f: &Fixture) -> (Verdict, Explanation) {
    let choice = Choice::parse(&f.method).unwrap();
    posed(f, |system, increment| {
        let mut solver = Solver::new(&choice, system).unwrap();
        let verdict = solver.judge(increment, f.tolerance).verdict;
        let answers = Answers::of(increment).unwrap();
        let own = explain(&choice, &mut solver, increment, &verdict, &answers, true).unwrap();
        (verdict, own)
    })
}

/// Goal: every cause is what was constructed, in every detail that decides, and its remedy remedies.
#[test]
fn every_cause_is_found_on_a_small_problem_of_its_own_and_remedied() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/causes");
    let mut seen = BTreeSet::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let f: Fixture = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let at = format!("{}: {}", path.display(), f.title);
        let (verdict, found) = explained(&f);
        let own = &found.diagnosis;
        assert!(matches!(verdict, Verdict::GaveUp(_)), "{at}: {verdict}");
        assert_eq!(own.cause.name(), f.cause, "{at}: {found:?}");
        assert_eq!(own.period, f.period, "{at}");
        if let Some(flips) = &f.flips {
            assert_eq!(&own.flips, flips, "{at}");
        }
        let within = |x: f64, [low, high]: [f64; 2]| (low..=high).contains(&x);
        assert!(
            f.measure.is_none_or(|range| within(own.measure, range)),
            "{at}: {own:?}"
        );
        let rate = own.rate.unwrap_or(f64::NAN);
        assert!(
            f.rate.is_none_or(|range| within(rate, range)),
            "{at}: {own:?}"
        );
        assert_eq!(found.solutions, f.solutions, "{at}");
        if let Some(remedy) = &f.remedy {
            assert_eq!(found.remedy.as_ref(), Some(remedy), "{at}");
            assert_eq!(judged(remedy, &f), Verdict::Solved, "{at}");
        }
        // The same twice.
        assert_eq!(
            format!("{:?}", explained(&f)),
            format!("{:?}", (verdict, found)),
            "{at}"
        );
        seen.insert(f.cause);
    }
    // Ends that no method of this program has been seen to have, and those that are no cause.
    let unseen = [Cause::SingularTangent, Cause::Unexplained];
    let all: BTreeSet<String> = (Cause::ALL.iter().filter(|own| !unseen.contains(own)))
        .map(|own| own.name().to_owned())
        .collect();
    assert_eq!(seen, all);
}

/// A problem in the plane from W, without more.
fn plane(w: &[[f64; 4]; 4], q: [f64; 4], friction: f64, method: &str) -> Fixture {
    Fixture {
        title: String::new(),
        dim: 2,
        friction,
        w: w.iter().map(|row| row.to_vec()).collect(),
        q: q.to_vec(),
        method: method.into(),
        tolerance: high(),
        cause: String::new(),
        period: None,
        flips: None,
        measure: None,
        rate: None,
        solutions: 0,
        remedy: None,
    }
}

/// Two points on one place: the tangent of two sticking points is singular. A method that ends there says so, and the harness
/// measures it; one that says so of a regular tangent is not believed.
#[test]
fn a_singular_tangent_is_measured_and_not_believed() {
    let tied = |i: usize, j: usize| f64::from(u8::from(i % 2 == j % 2));
    for (apart, singular) in [(0.0, true), (1e-3, false)] {
        let w = std::array::from_fn(|i| {
            std::array::from_fn(|j| tied(i, j) + if i == j { apart } else { 0.0 })
        });
        let f = plane(&w, [-1.0, 0.1, -1.0, 0.1], 0.3, "newton-ac");
        posed(&f, |system, increment| {
            let choice = Choice::parse(&f.method).unwrap();
            let mut solver = Solver::new(&choice, system).unwrap();
            let gauge = Gauge::new(increment).unwrap();
            let mut watch = Watch::new(&gauge);
            solver.watched(increment, &mut watch).unwrap();
            let own = Diagnosis::of(&Evidence {
                verdict: &Verdict::GaveUp(Status::SingularTangent),
                exact: true,
                tolerance: 1e-9,
                limit: None,
                watch: &watch,
                answers: &Answers::default(),
            });
            assert_eq!(own.cause == Cause::SingularTangent, singular, "{own:?}");
            assert!(!singular || own.measure <= 1e-10, "{own:?}");
        });
    }
}

/// Source: a geometric series. At the rate 1 − δ what is left is 1/δ times the last change: two decades for δ = 1e-2.
#[test]
fn a_test_by_changes_lies_by_the_decades_of_the_rate() {
    let rate = 0.99_f64;
    let iterate = |k: i32| {
        let left = rate.powi(k);
        let change = (1.0 - rate) * left / rate;
        Seen {
            violation: left,
            penetration: left,
            force_change: change,
            point_change: change,
            jump_change: change,
            pair_change: change,
            changes: usize::from(k < 3),
        }
    };
    let seen: Vec<Seen> = (0..2200).map(iterate).collect();
    let stops = evaluate("nsgs", true, &seen);
    let of = |name: &str| stops.iter().find(|stop| stop.criterion == name).unwrap();
    assert_eq!(stops.len(), 3, "{stops:?}");
    for name in ["force-change", "reaction-increment"] {
        let stop = of(name);
        // One iteration is 0.004 decades.
        assert!((stop.decades - 2.0).abs() < 0.01, "{stop:?}");
        assert!(stop.at < stop.reached, "{stop:?}");
    }
    let states = of("unchanged-states");
    assert_eq!(states.at, Some(3));
    assert!((states.decades - (9.0 + 3.0 * rate.log10())).abs() < 1e-9);
    // An approximate method can be held to its end alone.
    let stops = evaluate("penalty", false, &seen[..10]);
    let states = stops
        .iter()
        .find(|stop| stop.criterion == "unchanged-states");
    let off = 6.0 * -rate.log10();
    assert!(
        states.is_some_and(|stop| (stop.decades - off).abs() < 1e-9),
        "{stops:?}"
    );
}

/// A projection iteration on two nearly redundant points: states stand still after a few of many steps, by far too early.
/// Newton's method on active sets ends where they do, as published.
#[test]
fn unchanged_states_end_active_sets_and_nothing_else() {
    let near = 0.99;
    let w = [
        [1.0, 0.1, near, 0.0],
        [0.1, 1.0, 0.0, near],
        [near, 0.0, 1.0, 0.1],
        [0.0, near, 0.1, 1.0],
    ];
    for (method, lies) in [("projection", true), ("pdas", false)] {
        let f = plane(&w, [-1.0, 0.3, -0.995, 0.3], 0.3, method);
        assert_eq!(judged(method, &f), Verdict::Solved);
        posed(&f, |system, increment| {
            let choice = Choice::parse(method).unwrap();
            let mut solver = Solver::new(&choice, system).unwrap();
            let found = stops(&choice, &mut solver, increment).unwrap();
            let states = found
                .iter()
                .find(|stop| stop.criterion == "unchanged-states");
            let states = states.unwrap();
            assert_eq!(states.decades > 3.0, lies, "{method}: {states:?}");
            assert!(lies || states.decades == 0.0, "{method}: {states:?}");
        });
    }
}
