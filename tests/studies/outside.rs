//! Programs as methods: whatever one does is a verdict, nothing it says of itself is believed, and nothing is left of it.

#![cfg(unix)]

use std::fs::{self, File};
use std::io::Read;
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

use crate::common::{awaited, csv_rows};
use stickslip::files::interchange::{Info, LocalProblem, Problem, SparseMatrix, fclib};
use stickslip::run::choice::Choice;
use stickslip::run::judged::JudgedIncrement;
use stickslip::run::path::Solver;
use stickslip::studies::exchange::local_system;
use stickslip::studies::record::Record;
use stickslip_methods::{ContactState, ContactSystem, Increment, Load};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_stickslip");

/// Source: hand calculation. r_n = 2/0.5 = 4 closes the gap; 3 N would hold the slip, the bound is 2 N.
fn one_point() -> LocalProblem {
    let w = [0.5, 0.2];
    LocalProblem {
        dim: 2,
        w: SparseMatrix::from_dense(2, 2, |i, j| if i == j { w[i] } else { 0.0 }),
        q: vec![-2.0, 0.6],
        mu: vec![0.5],
        equality: None,
        info: Info::default(),
        solution: None,
        guesses: Vec::new(),
    }
}

/// A name for the program of the tests. A link: what was written here could be held open for writing by a process that another
/// test starts at that moment, and would not run.
pub fn called(dir: &Path, name: &str) -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/outside");
    let path = dir.join(name);
    symlink(own, &path).unwrap();
    path
}

fn exec(path: &Path) -> String {
    format!("exec:{}", path.display())
}

pub fn judged(choice: &Choice) -> JudgedIncrement {
    let posed = local_system(&one_point()).unwrap();
    let system = ContactSystem::new(posed.elastic, posed.friction).unwrap();
    let (rest, start) = (Load::zero(system.elastic()), ContactState::zero(&system));
    let increment = Increment {
        system: &system,
        load: &posed.load,
        start_load: &rest,
        start: &start,
        guess: None,
        index: 0,
        tolerance: 1e-9,
    };
    Solver::new(choice, &system)
        .unwrap()
        .judge(&increment, 1e-9)
}

#[test]
fn whatever_a_program_does_is_a_verdict() {
    let dir = tempfile::tempdir().unwrap();
    #[rustfmt::skip]
    let ends = [
        ("honest", "solved"),
        ("boastful", "solved"),
        ("arguments", "solved"),
        ("liar", "false-claim"),
        ("crash", "crashed: exit status: 1: last words"),
        ("killed", "crashed: signal: 9 (SIGKILL)"),
        ("hungry", "out-of-memory"),
        ("short", "crashed: 1 numbers for reactions, expected 2: 2 per point"),
        ("long", "crashed: 3 numbers for reactions, expected 2: 2 per point"),
        ("nan", "crashed: line 2 of the reactions: `nan` is no finite number"),
        ("garbage", "crashed: no reactions: byte 0 is 0xFF, no UTF-8 text"),
        ("words", "crashed: line 1 of the reactions: `four` is no finite number"),
        ("mute", "crashed: no reactions: No such file or directory (os error 2)"),
        ("folder", "crashed: no reactions: a directory, not a regular file"),
        ("lots", "crashed: it printed `iterations = lots`"),
        ("endless", "crashed: it printed `iterations = 1000000001`"),
        ("chatty", "crashed: standard output has more than 67108864 bytes"),
        ("lavish", "crashed: REACTION has more than 1048704 bytes"),
        ("pipes", "gave-up: unexplained"),
        ("vanishes", "gave-up: unexplained"),
        ("gives-up", "gave-up: unexplained"),
        ("stalls", "gave-up: stalled"),
        ("declines", "refused: ./problem.hdf5 is not for me"),
    ];
    for (name, verdict) in ends {
        let choice = Choice::parse(&exec(&called(dir.path(), name))).unwrap();
        assert_eq!(choice.label, format!("exec:{name}"));
        let found = judged(&choice);
        assert_eq!(found.verdict.to_string(), verdict, "{name}");
        if name == "honest" {
            let (work, judged) = (found.work.unwrap().solve, found.judged.unwrap());
            assert_eq!(judged.outcome.counters.iterations, 7);
            assert_eq!(work.reported_s, Some(1e-9));
            // A process takes longer than that, and less than the call with its files.
            assert!(1e-5 < work.enforcement_s && work.enforcement_s < work.total_s);
        } else {
            // Nor is a boast believed that the process itself refutes.
            assert_eq!(found.work.unwrap().solve.reported_s, None, "{name}");
        }
    }
}

/// The pipe that a program of the tests holds, with all that it starts: its end is that of them all, whenever that is.
pub struct Life(File);

impl Life {
    /// Of a program that begins later.
    pub fn of(program: &Path) -> Self {
        let pipe = program.with_extension("life");
        let made = Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        // One that is written to opens at once.
        let _both = File::options().read(true).write(true).open(&pipe).unwrap();
        Self(File::open(pipe).unwrap())
    }

