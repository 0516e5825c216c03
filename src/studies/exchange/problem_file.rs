//! Runs of methods on problems from interchange files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};
use stickslip_methods::{ContactSystem, Load, MethodError};

use crate::files::interchange::{InterchangeError, LocalProblem, Problem, fclib};
use crate::files::visible::visible;
use crate::model::body::Setup;
use crate::model::errors::Deviation;
use crate::studies::exchange::{System, global_system, local_system};

/// Rigid motions a local problem may have: those of ten bodies in space. Methods hold them dense, so that without a
/// bound an empty V would take memory that grows with the square of the file.
pub const MOST_MOTIONS: usize = 60;

/// Longest name of a problem [bytes]: files of its solutions have longer ones, and file systems take 255.
const MAX_NAME: usize = 200;

/// Most rows of which the rank is found out: that takes as long as tens of factorisations.
const MOST_RANKED: usize = 2000;

/// Size of the operator of a problem of a collection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OperatorSize {
    /// `local` or `global`.
    pub kind: String,
    /// Entries of W (global: of M) that the file stores, those at one position once.
    pub entries: usize,
    /// max |w_ij − w_ji| / max |w_ij| of it.
    pub asymmetry: f64,
    /// Rows of W, the tangential ones of points without friction too.
    pub rows: usize,
    /// Rigid motions.
    pub motions: usize,
    /// Numerical rank of W: singular values above 1e-10 of the largest; absent with more than 2000 rows.
    pub rank: Option<usize>,
}

/// A problem read and turned into a system.
pub struct ProblemFile {
    /// `local` or `global`.
    pub kind: &'static str,
    /// The body with its friction coefficients.
    pub system: ContactSystem,
    /// Nothing, and what acts on it.
    pub loads: [Load; 2],
    /// Time for reading.
    pub setup: Setup,
    /// Stored entries of W or M, and how far it is from symmetric in the file.
    stored: (usize, f64),
    /// Reactions that the file says are the solution, and what their distance is measured in.
    solution: Option<(Vec<f64>, f64)>,
}

/// Why a file cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ProblemFileError {
    /// Reading.
    #[error(transparent)]
    Interchange(#[from] InterchangeError),
    /// A singular M: its kernel is not in the file.
    #[error(
        "`{}`: M is singular at unknown {unknown} of {size}: a global file cannot tell rigid motions, solve the \
         local problem instead",
        path.display()
    )]
    Singular {
        /// Which file.
        path: PathBuf,
        /// Unknown whose pivot is not positive.
        unknown: usize,
        /// Number of unknowns.
        size: usize,
    },
    /// The numbers make no system.
    #[error("`{}`: {source}", path.display())]
    System {
        /// Which file.
        path: PathBuf,
        /// The fault, in words.
        source: MethodError,
    },
}

impl ProblemFileError {
    /// The fault without the path: where it lies says nothing about a problem.
    pub fn reason(&self, path: &Path) -> String {
        let quoted = format!("`{}`", path.display());
        let text = self.to_string();
        match text.strip_prefix(&format!("{quoted}: ")) {
            Some(rest) => rest.to_owned(),
            None => text.replace(&quoted, &format!("`{}`", file_name(path))),
        }
    }
}

impl ProblemFile {
    /// Reads a file; its name is that of the file.
    ///
    /// # Errors
    /// [`ProblemFileError`], naming the file.
    pub fn read(path: &Path) -> Result<Self, ProblemFileError> {
        Self::of(path, &file_name(path), fclib::read(path)?)
    }

    /// The bytes of a file, for a problem of that name.
    ///
    /// # Errors
    /// [`ProblemFileError`], naming the file.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>, name: &str) -> Result<Self, ProblemFileError> {
        Self::of(path, name, fclib::from_bytes(path, bytes)?)
    }

    fn of(path: &Path, name: &str, problem: Problem) -> Result<Self, ProblemFileError> {
        let clock = Instant::now();
        if name.len() > MAX_NAME {
            let what = format!(
                "its name has {} bytes, at most {MAX_NAME} are taken",
                name.len()
            );
            return Err(InterchangeError::refused(path, what).into());
        }
        refuse_unsupported(path, &problem)?;
        let failed = |source| match source {
            MethodError::NotPositiveDefinite { unknown, size } => ProblemFileError::Singular {
                path: path.into(),
                unknown,
                size,
            },
            source => ProblemFileError::System {
                path: path.into(),
                source,
            },
        };
        let operator = match &problem {
            Problem::Local(problem) => &problem.w,
            Problem::Global(problem) => &problem.m,
        };
        let asymmetry = operator.as_square().map_err(failed)?.asymmetry();
        let stored = (operator.len(), asymmetry);
        let solution = match &problem {
            Problem::Local(own) => own
                .solution
                .as_ref()
                .map(|s| (s.r.clone(), force_scale(own, &s.r))),
            Problem::Global(_) => None,
        };
        let (kind, system) = match &problem {
            Problem::Local(problem) => ("local", local_system(problem)),
            Problem::Global(problem) => ("global", global_system(problem)),
        };
        let System {
            elastic,
            friction,
            load,
        } = system.map_err(failed)?;
        // A singular M is bad input for every method; what the factor costs is counted as such all the same.
        elastic.factorise().map_err(failed)?;
        let system = ContactSystem::new(elastic, friction).map_err(failed)?;
        let shared = system.elastic().timings();
        let factor_s = shared.analysis_s + shared.factorisation_s;
        Ok(Self {
            kind,
            loads: [Load::zero(system.elastic()), load],
            system,
            stored,
            solution,
            setup: Setup {
                setup_s: (clock.elapsed().as_secs_f64() - factor_s).max(0.0),
                assembly_s: 0.0,
                traction_s: 0.0,
            },
        })
    }

    /// The operator in numbers; W is formed for its rank.
    ///
    /// # Errors
    /// Those of the condensation.
    pub fn operator(&self) -> Result<OperatorSize, MethodError> {
        let elastic = self.system.elastic();
        let rows = self.loads[1].offset.len();
        let ranked = (rows <= MOST_RANKED).then(|| elastic.rank());
        let (entries, asymmetry) = self.stored;
        Ok(OperatorSize {
            kind: self.kind.into(),
            entries,
            asymmetry,
            rows,
            motions: elastic.floating().len(),
            rank: ranked.transpose()?.flatten(),
        })
    }

    /// Distance of reactions from those that the file says are the solution, |r − r*| / max(|r*|, ρ |q|); nothing where it has none.
    pub fn deviations(&self, reactions: &[f64]) -> Vec<Deviation> {
        let Some((known, scale)) = &self.solution else {
            return Vec::new();
        };
        let apart: Vec<f64> = reactions
            .iter()
            .zip(known)
            .map(|(r, known)| r - known)
            .collect();
        vec![Deviation {
            quantity: REACTIONS.to_owned(),
            at: String::new(),
            found: norm(reactions),
            exact: norm(known),
            error: norm(&apart) / scale,
        }]
    }
}

