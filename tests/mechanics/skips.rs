//! A scene pays only for what it has: the counters prove each skip.

use crate::common::*;
use stickslip::case::shipped;
use stickslip::model::body::{Body, Needs};
use stickslip::run::registry::methods;
use stickslip::run::verdict::Verdict;
use stickslip::studies::results::Results;

fn names(exact: bool) -> Vec<&'static str> {
    let methods = methods().iter().filter(|m| m.exact || !exact);
    methods.map(|m| m.name).collect()
}

/// K does not change with contact: one factorisation per mesh serves every friction value, method and increment.
#[test]
fn one_factorisation_serves_every_friction_value_method_and_increment() {
    let mut case = shipped::find("sliding_block_cycle").unwrap().unwrap();
    case.sweep.friction = vec![0.1, 0.2];
    case.sweep.refine = vec![1, 3];
    case.path.increments = 3;
    let results = run(&case, &names(false));
    let expected = methods().len() * 2 * 2 * 3;
    assert!(
        results.increments().len() > expected / 2,
        "{}",
        results.increments().len()
    );
    for row in results.increments() {
        let spent = row.record.spent.as_ref();
        assert_eq!(
            spent.map(|own| own.factorisations),
            Some(1),
            "{:?}",
            row.key
        );
    }
}

/// A crack pulled open: one solve, no iteration, no Delassus operator, whatever the method.
#[test]
fn an_open_crack_costs_one_solve_and_nothing_else() {
    let case = shipped::find("tension_open").unwrap().unwrap();
    for method in methods() {
        let results = run(&case, &[method.name]);
        assert_eq!(results.increments().len(), 1);
        let row = &results.increments()[0];
        let spent = row.record.spent.as_ref();
        assert_eq!(row.step.verdict, Verdict::Solved, "{}", method.name);
        assert_eq!(
            (row.step.solves, row.step.iterations),
            (1, 0),
            "{}",
            method.name
        );
        assert_eq!(
            spent.map(|own| own.condensation_s),
            Some(0.0),
            "{}",
            method.name
        );
    }
    let found = solve(&case.source);
    assert_eq!(found.body.elastic.counters().condensations, 0);
    assert_eq!(found.body.elastic.counters().factorisations, 1);
}

/// Contact unknowns and points of every run.
fn sizes(results: &Results) -> Vec<[usize; 2]> {
    let problems = results
        .records()
        .map(|run| run.found.problem.as_ref().unwrap());
    problems.map(|own| [own.unknowns, own.points]).collect()
}

/// μ = 0: no tangential rows, so as many contact unknowns as points; with friction twice (2D) and three times (3D).
#[test]
fn a_frictionless_crack_has_one_unknown_per_point() {
    let case = shipped::find("frictionless").unwrap().unwrap();
    let results = run(&case, &names(false));
    for [unknowns, points] in sizes(&results) {
        assert_eq!(unknowns, points);
        assert!(points > 0);
    }
    let mut case = shipped::find("plate_mesh1").unwrap().unwrap();
    case.sweep.friction = vec![0.0, 0.1];
    let results = run(&case, &["b-newton"]);
    let [none, some] = [0, 1].map(|run| sizes(&results)[run]);
    assert_eq!([none[0], some[0]], [none[1], 2 * some[1]]);
    let rest = support("\"bottom\"", "[0, 0, 0]") + &support("\"top\"", "[1e-3, 0, -1e-3]");
    for (mu, components) in [(0.0, 1), (0.2, 3)] {
        let planes = [([0.0, 0.0, 0.5], [0.0, 0.0, 1.0], mu)];
        let results = run(
            &parse(&solid([1.0, 1.0, 1.0], [2, 2, 3], &planes, &rest)),
            &["b-newton"],
        );
        let [unknowns, points] = sizes(&results)[0];
        assert_eq!(unknowns, components * points);
    }
}

/// Two cracks, one of them without friction: only the other has tangential unknowns.
#[test]
fn only_points_with_friction_have_tangential_unknowns() {
    let rest = crack([-0.1, 0.3], [1.1, 0.3], 0.0, "none")
        + &crack([0.2, 0.75], [0.8, 0.77], 0.4, "branch")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[1e-3, -1e-3]");
    let found = solve(&plane([0.0, 0.0], [1.0, 1.0], [6, 7], &rest));
    let points = &found.body.points;
    let with = points.iter().filter(|p| p.crack == 1).count();
    assert!(with > 0 && with < points.len());
    assert_eq!(found.system.rows(), points.len() + with);
}

/// A body whose cracks leave it has no branch functions and no fan quadrature; without Heaviside functions beyond the
/// cut cells' nodes either.
#[test]
fn a_crack_without_tips_has_no_branch_functions() {
    let rest = crack([-0.1, 0.32], [1.1, 0.61], 0.1, "branch")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[0, -1e-3]");
    let body = body(&plane([0.0, 0.0], [1.0, 1.0], [6, 7], &rest));
    assert!(body.enrichment.tips.is_empty() && body.enrichment.tip_cells.is_empty());
    let cut: std::collections::BTreeSet<u32> = (0..body.mesh.cell_count())
        .filter(|&c| body.enrichment.partition(c).is_some())
        .flat_map(|c| body.mesh.cell(c).to_vec())
        .collect();
    assert_eq!(
        body.enrichment.functions.len() - body.mesh.nodes.len(),
        cut.len()
    );
}

/// A case whose every run is frictionless is set up without tangential rows in the condensation.
#[test]
fn a_frictionless_sweep_condenses_normal_rows_only() {
    let case = shipped::find("frictionless").unwrap().unwrap();
    let needs = Needs {
        frictionless: vec![true],
        ..Needs::default()
    };
    let body = Body::new(&case, 1, &needs).unwrap();
    assert!((0..body.points.len()).all(|i| body.elastic.frictionless(i)));
    assert_eq!(body.elastic.jump().rows(), 2 * body.points.len());
}
