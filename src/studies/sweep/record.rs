//! What a cell leaves behind: one record, one file.
//!
//! What was found is a function of the cell and the program alone; what was spent belongs to the machine and the moment.
//! The two are kept apart, so that a rerun can be compared bit by bit.

use std::fmt;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::statistics::{Timing, larger};
use crate::model::errors::Deviation;
use crate::run::provenance::Provenance;
use crate::run::verdict::Verdict;
use crate::studies::convergence::Value;
use crate::studies::exchange::problem_file::OperatorSize;

/// Version of the record files and of the tables made from them.
pub const SCHEMA: u32 = 4;

/// One cell, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the format, [`SCHEMA`].
    pub schema: u32,
    /// [`Cell::id`].
    pub id: String,
    /// What was measured.
    pub cell: Cell,
    /// By which program on which machine.
    pub origin: Origin,
    /// Limits that ended it, where the verdict is `timed-out` or `out-of-memory`: it says something about them alone.
    pub limits: Option<Limits>,
    /// What came out; the same on every run of the same program, but for limits.
    pub found: Found,
    /// Times and memory; present beside an honest verdict on a machine that had nothing else to do.
    pub spent: Option<Spent>,
}

impl Record {
    /// What this program found and spent on this machine, under no limits.
    pub(super) fn here(cell: &Cell, found: Found, spent: Option<Spent>) -> Self {
        Self {
            schema: SCHEMA,
            id: cell.id(),
            cell: cell.clone(),
            origin: Origin::here(),
            limits: None,
            found,
            spent,
        }
    }
}

/// Limits on one cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Wall-clock time with set-up and repeats [s].
    pub seconds: f64,
    /// Address space of the process [MB]; none: unlimited.
    pub memory_mb: Option<u64>,
}

/// Program and machine.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Origin {
    /// Version of this crate.
    pub version: String,
    /// Git commit of the sources, or `unknown`.
    pub commit: String,
    /// Whether the sources differed from it: `true`, `false` or `unknown`.
    pub dirty: String,
    /// Digest of the sources, which a commit with further changes does not tell.
    pub sources: String,
    /// Compiler.
    pub rustc: String,
    /// `debug` or `release`.
    pub profile: String,
    /// Operating system and processor model.
    pub machine: String,
}

impl Origin {
    /// This program on this machine; found out once.
    pub fn here() -> Self {
        static HERE: OnceLock<Origin> = OnceLock::new();
        HERE.get_or_init(Self::collect).clone()
    }

    fn collect() -> Self {
        let build = Provenance::collect(1);
        Self {
            version: build.version,
            commit: build.commit,
            dirty: build.dirty,
            sources: env!("STICKSLIP_BUILD_SOURCES").into(),
            rustc: build.rustc,
            profile: build.profile,
            machine: format!("{}, {}", build.os, build.cpu),
        }
    }

    /// Names and values of all parts.
    fn parts(&self) -> [(&'static str, &str); 7] {
        [
            ("version", &self.version),
            ("commit", &self.commit),
            ("uncommitted changes", &self.dirty),
            ("sources", &self.sources),
            ("compiler", &self.rustc),
            ("profile", &self.profile),
            ("machine", &self.machine),
        ]
    }

    /// The first difference from another origin: what, here, there.
    pub fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        let mut pairs = self.parts().into_iter().zip(other.parts());
        let ((what, own), (_, others)) = pairs.find(|((_, own), (_, others))| own != others)?;
        Some((what, own.to_owned(), others.to_owned()))
    }
}

impl fmt::Display for Origin {
    /// `version 0.1.0, commit …, machine …`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.parts().map(|(name, value)| format!("{name} {value}"));
        f.write_str(&parts.join(", "))
    }
}

/// What came out of a cell. Numbers that do not exist are absent, in a file `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Claim × check over the whole load path: that of the last increment, which is the first that is not honest.
    pub verdict: Verdict,
    /// Label of the method in tables.
    pub method: String,
    /// Whether the limit of the method are the contact laws.
    pub exact: bool,
    /// What was solved; absent where the cell ended before that was known.
    pub problem: Option<ProblemSize>,
    /// Increment by increment.
    pub increments: Vec<IncrementFound>,
    /// Distance from the converged solution of the same discrete problem; absent without an honest verdict or reference.
    pub solver_error: Option<SolverError>,
    /// Distance from the closed form; empty where the case has none, or without an honest verdict.
    pub deviations: Vec<Deviation>,
    /// Quantities of interest at the end of the path, for cases without closed form; empty without an honest verdict.
    pub values: Vec<Value>,
}

