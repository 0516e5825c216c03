//! Limits that every registered method must reach: no load, no friction, large friction, an open crack.

use crate::toys::*;
use stickslip_methods::*;

#[test]
fn no_load_means_no_motion_and_no_force() {
    let floating = block(1.0, 1.5, 50.0, 2.0);
    for body in [spring_pair(1.0, 1.0), floating] {
        let s = system(&body, 0.3);
        for m in general() {
            let outcome = run(m, &[], &s, &force(&s, &vec![0.0; body.unknowns()]), 1e-9);
            if !converged(m, &outcome, "") {
                continue;
            }
            assert!(
                outcome
                    .state
                    .u
                    .iter()
                    .chain(&outcome.state.p)
                    .all(|&x| x == 0.0),
                "{}",
                m.name
            );
        }
    }
}

#[test]
fn without_friction_there_are_no_tangential_rows_and_no_tangential_forces() {
    let mut rng = Random(5);
    let (k, b) = random_body(&mut rng, 3, 5, 4, 0.2);
    let f = rng.vector(k.len());
    let shared = elastic(3, &k, &b, vec![], false);
    let slim = elastic(3, &k, &b, vec![], true);
    // The shared body condenses all rows, and its frictionless system takes the normal block.
    run(
        method("b-newton").unwrap(),
        &[],
        &system(&shared, 0.4),
        &force(&system(&shared, 0.4), &f),
        1e-6,
    );
    for (m, options, _) in all() {
        let mut forces = Vec::new();
        for body in [&shared, &slim] {
            let s = system(body, 0.0);
            assert_eq!((s.components(), s.rows()), (1, 5));
            let outcome = run(m, &options, &s, &force(&s, &f), 1e-9);
            if !converged(m, &outcome, "") {
                continue;
            }
            assert!(
                (0..5).all(|i| outcome.state.p[3 * i + 1..3 * i + 3] == [0.0, 0.0]),
                "{}",
                m.name
            );
            forces.push(outcome.state.p);
        }
        assert!(difference(&forces[0], &forces[1]) < 1e-7, "{}", m.name);
    }
    assert!(matches!(
        ContactSystem::new(slim, vec![0.1; 5]),
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
    for m in exact() {
        let load = force(&s, &f);
        let outcome = run(m, &[], &s, &load, 1e-9);
        if !converged(m, &outcome, "") {
            continue;
        }
        assert_eq!(
            (outcome.state.p[3], outcome.state.p[7]),
            (0.0, 0.0),
            "{}",
            m.name
        );
        assert!(
            outcome.state.p[2] > 0.0 || outcome.state.p[6] > 0.0,
            "the case must close such a point"
        );
        assert!(
            judge(&s, &load, &outcome.state).natural_map <= 1e-9,
            "{}",
            m.name
        );
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
    let load = Load {
        force: vec![0.0; k.len()],
        offset: q,
        traction: vec![],
    };
    for (m, options, tolerance) in all() {
        let outcome = run(m, &options, &s, &load, 1e-11);
        if !converged(m, &outcome, "") {
            continue;
        }
        assert!(
            difference(&outcome.state.p, &tied) < 10.0 * tolerance,
            "{}",
            m.name
        );
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
    let offset = (0..6)
        .map(|r| if r % 2 == 0 { jump[r].abs() + 0.1 } else { 0.0 })
        .collect();
    for m in general() {
        let body = elastic(2, &k, &b, vec![], false);
        let s = system(&body, 0.3);
        let load = Load {
            force: f.clone(),
            offset: Vec::clone(&offset),
            traction: vec![],
        };
        let outcome = run(m, &[], &s, &load, 1e-9);
        assert_eq!(
            (outcome.status, outcome.claim),
            (Status::Converged, Claim::Exact),
            "{}",
            m.name
        );
        let counters = outcome.counters;
        assert_eq!(
            (
                counters.iterations,
                counters.solves,
                counters.factorisations
            ),
            (0, 1, 0),
            "{}",
            m.name
        );
        assert!(
            difference(&outcome.state.u, &free) < 1e-12
                && outcome.state.p.iter().all(|&p| p == 0.0)
        );
        assert_eq!(judge(&s, &load, &outcome.state).natural_map, 0.0);
        assert_eq!(
            body.counters(),
            ElasticCounters {
                factorisations: 1,
                solves: 1,
                products: 0,
                condensations: 0
            }
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
            run(m, &[], &s, &force(&s, &rng.vector(k.len())), 1e-6);
        }
    }
    let counters = body.counters();
    assert_eq!((counters.factorisations, counters.condensations), (1, 1));
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
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], vec![], vec![]);
    for j in 0..3 {
        row_idx.extend((j..3).map(|i| 2 * i).chain([2 * j + 1]));
        values.extend((j..3).map(|i| normal[i][j]).chain([1.0]));
        col_ptr.extend([values.len() - 1, values.len()]);
    }
    let w = SymmetricMatrix::new(6, col_ptr, row_idx, values);
    let body = Elastic::from_delassus(2, w.unwrap(), vec![]).unwrap();
    let s = system(&body, 0.0);
    let load = Load {
        force: vec![0.0; 6],
        offset: vec![0.05277372, 0.0, 1.55333021, 0.0, -1.76164288, 0.0],
        traction: vec![],
    };
    for m in general() {
        let outcome = run(m, &[], &s, &load, 1e-9);
        if !converged(m, &outcome, "") {
            continue;
        }
        if m.name == "pdas" {
            let h: Vec<f64> = outcome.history.iter().map(|h| h.natural_map).collect();
            let again = |k: usize| (h[k] - h[k - 3]).abs() < 1e-9 && (h[k] - h[k - 1]).abs() > 0.1;
            assert!(h.len() > 12 && (4..12).all(again), "{h:?}");
        }
    }
}
