//! Nitsche's method on bodies with stress: exact where the stress is uniform, close to the multipliers elsewhere.

use crate::common::*;
use stickslip::case::{Case, Expect, Target, Tolerance, shipped};
use stickslip::model::body::{Body, Needs};
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::registry::method;
use stickslip::run::verdict::Verdict;
use stickslip::studies::cases::{Settings, run_case};
use stickslip::studies::results::Results;
use stickslip::studies::rows::RunKey;
use stickslip_methods::{
    Claim, ContactState, ContactSystem, Increment, Load, Options, Outcome, Silent, Status, Tier,
};

const SETTINGS: Settings = Settings::PLAIN;

const TRACTION: Needs = Needs {
    frictionless: Vec::new(),
    traction: true,
};

fn options(theta: f64, gamma: f64) -> [(String, f64); 2] {
    [("theta".into(), theta), ("gamma".into(), gamma)]
}

/// The three variants with the γ of the default.
fn variants() -> Vec<Choice> {
    let nitsche = method("nitsche").unwrap();
    let variant = |theta| Choice::new(nitsche, &options(theta, 2.0)).unwrap();
    [1.0, 0.0, -1.0].map(variant).to_vec()
}

fn shipped(name: &str) -> Case {
    shipped::find(name).unwrap().unwrap()
}

fn found(results: &Results, key: &RunKey, [quantity, at, component]: [&str; 3]) -> f64 {
    value(results, |k| k == key, [quantity, at, component])
}

/// One increment on a body.
fn solve_body(
    body: &Body,
    system: &ContactSystem,
    load: &Load,
    tolerance: f64,
    (name, given): (&str, &[(String, f64)]),
) -> Outcome {
    let registered = method(name).unwrap();
    let options = Options::new(registered.options, given).unwrap();
    let mut enforcement = (registered.build)(&options);
    assert_eq!(enforcement.refuses(system), None);
    let increment = Increment {
        system,
        load,
        start_load: &no_load(body),
        start: &ContactState::zero(system),
        guess: None,
        index: 0,
        tolerance,
    };
    let outcome = enforcement.solve(&increment, &mut Silent).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{name} {given:?}");
    outcome
}

/// Source: closed form in the heads of the cases. Goal: in uniform stress the traction operator is exact, so all variants
/// solve the contact laws themselves, on conforming and embedded interfaces, stick and slip, through cycles; every number
/// the cases expect of exact methods holds within the tolerance stated there (1e-10).
#[test]
fn the_sliding_block_is_solved_exactly() {
    for name in [
        "sliding_block_conforming",
        "sliding_block_embedded",
        "sliding_block_cycle",
        "sliding_block_cycle_conforming",
    ] {
        let case = shipped(name);
        let results = run_case(&case, &variants(), SETTINGS, &Quiet).unwrap();
        let mut checked = 0;
        for run in results.increments() {
            assert_eq!(run.step.verdict, Verdict::Solved, "{:?}", run.key);
            for expect in case.expects.iter().filter(|e| applies(e, &case, &run.key)) {
                let at = [&expect.quantity, &expect.at, &expect.component];
                let value = found(&results, &run.key, at.map(|s| s.as_str()));
                let allowed = match expect.tolerance {
                    Tolerance::Relative(t) => t * expect.value.abs(),
                    Tolerance::Absolute(t) => t,
                };
                assert!(
                    (value - expect.value).abs() <= allowed,
                    "{:?} {at:?}: {value} instead of {}",
                    run.key,
                    expect.value
                );
                checked += 1;
            }
        }
        assert!(checked >= 3 * case.expects.len(), "{name}: {checked}");
    }
}

fn applies(expect: &Expect, case: &Case, key: &RunKey) -> bool {
    expect.method.is_none()
        && expect.friction.is_none_or(|mu| mu == key.friction)
        && expect.increment.unwrap_or(case.path.increments) == key.increment
}