    /// What one says that has begun.
    pub fn begun(&mut self) -> String {
        let mut line = String::new();
        let begun = || {
            line += &self.said();
            !line.is_empty()
        };
        assert!(awaited(begun));
        line
    }

    /// What they said, once all that have begun have ended.
    pub fn said(&mut self) -> String {
        let mut text = String::new();
        self.0.read_to_string(&mut text).unwrap();
        text
    }
}

/// Goal: a program that never ends is ended in time, and what it started at its end, whichever that is.
#[test]
fn silence_is_timed_out() {
    let dir = tempfile::tempdir().unwrap();
    let path = called(dir.path(), "forever");
    let (mut life, mut seconds) = (Life::of(&path), 0.2);
    let mut ended = |seconds: f64, until: Option<Instant>| {
        let forever = Choice::parse(&exec(&path)).unwrap();
        let verdict = judged(&forever.limited(seconds, until)).verdict;
        assert_eq!(verdict.to_string(), "timed-out");
        life.said()
    };
    // A busy machine ends it before it has begun.
    while {
        let (clock, said) = (Instant::now(), ended(seconds, None));
        assert!(clock.elapsed().as_secs_f64() >= seconds);
        assert!(["", "begun\n"].contains(&&*said), "{said}");
        said.is_empty()
    } {
        seconds *= 2.0;
    }
    assert_eq!(ended(300.0, Some(Instant::now())), "");

    let path = called(dir.path(), "leaves");
    let mut life = Life::of(&path);
    let verdict = judged(&Choice::parse(&exec(&path)).unwrap()).verdict;
    assert_eq!(verdict.to_string(), "gave-up: unexplained");
    assert_eq!(life.said(), "begun\n");
}

/// Goal: neither a program nor its folder outlives a harness that is killed, which can do nothing more about it, however soon
/// after the beginning of the program.
#[test]
fn nothing_is_left_of_a_call_whose_harness_was_killed() {
    let dir = folder();
    let temporary = dir.path().join("tmp");
    for name in ["kills", "kills-late"] {
        let mut life = Life::of(&called(dir.path(), name));
        let mut harness = Command::new(PROGRAM);
        let harness = harness.args(["solve", "one.hdf5", "-m", &format!("exec:{name}")]);
        let harness = harness.current_dir(dir.path()).env("TMPDIR", &temporary);
        assert_eq!(harness.status().unwrap().signal(), Some(9));
        let problem = life.said();
        assert!(problem.starts_with(temporary.to_str().unwrap()) && problem.lines().count() == 1);
        assert!(awaited(|| is_empty(&temporary)), "{problem}");
    }
}

fn is_empty(dir: &Path) -> bool {
    fs::read_dir(dir).unwrap().count() == 0
}

fn stickslip(dir: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = Command::new(PROGRAM)
        .args(arguments)
        .current_dir(dir)
        .env("TMPDIR", dir.join("tmp"))
        .output()
        .unwrap();
    // Whatever became of a call, its folder is gone, or goes where a process that measures was ended with it.
    let gone = || is_empty(&dir.join("tmp"));
    assert!(gone() || arguments.contains(&"--time-limit") && awaited(gone));
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

/// A folder with the problem of one point, and one for what is temporary.
fn folder() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("tmp")).unwrap();
    let bytes = Problem::Local(one_point()).to_bytes().unwrap();
    fs::write(dir.path().join("one.hdf5"), bytes).unwrap();
    dir
}

#[test]
fn it_is_tabulated_like_the_methods_here() {
    let dir = folder();
    for name in ["honest", "liar", "deep"] {
        called(dir.path(), name);
    }
    let methods =
        "solve one.hdf5 --out results -m b-newton -m exec:honest -m exec:./liar -m exec:deep";
    let arguments: Vec<&str> = methods.split(' ').collect();
    let (code, shown, complaints) = stickslip(dir.path(), &arguments);
    assert_eq!(code, Some(1), "{complaints}");
    assert!(
        shown.contains("exec:honest") && shown.contains("exec:liar"),
        "{shown}"
    );
    let rows = csv_rows(&fs::read_to_string(dir.path().join("results/runs.csv")).unwrap());
    let of = |method: &str, column: &str| {
        let row = rows.iter().find(|row| row["method"] == method);
        row.unwrap()[column].clone()
    };
    assert_eq!(of("exec:honest", "verdict"), "solved");
    assert_eq!(of("exec:liar", "verdict"), "false-claim");
    let reported = ["b-newton", "exec:honest", "exec:liar"].map(|m| of(m, "reported_s"));
    assert_eq!(reported, ["NaN", "1e-9", "NaN"]);
    assert_eq!(of("exec:liar", "enforcement_s"), "NaN");
}

#[test]
fn what_is_no_program_is_refused() {
    let dir = folder();
    fs::write(dir.path().join("text"), "#!/bin/sh\n").unwrap();
    for (argument, part) in [
        ("exec:missing", "method exec:missing: No such file"),
        ("exec:text", "method exec:text: it is not executable"),
        ("exec:tmp", "method exec:tmp: a directory"),
        ("exec:", "method exec:: "),
    ] {
        let arguments = ["solve", "one.hdf5", "-m", argument];
        let (code, _, complaints) = stickslip(dir.path(), &arguments);
        assert_eq!(code, Some(2), "{complaints}");
        assert!(complaints.contains(part), "{complaints}");
        assert!(!dir.path().join("results").exists());
    }
}

