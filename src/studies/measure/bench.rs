//! The system of a task. Neighbouring tasks solve the same problem, so the last body is kept with its factor, and for the last
//! friction coefficients the converged solution.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use rayon::ThreadPoolBuildError;
use stickslip_methods::{ContactSystem, Increment, MethodError};
use stickslip_xfem::stiffness::cell_matrix::CellError;

use super::answer::AsItIs;
use crate::case::{self, Case, CaseError, ContactSpace, shipped};
use crate::model::body::{Body, BodyError, Needs};
use crate::model::errors::Deviation;
use crate::model::loading::Loading;
use crate::model::snapshot::Snapshot;
use crate::run::choice::{Choice, ChoiceError};
use crate::run::loads::{Loads, Posed};
use crate::run::path::{Guess, Run};
use crate::run::registry::methods;
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::exchange::problem_file::{OperatorSize, ProblemFile};
use crate::studies::memory;
use crate::studies::task::{Body as BodyKey, FROM_FILE, Matter, Task, digest_of_bytes};
use crate::studies::tips::tip_named;
use crate::studies::why::answers::Answers;

/// Why a task could not be measured; what a method does wrong is a verdict.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The case or its discretisation.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The method.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// The method.
    #[error("no method `{0}` is at hand")]
    Method(String),
    /// The contact space.
    #[error("unknown contact space `{0}`")]
    Space(String),
    /// The enrichment of tips.
    #[error("unknown tip enrichment `{0}`")]
    Tip(String),
    /// Earlier words of this one.
    #[error("{0}")]
    Before(Verdict),
    /// A view that means nothing for the case.
    #[error("the case cannot be seen that way: {0}")]
    View(String),
    /// A problem file that no method is asked to solve.
    #[error("{0}")]
    File(String),
    /// A problem file that cannot be read any more, or is not the one that was planned with.
    #[error("{0}")]
    Gone(String),
}

impl From<CaseError> for MeasureError {
    fn from(error: CaseError) -> Self {
        Self::Body(error.into())
    }
}

impl From<MethodError> for MeasureError {
    fn from(error: MethodError) -> Self {
        Self::Body(error.into())
    }
}

impl From<CellError> for MeasureError {
    fn from(error: CellError) -> Self {
        Self::Body(error.into())
    }
}

/// Why a command cannot run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The case or its discretisation.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// The thread pool.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] ThreadPoolBuildError),
}

impl From<BodyError> for RunError {
    fn from(error: BodyError) -> Self {
        RunError::Measure(error.into())
    }
}

impl From<CaseError> for RunError {
    fn from(error: CaseError) -> Self {
        RunError::Measure(error.into())
    }
}

impl From<MeasureError> for Verdict {
    fn from(error: MeasureError) -> Self {
        match error {
            MeasureError::Body(BodyError::Method(error)) => error.into(),
            MeasureError::Body(BodyError::Case(refusal)) => Verdict::Refused(refusal.to_string()),
            MeasureError::Before(verdict) => verdict,
            MeasureError::File(reason) => Verdict::Refused(reason),
            other => Verdict::Crashed(other.to_string()),
        }
    }
}

/// Keeps the last body or problem file, or why there is none, and the last answer that was seen another way.
#[derive(Default)]
pub struct Bench {
    kept: Option<Kept>,
    refused: Option<(BodyKey, Verdict)>,
    pub(super) as_it_is: Option<AsItIs>,
}

struct Kept {
    key: BodyKey,
    subject: Subject,
    /// Peak of memory up to the factor [MB].
    peak_mb: Option<f64>,
    posed: Option<PerFriction>,
}

/// The problem.
enum Subject {
    Body(Box<Discretised>),
    Algebra(Box<(ProblemFile, OperatorSize)>),
}

struct Discretised {
    /// With the contact space, the tips and the increments of the task.
    case: Case,
    /// Increments of the case itself.
    increments: usize,
    refine: usize,
    needs: Needs,
    body: Body,
}

