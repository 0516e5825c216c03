//! Exported problems, solved again from their files, give what the case itself gives; bad files give exit code 2.

use std::path::{Path, PathBuf};

use crate::common::*;
use stickslip::case::Case;
use stickslip::case::shipped;
use stickslip::files::interchange::{Problem, fclib, matrix_market};
use stickslip::run::choice::Choice;
use stickslip::run::registry::methods;
use stickslip::run::run_case::{Fields, Quiet, Settings, run_case};
use stickslip_methods::Tier;
use tempfile::TempDir;

/// Largest difference of contact forces, relative to the largest, where a method takes the same steps.
const SAME_STEPS: f64 = 1e-8;

/// The same where iterations begin at other contact forces, which a file does not hold, or rounding decides between steps: a
/// natural map of 1e-9, amplified.
const OTHER_STEPS: f64 = 1e-6;

/// Exports into `problems/` of a new folder: the folder and the common name of the files.
fn exported(arguments: &[&str]) -> (TempDir, String) {
    let dir = tempfile::tempdir().unwrap();
    let (shown, _) = ends_with(0, &[&["export"], arguments].concat(), dir.path());
    let first = shown.lines().next().unwrap();
    let stem = first.strip_prefix("problems/").unwrap().to_owned();
    (dir, stem)
}

/// Contact forces of the solution in a file.
fn solution(path: &Path) -> Vec<f64> {
    match fclib::read(path).unwrap() {
        Problem::Local(problem) => problem.solution.unwrap().r,
        Problem::Global(problem) => problem.solution.unwrap().r,
    }
}

/// Contact forces of a direct run by the method of that name, point by point.
fn direct(case: &Case, method: &str, friction: f64, increment: usize) -> Vec<f64> {
    let mut case = case.clone();
    case.sweep.friction = vec![friction];
    case.sweep.refine.truncate(1);
    case.expects.clear();
    let choice = Choice::new(stickslip::run::registry::method(method).unwrap(), &[]).unwrap();
    let settings = Settings {
        tier: Some(Tier::High),
        jobs: 1,
        fields: Fields::None,
        starts: 1,
    };
    let results = run_case(&case, &[choice], settings, &Quiet).unwrap();
    let own = (results.points.iter()).filter(|row| row.key.increment == increment);
    let dim = case.model.dim();
    own.flat_map(|row| {
        [row.point.p_n, row.point.p_a, row.point.p_b]
            .into_iter()
            .take(dim)
    })
    .collect()
}

fn vector(path: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    matrix_market::parse(path, &text).unwrap().column(0)
}

/// The verdict of one row of `runs.csv`.
fn verdict(dir: &Path, case: &str, method: &str) -> String {
    let runs = std::fs::read_to_string(dir.join("results/runs.csv")).unwrap();
    let mut rows = csv_rows(&runs).into_iter();
    let row = rows.find(|row| row["case"] == case && row["method"] == method);
    row.unwrap_or_else(|| panic!("{case} {method}"))["verdict"].clone()
}

