//! Whatever bytes a file holds, its reader gives a value or one clear message with its place: no panic, no hang, no memory
//! beyond the file's.
//!
//! `PROPTEST_CASES=100000` asks for more inputs than a test run takes.

mod change;

use std::path::{Path, PathBuf};

use change::{any_binary, any_text};
use proptest::prelude::*;
use stickslip::case;
use stickslip::files::interchange::{Problem, fclib};
use stickslip::model::body::{Body, Needs};
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::verdict::Accuracy;
use stickslip::studies::axes::named;
use stickslip::studies::exchange::problem_file::ProblemFile;
use stickslip::studies::measure::{Bench, here};
use stickslip::studies::plan::Plan;
use stickslip::studies::sources::files::FileProblem;
use stickslip::studies::task::Looks;
use stickslip_methods::Tier;

use super::fclib::any::{any_global, any_local};
use crate::common::quick;

/// Largest number of cells of a case that is discretised here.
const SMALL: usize = 300;

/// So many inputs, unless the environment asks for more.
fn inputs(count: u32) -> ProptestConfig {
    let asked = std::env::var("PROPTEST_CASES").ok();
    ProptestConfig {
        cases: asked.and_then(|n| n.parse().ok()).unwrap_or(count),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Contents of all files of folders of the repository with an ending.
fn files(folders: &[&str], ending: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let entries = folders
        .iter()
        .flat_map(|f| std::fs::read_dir(root.join(f)).unwrap());
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == ending));
    paths.sort();
    assert!(!paths.is_empty(), "{folders:?}");
    paths
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect()
}

/// Demands one message: short, visible, of at most `lines` lines, after a beginning that names the place.
fn assert_clear(message: &str, begins: &str, lines: usize) {
    let hidden = |c: char| c.is_control() && c != '\n';
    assert!(message.starts_with(begins), "no `{begins}`: {message:?}");
    assert!(message.len() > begins.len() + 8, "says nothing: {message}");
    assert!(message.chars().count() < 1500, "floods: {message}");
    assert!(message.lines().count() <= lines, "rambles: {message}");
    assert!(!message.contains(hidden), "commands: {message:?}");
}

/// Time for a reader [s]: the usual inputs take milliseconds, with unoptimised code seconds.
const QUICK: i64 = 20;

fn any_case() -> impl Strategy<Value = Vec<u8>> {
    any_text(files(&["cases", "tests/data/geometry"], "toml"))
}

/// Sweeps of few cells.
const SWEEPS: [&str; 3] = [
    "title = \"Methods on two cases\"\nrepeats = { least = 7, most = 200, seconds = 0.05, patience_s = 2.0 }\n\n\
     [[cells]]\ncases = [\"plate_mesh1\", \"cyclic\"]\nrefine = [1, 2]\ncontact = [\"star\", \"edge-pairs\"]\n\
     friction = [0.1, 0.8]\nmethods = [\"hybrid\", \"penalty:normal=1e2,tangential=1e2\"]\n\
     tolerances = [1e-3, 1e-6, 1e-9]\n",
    "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\n",
    "title = \"Random\"\n[[cells]]\nrandom = { dimension = 2, seed = 1, problems = 1 }\nmethods = [\"nsgs\"]\n\
     tolerances = [1e-6]\n[[cells]]\ncases = [\"beside.toml\", \"tension_open\"]\nmethods = [\"latin\"]\n",
];

fn read_problem(bytes: Vec<u8>) -> Option<Problem> {
    match quick(QUICK, || fclib::from_bytes(Path::new("fuzz.hdf5"), bytes)) {
        Ok(problem) => Some(problem),
        Err(error) => {
            assert_clear(&error.to_string(), "`fuzz.hdf5`", 1);
            None
        }
    }
}

proptest! {
    #![proptest_config(inputs(400))]

    #[test]
    fn any_bytes_are_a_case_or_refused_at_line_and_column(bytes in any_case()) {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("fuzz.toml");
        std::fs::write(&file, &bytes).unwrap();
        match quick(QUICK, || case::read(&file)) {
            Ok(case) => {
                let visible = |text: &str| !text.chars().any(char::is_control);
                prop_assert!(!case.title.is_empty() && visible(&case.title));
                prop_assert!(case.probes.iter().all(|probe| visible(&probe.name)));
                prop_assert!(case.path.increments >= 1 && case.tolerance > 0.0);
            }
            Err(error) => {
                let lines = bytes.iter().filter(|b| **b == b'\n').count() + 1;
                prop_assert!((1..=lines).contains(&error.line()) && error.column() >= 1, "{error}");
                for error in error.faults() {
                    let place = format!("{}:{}:{}: ", file.display(), error.line(), error.column());
                    assert_clear(&error.to_string(), &place, 3);
                    prop_assert!(!error.value().is_empty() && !error.allowed().is_empty(), "{error}");
                }
            }
        }
    }

    #[test]
    fn any_bytes_are_a_sweep_or_refused_at_line_and_column(
        bytes in any_text(SWEEPS.map(|text| text.as_bytes().to_vec()).to_vec())
    ) {
        let dir = tempfile::tempdir().unwrap();
        let cyclic = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/cyclic.toml");
        std::fs::copy(cyclic, dir.path().join("beside.toml")).unwrap();
        let file = dir.path().join("sweep.toml");
        std::fs::write(&file, bytes).unwrap();
        match quick(QUICK, || Plan::read(&file)) {
            Ok(plan) => prop_assert!(!plan.tasks.is_empty()),
            Err(error) => {
                for error in error.faults() {
                    // A case that does not exist has no place in itself.
                    let begins = match error.line() {
                        0 => dir.path().display().to_string(),
                        line => format!("{}:{line}:{}: ", error.file().display(), error.column()),
                    };
                    assert_clear(&error.to_string(), &begins, 3);
                }
            }
        }
    }

    #[test]
    fn any_text_is_a_method_with_options_or_refused(
        text in any_text(["penalty:normal=1e2,tangential=1e2", "hybrid", "exec:./mine"].map(|t| t.as_bytes().to_vec()).to_vec())
    ) {
        let text = String::from_utf8_lossy(&text);
        match quick(QUICK, || Choice::parse(&text)) {
            Ok(choice) => {
                let again = Choice::parse(&choice.argument()).unwrap();
                prop_assert_eq!(again.label, choice.label);
            }
            Err(error) => prop_assert!(error.to_string().contains("method"), "{error}"),
        }
    }
}

