//! Problems of the benchmarks, and the name of every measurement on them.

pub mod scene;

use stickslip::case::Case;
use stickslip::case::shipped;

/// Stages before a method starts: everything to the system of equations.
pub const MESH_TO_SYSTEM: &str = "mesh to system";
/// Assembly of K, a part of the stage above.
pub const ASSEMBLY: &str = "assembly";
/// Factorisation of K.
pub const FACTORISATION: &str = "factorisation";
/// Condensation to the contact points.
pub const CONDENSATION: &str = "condensation";

/// Work of a method once for a system.
pub const PREPARE: &str = "prepare";
/// The solve of an increment without the work on all unknowns of the body.
pub const ENFORCEMENT: &str = "enforcement";

/// The exact method that follows load paths and stands for all of them from case file to judged result.
pub const EXACT: &str = "hybrid";
/// All methods of the registry together.
pub const ALL_METHODS: &str = "all methods";

/// Name of a benchmark.
pub struct BenchmarkName {
    /// Name of the measurement and its problem, e.g. `enforcement/plate_mesh1 88x88 mu=0.8`.
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
    /// Name of the case.
    pub case: &'static str,
    /// Cells along each cell of the shipped mesh.
    pub refine: usize,
    /// Friction coefficient μ.
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
    /// The shipped case.
    ///
    /// # Panics
    ///
    /// If no case of that name is shipped.
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

/// Makes every stage run on one thread, as the methods do.
pub fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build_global().expect("no thread pool was used before");
}

/// Says that a benchmark is not run.
pub fn left_out(name: &BenchmarkName, why: &dyn std::fmt::Display) {
    let (group, function) = (&name.group, &name.function);
    println!("left out: {group}/{function}/{}: {why}", name.value);
}