/// Size of a discrete problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProblemSize {
    /// Mesh label, e.g. `22x22`.
    pub mesh: String,
    /// Contact space with its marks, as in `runs.csv`.
    pub space: String,
    /// Largest distance of neighbouring grid lines [m]; 0 of a problem file.
    pub h_m: f64,
    /// Dimension of the body.
    pub dim: usize,
    /// Free displacement unknowns.
    pub dofs: usize,
    /// Contact points.
    pub points: usize,
    /// Contact unknowns.
    pub unknowns: usize,
    /// The operator of a problem file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operator: Option<OperatorSize>,
}

/// One increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IncrementFound {
    /// Its verdict.
    pub verdict: Verdict,
    /// Natural map found by the judge [-].
    pub natural_map: Option<f64>,
    /// Largest violation of the contact laws, of which the natural map is one [-].
    pub violation: Option<f64>,
    /// Iterations of the method.
    pub iterations: usize,
    /// Solves with the factor of K.
    pub solves: usize,
    /// Dense factorisations of condensed matrices.
    pub tangent_factorisations: usize,
    /// Sparse factorisations over all unknowns.
    pub global_factorisations: usize,
    /// Evaluations of the contact law at one point.
    pub local_solves: usize,
    /// Changes of a point between open, stick and slip from iterate to iterate, summed.
    pub state_changes: usize,
    /// Contact points that end in another state than the one they began the increment in.
    pub final_changes: usize,
}

/// Distance from the converged solution of the same discrete problem: the largest over the increments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolverError {
    /// Method that found the converged solution.
    pub reference: String,
    /// Its natural map, the largest over the increments [-].
    pub reference_natural_map: f64,
    /// ‖u − u*‖_K / ‖u*‖_K [-].
    pub energy: f64,
    /// |P − P*| / |P*| [-].
    pub force: f64,
    /// max |[[u]] − [[u]]*| / max |u*| [-].
    pub jump: f64,
}

/// Times and memory of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Mesh, cracks, sparsity pattern and elimination order [s]. This and the next three are measured once per body.
    pub setup_s: f64,
    /// Assembly of K [s].
    pub assembly_s: f64,
    /// Factorisation of K [s].
    pub factorisation_s: f64,
    /// Condensation to the contact points [s].
    pub condensation_s: f64,
    /// Preparation of the method.
    pub prepare: Timing,
    /// All increments of the path.
    pub solve: Timing,
    /// Of these, without load solves, recovery of displacements and checks of equilibrium.
    pub enforcement: Timing,
    /// Enforcement by the account of a program from outside, where it gives one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reported: Option<Timing>,
    /// Tables and fields of the last increment, in memory [s].
    pub output_s: f64,
    /// Largest resident memory of the process from the mesh to the end of the repeats [MB]; absent where the system does
    /// not tell.
    pub peak_mb: Option<f64>,
}

/// Times of a method, taken in turn with others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// As in [`Spent`].
    pub prepare: Timing,
    /// As in [`Spent`].
    pub solve: Timing,
    /// As in [`Spent`].
    pub enforcement: Timing,
    /// As in [`Spent`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reported: Option<Timing>,
}

impl Record {
    /// The record with times in place of those of one pass; a method that broke on the way has none.
    pub fn retimed(mut self, times: Result<Times, Verdict>) -> Self {
        match times {
            Ok(times) => {
                if let Some(spent) = &mut self.spent {
                    spent.prepare = times.prepare;
                    spent.solve = times.solve;
                    spent.enforcement = times.enforcement;
                    spent.reported = times.reported;
                }
            }
            Err(verdict) => {
                let Found { method, exact, .. } = self.found;
                (self.found, self.spent) = (Found::only(verdict, method, exact), None);
            }
        }
        self
    }
}

impl Found {
    /// A cell of which only the verdict is known.
    pub fn only(verdict: Verdict, method: String, exact: bool) -> Self {
        Self {
            verdict,
            method,
            exact,
            problem: None,
            increments: Vec::new(),
            solver_error: None,
            deviations: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Whether another record has the same bits: NaN is like NaN.
    pub fn same_bits(&self, other: &Self) -> bool {
        let text = |found| serde_json::to_string(found).ok();
        text(self) == text(other)
    }

    /// Largest natural map over the increments; NaN where one has none.
    pub fn natural_map(&self) -> f64 {
        self.worst(|i| i.natural_map)
    }

    /// Largest violation over the increments; NaN where one has none.
    pub fn violation(&self) -> f64 {
        self.worst(|i| i.violation)
    }

    fn worst(&self, of: fn(&IncrementFound) -> Option<f64>) -> f64 {
        let found = self.increments.iter().map(|i| of(i).unwrap_or(f64::NAN));
        found.fold(0.0, larger)
    }

    /// A counter summed over the increments.
    pub fn sum(&self, counter: fn(&IncrementFound) -> usize) -> usize {
        self.increments.iter().map(counter).sum()
    }
}
