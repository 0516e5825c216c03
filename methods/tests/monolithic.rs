//! The monolithic variants take the same iterates as the condensed ones; a floating body given by its Delassus operator.

use std::sync::Arc;

use crate::toys::*;
use stickslip_methods::*;

/// Bodies with their loads: coupled 2D and 3D, a floating block held by contact alone;
/// and the accuracy to compare at: the displacement form of springs 1e4 times stiffer than a body that floats on them
/// has a condition of 1e7.
fn problems() -> Vec<(Arc<Elastic>, f64, Vec<f64>, f64)> {
    let mut problems = Vec::new();
    for (dim, mu) in [(2, 0.3), (3, 0.3), (2, 0.0), (3, 0.9)] {
        let mut rng = Random(23);
        let (k, b) = random_body(&mut rng, dim, 8, 12, 0.1);
        let f = rng.vector(k.len());
        problems.push((elastic(dim, &k, &b, vec![], false), mu, f, 1e-12));
    }
    let held = vec![0.0, 0.0, 0.0, 0.0, 0.5, -2.0];
    problems.push((block(1.0, 1.5, 50.0, 2.0), 0.9, held, 1e-8));
    problems
}

/// Goal: on many rows of which few change a step uses earlier factors, and is the same step.
#[test]
fn steps_with_earlier_factors_are_those_of_the_whole_body() {
    let mut rng = Random(7);
    let (k, b) = random_body(&mut rng, 2, 300, 10, 1.0);
    let f = rng.vector(k.len());
    // Where pieces of b-newton meet, rounding decides between them.
    for name in ["newton-ac", "pdas"] {
        let m = method(name).unwrap();
        let [condensed, whole] = [0.0, 1.0].map(|monolithic| {
            let s = system(&elastic(2, &k, &b, vec![], false), 0.3);
            solved(m, &[("monolithic", monolithic)], &s, &force(&s, &f), 1e-10).unwrap()
        });
        let steps = condensed.history.len() - 1;
        assert!(steps >= 3, "{name}: {steps}");
        let [dense, sparse] = [
            condensed.counters.factorisations,
            whole.counters.global_factorisations,
        ];
        assert!(
            dense < steps && (1..=steps).contains(&sparse),
            "{name}: {dense} {steps} {sparse}"
        );
        for (a, b) in whole.history.iter().zip(&condensed.history) {
            assert_near(a.violation, b.violation, 1e-9 * b.violation + 1e-12, name);
            assert_eq!(a.changes, b.changes, "{name}");
        }
        assert!(
            difference(&whole.state.p, &condensed.state.p) < 1e-9,
            "{name}"
        );
    }
}

#[test]
fn every_monolithic_variant_has_the_same_iterates() {
    let has = |m: &&Method| m.options.iter().any(|o| o.name() == "monolithic");
    let variants: Vec<&Method> = methods().filter(has).collect();
    for name in ["b-newton", "newton-ac", "penalty", "augmented-lagrangian"] {
        assert!(variants.iter().any(|m| m.name == name), "{name}");
    }
    for m in variants {
        let pairs = problems().into_iter().zip(problems());
        for ((body, mu, f, rounding), (fresh, ..)) in pairs {
            let both = [(&body, 0.0), (&fresh, 1.0)].map(|(body, monolithic)| {
                let s = system(body, mu);
                let (load, given) = (force(&s, &f), [("monolithic", monolithic)]);
                let outcome = solved(m, &given, &s, &load, 100.0 * rounding)?;
                let judged = judge(&s, &load, &outcome.state);
                assert!(judged.violation.is_finite());
                Some(outcome)
            });
            let [Some(condensed), Some(whole)] = both else {
                continue;
            };
            let at = format!("{} dim {} mu {mu}", m.name, body.dim());
            // Neither the monolithic run nor the judge forms W.
            let formed = [&body, &fresh].map(|body| body.counters().condensations);
            assert_eq!(formed, [1, 0], "{at}");
            assert!(fresh.counters().products > 0, "{at}");
            assert_eq!(whole.history.len(), condensed.history.len(), "{at}");
            for (a, b) in whole.history.iter().zip(&condensed.history) {
                // Rounding of an iterate far from converged is relative to its own residual.
                let rounding = 1e-9 * b.violation + rounding;
                assert_near(a.violation, b.violation, rounding, &at);
                // Where pieces of b-newton meet, rounding decides between them.
                assert!(a.changes == b.changes || m.name == "b-newton", "{at}");
            }
            assert!(
                difference(&whole.state.p, &condensed.state.p) < 1e-9,
                "{at}"
            );
            let (one, other) = (whole.counters, condensed.counters);
            assert_eq!(other.global_factorisations, 0, "{at}");
            assert!(other.factorisations > 0, "{at}");
            assert!(one.global_factorisations > 0, "{at}");
        }
    }
}

/// A floating body by its Delassus operator: unit compliance, one rigid motion along all normals.
#[test]
fn rigid_motions_of_a_delassus_body_balance_the_load() {
    let unit = sparse(&diagonal(&[1.0; 4]));
    let body = Elastic::from_delassus(2, unit, vec![vec![1.0, 0.0, 1.0, 0.0]]).unwrap();
    let s = system(&body, 0.5);
    // Pressed by 2 N at the first point; the normal forces must sum to 2 N, tangential jumps 0.1 m push against friction.
    let load = load(vec![-2.0, 0.0, 0.0, 0.0], vec![0.0, 0.1, 0.0, 0.1]);
    for (m, outcome) in claims(exact(), &s, &load, 1e-11) {
        // g = W (f + P) + α = 0 at both: P − (2, 0) equal at both points, so P_n = (2, 0) + x, with 2 x + 2 = 2.
        for (p, exact) in outcome.state.p.iter().zip([2.0, -0.1, 0.0]) {
            assert_near(*p, exact, 1e-9, m.name);
        }
        assert!(
            judge(&s, &load, &outcome.state).violation <= 1e-11,
            "{}",
            m.name
        );
    }
}
