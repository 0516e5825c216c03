//! Limits that every registered method must reach: no load, no friction, large friction, an open crack.

use stickslip_methods::*;

use crate::toys::*;

#[test]
fn no_load_means_no_motion_and_no_force() {
    for body in [spring_pair(1.0, 1.0), block(1.0, 1.5, 50.0, 2.0)] {
        let s = system(&body, 0.3);
        for (m, outcome) in claims(general(), &s, &Load::zero(&body), 1e-9) {
            assert_eq!(outcome.state, ContactState::zero(&s), "{}", m.name);
        }
    }
}

#[test]
fn without_friction_there_are_no_tangential_rows_and_no_tangential_forces() {
    let mut rng = Random(5);
    let (k, b) = random_body(&mut rng, 3, 5, 4, 0.2);
    let f = rng.vector(k.len());
    let [shared, slim] = [false, true].map(|slim| elastic(3, &k, &b, vec![], slim));
    // The shared body condenses all rows, and its frictionless system takes the normal block.
    let rough = system(&shared, 0.4);
    run(
        method("b-newton").unwrap(),
        &[],
        &rough,
        &force(&rough, &f),
        1e-6,
    );
    let [one, other] = [&shared, &slim].map(|body| {
        let s = system(body, 0.0);
        assert_eq!((s.components(), s.rows()), (1, 5));
        let load = force(&s, &f);
        let forces = claims(all(), &s, &load, 1e-9).map(|(m, outcome)| {
            let p = outcome.state.p;
            let none = p.chunks(3).all(|p| p[1..] == [0.0, 0.0]);
            assert!(none, "{}", m.name);
            (m.name, p)
        });
        forces.collect::<Vec<_>>()
    });
    for ((name, p), (same, q)) in one.iter().zip(&other) {
        assert!(name == same && difference(p, q) < 1e-7, "{name}");
    }
    let refused = ContactSystem::new(slim, vec![0.1; 5]);
    assert!(matches!(
        refused,
        Err(MethodError::FrictionlessBody { point: 0, .. })
    ));
}

#[test]
fn points_without_friction_among_others_carry_no_tangential_force() {
    let mut rng = Random(6);
    let (k, b) = random_body(&mut rng, 2, 4, 3, 0.2);
    let body = elastic(2, &k, &b, vec![], false);
    let s = ContactSystem::new(body, vec![0.5, 0.0, 0.5, 0.0]).unwrap();
    assert_eq!((s.components(), s.rows()), (2, 6));
    let f: Vec<f64> = rng.vector(k.len()).iter().map(|x| x - 1.0).collect();
    let load = force(&s, &f);
    for (m, outcome) in claims(exact(), &s, &load, 1e-9) {
        let p = &outcome.state.p;
        assert_eq!((p[3], p[7]), (0.0, 0.0), "{}", m.name);
        assert!(p[2] > 0.0 || p[6] > 0.0, "the case must close such a point");
        let found = judge(&s, &load, &outcome.state).violation;
        assert!(found <= 1e-9, "{}: {found:e}", m.name);
    }
}

#[test]
fn large_friction_under_closing_load_is_the_tied_solution() {
    let mut rng = Random(11);
    let (k, b) = random_body(&mut rng, 3, 4, 6, 0.5);
    let s = system(&elastic(3, &k, &b, vec![], false), 50.0);
    // A load whose tied contact forces are the given, strongly compressive ones.
    let tied: Vec<f64> = (0..12)
        .map(|r| if r % 3 == 0 { 2.0 } else { rng.next() })
        .collect();
    let q: Vec<f64> = mul(&delassus(&k, &b), &tied).iter().map(|x| -x).collect();
    for (m, outcome) in claims(all(), &s, &load(vec![0.0; k.len()], q), 1e-11) {
        let off = difference(&outcome.state.p, &tied);
        assert!(off < 10.0 * m.accuracy, "{}: {off:.1e}", m.name);
    }
}

