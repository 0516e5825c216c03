//! The program as its users meet it: verbs, exit codes, files, silence in a pipe.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Output;

use crate::common::*;
use assert_cmd::Command;
use stickslip::case::shipped;
use stickslip::run::registry::methods;

fn stickslip(arguments: &[&str], dir: &Path) -> Output {
    let mut program = Command::cargo_bin("stickslip").unwrap();
    program.args(arguments).current_dir(dir).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A small plate with friction that runs in milliseconds; `expected` reaction in x of the support below.
fn small(expected: f64) -> String {
    let rest = crack([-0.1, 0.5], [1.1, 0.5], 0.3, "none")
        + &support("\"bottom\"", "[0, 0]")
        + &support("\"top\"", "[1e-4, -1e-3]");
    plane([0.0, 0.0], [1.0, 1.0], [3, 3], &rest)
        + &format!(
            "[[expect]]\nquantity = \"points_open\"\nvalue = {expected}\nunit = \"-\"\nabsolute = 0.5\nkind = \"analytic\"\nsource = \"Pushed together\"\n"
        )
}

/// Text of all files below a folder by relative path.
fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path
                    .strip_prefix(dir)
                    .unwrap()
                    .to_string_lossy()
                    .into_owned();
                found.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Columns of runs.csv that hold times.
const TIMES: [&str; 6] = [
    "setup_s",
    "assembly_s",
    "factorisation_s",
    "condensation_s",
    "prepare_s",
    "solve_s",
];

/// A CSV without some of its columns.
fn without(csv_text: &[u8], columns: &[&str]) -> String {
    let mut reader = csv::Reader::from_reader(csv_text);
    let header = reader.headers().unwrap().clone();
    let keep: Vec<usize> = (0..header.len())
        .filter(|&i| !columns.contains(&&header[i]))
        .collect();
    assert_eq!(header.len() - keep.len(), columns.len(), "{header:?}");
    let mut shown = String::new();
    for row in std::iter::once(header).chain(reader.records().map(Result::unwrap)) {
        let cells: Vec<&str> = keep.iter().map(|&i| &row[i]).collect();
        shown += &(cells.join(",") + "\n");
    }
    shown
}

/// `stickslip show methods | head`: the reader leaves after the first lines.
#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["show", "methods"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
}

