//! The discretised body of a cell. Neighbouring cells solve the same problem, so the last body is kept with its factor,
//! and for the last friction coefficients the converged solution.

use std::fs;
use std::path::Path;

use stickslip_methods::ContactSystem;

use super::reference::References;
use crate::case::{self, Case, ContactSpace};
use crate::model::body::{Body, BodyError, Needs};
use crate::model::loading::Loading;
use crate::run::choice::ChoiceError;
use crate::run::run_case::{RunError, warm_up};
use crate::run::verdict::Verdict;
use crate::studies::exchange::problem_file::{OperatorSize, ProblemFile};
use crate::studies::memory;
use crate::studies::sweep::cell::{Cell, digest_of_bytes};

/// Why a cell could not be measured; what a method does wrong is a verdict.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The case or its discretisation.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The method.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// The contact space.
    #[error("unknown contact space `{0}`")]
    Space(String),
    /// A problem file that no method is asked to solve.
    #[error("{0}")]
    File(String),
    /// A problem file that cannot be read any more, or is not the one the sweep was planned with.
    #[error("{0}")]
    Gone(String),
}

impl From<BodyError> for MeasureError {
    fn from(error: BodyError) -> Self {
        MeasureError::Run(error.into())
    }
}

impl From<MeasureError> for Verdict {
    fn from(error: MeasureError) -> Self {
        match error {
            MeasureError::Run(RunError::Body(BodyError::Method(error))) => error.into(),
            MeasureError::File(reason) => Verdict::Refused(reason),
            other => Verdict::Crashed(other.to_string()),
        }
    }
}

/// Keeps the last body, or the last problem file.
#[derive(Default)]
pub struct Bench {
    kept: Option<Kept>,
    /// The last problem file, by name and digest.
    file: Option<(String, String, ProblemFile, OperatorSize)>,
}

struct Kept {
    digest: String,
    refine: usize,
    space: Option<String>,
    needs: Needs,
    case: Case,
    /// Increments of the case itself.
    increments: usize,
    body: Body,
    /// Peak of memory up to the factor [MB].
    peak_mb: Option<f64>,
    friction: Option<PerFriction>,
}

struct PerFriction {
    friction: Vec<f64>,
    /// Number of increments that the converged solutions follow the path in.
    increments: usize,
    system: ContactSystem,
    references: References,
}

/// What a cell is solved on.
pub struct Scene<'a> {
    /// The case, with the contact space and the increments of the cell.
    pub case: &'a Case,
    /// Refinement factor.
    pub refine: usize,
    /// Its discretisation, factored.
    pub body: &'a Body,
    /// The contact system with the friction of the cell.
    pub system: &'a ContactSystem,
    /// What acts on the body.
    pub loading: Loading<'a>,
    /// Peak of memory while the body was discretised and factored [MB].
    pub peak_mb: Option<f64>,
    /// Converged solutions, once they were asked for.
    pub references: &'a mut References,
}

impl Bench {
    /// The problem of a cell from its file.
    ///
    /// # Errors
    /// A file that cannot be read or is refused.
    pub fn problem(
        &mut self,
        cell: &Cell,
        path: &Path,
    ) -> Result<(&ProblemFile, &OperatorSize), MeasureError> {
        let same = |kept: &(String, String, ProblemFile, OperatorSize)| {
            (&kept.0, &kept.1) == (&cell.case, &cell.digest)
        };
        self.kept = None;
        memory::reset_peak();
        let kept = match self.file.take().filter(same) {
            Some(kept) => kept,
            None => {
                let gone = |e| format!("cannot read `{}`: {e}", path.display());
                let bytes = fs::read(path).map_err(|e| MeasureError::Gone(gone(e)))?;
                if digest_of_bytes(&bytes) != cell.digest {
                    let what = format!(
                        "`{}` has changed since the sweep was planned",
                        path.display()
                    );
                    return Err(MeasureError::Gone(what));
                }
                drop(bytes);
                let problem = ProblemFile::read_as(path, cell.case.clone());
                let problem = problem.map_err(|e| MeasureError::File(e.reason(path)))?;
                let operator = problem.size().map_err(BodyError::from)?.operator;
                (cell.case.clone(), cell.digest.clone(), problem, operator)
            }
        };
        let (_, _, problem, operator) = self.file.insert(kept);
        Ok((problem, operator))
    }

    /// The scene of a cell.
    ///
    /// # Errors
    /// A case that cannot be read, discretised or factored.
    pub fn scene<'a>(
        &'a mut self,
        cell: &Cell,
        text: &str,
        traction: bool,
    ) -> Result<Scene<'a>, MeasureError> {
        let needs = Needs {
            frictionless: cell.friction.iter().all(|&mu| mu == 0.0),
            traction,
        };
        let same = |kept: &Kept| {
            (&kept.digest, kept.refine, &kept.space, kept.needs)
                == (&cell.digest, cell.refine, &cell.space, needs)
        };
        memory::reset_peak();
        self.file = None;
        // The old body goes before the new one comes: two would raise the peak of memory.
        let kept = match self.kept.take().filter(same) {
            Some(kept) => kept,
            None => Kept::new(cell, text, needs)?,
        };
        let kept = self.kept.insert(kept);
        let increments = kept.increments * cell.increments;
        kept.case.path.increments = increments;
        let same = |f: &PerFriction| f.friction == cell.friction && f.increments == increments;
        let known = kept.friction.take().filter(same);
        let per_friction = match known {
            Some(known) => known,
            None => {
                let of_point = kept.body.points.iter().map(|p| cell.friction[p.crack]);
                let system = ContactSystem::new(kept.body.elastic.clone(), of_point.collect());
                PerFriction {
                    friction: cell.friction.clone(),
                    increments,
                    system: system.map_err(BodyError::from)?,
                    references: References::default(),
                }
            }
        };
        let PerFriction {
            system, references, ..
        } = kept.friction.insert(per_friction);
        let loading = Loading::new(&kept.body, &kept.case, cell.mu())?;
        Ok(Scene {
            case: &kept.case,
            refine: kept.refine,
            body: &kept.body,
            system,
            loading,
            peak_mb: kept.peak_mb,
            references,
        })
    }
}

impl Kept {
    fn new(cell: &Cell, text: &str, needs: Needs) -> Result<Self, MeasureError> {
        let mut case = case::parse(format!("{}.toml", cell.case), text).map_err(BodyError::from)?;
        if let Some(name) = &cell.space {
            let space = ContactSpace::named(name);
            let space = space.ok_or_else(|| MeasureError::Space(name.clone()))?;
            case.cracks
                .iter_mut()
                .for_each(|crack| crack.contact = space);
        }
        warm_up(case.model.dim());
        memory::reset_peak();
        let body = Body::new(&case, cell.refine, needs)?;
        body.elastic.factorise().map_err(BodyError::from)?;
        Ok(Kept {
            digest: cell.digest.clone(),
            refine: cell.refine,
            space: cell.space.clone(),
            needs,
            increments: case.path.increments,
            case,
            body,
            peak_mb: memory::peak_mb(),
            friction: None,
        })
    }
}