#[test]
fn open_crack_is_one_linear_solve_and_is_never_condensed() {
    let mut rng = Random(2);
    let (k, b) = random_body(&mut rng, 2, 3, 5, 0.2);
    let f = rng.vector(k.len());
    let free = solve(&k, &f);
    let jump = mul(&b, &free);
    // An initial gap that the load does not close.
    let gap = |r: usize| {
        if r.is_multiple_of(2) {
            jump[r].abs() + 0.1
        } else {
            0.0
        }
    };
    let load = load(f, (0..6).map(gap).collect());
    for m in general() {
        let body = elastic(2, &k, &b, vec![], false);
        let s = system(&body, 0.3);
        let Outcome {
            status,
            claim,
            state,
            counters,
            ..
        } = run(&m, &[], &s, &load, 1e-9);
        assert_eq!(
            (status, claim),
            (Status::Converged, Claim::Exact),
            "{}",
            m.name
        );
        let work = (
            counters.iterations,
            counters.solves,
            counters.factorisations,
        );
        assert_eq!(work, (0, 1, 0), "{}", m.name);
        assert!(difference(&state.u, &free) < 1e-12 && state.p.iter().all(|&p| p == 0.0));
        assert_eq!(judge(&s, &load, &state).violation, 0.0);
        let ElasticCounters {
            factorisations,
            solves,
            products,
            condensations,
        } = body.counters();
        assert_eq!(
            [factorisations, solves, products, condensations],
            [1, 1, 0, 0]
        );
    }
}

#[test]
fn one_factorisation_serves_all_frictions_methods_and_increments() {
    let mut rng = Random(4);
    let (k, b) = random_body(&mut rng, 2, 6, 8, 0.2);
    let body = elastic(2, &k, &b, vec![], false);
    for mu in [0.0, 0.2, 0.7] {
        let s = system(&body, mu);
        for m in general() {
            run(&m, &[], &s, &force(&s, &rng.vector(k.len())), 1e-6);
        }
    }
    let counters = body.counters();
    assert_eq!((counters.factorisations, counters.condensations), (1, 1));
}

/// Goal: in 2D a tangent changes with the states of the points alone, and updates of multipliers that change none share its
/// factors.
#[test]
fn a_tangent_that_stays_is_not_factored_again() {
    let mut rng = Random(4);
    let (k, b) = random_body(&mut rng, 2, 6, 8, 0.2);
    let s = system(&elastic(2, &k, &b, vec![], false), 0.5);
    let m = method("augmented-lagrangian").unwrap();
    let load = force(&s, &rng.vector(k.len()));
    let outcome = solved(m, &[("stiffness", 1.0)], &s, &load, 1e-9).unwrap();
    let (updates, factored) = (outcome.counters.iterations, outcome.counters.factorisations);
    assert!(
        factored > 0 && updates > 5 * factored,
        "{updates} {factored}"
    );
}

/// W⁻¹ has positive entries off the diagonal, so nothing keeps the active set method from a cycle of three sets.
#[test]
fn a_cycle_of_active_sets_without_friction_is_left() {
    let normal = [
        [3.15467566, 3.4225866, -3.23428727],
        [3.4225866, 5.74884201, -6.11342967],
        [-3.23428727, -6.11342967, 6.79082924],
    ];
    // Rows (n, t) per point, the tangential ones not coupled.
    let entry = |i: usize, j: usize| match (i % 2, j % 2) {
        (0, 0) => normal[i / 2][j / 2],
        _ => f64::from(u8::from(i == j)),
    };
    let w: Rows = (0..6)
        .map(|i| (0..6).map(|j| entry(i, j)).collect())
        .collect();
    let body = Elastic::from_delassus(2, sparse(&w), vec![]).unwrap();
    let s = system(&body, 0.0);
    let load = free_jump(&[0.05277372, 0.0, 1.55333021, 0.0, -1.76164288, 0.0]);
    for (m, outcome) in claims(general(), &s, &load, 1e-9) {
        if m.name == "pdas" {
            let h: Vec<f64> = outcome.history.iter().map(|h| h.violation).collect();
            let again = |k: usize| (h[k] - h[k - 3]).abs() < 1e-9 && (h[k] - h[k - 1]).abs() > 0.1;
            assert!(h.len() > 12 && (4..12).all(again), "{h:?}");
        }
    }
}
