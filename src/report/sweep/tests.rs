use std::collections::BTreeMap;

use crate::run::registry::methods;

use crate::model::errors::Deviation;
use crate::report::sweep::*;
use crate::studies::analysis::support::{end_with, lying, record, timed};
use crate::studies::followed::Value;

/// Files that must not depend on times.
const TIMELESS: [&str; 2] = ["increments.csv", "success.csv"];

/// Three meshes of a plate with closed form and two of a beam without, with and without friction, by all methods at five
/// tolerances; nsgs fails on the finest plate, barrier is refused on the beam.
pub fn records_of_a_sweep() -> Vec<Record> {
    let problems = [("plate", [1, 2, 4].as_slice(), 2), ("beam", &[1, 2, 3], 3)];
    let mut records = Vec::new();
    for (case, meshes, dim) in problems {
        for refine in meshes {
            for mu in [0.0, 0.3] {
                for (index, method) in methods().iter().enumerate() {
                    for exponent in [2, 3, 6, 9, 10] {
                        let tolerance = 10f64.powi(-exponent);
                        let cell = cell(case, *refine, dim, mu, method.name, tolerance, index);
                        records.push(cell);
                    }
                }
                for exponent in [2, 3, 5, 6] {
                    let options = format!("penalty:normal=1e{exponent},tangential=1e{exponent}");
                    let mut cell = cell(case, *refine, dim, mu, &options, 1e-9, 13);
                    approximate(&mut cell, 10f64.powi(-exponent));
                    records.push(cell);
                }
            }
        }
    }
    records
}

fn cell(
    case: &str,
    refine: usize,
    dim: usize,
    mu: f64,
    method: &str,
    tolerance: f64,
    index: usize,
) -> Record {
    let digits = -tolerance.log10();
    // Newton methods come first in the registry; the rest gain a fixed factor per step.
    let newton = index < 5;
    let steps = if newton { 4 + index } else { 8 * (index - 3) };
    let iterations = if newton {
        steps
    } else {
        (steps as f64 * digits) as usize
    };
    let points = 10 * refine.pow(dim as u32 - 1);
    let wobble = 1.0 + 0.3 * ((7 * index + 3 * refine + case.len()) as f64).sin();
    let seconds = 2e-5 * wobble * points as f64 * iterations as f64;
    let mut cell = timed(record(case, method, tolerance), seconds);
    cell.asked.refine = refine;
    cell.asked.friction = vec![mu];
    cell.id = cell.asked.id();
    let size = cell.found.problem.as_mut().unwrap();
    size.mesh = format!("{0}x{0}", 10 * refine);
    size.h_m = 1.0 / refine as f64;
    size.dim = dim;
    size.points = points;
    size.unknowns = points * if mu > 0.0 { dim } else { 1 };
    size.dofs = dim * (10 * refine).pow(dim as u32);
    let scale = size.dofs as f64;
    let increment = &mut cell.found.increments[0];
    increment.iterations = iterations;
    increment.local_solves = iterations * points;
    increment.tangent_factorisations = if newton {
        steps
    } else {
        usize::from(index < 9)
    };
    if case == "beam" {
        let second = cell.found.increments[0].clone();
        cell.found.increments.push(second);
        let h = cell.found.problem.as_ref().unwrap().h_m;
        cell.found.values.push(Value {
            quantity: "strain_energy".into(),
            at: String::new(),
            value: 5.0 - 0.2 * h * h,
            norm: 5.0,
            scale: 5.0,
        });
    } else {
        cell.found.deviations.push(Deviation {
            quantity: "energy".into(),
            at: String::new(),
            found: 1.0,
            exact: 1.0,
            error: 0.1 / refine as f64,
        });
    }
    let spent = cell.spent.as_mut().unwrap();
    spent.setup_s = 1e-6 * scale;
    spent.assembly_s = 4e-6 * scale;
    spent.factorisation_s = 2e-6 * scale.powf(1.2);
    spent.condensation_s = 1e-5 * points as f64;
    spent.output_s = 5e-7 * scale;
    let newton_error = if newton {
        tolerance * tolerance
    } else {
        0.3 * tolerance
    };
    cell.found.solver_error.as_mut().unwrap().energy = newton_error;
    match method {
        "penalty" => approximate(&mut cell, 1e-4),
        "nitsche" => approximate(&mut cell, 3e-5),
        "barrier" if case == "beam" => fail(&mut cell, "refused: no reason"),
        "barrier" => approximate(&mut cell, 1e-4),
        "nsgs" if refine == 4 => fail(&mut cell, "gave-up: max-iterations"),
        _ => {}
    }
    cell
}

/// Laws of its own with this natural map.
fn approximate(cell: &mut Record, map: f64) {
    let verdict = match map {
        _ if map <= cell.asked.tolerance => "solved",
        _ if map <= 1e-6 => "approximate: mid",
        _ if map <= 1e-3 => "approximate: low",
        _ => "approximate: none",
    };
    for increment in &mut cell.found.increments {
        increment.judge.natural_map = map;
        increment.judge.violation = map;
        increment.verdict = verdict.parse().unwrap();
    }
    cell.found.verdict = verdict.parse().unwrap();
    cell.found.solver_error.as_mut().unwrap().energy = 0.1 * map;
}

fn fail(cell: &mut Record, verdict: &str) {
    end_with(cell, verdict);
    cell.found.solver_error = None;
    cell.found.deviations.clear();
    cell.found.values.clear();
}

fn files(records: &[Record]) -> BTreeMap<String, Vec<u8>> {
    let bundle = bundle(records, records.len(), &Provenance::collect(1)).unwrap();
    let file = |path: &str| (path.to_owned(), bundle.get(path).unwrap().to_vec());
    bundle.paths().map(file).collect()
}