/// `stickslip run … 2>&- | head`: what nobody can read must not change the exit code.
#[test]
fn an_error_that_nobody_reads_keeps_its_exit_code() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("off.toml"), small(2.0)).unwrap();
    for (arguments, code) in [
        (&["run", "nothing"][..], 2),
        (&["run", "off.toml", "--method", METHOD], 1),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .args(arguments)
            .current_dir(dir.path())
            .stdout(std::process::Stdio::null())
            .stderr(writer)
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn list_and_show_name_every_method_and_case() {
    let dir = tempfile::tempdir().unwrap();
    let list = stickslip(&["list"], dir.path());
    assert_eq!(list.status.code(), Some(0));
    assert!(list.stderr.is_empty());
    let shown = text(&list.stdout);
    for method in methods() {
        assert!(
            shown.contains(method.name) && shown.contains(method.summary),
            "{shown}"
        );
        let one = stickslip(&["show", method.name], dir.path());
        assert_eq!(one.status.code(), Some(0));
        let one = text(&one.stdout);
        assert!(one.contains(method.reference), "{one}");
        for option in method.options {
            assert!(
                one.contains(option.name()) && one.contains(option.help()),
                "{one}"
            );
        }
    }
    for (name, source) in shipped::CASES {
        assert!(shown.contains(name), "{shown}");
        let one = stickslip(&["show", name], dir.path());
        assert_eq!(text(&one.stdout).trim_end(), source.trim_end());
    }
    assert!(files(dir.path()).is_empty());
}

#[test]
fn help_and_version_end_with_0_and_bad_usage_with_2() {
    let dir = tempfile::tempdir().unwrap();
    for good in [&["--help"][..], &["--version"], &["run", "--help"]] {
        let output = stickslip(good, dir.path());
        assert_eq!(output.status.code(), Some(0), "{good:?}");
        assert!(!output.stdout.is_empty());
    }
    for bad in [
        &["run"][..],
        &["show"],
        &["check"],
        &["fly"],
        &["run", "cyclic", "--tier", "perfect"],
        &["run", "cyclic", "--jobs", "0"],
        &["run", "cyclic", "--jobs", "-1"],
        &["run", "cyclic", "--speed", "9"],
    ] {
        let output = stickslip(bad, dir.path());
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(
            !output.stderr.is_empty() && output.stdout.is_empty(),
            "{bad:?}"
        );
    }
    assert!(files(dir.path()).is_empty());
}

#[test]
fn check_accepts_every_shipped_case_and_says_its_size() {
    let dir = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    for (name, source) in shipped::CASES {
        // The large meshes of the sweeps belong to `run`.
        if !source.contains("refine") && !source.contains("solid") {
            let file = format!("{name}.toml");
            std::fs::write(dir.path().join(&file), source).unwrap();
            names.push(file);
        }
    }
    assert!(names.len() >= 4);
    let arguments: Vec<&str> = std::iter::once("check")
        .chain(names.iter().map(String::as_str))
        .collect();
    let output = stickslip(&arguments, dir.path());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    for (line, name) in text(&output.stdout).lines().zip(&names) {
        assert!(line.starts_with(name.as_str()), "{line}");
        assert!(
            line.contains("cells") && line.contains("unknowns") && line.contains("contact points")
        );
    }
    assert_eq!(files(dir.path()).len(), names.len());
}

#[test]
fn run_writes_its_tables_shows_them_and_is_silent_on_standard_error() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), small(0.0)).unwrap();
    let output = stickslip(&["run", "small.toml", "--out", "out"], dir.path());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    assert!(
        !shown.contains('\u{1b}'),
        "colours or cursor movements in a pipe"
    );
    let written = files(&dir.path().join("out"));
    for name in [
        "runs.csv",
        "quantities.csv",
        "history.csv",
        "points.csv",
        "expectations.csv",
        "provenance.toml",
    ] {
        assert!(
            written.contains_key(name),
            "{name} missing in {:?}",
            written.keys()
        );
    }
    assert!(written.keys().any(|k| k.ends_with(".vtu")));
    for method in methods() {
        assert!(shown.contains(method.name), "{shown}");
        assert!(text(&written["runs.csv"]).contains(method.name));
    }
    // Nothing is left beside the folder asked for.
    let mut beside: Vec<String> = std::fs::read_dir(dir.path())
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    beside.sort();
    assert_eq!(beside, ["out", "small.toml"]);
}

#[test]
fn a_missed_expectation_ends_with_1_and_is_named() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), small(3.0)).unwrap();
    let output = stickslip(
        &["run", "small.toml", "--method", "b-newton", "--out", "out"],
        dir.path(),
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("missed"));
    assert!(text(&files(&dir.path().join("out"))["expectations.csv"]).contains("missed"));
}

#[test]
fn unknown_names_and_bad_options_end_with_2_and_write_nothing() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), small(0.0)).unwrap();
    for (arguments, words) in [
        (&["run", "plate_mesh9"][..], "unknown case `plate_mesh9`"),
        (&["run", "nowhere.toml"], "nowhere.toml"),
        (&["run", "."], "director"),
        (
            &["run", "small.toml", "-m", "newton"],
            "unknown method `newton`",
        ),
        (&["run", "small.toml", "-m", "penalty:stiff=3"], "stiff"),
        (&["run", "small.toml", "-m", "penalty:normal=-1"], "normal"),
        (&["run", "small.toml", "-m", "penalty:normal=nan"], "normal"),
        (
            &["run", "small.toml", "-m", "penalty:normal=big"],
            "not key=value",
        ),
        (
            &["run", "small.toml", "-m", "penalty:normal"],
            "not key=value",
        ),
        (
            &["run", "small.toml", "-m", "penalty:normal=1,normal=2"],
            "normal",
        ),
        (&["show", "nothing"], "unknown method or case"),
        (&["check", "nowhere.toml"], "nowhere.toml"),
    ] {
        let output = stickslip(arguments, dir.path());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let shown = text(&output.stderr);
        assert!(
            shown.starts_with("error: ") && shown.contains(words),
            "{arguments:?}: {shown}"
        );
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert_eq!(files(dir.path()).len(), 1, "{arguments:?} wrote something");
        assert!(
            !dir.path().join("results").exists(),
            "{arguments:?} left a folder"
        );
    }
}