struct PerFriction {
    friction: Vec<f64>,
    /// Number of increments that the converged solutions follow the path in.
    increments: usize,
    system: Option<ContactSystem>,
    references: Mutex<References>,
    answers: Mutex<Option<Answers>>,
}

/// A converged solution.
pub struct Reference {
    /// Its natural map, the largest over the increments.
    pub natural_map: f64,
    /// By increment.
    pub snapshots: Vec<Snapshot>,
}

/// Attempts so far on one problem, by method; none where it did not converge.
pub type References = BTreeMap<&'static str, Option<Reference>>;

/// The problem, with the load on it.
enum Setting<'a> {
    Body(&'a Discretised, Loading<'a>),
    Algebra(&'a ProblemFile, &'a OperatorSize),
}

/// The problem of a task.
pub struct Scene<'a> {
    setting: Setting<'a>,
    /// The contact system with the friction of the task.
    pub system: &'a ContactSystem,
    /// Peak of memory while the body was discretised and factored [MB].
    pub peak_mb: Option<f64>,
    references: &'a Mutex<References>,
    answers: &'a Mutex<Option<Answers>>,
}

impl Bench {
    /// The scene of a task.
    ///
    /// # Errors
    /// A case that cannot be read, discretised or factored; a file that cannot be read or is refused.
    pub fn scene<'a>(&'a mut self, task: &Task) -> Result<Scene<'a>, MeasureError> {
        let asked = &task.asked;
        memory::reset_peak();
        let fits = |kept: &Kept| kept.key == asked.body() && kept.subject.serves(task);
        // The old body goes before the new one comes: two would raise the peak of memory.
        let kept = match self.kept.take().filter(fits) {
            Some(kept) => kept,
            None => self.discretise(task)?,
        };
        let Kept {
            subject,
            posed,
            peak_mb,
            ..
        } = self.kept.insert(kept);
        if let Subject::Body(own) = subject {
            own.case.path.increments = own.increments * asked.increments;
        }
        let same = |own: &PerFriction| {
            own.friction == asked.friction && own.increments == asked.increments
        };
        let known = match posed.take().filter(same) {
            Some(known) => known,
            None => PerFriction {
                friction: asked.friction.clone(),
                increments: asked.increments,
                system: subject.system(&asked.friction_by_crack())?,
                references: Mutex::default(),
                answers: Mutex::default(),
            },
        };
        let known = posed.insert(known);
        let (own, setting) = match &*subject {
            Subject::Body(own) => {
                let loading = Loading::new(&own.body, &own.case, asked.mu())?;
                (None, Setting::Body(own, loading))
            }
            Subject::Algebra(file) => (Some(&file.0.system), Setting::Algebra(&file.0, &file.1)),
        };
        let Some(system) = known.system.as_ref().or(own) else {
            return Err(MeasureError::File("a problem without a system".into()));
        };
        Ok(Scene {
            setting,
            system,
            peak_mb: *peak_mb,
            references: &known.references,
            answers: &known.answers,
        })
    }
}

impl Bench {
    /// A new body or problem; a refusal is kept, so that what is refused is discretised once.
    fn discretise(&mut self, task: &Task) -> Result<Kept, MeasureError> {
        let key = task.asked.body();
        if let Some((_, verdict)) = self.refused.as_ref().filter(|known| known.0 == key) {
            return Err(MeasureError::Before(verdict.clone()));
        }
        Kept::new(task).inspect_err(|error| {
            if let MeasureError::Body(BodyError::Case(refusal)) = error {
                self.refused = Some((key, Verdict::Refused(refusal.to_string())));
            }
        })
    }
}