/// Goal: on the plate of the paper (branch functions, stress concentrations) the reaction stays within 3e-4 of the
/// multipliers', at any friction and on both meshes (measured: 2.0e-4 at worst), and so do finer meshes: the two methods
/// approach one limit, since their difference stays below a tenth of what either still misses of it for μ = 0.8 and 1.2.
#[test]
fn the_plate_agrees_with_the_multipliers_on_every_mesh() {
    const LIMIT: [(f64, Option<f64>); 3] =
        [(0.1, None), (0.8, Some(1121.3e6)), (1.2, Some(1155.9e6))];
    for (name, refine) in [("plate_mesh1", vec![1, 2, 4]), ("plate_mesh2", vec![1])] {
        let mut case = shipped(name);
        case.sweep.refine = refine;
        let mut list = choices(&[METHOD]);
        list.extend(variants());
        let results = run_case(&case, &list, SETTINGS, &Quiet).unwrap();
        for run in results
            .increments()
            .iter()
            .filter(|r| r.key.method != METHOD)
        {
            assert!(
                matches!(run.step.verdict, Verdict::Approximate(_)),
                "{:?}",
                run.key
            );
            let at = ["reaction", "top", "y"];
            let reference = RunKey {
                method: METHOD.into(),
                ..run.key.clone()
            };
            let (nitsche, newton) = (
                found(&results, &run.key, at),
                found(&results, &reference, at),
            );
            let difference = (nitsche - newton).abs();
            println!("{:?}: {:.1e}", run.key, difference / newton.abs());
            assert!(difference < 3e-4 * newton.abs(), "{:?}", run.key);
            let limit = LIMIT.iter().find(|l| l.0 == run.key.friction).unwrap().1;
            if let (Some(limit), "plate_mesh1") = (limit, name) {
                assert!(
                    difference < 0.1 * (newton.abs() - limit).abs(),
                    "{:?}",
                    run.key
                );
            }
        }
    }
}

/// Goal: the beam of the paper, 3D, with and without friction: the displacements of the loaded edge within 1.5e-4 of
/// the multipliers' (measured: 7.6e-5 at worst).
#[test]
fn the_beam_agrees_with_the_multipliers() {
    let case = shipped("beam_model1");
    let mut list = choices(&[METHOD]);
    list.extend(variants());
    let results = run_case(&case, &list, SETTINGS, &Quiet).unwrap();
    let mut worst: f64 = 0.0;
    for run in results
        .increments()
        .iter()
        .filter(|r| r.key.method != METHOD)
    {
        assert!(
            matches!(run.step.verdict, Verdict::Approximate(_)),
            "{:?}",
            run.key
        );
        let reference = RunKey {
            method: METHOD.into(),
            ..run.key.clone()
        };
        for probe in ["P1", "P4", "P7"] {
            let of = |key: &RunKey| -> Vec<f64> {
                let component = |c| found(&results, key, ["displacement", probe, c]);
                ["x", "y", "z"].map(component).to_vec()
            };
            worst = worst.max(relative_difference(&of(&run.key), &of(&reference)));
        }
    }
    println!("{worst:.1e}");
    assert!(worst < 1.5e-4, "{worst:e}");
}

/// Source: C ~ 1/γ. Goal: contact forces approach the multipliers like 1/γ: ten times γ, a tenth of the difference.
#[test]
fn the_stabilisation_vanishes_like_one_over_gamma() {
    let case = shipped("plate_mesh1");
    let body = Body::new(&case, 1, &TRACTION).unwrap();
    let system = ContactSystem::new(body.elastic.clone(), vec![0.8; body.points.len()]).unwrap();
    let load = loading(&body, &case).at(case.path.increments);
    let exact = solve_body(&body, &system, &load, 1e-12, (METHOD, &[]))
        .state
        .p;
    for theta in [1.0, 0.0, -1.0] {
        let error = |gamma| {
            let options = options(theta, gamma);
            let outcome = solve_body(&body, &system, &load, 1e-9, ("nitsche", &options));
            relative_difference(&outcome.state.p, &exact)
        };
        let (coarse, fine) = (error(200.0), error(2000.0));
        println!("{theta}: {coarse:.2e} {fine:.2e}");
        assert!(
            coarse > 1e-5 && (9.0..11.0).contains(&(coarse / fine)),
            "{theta}"
        );
    }
}

/// Source: uniform traction in the closed form. Goal: where edge pairs off the grid make the multipliers oscillate, the
/// stabilisation damps them: scatter of P_n/w about its mean (measured: 0.53 to 0.65 of the mean for the multipliers, at
/// most 0.17 for γ = 2).
#[test]
fn oscillations_of_edge_pairs_off_the_grid_are_damped() {
    let case = shipped("sliding_block_off_grid");
    for refine in [1, 2, 4] {
        let body = Body::new(&case, refine, &TRACTION).unwrap();
        let system =
            ContactSystem::new(body.elastic.clone(), vec![0.5; body.points.len()]).unwrap();
        let load = loading(&body, &case).at(case.path.increments);
        let scatter = |name: &str, options: &[(String, f64)]| {
            let outcome = solve_body(&body, &system, &load, 1e-9, (name, options));
            let normal = outcome.state.p.iter().step_by(2).zip(&body.points);
            let t: Vec<f64> = normal.map(|(p, point)| p / point.weight).collect();
            let mean = t.iter().sum::<f64>() / t.len() as f64;
            let variance = t.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / t.len() as f64;
            variance.sqrt() / mean
        };
        let multipliers = scatter(METHOD, &[]);
        assert!(multipliers > 0.5, "{multipliers}");
        for theta in [1.0, 0.0, -1.0] {
            let nitsche = scatter("nitsche", &options(theta, 2.0));
            println!("{refine} {theta}: {nitsche:.3} instead of {multipliers:.3}");
            assert!(nitsche < 0.2, "{refine} {theta}: {nitsche}");
        }
    }
}

