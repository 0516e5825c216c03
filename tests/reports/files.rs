//! The files of a command appear as a whole or not at all.

use crate::report_data::results;
use std::fs;
use std::path::Path;
use stickslip::files::bundle::FolderError;
use stickslip::report::{Bundle, Claim, Plan, Provenance, plan, standard};

/// Writes the tables, all or none.
fn write_tables(dir: &Path) -> Result<(), FolderError> {
    let mut bundle = Bundle::new();
    standard::add_tables(&mut bundle, &results()).expect("tables");
    Claim::new(dir, plan("run"), false)?.commit(&bundle)
}

/// Writes files whose contents are their names, for the plan of a command; for `""` for none.
fn write(dir: &Path, own: &str, names: &[&str], force: bool) -> Result<(), FolderError> {
    let mut bundle = Bundle::new();
    for name in names {
        bundle.add(*name, *name)?;
    }
    let plan = if own.is_empty() {
        Plan::new()
    } else {
        plan(own)
    };
    Claim::new(dir, plan, force)?.commit(&bundle)
}

/// That something is refused, with the words for it.
fn refused(found: Result<(), FolderError>, words: &[&str]) {
    let error = found.expect_err("refused").to_string();
    let all = words.iter().all(|word| error.contains(word));
    assert!(all, "{words:?}: {error}");
}

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn one_command_writes_all_kinds_and_twice_the_same() {
    let (first, second) = (temporary(), temporary());
    for dir in [&first, &second] {
        let bundle = standard::bundle(&results(), &Provenance::collect(2)).expect("a bundle");
        let claim = Claim::new(dir.path(), plan("run"), false).expect("a folder");
        claim.commit(&bundle).expect("written");
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
    assert_eq!([of(".state.svg"), of(".vtu"), of(".pvd")], [1, 4, 1]);
    assert_eq!(of(".loop.svg"), 0, "one increment");
    assert_eq!(
        [of(".csv"), of(".md"), of(".tex"), of("provenance.toml")],
        [6, 2, 1, 1]
    );
}

#[test]
fn folders_that_cannot_be_written_are_named_before_anything_is_computed() {
    let dir = temporary();
    let file = dir.path().join("file");
    fs::write(&file, "in the way").expect("a file");
    for target in [file.clone(), file.join("below")] {
        refused(write_tables(&target), &[&target.display().to_string()]);
    }
    assert_eq!(fs::read_to_string(&file).expect("the file"), "in the way");
    let fresh = dir.path().join("a/b");
    drop(Claim::new(&fresh, plan("run"), false).expect("a new folder"));
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

/// Goal: only what the own list says was written is replaced or removed.
#[test]
fn files_of_others_are_neither_replaced_nor_removed() {
    let dir = temporary();
    let put = |name: &str| fs::write(dir.path().join(name), "mine").expect("a file");
    write(dir.path(), "run", &["a.csv", "figures/a.svg"], false).expect("written");
    put("b.csv");
    put("figures/mine.pdf");
    let before = contents(dir.path());
    let refuse = |names: &[&str], words: &[&str]| {
        refused(write(dir.path(), "run", names, false), words);
        assert_eq!(contents(dir.path()), before, "{names:?}");
    };
    refuse(&["0.csv", "b.csv"], &["b.csv", "not written by this"]);
    refuse(&["0.csv", "figures"], &["figures", "a folder stands"]);
    refuse(&["0.csv", "b.csv/c"], &["b.csv", "a file stands"]);
    // Of another plan all that is listed goes, and nothing else.
    let other = ["b.svg"];
    refused(
        write(dir.path(), "solve", &other, false),
        &["`run`", "`solve`", "--out", "--force"],
    );
    assert_eq!(contents(dir.path()), before);
    write(dir.path(), "solve", &other, true).expect("forced");
    let left = ["b.csv", "b.svg", "figures/mine.pdf", "written.toml"];
    assert_eq!(files_below(dir.path()), left);
    fs::write(dir.path().join("written.toml"), "mine").expect("a file");
    refused(write(dir.path(), "solve", &other, true), &["written.toml"]);
    fs::write(
        dir.path().join("written.toml"),
        "plan = {}\nfiles = [\"../up\"]",
    )
    .expect("a file");
    refused(write(dir.path(), "solve", &other, true), &["written.toml"]);
}

/// Goal: files of no plan stay when a plan writes beside them, and are replaced by their own kind, or by a plan that has
/// them too.
#[test]
fn files_of_no_plan_stand_beside_those_of_any() {
    let dir = temporary();
    let put = |own, names: &[&str]| write(dir.path(), own, names, false).expect("written");
    put("", &["case.toml", "index.html"]);
    put("stress", &["a.csv", "index.html"]);
    put("", &["index.html", "other.toml"]);
    put("stress", &["b.csv"]);
    let left = [
        "b.csv",
        "case.toml",
        "index.html",
        "other.toml",
        "written.toml",
    ];
    assert_eq!(files_below(dir.path()), left);
}

/// Goal: what a run that ended half-way has written is its own: the next one completes it, and leaves no trace of it.
#[test]
fn what_a_killed_run_had_begun_is_completed() {
    let dir = temporary();
    write(dir.path(), "run", &["a.csv", "b.csv"], false).expect("written");
    fs::write(dir.path().join("mine"), "mine").expect("a file");
    // The last file cannot be written under its first name.
    let taken = format!("z.csv.partial-{}", std::process::id());
    fs::create_dir(dir.path().join(&taken)).expect("a folder");
    let names = ["a.csv", "c.csv", "z.csv"];
    refused(write(dir.path(), "run", &names, false), &["write file"]);
    fs::remove_dir(dir.path().join(taken)).expect("removed");
    let half = ["a.csv", "b.csv", "c.csv", "mine", "written.toml"];
    assert_eq!(files_below(dir.path()), half);
    write(dir.path(), "run", &["c.csv", "d.csv"], false).expect("the next run");
    let left = ["c.csv", "d.csv", "mine", "written.toml"];
    assert_eq!(files_below(dir.path()), left);
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

/// Files with what is in them.
fn contents(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let read = |name: String| (name.clone(), fs::read(dir.join(&name)).expect("a file"));
    files_below(dir).into_iter().map(read).collect()
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
