//! Time to discretise, factor and condense; everything before a method starts.

mod common;

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use common::{bench, group, settings};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use stickslip::model::body::{Body, Needs};
use stickslip_methods::ContactSystem;
use stickslip_timing::{ASSEMBLY, CONDENSATION, FACTORISATION, MESH_TO_SYSTEM, PROBLEMS};

fn discretisation(criterion: &mut Criterion) {
    for problem in &PROBLEMS {
        let case = problem.case();
        let body = || {
            Body::new(&case, problem.refine, &Needs::default())
                .expect("shipped cases can be discretised")
        };
        let factorise = |body: &mut Body| body.elastic.factorise().expect("K is regular");
        let factored = || {
            let mut body = body();
            factorise(&mut body);
            let friction = vec![problem.friction; body.points.len()];
            ContactSystem::new(Arc::clone(&body.elastic), friction).expect("friction is valid")
        };
        let name = |stage| problem.discretisation(stage);
        let mut group = group(criterion, &name("").group);
        bench(&mut group, &name(MESH_TO_SYSTEM), |b| {
            b.iter_with_large_drop(&body);
        });
        bench(&mut group, &name(ASSEMBLY), |b| {
            // A part of the stage above, which tells its time itself.
            let assembly_s = || black_box(body()).setup.assembly_s;
            b.iter_custom(|calls| Duration::from_secs_f64((0..calls).map(|_| assembly_s()).sum()));
        });
        bench(&mut group, &name(FACTORISATION), |b| {
            b.iter_batched_ref(body, factorise, BatchSize::PerIteration);
        });
        bench(&mut group, &name(CONDENSATION), |b| {
            let condense = |system: &mut ContactSystem| system.condense().expect("it is held");
            b.iter_batched_ref(factored, condense, BatchSize::PerIteration);
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = settings();
    targets = discretisation
}
criterion_main!(benches);
