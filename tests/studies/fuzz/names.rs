//! Names of files and titles, which anybody chooses, command neither terminal nor spreadsheet, and lead out of no folder.

use std::fs;
use std::path::Path;

use stickslip::studies::sweep::store::sealed;

use super::folder;
use crate::common::{ends_with, files, stickslip};

const SWEEP: &str = "title = \"t\"\nrepeats = { least = 1, most = 2, seconds = 0.0 }\n[[cells]]\ncases = [CASE]\n\
                     refine = [1]\nfriction = [0.1]\nmethods = [\"b-newton\"]\ntolerances = [1e-6]\n";

/// Demands that no output holds an escape and no table a formula.
fn assert_harmless(dir: &Path, shown: &str) {
    assert!(!shown.contains('\u{1b}'), "{shown:?}");
    for (name, bytes) in files(dir) {
        assert!(!name.contains(['\u{1b}', '\u{202e}']), "{name:?}");
        if name.ends_with(".hdf5") {
            continue; // Not for terminals.
        }
        let text = String::from_utf8_lossy(&bytes);
        assert!(!text.contains(['\u{1b}', '\u{202e}']), "{name}");
        let formula =
            |line: &str| line.starts_with(['=', '@']) || line.contains(",=") || line.contains(",@");
        assert!(
            !name.ends_with(".csv") || !text.lines().any(formula),
            "{name}: {text}"
        );
    }
}

/// File names that are commands elsewhere.
#[cfg(unix)]
const HOSTILE: [&str; 5] = [
    "=1+1",
    "a\u{1b}[31mb",
    "@SUM(A1)",
    "a\u{202e}b",
    "..\\..\\x",
];