type Line = BTreeMap<String, String>;

/// The rows of a file by column.
fn rows(file: &[u8]) -> Vec<Line> {
    let mut reader = csv::Reader::from_reader(file);
    reader.deserialize().map(Result::unwrap).collect()
}

/// Rows of `runs.csv` without what belongs to the machine.
fn untimed(file: &[u8]) -> Vec<Line> {
    let mut rows = rows(file);
    let spent = |name: &str| name.ends_with("_s") || ["repetitions", "peak_mb"].contains(&name);
    rows.iter_mut()
        .for_each(|row| row.retain(|name, _| !spent(name)));
    rows
}

#[test]
fn a_liar_leaves_no_time_in_any_file() {
    let mut records = records_of_a_sweep();
    let verdicts = [
        "false-claim",
        "gave-up: stalled",
        "refused: no",
        "crashed: no",
        "timed-out",
        "out-of-memory",
    ];
    for (record, verdict) in records
        .iter_mut()
        .skip(2)
        .step_by(11)
        .zip(verdicts.iter().cycle())
    {
        let mut liar = lying(verdict);
        liar.asked = record.asked.clone();
        liar.id = record.id.clone();
        liar.found.problem = record.found.problem.clone();
        liar.found.method = record.found.method.clone();
        *record = liar;
    }
    let with = files(&records);
    let mut stripped = 0;
    for record in &mut records {
        if !record.found.verdict.is_honest() {
            assert!(record.spent.take().is_some());
            stripped += 1;
        }
    }
    assert!(stripped > 80, "{stripped}");
    let without = files(&records);
    assert!(with.keys().eq(without.keys()));
    for (path, contents) in &with {
        assert!(*contents == without[path], "{path}");
    }
    let rows = rows(&with["runs.csv"]);
    let (lies, others): (Vec<_>, Vec<_>) =
        (rows.iter()).partition(|row| row["verdict"] == "false-claim");
    assert!(!lies.is_empty() && lies.iter().all(|row| row["total_s"] == "NaN"));
    let timed = others.iter().filter(|row| row["total_s"] != "NaN");
    assert!(timed.count() > 100);
}

#[test]
fn counters_and_errors_stand_in_files_without_times() {
    let mut records = records_of_a_sweep();
    let before = files(&records);
    for (index, record) in records.iter_mut().enumerate() {
        *record = timed(record.clone(), 1.0 + (index % 7) as f64);
    }
    let after = files(&records);
    for path in TIMELESS {
        assert_eq!(before[path], after[path], "{path}");
    }
    assert_eq!(untimed(&before["runs.csv"]), untimed(&after["runs.csv"]));
    assert_ne!(before["ranking.csv"], after["ranking.csv"]);
}

#[test]
fn the_order_of_the_records_does_not_matter() {
    let mut records = records_of_a_sweep();
    let before = files(&records);
    records.reverse();
    let after = files(&records);
    assert!(before.keys().eq(after.keys()));
    for (path, contents) in before {
        assert!(contents == after[&path], "{path}");
    }
}

#[test]
fn every_cell_stands_in_its_table_and_every_problem_has_a_figure() {
    let records = records_of_a_sweep();
    let files = files(&records);
    let lines = |path: &str| {
        let text = String::from_utf8(files[path].clone()).unwrap();
        text.lines().count() - 1
    };
    assert_eq!(lines("runs.csv"), records.len());
    let increments = records.iter().map(|r| r.found.increments.len());
    assert_eq!(lines("increments.csv"), increments.sum::<usize>());
    let count = |start: &str| files.keys().filter(|path| path.starts_with(start)).count();
    assert_eq!(count("figures/time_against_solver_error."), 12);
    assert_eq!(count("figures/time_against_total_error."), 4);
    assert_eq!(count("figures/stages."), 4);
    assert_eq!(count("figures/profile."), 1);
}

#[test]
fn swept_options_have_tables_and_a_figure() {
    assert!(!files(&records_of_a_sweep()).contains_key("options.csv"));
    let mut records = Vec::new();
    for case in ["plate", "beam"] {
        for value in ["", ":r=1e-1", ":r=1e1", ":r=1e2"] {
            let mut record = record(case, &format!("pdas{value}"), 1e-6);
            if value == ":r=1e2" && case == "beam" {
                fail(&mut record, "gave-up: stalled");
            }
            records.push(record);
        }
    }
    let files = files(&records);
    let text = |path: &str| String::from_utf8(files[path].clone()).unwrap();
    let row = "pdas,r,1,1e-6,2,0.1,10,10,0.1,10,0.1,100";
    assert_eq!(text("options.csv").lines().nth(1), Some(row));
    let figure = text("figures/options.svg");
    assert!(
        figure.contains(">50 %<") && figure.contains("pdas, r, 1e-6"),
        "{figure}"
    );
}

#[test]
fn without_times_there_are_no_rankings_and_no_errors() {
    let mut records = records_of_a_sweep();
    records.iter_mut().for_each(|record| record.spent = None);
    let files = files(&records);
    assert!(!files.contains_key("figures/profile.time.svg"));
    assert!(!files.contains_key("ranking.csv"));
    assert!(
        bundle(&[], 0, &Provenance::collect(1)).is_ok(),
        "no cell yet"
    );
}

#[test]
fn an_incomplete_sweep_says_so() {
    let records = records_of_a_sweep();
    let text = |total: usize| {
        let bundle = bundle(&records, total, &Provenance::collect(1)).unwrap();
        String::from_utf8(bundle.get("success.md").unwrap().to_vec()).unwrap()
    };
    let count = records.len();
    let told = format!("incomplete, {count} of {} cells", count + 5);
    assert!(text(count + 5).contains(&told));
    assert!(!text(count).contains("incomplete"));
}
