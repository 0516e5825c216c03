//! Rules of a sweep file: its axes, and where a bad one is refused.

use std::fs;

use super::pipeline::{measured, planned, records};
use crate::common::ends_with;
use stickslip::studies::plan::Plan;
use stickslip::studies::record::Record;
use stickslip::studies::task::Task;

/// A good file, up to what is added.
const GOOD: &str = "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\n";

#[test]
fn bad_sweep_files_are_refused_at_their_place() {
    let with = |line: &str| format!("{GOOD}{line}\n");
    let instead = |from: &str, to: &str| GOOD.replace(from, to);
    #[rustfmt::skip]
    let rows = [
        (instead("cyclic", "cyclik"), "3:10", "unknown case"),
        (instead("cyclic", "no.toml"), "3:10", "no.toml"),
        (instead("cyclic", &format!("cyclic\", \"{}.toml", "x".repeat(100_000))), "3:20", "cells"),
        (instead("cases = [\"cyclic\"]", "random = { dimension = 2, problems = 1000000 }"), "3:38", "out of range"),
        (with("methods = [\"newton\"]"), "4:12", "unknown method `newton`"),
        (with("methods = [\"penalty:normal=-1\"]"), "4:12", "normal"),
        (with("methods = []"), "4:11", "empty list"),
        (with("tolerances = [2.0]"), "4:15", "out of range"),
        (with("tolerances = [1e-3, \"x\"]"), "4:21", "wrong type"),
        (with("refine = [0]"), "4:11", "out of range"),
        (with("contact = [\"stars\"]"), "4:12", "did you mean `star`?"),
        (with("friction = [-0.1]"), "4:13", "out of range"),
        (with("looks = [\"stop\"]"), "4:10", "did you mean `stops`?"),
        (with("random = { dimension = 2, problems = 3 }"), "4:10", "exclude each other"),
        (with("bodies = { dimension = 2, points = [100], of_each = 3 }"), "4:10", "exclude each other"),
        (instead("cases = [\"cyclic\"]", "bodies = { dimension = 2, points = [3], of_each = 1 }"), "3:", "out of range"),
        (with("increments = [0]"), "4:15", "out of range"),
        (with("increments = []"), "4:14", "empty list"),
        (with("start = [\"warm\", \"cool\"]"), "4:18", "did you mean `cold`?"),
        (with("meshes = [1]"), "4:1", "unknown key"),
        (with("options = {}"), "4:11", "empty table"),
        (with("options.r = 1"), "4:13", "wrong type"),
        (with("options.r = []"), "4:13", "empty list"),
        (with("options.x = [1]"), "4:13", "no method has an option `x`"),
        (with("options = { r = [1], gamma = [2] }"), "4:11", "no method has all of them"),
        (with("methods = [\"pdas\", \"nsgs\"]\noptions.r = [1]"), "4:20", "no option `r`"),
        (with("methods = [\"pdas:r=2\"]\noptions.r = [1, 3]"), "4:12", "given twice"),
        (with("options.r = [1, 1e4]"), "4:17", "a number from 0.001 to 1000"),
        (with("methods = [\"hybrid\"]\noptions.first = [5, 2.5]"), "5:21", "a whole number from 1 to 10000"),
        (with("options.monolithic = [0, 2]"), "4:26", "a whole number from 0 to 1"),
        (with("options.first = { from = 1, to = 10, per_decade = 2 }"), "4:17", "3.162e0 is not allowed"),
        (with("options.r = { from = 1, to = 0.1 }"), "4:30", "out of range"),
        (with("options.r = { from = 0, to = 1 }"), "4:22", "out of range"),
        (with("options.r = { from = 1 }"), "4:13", "missing `to`"),
        (instead("[[cells]]", "repeats = { least = 0 }\n[[cells]]"), "2:21", "out of range"),
        (instead("title", "title = "), "1:", "not valid TOML"),
        ("title = \"t\"\n".to_owned(), "1:1", "[[cells]]"),
    ];
    for (text, place, part) in rows {
        let error = Plan::parse("sweep.toml".as_ref(), &text)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with(&format!("sweep.toml:{place}")),
            "{text}\n{error}"
        );
        assert!(
            error.contains(part) && error.len() < 1500,
            "{text}\n{error}"
        );
    }
    // Files are one increment from rest, and begin nowhere else.
    let file = super::interchange::shipped_file("local_csr.hdf5");
    let files = format!("files = [{:?}]\nstart = [\"cold\"]", file.to_str().unwrap());
    let text = instead("cases = [\"cyclic\"]", &files);
    let error = Plan::parse("sweep.toml".as_ref(), &text)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("4:9") && error.contains("one increment from rest"),
        "{error}"
    );
    // Through the program nothing is left behind.
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("sweep.toml"), with("methods = []")).unwrap();
    let (_, error) = ends_with(2, &["study", "sweep.toml", "--out", "out"], dir.path());
    assert!(
        error.contains("sweep.toml:4:11") && !dir.path().join("out").exists(),
        "{error}"
    );
}

