//! Exported problems, solved again from their files, give what the case itself gives; bad files give exit code 2.

use std::path::{Path, PathBuf};

use crate::common::*;
use stickslip::case::{Case, Target, shipped};
use stickslip::files::interchange::{
    Info, LocalEquality, LocalProblem, Problem, SparseMatrix, fclib,
};
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::registry::methods;
use stickslip::studies::cases::{Settings, run_case};
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
        tier: Some(Target::Tier(Tier::High)),
        ..Settings::PLAIN
    };
    let results = run_case(&case, &[choice], settings, &Quiet).unwrap();
    let own = results.points();
    let own = own.iter().filter(|row| row.key.increment == increment);
    let dim = case.model.dim();
    own.flat_map(|row| {
        [row.point.p_n, row.point.p_a, row.point.p_b]
            .into_iter()
            .take(dim)
    })
    .collect()
}

pub fn vector(path: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    text.lines().map(|line| line.parse().unwrap()).collect()
}

/// The verdict of one row of `runs.csv`.
pub fn verdict(dir: &Path, case: &str, method: &str) -> String {
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
    let local = dir.path().join(format!("problems/{stem}.local.hdf5"));
    let kinds = match fclib::read(&local).unwrap() {
        Problem::Local(problem) if problem.equality.is_some() => &["local"][..],
        _ => &["local", "global"],
    };
    let files: Vec<String> = (kinds.iter())
        .map(|kind| format!("problems/{stem}.{kind}.hdf5"))
        .collect();
    let mut arguments = vec!["solve", "--out", "results"];
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
        // Restarts, and faces of the bounds, hang on signs of what vanishes at the solution.
        let close = match method.name {
            "accelerated-gradient" | "tresca" => OTHER_STEPS,
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
            let run = format!("{problem}.{kind}.fclib.{}.mu-{mu}.r.txt", method.name);
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
    let global = format!("problems/{stem}.global.hdf5");
    let (_, singular) = ends_with(2, &["solve", &global], dir.path());
    let told = singular.contains("M is singular") && singular.contains("local problem");
    assert!(told, "{singular}");
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
    }
}

#[test]
fn what_needs_the_stiffness_refuses_local_files() {
    let (dir, stem) = exported(&["plate_mesh1", "--friction", "0.8"]);
    let [local, global] = ["local", "global"].map(|kind| format!("problems/{stem}.{kind}.hdf5"));
    let monolithic = [
        "solve",
        &local,
        &global,
        "--out",
        "results",
        "-m",
        "newton-ac:monolithic=1",
    ];
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

pub fn shipped_file(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data/fclib").join(name)
}

#[test]
fn files_of_other_writers_are_solved() {
    let dir = tempfile::tempdir().unwrap();
    let names = ["local_csr", "local_gzip", "unwritten", "no_contact"];
    let files = names.map(|name| shipped_file(&format!("{name}.hdf5")));
    let mut arguments = vec!["solve", "--out", "results", "-m", METHOD];
    arguments.extend(files.iter().map(|file| file.to_str().unwrap()));
    ends_with(0, &arguments, dir.path());
    for name in names {
        assert_eq!(verdict(dir.path(), name, METHOD), "solved");
    }
}

/// A V without columns took the solution of no equations for one, which the library of matrices does not.
#[test]
fn a_problem_with_no_rigid_motions_in_its_v_is_solved() {
    let dir = tempfile::tempdir().unwrap();
    let empty = |rows| SparseMatrix::from_triplets(rows, 0, []).unwrap();
    let problem = Problem::Local(LocalProblem {
        dim: 2,
        w: SparseMatrix::from_triplets(2, 2, [(0, 0, 1.0), (1, 1, 1.0)]).unwrap(),
        q: vec![-1.0, 0.1],
        mu: vec![0.3],
        equality: Some(LocalEquality {
            v: empty(2),
            r: empty(0),
            s: Vec::new(),
        }),
        info: Info::default(),
        solution: None,
        guesses: Vec::new(),
    });
    std::fs::write(dir.path().join("p.hdf5"), problem.to_bytes().unwrap()).unwrap();
    ends_with(0, &["solve", "p.hdf5", "-m", METHOD], dir.path());
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
    let half = shipped_file("half.hdf5");
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
        (vec![half.to_str().unwrap()], "W holds one triangle"),
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
