//! Methods against each other, against their own parameters and against independent solvers.

use crate::toys::*;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SupportedConeT};
use stickslip_methods::*;

/// Open, stick or slip of every point, by the forces.
fn states(system: &ContactSystem, p: &[f64]) -> Vec<u8> {
    let largest = p.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    p.chunks(system.dim())
        .zip(system.friction())
        .map(|(p, mu)| {
            let t = p[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
            match () {
                () if p[0] <= 1e-6 * largest => 0,
                () if t < mu * p[0] - 1e-6 * largest => 1,
                () => 2,
            }
        })
        .collect()
}

/// 30 coupled random systems per friction and dimension.
#[test]
fn all_exact_methods_give_the_same_answer_on_random_coupled_systems() {
    for dim in [2, 3] {
        for mu in [0.0, 0.1, 0.3, 0.6, 1.0] {
            let mut rng = Random(7);
            let mut seen = [0; 3];
            for trial in 0..30 {
                let (k, b) = random_body(&mut rng, dim, 12, 20, 0.05);
                let s = system(&elastic(dim, &k, &b, vec![], false), mu);
                let load = force(&s, &rng.vector(k.len()));
                let mut reference: Option<ContactState> = None;
                for m in exact() {
                    let outcome = run(m, &[], &s, &load, 1e-10);
                    assert_eq!(
                        outcome.status,
                        Status::Converged,
                        "{} dim {dim} mu {mu} trial {trial}",
                        m.name
                    );
                    let reference = reference.get_or_insert_with(|| outcome.state.clone());
                    let (du, dp) = (
                        difference(&outcome.state.u, &reference.u),
                        difference(&outcome.state.p, &reference.p),
                    );
                    assert!(
                        du < 1e-7 && dp < 1e-7,
                        "{} dim {dim} mu {mu} trial {trial}: {du:.1e} {dp:.1e}",
                        m.name
                    );
                    assert_eq!(
                        states(&s, &outcome.state.p),
                        states(&s, &reference.p),
                        "{} trial {trial}",
                        m.name
                    );
                }
                if let Some(reference) = reference {
                    states(&s, &reference.p)
                        .iter()
                        .for_each(|&i| seen[i as usize] += 1);
                }
            }
            assert!(
                seen[0] > 0 && seen[2] > 0 && (mu < 0.2 || seen[1] > 0),
                "the study must have all states: {seen:?}"
            );
        }
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
fn penalty_error_falls_like_one_over_its_stiffness() {
    let (s, load, reference) = specimen();
    let penalty = method("penalty").unwrap();
    let errors: Vec<f64> = [1e2, 1e3, 1e4, 1e5, 1e6]
        .iter()
        .map(|&c| {
            let outcome = run(penalty, &[("normal", c), ("tangential", c)], &s, &load, 1e-12);
            assert_eq!(outcome.status, Status::Converged, "{c:e}");
            assert!(matches!(outcome.claim, Claim::Penalised { normal, tangential } if normal == tangential && normal > 0.0));
            difference(&outcome.state.p, &reference.p)
        })
        .collect();
    for pair in errors.windows(2) {
        let slope = (pair[1] / pair[0]).log10();
        assert!((-1.1..-0.9).contains(&slope), "{errors:?}");
    }
}

#[test]
fn barrier_error_falls_like_its_gap_and_slip_and_never_penetrates() {
    let (s, load, reference) = specimen();
    let barrier = method("barrier").unwrap();
    let errors: Vec<f64> = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
        .iter()
        .map(|&c| {
            let outcome = run(barrier, &[("gap", c), ("slip", c)], &s, &load, 1e-12);
            assert_eq!(outcome.status, Status::Converged, "{c:e}");
            assert!(matches!(outcome.claim, Claim::Barrier { gap, slip, .. } if gap == slip && gap > 0.0));
            let judged = judge(&s, &load, &outcome.state);
            assert_eq!((judged.penetration, judged.adhesion), (0.0, 0.0));
            assert!(judged.cone < 1e-15, "{judged:?}");
            difference(&outcome.state.p, &reference.p)
        })
        .collect();
    for pair in errors.windows(2) {
        let slope = (pair[1] / pair[0]).log10();
        assert!((-1.1..-0.9).contains(&slope), "{errors:?}");
    }
}

#[test]
fn exact_methods_do_not_depend_on_their_numerical_parameters() {
    let (s, load, reference) = specimen();
    let sweeps: [(&str, &str, &[f64]); 11] = [
        ("b-newton", "r", &[1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3]),
        (
            "augmented-lagrangian",
            "stiffness",
            &[1.0, 10.0, 1e2, 1e3, 1e4, 1e6],
        ),
        ("latin", "search_direction", &[0.1, 0.3, 1.0, 3.0, 10.0]),
        ("latin", "relaxation", &[0.5, 0.7, 0.9]),
        ("admm", "penalty", &[1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3]),
        ("admm", "over_relaxation", &[0.5, 1.0, 1.9]),
        ("projection", "variant", &[0.0, 1.0]),
        ("nsgs", "relaxation", &[0.5, 0.8, 1.2]),
        ("interior-point", "fraction", &[0.5, 0.9, 0.999]),
        ("socp", "anderson", &[0.0, 1.0, 20.0]),
        ("tresca", "anderson", &[0.0, 1.0, 20.0]),
    ];
    for (name, option, values) in sweeps {
        for &value in values {
            let outcome = run(method(name).unwrap(), &[(option, value)], &s, &load, 1e-10);
            assert_eq!(
                outcome.status,
                Status::Converged,
                "{name} {option} = {value}"
            );
            let (du, dp) = (
                difference(&outcome.state.u, &reference.u),
                difference(&outcome.state.p, &reference.p),
            );
            assert!(
                du < 1e-7 && dp < 1e-7,
                "{name} {option} = {value}: {du:.1e} {dp:.1e}"
            );
        }
    }
}

#[test]
fn exact_methods_can_be_driven_to_rounding() {
    let (s, load, _) = specimen();
    for m in exact() {
        let outcome = run(m, &[], &s, &load, 1e-13);
        if !converged(m, &outcome, "") {
            continue;
        }
        assert!(
            judge(&s, &load, &outcome.state).natural_map <= 1e-13,
            "{}",
            m.name
        );
        // Beyond rounding there is nothing to claim.
        let outcome = run(m, &[], &s, &load, 1e-20);
        assert!(
            outcome.status != Status::Converged
                || outcome.history.last().unwrap().natural_map == 0.0,
            "{}",
            m.name
        );
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
                let outcome = run(m, &[], &s, &load, Tier::High.tolerance());
                assert_eq!(
                    outcome.status,
                    Status::Converged,
                    "{} shift {shift}",
                    m.name
                );
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
        let n = k.len();
        let f = rng.vector(n);
        let offset: Vec<f64> = rng.vector(dim * points).iter().map(|x| 0.1 * x).collect();
        let upper: Rows = (0..n)
            .map(|i| (0..n).map(|j| if j >= i { k[i][j] } else { 0.0 }).collect())
            .collect();
        let normal: Rows = (0..points)
            .map(|i| b[dim * i].iter().map(|x| -x).collect())
            .collect();
        let gaps: Vec<f64> = (0..points).map(|i| offset[dim * i]).collect();
        let linear: Vec<f64> = f.iter().map(|x| -x).collect();
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-12)
            .tol_gap_rel(1e-12)
            .tol_feas(1e-12)
            .build()
            .unwrap();
        let (hessian, constraints) = (csc(&upper), csc(&normal));
        let cones = [SupportedConeT::NonnegativeConeT(points)];
        let mut solver =
            DefaultSolver::new(&hessian, &linear, &constraints, &gaps, &cones, settings).unwrap();
        solver.solve();

        let s = system(&elastic(dim, &k, &b, vec![], false), 0.0);
        let load = Load {
            force: f,
            offset,
            traction: vec![],
        };
        for (m, options, tolerance) in all() {
            let outcome = run(m, &options, &s, &load, 1e-10);
            let p: Vec<f64> = outcome.state.p.iter().step_by(dim).copied().collect();
            let (du, dp) = (
                difference(&outcome.state.u, &solver.solution.x),
                difference(&p, &solver.solution.z),
            );
            let allowed = tolerance.max(1e-6);
            assert!(
                du < allowed && dp < allowed,
                "{} dim {dim}: {du:.1e} {dp:.1e}",
                m.name
            );
        }
    }
}
