//! Time from the text of a case file to the judged result: all its meshes, friction coefficients and expected numbers, one
//! exact method; of one case all methods.
//!
//! A case is timed only if no run failed and every expected number came out as stated.

mod common;

use common::{bench, group, settings};
use criterion::{Criterion, criterion_group, criterion_main};
use stickslip::case;
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::registry::method;
use stickslip::studies::cases::{Settings, run_case};
use stickslip::studies::results::Results;
use stickslip_timing::{ALL_METHODS, EXACT, PROBLEMS, left_out};

const SETTINGS: Settings = Settings::PLAIN;

/// The case as shipped.
fn run(file: &str, text: &str, choices: &[Choice]) -> Results {
    let case = case::parse(file, text).expect("shipped cases are valid");
    run_case(&case, choices, SETTINGS, &Quiet).expect("shipped cases can be run")
}

fn end_to_end(criterion: &mut Criterion) {
    let exact = Choice::new(method(EXACT).expect("registered"), &[]).expect("defaults are valid");
    let all = Choice::all().expect("defaults are valid");
    for problem in &PROBLEMS {
        let case = problem.case();
        let file = format!("{}.toml", problem.case);
        let mut sets = vec![(EXACT, std::slice::from_ref(&exact))];
        if problem.case == "plate_mesh1" {
            sets.push((ALL_METHODS, &all));
        }
        let mut group = group(criterion, &problem.end_to_end("").group);
        for (methods, choices) in sets {
            let name = problem.end_to_end(methods);
            if !run(&file, &case.source, choices).as_expected() {
                left_out(
                    &name,
                    &"a run failed or an expected number is not as stated",
                );
                continue;
            }
            bench(&mut group, &name, |b| {
                b.iter_with_large_drop(|| run(&file, &case.source, choices));
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = settings();
    targets = end_to_end
}
criterion_main!(benches);
