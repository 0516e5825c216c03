//! Work along load paths: what friction takes, what supports and loads do, and the state at time 0.

use crate::common::*;
use stickslip::case::{Case, shipped};
use stickslip::run::verdict::Verdict;
use stickslip::studies::results::Results;

/// A quantity of the whole body by increment.
fn history(results: &Results, quantity: &str) -> Vec<f64> {
    let mut runs = results.records();
    assert!(runs.all(|run| run.found.verdict == Verdict::Solved));
    let rows = results.quantities().into_iter().map(|row| row.quantity);
    rows.filter(|q| q.name == quantity && q.at.is_empty())
        .map(|q| q.value)
        .collect()
}

fn last(results: &Results, quantity: &str) -> f64 {
    *history(results, quantity).last().unwrap()
}

/// A plate pushed down, its crack inclined by 30 degrees.
fn pushed(increments: usize) -> Case {
    let rest = crack([-0.7484, -0.497], [0.8104, 0.403], 0.2, "auto")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[0, -1e-3]")
        + &format!("[path]\nincrements = {increments}\n");
    parse(&plane([-2.0, -2.0], [2.0, 2.0], [21, 21], &rest))
}

/// Source: energy balance; under one growing load slip and pressure grow in proportion. Goal: friction takes what the supports do
/// and the body does not store, in one increment as in many, on the crack as on all.
/// Tolerance 1e-8: that of the contact laws, 1e-9, on a work a few times that of friction.
#[test]
fn friction_takes_what_the_supports_do_and_the_body_does_not_store() {
    let mut found = Vec::new();
    for increments in [1, 4] {
        let results = run(&pushed(increments), &[METHOD]);
        assert_eq!(results.increments().len(), increments);
        let of = |quantity| last(&results, quantity);
        let dissipation = of("dissipation");
        let lost = of("external_work") - of("strain_energy");
        assert!(dissipation > 0.01 * of("strain_energy"));
        assert!(
            (dissipation - lost).abs() < 1e-8 * lost,
            "{dissipation} {lost}"
        );
        assert!(of("path_error") < 1e-8 && of("initial_stress_work") == 0.0);
        let at_end = |k: &stickslip::studies::rows::RunKey| k.increment == increments;
        let own = value(&results, at_end, ["dissipation", "crack-1", ""]);
        assert_eq!(own, dissipation);
        found.push(dissipation);
    }
    assert!((found[1] - found[0]).abs() < 1e-8 * found[0], "{found:?}");
}

/// The partial slip cycle with so many increments from turn to turn.
fn cycle(per_leg: usize) -> Results {
    let mut case = shipped::find("partial_slip_cycle").unwrap().unwrap();
    case.expects.clear();
    case.sweep.refine = vec![2];
    let history = vec![[0.0, 0.0], [1.0, 1.0], [2.0, -1.0], [3.0, 1.0]];
    case.exact.as_mut().unwrap().history = stickslip::case::History::Points(history);
    (case.path.increments, case.path.end) = (3 * per_leg, 3.0);
    run(&case, &[METHOD])
}

/// Source: closed form of the case: a cycle takes four times what first loading does, whatever the number of increments, for the
/// pressure is constant. Goal: so it is with one increment from turn to turn, from the state under pressure at time 0 on; the
/// trapezoid, wrong there, approaches it.
/// Tolerances: 2 % are the mesh; increments change nothing beyond 1 %, what stick-slip boundaries between them leave.
#[test]
fn slip_that_turns_takes_what_it_does_in_many_increments() {
    let [one, four, many] = [1, 4, 16].map(cycle);
    let taken = |results: &Results, per_leg: usize| {
        let w = history(results, "dissipation");
        assert_eq!((w.len(), w[0]), (1 + 3 * per_leg, 0.0));
        [w[per_leg], w[3 * per_leg] - w[per_leg]]
    };
    let reference = taken(&many, 16);
    for (results, per_leg) in [(&one, 1), (&four, 4), (&many, 16)] {
        let [first, cycle] = taken(results, per_leg);
        assert!((cycle / first - 4.0).abs() < 0.08, "{first} {cycle}");
        for (found, exact) in [first, cycle].iter().zip(reference) {
            assert!((found - exact).abs() < 0.01 * exact, "{found} {exact}");
        }
    }
    let errors = [&one, &four, &many].map(|results| last(results, "path_error"));
    assert!(errors[0] > 0.5, "{errors:?}");
    assert!(
        errors[1] < 0.5 * errors[0] && errors[2] < 0.5 * errors[1],
        "{errors:?}"
    );
}

