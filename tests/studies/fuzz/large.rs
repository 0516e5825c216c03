//! Files as large as readers take them, made to cost more than their size: every one is read or refused within two seconds.

use std::path::Path;
use std::time::{Duration, Instant};

use hdf5_pure::FileBuilder;
use stickslip::case;
use stickslip::files::interchange::{Problem, fclib};
use stickslip::studies::sweep::plan::Outline;

/// Bytes of a large text, a little below what is read at all.
const LARGE: usize = 1_000_000;

const PLANE: &str =
    "title = \"t\"\nmodel = \"plane-strain\"\nmaterial = { young_pa = 1, poisson = 0.3 }\n";
const BOX: &str = "mesh = { box = { min_m = [0, 0], max_m = [1, 1], cells = [2, 2] } }\n";

/// Demands an end within two seconds; optimised code is what is meant.
fn quick<T>(what: &str, read: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let found = read();
    let elapsed = start.elapsed();
    let most = if cfg!(debug_assertions) { 20 } else { 2 };
    println!("{what}: {:.3} s", elapsed.as_secs_f64());
    assert!(elapsed < Duration::from_secs(most), "{what}: {elapsed:?}");
    found
}

/// As many repetitions as make a large text; `#` stands for a number that differs every time.
fn many(unit: &str) -> String {
    let numbered = |k: usize| unit.replace('#', &k.to_string());
    let count = LARGE / (unit.len() + 5);
    (1..=count).map(numbered).collect()
}

#[test]
fn long_lists_cost_no_more_than_their_length() {
    let dir = tempfile::tempdir().unwrap();
    let distinct = |unit: &str| format!("[{}]", many(unit));
    for (what, text) in [
        (
            "frictions",
            format!("{PLANE}{BOX}sweep = {{ friction = {} }}\n", distinct("#, ")),
        ),
        (
            "grid lines",
            format!(
                "{PLANE}mesh = {{ lines_m = [{}, [0, 1]] }}\n",
                distinct("#, ")
            ),
        ),
        (
            "probes",
            format!(
                "{PLANE}{BOX}{}",
                many("[[probe]]\nname = \"p#\"\npoint_m = [0, 0]\n")
            ),
        ),
        (
            "equal probes",
            format!(
                "{PLANE}{BOX}{}",
                many("[[probe]]\nname = \"p#\"\npoint_m = [0, 0]\n") + "[[probe]]\nname = \"p1\"\n"
            ),
        ),
        (
            "cracks",
            format!(
                "{PLANE}{BOX}{}",
                many("[[crack]]\npoints_m = [[0, 0], [1, #]]\nfriction = 0.#\n")
            ),
        ),
        (
            "points",
            format!(
                "{PLANE}{BOX}[[crack]]\nfriction = 0.1\npoints_m = {}\n",
                distinct("[#, 1], ")
            ),
        ),
        (
            "history",
            format!(
                "{PLANE}{BOX}[[load]]\nbody_n_per_m3 = [0, 1]\nhistory = {}\n",
                distinct("[#, 1], ")
            ),
        ),
        (
            "methods",
            format!("{PLANE}{BOX}{}", many("[[method]]\nname = \"m\"\n")),
        ),
        (
            "options",
            format!("{PLANE}{BOX}[[method]]\nname = \"m\"\n{}", many("o# = 1\n")),
        ),
        ("unknown keys", format!("{PLANE}{BOX}{}", many("k# = 1\n"))),
        (
            "unknown tables",
            format!("{PLANE}{BOX}{}", many("[t#.a.b.c]\n")),
        ),
        (
            "expectations",
            format!(
                "{PLANE}{BOX}{}",
                many(
                    "[[expect]]\nquantity = \"q\"\nvalue = #\nunit = \"m\"\nrelative = 1e-3\nkind = \"analytic\"\nsource = \"s\"\n"
                )
            ),
        ),
        (
            "a condition",
            format!(
                "{PLANE}{BOX}[[load]]\non = \"top\"\npressure_pa = 1\nwhere = \"x > 0{}\"\n",
                many(" and x > #")
            ),
        ),
        (
            "one comment",
            format!("#{}\n{PLANE}{BOX}", "x".repeat(LARGE)),
        ),
        (
            "blank lines",
            format!("{}{PLANE}{BOX}x = 1\n", "\n".repeat(LARGE)),
        ),
        (
            "all cells",
            format!("{PLANE}{}", BOX.replace("[2, 2]", "[20000000, 1]")),
        ),
        (
            "more cells",
            format!("{PLANE}{}", BOX.replace("[2, 2]", "[20000000, 2]")),
        ),
    ] {
        let found = quick(what, || case::parse("large.toml", text.as_str()));
        if let Err(error) = found {
            let message = error.to_string();
            assert!(message.starts_with("large.toml:"), "{what}: {message}");
            assert!(message.chars().count() < 1500, "{what}: {message}");
        }
    }
    let several = |unit: &str| {
        let numbered = |k: usize| unit.replace('#', &k.to_string());
        format!(
            "[{}]",
            (0..1000).map(numbered).collect::<Vec<_>>().join(", ")
        )
    };
    let file = dir.path().join("sweep.toml");
    let cells = "title = \"t\"\n[[cells]]\n";
    let one = "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\n";
    for (what, text, part) in [
        (
            "cases",
            format!("{cells}cases = {}\n", distinct("\"cyclic\", ")),
            "at most 1000 cases",
        ),
        (
            "paths",
            format!("{cells}cases = {}\n", distinct("\"#.toml\", ")),
            "at most 1000 cases",
        ),
        (
            "blocks",
            format!(
                "title = \"t\"\n{}",
                many("[[cells]]\ncases = [\"cyclic\"]\n")
            ),
            "at most 1000 cases",
        ),
        (
            "cells",
            format!("{one}friction = {}\n", distinct("#, ")),
            "at most 100000 cells",
        ),
        (
            "products",
            format!(
                "{one}friction = {}\ntolerances = {}\n",
                several("#"),
                several("1e-3")
            ),
            "at most 100000 cells",
        ),
        (
            "random problems",
            format!("{cells}random = {{ dimension = 3, problems = 1000000 }}\n"),
            "integers from 1 to 10000",
        ),
        (
            "random cells",
            format!(
                "{cells}random = {{ dimension = 3, problems = 10000 }}\nfriction = [0.1, 0.2]\n"
            ),
            "at most 100000 cells",
        ),
    ] {
        let error = match quick(what, || Outline::parse(&file, &text)) {
            Ok(_) => panic!("{what}: accepted"),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(part), "{what}: {error}");
        assert!(
            error.starts_with(&format!("{}:", file.display())),
            "{error}"
        );
    }
}

