//! Random robustness study: every method on the same random problems, for several friction coefficients.
//!
//! Problem k of a dimension is load k mod 4 on body k / 4. Bodies are drawn until one can be discretised, has enough
//! contact points, and enough of its loads close the crack. Each is factored and condensed once for all its loads,
//! friction coefficients and methods. Every increment starts from rest, so that one failure leaves the others alone.
//!
//! What gives up is explained ([`atlas`](crate::studies::atlas)), and on the first problem of every body all methods run a
//! second time under the eyes of published stopping tests: a quarter of the problems, so that the study stays a study.

pub mod atlas;
pub mod random;
pub mod summary;

use std::ops::RangeInclusive;
use std::sync::Arc;

use rayon::prelude::*;
use stickslip_methods::{
    ContactState, ContactSystem, Increment, Load, MethodError, PointStatus, Tier,
    contact_wise_margin,
};

use crate::case;
use crate::case::Case;
use crate::model::body::{Body, BodyError, Needs};
use crate::model::loading::Loading;
use crate::run::choice::Choice;
use crate::run::increment::{JudgedIncrement, Solver};
use crate::run::run_case::Progress;
use crate::run::several::ambiguous;
use crate::run::verdict::Verdict;
use crate::studies::atlas::answers::Answers;
use crate::studies::atlas::stopping::Stop;
use crate::studies::atlas::{Explanation, explain, stops};
use crate::studies::robustness::random::{Kind, Specimen, Stream};

/// Problems on one body.
const LOADS: usize = 4;
/// Loads drawn per body.
const CANDIDATES: usize = 12;
/// Fraction of the points that would overlap without contact forces: with fewer there is little to solve.
const PRESSED: f64 = 0.25;
/// Bodies drawn before giving up; about every second one will do.
const DRAWS: usize = 1000;

/// The bodies of a dimension, and how many contact points they may have.
fn wanted(dim: usize) -> (Kind, RangeInclusive<usize>) {
    let (cells, points) = if dim == 2 {
        (8..=20, 10..=40)
    } else {
        (3..=5, 20..=80)
    };
    let slope = 0.8;
    (Kind { dim, cells, slope }, points)
}

/// What to run.
#[derive(Debug, Clone)]
pub struct RobustnessPlan {
    /// Seed of all bodies and loads.
    pub seed: u64,
    /// Dimensions, 2 and 3.
    pub dims: Vec<usize>,
    /// Problems per dimension and friction coefficient.
    pub problems: usize,
    /// The one problem to run instead of all.
    pub only: Option<usize>,
    /// Friction coefficients.
    pub friction: Vec<f64>,
    /// Accuracy asked for.
    pub tier: Tier,
    /// Bodies worked on at the same time; times are kept for one only.
    pub jobs: usize,
}

/// One method on one problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Space dimension.
    pub dim: usize,
    /// Number of the problem, from 0.
    pub problem: usize,
    /// Friction coefficient.
    pub friction: f64,
    /// Method label.
    pub method: String,
    /// Whether the method's limit are the contact laws.
    pub exact: bool,
    /// Claim × check.
    pub verdict: Verdict,
    /// Natural map found by the judge; NaN if there was nothing to judge.
    pub natural_map: f64,
    /// Iterations.
    pub iterations: usize,
    /// Factorisations inside the iteration, dense or sparse.
    pub factorisations: usize,
    /// Time of the enforcement in s; NaN unless the machine did nothing else.
    pub solve_s: f64,
    /// Whether every contact point alone has exactly one solution: [`contact_wise_margin`] > 0.
    pub unique: bool,
    /// Contact points.
    pub points: usize,
    /// Points the method found open, sticking and slipping.
    pub statuses: [usize; 3],
    /// Why it gave up, if it did.
    pub explanation: Option<Explanation>,
    /// Where published stopping tests would have stopped it: on the first problem of every body alone, where the method runs
    /// twice.
    pub stops: Vec<Stop>,
}

/// Whether no method claimed what does not hold and none failed with an error. Giving up is a result like any other.
pub fn as_expected(trials: &[Trial]) -> bool {
    !trials.iter().any(Trial::is_wrong)
}

impl Trial {
    /// Whether the run gave what its method is for: an exact one the contact laws, another one the laws it claims.
    pub fn succeeded(&self) -> bool {
        self.verdict.is_solved() || !self.exact && self.verdict.is_honest()
    }

    /// A claim that does not hold, or an error. A trial has no limits, so that running into one is an error too.
    pub fn is_wrong(&self) -> bool {
        self.verdict.is_wrong() || self.verdict.kind().is_limit()
    }
}