/// λ of a body from the claim of a run, γ = 2 λ.
fn trace_constant(body: &Body, case: &Case) -> f64 {
    let system = ContactSystem::new(body.elastic.clone(), friction(case, body)).unwrap();
    let load = loading(body, case).at(case.path.increments);
    let outcome = solve_body(body, &system, &load, 1e-9, ("nitsche", &options(1.0, 2.0)));
    match outcome.claim {
        Claim::Nitsche { gamma, .. } => 0.5 * gamma,
        other => panic!("{other:?}"),
    }
}

/// Pushed and sheared onto a crack through a unit square of 5 × 5 cells.
fn pushed(p: [f64; 2], q: [f64; 2], tip: &str) -> String {
    let rest = crack(p, q, 0.3, tip)
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[1e-3, -1e-3]");
    plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest)
}

/// Source: definition, |S u|²/w <= λ u·K u. Goal: λ bounds random fields, and is reached: by the field K⁻¹ Sᵀ w⁻¹ τ that
/// power iteration finds with nothing but K and S. With and without tips.
#[test]
fn gamma_is_measured_by_the_constant_of_the_trace_inequality() {
    let mut random = Random(31);
    for (q, tip) in [([1.1, 0.61], "none"), ([0.63, 0.45], "branch")] {
        let case = parse(&pushed([-0.1, 0.32], q, tip));
        let body = Body::new(&case, 1, &TRACTION).unwrap();
        let lambda = trace_constant(&body, &case);
        let (s, k) = (
            body.elastic.traction().unwrap(),
            body.elastic.stiffness().unwrap(),
        );
        let n = body.elastic.unknowns();
        let quotient = |u: &[f64]| {
            let mut tau = vec![0.0; s.rows()];
            s.mul(u, &mut tau);
            let mut ku = vec![0.0; n];
            k.mul(u, &mut ku);
            let weight = |row: usize| body.elastic.weight()[row / 2];
            let trace: f64 = (0..tau.len()).map(|i| tau[i] * tau[i] / weight(i)).sum();
            let energy: f64 = u.iter().zip(&ku).map(|(u, f)| u * f).sum();
            tau.iter_mut()
                .enumerate()
                .for_each(|(i, t)| *t /= weight(i));
            (trace / energy, tau)
        };
        for _ in 0..20 {
            assert!(quotient(&random.vector(n)).0 <= lambda);
        }
        let mut u = random.vector(n);
        let mut reached = 0.0;
        for _ in 0..300 {
            let (value, tau) = quotient(&u);
            reached = value;
            u = vec![0.0; n];
            s.mul_transpose_add(&tau, &mut u);
            body.elastic.solve(&mut u).unwrap();
            let size = u.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            u.iter_mut().for_each(|v| *v /= size);
        }
        println!("{tip}: {lambda} {reached}");
        assert_near(reached / lambda, 1.0, 1e-3, (&tip, &reached, &lambda));
    }
}

/// Goal: slivers do not drive γ: λ stays within a factor of 2.5, with the stress of the gradient within two, of that of a cut
/// through the middle, down to cuts of 1e-5 of a cell, ten times what is told from none, along a row of cells and through the corners of cells.
#[test]
fn slivers_do_not_drive_gamma() {
    for (stress, most) in [("", 2.5), (", dilatation = \"full\"", 2.0)] {
        let lambda = |p: [f64; 2], q: [f64; 2]| {
            let stress = format!("poisson = 0.3{stress}");
            let case = parse(&pushed(p, q, "none").replace("poisson = 0.3", &stress));
            let body = Body::new(&case, 1, &TRACTION).unwrap();
            trace_constant(&body, &case)
        };
        let row = |e: f64| lambda([-0.1, 0.4 + 0.2 * e], [1.1, 0.4 + 0.2 * e]);
        let corners = |e: f64| lambda([-0.1, 0.1 + 0.2 * e], [0.9, 1.1 + 0.2 * e]);
        let middle = [row(0.5), corners(0.5)];
        println!("{middle:?}");
        for e in [1e-1, 1e-2, 1e-4, 1e-5] {
            let thin = [row(e) / middle[0], corners(e) / middle[1]];
            println!("{e:e}: {thin:?}");
            assert!(
                thin.iter().all(|r| (1.0 / most..most).contains(r)),
                "{e:e}: {thin:?}"
            );
        }
    }
}