proptest! {
    #![proptest_config(inputs(1500))]

    /// A problem that is taken can be written and read again.
    #[test]
    fn any_bytes_are_a_problem_or_refused_by_name(
        bytes in any_binary(files(&["tests/data/fclib"], "hdf5"))
    ) {
        if let Some(problem) = read_problem(bytes) {
            let again = problem.to_bytes().unwrap();
            prop_assert_eq!(read_problem(again), Some(problem));
        }
    }
}

proptest! {
    #![proptest_config(inputs(100))]

    /// Goal: what the reader takes is discretised or refused, whatever its numbers.
    #[test]
    fn an_accepted_case_is_discretised_or_refused(bytes in any_case()) {
        let text = String::from_utf8_lossy(&bytes);
        if let Ok(case) = case::parse("fuzz.toml", text.as_ref()) {
            let lines = case.mesh.grid.lines.iter();
            // Many cells take their time, and are none of the reader's affairs.
            if lines.map(|line| line.len() - 1).product::<usize>() <= SMALL
                && let Err(error) = Body::new(&case, 1, &Needs::default())
            {
                assert_clear(&error.to_string(), "", 3);
            }
        }
    }

    /// Goal: what the reader takes becomes a system that methods solve or give up on, or is refused.
    #[test]
    fn an_accepted_problem_is_run_or_refused(
        problem in prop_oneof![any_local().prop_map(Problem::Local), any_global().prop_map(Problem::Global)]
    ) {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("fuzz.hdf5");
        std::fs::write(&file, problem.to_bytes().unwrap()).unwrap();
        let choices = ["b-newton", "nsgs"].map(|name| Choice::parse(name).unwrap());
        match ProblemFile::read(&file) {
            Ok(problem) => {
                drop(problem);
                let problem = FileProblem::all(std::slice::from_ref(&file)).unwrap()[0].problem();
                let accuracy = Accuracy::exactly(Tier::Low.tolerance());
                let methods = named(&choices);
                let tasks = problem.subject.tasks(&problem.axes, &methods, &[accuracy], Looks::default());
                let mut bench = Bench::default();
                let answers = here(&mut bench, &tasks, &choices, 1, None, &Quiet, &mut |_, _| ());
                prop_assert_eq!(answers.unwrap().len(), 2);
            }
            Err(error) => assert_clear(&error.to_string(), "`", 1),
        }
    }
}

/// Goal: every place that may hold the length of a dataset is believed only as far as the file goes.
#[test]
fn a_header_that_claims_a_trillion_entries_allocates_nothing() {
    let shipped = files(&["tests/data/fclib"], "hdf5").remove(0);
    for at in (0..shipped.len() - 8).step_by(8) {
        let mut bytes = shipped.clone();
        bytes[at..at + 8].copy_from_slice(&1_000_000_000_000_u64.to_le_bytes());
        read_problem(bytes);
    }
}

/// Goal: whatever a program from outside answers is a verdict.
#[cfg(unix)]
#[test]
fn any_answer_of_a_program_is_a_verdict() {
    use proptest::test_runner::TestRunner;
    let dir = tempfile::tempdir().unwrap();
    let program = super::outside::called(dir.path(), "any");
    let choice = Choice::parse(&format!("exec:{}", program.display())).unwrap();
    let texts = |text: &str| any_text(vec![text.as_bytes().to_vec()]);
    let answers = (
        texts("4 -2\n"),
        texts("iterations = 12\nseconds = 1.5e-3\nstatus = stalled\n"),
    );
    let mut runner = TestRunner::new(inputs(30));
    runner
        .run(&answers, |(answer, said)| {
            std::fs::write(dir.path().join("any.answer"), answer).unwrap();
            std::fs::write(dir.path().join("any.said"), said).unwrap();
            let verdict = super::outside::judged(&choice).verdict.to_string();
            let kinds = ["solved", "false-claim", "crashed: ", "gave-up: "];
            prop_assert!(
                kinds.iter().any(|kind| verdict.starts_with(kind)),
                "{verdict}"
            );
            prop_assert!(
                verdict.len() < 300 && !verdict.contains(char::is_control),
                "{verdict:?}"
            );
            Ok(())
        })
        .unwrap();
}