#[test]
fn a_header_that_claims_a_trillion_entries_is_refused_before_it_is_believed() {
    // Every place that holds the length of a dataset, put right or wrong: sizes lie aligned in its headers.
    let shipped = std::fs::read(super::folder("tests/data/fclib/local_csr.hdf5")).unwrap();
    for at in (0..shipped.len() - 8).step_by(8) {
        let mut bytes = shipped.clone();
        bytes[at..at + 8].copy_from_slice(&1_000_000_000_000_u64.to_le_bytes());
        let _ = quick("FCLIB", || fclib::from_bytes(Path::new("a.hdf5"), bytes));
    }
}

/// A local problem without friction at `points` points in the plane, with W the identity.
fn local(points: usize, guesses: i32) -> Vec<u8> {
    let m = 2 * points;
    let mut file = FileBuilder::new();
    let mut root = file.create_group("fclib_local");
    root.create_dataset("spacedim").with_i32_data(&[2]);
    let mut w = root.create_group("W");
    let index: Vec<i32> = (0..m as i32).collect();
    for name in ["m", "n", "nz", "nzmax"] {
        w.create_dataset(name).with_i32_data(&[m as i32]);
    }
    w.create_dataset("p").with_i32_data(&index);
    w.create_dataset("i").with_i32_data(&index);
    w.create_dataset("x").with_f64_data(&vec![1.0; m]);
    root.add_group(w.finish());
    let mut vectors = root.create_group("vectors");
    vectors.create_dataset("q").with_f64_data(&vec![1.0; m]);
    vectors
        .create_dataset("mu")
        .with_f64_data(&vec![0.0; points]);
    root.add_group(vectors.finish());
    file.add_group(root.finish());
    let mut group = file.create_group("guesses");
    group
        .create_dataset("number_of_guesses")
        .with_i32_data(&[guesses]);
    let mut guess = group.create_group("1");
    for name in ["u", "r"] {
        guess.create_dataset(name).with_f64_data(&vec![0.0; m]);
    }
    group.add_group(guess.finish());
    file.add_group(group.finish());
    file.finish().unwrap()
}

#[test]
fn guesses_that_are_not_there_cost_nothing() {
    let read = |bytes| quick("guesses", || fclib::from_bytes(Path::new("a.hdf5"), bytes));
    assert!(read(local(3, 1)).is_ok());
    let Problem::Local(problem) = read(local(3, i32::MAX)).unwrap() else {
        panic!("a local problem");
    };
    assert_eq!(problem.guesses.len(), 1);
    assert!(read(local(20_000, 1)).is_ok());
}
