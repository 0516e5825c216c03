//! Runs: a case times its meshes, friction values and methods, increment by increment.

use std::sync::Arc;

use rayon::prelude::*;
use stickslip_methods::{ContactSystem, Tier};

use crate::case::{Case, CaseError};
use crate::model::body::{Body, BodyError, Needs};
use crate::model::field_mesh::field_step;
use crate::model::loading::Loading;
use crate::model::quantities::{point_states, quantities};
use crate::run::choice::{Choice, choices};
use crate::run::exact_curve::exact_rows;
use crate::run::expect::{self, expectation_rows};
use crate::run::load_path::LoadPathRun;
use crate::run::record::{Results, RunFields, RunRow};
use crate::run::verdict::Accuracy;

/// How to run cases.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Tier asked for; `None`: the case's own.
    pub tier: Option<Tier>,
    /// Cells run at the same time; times are recorded for one only.
    pub jobs: usize,
    /// Whose fields are kept for pictures.
    pub fields: Fields,
}

/// Methods whose fields are kept: pictures cost more than solving, and exact methods agree to many digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fields {
    /// Nobody's.
    None,
    /// The first exact method's of every problem, or the first method's if none is exact.
    First,
    /// Everybody's.
    All,
}

/// Watches the runs of a command.
pub trait Progress: Sync {
    /// So many runs will follow.
    fn plan(&self, runs: usize);
    /// One run (case, mesh, friction, method) ended.
    fn done(&self, label: &str);
}

/// No progress report.
pub struct Quiet;

impl Progress for Quiet {
    fn plan(&self, _: usize) {}
    fn done(&self, _: &str) {}
}

/// Why a command cannot run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The case or its discretisation.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The thread pool.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl From<CaseError> for RunError {
    fn from(error: CaseError) -> Self {
        RunError::Body(error.into())
    }
}

/// One run before it starts.
struct Cell<'a> {
    body: &'a Body,
    loading: Arc<Loading<'a>>,
    friction: f64,
    system: Arc<ContactSystem>,
    choice: &'a Choice,
    refine: usize,
    fields: bool,
}

/// Runs a case for some methods and gathers everything it produced.
pub fn run_case(
    case: &Case,
    given: &[Choice],
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Results, RunError> {
    let choices = choices(case, given)?;
    expect::check(case)?;
    let accuracy = Accuracy::of(case, settings.tier.unwrap_or(case.tier));
    let frictions = friction_values(case);
    progress.plan(case.sweep.refine.len() * frictions.len() * choices.len());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.jobs)
        .build()?;
    let mut results = Results::default();
    for &refine in &case.sweep.refine {
        let frictionless = frictions
            .iter()
            .all(|per_crack| per_crack.iter().all(|&mu| mu == 0.0));
        let needs = Needs {
            frictionless,
            traction: choices.iter().any(Choice::needs_traction),
        };
        let body = Body::new(case, refine, needs)?;
        let mut cells = Vec::new();
        for per_crack in &frictions {
            let friction = body.points.iter().map(|p| per_crack[p.crack]).collect();
            let system = Arc::new(
                ContactSystem::new(body.elastic.clone(), friction).map_err(BodyError::from)?,
            );
            let mu = per_crack.first().copied().unwrap_or(0.0);
            let loading = Arc::new(Loading::new(&body, case, mu)?);
            // The same on every mesh.
            if Some(&refine) == case.sweep.refine.first() {
                results.exact.extend(exact_rows(case, &loading, mu));
            }
            let first = choices.iter().position(|c| c.method.exact).unwrap_or(0);
            for (number, choice) in choices.iter().enumerate() {
                cells.push(Cell {
                    fields: match settings.fields {
                        Fields::None => false,
                        Fields::First => number == first,
                        Fields::All => true,
                    },
                    body: &body,
                    loading: loading.clone(),
                    friction: mu,
                    system: system.clone(),
                    choice,
                    refine,
                });
            }
        }
        let run = |cell: &Cell<'_>| {
            let results = run_cell(case, cell, accuracy);
            progress.done(&format!(
                "{} {} mu={} {}",
                case.name, body.label, cell.friction, cell.choice.label
            ));
            results
        };
        // One after the other unless asked otherwise, so that times mean something.
        let parts: Vec<Results> = if settings.jobs > 1 {
            pool.install(|| cells.par_iter().map(run).collect())
        } else {
            cells.iter().map(run).collect()
        };
        for part in parts {
            results.append(part);
        }
    }
    if settings.jobs > 1 {
        results.runs.iter_mut().for_each(RunRow::forget_times);
    }
    Ok(results)
}

/// Friction coefficients per run and crack.
pub fn friction_values(case: &Case) -> Vec<Vec<f64>> {
    if case.sweep.friction.is_empty() {
        return vec![case.cracks.iter().map(|c| c.friction).collect()];
    }
    case.sweep
        .friction
        .iter()
        .map(|&mu| vec![mu; case.cracks.len()])
        .collect()
}

/// The load path of one run.
fn run_cell(case: &Case, cell: &Cell<'_>, accuracy: Accuracy) -> Results {
    let Cell { body, choice, .. } = *cell;
    let path = LoadPathRun {
        case,
        loading: &cell.loading,
        system: &cell.system,
        friction: cell.friction,
        choice,
        accuracy,
    };
    let (mut results, mut steps) = (Results::default(), Vec::new());
    let end = path.follow(&mut |key, increment, now| {
        results.runs.push(path.row(key, increment));
        results.history.extend(increment.history_rows(key));
        let Some(now) = now else { return };
        results.add_found(key, quantities(case, body, now), point_states(body, now));
        if cell.fields {
            steps.push(field_step(body, now));
        }
    });
    // A run that could not start is held to nothing.
    if !end.started {
        return results;
    }
    let key = end.key;
    results.expectations = expectation_rows(case, choice, cell.refine, &key, &results);
    if !steps.is_empty() {
        results.fields.push(RunFields { key, steps });
    }
    results
}