/// Name of the deviation of reactions.
pub const REACTIONS: &str = "reactions";

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Reference of forces: the known ones, or those that the free velocity would take.
fn force_scale(problem: &LocalProblem, known: &[f64]) -> f64 {
    let rows = problem.q.len();
    let trace: f64 = (0..rows).map(|k| problem.w.get(k, k)).sum();
    norm(known).max(rows as f64 / trace * norm(&problem.q))
}

/// File name without the extensions HDF5 files have.
pub fn file_name(path: &Path) -> String {
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy();
    let stem = [".hdf5", ".h5"]
        .iter()
        .find_map(|end| name.strip_suffix(end));
    visible(stem.unwrap_or(&name))
}

fn refuse_unsupported(path: &Path, problem: &Problem) -> Result<(), InterchangeError> {
    let unsupported = |what: &str| Err(InterchangeError::refused(path, what));
    let (name, operator) = match problem {
        Problem::Local(problem) => ("W", &problem.w),
        Problem::Global(problem) => ("M", &problem.m),
    };
    if matches!(operator.sides(), [true, false] | [false, true]) {
        return unsupported(&format!(
            "{name} holds one triangle: store it in full, or say `symmetric_packed = 1`"
        ));
    }
    match problem {
        Problem::Local(problem) => {
            let Some(equality) = &problem.equality else {
                return Ok(());
            };
            let (motions, rows) = (equality.v.cols(), problem.q.len());
            if motions > MOST_MOTIONS.min(rows) {
                return unsupported(&format!(
                    "V has {motions} columns: with {rows} rows at most {} rigid motions are solved",
                    MOST_MOTIONS.min(rows)
                ));
            }
            if equality.r.entries().any(|e| e.2 != 0.0) {
                return unsupported(
                    "R is not zero: only rigid motions (Vᵀ r + s = 0) are solved, not other unknowns",
                );
            }
            Ok(())
        }
        Problem::Global(problem) if problem.equality.is_some() => {
            unsupported("G is present: eliminate the equality constraints Gᵀ v + b = 0 first")
        }
        Problem::Global(_) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::interchange::{Info, LocalEquality, SparseMatrix};

    #[test]
    fn more_rigid_motions_than_bodies_have_are_refused_before_they_are_expanded() {
        for (points, motions, refusal) in [
            (2000, 6000, Some("6000 columns: with 6000 rows at most 60 ")),
            (1, 4, Some("4 columns: with 3 rows at most 3 ")),
            (20, 60, None),
        ] {
            let rows = 3 * points;
            let empty = |rows| SparseMatrix::from_triplets(rows, motions, []).unwrap();
            let problem = Problem::Local(LocalProblem {
                dim: 3,
                w: SparseMatrix::from_triplets(rows, rows, []).unwrap(),
                q: vec![0.0; rows],
                mu: vec![0.3; points],
                equality: Some(LocalEquality {
                    v: empty(rows),
                    r: empty(motions),
                    s: vec![0.0; motions],
                }),
                info: Info::default(),
                solution: None,
                guesses: Vec::new(),
            });
            // Through the file, so that reading takes what it is said to take.
            let path = Path::new("many.hdf5");
            let read = fclib::from_bytes(path, problem.to_bytes().unwrap()).unwrap();
            match (refuse_unsupported(path, &read), refusal) {
                (Err(error), Some(part)) => assert!(error.to_string().contains(part), "{error}"),
                (found, expected) => assert_eq!(found.is_ok(), expected.is_none(), "{found:?}"),
            }
        }
    }
}