/// Exports one increment, solves its files with every method and compares with direct runs.
fn files_give_what_the_case_gives(
    name: &str,
    friction: f64,
    increment: usize,
) -> (TempDir, String) {
    let case = shipped::find(name).unwrap().unwrap();
    let (mu, k) = (friction.to_string(), increment.to_string());
    let (dir, stem) = exported(&[name, "--friction", &mu, "--increment", &k]);
    let floating = dir.path().join(format!("problems/{stem}.V.mtx")).exists();
    let kinds = if floating {
        &["local"][..]
    } else {
        &["local", "global"]
    };
    let files: Vec<String> = (kinds.iter())
        .map(|kind| format!("problems/{stem}.{kind}.hdf5"))
        .collect();
    let mut arguments = vec!["solve"];
    arguments.extend(files.iter().map(String::as_str));
    ends_with(0, &arguments, dir.path());
    assert!(dir.path().join("results/history.csv").exists());
    let close = if increment == 1 {
        SAME_STEPS
    } else {
        OTHER_STEPS
    };
    let exact = solution(&dir.path().join(&files[0]));
    for method in methods() {
        // Its restarts hang on the sign of a product that vanishes at the solution.
        let close = match method.name {
            "accelerated-gradient" => OTHER_STEPS,
            _ => close,
        };
        let expected = direct(&case, method.name, friction, increment);
        for kind in kinds {
            let problem = format!("{stem}.{kind}");
            let verdict = verdict(dir.path(), &problem, method.name);
            let at = format!("{} {kind}: {verdict}", method.name);
            if let Some(reason) = verdict.strip_prefix("refused: ") {
                assert!(!reason.is_empty() && !method.exact, "{at}");
                continue;
            }
            // The export starts where an exact method has led; an approximate one has led elsewhere.
            if increment > 1 && !method.exact {
                assert!(verdict.starts_with("approximate"), "{at}");
                continue;
            }
            let run = format!("{problem}.{kind}.fclib.{}.mu-{mu}.r.mtx", method.name);
            let found = vector(&dir.path().join("results/solutions").join(run));
            let difference = relative_difference(&found, &expected);
            assert!(difference <= close, "{at}: {difference:e}");
            if method.exact {
                let difference = relative_difference(&found, &exact);
                let holds = verdict == "solved" && difference <= OTHER_STEPS;
                assert!(holds, "{at}: {difference:e}");
            }
        }
    }
    (dir, stem)
}

#[test]
fn plate_and_beam_and_later_increments_that_start_where_the_path_has_led() {
    files_give_what_the_case_gives("plate_mesh1", 0.8, 1);
    files_give_what_the_case_gives("beam_model1", 0.1, 1);
    files_give_what_the_case_gives("cyclic", 0.3, 4);
}

#[test]
fn floating_block_with_its_rigid_motions() {
    let (dir, stem) = files_give_what_the_case_gives("sliding_block_embedded", 0.2, 3);
    std::fs::remove_dir_all(dir.path().join("results")).unwrap();
    let file = |kind: &str| format!("problems/{stem}.{kind}");
    let [global, local, q] = ["global.hdf5", "local.hdf5", "q.mtx"].map(file);
    let (_, singular) = ends_with(2, &["solve", &global], dir.path());
    let told = singular.contains("M is singular") && singular.contains("local problem");
    assert!(told, "{singular}");
    let (_, floats) = ends_with(2, &["judge", &local, &q], dir.path());
    assert!(floats.contains("the body floats"), "{floats}");
    assert!(!dir.path().join("results").exists());
}

#[test]
fn frictionless_cases_keep_all_rows() {
    let (dir, stem) = exported(&["frictionless"]);
    let path = dir.path().join(format!("problems/{stem}.local.hdf5"));
    let Problem::Local(problem) = fclib::read(&path).unwrap() else {
        panic!("a global problem");
    };
    assert_eq!(problem.w.rows(), 2 * problem.points());
    assert!(problem.mu.iter().all(|&mu| mu == 0.0));
    let solution = problem.solution.unwrap();
    assert!(solution.r.iter().step_by(2).any(|&p| p > 0.0));
    assert!(solution.r.iter().skip(1).step_by(2).all(|&p| p == 0.0));
    ends_with(0, &["solve", path.to_str().unwrap()], dir.path());
}