#[cfg(unix)]
#[test]
fn names_of_cases_stay_names_in_studies_and_exports() {
    for name in HOSTILE {
        let dir = tempfile::tempdir().unwrap();
        let case = fs::read(folder("cases/plate_mesh1.toml")).unwrap();
        let file = format!("{name}.toml");
        fs::write(dir.path().join(&file), case).unwrap();
        let listed = format!("{:?}", file)
            .replace("\\u{1b}", "\\u001b")
            .replace("\\u{202e}", "\\u202e");
        fs::write(
            dir.path().join("sweep.toml"),
            SWEEP.replace("CASE", &listed),
        )
        .unwrap();
        let (shown, complaints) =
            ends_with(0, &["study", "sweep.toml", "--out", "out"], dir.path());
        assert_harmless(&dir.path().join("out"), &(shown + &complaints));
        let export = ["export", &file, "--out", "problems", "--friction", "0.1"];
        let (shown, complaints) = ends_with(0, &export, dir.path());
        assert_harmless(&dir.path().join("problems"), &(shown + &complaints));
        let mut left: Vec<String> = fs::read_dir(dir.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        left.retain(|own| *own != file);
        left.sort();
        assert_eq!(
            left,
            ["out", "problems", "sweep.toml"],
            "{name:?} left the folder"
        );
    }
}

#[cfg(unix)]
#[test]
fn names_of_problem_files_stay_names() {
    for name in HOSTILE {
        let dir = tempfile::tempdir().unwrap();
        let file = format!("{name}.hdf5");
        fs::copy(
            folder("tests/data/fclib/local_csr.hdf5"),
            dir.path().join(&file),
        )
        .unwrap();
        let solve = ["solve", &file, "-m", "b-newton", "--out", "out"];
        let (_, shown, complaints) = stickslip(&solve, dir.path());
        assert_harmless(&dir.path().join("out"), &(shown + &complaints));
    }
}

/// Goal: a path as the name of a case is the file at it, named by its last part, or an error; nothing is written beside.
#[test]
fn a_path_as_the_name_of_a_case_writes_nowhere_else() {
    let dir = tempfile::tempdir().unwrap();
    let inner = dir.path().join("inner");
    fs::create_dir(&inner).unwrap();
    fs::copy(folder("cases/cyclic.toml"), dir.path().join("outer.toml")).unwrap();
    let run = [
        "run",
        "../outer.toml",
        "--method",
        "b-newton",
        "--out",
        "out",
    ];
    let (shown, _) = ends_with(0, &run, &inner);
    assert!(!shown.contains(".."), "{shown}");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    assert_eq!(fs::read_dir(&inner).unwrap().count(), 1);
    for name in [
        "../cyclic",
        "cases/../../cyclic",
        "/etc/passwd",
        "..",
        "",
        "~/x",
        "cyclic/",
        "cyclic\0",
    ] {
        if name.contains('\0') {
            continue; // No program can be given one.
        }
        let (_, complaints) = ends_with(2, &["run", name, "--out", "refused"], &inner);
        assert!(complaints.starts_with("error: "), "{complaints}");
        assert!(complaints.lines().count() <= 3, "{complaints}");
    }
    for name in ["../cyclic", "/etc/passwd", "..", ""] {
        fs::write(
            inner.join("sweep.toml"),
            SWEEP.replace("CASE", &format!("{name:?}")),
        )
        .unwrap();
        let study = ["study", "sweep.toml", "--out", "refused"];
        let (_, complaints) = ends_with(2, &study, &inner);
        assert!(
            complaints.starts_with("error: sweep.toml:4:10: "),
            "{complaints}"
        );
    }
    assert!(!inner.join("refused").exists());
}

/// Goal: who seals what he made up gets no further than who writes a sweep file.
#[test]
fn texts_made_up_in_records_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(
        dir.path().join("sweep.toml"),
        SWEEP.replace("CASE", "\"plate_mesh1\""),
    )
    .unwrap();
    ends_with(0, &["study", "sweep.toml", "--out", "out"], dir.path());
    let list = dir.path().join("out/sweep.json");
    let cells = dir.path().join("out/cells");
    let cell = fs::read_dir(&cells)
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let id = cell.file_stem().unwrap().to_str().unwrap();
    let title = ("\"title\": \"t\"", "title of a sweep");
    for (file, (from, what), to) in [
        (&list, title, "\"title\": \"=1+1\""),
        (
            &list,
            ("\"title\": \"t\"", "visible text"),
            "\"title\": \"a\\u001b[31mb\"",
        ),
        (&list, (id, "id of a cell"), "../../../etc/x"),
        (&list, (id, "id of a cell"), &"x".repeat(400)),
        (
            &cell,
            ("\"machine\": \"", "visible text"),
            "\"machine\": \"\\u001b[31m",
        ),
        (
            &cell,
            ("\"method\": \"b-newton\",\n    \"exact\"", "visible text"),
            "\"method\": \"\\u202e\",\n    \"exact\"",
        ),
    ] {
        let text = fs::read_to_string(file).unwrap();
        assert!(text.contains(from), "{from} in {text}");
        fs::write(file, sealed(&text.replace(from, to))).unwrap();
        let merge = ["merge", "out", "--out", "merged"];
        let (shown, complaints) = ends_with(2, &merge, dir.path());
        assert!(complaints.contains(what), "{complaints}");
        assert!(complaints.chars().count() < 500, "{complaints}");
        assert_harmless(&dir.path().join("none"), &(shown + &complaints));
        fs::write(file, text).unwrap();
    }
    ends_with(0, &["merge", "out", "--out", "merged"], dir.path());
}

/// Goal: who names files at length learns so before hours of computing, not when the results are to be written.
#[test]
fn names_too_long_for_files_of_results_are_refused_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let name = "x".repeat(121);
    fs::copy(
        folder("cases/cyclic.toml"),
        dir.path().join(format!("{name}.toml")),
    )
    .unwrap();
    let (_, complaints) = ends_with(2, &["run", &format!("{name}.toml")], dir.path());
    assert!(
        complaints.contains(".toml:1:1: file name too long"),
        "{complaints}"
    );
    let file = format!("{}.hdf5", "x".repeat(201));
    fs::copy(
        folder("tests/data/fclib/local_csr.hdf5"),
        dir.path().join(&file),
    )
    .unwrap();
    let (_, complaints) = ends_with(2, &["solve", &file], dir.path());
    assert!(
        complaints.contains("its name has 201 bytes"),
        "{complaints}"
    );
    // The longest that are taken are written.
    let name = "x".repeat(120);
    fs::copy(
        folder("cases/plate_mesh1.toml"),
        dir.path().join(format!("{name}.toml")),
    )
    .unwrap();
    let file = format!("{name}.toml");
    let run = [
        "run",
        &file,
        "-m",
        "penalty:normal=1.2345e2,tangential=1.2345e2",
    ];
    ends_with(0, &run, dir.path());
}
