//! Runs: a case times its meshes, friction values and methods, increment by increment.

use std::sync::Once;

use rayon::prelude::*;
use stickslip_methods::Tier;

use crate::case::{Case, CaseError, shipped};
use crate::model::body::{Body, BodyError, Needs};
use crate::model::field_mesh::field_step;
use crate::model::quantities::{point_states, quantities};
use crate::run::choice::{Choice, choices};
use crate::run::exact_curve::exact_rows;
use crate::run::expect::{self, expectation_rows};
use crate::run::load_path::{Guess, LoadPathRun, Posed};
use crate::run::record::{Results, RunFields, RunRow};
use crate::run::registry::methods;
use crate::run::several::mark_several;
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
    /// Starts from which every exact method looks for answers; 1: that of the increment alone, whose runs are kept.
    pub starts: usize,
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
    let first = choices.iter().position(Choice::exact).unwrap_or(0);
    let mut results = Results::default();
    if settings.jobs == 1 {
        warm_up(case.model.dim());
    }
    for &refine in &case.sweep.refine {
        let body = Body::new(case, refine, needs(&frictions, &choices))?;
        let posed = (frictions.iter())
            .map(|friction| Posed::new(&body, case, friction))
            .collect::<Result<Vec<_>, _>>()?;
        // The same on every mesh.
        if Some(&refine) == case.sweep.refine.first() {
            results.exact.extend(posed.iter().flat_map(exact_rows));
        }
        let run = |&(posed, number): &(&Posed<'_>, usize)| {
            let choice = &choices[number];
            let fields = match settings.fields {
                Fields::None => false,
                Fields::First => number == first,
                Fields::All => true,
            };
            let mut results = run_path(&posed.run(choice, accuracy), refine, fields);
            for further in (0..settings.starts.saturating_sub(1)).filter(|_| choice.exact()) {
                let path = LoadPathRun {
                    guess: Guess::Further(further),
                    ..posed.run(choice, accuracy)
                };
                path.follow(&mut |key, now, _| results.answers.extend(now.answer(key.problem())));
            }
            let Posed { friction, .. } = posed;
            progress.done(&format!(
                "{} {} mu={friction} {}",
                case.name, body.label, choice.label
            ));
            results
        };
        let cells: Vec<(&Posed<'_>, usize)> = (posed.iter())
            .flat_map(|posed| (0..choices.len()).map(move |number| (posed, number)))
            .collect();
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
    mark_several(&mut results);
    if settings.jobs > 1 {
        results.runs.iter_mut().for_each(RunRow::forget_times);
    }
    Ok(results)
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
        let friction: Vec<f64> = case.cracks.iter().map(|crack| crack.friction).collect();
        let body = Body::new(&case, 1, Needs::default()).ok()?;
        let posed = Posed::new(&body, &case, &friction).ok()?;
        let path = posed.run(&choice, Accuracy::of(&case, case.tier));
        path.follow(&mut |_, _, _| ());
        Some(())
    };
    // What fails here fails in the run itself too, and is told there.
    once.call_once(|| _ = run());
}

/// What the runs of some methods ask of a body, given the friction coefficients per run and crack.
pub fn needs(frictions: &[Vec<f64>], choices: &[Choice]) -> Needs {
    Needs {
        frictionless: frictions.iter().flatten().all(|&mu| mu == 0.0),
        traction: choices.iter().any(Choice::needs_traction),
    }
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
fn run_path(path: &LoadPathRun<'_>, refine: usize, fields: bool) -> Results {
    let (case, body) = (path.case, path.loading.body());
    let (mut results, mut steps) = (Results::default(), Vec::new());
    let end = path.follow(&mut |key, increment, now| {
        results.runs.push(path.row(key, increment, now));
        results.history.extend(increment.history_rows(key));
        results.answers.extend(increment.answer(key.problem()));
        let Some(now) = now else { return };
        results.add_found(key, quantities(case, body, now), point_states(body, now));
        if fields {
            steps.push(field_step(body, now));
        }
    });
    // A run that could not start is held to nothing.
    if !end.started {
        return results;
    }
    let key = end.key;
    results.expectations = expectation_rows(case, path.choice, refine, &key, &results);
    if !steps.is_empty() {
        results.fields.push(RunFields { key, steps });
    }
    results
}
