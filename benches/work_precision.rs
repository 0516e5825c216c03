//! Gathers what the benchmarks measured into `results/bench/`, runs the study of run time against error into
//! `results/study/`, and shows all of `results/` as one page, `results/index.html`.
//!
//! The study is measured afresh every time; its records lie in `target/tmp/study`. It is left out where a filter asks for
//! some benchmarks only.
//!
//! No benchmark itself, but a target like them, so that one `cargo bench` measures and reports; cargo runs targets by name.
//! It succeeds with whatever results there are. Under `cargo test --benches` or with `--test` it does all the same on the
//! smallest problem and writes into a temporary folder. All other arguments are criterion's and ignored.

mod common;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Instant, SystemTime};

use common::scene::Scene;
use common::{
    ALL_METHODS, ENFORCEMENT, EXACT, PREPARE, PROBLEMS, Problem, STAGES, one_thread,
    runs_all_methods,
};
use stickslip::report::page;
use stickslip::report::sweep;
use stickslip::report::timings::{self, BenchmarkName, Expected, Ignored, harvest, last_built};
use stickslip::report::{Bundle, Claim, Provenance, add_provenance, plan};
use stickslip::run::choice::Choice;
use stickslip::run::run_case::Progress;
use stickslip::run::verdict::Verdict;
use stickslip::studies::sweep::conduct::{Conduct, Shard, conduct};
use stickslip::studies::sweep::plan::Plan;
use stickslip::studies::sweep::record::Limits;
use stickslip::studies::sweep::store::Store;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |name: &str| arguments.iter().any(|a| a == name);
    if given("--list") {
        return Ok(());
    }
    one_thread();
    let scratch = tempfile::tempdir()?;
    let full = given("--bench") && !given("--test");
    let (problems, home, out) = if full {
        let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/bench");
        (&PROBLEMS[..], criterion_home(), results)
    } else {
        let out = scratch.path().join("results/bench");
        (&PROBLEMS[4..], scratch.path().join("criterion"), out)
    };
    let claim = Claim::new(&out, plan("bench"), false)?;

    let mut bundle = Bundle::new();
    add_timings(&mut bundle, &home, problems)?;
    let provenance = Provenance::collect(1).with_option("arguments", arguments.join(" "));
    add_provenance(&mut bundle, &provenance)?;
    claim.commit(&bundle)?;
    for path in bundle.paths() {
        println!("wrote {}", out.join(path).display());
    }
    if full && filtered(&arguments) {
        println!("no study: only some benchmarks are asked for");
        return Ok(());
    }
    let reports = out.parent().unwrap_or(&out);
    let (records, sweep) = if full {
        let records = Path::new(env!("CARGO_TARGET_TMPDIR")).join("study");
        if records.exists() {
            std::fs::remove_dir_all(&records)?;
        }
        (records, SWEEP)
    } else {
        (scratch.path().join("study"), SMALLEST)
    };
    study(sweep, &records, &reports.join("study"))?;
    let bytes = page::write(reports)?;
    println!(
        "wrote {}, {bytes} bytes",
        reports.join(page::FILE).display()
    );
    Ok(())
}

/// The sweep of the study.
const SWEEP: &str = include_str!("study.toml");

