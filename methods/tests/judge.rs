//! The judge against states made to deceive it: what is wrong must read as wrong.

use std::sync::Arc;

use stickslip_methods::*;

use crate::toys::*;

/// Points of unit compliance without coupling, 2D, that one rigid motion along all normals leaves free.
fn floating_points(count: usize) -> Arc<Elastic> {
    let unit = sparse(&diagonal(&vec![1.0; 2 * count]));
    Elastic::from_delassus(2, unit, vec![[1.0, 0.0].repeat(count)]).unwrap()
}

/// One point pressed by 1 N. Only P_n = 1 N balances; without any force, or with 7 N, the body would fly off.
#[test]
fn forces_that_do_not_balance_a_floating_body_are_seen_though_w_does_not_see_them() {
    let s = system(&floating_points(1), 0.3);
    let load = force(&s, &[-1.0, 0.0]);
    for (p, lift, right) in [(1.0, 0.0, true), (0.0, 100.0, false), (7.0, -6.0, false)] {
        let (u, p) = (vec![p - 1.0 + lift, 0.0], vec![p, 0.0]);
        let found = judge(&s, &load, &ContactState { u, p });
        let holds = found.equilibrium <= 1e-12 && found.violation <= 1e-9;
        assert_eq!(holds, right, "{found:?}");
    }
}

/// W = I, q = (−1, 0.5). The natural map of faces that overlap without forces, and of friction without pressure, falls
/// like 1/μ: it alone would let both pass.
#[test]
fn no_friction_coefficient_hides_an_overlap_or_a_force_outside_the_cone() {
    let unit = sparse(&diagonal(&[1.0; 2]));
    let body = Elastic::from_delassus(2, unit, vec![]).unwrap();
    for mu in [0.0, 0.3, 2e3, 1e5, 1e10] {
        let s = system(&body, mu);
        let overlap = ContactState {
            u: vec![-1.0, 0.5],
            p: vec![0.0; 2],
        };
        let found = judge(&s, &force(&s, &[-1.0, 0.5]), &overlap);
        // u_ref = |q|, without a tangential row |q_n|.
        let u_ref = if mu == 0.0 { 1.0 } else { 1.25_f64.sqrt() };
        assert_near(found.penetration, 1.0 / u_ref, 1e-15, mu);
        assert_eq!(found.violation, found.penetration.max(found.natural_map));
        assert!(mu < 1.0 || found.natural_map < 2.0 / mu, "{found:?}");

        let outside = ContactState {
            u: vec![0.0; 2],
            p: vec![0.0, 1.0],
        };
        let found = judge(&s, &force(&s, &[0.0, -1.0]), &outside);
        // Without friction nothing reads P_t, and P_ref is 0.
        assert!(found.cone >= 1.0 && found.violation >= 1.0, "{found:?}");
        assert!(mu < 1.0 || found.natural_map < 2.0 / mu, "{found:?}");
    }
}

/// Above some μ a crack that is pressed everywhere sticks, and more friction changes nothing. Methods may give up then.
#[test]
fn whoever_claims_an_answer_for_huge_friction_has_that_of_large_friction() {
    let mut rng = Random(31);
    let (k, b) = random_body(&mut rng, 2, 6, 6, 0.3);
    let body = elastic(2, &k, &b, vec![], false);
    // Forces that press every point: f = −Bᵀ (1, 0.4).
    let f: Vec<f64> = (0..k.len())
        .map(|j| {
            b.iter()
                .zip([1.0, 0.4].repeat(6))
                .map(|(row, p)| -row[j] * p)
                .sum()
        })
        .collect();
    let stick = system(&body, 10.0);
    let reference = run(
        method("hybrid").unwrap(),
        &[],
        &stick,
        &force(&stick, &f),
        1e-12,
    );
    assert_eq!(reference.status, Status::Converged);
    assert!((0..6).all(|i| reference.state.p[2 * i] > 0.1));
    // De Saxcé's term multiplies the rounding of d by μ: for 1e10 it alone exceeds tier high.
    for (mu, least) in [(2e3, 8), (1e5, 5), (1e10, 0)] {
        let s = system(&body, mu);
        let load = force(&s, &f);
        for tier in Tier::ALL {
            let mut claims = 0;
            for m in exact() {
                let outcome = run(&m, &[], &s, &load, tier.tolerance());
                if outcome.status != Status::Converged {
                    continue;
                }
                claims += 1;
                let off = difference(&outcome.state.p, &reference.state.p);
                // The condition of W is below 1e3.
                let at = format!("{} {mu:e} {tier}: {off:e}", m.name);
                assert!(off <= 1e3 * tier.tolerance(), "{at}");
            }
            assert!(claims >= least, "{mu:e} {tier}: {claims}");
        }
    }
}