/// The equations of both problems, from the files alone.
#[test]
fn exported_solutions_fulfil_the_equations_of_the_format() {
    for arguments in [
        &["cyclic", "--increment", "4"][..],
        &["sliding_block_embedded", "--friction", "0.2"],
    ] {
        let (dir, stem) = exported(arguments);
        let file = |end: &str| dir.path().join(format!("problems/{stem}.{end}"));
        let Problem::Local(local) = fclib::read(&file("local.hdf5")).unwrap() else {
            panic!("a global problem");
        };
        let solution = local.solution.unwrap();
        let mut u = local.q.clone();
        let mut size = 0.0;
        for (i, j, w) in local.w.entries() {
            u[i] += w * solution.r[j];
            size += (w * solution.r[j]).abs();
        }
        if let Some(equality) = &local.equality {
            let mut balance = equality.s.clone();
            for (i, j, v) in equality.v.entries() {
                u[i] += v * solution.l[j];
                balance[j] += v * solution.r[i];
            }
            let force = solution.r.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
            assert!(
                balance.iter().all(|b| b.abs() <= 1e-11 * force),
                "{balance:?}"
            );
        }
        let close = |a: &[f64], b: &[f64], size: f64| {
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-11 * size)
        };
        assert!(close(&u, &solution.u, size), "{u:?}\n{:?}", solution.u);

        let Problem::Global(global) = fclib::read(&file("global.hdf5")).unwrap() else {
            panic!("a local problem");
        };
        let solution = global.solution.unwrap();
        let mut residual: Vec<f64> = global.f.iter().map(|f| -f).collect();
        let mut size = 0.0;
        for (i, j, m) in global.m.entries() {
            residual[i] += m * solution.v[j];
            size += (m * solution.v[j]).abs();
        }
        let mut u = global.w.clone();
        for (i, j, h) in global.h.entries() {
            residual[i] -= h * solution.r[j];
            u[j] += h * solution.v[i];
        }
        assert!(
            residual.iter().all(|r| r.abs() <= 1e-13 * size),
            "{residual:?}"
        );
        let largest = solution.v.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(close(&u, &solution.u, largest));
        // The text files are the same numbers.
        assert_eq!(vector(&file("f.mtx")), global.f);
        assert_eq!(vector(&file("q.mtx")), local.q);
        for (part, matrix) in [
            ("K", &global.m),
            ("B", &global.h.transposed()),
            ("W", &local.w),
        ] {
            let path = file(&format!("{part}.mtx"));
            let text = std::fs::read_to_string(&path).unwrap();
            assert_eq!(
                &matrix_market::parse(&path, &text).unwrap(),
                matrix,
                "{part}"
            );
        }
    }
}

#[test]
fn reactions_of_other_programs_are_judged() {
    let (dir, stem) = exported(&["plate_mesh1", "--friction", "0.8"]);
    let file = format!("problems/{stem}.local.hdf5");
    let reaction = solution(&dir.path().join(&file));
    let write = |name: &str, values: &[f64]| {
        std::fs::write(dir.path().join(name), matrix_market::vector(values)).unwrap();
    };
    write("good.mtx", &reaction);
    write("zero.mtx", &vec![0.0; reaction.len()]);
    let rough: Vec<f64> = reaction.iter().map(|r| r * (1.0 + 1e-5)).collect();
    write("rough.mtx", &rough);
    write("short.mtx", &reaction[1..]);
    // More entries than a number can count.
    let huge = "%%MatrixMarket matrix coordinate real general\n18446744073709551615 2 0\n";
    std::fs::write(dir.path().join("huge.mtx"), huge).unwrap();
    let sizes = "line 2: `18446744073709551615 2 0`, expected sizes that the file can hold";
    let wide = "%%MatrixMarket matrix coordinate real general\n4000000 2 0\n";
    std::fs::write(dir.path().join("wide.mtx"), wide).unwrap();
    let shape = format!("4000000 × 2, expected {} × 1", reaction.len());
    for (arguments, code, words) in [
        (&["good.mtx"][..], 0, ""),
        (&["good.mtx", "zero.mtx"], 1, ""),
        (&["rough.mtx"], 1, ""),
        (&["rough.mtx", "--tier", "low"], 0, ""),
        (&["short.mtx"], 2, ""),
        (&["huge.mtx"], 2, sizes),
        (&["wide.mtx"], 2, &shape),
        (&["nowhere.mtx"], 2, ""),
    ] {
        let arguments = [&["judge", &*file], arguments].concat();
        let (_, complaints) = ends_with(code, &arguments, dir.path());
        assert!(complaints.contains(words), "{complaints}");
    }
    // The global file says the same, within its own rounding.
    let global = format!("problems/{stem}.global.hdf5");
    let (shown, _) = ends_with(0, &["judge", &global, "good.mtx"], dir.path());
    assert!(shown.contains("equilibrium"));

    // What needs the stiffness refuses local files.
    let monolithic = ["solve", &file, &global, "-m", "newton-ac:monolithic=1"];
    ends_with(0, &monolithic, dir.path());
    let [local, global] = ["local", "global"].map(|kind| {
        let case = format!("{stem}.{kind}");
        verdict(dir.path(), &case, "newton-ac[monolithic=1e0]")
    });
    assert!(
        local.starts_with("refused: ") && global == "solved",
        "{local} {global}"
    );
}

