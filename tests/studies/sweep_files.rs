//! What a sweep file may say: its axes, and where a bad one is refused.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use stickslip::studies::sweep::record::Record;

use super::sweep::{code, found, study};

#[test]
fn bad_sweep_files_are_refused_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.toml");
    let good = "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\n";
    for (text, place, part) in [
        ("title = \"t\"\n".to_owned(), "1:1", "[[cells]]"),
        (good.replace("cyclic", "cyclik"), "3:10", "unknown case"),
        (good.replace("cyclic", "no.toml"), "", "no.toml"),
        (
            format!("{good}methods = [\"newton\"]\n"),
            "4:12",
            "unknown method `newton`",
        ),
        (
            format!("{good}methods = [\"penalty:normal=-1\"]\n"),
            "4:12",
            "normal",
        ),
        (format!("{good}methods = []\n"), "4:11", "empty list"),
        (
            format!("{good}tolerances = [2.0]\n"),
            "4:15",
            "out of range",
        ),
        (
            format!("{good}tolerances = [1e-3, \"x\"]\n"),
            "4:21",
            "wrong type",
        ),
        (format!("{good}refine = [0]\n"), "4:11", "out of range"),
        (
            format!("{good}contact = [\"stars\"]\n"),
            "4:12",
            "did you mean `star`?",
        ),
        (format!("{good}friction = [-0.1]\n"), "4:13", "out of range"),
        (
            format!("{good}random = {{ dimension = 2, problems = 3 }}\n"),
            "4:10",
            "exclude each other",
        ),
        (
            format!("{good}bodies = {{ dimension = 2, points = [100], of_each = 3 }}\n"),
            "4:10",
            "exclude each other",
        ),
        (
            good.replace(
                "cases = [\"cyclic\"]",
                "bodies = { dimension = 2, points = [3], of_each = 1 }",
            ),
            "3:",
            "out of range",
        ),
        (format!("{good}increments = [0]\n"), "4:15", "out of range"),
        (format!("{good}increments = []\n"), "4:14", "empty list"),
        (
            format!("{good}start = [\"warm\", \"cool\"]\n"),
            "4:18",
            "did you mean `cold`?",
        ),
        (
            good.replace(
                "cases = [\"cyclic\"]",
                "files = [\"x.hdf5\"]\nstart = [\"cold\"]",
            ),
            "4:9",
            "one increment from rest",
        ),
        (format!("{good}meshes = [1]\n"), "4:1", "unknown key"),
        (format!("{good}options = {{}}\n"), "4:11", "empty table"),
        (format!("{good}options.r = 1\n"), "4:13", "wrong type"),
        (format!("{good}options.r = []\n"), "4:13", "empty list"),
        (
            format!("{good}options.x = [1]\n"),
            "4:13",
            "no method has an option `x`",
        ),
        (
            format!("{good}options = {{ r = [1], gamma = [2] }}\n"),
            "4:11",
            "no method has all of them",
        ),
        (
            format!("{good}methods = [\"pdas\", \"nsgs\"]\noptions.r = [1]\n"),
            "4:20",
            "no option `r`",
        ),
        (
            format!("{good}methods = [\"pdas:r=2\"]\noptions.r = [1, 3]\n"),
            "4:12",
            "given twice",
        ),
        (
            format!("{good}options.r = [1, 1e4]\n"),
            "4:17",
            "a number from 0.001 to 1000",
        ),
        (
            format!("{good}methods = [\"hybrid\"]\noptions.first = [5, 2.5]\n"),
            "5:21",
            "a whole number from 1 to 10000",
        ),
        (
            format!("{good}options.monolithic = [0, 2]\n"),
            "4:26",
            "a whole number from 0 to 1",
        ),
        (
            format!("{good}options.first = {{ from = 1, to = 10, per_decade = 2 }}\n"),
            "4:17",
            "3.162e0 is not allowed",
        ),
        (
            format!("{good}options.r = {{ from = 1, to = 0.1 }}\n"),
            "4:30",
            "out of range",
        ),
        (
            format!("{good}options.r = {{ from = 0, to = 1 }}\n"),
            "4:22",
            "out of range",
        ),
        (
            format!("{good}options.r = {{ from = 1 }}\n"),
            "4:13",
            "missing `to`",
        ),
        (
            good.replace("[[cells]]", "repeats = { least = 0 }\n[[cells]]"),
            "2:21",
            "out of range",
        ),
        (good.replace("title", "title = "), "1:", "not valid TOML"),
    ] {
        fs::write(&file, &text).unwrap();
        let out = folder.path().join("out");
        let output = study(&file, &out, &[])
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}\n{error}");
        assert!(
            error.contains(&format!("sweep.toml:{place}")) || place.is_empty(),
            "{text}\n{error}"
        );
        assert!(error.contains(part), "{text}\n{error}");
        assert!(!out.exists(), "{text}");
    }
}

