//! Every registered method against systems solved by hand or by enumeration.

use stickslip_methods::*;

use crate::toys::*;

#[test]
fn one_spring_pair_opens_sticks_and_slips_as_computed_by_hand() {
    let (k_n, k_t, mu) = (2.0, 5.0, 0.5);
    let s = system(&spring_pair(k_n, k_t), mu);
    // f = (f_n, f_t): open for f_n > 0; else P_n = −f_n, and P_t = −f_t unless that exceeds μ P_n.
    for (f, p) in [
        ([3.0, 1.0], [0.0, 0.0]),
        ([-4.0, 1.9], [4.0, -1.9]),
        ([-4.0, 3.0], [4.0, -2.0]),
        ([-4.0, -3.0], [4.0, 2.0]),
    ] {
        let u = [(f[0] + p[0]) / k_n, (f[1] + p[1]) / k_t];
        for (m, outcome) in claims(all(), &s, &force(&s, &f), 1e-12) {
            assert!(difference(&outcome.state.p, &p) < m.accuracy, "{}", m.name);
            for (found, exact) in outcome.state.u.iter().zip(u) {
                let scale = f[0].abs() / k_n;
                assert_near(*found, exact, m.accuracy * scale, (m.name, f));
            }
        }
    }
}

/// E8: a slider under constant normal force N, pulled through a spring k by ±u₀. Sticks for good if u₀ <= μN/k, else
/// dissipates 4 μN (u₀ − μN/k) per cycle with the spring force clamped at ±μN.
#[test]
fn friction_loop_has_the_closed_form_dissipation_and_clamped_force() {
    let (k, n, mu) = (3.0, 2.0, 0.4);
    let s = system(&spring_pair(7.0, k), mu);
    'method: for (m, u0) in all().map(|m| (m, 0.2)).chain(all().map(|m| (m, 0.5))) {
        let load = |pull: f64| force(&s, &[-n, k * pull]);
        let (mut state, mut last) = (ContactState::zero(&s), load(0.0));
        let (mut dissipated, mut largest) = (0.0, 0.0_f64);
        for (step, pull) in [1.0, 0.3, -1.0, -0.5, 1.0, -1.0, 1.0].iter().enumerate() {
            let next = load(u0 * pull);
            let i = increment(&s, &next, &last, &state, 1e-12);
            let outcome = build(&m, &m.given).solve(&i, &mut Silent).unwrap();
            if !converged(&m, &outcome) {
                continue 'method;
            }
            let d = i.jump(&outcome.state.u)[1] - i.start_jump()[1];
            if step >= 5 {
                dissipated -= outcome.state.p[1] * d;
            }
            largest = largest.max(outcome.state.p[1].abs());
            (state, last) = (outcome.state, next);
        }
        let exact = 4.0 * mu * n * (u0 - mu * n / k).max(0.0);
        assert_near(dissipated, exact, m.accuracy, m.name);
        assert_near(largest, (mu * n).min(k * u0), m.accuracy, m.name);
    }
}

/// A block on two feet, weight N, pushed at its top by F against a lateral spring k: both feet slip, friction μN,
/// u_x(top) = (F − μN)/k; moments about the top: a (P₂ − P₁) = h μN.
#[test]
fn confined_floating_block_slides_as_statics_says() {
    let (a, h, k, n, f, mu) = (1.0, 1.5, 2.0, 10.0, 4.0, 0.3);
    let s = system(&block(a, h, 50.0, k), mu);
    let load = force(&s, &[0.0, 0.0, 0.0, 0.0, f, -n]);
    let [p1, p2] = [-1.0, 1.0].map(|sign| n / 2.0 * (1.0 + sign * h * mu / a));
    for (m, outcome) in claims(all(), &s, &load, 1e-11) {
        let dp = difference(&outcome.state.p, &[p1, -mu * p1, p2, -mu * p2]);
        assert!(dp < m.accuracy, "{}: {dp:.1e}", m.name);
        assert_near(outcome.state.u[4], (f - mu * n) / k, m.accuracy, m.name);
        let judged = judge(&s, &load, &outcome.state);
        assert!(judged.equilibrium < 1e-12, "{}: {judged:?}", m.name);
    }
}

