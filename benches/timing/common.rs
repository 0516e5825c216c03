//! Settings of Criterion that the benchmarks share.

use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{Bencher, BenchmarkGroup, BenchmarkId, Criterion, SamplingMode};
use stickslip_timing::{BenchmarkName, one_thread};

/// Before every benchmark.
pub const WARM_UP: Duration = Duration::from_millis(100);
/// For the samples of a benchmark together, where ten calls do not take longer.
pub const MEASUREMENT: Duration = Duration::from_millis(300);

/// Settings of all groups: many short measurements, since a solve takes microseconds to half a second. Criterion's own
/// statistics are cheap ones.
pub fn settings() -> Criterion {
    one_thread();
    Criterion::default()
        .sample_size(10)
        .nresamples(2_000)
        .warm_up_time(WARM_UP)
        .measurement_time(MEASUREMENT)
        .without_plots()
}

/// A group of benchmarks of one problem.
pub fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    // As many calls in every sample: set-up may take much longer than what is timed.
    group.sampling_mode(SamplingMode::Flat);
    group
}

/// One benchmark under its name; the group is that of the name.
pub fn bench(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &BenchmarkName,
    routine: impl FnMut(&mut Bencher<'_>),
) {
    if name.value.is_empty() {
        group.bench_function(&name.function, routine);
    } else {
        group.bench_function(BenchmarkId::new(&name.function, &name.value), routine);
    }
}
