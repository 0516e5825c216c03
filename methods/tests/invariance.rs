//! Changes that must not change the answer of a method, and quantities that its answers must conserve.

use stickslip_methods::*;

use crate::toys::*;

/// Discrete energy identity of one increment, exact to the accuracy of the contact laws:
/// f·Δu = ΔE + ½ Δu·K Δu + D + Σ P_n g_old with E = ½ u·K u and D = −Σ P_t·d >= 0, because P_n g = 0 at the end.
#[test]
fn energy_balances_and_friction_dissipates_along_a_load_path() {
    for dim in [2, 3] {
        let mut rng = Random(21);
        let (k, b) = random_body(&mut rng, dim, 6, 6, 0.3);
        let s = system(&elastic(dim, &k, &b, vec![], false), 0.4);
        let loads: Vec<Load> = (0..8).map(|_| force(&s, &rng.vector(k.len()))).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let energy = |u: &[f64]| 0.5 * dot(u, &mul(&k, u));
        'method: for m in exact() {
            let (mut state, mut last) = (ContactState::zero(&s), Load::zero(s.elastic()));
            let (mut total, mut scale) = (0.0, 0.0_f64);
            for next in &loads {
                let i = increment(&s, next, &last, &state, 1e-10);
                let outcome = build(&m, &[]).solve(&i, &mut Silent).unwrap();
                if !converged(&m, &outcome) {
                    continue 'method;
                }
                let (u, p) = (&outcome.state.u, &outcome.state.p);
                let du: Vec<f64> = u.iter().zip(&state.u).map(|(a, b)| a - b).collect();
                let (new, old) = (i.jump(u), i.start_jump());
                let work = dot(&next.force, &du);
                let stored = energy(u) - energy(&state.u);
                let slip = (0..p.len()).filter(|r| !r.is_multiple_of(dim));
                let dissipated: f64 = -slip.map(|r| p[r] * (new[r] - old[r])).sum::<f64>();
                let normal: f64 = (0..p.len()).step_by(dim).map(|r| p[r] * old[r]).sum();
                scale = scale.max(work.abs()).max(stored.abs());
                let spent = stored + energy(&du) + dissipated + normal;
                assert_near(work, spent, 1e-8 * scale, m.name);
                assert!(dissipated > -1e-8 * scale, "{}: {dissipated}", m.name);
                total += dissipated;
                (state, last) = (outcome.state, next.clone());
            }
            assert!(total > 1e-3 * scale, "the path must slip");
        }
    }
}

/// A body of five points in 3D and a load.
fn five(seed: u64) -> (Rows, Rows, Vec<f64>, Random) {
    let mut rng = Random(seed);
    let (k, b) = random_body(&mut rng, 3, 5, 5, 0.2);
    let f = rng.vector(k.len());
    (k, b, f, rng)
}

#[test]
fn the_same_increment_twice_gives_the_same_bits() {
    let (k, b, f, mut rng) = five(8);
    let s = system(&elastic(3, &k, &b, vec![], false), 0.3);
    let (first, second) = (force(&s, &f), force(&s, &rng.vector(k.len())));
    let (start, rest) = (ContactState::zero(&s), Load::zero(s.elastic()));
    for m in general() {
        let mut instance = build(&m, &[]);
        let mut solve = |load: &Load| {
            let i = increment(&s, load, &rest, &start, 1e-9);
            instance.solve(&i, &mut Silent).unwrap().state
        };
        // Something else in between: an instance may keep factorisations, not history.
        let (a, other, again) = (solve(&first), solve(&second), solve(&first));
        assert!(a == again && a != other, "{}", m.name);
        let fresh = run(&m, &[], &s, &first, 1e-9).state;
        assert_eq!(fresh, a, "{}: fresh instance", m.name);
    }
}

/// Goal: where a method begins to iterate is no part of the problem. Laws that remember forces, the springs of `penalty`, take
/// them from the start of the increment whatever the guess.
#[test]
fn answers_do_not_depend_on_the_guess() {
    let (k, b, f, mut rng) = five(12);
    let s = system(&elastic(3, &k, &b, vec![], false), 0.3);
    let (first, second) = (force(&s, &f), force(&s, &rng.vector(k.len())));
    let wild = rng.vector(15);
    for m in general() {
        let start = run(&m, &[], &s, &first, 1e-10).state;
        let slips = |p: &[f64]| p[1].hypot(p[2]) > 0.0;
        assert!(
            start.p.chunks(3).any(slips),
            "{}: nothing to forget",
            m.name
        );
        let from = |guess: Option<&[f64]>| {
            let i = increment(&s, &second, &first, &start, 1e-10);
            let i = Increment { guess, ..i };
            let outcome = build(&m, &[]).solve(&i, &mut Silent).unwrap();
            converged(&m, &outcome).then_some(outcome)
        };
        let Some(warm) = from(None) else { continue };
        assert_eq!(from(Some(&start.p)).as_ref(), Some(&warm), "{}", m.name);
        let others = [vec![0.0; 15], wild.clone()];
        let others = others.iter().filter_map(|guess| from(Some(guess)));
        let others: Vec<Outcome> = others.collect();
        for other in &others {
            assert_same(&other.state, &warm.state, 1e-7, m.name);
        }
        let differ = |o: &Outcome| o.history[0] != warm.history[0];
        assert!(others.iter().any(differ), "{} ignores it", m.name);
    }
}

