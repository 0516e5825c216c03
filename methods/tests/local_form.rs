//! The condensed increment that goes into interchange files.

use crate::toys::*;
use stickslip_methods::*;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves the increment, and the body given by its local form alone.
fn both(increment: &Increment<'_>, m: &Method) -> Option<(LocalForm, ContactState)> {
    let form = increment.local_form().unwrap();
    let direct = build(m, &[]).solve(increment, &mut Silent).unwrap();
    if !converged(m, &direct) {
        return None;
    }
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
    let local = solved(m, &[], &s, &load, 1e-9)?.state;
    assert!(judge(&s, &load, &local).violation <= 1e-9);
    assert!(difference(&local.p, &direct.state.p) < 1e-7, "{}", m.name);
    if m.options.iter().any(|o| o.name() == "monolithic") {
        let refusal = build(m, &[("monolithic", 1.0)]).refuses(&s);
        assert!(refusal.unwrap().contains("stiffness"), "{}", m.name);
    }
    Some((form, direct.state))
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
            let column: Vec<f64> = form.w.column(j).map(|(_, value)| value).collect();
            let expected: Vec<f64> = (j..W.len()).map(|i| W[i][j]).collect();
            assert!(difference(&column, &expected) < 1e-11);
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
            let of_form = both(&increment(&s, &load, &rest, &start, 1e-10), &m);
            let Some((form, direct)) = of_form else {
                continue;
            };
            assert_eq!(form.modes.len(), s.elastic().floating().len());
            for (mode, c) in form.modes.iter().zip(&form.balance) {
                assert_near(dot(mode, mode), 1.0, 1e-14, m.name);
                assert_near(dot(mode, &direct.p), *c, 1e-9 * c.abs().max(1.0), m.name);
            }
        }
    }
}

/// Goal: W of the normal rows stands among tangential ones that nothing is coupled to, of the mean size of its diagonal.
#[test]
fn a_frictionless_body_has_tangential_rows_that_move_nothing() {
    let mut rng = Random(2);
    let (k, b) = random_body(&mut rng, 2, 3, 1, 0.3);
    let s = system(&elastic(2, &k, &b, vec![], true), 0.0);
    let load = force(&s, &rng.vector(k.len()));
    let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
    let i = increment(&s, &load, &rest, &start, 1e-9);
    let form = i.local_form().unwrap();
    let (W, q) = (delassus(&k, &b), mul(&b, &solve(&k, &load.force)));
    let mean = (0..3).map(|i| W[2 * i][2 * i]).sum::<f64>() / 3.0;
    let mut entries = 0;
    for j in 0..6 {
        for (row, value) in form.w.column(j) {
            let expected = match (row % 2, j % 2) {
                (0, 0) => W[row][j],
                _ if row == j => mean,
                _ => panic!("({row}, {j}) is coupled"),
            };
            assert_near(value, expected, 1e-11, "W");
            entries += 1;
        }
        assert_near(form.q[j], if j % 2 == 0 { q[j] } else { 0.0 }, 1e-11, "q");
    }
    assert_eq!(entries, 6 + 3);
}

/// Goal: the way back. Forces with an imbalance of rounding are taken as they are but for that, and the state is that of the
/// method itself.
#[test]
fn forces_and_amplitudes_of_the_form_give_the_state() {
    let s = system(&block(1.0, 1.5, 50.0, 2.0), 0.5);
    let load = force(&s, &[0.0, 0.0, 0.1, 0.0, 0.2, -4.0]);
    let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(&s));
    let i = increment(&s, &load, &rest, &start, 1e-10);
    let direct = solved(method("b-newton").unwrap(), &[], &s, &load, 1e-10)
        .unwrap()
        .state;
    let form = i.local_form().unwrap();
    assert!(!form.modes.is_empty());
    // V is orthonormal: λ = Vᵀ (u − q − W r).
    let mut u = i.jump(&direct.u);
    let mut pressed = vec![0.0; u.len()];
    form.w.mul(&direct.p, &mut pressed);
    (u.iter_mut().zip(&form.q).zip(&pressed)).for_each(|((u, q), w)| *u -= q + w);
    let amplitudes: Vec<f64> = form.modes.iter().map(|v| dot(v, &u)).collect();
    let mut p = direct.p.clone();
    p[0] += 1e-9;
    let state = i.state_of(&p, &amplitudes).unwrap();
    assert!(difference(&state.u, &direct.u) < 1e-8);
    let found = residuals(&i, &state).unwrap();
    assert!(
        found.equilibrium < 1e-13 && found.violation < 1e-8,
        "{found:?}"
    );
    let short = i.state_of(&p[1..], &amplitudes);
    assert!(
        matches!(
            short,
            Err(MethodError::Size {
                found: 3,
                expected: 4,
                ..
            })
        ),
        "{short:?}"
    );
}
