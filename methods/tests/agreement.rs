//! Methods against each other, against their own parameters and against independent solvers.

use clarabel::solver::SupportedConeT;
use stickslip_methods::*;

use crate::toys::*;

/// Open, stick or slip of every point, by the forces.
fn states(system: &ContactSystem, p: &[f64]) -> Vec<usize> {
    let largest = p.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let points = p.chunks(system.dim()).zip(system.friction());
    let state = |(p, mu): (&[f64], &f64)| {
        let t = p[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
        match () {
            () if p[0] <= 1e-6 * largest => 0,
            () if t < mu * p[0] - 1e-6 * largest => 1,
            () => 2,
        }
    };
    points.map(state).collect()
}

/// 30 coupled random systems per friction and dimension.
#[test]
fn all_exact_methods_give_the_same_answer_on_random_coupled_systems() {
    for (dim, mu) in [2, 3]
        .iter()
        .flat_map(|dim| [0.0, 0.1, 0.3, 0.6, 1.0].map(|mu| (*dim, mu)))
    {
        let mut rng = Random(7);
        let mut seen = [0; 3];
        for trial in 0..30 {
            let (k, b) = random_body(&mut rng, dim, 12, 20, 0.05);
            let s = system(&elastic(dim, &k, &b, vec![], false), mu);
            let load = force(&s, &rng.vector(k.len()));
            let mut reference: Option<(ContactState, Vec<usize>)> = None;
            for m in exact() {
                let Some(Outcome { state, .. }) = solved(&m, &[], &s, &load, 1e-10) else {
                    continue;
                };
                let own = states(&s, &state.p);
                let (other, theirs) = reference.get_or_insert_with(|| (state.clone(), own.clone()));
                assert_same(&state, other, 1e-7, (m.name, dim, mu, trial));
                assert_eq!(&own, theirs, "{} trial {trial}", m.name);
            }
            let (_, states) = reference.unwrap();
            states.into_iter().for_each(|i| seen[i] += 1);
        }
        let all = seen[0] > 0 && seen[2] > 0 && (mu < 0.2 || seen[1] > 0);
        assert!(all, "the study must have all states: {seen:?}");
    }
}

/// One 3D system with open, sticking and slipping points, its load and its solution.
fn specimen() -> (ContactSystem, Load, ContactState) {
    let mut rng = Random(33);
    let (k, b) = random_body(&mut rng, 3, 10, 10, 0.1);
    let s = system(&elastic(3, &k, &b, vec![], false), 0.6);
    let load = force(&s, &rng.vector(k.len()));
    let reference = run(method("b-newton").unwrap(), &[], &s, &load, 1e-13).state;
    let mut kinds = states(&s, &reference.p);
    kinds.sort_unstable();
    kinds.dedup();
    assert_eq!(kinds, [0, 1, 2]);
    (s, load, reference)
}

#[test]
fn penalty_error_falls_like_one_over_its_stiffness_and_that_of_the_barrier_like_its_gap() {
    let (s, load, reference) = specimen();
    #[rustfmt::skip]
    let sweeps = [
        ("penalty", ["normal", "tangential"], [1e2, 1e3, 1e4, 1e5, 1e6]),
        ("barrier", ["gap", "slip"], [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]),
    ];
    for (name, options, values) in sweeps {
        let errors = values.map(|c| {
            let given = options.map(|option| (option, c));
            let outcome = solved(method(name).unwrap(), &given, &s, &load, 1e-12).unwrap();
            let (one, other) = match outcome.claim {
                Claim::Penalised { normal, tangential } => (normal, tangential),
                Claim::Barrier { gap, slip, .. } => (gap, slip),
                other => panic!("{other:?}"),
            };
            assert!(one == other && one > 0.0, "{name}");
            if name == "barrier" {
                // It never penetrates.
                let judged = judge(&s, &load, &outcome.state);
                assert_eq!((judged.penetration, judged.adhesion), (0.0, 0.0));
                assert!(judged.cone < 1e-15, "{judged:?}");
            }
            difference(&outcome.state.p, &reference.p)
        });
        for pair in errors.windows(2) {
            let slope = (pair[1] / pair[0]).log10();
            assert!((-1.1..-0.9).contains(&slope), "{name}: {errors:?}");
        }
    }
}

#[test]
fn exact_methods_do_not_depend_on_their_numerical_parameters() {
    let (s, load, reference) = specimen();
    #[rustfmt::skip]
    let sweeps: [(&str, &str, &[f64]); 15] = [
        ("b-newton", "r", &[1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3]),
        ("augmented-lagrangian", "stiffness", &[1.0, 10.0, 1e2, 1e3, 1e4, 1e6]),
        ("gnm", "return_map", &[0.0, 2.0]),
        ("augmented-lagrangian", "anderson", &[5.0]),
        ("nsgs", "anderson", &[1.0, 5.0, 20.0]),
        ("latin", "anderson", &[1.0, 5.0, 20.0]),
        ("admm", "anderson", &[1.0, 5.0, 20.0]),
        ("latin", "search_direction", &[0.1, 0.3, 1.0, 3.0, 10.0]),
        ("latin", "relaxation", &[0.5, 0.7, 0.9]),
        ("admm", "penalty", &[1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3]),
        ("admm", "over_relaxation", &[0.5, 1.0, 1.9]),
        ("nsgs", "relaxation", &[0.5, 0.8, 1.2]),
        ("interior-point", "fraction", &[0.5, 0.9, 0.999]),
        ("socp", "anderson", &[0.0, 1.0, 20.0]),
        ("tresca", "anderson", &[0.0, 1.0, 20.0]),
    ];
    for (name, option, values) in sweeps {
        for &value in values {
            let given = [(option, value)];
            let outcome = solved(method(name).unwrap(), &given, &s, &load, 1e-10).unwrap();
            assert_same(&outcome.state, &reference, 1e-7, (name, given));
        }
    }
}

#[test]
fn exact_methods_can_be_driven_to_rounding() {
    let (s, load, _) = specimen();
    for (m, outcome) in claims(exact(), &s, &load, 1e-13) {
        let found = judge(&s, &load, &outcome.state).violation;
        assert!(found <= 1e-13, "{}: {found:e}", m.name);
        // Beyond rounding there is nothing to claim.
        let outcome = run(&m, &[], &s, &load, 1e-20);
        let last = outcome.history.last().unwrap().violation;
        let honest = outcome.status != Status::Converged || last == 0.0;
        assert!(honest, "{}", m.name);
    }
}

#[test]
fn every_exact_method_reaches_tier_high_within_its_default_limits_on_a_stiff_range_of_systems() {
    // Condition of K from about 10 to 1e6: LATIN is the one that feels it.
    for shift in [1.0, 1e-2, 1e-4] {
        let mut rng = Random(41);
        for _ in 0..5 {
            let (k, b) = random_body(&mut rng, 2, 10, 10, shift);
            let s = system(&elastic(2, &k, &b, vec![], false), 0.3);
            let load = force(&s, &rng.vector(k.len()));
            for m in exact() {
                solved(&m, &[], &s, &load, Tier::High.tolerance());
            }
        }
    }
}

/// min ½ u·K u − f·u subject to B_n u + offset_n >= 0, by an interior-point code that knows nothing of W.
#[test]
fn frictionless_contact_is_the_quadratic_programme_that_clarabel_solves() {
    let mut rng = Random(17);
    for (dim, points) in [(2, 10), (3, 8)] {
        let (k, b) = random_body(&mut rng, dim, points, 10, 0.2);
        let f = rng.vector(k.len());
        let offset: Vec<f64> = rng.vector(dim * points).iter().map(|x| 0.1 * x).collect();
        let minus = |v: &[f64]| -> Vec<f64> { v.iter().map(|x| -x).collect() };
        let normal: Rows = b.iter().step_by(dim).map(|row| minus(row)).collect();
        let gaps: Vec<f64> = offset.iter().step_by(dim).copied().collect();
        let cones = [SupportedConeT::NonnegativeConeT(points)];
        let independent = minimise(&k, &minus(&f), (&normal, &gaps, &cones), 1e-12);

        let s = system(&elastic(dim, &k, &b, vec![], false), 0.0);
        let load = load(f, offset);
        for (m, outcome) in claims(all(), &s, &load, 1e-10) {
            let found = outcome.state;
            let p: Vec<f64> = found.p.iter().step_by(dim).copied().collect();
            let du = difference(&found.u, &independent.x);
            let dp = difference(&p, &independent.z);
            let allowed = m.accuracy.max(1e-6);
            assert!(
                du < allowed && dp < allowed,
                "{}: {du:.1e} {dp:.1e}",
                m.name
            );
        }
    }
}
