//! Ends of a study or a task of it: limits are verdicts, what others end is an error, an interruption leaves whole records.

#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use super::outside::Life;
use super::pipeline::{forty_tolerances, measured, planned, records, study};
use crate::common::awaited;
use stickslip::run::verdict::Verdict;
use stickslip::studies::plan::Plan;
use stickslip::studies::record::Record;

/// 40 accuracies on a coarse plate: tasks of a few milliseconds; and more cells.
fn plate(methods: &str, more: &str) -> (tempfile::TempDir, Plan) {
    planned(&format!(
        "title = \"t\"\nrepeats = {{ least = 1, most = 2, seconds = 0.0 }}\n[[cells]]\ncases = [\"plate_mesh1\"]\n\
         friction = [0.1]\nmethods = [{methods}]\ntolerances = {}\n{more}",
        forty_tolerances()
    ))
}

/// A program that waits, in the middle of them.
const WAITS: &str = "[[cells]]\ncases = [\"plate_mesh1\"]\nfriction = [0.1]\nmethods = [\"exec:waits\"]\ntolerances = [1e-6]\n";

/// Complaint of a study that ends with 2.
#[track_caller]
fn refused(mut command: Command) -> String {
    let output = command.stderr(Stdio::piped()).output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    error
}

fn kill(signal: &str, process: &str) {
    let kill = Command::new("kill").args([signal, process]).status();
    assert!(kill.unwrap().success());
}

fn all_solved(out: &Path, plan: &Plan) -> bool {
    let all = records(out, &plan.tasks);
    let solved = |own: &Record| own.found.verdict == Verdict::Solved;
    !all.is_empty() && all.values().all(solved)
}

#[test]
fn limits_of_time_and_memory_are_verdicts() {
    let sweep = "title = \"t\"\n[[cells]]\ncases = [\"plate_mesh1\"]\nrefine = [1]\nfriction = [0.1]\n\
                 methods = [\"hybrid\"]\ntolerances = [1e-3, 1e-6]\n";
    let (dir, plan) = planned(sweep);
    let run = |more: &str| {
        measured(
            dir.path(),
            &format!("sweep.toml --untimed --out out {more}"),
        )
    };
    let out = dir.path().join("out");
    // No task is measured within a microsecond; all have a record, which says something about this limit alone.
    let short = "--time-limit 1e-6";
    assert_eq!([run(short), run(short)], [2, 0]);
    let ended = |r: &Record| r.found.verdict == Verdict::TimedOut && r.limits.is_some();
    assert!(records(&out, &plan.tasks).values().all(ended));
    assert_eq!([run(""), run(short)], [2, 0]);
    assert!(all_solved(&out, &plan));

    let (dir, plan) = planned(&sweep.replace("[1]", "[32, 8, 1]"));
    // The coarse mesh fits into 70 MB of address space; of 176 × 176 cells the factor does not, which an error says; of
    // 704 × 704 nothing does, and the process dies.
    measured(dir.path(), "sweep.toml --out out --memory-limit 70");
    let verdict = |refine: usize| {
        let all = records(&dir.path().join("out"), &plan.tasks).into_values();
        let own = all.filter(|own| own.asked.refine == refine);
        own.map(|own| (own.found.verdict, own.limits.is_some()))
            .collect::<Vec<_>>()
    };
    let (denied, solved) = ((Verdict::OutOfMemory, true), (Verdict::Solved, false));
    for mesh in [32, 8] {
        assert_eq!(verdict(mesh), [denied.clone(), denied.clone()]);
    }
    assert_eq!(verdict(1), [solved.clone(), solved]);
}

/// Goal: what somebody else's limit or hand ends is an error of the run; no record says that a method failed of it.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_shell_and_kills_from_outside_leave_no_record() {
    let (dir, plan) = plate("\"b-newton\"", "");
    // A limit below the one asked for bounds the tasks instead of it, as long as it lasts.
    let own = "sweep.toml --out out --untimed --memory-limit 8000 --shard 1/20";
    let own = study(dir.path(), own);
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v 4000000 && exec \"$0\" \"$@\""]);
    command
        .arg(own.get_program())
        .args(own.get_args())
        .current_dir(dir.path());
    let warned = command.output().unwrap();
    assert_eq!(warned.status.code(), Some(0));
    let told = String::from_utf8(warned.stderr).unwrap();
    assert!(told.contains("the shell bounds memory"), "{told}");
    assert!(all_solved(&dir.path().join("out"), &plan));

    let (dir, plan) = plate("\"b-newton\"", WAITS);
    let mut life = Life::of(&dir.path().join("waits"));
    let mut run = study(dir.path(), "sweep.toml --out killed");
    let run = run.stderr(Stdio::piped()).spawn().unwrap();
    kill("-9", life.begun().trim());
    let output = run.wait_with_output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("signal: 9"), "{error}");
    assert!(all_solved(&dir.path().join("killed"), &plan));
}

