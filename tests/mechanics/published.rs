//! The founding paper's tables, by every exact method; and what the harness adds to them.

use crate::common::*;
use stickslip::case::shipped;
use stickslip::run::registry::methods;
use stickslip::studies::results::Results;

fn exact() -> Vec<&'static str> {
    let methods = methods().iter().filter(|m| m.exact);
    methods.map(|m| m.name).collect()
}

fn shipped_run(name: &str, methods: &[&str]) -> Results {
    run(&shipped::find(name).unwrap().unwrap(), methods)
}

/// Rows of a printed table: name cells, then numbers.
fn printed(text: &str, names: usize) -> Vec<(Vec<&str>, Vec<f64>)> {
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let numbers = cells[names..].iter().map(|c| c.parse().unwrap()).collect();
        (cells[..names].to_vec(), numbers)
    });
    rows.collect()
}

/// Source: founding paper, Table 1, Mesh I: 973.3, 1107.4, 1137.5 (MN/m) for μ = 0.1, 0.8, 1.2.
/// Goal: the completed example of section 5.1 reproduces it; all exact methods give one number.
/// Tolerance 1e-3: crack length, plane state and clamping are not printed and were found by fit; the largest deviation
/// is 8e-4, at μ = 1.2. Methods among each other: 1e-6, far above their tolerance of 1e-9.
#[test]
fn table_1_mesh_1_is_reproduced_by_every_exact_method() {
    let results = shipped_run("plate_mesh1", &exact());
    let table = printed(include_str!("../../cases/reference/plate_table1.csv"), 1);
    let rows = table.iter().filter(|(names, _)| names[0] == "I");
    let mut compared = 0;
    for (_, numbers) in rows {
        let (friction, reaction) = (numbers[0], numbers[1]);
        let of = |method: &str| {
            let key =
                |k: &stickslip::studies::rows::RunKey| k.friction == friction && k.method == method;
            -value(&results, key, ["reaction", "top", "y"]) / 1e6
        };
        let reference = of(METHOD);
        for method in exact() {
            let found = of(method);
            println!("μ = {friction}, {method}: {found:.2} against {reaction}");
            assert_near(found / reaction, 1.0, 1e-3, (&method, &friction, &found));
            assert_near(found / reference, 1.0, 1e-6, (&method, &friction, &found));
            compared += 1;
        }
    }
    assert_eq!(compared, 3 * exact().len());
}

/// u of P1 … P7 for one component [m].
fn probes(results: &Results, friction: f64, method: &str, component: &str) -> Vec<f64> {
    let key = |k: &stickslip::studies::rows::RunKey| k.friction == friction && k.method == method;
    (1..=7)
        .map(|i| value(results, key, ["displacement", &format!("P{i}"), component]))
        .collect()
}

/// Source: founding paper, Table 2: two models, three components, seven points. Goal: all 42 numbers, with μ = 0 as the
/// printed law reads (its Eq. 7 has no friction); with the stated μ = 0.1 they are missed by far more.
/// Tolerance 1e-9 m: half a unit of the last printed digit is 5e-10 m (x, z) and 5e-11 m (y).
///
/// With exact sub-cells Model I is the same discrete problem as Model II (12 digits), so the difference between the two
/// printed models is the quadrature of the cut cells.
#[test]
fn table_2_is_reproduced_in_all_42_numbers_and_both_models_are_one_with_exact_sub_cells() {
    let first = shipped_run("beam_model1_gauss6", &[METHOD]);
    let second = shipped_run("beam_model2", &[METHOD]);
    let table = printed(include_str!("../../cases/reference/beam_table2.csv"), 2);
    let mut compared = 0;
    let (mut worst, mut stated): (f64, f64) = (0.0, 0.0);
    for (names, numbers) in &table {
        let results = if names[0] == "I" { &first } else { &second };
        let off = |friction: f64| {
            let found = probes(results, friction, METHOD, names[1]);
            let pairs = found.iter().zip(numbers);
            pairs
                .map(|(f, p)| (f - p * 1e-3).abs())
                .collect::<Vec<f64>>()
        };
        for difference in off(0.0) {
            assert!(difference < 1e-9, "{names:?}: {difference:e}");
            worst = worst.max(difference);
            compared += 1;
        }
        stated = off(0.1).into_iter().fold(stated, f64::max);
    }
    println!("as printed: {worst:.1e} m, as stated: {stated:.1e} m");
    assert_eq!(compared, 42);
    assert!(stated > 1e-6, "{stated:e}");

    let sub_cells = shipped_run("beam_model1", &[METHOD]);
    for friction in [0.0, 0.1] {
        for component in ["x", "y", "z"] {
            let one = probes(&sub_cells, friction, METHOD, component);
            let two = probes(&second, friction, METHOD, component);
            for (a, b) in one.iter().zip(two) {
                assert!((a - b).abs() < 1e-12, "{component} {friction}: {a:e} {b:e}");
            }
        }
    }
}
