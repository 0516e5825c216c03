//! What every registered method must say about itself: claims that hold, statuses, refusals.

use crate::toys::*;
use stickslip_methods::*;

#[test]
fn a_converged_claim_passes_the_judge_at_every_tier() {
    for tier in Tier::ALL {
        for dim in [2, 3] {
            for mu in [0.0, 0.4, 2.0] {
                let mut rng = Random(13);
                for _ in 0..5 {
                    let (k, b) = random_body(&mut rng, dim, 8, 6, 0.05);
                    let s = system(&elastic(dim, &k, &b, vec![], false), mu);
                    let load = force(&s, &rng.vector(k.len()));
                    for m in general() {
                        let outcome = run(m, &[], &s, &load, tier.tolerance());
                        let judged = judge(&s, &load, &outcome.state);
                        assert!(judged.equilibrium < 1e-12, "{}: {judged:?}", m.name);
                        if outcome.status == Status::Converged && outcome.claim == Claim::Exact {
                            assert!(
                                judged.natural_map <= tier.tolerance(),
                                "{} {tier}: {judged:?}",
                                m.name
                            );
                        }
                        let last = outcome.history.last().unwrap().natural_map;
                        if outcome.claim == Claim::Exact {
                            assert!(
                                (last - judged.natural_map).abs() <= 1e-12 + 1e-6 * last,
                                "{}",
                                m.name
                            );
                        } else {
                            assert!(!m.exact, "{}", m.name);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn limits_and_monitors_end_a_run_with_their_status() {
    struct StopAt(usize);
    impl Monitor for StopAt {
        fn step(&mut self, iteration: usize, natural_map: f64) -> bool {
            assert!(natural_map.is_finite());
            iteration < self.0
        }
    }
    let mut rng = Random(14);
    let (k, b) = random_body(&mut rng, 2, 8, 6, 0.05);
    let s = system(&elastic(2, &k, &b, vec![], false), 0.4);
    let load = force(&s, &rng.vector(k.len()));
    let (start, rest) = (ContactState::zero(&s), force(&s, &vec![0.0; k.len()]));
    for m in general() {
        let limit = m
            .options
            .iter()
            .find(|o| matches!(o, OptionSpec::Whole(_)))
            .unwrap()
            .name();
        let outcome = run(m, &[(limit, 1.0)], &s, &load, 1e-9);
        assert_eq!(
            (outcome.status, outcome.counters.iterations),
            (Status::MaxIterations, 1),
            "{}",
            m.name
        );
        let i = increment(&s, &load, &rest, &start, 1e-9);
        let outcome = build(m, &[]).solve(&i, &mut StopAt(1)).unwrap();
        assert_eq!(
            (outcome.status, outcome.history.len()),
            (Status::Stopped, 2),
            "{}",
            m.name
        );
    }
}

#[test]
fn malformed_input_is_refused_with_typed_errors() {
    let body = spring_pair(1.0, 1.0);
    let s = system(&body, 0.3);
    let good = force(&s, &[0.0, 0.0]);
    let start = ContactState::zero(&s);
    for m in general() {
        let solve = |load: &Load, tolerance: f64| {
            build(m, &[])
                .solve(&increment(&s, load, &good, &start, tolerance), &mut Silent)
                .unwrap_err()
        };
        let short = Load {
            force: vec![0.0],
            offset: vec![0.0; 2],
            traction: vec![],
        };
        let nan = Load {
            force: vec![0.0, f64::NAN],
            offset: vec![0.0; 2],
            traction: vec![],
        };
        assert!(matches!(
            solve(&short, 1e-9),
            MethodError::Size {
                expected: 2,
                found: 1,
                ..
            }
        ));
        assert!(matches!(
            solve(&nan, 1e-9),
            MethodError::Range { index: 1, .. }
        ));
        assert!(matches!(solve(&good, f64::NAN), MethodError::Range { .. }));
    }
    for mu in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            ContactSystem::new(body.clone(), vec![mu]),
            Err(MethodError::Range { .. })
        ));
    }
}

#[test]
fn systems_and_methods_can_be_shared_between_threads() {
    fn shared<T: Send + Sync>() {}
    fn sent<T: Send + ?Sized>() {}
    shared::<ContactSystem>();
    sent::<dyn Enforcement>();
}

#[test]
fn methods_that_need_the_stress_refuse_bodies_without_it() {
    let s = system(&spring_pair(1.0, 1.0), 0.3);
    let needy: Vec<_> = methods()
        .map(|m| build(m, &[]))
        .filter(|m| m.needs().traction)
        .collect();
    assert!(!needy.is_empty());
    for method in needy {
        assert!(method.refuses(&s).unwrap().contains("no traction operator"));
    }
}

/// Springs and barriers have another norm than the judge, who weights slip by μ.
#[test]
fn a_claim_of_other_laws_passes_the_judge_of_those_laws_for_large_friction_too() {
    for name in ["penalty", "barrier"] {
        let mut solved = 0;
        for seed in 500..900 {
            let mut rng = Random(seed);
            let (k, b) = random_body(&mut rng, 3, 5, 3, 0.05);
            let s = system(&elastic(3, &k, &b, vec![], false), 50.0);
            let load = force(&s, &rng.vector(k.len()));
            let outcome = run(method(name).unwrap(), &[], &s, &load, 1e-9);
            if outcome.status != Status::Converged {
                continue;
            }
            let (start, rest) = (ContactState::zero(&s), Load::zero(s.elastic()));
            let i = increment(&s, &load, &rest, &start, 1e-9);
            let judged = residuals_of(&i, &outcome.state, outcome.claim).unwrap();
            assert!(judged.claimed <= 1e-9, "{name} seed {seed}: {judged:?}");
            solved += 1;
        }
        assert!(solved >= 300, "{name}: {solved}");
    }
}

/// A body that three points hold and nothing else, free to shift along the normals and to tilt: W = I. Unloaded, it may be
/// anywhere above the contact, also where tilting to where it was would sink a point.
#[test]
fn an_unloaded_floating_body_is_not_claimed_inside_the_other_side() {
    let unit = SymmetricMatrix::new(6, (0..=6).collect(), (0..6).collect(), vec![1.0; 6]).unwrap();
    let modes = vec![
        vec![1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
        vec![-1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    ];
    let body = Elastic::from_delassus(2, unit, modes).unwrap();
    let s = system(&body, 0.3);
    let rest = Load::zero(&body);
    for m in general().filter(|m| build(m, &[]).refuses(&s).is_none()) {
        let mut instance = build(m, &[]);
        let loaded = force(&s, &[-1.0, 0.0, -2.0, 0.0, 0.5, 0.0]);
        let (mut state, mut before) = (ContactState::zero(&s), rest.clone());
        for load in [loaded, rest.clone()] {
            let i = increment(&s, &load, &before, &state, 1e-9);
            let outcome = instance.solve(&i, &mut Silent).unwrap();
            let judged = residuals_of(&i, &outcome.state, outcome.claim).unwrap();
            if !converged(m, &outcome, "") {
                continue;
            }
            assert!(judged.claimed <= 1e-9, "{}: {judged:?}", m.name);
            (state, before) = (outcome.state, load);
        }
    }
}
