//! What the benchmarks share: their problems, names and settings.

// Every benchmark uses its own part.
#![allow(dead_code)]

pub mod scene;

use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{Bencher, BenchmarkGroup, BenchmarkId, Criterion, SamplingMode};
use stickslip::case::Case;
use stickslip::case::shipped;

/// Stages before a method starts.
pub const MESH_TO_SYSTEM: &str = "mesh to system";
pub const ASSEMBLY: &str = "assembly";
pub const FACTORISATION: &str = "factorisation";
pub const CONDENSATION: &str = "condensation";

/// Stages of a method.
pub const PREPARE: &str = "prepare";
pub const ENFORCEMENT: &str = "enforcement";

/// The exact method that follows load paths and stands for all of them from case file to judged result.
pub const EXACT: &str = "hybrid";
/// All methods of the registry together.
pub const ALL_METHODS: &str = "all methods";

/// Name of a benchmark.
pub struct BenchmarkName {
    /// What is measured on which problem, e.g. `enforcement/plate_mesh1 88x88 mu=0.8`.
    pub group: String,
    /// Stage, e.g. `prepare`.
    pub function: String,
    /// Method; empty where there is none.
    pub value: String,
}

impl BenchmarkName {
    fn new(group: String, function: &str, value: &str) -> Self {
        Self {
            group,
            function: function.into(),
            value: value.into(),
        }
    }
}

/// A shipped case on one mesh with one friction coefficient.
pub struct Problem {
    pub case: &'static str,
    pub refine: usize,
    pub friction: f64,
}

/// The founding paper's plate and beam; slip over the whole crack, over a part of it, and of a block along it. Of the
/// shipped friction coefficients the one that takes most iterations; refined where the shipped mesh has a handful of
/// contact points.
pub const PROBLEMS: [Problem; 5] = [
    Problem {
        case: "plate_mesh1",
        refine: 4,
        friction: 0.8,
    },
    Problem {
        case: "beam_model1",
        refine: 1,
        friction: 0.1,
    },
    Problem {
        case: "inclined_crack",
        refine: 4,
        friction: 0.1,
    },
    Problem {
        case: "partial_slip",
        refine: 4,
        friction: 0.5,
    },
    Problem {
        case: "sliding_block_embedded",
        refine: 3,
        friction: 0.2,
    },
];

impl Problem {
    pub fn case(&self) -> Case {
        match shipped::find(self.case) {
            Some(Ok(case)) => case,
            other => panic!("{}: {other:?}", self.case),
        }
    }

    /// Case and mesh, e.g. `plate_mesh1 88x88`.
    fn mesh(&self) -> String {
        let lines = self.case().mesh.grid.refined(self.refine).lines;
        let cells: Vec<String> = lines.iter().map(|l| (l.len() - 1).to_string()).collect();
        format!("{} {}", self.case, cells.join("x"))
    }

    /// A stage before a method starts.
    pub fn discretisation(&self, stage: &str) -> BenchmarkName {
        BenchmarkName::new(format!("discretisation/{}", self.mesh()), stage, "")
    }

    /// A stage of a method.
    pub fn enforcement(&self, stage: &str, method: &str) -> BenchmarkName {
        let group = format!("enforcement/{} mu={}", self.mesh(), self.friction);
        BenchmarkName::new(group, stage, method)
    }

    /// The case as shipped, with all its meshes and friction coefficients.
    pub fn end_to_end(&self, methods: &str) -> BenchmarkName {
        BenchmarkName::new(format!("end_to_end/{}", self.case), methods, "")
    }
}

/// Before every benchmark.
pub const WARM_UP: Duration = Duration::from_millis(100);
/// For the samples of a benchmark together, where ten calls do not take longer.
pub const MEASUREMENT: Duration = Duration::from_millis(300);

/// Whether a case runs end to end with all methods too.
pub fn runs_all_methods(problem: &Problem) -> bool {
    problem.case == "plate_mesh1"
}

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

/// Makes every stage run on one thread, as the methods do.
pub fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build_global().expect("no thread pool was used before");
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

/// Says that a benchmark is not run.
pub fn left_out(name: &BenchmarkName, why: &dyn std::fmt::Display) {
    let BenchmarkName {
        group,
        function,
        value,
    } = name;
    println!("left out: {group}/{function}/{value}: {why}");
}
