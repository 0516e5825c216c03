//! The condensed increment that goes into interchange files.

use crate::toys::*;
use stickslip_methods::*;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves the increment, and the body given by its local form alone.
fn both(increment: &Increment<'_>, method: &Method) -> (LocalForm, ContactState, ContactState) {
    let form = increment.local_form().unwrap();
    let solved = run_from(method, &[], increment);
    assert_eq!(solved.status, Status::Converged, "{}", method.name);
    let dim = increment.system.dim();
    let body = Elastic::from_delassus(dim, form.w.clone(), form.modes.clone()).unwrap();
    // V is orthonormal: f = −V c has Vᵀ f = −c.
    let mut f = vec![0.0; form.q.len()];
    for (mode, c) in form.modes.iter().zip(&form.balance) {
        f.iter_mut().zip(mode).for_each(|(f, v)| *f -= c * v);
    }
    let mut free = f.clone();
    body.solve(&mut free).unwrap();
    let load = Load {
        force: f,
        offset: form.q.iter().zip(&free).map(|(q, free)| q - free).collect(),
        traction: vec![],
    };
    let s = ContactSystem::new(body, increment.system.friction().to_vec()).unwrap();
    let again = run(method, &[], &s, &load, 1e-9);
    assert_eq!(again.status, Status::Converged, "{}", method.name);
    assert!(judge(&s, &load, &again.state).natural_map <= 1e-9);
    (form, solved.state, again.state)
}

#[test]
fn it_is_the_delassus_operator_and_the_jump_without_contact_forces() {
    let mut rng = Random(3);
    for dim in [2, 3] {
        let (k, b) = random_body(&mut rng, dim, 4, 3, 0.2);
        let s = system(&elastic(dim, &k, &b, vec![], false), 0.0);
        let load = force(&s, &rng.vector(k.len()));
        let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
        let form = increment(&s, &load, &rest, &start, 1e-9)
            .local_form()
            .unwrap();
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
        for method in exact() {
            let (_, direct, local) = both(&increment(&s, &load, &first, &start, 1e-10), method);
            assert!(difference(&local.p, &direct.p) < 1e-7, "{}", method.name);
        }
    }
}

#[test]
fn floating_bodies_keep_their_balance() {
    for lateral in [0.0, 2.0] {
        let s = system(&block(1.0, 1.5, 50.0, lateral), 0.5);
        let load = force(&s, &[0.0, 0.0, 0.1, 0.0, 0.2, -4.0]);
        let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
        for method in exact() {
            let (form, direct, local) = both(&increment(&s, &load, &rest, &start, 1e-10), method);
            assert_eq!(form.modes.len(), s.elastic().floating().len());
            for (mode, c) in form.modes.iter().zip(&form.balance) {
                assert!((dot(mode, mode) - 1.0).abs() < 1e-14);
                assert!((dot(mode, &direct.p) - c).abs() < 1e-9 * c.abs().max(1.0));
            }
            assert!(difference(&local.p, &direct.p) < 1e-7, "{}", method.name);
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
