//! Time to discretise, factor and condense the paper's bodies; everything before a method starts.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BatchSize, BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use stickslip::harness::body::{Body, Needs};
use stickslip::harness::shipped;
use stickslip_methods::ContactSystem;

/// Case and refinement factor.
const BODIES: [(&str, usize); 4] = [
    ("plate_mesh1", 1),
    ("plate_mesh1", 4),
    ("beam_model1", 1),
    ("beam_model2", 1),
];

fn discretisation(criterion: &mut Criterion) {
    for (name, refine) in BODIES {
        let case = match shipped::find(name) {
            Some(Ok(case)) => case,
            other => panic!("{name}: {other:?}"),
        };
        let body = || {
            Body::new(&case, refine, Needs::default()).expect("shipped cases can be discretised")
        };
        let mut group = criterion.benchmark_group(format!("discretisation/{name}"));
        group
            .sample_size(10)
            .sampling_mode(SamplingMode::Flat)
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(2));
        group.bench_function(BenchmarkId::new("mesh to system", refine), |b| {
            b.iter(|| black_box(body()));
        });
        let factorise = |body: &Body| body.elastic.factorise().expect("K is regular");
        group.bench_function(BenchmarkId::new("factorisation", refine), |b| {
            b.iter_batched_ref(body, |body| factorise(body), BatchSize::PerIteration);
        });
        let factored = || {
            let body = body();
            factorise(&body);
            let friction = vec![0.3; body.points.len()];
            ContactSystem::new(body.elastic, friction).expect("friction is valid")
        };
        group.bench_function(BenchmarkId::new("condensation", refine), |b| {
            b.iter_batched_ref(
                factored,
                |system| system.condense().expect("the body is held"),
                BatchSize::PerIteration,
            );
        });
        group.finish();
    }
}

criterion_group!(benches, discretisation);
criterion_main!(benches);
