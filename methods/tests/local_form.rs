//! The condensed increment that goes into interchange files.

use crate::toys::*;
use stickslip_methods::*;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves the increment, and the body given by its local form alone.
fn both(increment: &Increment<'_>, m: &Method) -> (LocalForm, ContactState) {
    let form = increment.local_form().unwrap();
    let direct = build(m, &[]).solve(increment, &mut Silent).unwrap();
    assert_eq!(direct.status, Status::Converged, "{}", m.name);
    let dim = increment.system.dim();
    let body = Elastic::from_delassus(dim, form.w.clone(), form.modes.clone()).unwrap();
    assert!(body.stiffness().is_none());
    // V is orthonormal: f = −V c has Vᵀ f = −c.
    let mut f = vec![0.0; form.q.len()];
    for (mode, c) in form.modes.iter().zip(&form.balance) {
        f.iter_mut().zip(mode).for_each(|(f, v)| *f -= c * v);
    }
    let mut free = f.clone();
    body.solve(&mut free).unwrap();
    let offset = form.q.iter().zip(&free).map(|(q, free)| q - free);
    let load = load(f, offset.collect());
    let s = ContactSystem::new(body, increment.system.friction().to_vec()).unwrap();
    let local = solved(m, &[], &s, &load, 1e-9).state;
    assert!(judge(&s, &load, &local).violation <= 1e-9);
    assert!(difference(&local.p, &direct.state.p) < 1e-7, "{}", m.name);
    if m.options.iter().any(|o| o.name() == "monolithic") {
        let refusal = build(m, &[("monolithic", 1.0)]).refuses(&s);
        assert!(refusal.unwrap().contains("stiffness"), "{}", m.name);
    }
    (form, direct.state)
}

#[test]
fn it_is_the_delassus_operator_and_the_jump_without_contact_forces() {
    let mut rng = Random(3);
    for dim in [2, 3] {
        let (k, b) = random_body(&mut rng, dim, 4, 3, 0.2);
        let s = system(&elastic(dim, &k, &b, vec![], false), 0.0);
        let load = force(&s, &rng.vector(k.len()));
        let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
        let i = increment(&s, &load, &rest, &start, 1e-9);
        let form = i.local_form().unwrap();
        let W = delassus(&k, &b);
        for j in 0..W.len() {
            let column = form.w.col_ptr()[j]..form.w.col_ptr()[j + 1];
            let expected: Vec<f64> = (j..W.len()).map(|i| W[i][j]).collect();
            assert!(difference(&form.w.values()[column], &expected) < 1e-11);
        }
        assert!(difference(&form.q, &mul(&b, &solve(&k, &load.force))) < 1e-11);
        assert!(form.modes.is_empty() && form.balance.is_empty());
    }
}

#[test]
fn a_body_known_by_it_alone_has_the_same_contact_forces() {
    let mut rng = Random(8);
    for dim in [2, 3] {
        let (k, b) = random_body(&mut rng, dim, 4, 3, 0.2);
        let body = elastic(dim, &k, &b, vec![], false);
        // Every other point without friction, and a start that has slipped already.
        let s = ContactSystem::new(body, vec![0.4, 0.0, 0.7, 0.0]).unwrap();
        let first = force(&s, &rng.vector(k.len()));
        let start = run(method("b-newton").unwrap(), &[], &s, &first, 1e-9).state;
        let load = force(&s, &rng.vector(k.len()));
        for m in exact() {
            both(&increment(&s, &load, &first, &start, 1e-10), &m);
        }
    }
}

#[test]
fn floating_bodies_keep_their_balance() {
    for lateral in [0.0, 2.0] {
        let s = system(&block(1.0, 1.5, 50.0, lateral), 0.5);
        let load = force(&s, &[0.0, 0.0, 0.1, 0.0, 0.2, -4.0]);
        let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
        for m in exact() {
            let (form, direct) = both(&increment(&s, &load, &rest, &start, 1e-10), &m);
            assert_eq!(form.modes.len(), s.elastic().floating().len());
            for (mode, c) in form.modes.iter().zip(&form.balance) {
                assert_near(dot(mode, mode), 1.0, 1e-14, m.name);
                assert_near(dot(mode, &direct.p), *c, 1e-9 * c.abs().max(1.0), m.name);
            }
        }
    }
}

#[test]
fn a_frictionless_body_has_no_tangential_rows_to_give() {
    let (k, b) = random_body(&mut Random(2), 2, 2, 1, 0.3);
    let s = system(&elastic(2, &k, &b, vec![], true), 0.0);
    let (load, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
    let refused = increment(&s, &load, &load, &start, 1e-9).local_form();
    assert_eq!(refused, Err(MethodError::NoTangentialRows));
}
