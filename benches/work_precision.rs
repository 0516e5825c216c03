//! Gathers what the benchmarks measured into `reports/bench/`: `timings.csv`, tables, provenance.
//!
//! No benchmark itself, but a target like them, so that one `cargo bench` measures and reports; cargo runs targets by name.
//! It succeeds with whatever results there are. Under `cargo test --benches` or with `--test` it does all the same on the
//! smallest problem and writes into a temporary folder. All other arguments are criterion's and ignored.

mod common;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use common::scene::Scene;
use common::{
    ALL_METHODS, EXACT, PREPARE, PROBLEMS, Problem, SOLVE, STAGES, one_thread, runs_all_methods,
};
use stickslip::harness::run::Choice;
use stickslip::report::timings::{self, BenchmarkName, Expected, Ignored, harvest, last_built};
use stickslip::report::{Bundle, Provenance, prepare_output};

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
        let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/bench");
        (&PROBLEMS[..], criterion_home(), reports)
    } else {
        let out = scratch.path().join("reports");
        (&PROBLEMS[4..], scratch.path().join("criterion"), out)
    };
    prepare_output(&out)?;

    let mut bundle = Bundle::new();
    add_timings(&mut bundle, &home, problems)?;
    // Further studies of the bench run add their files to the bundle here.
    let provenance = Provenance::collect(1).with_option("arguments", arguments.join(" "));
    provenance.add_to(&mut bundle)?;
    bundle.commit(&out)?;
    for path in bundle.paths() {
        println!("wrote {}", out.join(path).display());
    }
    Ok(())
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
    let mut expect = |name: BenchmarkName, verdict: String, newer_than| {
        expected.push(Expected {
            name,
            verdict,
            newer_than,
        });
    };
    let choices = Choice::all()?;
    for problem in problems {
        for stage in STAGES {
            expect(problem.discretisation(stage), String::new(), discretisation);
        }
        expect(problem.end_to_end(EXACT), String::new(), end_to_end);
        if runs_all_methods(problem) {
            expect(problem.end_to_end(ALL_METHODS), String::new(), end_to_end);
        }
        let scene = Scene::new(problem);
        for choice in &choices {
            let verdict = scene.judge(choice);
            if verdict.is_honest() {
                for stage in [PREPARE, SOLVE] {
                    let name = problem.enforcement(stage, choice.method.name);
                    expect(name, verdict.to_string(), enforcement);
                }
            }
        }
    }
    Ok(expected)
}
