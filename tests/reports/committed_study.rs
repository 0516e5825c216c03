//! The committed study holds what this program finds: a part of its cells is measured again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::studies::measure::Bench;
use stickslip::studies::measure::here;
use stickslip::studies::plan::Plan;
use stickslip::studies::task::Task;

fn root(path: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Columns of `runs.csv` by id.
fn committed() -> BTreeMap<String, BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(root("reports/study/runs.csv")).unwrap();
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
        .filter(|task| methods.contains(name(&task.asked.method)));
    assert!(known.map(Task::id).eq(ids.into_iter().cloned()));
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
    let plate = |id: &str| id.starts_with("plate_mesh1.r1.own.mu-0.8.");
    let held = |task: &Task| plate(&task.id()) && committed.contains_key(&task.id());
    let tasks: Vec<Task> = plan.tasks.into_iter().filter(held).collect();
    let methods: BTreeSet<&str> = tasks.iter().map(|own| &*own.asked.method).collect();
    let choices: Vec<Choice> = (methods.into_iter())
        .map(|own| Choice::parse(own).unwrap())
        .collect();
    let bench = &mut Bench::default();
    let answers = here(bench, &tasks, &choices, 1, None, &Quiet, &mut |_, _| ()).unwrap();
    let measured = answers.len();
    for record in answers.into_iter().map(|own| own.record) {
        let id = &record.id;
        let (row, found) = (&committed[id], &record.found);
        assert_eq!(row["verdict"], found.verdict.to_string(), "{id}");
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let close = |column: &str, value: usize| {
            let difference = (number(column) - value as f64).abs();
            assert!(
                difference <= 0.02 * value as f64 + 1.0,
                "{id}: {column} {value}"
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
            "{id}: {printed:e} {error:e}"
        );
    }
    let expected = committed.keys().filter(|id| plate(id)).count();
    assert!(
        measured == expected && measured > 100,
        "{measured} of {expected}"
    );
}
