//! The files of a command appear as a whole or not at all.

use crate::report_data::results;
use std::fs;
use std::path::Path;
use stickslip::files::bundle::FolderError;
use stickslip::report::{Bundle, Provenance, ReportError, prepare_output, standard};

/// Writes the tables, all or none.
fn write_tables(dir: &Path) -> Result<(), ReportError> {
    let mut bundle = Bundle::new();
    standard::add_tables(&mut bundle, &results())?;
    Ok(bundle.commit(dir)?)
}

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn one_command_writes_all_kinds_and_twice_the_same() {
    let (first, second) = (temporary(), temporary());
    for dir in [&first, &second] {
        standard::write(dir.path(), &results(), &Provenance::collect(2)).expect("written");
    }
    let files = files_below(first.path());
    assert_eq!(files, files_below(second.path()));
    for file in &files {
        let read = |dir: &tempfile::TempDir| fs::read(dir.path().join(file)).expect("a file");
        assert_eq!(read(&first), read(&second), "{file}");
    }
    let of = |end: &str| files.iter().filter(|file| file.ends_with(end)).count();
    // Three friction values with all methods, and all friction values by the first exact method.
    assert_eq!([of(".residual.svg"), of(".profile.svg")], [3, 4]);
    let sweep = "figures/plate_mesh1.22x22.edge-pairs.b-newton.crack-1.profile.svg".to_owned();
    assert!(files.contains(&sweep), "{files:?}");
    assert_eq!([of(".displacement.svg"), of(".vtu"), of(".pvd")], [1, 4, 1]);
    assert_eq!(
        [of(".von-mises.svg"), of(".contact.svg"), of(".loop.svg")],
        [1, 0, 0],
        "a plane body in one increment"
    );
    assert_eq!(
        [of(".csv"), of(".md"), of(".tex"), of("provenance.toml")],
        [7, 1, 1, 1]
    );
}

#[test]
fn folders_that_cannot_be_written_are_named_before_anything_is_computed() {
    let dir = temporary();
    let file = dir.path().join("file");
    fs::write(&file, "in the way").expect("a file");
    for target in [file.clone(), file.join("below")] {
        let error = prepare_output(&target).expect_err("a file is no folder");
        assert!(
            error.to_string().contains(&target.display().to_string()),
            "{error}"
        );
        let error = write_tables(&target).expect_err("a file is no folder");
        assert!(
            matches!(error, ReportError::Folder(FolderError::Io { .. })),
            "{error}"
        );
    }
    assert_eq!(fs::read_to_string(&file).expect("the file"), "in the way");
    let fresh = dir.path().join("a/b");
    drop(prepare_output(&fresh).expect("a new folder"));
    let names: Vec<_> = fs::read_dir(dir.path())
        .expect("a folder")
        .flatten()
        .map(|e| e.file_name())
        .collect();
    assert_eq!(
        names,
        ["file"],
        "nothing is left of the probe, not even the new folder"
    );
}

#[test]
fn a_failure_leaves_the_folder_as_it_was() {
    let dir = temporary();
    fs::write(dir.path().join("history.csv"), "old").expect("an old file");
    // The last of the five names is taken by a folder, the write fails after others were put in place.
    fs::create_dir_all(dir.path().join("runs.csv/inside")).expect("a folder in the way");
    let before = files_below(dir.path());
    let error = write_tables(dir.path()).expect_err("runs.csv is a folder");
    assert!(error.to_string().contains("runs.csv"), "{error}");
    assert_eq!(files_below(dir.path()), before);
    assert_eq!(
        fs::read_to_string(dir.path().join("history.csv")).expect("the file"),
        "old"
    );
    assert!(
        !dir.path().join("points.csv").exists(),
        "half the files would be a lie"
    );
}

#[test]
fn success_replaces_old_files_and_leaves_no_traces() {
    let dir = temporary();
    fs::write(dir.path().join("runs.csv"), "old").expect("an old file");
    fs::write(dir.path().join("mine.txt"), "mine").expect("another file");
    write_tables(dir.path()).expect("written");
    let names = files_below(dir.path());
    let expected = [
        "exact.csv",
        "expectations.csv",
        "expectations_by_case.csv",
        "expectations_by_case.md",
        "expectations_by_case.tex",
        "history.csv",
        "mine.txt",
        "points.csv",
        "quantities.csv",
        "runs.csv",
    ];
    assert_eq!(names, expected);
    assert!(
        fs::read_to_string(dir.path().join("runs.csv"))
            .expect("a file")
            .starts_with("case,mesh,")
    );
}

#[test]
fn bundles_refuse_names_outside_and_names_taken() {
    let mut bundle = Bundle::new();
    for path in ["../up.csv", "/etc/passwd", "", "a/../../b"] {
        assert!(
            matches!(
                bundle.add(path, "x"),
                Err(FolderError::OutsideFolder { .. })
            ),
            "{path}"
        );
    }
    bundle.add("a.csv", "x").expect("a name");
    assert!(matches!(
        bundle.add("a.csv", "y"),
        Err(FolderError::Duplicate { .. })
    ));
}

fn files_below(dir: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![dir.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path.clone());
            }
            let name = path.strip_prefix(dir).expect("below").display().to_string();
            if path.is_file() {
                found.push(name);
            }
        }
    }
    found.sort();
    found
}