fn shipped_file(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data/fclib").join(name)
}

#[test]
fn files_of_other_writers_are_solved() {
    let dir = tempfile::tempdir().unwrap();
    let files = ["local_csr.hdf5", "local_gzip.hdf5"].map(shipped_file);
    let mut arguments = vec!["solve", "-m", METHOD];
    arguments.extend(files.iter().map(|file| file.to_str().unwrap()));
    ends_with(0, &arguments, dir.path());
    for name in ["local_csr", "local_gzip"] {
        assert_eq!(verdict(dir.path(), name, METHOD), "solved");
    }
}

#[test]
fn bad_files_give_exit_code_2_and_leave_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let good = std::fs::read(shipped_file("local_csr.hdf5")).unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).unwrap();
    write("good.hdf5", &good);
    write("short.hdf5", &good[..good.len() / 2]);
    write("empty.hdf5", b"");
    write("text.hdf5", b"%%MatrixMarket matrix array real general\n");
    let constraints = shipped_file("global.hdf5");
    let unsymmetric = shipped_file("collection/rotating/table-2d-global.hdf5");
    let rolling = shipped_file("collection/rolling/local-3d.hdf5");
    for (arguments, part) in [
        (vec!["short.hdf5"], "short.hdf5"),
        (vec!["empty.hdf5"], "not readable as HDF5"),
        (vec!["text.hdf5"], "not readable as HDF5"),
        (vec!["nowhere.hdf5"], "cannot read `nowhere.hdf5`"),
        (vec!["good.hdf5", "short.hdf5"], "short.hdf5"),
        (vec!["good.hdf5", "good.hdf5"], "`good` is given twice"),
        (vec!["good.hdf5", "-m", "none"], "unknown method `none`"),
        (vec![constraints.to_str().unwrap()], "G is present"),
        (
            vec![unsymmetric.to_str().unwrap()],
            "condense it to a local file",
        ),
        (vec![rolling.to_str().unwrap()], "rolling-friction problem"),
    ] {
        let (_, error) = ends_with(2, &[&["solve"], &arguments[..]].concat(), dir.path());
        assert!(error.contains(part), "{arguments:?}: {error}");
        assert!(!dir.path().join("results").exists(), "{arguments:?}");
    }
}

#[test]
fn questions_without_an_answer_are_not_exported() {
    let dir = tempfile::tempdir().unwrap();
    let low = ["plate_mesh1", "--friction", "0.1"];
    #[rustfmt::skip]
    let refused = [
        (&["plate_mesh1"][..], &[][..], "0.1, 0.8, 1.2: choose one with --friction"),
        (&low, &["--increment", "2"], "increments 1 to 1"),
        (&["plate_mesh1"], &["--friction=-1"], "not negative"),
        (&low, &["-m", "penalty"], "not solved by penalty"),
        (&["nothing"], &[], "unknown case"),
    ];
    for (case, options, part) in refused {
        let arguments = [&["export"], case, options].concat();
        let (_, error) = ends_with(2, &arguments, dir.path());
        assert!(error.contains(part), "{arguments:?}: {error}");
        assert!(!dir.path().join("problems").exists(), "{arguments:?}");
    }
}

/// Families of `tests/data/fclib/collection`, in another folder: only the files named are copied.
fn collection(dir: &Path, files: &[&str]) {
    for file in files {
        let to = dir.join("collection").join(file);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(shipped_file("collection").join(file), to).unwrap();
    }
}

