//! Time of every method on every problem: preparation, and enforcement on the hardest increment of the load path to 1e-9,
//! which is its solution without load solve, recovery of displacements and checks of equilibrium.
//!
//! K is factored and condensed before, and every solve starts with an instance that has seen nothing, so that nothing it
//! keeps is paid for by an earlier sample. A method is timed only if the judge has accepted its answer. Preparation has
//! nothing left to do for a method that only needs K: its nanoseconds say so.

mod common;

use std::time::Duration;

use common::{MEASUREMENT, WARM_UP, bench, group, settings};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use stickslip::run::choice::Choice;
use stickslip_timing::scene::Scene;
use stickslip_timing::{ENFORCEMENT, PREPARE, PROBLEMS, left_out};

/// For what takes nanoseconds.
const SHORT: Duration = Duration::from_millis(20);

fn enforcement(criterion: &mut Criterion) {
    let choices = Choice::all().expect("defaults are valid");
    for problem in &PROBLEMS {
        let scene = Scene::new(problem);
        let mut group = group(criterion, &problem.enforcement("", "").group);
        for choice in &choices {
            let name = |stage| problem.enforcement(stage, choice.name());
            let verdict = scene.judge(choice);
            if !verdict.is_honest() {
                left_out(&name(ENFORCEMENT), &verdict);
                continue;
            }
            group.warm_up_time(SHORT).measurement_time(SHORT);
            bench(&mut group, &name(PREPARE), |b| {
                b.iter_batched_ref(
                    || scene.build(choice),
                    |solver| scene.prepare(solver.as_mut()),
                    BatchSize::SmallInput,
                );
            });
            group.warm_up_time(WARM_UP).measurement_time(MEASUREMENT);
            bench(&mut group, &name(ENFORCEMENT), |b| {
                b.iter_custom(|calls| {
                    let mut solvers: Vec<_> = (0..calls).map(|_| scene.solver(choice)).collect();
                    let own = solvers.iter_mut();
                    own.map(|solver| scene.enforcement(solver)).sum()
                });
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = settings();
    targets = enforcement
}
criterion_main!(benches);
