//! The monolithic variants take the same iterates as the condensed ones; a body given by its Delassus operator has the
//! same answers as the body it came from.

use std::sync::Arc;

use crate::toys::*;
use stickslip_methods::*;

/// Methods with a monolithic variant.
fn variants() -> impl Iterator<Item = &'static Method> {
    let has = |m: &&Method| m.options.iter().any(|o| o.name() == "monolithic");
    methods().filter(has)
}

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
    problems.push((
        block(1.0, 1.5, 50.0, 2.0),
        0.9,
        vec![0.0, 0.0, 0.0, 0.0, 0.5, -2.0],
        1e-8,
    ));
    problems
}

#[test]
fn every_monolithic_variant_has_the_same_iterates() {
    let names: Vec<&str> = variants().map(|m| m.name).collect();
    for name in ["b-newton", "newton-ac", "penalty", "augmented-lagrangian"] {
        assert!(names.contains(&name), "{name}");
    }
    for m in variants() {
        let pairs = problems().into_iter().zip(problems());
        for ((body, mu, f, rounding), (fresh, ..)) in pairs {
            let s = system(&body, mu);
            let load = force(&s, &f);
            let condensed = run(m, &[], &s, &load, 100.0 * rounding);
            assert!(judge(&s, &load, &condensed.state).natural_map.is_finite());
            let formed = body.counters().condensations;
            let alone = system(&fresh, mu);
            let load = force(&alone, &f);
            let whole = run(m, &[("monolithic", 1.0)], &alone, &load, 100.0 * rounding);
            assert!(judge(&alone, &load, &whole.state).natural_map.is_finite());
            // Neither the monolithic run nor the judge forms W.
            let counters = fresh.counters();
            assert_eq!((formed, counters.condensations), (1, 0), "{}", m.name);
            assert!(counters.products > 0, "{}", m.name);
            let at = format!("{} dim {} mu {mu}", m.name, s.dim());
            assert_eq!(condensed.status, Status::Converged, "{at}");
            assert_eq!(whole.status, Status::Converged, "{at}");
            assert_eq!(whole.history.len(), condensed.history.len(), "{at}");
            for (a, b) in whole.history.iter().zip(&condensed.history) {
                // Rounding of an iterate far from converged is relative to its own residual.
                let rounding = 1e-9 * b.natural_map + rounding;
                assert!(
                    (a.natural_map - b.natural_map).abs() < rounding,
                    "{at}: {a:?} {b:?}"
                );
                assert_eq!(a.changes, b.changes, "{at}");
            }
            assert!(
                difference(&whole.state.p, &condensed.state.p) < 1e-9,
                "{at}"
            );
            let (one, other) = (whole.counters, condensed.counters);
            // A rescue factors its global stage, each in its own way.
            assert_eq!(other.global_factorisations, 0, "{at}");
            assert_eq!(
                one.factorisations + one.global_factorisations,
                other.factorisations,
                "{at}"
            );
            assert!(one.global_factorisations > 0, "{at}");
        }
    }
}

/// The Delassus operator of a body as a sparse matrix.
fn sparse(w: &Rows) -> SymmetricMatrix {
    let m = w.len();
    let row_idx = (0..m).flat_map(|j| j..m).collect();
    let values = (0..m)
        .flat_map(|j| (j..m).map(move |i| (i, j)))
        .map(|(i, j)| w[i][j]);
    let col_ptr = (0..=m).scan(0, |sum, j| {
        let begin = *sum;
        *sum += m - j;
        Some(begin)
    });
    SymmetricMatrix::new(m, col_ptr.collect(), row_idx, values.collect()).unwrap()
}

#[test]
fn a_body_known_by_its_delassus_operator_has_the_same_contact_forces() {
    for (dim, mu) in [(2, 0.4), (3, 0.4), (3, 0.0)] {
        let mut rng = Random(29);
        let (k, b) = random_body(&mut rng, dim, 6, 9, 0.1);
        let f = rng.vector(k.len());
        let whole = system(&elastic(dim, &k, &b, vec![], false), mu);
        let bare = Elastic::from_delassus(dim, sparse(&delassus(&k, &b)), vec![]).unwrap();
        assert!(bare.stiffness().is_none());
        let bare = system(&bare, mu);
        let load = Load {
            force: vec![0.0; dim * 6],
            offset: mul(&b, &solve(&k, &f)),
            traction: vec![],
        };
        for m in exact() {
            let at = format!("{} dim {dim} mu {mu}", m.name);
            let reference = run(m, &[], &whole, &force(&whole, &f), 1e-10);
            let outcome = run(m, &[], &bare, &load, 1e-10);
            assert_eq!(outcome.status, Status::Converged, "{at}");
            assert!(
                difference(&outcome.state.p, &reference.state.p) < 1e-7,
                "{at}"
            );
            let judged = judge(&bare, &load, &outcome.state);
            assert!(
                judged.natural_map <= 1e-10 && judged.equilibrium < 1e-13,
                "{at}: {judged:?}"
            );
        }
        for m in variants() {
            let refusal = build(m, &[("monolithic", 1.0)]).refuses(&bare);
            assert!(refusal.unwrap().contains("stiffness"), "{}", m.name);
        }
    }
}

/// A floating body by its Delassus operator: unit compliance, one rigid motion along all normals.
#[test]
fn rigid_motions_of_a_delassus_body_balance_the_load() {
    let unit: Rows = diagonal(&[1.0; 4]);
    let body = Elastic::from_delassus(2, sparse(&unit), vec![vec![1.0, 0.0, 1.0, 0.0]]).unwrap();
    let s = system(&body, 0.5);
    // Pressed by 2 N at the first point; the normal forces must sum to 2 N, tangential jumps 0.1 m push against friction.
    let load = Load {
        force: vec![-2.0, 0.0, 0.0, 0.0],
        offset: vec![0.0, 0.1, 0.0, 0.1],
        traction: vec![],
    };
    for m in exact() {
        let outcome = run(m, &[], &s, &load, 1e-11);
        if !converged(m, &outcome, "") {
            continue;
        }
        // g = W (f + P) + α = 0 at both: P − (2, 0) equal at both points, so P_n = (2, 0) + x, with 2 x + 2 = 2.
        let p = &outcome.state.p;
        assert!((p[0] + p[2] - 2.0).abs() < 1e-9, "{}: {p:?}", m.name);
        assert!(
            (p[0] - 2.0).abs() < 1e-9 && p[2].abs() < 1e-9,
            "{}: {p:?}",
            m.name
        );
        assert!((p[1] + 0.1).abs() < 1e-9, "sticks, {}: {p:?}", m.name);
        assert!(
            judge(&s, &load, &outcome.state).natural_map <= 1e-11,
            "{}",
            m.name
        );
    }
}