fn rows(path: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    csv_rows(&std::fs::read_to_string(path).unwrap())
}

/// Source: `make_collection.py` says which file is what; rank and asymmetry were found by numpy.
#[test]
fn a_collection_is_solved_or_refused_with_the_reason() {
    let dir = tempfile::tempdir().unwrap();
    let all = shipped_file("collection");
    let methods = ["newton-ac", "nsgs", "interior-point", "socp"];
    let mut arguments = vec!["solve", all.to_str().unwrap()];
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
        ("rotating.table-2d-global", "NaN", "NaN", "NaN", "NaN", "M is unsymmetric by 2.0e-2 relative"),
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
                    let reason = format!(
                        "refused: W is unsymmetric by {relative:.1e} relative, the method needs a symmetric W"
                    );
                    assert_eq!(verdict, reason, "{name}");
                }
                // Rigid bodies on each other, with more contact rows than W has rank.
                _ if several.iter().any(|own| name.starts_with(own)) => {
                    assert_eq!(verdict, "solved (several)", "{name} {method}");
                }
                _ => assert_eq!(verdict, "solved", "{name} {method}"),
            }
        }
    }
    // What libfclib has copied is the same problem.
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
            name.starts_with(&start) && name.ends_with(".r.mtx")
        };
        vector(&found.into_iter().find(own).unwrap())
    };
    assert_eq!(solution("table-3d"), solution("table-3d-libfclib"));
    let families = rows(&dir.path().join("results/families.csv"));
    let own = |row: &&std::collections::BTreeMap<String, String>| {
        row["family"] == "rotating" && row["method"] == "socp"
    };
    let socp = families.iter().find(own).unwrap();
    assert_eq!(
        [&socp["problems"], &socp["refused"], &socp["honest"]],
        ["4", "4", "0"]
    );
}

/// A study of problem files goes on where it ended, and a file that changed meanwhile is another problem.
#[test]
fn a_study_of_files_is_resumed_and_told_by_family() {
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
    let study = ["study", "files.toml", "--untimed"];
    let (shown, _) = ends_with(0, &study, dir.path());
    assert!(
        shown.contains("6 cells: 0 measured before, 6 now, 0 left"),
        "{shown}"
    );
    let (shown, _) = ends_with(0, &study, dir.path());
    assert!(
        shown.contains("6 cells: 6 measured before, 0 now, 0 left"),
        "{shown}"
    );
    let results = dir.path().join("results");
    let problems = rows(&results.join("problems.csv"));
    let found: Vec<[&str; 3]> = (problems.iter())
        .map(|row| [&*row["problem"], &*row["family"], &*row["rank"]])
        .collect();
    let expected = [
        ["disks.full-2d", "disks", "12"],
        ["rolling.local-2d", "rolling", "NaN"],
        ["rotating.table-2d", "rotating", "24"],
    ];
    assert_eq!(found, expected);
    assert!(problems[1]["refused"].contains("rolling-friction problem"));
    let families = rows(&results.join("families.csv"));
    let found: Vec<[&str; 4]> = (families.iter())
        .map(|row| {
            [
                &*row["family"],
                &*row["method"],
                &*row["honest"],
                &*row["refused"],
            ]
        })
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
    let (_, error) = ends_with(2, &study, dir.path());
    assert!(error.contains("holds another sweep"), "{error}");
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
    ends_with(
        0,
        &["solve", file.to_str().unwrap(), "-m", "hybrid"],
        dir.path(),
    );
    let runs = rows(&dir.path().join("results/runs.csv"));
    let iterations: usize = runs[0]["iterations"].parse().unwrap();
    assert!(
        runs[0]["verdict"] == "solved" && iterations < 120,
        "{iterations}"
    );
    let problem = &rows(&dir.path().join("results/problems.csv"))[0];
    assert_eq!([&problem["rows"], &problem["rank"]], ["171", "108"]);
}