/// Methods and options of the cells of a sweep of one case at one tolerance.
fn listed(folder: &Path, block: &str) -> Vec<String> {
    let file = folder.join("options.toml");
    let text =
        format!("title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\ntolerances = [1e-6]\n{block}\n");
    fs::write(&file, text).unwrap();
    let output = study(&file, &folder.join("none"), &["--list"])
        .stdout(Stdio::piped())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{block}");
    let ids = String::from_utf8(output.stdout).unwrap();
    let mut found: Vec<String> = (ids.lines())
        .map(|id| {
            let (_, method) = id.split_once(".mu-0.3.").unwrap();
            method.split_once(".tol-").unwrap().0.to_owned()
        })
        .collect();
    found.sort();
    found
}

/// Goal: an option is an axis; ids name the value as on the command line, and the default is the plain method.
#[test]
fn options_of_methods_are_axes_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |block: &str| listed(folder.path(), block);
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

/// Goal: both axes stand in ids; without them a cell has the id that it always had.
#[test]
fn increments_and_starts_are_axes_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |block: &str| listed(folder.path(), &format!("methods = [\"pdas\"]\n{block}"));
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
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (folder.path().join("sweep.toml"), folder.path().join("out"));
    let text = "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\nmethods = [\"nsgs\", \"penalty\"]\n\
                increments = [1, 2]\nstart = [\"warm\", \"cold\"]\ntolerances = [1e-6]\n";
    fs::write(&file, text).unwrap();
    assert_eq!(code(study(&file, &out, &["--untimed"])), 0);
    let records = found(&out);
    assert_eq!(records.len(), 8);
    for record in records.values() {
        let (cell, found) = (&record.cell, &record.found);
        assert_eq!(
            found.increments.len(),
            1 + 16 * cell.increments,
            "{}",
            record.id
        );
        assert!(found.verdict.is_honest(), "{}", record.id);
        // Of the converged solution in the same increments: soft springs are off by their modelling error, from either start.
        let error = found.solver_error.as_ref().unwrap().energy;
        assert!(error < 1e-2, "{}: {error:e}", record.id);
        let warm = |o: &&Record| {
            !o.cell.cold && (&o.cell.method, o.cell.increments) == (&cell.method, cell.increments)
        };
        let twin = records.values().find(warm).unwrap();
        let other = twin.found.solver_error.as_ref().unwrap().energy;
        assert!(
            (error - other).abs() < 1e-5,
            "{}: {error:e} {other:e}",
            record.id
        );
        if cell.cold && cell.method == "nsgs" {
            let [cold, warm] = [found, &twin.found].map(|f| f.sum(|i| i.iterations));
            assert!(cold > warm, "{}: {cold} {warm}", record.id);
        }
    }
    let table = fs::read_to_string(out.join("starts.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 4, "{table}");
    assert!(
        rows[1].starts_with("cyclic,nsgs,1e-6,2,33,1,1,1,"),
        "{table}"
    );
}
