//! Folders of problem files: solved, studied by class, and solved by packings of many redundant points.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::interchange::{shipped_file, vector, verdict};
use super::pipeline::measured;
use crate::common::*;
use stickslip::run::registry::methods;

/// Families of `tests/data/fclib/collection`, in another folder: only the files named are copied.
fn collection(dir: &Path, files: &[&str]) {
    for file in files {
        let to = dir.join("collection").join(file);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(shipped_file("collection").join(file), to).unwrap();
    }
}

type Row = BTreeMap<String, String>;

fn rows(path: &Path) -> Vec<Row> {
    csv_rows(&std::fs::read_to_string(path).unwrap())
}

/// Source: `make_collection.py` says which file is what; rank and asymmetry were found by numpy.
#[test]
fn a_collection_is_solved_or_refused_with_the_reason() {
    let dir = tempfile::tempdir().unwrap();
    let all = shipped_file("collection");
    let methods = ["newton-ac", "nsgs", "interior-point", "socp"];
    let mut arguments = vec!["solve", all.to_str().unwrap(), "--out", "results"];
    arguments.extend(methods.iter().flat_map(|method| ["-m", method]));
    ends_with(0, &arguments, dir.path());

    let problems = rows(&dir.path().join("results/problems.csv"));
    #[rustfmt::skip]
    let expected = [
        ("blocks.column-2d", "36", "18", "420", "", ""),
        ("blocks.column-3d", "36", "18", "880", "", ""),
        ("blocks.column-3d-libfclib", "36", "18", "880", "", ""),
        ("disks.full-2d", "16", "12", "256", "", ""),
        ("disks.packing-2d", "32", "24", "326", "", ""),
        ("rolling.global-2d", "NaN", "NaN", "NaN", "NaN", "rolling-friction problem: group /fclib_global_rolling"),
        ("rolling.local-2d", "NaN", "NaN", "NaN", "NaN", "rolling-friction problem: fclib_local/vectors/mu_r"),
        ("rolling.local-3d", "NaN", "NaN", "NaN", "NaN", "rolling-friction problem: fclib_local/vectors/mu_r"),
        ("rotating.column-3d", "24", "12", "512", "0.0033", ""),
        ("rotating.table-2d", "36", "24", "432", "0.0067", ""),
        ("rotating.table-2d-global", "16", "12", "20", "0.02", ""),
        ("rotating.table-3d", "48", "30", "586", "0.0057", ""),
        ("rotating.table-3d-libfclib", "48", "30", "586", "0.0057", ""),
        ("spheres.packing-3d", "42", "30", "424", "", ""),
        ("spheres.packing-3d-global", "42", "30", "30", "", ""),
    ];
    assert_eq!(problems.len(), expected.len());
    for (found, (name, size, rank, entries, asymmetry, refused)) in problems.iter().zip(expected) {
        assert_eq!(found["problem"], name);
        let sizes = [&found["rows"], &found["rank"], &found["stored_entries"]];
        assert_eq!(sizes, [size, rank, entries], "{name}");
        let reason = found["refused"].starts_with(refused)
            && found["refused"].is_empty() == refused.is_empty();
        assert!(reason, "{name}: {}", found["refused"]);
        match asymmetry {
            // Rounding of the writer.
            "" => assert!(found["asymmetry"].parse::<f64>().unwrap() < 1e-14, "{name}"),
            stated => assert_eq!(found["asymmetry"], stated, "{name}"),
        }
    }
    let solvable = expected.iter().filter(|row| row.5.is_empty());
    let several = ["blocks.column-3d", "spheres.packing-3d"];
    for (name, .., asymmetry, _) in solvable {
        for method in methods {
            let verdict = verdict(dir.path(), name, method);
            match (method, *asymmetry) {
                ("socp", stated) if !stated.is_empty() => {
                    let relative: f64 = stated.parse().unwrap();
                    // Of a global file the table states the asymmetry of M.
                    let by = if name.ends_with("global") {
                        "refused: W is unsymmetric by ".to_owned()
                    } else {
                        format!("refused: W is unsymmetric by {relative:.1e} relative, ")
                    };
                    let needs = verdict.ends_with(" relative, the method needs a symmetric W");
                    assert!(verdict.starts_with(&by) && needs, "{name}: {verdict}");
                }
                // Rigid bodies on each other, with more contact rows than W has rank.
                _ if several.iter().any(|own| name.starts_with(own)) => {
                    assert_eq!(verdict, "solved (several)", "{name} {method}");
                }
                _ => assert_eq!(verdict, "solved", "{name} {method}"),
            }
        }
    }
    // A copy by libfclib is the same problem.
    let solution = |name: &str| {
        let file = format!("results/solutions/rotating.{name}.local.fclib.newton-ac.mu-");
        let path = dir.path().join(file);
        let parent = path.parent().unwrap();
        let start = path.file_name().unwrap().to_str().unwrap().to_owned();
        let found = std::fs::read_dir(parent)
            .unwrap()
            .map(|item| item.unwrap().path());
        let own = |path: &PathBuf| {
            let name = path.file_name().unwrap().to_str().unwrap();
            name.starts_with(&start) && name.ends_with(".r.txt")
        };
        vector(&found.into_iter().find(own).unwrap())
    };
    assert_eq!(solution("table-3d"), solution("table-3d-libfclib"));
    let rates = rows(&dir.path().join("results/success.csv"));
    let own = |row: &&Row| row["class"] == "rotating" && row["method"] == "socp";
    let socp = rates.iter().find(own).unwrap();
    let counts = ["cells", "refused", "correct"].map(|column| &*socp[column]);
    assert_eq!(counts, ["5", "5", "0"]);
}