/// Goal: what acts at time 0 is there before the first increment, with its slip and without work; loads that stay do none later;
/// where nothing acts at time 0 a path has no increment 0. Tolerance 1e-9 of the stored energy: that of the contact laws.
#[test]
fn the_state_at_time_0_comes_first_and_its_work_is_not_counted() {
    let text = pushed(2).source.replace(
        "displacement_m = [0, -1e-3]",
        "displacement_m = [0, -1e-3]\nhistory = \"constant\"",
    );
    let results = run(&parse(&text), &[METHOD]);
    let increments: Vec<usize> = results
        .increments()
        .iter()
        .map(|r| r.key.increment)
        .collect();
    assert_eq!(increments, [0, 1, 2]);
    let stored = history(&results, "strain_energy");
    let slip = history(&results, "max_slip");
    assert!(slip[0] > 1e-5 && stored[0] > 0.0);
    for k in 0..3 {
        assert!((slip[k] - slip[0]).abs() < 1e-9 * slip[0], "{slip:?}");
        assert!(
            (stored[k] - stored[0]).abs() < 1e-9 * stored[0],
            "{stored:?}"
        );
        for quantity in ["dissipation", "external_work"] {
            let work = history(&results, quantity)[k];
            assert!(work.abs() < 1e-9 * stored[0], "{quantity}: {work:e}");
        }
    }
    let same = run(&pushed(1), &[METHOD]);
    let mut same = same.points();
    let own = results
        .points()
        .into_iter()
        .filter(|p| p.key.increment == 0);
    for (a, b) in same.drain(..).zip(own) {
        assert_eq!(
            (a.point.p_n, a.point.slip_a_m),
            (b.point.p_n, b.point.slip_a_m)
        );
    }
}

/// Goal: on random scenes, loaded at time 0 or not, by displacements, pressure and an initial stress that turn, with faces that
/// open and close: friction never gives, and equilibrium makes the balance of work an identity in every increment and in sum.
/// Tolerance 1e-8 of the sum of its terms.
#[test]
fn friction_never_gives_and_work_balances_on_random_scenes() {
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let (mut taken, mut opened, mut stressed) = (0, 0, 0);
    for _ in 0..12 {
        let mut points = || [0; 2].map(|_| random.between(0.1, 0.9));
        let (from, to) = (points(), points());
        let friction = random.between(0.0, 1.0);
        let mut path = |size: f64| {
            let mut factor = || size * random.between(-1.0, 1.0);
            let points: Vec<[f64; 2]> = (0..5).map(|t| [f64::from(t), factor()]).collect();
            format!("history = {points:?}\n")
        };
        let rest = crack(from, to, friction, "auto")
            + &support("\"bottom\"", "[0, 0]")
            + &support("\"top\"", "[1e-2, \"free\"]")
            + &path(1.0)
            + "[[load]]\non = \"top\"\npressure_pa = 2e-3\nhistory = \"constant\"\n"
            + "[[load]]\non = \"left\"\npressure_pa = 5e-3\n"
            + &path(1.0)
            + "[[load]]\ninitial_stress_pa = [-1e-3, -2e-3, 1e-3]\n"
            + &path(1.0)
            + "[path]\nincrements = 8\nend = 4\n";
        let results = run(
            &parse(&plane([0.0, 0.0], [1.0, 1.0], [11, 11], &rest)),
            &[METHOD],
        );
        let of = |quantity| history(&results, quantity);
        let (friction, stored) = (of("dissipation"), of("strain_energy"));
        assert!(
            friction.is_sorted() && friction[0] == 0.0,
            "{friction:?}\n{rest}"
        );
        let identity = of("energy_identity");
        assert!(identity.iter().all(|e| *e < 1e-8), "{identity:?}\n{rest}");
        let (work, initial) = (of("external_work"), of("initial_stress_work"));
        let (error, opening) = (of("path_error"), of("max_gap"));
        for k in 1..work.len() {
            let left = work[k] + initial[k] - (stored[k] - stored[0]) - friction[k];
            let size = work[k].abs() + initial[k].abs() + stored[k] + stored[0];
            if friction[k] > 0.0 {
                let off = (left.abs() - error[k] * friction[k]).abs();
                assert!(off < 1e-8 * size, "{left:e}\n{rest}");
            }
        }
        taken += usize::from(friction[8] > 1e-3 * stored[8]);
        opened += usize::from(opening.iter().any(|gap| *gap > 1e-5));
        stressed += usize::from(initial[8].abs() > 1e-3 * stored[8]);
    }
    assert!(
        taken >= 4 && opened >= 4 && stressed >= 6,
        "{taken} {opened} {stressed}"
    );
}