#[test]
fn the_conformance_kit_finds_who_does_not_conform() {
    let dir = folder();
    for name in ["liar", "declines"] {
        called(dir.path(), name);
    }
    let (code, shown, _) = stickslip(dir.path(), &["conform", "hybrid", "nsgs"]);
    assert_eq!(code, Some(0), "{shown}");
    assert_eq!(shown.matches(" passed, 0 declined, 0 failed").count(), 2);
    // None of it is the problem of one point.
    let (code, shown, _) = stickslip(dir.path(), &["conform", "exec:liar"]);
    assert_eq!(code, Some(1));
    assert!(
        shown.contains("exec:liar: 0 of 18 passed, 0 declined, 18 failed"),
        "{shown}"
    );
    // Who declines everything has shown nothing.
    let (code, shown, _) = stickslip(dir.path(), &["conform", "exec:declines"]);
    assert_eq!(code, Some(1));
    assert!(shown.contains("18 declined, 0 failed"), "{shown}");
}

/// Goal: in a study too every program has its verdict and an honest one its times; one that changes is measured again.
#[test]
fn a_study_outlives_its_programs_and_sees_when_they_change() {
    let dir = folder();
    let path = dir.path();
    let export = "export plate_mesh1 --friction 0.1 --out problems";
    let export: Vec<&str> = export.split(' ').collect();
    assert_eq!(stickslip(path, &export).0, Some(0));
    let local = (fs::read_dir(path.join("problems")).unwrap())
        .map(|entry| entry.unwrap().path())
        .find(|path| path.to_string_lossy().ends_with(".local.hdf5"))
        .unwrap();
    let Problem::Local(problem) = fclib::read(&local).unwrap() else {
        panic!("a local problem");
    };
    let r = problem.solution.unwrap().r;
    let numbers: Vec<String> = r.iter().map(|r| format!("{r:e}")).collect();
    fs::write(path.join("r.txt"), numbers.join("\n") + "\n").unwrap();
    for name in ["knows", "halves", "forever", "crash"] {
        called(path, name);
    }
    let methods = "\"b-newton\", \"exec:knows\", \"exec:halves\", \"exec:crash\"";
    let study = |methods: &str, more: &[&str]| {
        let sweep = format!(
            "title = \"t\"\nrepeats = {{ least = 2, most = 2, seconds = 0.0, patience_s = 1e9 }}\n[[cells]]\n\
             cases = [\"plate_mesh1\"]\nfriction = [0.1]\ntolerances = [1e-6]\nmethods = [{methods}]\n"
        );
        fs::write(path.join("sweep.toml"), sweep).unwrap();
        let arguments = ["study", "sweep.toml", "--out", "out"];
        stickslip(path, &[&arguments, more].concat())
    };
    let record = |method: &str| -> Record {
        let mut files = fs::read_dir(path.join("out/records")).unwrap();
        let text = fs::read_to_string(files.next().unwrap().unwrap().path()).unwrap();
        let all = text.lines().map(|line| serde_json::from_str(line).unwrap());
        let mut own = all.filter(|own: &Record| own.found.method == method);
        own.next_back().unwrap()
    };

    let (code, shown, complaints) = study(methods, &[]);
    assert_eq!(code, Some(1), "{complaints}");
    assert!(shown.contains("4 tasks: 4 measured now, 0 left"), "{shown}");
    // On a busy machine the others would not end within a second.
    let all = format!("{methods}, \"exec:forever\"");
    let (_, shown, _) = study(&all, &["--time-limit", "1"]);
    assert!(shown.contains("5 tasks: 1 measured now, 0 left"), "{shown}");
    let knows = record("exec:knows");
    assert_eq!(knows.found.verdict.to_string(), "solved");
    let spent = knows.spent.unwrap();
    assert_eq!(spent.reported.unwrap().median_s, 1e-6);
    assert!(spent.enforcement.median_s > 1e-5 && spent.enforcement.samples == 2);
    assert!(record("b-newton").spent.unwrap().reported.is_none());
    let verdicts =
        ["exec:halves", "exec:forever", "exec:crash"].map(|m| record(m).found.verdict.to_string());
    let reason = format!(
        "crashed: {} numbers for reactions, expected {}: 2 per point",
        r.len() + 1,
        r.len()
    );
    let crash = "crashed: exit status: 1: last words";
    assert_eq!(verdicts, [&*reason, "timed-out", crash]);

    // Written by a process that ends before the program begins.
    let changed = Command::new("sh")
        .args(["-c", "cp halves new && echo exit 3 >> new && mv new halves"])
        .current_dir(path)
        .status();
    assert!(changed.unwrap().success());
    let (_, shown, _) = study(methods, &[]);
    assert!(shown.contains("4 tasks: 1 measured now, 0 left"), "{shown}");
    assert_eq!(
        record("exec:halves").found.verdict.to_string(),
        "gave-up: unexplained"
    );
}
