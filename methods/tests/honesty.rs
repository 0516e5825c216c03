//! Duties of every registered method: claims that hold, statuses, refusals.

use stickslip_methods::*;

use crate::toys::*;

#[test]
fn a_converged_claim_passes_the_judge_at_every_tier() {
    for tier in Tier::ALL {
        for (dim, mu) in [(2, 0.0), (2, 0.4), (2, 2.0), (3, 0.0), (3, 0.4), (3, 2.0)] {
            let mut rng = Random(13);
            for _ in 0..5 {
                let (k, b) = random_body(&mut rng, dim, 8, 6, 0.05);
                let s = system(&elastic(dim, &k, &b, vec![], false), mu);
                let load = force(&s, &rng.vector(k.len()));
                for m in general() {
                    let outcome = run(&m, &[], &s, &load, tier.tolerance());
                    let judged = judge(&s, &load, &outcome.state);
                    let at = format!("{} {tier}: {judged:?}", m.name);
                    assert!(judged.equilibrium < 1e-12, "{at}");
                    if outcome.claim != Claim::Exact {
                        assert!(!m.exact, "{at}");
                        continue;
                    }
                    let holds = judged.violation <= tier.tolerance();
                    assert!(holds || outcome.status != Status::Converged, "{at}");
                    let last = outcome.history.last().unwrap().violation;
                    let off = (last - judged.violation).abs();
                    assert!(off <= 1e-12 + 1e-6 * last, "{at}");
                }
            }
        }
    }
}

#[test]
fn limits_and_monitors_end_a_run_with_their_status() {
    struct StopAt(usize);
    impl Monitor for StopAt {
        fn step(&mut self, iteration: usize, violation: f64) -> bool {
            assert!(violation.is_finite());
            iteration < self.0
        }
    }
    let mut rng = Random(14);
    let (k, b) = random_body(&mut rng, 2, 8, 6, 0.05);
    let s = system(&elastic(2, &k, &b, vec![], false), 0.4);
    let load = force(&s, &rng.vector(k.len()));
    let (start, rest) = (ContactState::zero(&s), Load::zero(s.elastic()));
    for m in general() {
        let mut options = m.options.iter();
        let Some(limit) = options.find(|o| o.name().starts_with("max_")) else {
            continue;
        };
        let Outcome {
            status, counters, ..
        } = run(&m, &[(limit.name(), 1.0)], &s, &load, 1e-9);
        let found = (status, counters.iterations);
        assert_eq!(found, (Status::MaxIterations, 1), "{}", m.name);
        let i = increment(&s, &load, &rest, &start, 1e-9);
        let outcome = build(&m, &[]).solve(&i, &mut StopAt(1)).unwrap();
        let found = (outcome.status, outcome.history.len());
        assert_eq!(found, (Status::Stopped, 2), "{}", m.name);
    }
}

#[test]
fn malformed_input_is_refused_with_typed_errors() {
    use MethodError::{Range, Size};
    let body = spring_pair(1.0, 1.0);
    let s = system(&body, 0.3);
    let good = Load::zero(&body);
    let start = ContactState::zero(&s);
    for m in general() {
        let solve = |load: &Load, tolerance: f64| {
            let i = increment(&s, load, &good, &start, tolerance);
            build(&m, &[]).solve(&i, &mut Silent).unwrap_err()
        };
        let short = solve(&load(vec![0.0], vec![0.0; 2]), 1e-9);
        assert!(
            matches!(
                short,
                Size {
                    expected: 2,
                    found: 1,
                    ..
                }
            ),
            "{short}"
        );
        let nan = solve(&force(&s, &[0.0, f64::NAN]), 1e-9);
        assert!(matches!(nan, Range { index: 1, .. }), "{nan}");
        assert!(matches!(solve(&good, f64::NAN), Range { .. }));
    }
    for mu in [-0.1, f64::NAN, f64::INFINITY] {
        let refused = ContactSystem::new(body.clone(), vec![mu]);
        assert!(matches!(refused, Err(Range { .. })));
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
    let built = methods().map(|m| build(m, &[]));
    let needy: Vec<_> = built.filter(|m| m.needs().traction).collect();
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
            if outcome.status == Status::Converged {
                let (start, rest) = (ContactState::zero(&s), Load::zero(s.elastic()));
                let i = increment(&s, &load, &rest, &start, 1e-9);
                let judged = residuals_of(&i, &outcome.state, outcome.claim).unwrap();
                assert!(judged.claimed <= 1e-9, "{name} seed {seed}: {judged:?}");
                solved += 1;
            }
        }
        assert!(solved >= 300, "{name}: {solved}");
    }
}

/// A body that three points hold and nothing else, free to shift along the normals and to tilt: W = I. Unloaded, it may be
/// anywhere above the contact, also where tilting to where it was would sink a point.
#[test]
fn an_unloaded_floating_body_is_not_claimed_inside_the_other_side() {
    let shift = vec![1.0, 0.0, 1.0, 0.0, 1.0, 0.0];
    let tilt = vec![-1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let unit = sparse(&diagonal(&[1.0; 6]));
    let body = Elastic::from_delassus(2, unit, vec![shift, tilt]).unwrap();
    let s = system(&body, 0.3);
    let rest = Load::zero(&body);
    for m in general().filter(|m| build(m, &[]).refuses(&s).is_none()) {
        let mut instance = build(&m, &[]);
        let loaded = force(&s, &[-1.0, 0.0, -2.0, 0.0, 0.5, 0.0]);
        let (mut state, mut before) = (ContactState::zero(&s), rest.clone());
        for load in [loaded, rest.clone()] {
            let i = increment(&s, &load, &before, &state, 1e-9);
            let outcome = instance.solve(&i, &mut Silent).unwrap();
            let judged = residuals_of(&i, &outcome.state, outcome.claim).unwrap();
            if converged(&m, &outcome) {
                assert!(judged.claimed <= 1e-9, "{}: {judged:?}", m.name);
                (state, before) = (outcome.state, load);
            }
        }
    }
}