/// Goal: a piece that only the crack holds. Pushed and sheared by tractions, its contact forces balance the load exactly,
/// whatever the variant: Σ P in space is the resultant, since consistency terms have none.
#[test]
fn a_floating_piece_is_held_by_forces_that_balance_its_load() {
    let rest = crack([-0.1, 0.47], [1.1, 0.53], 0.3, "none")
        + &support("\"bottom\"", "[0, 0]")
        + "[[support]]\non = [\"left\", \"top\"]\ndisplacement_m = [0, \"free\"]\n"
        + &load("top", "traction_pa = [0, -1e-3]");
    let case = parse(&plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest));
    let body = Body::new(&case, 1, &TRACTION).unwrap();
    assert!(!body.elastic.floating().is_empty());
    let system = ContactSystem::new(body.elastic.clone(), friction(&case, &body)).unwrap();
    let load = loading(&body, &case).at(case.path.increments);
    for theta in [1.0, 0.0, -1.0] {
        let options = options(theta, 2.0);
        let outcome = solve_body(&body, &system, &load, 1e-10, ("nitsche", &options));
        let vertical: f64 = (body.points.iter().zip(outcome.state.p.chunks_exact(2)))
            .map(|(point, p)| point.frame[0][1] * p[0] + point.frame[1][1] * p[1])
            .sum();
        assert!((vertical - 1e-3).abs() < 1e-12, "{theta}: {vertical}");
    }
}

/// A support beside the crack takes part of the consistency term: reactions still balance the load.
#[test]
fn reactions_balance_the_load_where_the_crack_meets_a_support() {
    let rest = crack([-0.1, 0.42], [1.1, 0.61], 0.3, "none")
        + &support("[\"left\"]", "[0, 0]")
        + &load("right", "traction_pa = [-1e-3, 2e-4]");
    let case = parse(&plane([0.0, 0.0], [1.0, 1.0], [5, 5], &rest));
    let results = run_case(&case, &variants(), SETTINGS, &Quiet).unwrap();
    for run in results.increments() {
        assert!(
            matches!(run.step.verdict, Verdict::Approximate(_)),
            "{:?}: {}",
            run.key,
            run.step.verdict
        );
        for (component, exact) in [("x", 1e-3), ("y", -2e-4)] {
            let reaction = found(&results, &run.key, ["reaction", "left", component]);
            assert_near(reaction, exact, 1e-14, &run.key);
        }
    }
}

/// The stabilised operator must be positive: γ above (1 + θ)²/4, or the method says why not.
#[test]
fn too_little_stabilisation_is_refused_with_the_bound() {
    let case = parse(&pushed([-0.1, 0.32], [1.1, 0.61], "none"));
    let body = Body::new(&case, 1, &TRACTION).unwrap();
    let system = ContactSystem::new(body.elastic.clone(), friction(&case, &body)).unwrap();
    let refusal = |theta: f64, gamma: f64| {
        let registered = method("nitsche").unwrap();
        let options = Options::new(registered.options, &options(theta, gamma)).unwrap();
        (registered.build)(&options).refuses(&system)
    };
    for (theta, least) in [(1.0, "1"), (0.0, "0.25")] {
        let bound: f64 = least.parse().unwrap();
        assert_eq!(refusal(theta, 1.01 * bound), None);
        let reason = refusal(theta, bound).unwrap();
        assert!(reason.contains(&format!("gamma > {least}")), "{reason}");
    }
    assert_eq!(refusal(-1.0, 0.01), None);
}

/// Nitsche's consistency term is no contact force: equilibrium with the contact forces alone does not hold to rounding,
/// so that the answer is graded and never called solved, however coarse the tier.
#[test]
fn a_consistency_term_is_never_taken_for_equilibrium() {
    let settings = Settings {
        tier: Some(Target::Tier(Tier::Low)),
        ..SETTINGS
    };
    let case = shipped("plate_mesh1");
    let results = run_case(&case, &choices(&["nitsche"]), settings, &Quiet).unwrap();
    assert!(!results.increments().is_empty());
    for run in results.increments() {
        let graded = run.step.verdict == Verdict::Approximate(Some(Tier::Low));
        assert!(
            graded && run.step.judge.claimed_equilibrium <= 1e-12,
            "{run:?}"
        );
        assert!(run.step.judge.equilibrium > 1e-9, "{run:?}");
    }
}