#[test]
fn a_method_with_options_is_labelled_by_them_and_its_answer_changes() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), small(0.0)).unwrap();
    let arguments = [
        "run",
        "small.toml",
        "--method",
        "penalty:normal=1e2",
        "-m",
        "penalty",
        "--tier",
        "low",
        "--out",
        "out",
    ];
    let output = stickslip(&arguments, dir.path());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let written = files(&dir.path().join("out"));
    let runs = text(&written["runs.csv"]);
    assert!(
        runs.contains("penalty[normal=1e2]")
            && runs.contains(",penalty,")
            && runs.contains(",low,"),
        "{runs}"
    );
    let mut found = BTreeMap::new();
    let mut reader = csv::Reader::from_reader(written["quantities.csv"].as_slice());
    for row in reader.records().map(Result::unwrap) {
        if row.iter().any(|c| c == "max_penetration") && row.iter().any(|c| c == "crack-1") {
            let header = ["method", "value"].map(|n| {
                let text = text(&written["quantities.csv"]);
                text.lines()
                    .next()
                    .unwrap()
                    .split(',')
                    .position(|c| c == n)
                    .unwrap()
            });
            let value: f64 = row[header[1]].parse().unwrap();
            found.insert(row[header[0]].to_owned(), value);
        }
    }
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found["penalty"] != found["penalty[normal=1e2]"],
        "{found:?}"
    );
}

#[test]
fn a_folder_that_cannot_be_written_ends_with_2_before_anything_runs() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), small(0.0)).unwrap();
    std::fs::write(dir.path().join("taken"), "mine").unwrap();
    for out in ["taken", "taken/below", "/proc/stickslip"] {
        let output = stickslip(&["run", "small.toml", "--out", out], dir.path());
        assert_eq!(output.status.code(), Some(2), "{out}");
        assert!(text(&output.stderr).starts_with("error: "), "{out}");
        assert!(output.stdout.is_empty(), "{out}: ran first");
    }
    let kept = files(dir.path());
    assert_eq!(kept.len(), 2);
    assert_eq!(kept["taken"], b"mine");
}

#[test]
fn the_same_command_twice_writes_the_same_files_but_for_times() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("small.toml"), small(0.0)).unwrap();
    let written = ["one", "two", "jobs"].map(|out| {
        let jobs = if out == "jobs" { "2" } else { "1" };
        let output = stickslip(
            &["run", "small.toml", "cyclic", "--out", out, "--jobs", jobs],
            dir.path(),
        );
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        files(&dir.path().join(out))
    });
    for other in &written[1..] {
        let names = |w: &BTreeMap<String, Vec<u8>>| w.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&written[0]), names(other));
        for (name, content) in &written[0] {
            match name.as_str() {
                "runs.csv" => assert_eq!(without(content, &TIMES), without(&other[name], &TIMES)),
                // Times and the machine.
                "provenance.toml" | "runs.md" | "runs.tex" | "index.html" => {}
                _ => assert!(content == &other[name], "{name} differs"),
            }
        }
    }
}

/// The main job: both tables of the paper on the terminal and in files, every expectation met, the same bytes without a
/// verb as with it.
#[test]
fn paper_shows_and_writes_both_tables_and_is_what_runs_without_a_verb() {
    let dir = tempfile::tempdir().unwrap();
    let named = stickslip(&["paper", "--out", "named"], dir.path());
    assert_eq!(named.status.code(), Some(0), "{}", text(&named.stderr));
    assert!(named.stderr.is_empty(), "{}", text(&named.stderr));
    let shown = text(&named.stdout);
    for printed in ["973.3", "1107.4", "1137.5", "1.782853", "0.5293037"] {
        assert!(shown.contains(printed), "{printed} missing in\n{shown}");
    }
    let plain = stickslip(&[], dir.path());
    assert_eq!(plain.status.code(), Some(0), "{}", text(&plain.stderr));
    let (named, plain) = (
        files(&dir.path().join("named")),
        files(&dir.path().join("results")),
    );
    assert_eq!(
        named.keys().collect::<Vec<_>>(),
        plain.keys().collect::<Vec<_>>()
    );
    let page = text(&named["index.html"]);
    assert!(page.contains("Table 1: vertical reaction") && page.contains("1107.263"));
    for table in ["table1", "table2"] {
        for kind in ["csv", "md", "tex"] {
            let name = format!("{table}.{kind}");
            assert!(named.contains_key(&name), "{name} missing");
            assert!(named[&name] == plain[&name], "{name} differs");
        }
    }
    for name in ["quantities.csv", "history.csv", "points.csv"] {
        assert!(named[name] == plain[name], "{name} differs");
    }
}