/// Pressed, then let go: at zero load nothing is left to be relative to. Whoever claims an answer has P = 0, without
/// running into underflow; cone programmes without data and the central path may say that they found none.
#[test]
fn a_floating_body_let_go_ends_without_forces() {
    let body = floating_points(3);
    let s = system(&body, 0.4);
    let rest = Load::zero(&body);
    let pressed = force(&s, &[-1.0, 0.3, -2.5, 0.0, -0.5, 0.0]);
    for m in exact() {
        let mut method = build(&m, &[]);
        let virgin = ContactState::zero(&s);
        let first = increment(&s, &pressed, &rest, &virgin, 1e-9);
        let before = method.solve(&first, &mut Silent).unwrap();
        if !converged(&m, &before) {
            continue;
        }
        let second = increment(&s, &rest, &pressed, &before.state, 1e-9);
        let after = method.solve(&second, &mut Silent).unwrap();
        if after.status != Status::Converged {
            let excused = ["socp", "tresca", "interior-point"];
            assert!(excused.contains(&m.name), "{}", m.name);
            continue;
        }
        let found = residuals(&second, &after.state).unwrap();
        let holds = found.violation <= 1e-9 && found.equilibrium <= 1e-12;
        assert!(holds, "{}: {found:?}", m.name);
        let largest = |p: &[f64]| p.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let left = largest(&after.state.p) / largest(&before.state.p);
        assert!(left <= 1e-8, "{}: {left:e}", m.name);
        assert!(after.history.len() < 3000, "{}", m.name);
    }
}

#[test]
fn claims_with_parameters_that_say_nothing_are_refused() {
    let body = spring_pair(1.0, 1.0);
    let s = system(&body, 0.3);
    let load = force(&s, &[-1.0, 0.0]);
    let (rest, start) = (Load::zero(&body), ContactState::zero(&s));
    let i = increment(&s, &load, &rest, &start, 1e-9);
    for bad in [0.0, -1.5, f64::NAN, f64::INFINITY] {
        #[rustfmt::skip]
        let claims = [
            Claim::Penalised { normal: bad, tangential: 1.0 },
            Claim::Penalised { normal: 1.0, tangential: bad },
            Claim::Barrier { gap: bad, slip: 1.0, stiffness: 1.0 },
            Claim::Nitsche { theta: 1.0, gamma: bad },
        ];
        for claim in claims {
            let error = residuals_of(&i, &start, claim).unwrap_err();
            assert!(
                matches!(error, MethodError::Range { .. }),
                "{claim:?}: {error}"
            );
        }
    }
}

/// Two points pressed on each other, W = [1 −1; −1 1] on their normals, and one beside. Only W tells the forces of the first two apart
/// from none, and it does not feel 1e10 against 1e10.
fn opposed(last: f64) -> Arc<Elastic> {
    let mut w = diagonal(&[1.0, 1.0, 1.0, 1.0, last, 1.0]);
    (w[0][2], w[2][0]) = (-1.0, -1.0);
    Elastic::from_delassus(2, sparse(&w), vec![]).unwrap()
}