/// Why the study could not run.
#[derive(Debug, thiserror::Error)]
pub enum RobustnessError {
    /// A random body broke the discretisation. Refusals are no errors: another body is drawn.
    #[error("a random body in {dim}D cannot be discretised: {source}\n{text}")]
    Body {
        /// Space dimension.
        dim: usize,
        /// The case file.
        text: String,
        /// Why.
        source: BodyError,
    },
    /// The generator gave nothing usable.
    #[error("no usable body in {dim}D among {DRAWS} of number {number}")]
    NoBody {
        /// Space dimension.
        dim: usize,
        /// Body number.
        number: usize,
    },
    /// The system of a random body was refused.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The thread pool.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// A body with the loads that are posed on it.
pub struct Sample {
    specimen: Specimen,
    /// The discretised body.
    pub body: Body,
    /// Its case; increment k of the path is load k.
    case: Case,
    loads: Vec<usize>,
}

impl Sample {
    /// Body `number` of a seed: the same whatever else is drawn.
    ///
    /// # Errors
    /// [`RobustnessError::Body`] and [`RobustnessError::NoBody`].
    pub fn new(
        seed: u64,
        dim: usize,
        number: usize,
        needs: Needs,
    ) -> Result<Self, RobustnessError> {
        let mut stream = Stream::numbered(seed, 4 * number as u64 + dim as u64);
        let (kind, points) = wanted(dim);
        for _ in 0..DRAWS {
            let specimen = Specimen::draw(&kind, CANDIDATES, &mut stream);
            let all: Vec<usize> = (0..CANDIDATES).collect();
            let text = specimen.case(&all, &[1.0]);
            let body = case::parse("random.toml", text.as_str())
                .map_err(BodyError::from)
                .and_then(|case| Ok((Body::new(&case, 1, needs)?, case)));
            let (body, case) = match body {
                Ok(both) => both,
                // The position asks for something the discretisation refuses, e.g. a crack that misses all edges.
                Err(BodyError::Case(_)) => continue,
                Err(source) => return Err(RobustnessError::Body { dim, text, source }),
            };
            if !points.contains(&body.points.len()) {
                continue;
            }
            let mut sample = Self {
                specimen,
                body,
                case,
                loads: Vec::new(),
            };
            let mut loads = Vec::new();
            let loading = sample.loading()?;
            for load in all {
                if loads.len() < LOADS && closes(&sample.body, &loading.at(load + 1))? {
                    loads.push(load);
                }
            }
            if loads.len() == LOADS {
                sample.loads = loads;
                return Ok(sample);
            }
        }
        Err(RobustnessError::NoBody { dim, number })
    }

    /// What acts on the body; random cases have no closed form, so friction does not matter.
    fn loading(&self) -> Result<Loading<'_>, RobustnessError> {
        Loading::new(&self.body, &self.case, 0.0).map_err(|source| RobustnessError::Body {
            dim: self.specimen.dim,
            text: self.case.source.clone(),
            source,
        })
    }

    /// The case file of one of its problems, numbered within the body.
    pub fn case(&self, problem: usize, friction: &[f64]) -> String {
        self.specimen.case(&[self.loads[problem]], friction)
    }
}

/// Whether enough points would overlap without contact forces.
fn closes(body: &Body, load: &Load) -> Result<bool, MethodError> {
    let mut u = load.force.clone();
    body.elastic.solve(&mut u)?;
    let mut jump = vec![0.0; load.offset.len()];
    body.elastic.jump().mul(&u, &mut jump);
    let gaps = jump.iter().zip(&load.offset).step_by(body.mesh.dim());
    let closed = gaps.filter(|(jump, offset)| *jump + *offset < 0.0).count();
    Ok(closed as f64 >= PRESSED * body.points.len() as f64)
}

/// What the bodies of a study must have. A draw that is refused is drawn again, so the same needs make the same bodies.
fn needs(choices: &[Choice]) -> Needs {
    Needs {
        traction: choices.iter().any(Choice::needs_traction),
        ..Needs::default()
    }
}

/// The case file of a problem: what failed in a study can be looked at with `stickslip run`.
///
/// # Errors
/// Those of [`Sample::new`].
pub fn case_of(
    plan: &RobustnessPlan,
    choices: &[Choice],
    dim: usize,
    problem: usize,
) -> Result<String, RobustnessError> {
    case_numbered(plan.seed, dim, problem, &plan.friction, needs(choices))
}

/// The case file of a problem by its numbers alone.
///
/// # Errors
/// Those of [`Sample::new`].
pub fn case_numbered(
    seed: u64,
    dim: usize,
    problem: usize,
    friction: &[f64],
    needs: Needs,
) -> Result<String, RobustnessError> {
    let sample = Sample::new(seed, dim, problem / LOADS, needs)?;
    Ok(sample.case(problem % LOADS, friction))
}