impl Kept {
    fn new(task: &Task) -> Result<Self, MeasureError> {
        let asked = &task.asked;
        let view = asked.view;
        let subject = match &*task.matter {
            Matter::Case { file, text } => {
                let seen = match view {
                    None => text.clone(),
                    Some(view) => view
                        .apply(text)
                        .ok_or_else(|| MeasureError::View(view.name()))?,
                };
                Subject::of_case(case::parse(file, seen)?, task)?
            }
            Matter::Given(case) => Subject::of_case((**case).clone(), task)?,
            Matter::File(path) => {
                let gone = |e| format!("cannot read `{}`: {e}", path.display());
                let bytes = fs::read(path).map_err(|e| MeasureError::Gone(gone(e)))?;
                if digest_of_bytes(&bytes) != asked.digest {
                    let what = format!("`{}` has changed since it was planned", path.display());
                    return Err(MeasureError::Gone(what));
                }
                Subject::of_file(path, bytes, &asked.case)?
            }
            Matter::Bytes(bytes) => {
                Subject::of_file(asked.case.as_ref(), bytes.clone(), &asked.case)?
            }
        };
        Ok(Self {
            key: asked.body(),
            subject,
            peak_mb: memory::peak_mb(),
            posed: None,
        })
    }
}

/// Demands of a task on the body of a case. Whether the normals of a crack alone are condensed is decided by all friction coefficients
/// of the case, so that neighbouring tasks share a body.
fn needs(case: &Case, task: &Task) -> Needs {
    let swept = case.sweep.friction.iter().any(|mu| *mu != 0.0);
    let pairs = case.cracks.iter().zip(task.asked.friction_by_crack());
    let frictionless = pairs.map(|(crack, mu)| !swept && crack.friction == 0.0 && mu == 0.0);
    Needs {
        frictionless: frictionless.collect(),
        traction: task.traction,
    }
}

impl Subject {
    /// A case, discretised with the contact space and tips of a task.
    fn of_case(mut case: Case, task: &Task) -> Result<Self, MeasureError> {
        let asked = &task.asked;
        for crack in &mut case.cracks {
            if let Some(name) = &asked.space {
                let space = ContactSpace::named(name);
                crack.contact = space.ok_or_else(|| MeasureError::Space(name.clone()))?;
            }
            if let Some(name) = &asked.tip {
                let tip = tip_named(name);
                crack.tip = tip.ok_or_else(|| MeasureError::Tip(name.clone()))?;
            }
        }
        warm_up(case.model.dim());
        memory::reset_peak();
        let needs = needs(&case, task);
        let body = Body::new(&case, asked.refine, &needs)?;
        body.factorise(&case)?;
        Ok(Self::Body(Box::new(Discretised {
            increments: case.path.increments,
            refine: asked.refine,
            case,
            needs,
            body,
        })))
    }

    /// The problem of a file.
    fn of_file(path: &Path, bytes: Vec<u8>, name: &str) -> Result<Self, MeasureError> {
        let problem = ProblemFile::from_bytes(path, bytes, name);
        let problem = problem.map_err(|e| MeasureError::File(e.reason(path)))?;
        let operator = problem.operator()?;
        Ok(Self::Algebra(Box::new((problem, operator))))
    }

    /// Whether it has what a task on the same problem needs.
    fn serves(&self, task: &Task) -> bool {
        match self {
            Self::Algebra(_) => true,
            Self::Body(own) => {
                let needs = needs(&own.case, task);
                own.needs.frictionless == needs.frictionless
                    && (own.needs.traction || !needs.traction)
            }
        }
    }

    /// The contact system of a body, given friction per crack; none of bare algebra, which has its own.
    fn system(&self, friction: &[f64]) -> Result<Option<ContactSystem>, MeasureError> {
        let Self::Body(own) = self else {
            return Ok(None);
        };
        let of_point = own.body.points.iter().map(|p| friction[p.crack]);
        let system = ContactSystem::new(own.body.elastic.clone(), of_point.collect())?;
        Ok(Some(system))
    }
}