/// A sweep that takes no time.
const SMALLEST: &str = "
title = \"A small study\"
repeats = { least = 1, most = 1 }
[[cells]]
cases = [\"sliding_block_embedded\"]
refine = [1]
friction = [0.2]
";

/// Options of criterion that are followed by a value.
const WITH_VALUE: [&str; 15] = [
    "--save-baseline",
    "--baseline",
    "--baseline-lenient",
    "--load-baseline",
    "--sample-size",
    "--warm-up-time",
    "--measurement-time",
    "--nresamples",
    "--noise-threshold",
    "--confidence-level",
    "--significance-level",
    "--profile-time",
    "--color",
    "--output-format",
    "--format",
];

/// Whether an argument selects benchmarks.
fn filtered(arguments: &[String]) -> bool {
    let mut before = "";
    for argument in arguments {
        if !argument.starts_with('-') && !WITH_VALUE.contains(&before) {
            return true;
        }
        before = argument;
    }
    false
}

/// Measures a sweep and writes its report.
fn study(sweep: &str, records: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let claim = Claim::new(out, plan("study"), false)?;
    let plan = Plan::parse(Path::new("benches/study.toml"), sweep)?;
    let store = Store::create(records, plan.contents(), false)?;
    let how = Conduct {
        program: Path::new(env!("CARGO_BIN_EXE_stickslip")),
        jobs: 1,
        timed: true,
        limits: Limits {
            seconds: 60.0,
            memory_mb: None,
        },
        shard: Shard::ALL,
        redo: false,
        stop: &AtomicBool::new(false),
    };
    println!(
        "study: {} cells, records in {}",
        plan.tasks.len(),
        records.display()
    );
    let clock = Instant::now();
    conduct(&plan.tasks, plan.repeats, &store, how, &Tenths::default())?;
    println!("study: measured in {:.0} s", clock.elapsed().as_secs_f64());
    let kept = store.records()?;
    let provenance = Provenance::collect(1).with_option("sweep", plan.title.clone());
    claim.commit(&sweep::bundle(&kept, plan.tasks.len(), &provenance)?)?;
    println!("wrote {}", out.display());
    Ok(())
}

/// A line per tenth of the cells.
#[derive(Default)]
struct Tenths {
    planned: AtomicUsize,
    done: AtomicUsize,
}

impl Progress for Tenths {
    fn plan(&self, runs: usize) {
        self.planned.store(runs, Ordering::Relaxed);
    }

    fn done(&self, label: &str) {
        let (done, planned) = (
            self.done.fetch_add(1, Ordering::Relaxed) + 1,
            self.planned.load(Ordering::Relaxed),
        );
        if done * 10 / planned != (done - 1) * 10 / planned {
            println!("study: {done} of {planned}, {label}");
        }
    }
}

/// Where criterion writes, by its own rules.
fn criterion_home() -> PathBuf {
    if let Some(home) = std::env::var_os("CRITERION_HOME") {
        return home.into();
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    // Cargo compiles in the folder for temporary files inside the target folder.
    let compiled = || Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("");
    target.unwrap_or_else(compiled).join("criterion")
}

/// Reads the results of this build and says what there is none of.
fn add_timings(
    bundle: &mut Bundle,
    home: &Path,
    problems: &[Problem],
) -> Result<(), Box<dyn Error>> {
    let found = harvest(home, &expected(problems)?);
    let of = |kind: fn(&Ignored) -> bool| found.ignored.iter().filter(|(_, why)| kind(why)).count();
    println!(
        "{} timings from {}; without a result of this build: {}; left aside: {} of older builds, {} unknown",
        found.rows.len(),
        home.display(),
        found.missing.len(),
        of(|why| *why == Ignored::Stale),
        of(|why| *why == Ignored::Unknown),
    );
    for (path, why) in &found.ignored {
        if let Ignored::Broken(reason) = why {
            println!("unreadable: {}: {reason}", path.display());
        }
    }
    timings::add_to(bundle, &found.rows)?;
    Ok(())
}

/// Benchmarks that belong into the table. What the judge rejects is not among them, whatever criterion has of it.
fn expected(problems: &[Problem]) -> Result<Vec<Expected>, Box<dyn Error>> {
    let executable = std::env::current_exe()?;
    let folder = executable.parent().unwrap_or(Path::new("."));
    // Of a target that was never built nothing counts.
    let built = |target| last_built(folder, target).unwrap_or_else(SystemTime::now);
    let [discretisation, end_to_end, enforcement] =
        ["discretisation", "end_to_end", "enforcement"].map(built);
    let mut expected = Vec::new();
    let mut expect = |name: BenchmarkName, verdict: Option<Verdict>, newer_than| {
        expected.push(Expected {
            name,
            verdict,
            newer_than,
        });
    };
    let choices = Choice::all()?;
    for problem in problems {
        for stage in STAGES {
            expect(problem.discretisation(stage), None, discretisation);
        }
        expect(problem.end_to_end(EXACT), None, end_to_end);
        if runs_all_methods(problem) {
            expect(problem.end_to_end(ALL_METHODS), None, end_to_end);
        }
        let scene = Scene::new(problem);
        for choice in &choices {
            let verdict = scene.judge(choice);
            if verdict.is_honest() {
                for stage in [PREPARE, ENFORCEMENT] {
                    let name = problem.enforcement(stage, choice.name());
                    expect(name, Some(verdict.clone()), enforcement);
                }
            }
        }
    }
    Ok(expected)
}
