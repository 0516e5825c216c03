//! The committed study holds what this program finds: a part of its cells is measured again.

use std::collections::BTreeMap;
use std::path::Path;

use stickslip::harness::run::Choice;
use stickslip::sweep::Bench;
use stickslip::sweep::measure::{Repeats, measure};
use stickslip::sweep::plan::Plan;

fn root(path: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Columns of `cells.csv` by id.
fn committed() -> BTreeMap<String, BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(root("reports/study/cells.csv")).unwrap();
    let rows = reader.deserialize::<BTreeMap<String, String>>();
    rows.map(|row| row.unwrap())
        .map(|row| (row["id"].clone(), row))
        .collect()
}

#[test]
fn the_committed_study_has_every_cell_of_its_sweep_once() {
    let plan = Plan::read(&root("benches/study.toml")).unwrap();
    let mut ids: Vec<String> = committed().into_keys().collect();
    ids.sort();
    assert!(plan.tasks.iter().map(|task| &task.id).eq(ids.iter()));
}

/// Verdicts and work of the plate at every tolerance, by every method. Residuals are printed with two digits; the natural
/// map near the tolerance decides about one more iteration, so counters of the first-order methods may differ by one
/// where another processor rounds differently.
#[test]
fn the_committed_numbers_of_the_plate_are_found_again() {
    let plan = Plan::read(&root("benches/study.toml")).unwrap();
    let committed = committed();
    let (mut bench, mut measured) = (Bench::default(), 0);
    let plate = |id: &str| id.starts_with("plate_mesh1.r1.own.mu-0.8.");
    for task in plan.tasks.iter().filter(|task| plate(&task.id)) {
        let choice = Choice::parse(&task.cell.method).unwrap();
        let record = measure(&mut bench, &task.cell, &task.text, &choice, Repeats::NONE).unwrap();
        let (row, found) = (&committed[&task.id], &record.found);
        assert_eq!(row["verdict"], found.verdict.to_string(), "{}", task.id);
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let close = |column: &str, value: usize| {
            let difference = (number(column) - value as f64).abs();
            assert!(
                difference <= 0.02 * value as f64 + 1.0,
                "{}: {column} {value}",
                task.id
            );
        };
        close("iterations", found.sum(|i| i.iterations));
        close(
            "tangent_factorisations",
            found.sum(|i| i.tangent_factorisations),
        );
        let error = found.solver_error.as_ref().unwrap().energy;
        // Two digits, and one more iteration at most; rounding is not compared.
        let printed = number("error_energy");
        assert!(
            (printed - error).abs() <= 0.05 * error.max(1e-11),
            "{}: {printed:e} {error:e}",
            task.id
        );
        measured += 1;
    }
    assert_eq!(measured, 135, "15 methods, 9 tolerances");
}
