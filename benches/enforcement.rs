//! Time of every method on the paper's problems: preparation and one increment, K factored and condensed before.

use std::time::Duration;

use criterion::{BatchSize, BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use stickslip::harness::body::{Body, Needs};
use stickslip::harness::loading::Loading;
use stickslip::harness::shipped;
use stickslip_methods::{
    ContactState, ContactSystem, Increment, Load, METHODS, Options, Silent, Tier,
};

/// Case and friction coefficient.
const PROBLEMS: [(&str, f64); 4] = [
    ("plate_mesh1", 0.1),
    ("plate_mesh1", 1.2),
    ("beam_model2", 0.0),
    ("beam_model2", 0.1),
];

fn enforcement(criterion: &mut Criterion) {
    for (name, friction) in PROBLEMS {
        let case = match shipped::find(name) {
            Some(Ok(case)) => case,
            other => panic!("{name}: {other:?}"),
        };
        let needs = Needs {
            traction: true,
            ..Needs::default()
        };
        let body = Body::new(&case, 1, needs).expect("shipped cases can be discretised");
        let frictions = vec![friction; body.points.len()];
        let system =
            ContactSystem::new(body.elastic.clone(), frictions).expect("friction is valid");
        system.condense().expect("the body is held");
        let loading = Loading::new(&body, &case, friction).expect("no closed form is asked for");
        let load = loading.at(case.path.increments);
        let nothing = Load::zero(&body.elastic);
        let start = ContactState::zero(&system);
        let mut group = criterion.benchmark_group(format!("enforcement/{name}"));
        group
            .sample_size(10)
            .sampling_mode(SamplingMode::Flat)
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(2));
        for method in METHODS {
            let build = || {
                let options = Options::new(method.options, &[]).expect("defaults are valid");
                (method.build)(&options).expect("defaults are valid")
            };
            group.bench_function(BenchmarkId::new(method.name, friction), |b| {
                b.iter_batched_ref(
                    build,
                    |solver| {
                        let increment = Increment {
                            system: &system,
                            load: &load,
                            start_load: &nothing,
                            start: &start,
                            index: 0,
                            tolerance: Tier::High.tolerance(),
                        };
                        solver.prepare(&system).expect("K is factored");
                        solver
                            .solve(&increment, &mut Silent)
                            .expect("the input is valid")
                    },
                    BatchSize::PerIteration,
                );
            });
        }
        group.finish();
    }
}

criterion_group!(benches, enforcement);
criterion_main!(benches);