/// Goal: whoever cannot write gets an error that names the path, and a second run does not mix with the first.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let (dir, _) = plate("\"b-newton\"", "");
    let error = refused(study(dir.path(), "sweep.toml --out /dev/null/x"));
    assert!(error.contains("/dev/null"), "{error}");
    let out = dir.path().join("full");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("records"), "in the way").unwrap();
    let error = refused(study(dir.path(), "sweep.toml --out full"));
    assert!(error.contains("records"), "{error}");
    assert_eq!(
        fs::read_to_string(out.join("records")).unwrap(),
        "in the way"
    );
}

/// Goal: an interruption ends the run with whole records; the next run takes it up.
#[test]
fn an_interrupted_study_finishes_its_task_and_says_what_is_left() {
    let (dir, plan) = plate("\"b-newton\", \"hybrid\", \"latin\", \"nsgs\"", WAITS);
    let mut life = Life::of(&dir.path().join("waits"));
    let (run, out) = ("sweep.toml --untimed --out out", dir.path().join("out"));
    let mut command = study(dir.path(), run);
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    life.begun();
    kill("-INT", &child.id().to_string());
    let (mut told, mut errors) = (BufReader::new(child.stderr.take().unwrap()), String::new());
    while !errors.contains("Interrupted") && told.read_line(&mut errors).unwrap() > 0 {}
    fs::write(dir.path().join("waits.go"), "").unwrap();
    told.read_to_string(&mut errors).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    let (text, all) = (String::from_utf8(output.stdout).unwrap(), plan.tasks.len());
    let kept = records(&out, &plan.tasks);
    assert!(kept.values().any(|own| own.found.method == "exec:waits"));
    let (kept, left) = (kept.len(), all - kept.len());
    assert!((10..all - 10).contains(&kept), "{kept}");
    assert!(
        text.contains(&format!("{kept} measured now, {left} left")),
        "{text}"
    );
    assert!(errors.contains("Interrupted"), "{errors}");
    // One line per task where nobody looks at a bar.
    assert_eq!(errors.lines().filter(|l| l.starts_with('[')).count(), kept);
    assert_eq!(measured(dir.path(), run), left);
}

/// Goal: what is no file that a disk holds is refused at once by every verb that reads one: pipes that nobody writes into,
/// devices without an end, folders without a problem, and a terabyte of nothing.
#[test]
fn what_is_no_regular_file_is_refused_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let pipe = Command::new("mkfifo")
        .arg(dir.path().join("pipe.toml"))
        .status();
    assert!(pipe.unwrap().success());
    fs::create_dir(dir.path().join("empty")).unwrap();
    let vast = fs::File::create(dir.path().join("vast.toml")).unwrap();
    vast.set_len(1 << 40).unwrap();
    for (file, words) in [
        ("pipe.toml", ["a pipe or device, not a regular file"; 2]),
        ("/dev/zero", ["a pipe or device, not a regular file"; 2]),
        ("/dev/urandom", ["a pipe or device, not a regular file"; 2]),
        (
            "empty",
            ["a directory, not a regular file", "no file.hdf5 or file.h5"],
        ),
        (
            "vast.toml",
            ["1099511627776 bytes", "does not begin like HDF5"],
        ),
    ] {
        for verb in ["check", "run", "study", "solve"] {
            let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
            let program = program.args([verb, file]).current_dir(dir.path());
            let mut child = program
                .stdin(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            if !awaited(|| child.try_wait().unwrap().is_some()) {
                child.kill().unwrap();
                panic!("{verb} {file} hangs");
            }
            let output = child.wait_with_output().unwrap();
            let told = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{verb} {file}: {told}");
            assert!(
                told.starts_with("error: ") && told.contains(file),
                "{verb}: {told}"
            );
            assert!(
                words.iter().any(|word| told.contains(word)),
                "{verb} {file}: {told}"
            );
        }
    }
    assert!(!dir.path().join("results").exists());
}