/// A study of problem files is told by class, and a file that changed meanwhile is another problem.
#[test]
fn a_study_of_files_is_told_by_class() {
    let dir = tempfile::tempdir().unwrap();
    collection(
        dir.path(),
        &[
            "disks/full-2d.hdf5",
            "rotating/table-2d.hdf5",
            "rolling/local-2d.hdf5",
        ],
    );
    let sweep = "title = \"Files\"\n\n[[cells]]\nfiles = [\"collection\"]\nmethods = [\"newton-ac\", \"socp\"]\ntolerances = [1e-9]\n";
    std::fs::write(dir.path().join("files.toml"), sweep).unwrap();
    let study = "files.toml --untimed";
    assert_eq!([(); 2].map(|()| measured(dir.path(), study)), [6, 0]);
    let results = dir.path().join("results/files");
    let problems = rows(&results.join("problems.csv"));
    let found: Vec<[&str; 2]> = (problems.iter())
        .map(|row| [&*row["problem"], &*row["rank"]])
        .collect();
    let expected = [
        ["disks.full-2d", "12"],
        ["rolling.local-2d", "NaN"],
        ["rotating.table-2d", "24"],
    ];
    assert_eq!(found, expected);
    assert!(problems[1]["refused"].contains("rolling-friction problem"));
    let mut rates = rows(&results.join("success.csv"));
    rates.retain(|row| !row["class"].is_empty());
    let columns = ["class", "method", "correct", "refused"];
    let found: Vec<[&str; 4]> = (rates.iter())
        .map(|row| columns.map(|column| &*row[column]))
        .collect();
    let expected = [
        ["disks", "newton-ac", "1", "0"],
        ["disks", "socp", "1", "0"],
        ["rolling", "newton-ac", "0", "1"],
        ["rolling", "socp", "0", "1"],
        ["rotating", "newton-ac", "1", "0"],
        ["rotating", "socp", "0", "1"],
    ];
    assert_eq!(found, expected);

    let other = shipped_file("collection/disks/packing-2d.hdf5");
    std::fs::copy(other, dir.path().join("collection/disks/full-2d.hdf5")).unwrap();
    assert_eq!(measured(dir.path(), study), 2);
    // A folder alone is a study of all methods.
    let (shown, _) = ends_with(0, &["study", "collection", "--list"], dir.path());
    assert_eq!(shown.lines().count(), 3 * 3 * methods().len());
    std::fs::create_dir(dir.path().join("none")).unwrap();
    let (_, error) = ends_with(2, &["study", "none"], dir.path());
    assert!(error.contains("no file.hdf5"), "{error}");
}

/// Goal: a packing whose points are redundant takes tens of iterations, not the hundreds of sweeps (767 iterations in all) after
/// which `hybrid` once came to the method that solves it.
#[test]
fn hybrid_comes_to_the_interior_point_method_early_where_points_are_redundant() {
    let dir = tempfile::tempdir().unwrap();
    let file = shipped_file("packing.hdf5");
    let solve = ["solve", file.to_str().unwrap(), "-m", "hybrid"];
    ends_with(0, &[&solve[..], &["--out", "results"]].concat(), dir.path());
    let runs = rows(&dir.path().join("results/runs.csv"));
    let iterations: usize = runs[0]["iterations"].parse().unwrap();
    assert!(
        runs[0]["verdict"] == "solved" && iterations < 40,
        "{iterations}"
    );
    let problem = &rows(&dir.path().join("results/problems.csv"))[0];
    assert_eq!([&problem["rows"], &problem["rank"]], ["171", "108"]);
}