/// The same block without the spring: below μN it sticks (statics gives the resultants), above there is no equilibrium.
#[test]
fn free_floating_block_sticks_below_the_friction_limit_and_is_a_mechanism_above() {
    let (a, h, n, mu) = (1.0, 0.8, 10.0, 0.3);
    let s = system(&block(a, h, 50.0, 0.0), mu);
    let top = |x: f64, y: f64| force(&s, &[0.0, 0.0, 0.0, 0.0, x, y]);
    for (m, stick) in claims(all(), &s, &top(2.0, -n), 1e-11) {
        let p = &stick.state.p;
        assert_near(p[1] + p[3], -2.0, m.accuracy, m.name);
        assert_near(p[0] + p[2], n, m.accuracy, m.name);
        assert_near(a * (p[2] - p[0]), h * 2.0, m.accuracy, m.name);
        assert!(!balanced_by_nothing(&s, &top(2.0, -n)));

        let limit = [("max_iterations", 300.0), ("max_outer", 20.0)].into_iter();
        let has = |name: &str| m.options.iter().any(|o| o.name() == name);
        let limit: Vec<_> = limit.filter(|(name, _)| has(name)).collect();
        for load in [top(4.0, -n), top(1.0, n)] {
            let lost = run(&m, &limit, &s, &load, 1e-9);
            assert_ne!(lost.status, Status::Converged, "{}", m.name);
            let mut numbers = lost.state.u.iter().chain(&lost.state.p);
            assert!(numbers.all(|x| x.is_finite()), "{}", m.name);
            assert!(balanced_by_nothing(&s, &load));
        }
    }
}

/// Whether no force within the cones balances a load, proved.
fn balanced_by_nothing(s: &ContactSystem, load: &Load) -> bool {
    let (start, rest) = (ContactState::zero(s), force(s, &[0.0; 6]));
    conic::no_equilibrium(&increment(s, load, &rest, &start, 1e-9)).unwrap()
}

/// The same block: friction balances F <= μ N and no more, and no force what pulls it off.
#[test]
fn what_no_force_balances_is_proved() {
    let (n, mu) = (10.0, 0.3);
    let s = system(&block(1.0, 0.8, 50.0, 0.0), mu);
    let top = |x: f64, y: f64| force(&s, &[0.0, 0.0, 0.0, 0.0, x, y]);
    for (share, none) in [
        (0.999, false),
        (1.001, true),
        (-0.999, false),
        (-1.001, true),
    ] {
        assert_eq!(
            balanced_by_nothing(&s, &top(share * mu * n, -n)),
            none,
            "{share}"
        );
    }
    assert!(balanced_by_nothing(&s, &top(0.0, 1e-3 * n)));
    assert!(!balanced_by_nothing(&s, &top(0.0, 0.0)));
}

#[test]
fn frictionless_block_that_can_slide_away_is_reported_as_mechanism() {
    let s = system(&block(1.0, 1.0, 50.0, 0.0), 0.0);
    let load = force(&s, &[0.0, 0.0, 0.0, 0.0, 1.0, -5.0]);
    for m in general() {
        let outcome = run(&m, &[], &s, &load, 1e-9);
        assert_eq!(outcome.status, Status::Mechanism, "{}", m.name);
    }
}

/// Oblique slip on an anisotropic body: (k_a + σ) d_a = f_a, (k_b + σ) d_b = f_b with σ = μP_n/|d|, a scalar equation.
#[test]
fn oblique_slip_on_the_3d_cone_solves_the_scalar_equation() {
    let (k, f, mu) = ([2.0, 1.0, 6.0], [-3.0, 2.0, 2.5], 0.4);
    let bound = mu * -f[0];
    let slip = |sigma: f64| [f[1] / (k[1] + sigma), f[2] / (k[2] + sigma)];
    let excess = |sigma: f64| slip(sigma)[0].hypot(slip(sigma)[1]) * sigma - bound;
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..200 {
        let mid = 0.5 * (low + high);
        let end = if excess(mid) < 0.0 {
            &mut low
        } else {
            &mut high
        };
        *end = mid;
    }
    let d = slip(low);
    let size = d[0].hypot(d[1]);
    let p = [-f[0], -bound * d[0] / size, -bound * d[1] / size];
    let body = elastic(3, &diagonal(&k), &diagonal(&[1.0; 3]), vec![], false);
    let s = system(&body, mu);
    for (m, outcome) in claims(all(), &s, &force(&s, &f), 1e-11) {
        let state = &outcome.state;
        let (dp, du) = (difference(&state.p, &p), difference(&state.u[1..], &d));
        assert!(
            dp < 10.0 * m.accuracy && du < 10.0 * m.accuracy,
            "{}",
            m.name
        );
    }
}

#[test]
fn two_and_three_coupled_pairs_match_the_enumeration_of_all_states() {
    let mut rng = Random(3);
    let mut compared = 0;
    for trial in 0..60 {
        let (k, b) = random_body(&mut rng, 2, 2 + trial % 2, 3, 0.3);
        let s = system(&elastic(2, &k, &b, vec![], false), 0.5);
        let f = rng.vector(k.len());
        let states = enumerate(&delassus(&k, &b), &mul(&b, &solve(&k, &f)), 0.5);
        // Several solutions: outside the range where Coulomb's problem is unique.
        let [p] = &states[..] else { continue };
        for m in all() {
            let Some(outcome) = solved(&m, &m.given, &s, &force(&s, &f), 1e-11) else {
                continue;
            };
            let found = outcome.state.p;
            for (found, exact) in found.iter().zip(p) {
                assert_near(*found, *exact, 100.0 * m.accuracy, (m.name, trial));
            }
        }
        compared += 1;
    }
    assert!(compared > 50, "{compared}");
}