fn unpoisoned<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Scene<'_> {
    /// The system with what acts on it.
    pub fn posed(&self) -> Posed<'_> {
        let loads = match &self.setting {
            Setting::Body(_, loading) => Loads::Body(loading),
            Setting::Algebra(file, _) => Loads::Algebra(&file.loads),
        };
        Posed {
            system: self.system,
            loads,
        }
    }

    /// The case and what acts on its body; none of bare algebra.
    pub fn body(&self) -> Option<(&Case, &Loading<'_>)> {
        match &self.setting {
            Setting::Body(own, loading) => Some((&own.case, loading)),
            Setting::Algebra(..) => None,
        }
    }

    /// Converged solutions that were asked for so far.
    pub fn references(&self) -> MutexGuard<'_, References> {
        unpoisoned(self.references)
    }

    /// The solutions of an increment. The first one begins from the same state whatever the method: its solutions are kept.
    ///
    /// # Errors
    /// Input that no method could treat.
    pub fn answers(&self, problem: &Increment<'_>, first: bool) -> Result<Answers, MethodError> {
        if !first {
            return Answers::of(problem);
        }
        let mut known = unpoisoned(self.answers);
        match &*known {
            Some(known) => Ok(known.clone()),
            None => Ok(known.insert(Answers::of(problem)?).clone()),
        }
    }

    /// Mesh and contact space, as tables name them.
    pub(super) fn labels(&self) -> (String, String) {
        match &self.setting {
            Setting::Body(own, _) => (own.body.label.clone(), own.body.space.clone()),
            Setting::Algebra(file, _) => (file.kind.to_owned(), FROM_FILE.to_owned()),
        }
    }

    /// Largest distance of neighbouring grid lines [m]; 0 of bare algebra.
    pub(super) fn cell_size(&self) -> f64 {
        match &self.setting {
            Setting::Body(own, _) => own.case.mesh.grid.refined(own.refine).cell_size(),
            Setting::Algebra(..) => 0.0,
        }
    }

    pub(super) fn uniform_stress(&self) -> f64 {
        match &self.setting {
            Setting::Body(own, _) => own.body.checks.uniform,
            Setting::Algebra(..) => f64::NAN,
        }
    }

    /// Distance of reactions from the known ones of bare algebra.
    pub(super) fn deviations(&self, reactions: &[f64]) -> Vec<Deviation> {
        match &self.setting {
            Setting::Body(..) => Vec::new(),
            Setting::Algebra(file, _) => file.deviations(reactions),
        }
    }

    /// The operator of bare algebra.
    pub(super) fn operator(&self) -> Option<OperatorSize> {
        match &self.setting {
            Setting::Body(..) => None,
            Setting::Algebra(_, operator) => Some((*operator).clone()),
        }
    }

    /// Seconds to set up the body and to assemble its stiffness, with the traction operator where it is needed.
    pub(super) fn setup(&self, traction: bool) -> [f64; 2] {
        let setup = match &self.setting {
            Setting::Body(own, _) => own.body.setup,
            Setting::Algebra(file, _) => file.setup,
        };
        let owed_s = if traction { setup.traction_s } else { 0.0 };
        [setup.setup_s + owed_s, setup.assembly_s]
    }
}

/// Runs a small shipped case of a dimension, once in a program: the first mesh would otherwise pay for starting threads and
/// for memory that is touched for the first time, and look slower than the second. To be called before times are taken.
pub fn warm_up(dim: usize) {
    static PLANE: Once = Once::new();
    static SOLID: Once = Once::new();
    let (name, once) = match dim {
        2 => ("plate_mesh1", &PLANE),
        _ => ("manufactured_slip_3d", &SOLID),
    };
    let run = || -> Option<()> {
        let case = shipped::find(name)?.ok()?;
        let choice = Choice::new(methods().first()?, &[]).ok()?;
        let body = Body::new(&case, 1, &Needs::default()).ok()?;
        let friction = body.points.iter().map(|p| case.cracks[p.crack].friction);
        let system = ContactSystem::new(body.elastic.clone(), friction.collect()).ok()?;
        let mu = case.cracks.first().map_or(0.0, |crack| crack.friction);
        let loading = Loading::new(&body, &case, mu).ok()?;
        let run = Run {
            posed: Posed {
                system: &system,
                loads: Loads::Body(&loading),
            },
            choice: &choice,
            accuracy: Accuracy::own(&case),
            guess: Guess::Before,
        };
        run.follow(&mut |_| ());
        Some(())
    };
    // A failure here is one of the run itself too, and is told there.
    once.call_once(|| _ = run());
}