#[test]
fn reordering_the_points_reorders_the_answer() {
    let (k, b, f, _) = five(9);
    let reordered = |rows: &[usize]| -> Vec<usize> {
        let own = rows.iter().flat_map(|&i| 3 * i..3 * i + 3);
        own.collect()
    };
    let rows = reordered(&[3, 0, 4, 1, 2]);
    let moved: Rows = rows.iter().map(|&r| b[r].clone()).collect();
    for m in all() {
        let [mut a, c] = [&b, &moved].map(|b| {
            let s = system(&elastic(3, &k, b, vec![], false), 0.3);
            run(&m, &m.given, &s, &force(&s, &f), 1e-10).state
        });
        a.p = rows.iter().map(|&r| a.p[r]).collect();
        assert_same(&c, &a, 1e-7, m.name);
    }
}

#[test]
fn answers_do_not_depend_on_units_or_tangent_frames() {
    let (k, b, f, _) = five(10);
    let (modulus, length) = (1e-10, 1e3);
    // Forces scale with E L², stiffness with E L, displacements with L.
    let times = |v: &[f64], c: f64| -> Vec<f64> { v.iter().map(|x| x * c).collect() };
    let scaled: Rows = k.iter().map(|row| times(row, modulus * length)).collect();
    let loud = times(&f, modulus * length * length);
    let (sin, cos) = 0.7_f64.sin_cos();
    let mut turned = b.clone();
    for i in 0..5 {
        for j in 0..k.len() {
            let [x, y] = [b[3 * i + 1][j], b[3 * i + 2][j]];
            turned[3 * i + 1][j] = cos * x + sin * y;
            turned[3 * i + 2][j] = cos * y - sin * x;
        }
    }
    for m in all() {
        let solve = |k: &Rows, b: &Rows, f: &[f64]| {
            let s = system(&elastic(3, k, b, vec![], false), 0.3);
            run(&m, &m.given, &s, &force(&s, f), 1e-9)
        };
        let (reference, units) = (solve(&k, &b, &f), solve(&scaled, &b, &loud));
        let frames = solve(&k, &turned, &f);
        let u = times(&units.state.u, 1.0 / length);
        assert!(difference(&u, &reference.state.u) < 1e-10, "{}", m.name);
        assert_eq!(units.counters, reference.counters, "{}", m.name);
        for (a, b) in units.history.iter().zip(&reference.history) {
            assert_near(a.violation, b.violation, 1e-10, m.name);
        }
        assert!(
            difference(&frames.state.u, &reference.state.u) < 1e-7,
            "{}",
            m.name
        );
        // LATIN's search direction comes from an estimate that sees the frame.
        let steps = [&frames, &reference].map(|o| o.counters.iterations);
        assert!(
            steps[0] == steps[1] || m.name == "latin",
            "{}: {steps:?}",
            m.name
        );
    }
}

/// Two pairs on the same place share one contact force in any proportion: W is singular, u is unique.
#[test]
fn redundant_points_leave_the_displacements_unique() {
    let mut rng = Random(15);
    let (k, b) = random_body(&mut rng, 2, 3, 5, 0.3);
    let doubled = [&b[..], &b[..2]].concat();
    let f: Vec<f64> = rng.vector(k.len()).iter().map(|x| x - 1.0).collect();
    for m in exact() {
        let both = [&b, &doubled].map(|b| {
            let s = system(&elastic(2, &k, b, vec![], false), 0.4);
            solved(&m, &[], &s, &force(&s, &f), 1e-10).map(|own| own.state)
        });
        let [Some(a), Some(c)] = both else { continue };
        assert!(a.p[0] > 0.0, "the doubled point must be closed");
        assert!(difference(&c.u, &a.u) < 1e-7, "{}", m.name);
        assert_near(c.p[0] + c.p[6], a.p[0], 1e-7, m.name);
    }
}