/// Runs the study: trials by dimension, problem, friction and method.
///
/// # Errors
/// [`RobustnessError`]; what a method does wrong is a verdict.
pub fn run(
    plan: &RobustnessPlan,
    choices: &[Choice],
    progress: &dyn Progress,
) -> Result<Vec<Trial>, RobustnessError> {
    let numbers: Vec<usize> = match plan.only {
        Some(problem) => vec![problem],
        None => (0..plan.problems).collect(),
    };
    let bodies: Vec<(usize, &[usize])> = (plan.dims.iter())
        .flat_map(|&dim| {
            let same_body = |a: &usize, b: &usize| a / LOADS == b / LOADS;
            numbers.chunk_by(same_body).map(move |own| (dim, own))
        })
        .collect();
    progress.plan(bodies.len() * plan.friction.len() * choices.len());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(plan.jobs)
        .build()?;
    let of_body =
        |&(dim, problems): &(usize, &[usize])| run_body(plan, dim, problems, choices, progress);
    let parts: Vec<Vec<Trial>> =
        pool.install(|| bodies.par_iter().map(of_body).collect::<Result<_, _>>())?;
    Ok(parts.into_iter().flatten().collect())
}

/// Some problems of one body.
fn run_body(
    plan: &RobustnessPlan,
    dim: usize,
    problems: &[usize],
    choices: &[Choice],
    progress: &dyn Progress,
) -> Result<Vec<Trial>, RobustnessError> {
    let number = problems.first().map_or(0, |problem| problem / LOADS);
    let sample = Sample::new(plan.seed, dim, number, needs(choices))?;
    let body = &sample.body;
    let loading = sample.loading()?;
    let loads: Vec<(usize, Load)> = problems
        .iter()
        .map(|&problem| (problem, loading.at(sample.loads[problem % LOADS] + 1)))
        .collect();
    let rest = Load::zero(&body.elastic);
    let mut trials = Vec::new();
    for &friction in &plan.friction {
        let system = Arc::new(ContactSystem::new(
            body.elastic.clone(),
            vec![friction; body.points.len()],
        )?);
        let unique = contact_wise_margin(&system)? > 0.0;
        let start = ContactState::zero(&system);
        let mut known: Vec<Option<Answers>> = vec![None; loads.len()];
        let (first, mut answers) = (trials.len(), Vec::new());
        for choice in choices {
            let mut solver = Solver::new(choice, &system);
            for ((problem, load), known) in loads.iter().zip(&mut known) {
                let increment = Increment {
                    system: &system,
                    load,
                    start_load: &rest,
                    start: &start,
                    guess: None,
                    index: 0,
                    tolerance: plan.tier.tolerance(),
                };
                let tried = match &mut solver {
                    Ok(solver) => solver.judge(&increment, plan.tier.tolerance()),
                    Err(verdict) => JudgedIncrement::not_started(verdict.clone()),
                };
                let count = |of: PointStatus| {
                    let judged = tried.judged.iter().flat_map(|j| &j.status);
                    judged.filter(|status| **status == of).count()
                };
                let outcome = tried.judged.as_ref().map(|j| &j.outcome.counters);
                let (mut explanation, mut stopped) = (None, Vec::new());
                if let Ok(solver) = &mut solver {
                    if problem % LOADS == 0 {
                        stopped = stops(choice, solver, &increment)?;
                    }
                    if let Verdict::GaveUp(_) = tried.verdict {
                        let known = match known {
                            Some(known) => known,
                            None => known.insert(Answers::of(&increment)?),
                        };
                        let verdict = &tried.verdict;
                        explanation = Some(explain(choice, solver, &increment, verdict, known)?);
                    }
                }
                answers.extend(tried.answer(problem.to_string()));
                trials.push(Trial {
                    dim,
                    problem: *problem,
                    friction,
                    method: choice.label.clone(),
                    exact: choice.exact(),
                    natural_map: (tried.judged.as_ref()).map_or(f64::NAN, |j| j.found.natural_map),
                    iterations: outcome.map_or(0, |c| c.iterations),
                    factorisations: outcome
                        .map_or(0, |c| c.factorisations + c.global_factorisations),
                    solve_s: (tried.work.filter(|_| plan.jobs == 1))
                        .map_or(f64::NAN, |work| work.solve.enforcement_s),
                    unique,
                    points: body.points.len(),
                    statuses: [PointStatus::Open, PointStatus::Stick, PointStatus::Slip].map(count),
                    explanation,
                    stops: stopped,
                    verdict: tried.verdict,
                });
            }
            progress.done(&format!(
                "{dim}D body {number} mu={friction} {}",
                choice.label
            ));
        }
        let ambiguous = ambiguous(&answers);
        for trial in &mut trials[first..] {
            let problem = trial.problem.to_string();
            trial.verdict.mark(ambiguous.contains(&problem));
        }
    }
    Ok(trials)
}
