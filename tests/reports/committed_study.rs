//! The committed study holds what this program finds: a part of its cells is measured again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use stickslip::run::choice::Choice;
use stickslip::studies::sweep::cell::Source;
use stickslip::studies::sweep::measure::Bench;
use stickslip::studies::sweep::measure::measure;
use stickslip::studies::sweep::plan::Plan;

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
fn the_committed_study_has_every_cell_of_its_methods_once() {
    let plan = Plan::read(&root("benches/study.toml")).unwrap();
    let committed = committed();
    let methods: BTreeSet<&str> = committed.values().map(|row| name(&row["method"])).collect();
    let mut ids: Vec<&String> = committed.keys().collect();
    ids.sort();
    // Methods registered since are compared when the study is measured again.
    let known = plan
        .tasks
        .iter()
        .filter(|task| methods.contains(name(&task.cell.method)));
    assert!(known.map(|task| &task.id).eq(ids));
}

/// Name of a method without its options.
fn name(label: &str) -> &str {
    label.split(['[', ':']).next().unwrap_or(label)
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
    let held = |id: &str| plate(id) && committed.contains_key(id);
    for task in plan.tasks.iter().filter(|task| held(&task.id)) {
        let choice = Choice::parse(&task.cell.method).unwrap();
        let Source::Case(text) = &*task.source else {
            panic!("{} comes from a file", task.id)
        };
        let record = measure(&mut bench, &task.cell, text, &choice).unwrap();
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
    let expected = committed.keys().filter(|id| plate(id)).count();
    assert!(
        measured == expected && measured > 100,
        "{measured} of {expected}"
    );
}
