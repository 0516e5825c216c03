//! Instructions that every method executes to solve the plate and the beam: a measure of work that does not change with the
//! load of the machine. One executable gives the same counts in every run; only methods that call clarabel (`socp`,
//! `tresca`) move, by some ten instructions of 10⁸. Another build of the same source may shift them by half a percent.
//!
//! ```text
//! cargo install gungraun-runner --version 0.20.0        # the version of gungraun in Cargo.lock
//! cargo bench --features callgrind --bench instructions
//! ```
//!
//! Needs valgrind (package `valgrind`) and `gungraun-runner` of the same version as the library in the path; without them it
//! says so and fails. Every method runs once, in a process of its own, from the state in which `enforcement` starts its
//! timer; nothing before is counted. Only what the judge accepts is counted, anything else ends the run. Counts are of
//! instructions executed, not of time: valgrind's processor has no AVX-512, and a cache miss costs nothing. Results are
//! numbered by the order of the registry, which is printed first; they stay in `target/gungraun`, with the change since the
//! last run.

// The macros make public items without documentation.
#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Once;

use gungraun::{
    Callgrind, LibraryBenchmarkConfig, library_benchmark, library_benchmark_group, main,
};
use stickslip::run::choice::Choice;
use stickslip::run::registry;
use stickslip_methods::{Enforcement, Outcome};
use stickslip_timing::scene::Scene;
use stickslip_timing::{PROBLEMS, Problem, one_thread};

/// A method in front of its increment.
type Ready = (Scene, Box<dyn Enforcement>);

/// Names of all methods; once per process it prints which number is whose.
fn methods() -> impl Iterator<Item = &'static str> {
    static PRINTED: Once = Once::new();
    PRINTED.call_once(|| {
        for (number, method) in registry::methods().iter().enumerate() {
            println!("plate_{number}, beam_{number}: {}", method.name);
        }
    });
    registry::methods().iter().map(|method| method.name)
}

/// Instructions only: the model of a cache says little about a machine's, and its counts change with addresses.
fn instructions_only() -> LibraryBenchmarkConfig {
    let mut config = LibraryBenchmarkConfig::default();
    config.tool(Callgrind::with_args(["--cache-sim=no"]));
    config
}

fn ready(problem: &Problem, name: &str) -> Ready {
    one_thread();
    let choice =
        Choice::new(registry::method(name).expect("registered"), &[]).expect("defaults are valid");
    let scene = Scene::new(problem);
    let verdict = scene.judge(&choice);
    assert!(verdict.is_honest(), "{}, {name}: {verdict}", problem.case);
    let mut solver = scene.build(&choice);
    scene.prepare(solver.as_mut());
    (scene, solver)
}

fn plate(name: &str) -> Ready {
    ready(&PROBLEMS[0], name)
}

fn beam(name: &str) -> Ready {
    ready(&PROBLEMS[1], name)
}

#[library_benchmark]
#[benches::plate(iter = methods(), setup = plate)]
#[benches::beam(iter = methods(), setup = beam)]
fn solve((scene, mut solver): Ready) -> (Ready, Outcome) {
    let outcome = black_box(scene.solve(solver.as_mut()));
    // Handed back: taking them apart is no work of the method.
    ((scene, solver), outcome)
}

library_benchmark_group!(name = enforcement, benchmarks = solve);
main!(
    config = instructions_only(),
    library_benchmark_groups = enforcement
);