/// q = −1 at the point beside. Whatever presses the others, its overlap is all of q; the right answer with a self-stress that
/// rounding of W P can bear holds, a larger one is at least told as rounding.
#[test]
fn forces_that_w_does_not_feel_buy_no_overlap() {
    let s = system(&opposed(1.0), 0.3);
    let load = free_jump(&[0.0, 0.0, 0.0, 0.0, -1.0, 0.0]);
    for stress in [0.0, 1.0, 1e5, 1e10, 1e30, 1e150, 1e300] {
        let mut p = vec![stress, 0.0, stress, 0.0, 0.0, 0.0];
        let u = vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let wrong = judge(&s, &load, &ContactState { u, p: p.clone() });
        assert_near(wrong.penetration, 1.0, 1e-15, stress);
        assert_eq!((wrong.reference_force, wrong.reference_jump), (1.0, 1.0));
        p[4] = 1.0;
        let u = vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let right = judge(&s, &load, &ContactState { u, p });
        assert!(right.violation <= 1e-15, "{stress:e}: {right:?}");
        assert_eq!(right.rounding > 1e-9, stress > 1e6, "{right:?}");
    }
}

/// The point beside does not yield: no force opens it, and no motion of the others either. Nor do two that a gap of 1 pinches by 2.
#[test]
fn no_method_solves_and_a_proof_refutes_what_has_no_solution() {
    for (last, q, none) in [
        (0.0, [0.0, 0.0, 0.0, 0.0, -1.0, 0.0], true),
        (1.0, [-2.0, 0.0, 1.0, 0.0, -1.0, 0.0], true),
        (1.0, [-1.0, 0.0, 1.0, 0.0, -1.0, 0.0], false),
        // A soft mode proves nothing.
        (1e-12, [-1.0, 0.0, 1.0, 0.0, -1.0, 0.0], false),
    ] {
        let s = system(&opposed(last), 0.3);
        let (load, rest) = (free_jump(&q), Load::zero(s.elastic()));
        let start = ContactState::zero(&s);
        let i = increment(&s, &load, &rest, &start, 1e-9);
        assert_eq!(conic::no_equilibrium(&i).unwrap(), none, "{q:?}");
        for m in exact().filter(|_| none) {
            let outcome = build(&m, &[]).solve(&i, &mut Silent);
            let claims = outcome.is_ok_and(|outcome| outcome.status == Status::Converged);
            assert!(!claims, "{} {q:?}", m.name);
        }
    }
}

/// ρ |q| leaves the range of numbers: nothing could be compared with it.
#[test]
fn what_numbers_cannot_hold_is_refused_by_name() {
    let stiff = Elastic::from_delassus(2, sparse(&diagonal(&[1e-301; 2])), vec![]).unwrap();
    let s = system(&stiff, 0.3);
    let (load, rest) = (free_jump(&[-1e149, 0.0]), Load::zero(&stiff));
    let start = ContactState::zero(&s);
    let i = increment(&s, &load, &rest, &start, 1e-9);
    for m in exact() {
        let error = build(&m, &[]).solve(&i, &mut Silent).unwrap_err();
        assert!(
            matches!(error, MethodError::Refused { .. }),
            "{}: {error}",
            m.name
        );
    }
}

/// Two springs, the second 1e-14 as stiff and 1.5 times where its force puts it: beside the force of the first, the norm of
/// all loses 0.2 of that of the second, its own row does not.
#[test]
fn displacements_of_a_soft_part_are_held_to_its_own_forces() {
    let (k, b) = (diagonal(&[1.0, 1e-14]), diagonal(&[1.0, 0.0]));
    let s = system(&elastic(2, &k, &b, vec![], false), 0.0);
    let load = force(&s, &[1.0, 1e-14]);
    for (soft, right) in [(1.0, true), (1.0 + 1e-6, false), (1.5, false)] {
        let (u, p) = (vec![1.0, soft], vec![0.0; 2]);
        let found = judge(&s, &load, &ContactState { u, p });
        assert_eq!(found.equilibrium <= 1e-12, right, "{found:?}");
    }
}