/// Methods and options in the ids of a sweep of one case at one tolerance.
fn listed(block: &str) -> Vec<String> {
    let plan = Plan::parse(
        "sweep.toml".as_ref(),
        &format!("{GOOD}tolerances = [1e-6]\n{block}\n"),
    );
    let method = |task: &Task| {
        let id = task.id();
        let (_, method) = id.split_once(".mu-0.3.").unwrap();
        method.split_once(".tol-").unwrap().0.to_owned()
    };
    let mut found: Vec<String> = plan.unwrap().tasks.iter().map(method).collect();
    found.sort();
    found
}

/// Goal: an option is an axis; ids name the value as on the command line, and the default is the plain method.
#[test]
fn options_of_methods_are_axes_of_a_sweep() {
    let grid = "methods = [\"pdas\"]\noptions.r = { from = 0.1, to = 10, per_decade = 2 }";
    let expected = [
        "pdas",
        "pdas-r=1e-1",
        "pdas-r=1e1",
        "pdas-r=3.162e-1",
        "pdas-r=3.162e0",
    ];
    assert_eq!(listed(grid), expected);
    // The default stands between the values of a grid, and is not added to a list.
    let off = "methods = [\"pdas\"]\noptions.r = { from = 0.5, to = 5 }";
    assert_eq!(listed(off), ["pdas", "pdas-r=5e-1", "pdas-r=5e0"]);
    let list = "methods = [\"pdas\"]\noptions.r = [0.5, 2]";
    assert_eq!(listed(list), ["pdas-r=2e0", "pdas-r=5e-1"]);
    // Without names every method that has all options, with every combination.
    let both = "options = { r = [1, 2], monolithic = [0, 1] }";
    let expected: Vec<String> = ["b-newton", "gnm", "ncp-newton", "newton-ac", "pdas"]
        .iter()
        .flat_map(|name| {
            let ends = ["", "-monolithic=1e0", "-r=2e0", "-r=2e0-monolithic=1e0"];
            ends.map(|end| format!("{name}{end}"))
        })
        .collect();
    assert_eq!(listed(both), expected);
    // Beside options that a method is given by name.
    let beside = "methods = [\"hybrid:first=3\"]\noptions.r = [2]";
    assert_eq!(listed(beside), ["hybrid-r=2e0-first=3e0"]);
}

/// Goal: both axes stand in ids; without them a task has the id that it always had.
#[test]
fn increments_and_starts_are_axes_of_a_sweep() {
    let listed = |block: &str| listed(&format!("methods = [\"pdas\"]\n{block}"));
    assert_eq!(listed("increments = [1]\nstart = [\"warm\"]"), ["pdas"]);
    let both = "increments = [10, 1]\nstart = [\"warm\", \"cold\"]";
    let expected = [
        "cold.pdas",
        "increments-10.cold.pdas",
        "increments-10.pdas",
        "pdas",
    ];
    assert_eq!(listed(both), expected);
}

/// Goal: what they change, through the program: a path in more increments, other counts of iterations, the same answers.
#[test]
fn records_and_tables_tell_increments_and_starts_apart() {
    let (dir, plan) = planned(
        "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\nmethods = [\"nsgs\", \"penalty\"]\n\
         increments = [1, 2]\nstart = [\"warm\", \"cold\"]\ntolerances = [1e-6]\n",
    );
    let run = "sweep.toml --untimed --out out";
    assert_eq!(measured(dir.path(), run), 8);
    let out = dir.path().join("out");
    let records = records(&out, &plan.tasks);
    for record in records.values() {
        let (asked, found) = (&record.asked, &record.found);
        assert_eq!(
            found.increments.len(),
            1 + 16 * asked.increments,
            "{}",
            record.id
        );
        assert!(found.verdict.is_honest(), "{}", record.id);
        // Of the converged solution in the same increments: soft springs are off by their modelling error, from either start.
        let error = found.solver_error.as_ref().unwrap().energy;
        assert!(error < 1e-2, "{}: {error:e}", record.id);
        let warm = |o: &&Record| {
            !o.asked.cold
                && (&o.asked.method, o.asked.increments) == (&asked.method, asked.increments)
        };
        let twin = records.values().find(warm).unwrap();
        let other = twin.found.solver_error.as_ref().unwrap().energy;
        assert!(
            (error - other).abs() < 1e-5,
            "{}: {error:e} {other:e}",
            record.id
        );
        if asked.cold && asked.method == "nsgs" {
            let [cold, warm] = [found, &twin.found].map(|f| f.sum(|i| i.iterations));
            assert!(cold > warm, "{}: {cold} {warm}", record.id);
        }
    }
}
