//! One increment of a case as interchange files.

use stickslip_methods::{ContactState, ContactSystem, Increment, Tier};

use crate::case::Case;
use crate::files::interchange::{Info, InterchangeError};
use crate::model::body::{Body, BodyError, Needs};
use crate::model::loading::Loading;
use crate::run::choice::Choice;
use crate::run::loads::{Loads, Posed};
use crate::run::path::{Guess, Run};
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::axes::friction_values;
use crate::studies::exchange::{global_problem, local_problem};
use crate::studies::rows::RunKey;

/// Which increment.
#[derive(Debug, Clone)]
pub struct Request {
    /// Increment from 1; the last by default.
    pub increment: Option<usize>,
    /// Friction of all cracks; the case's by default.
    pub friction: Option<f64>,
    /// Refinement; the first of the case by default.
    pub refine: Option<usize>,
    /// Method that solves the increments up to this one.
    pub choice: Choice,
}

/// One increment as files.
pub struct ExportedIncrement {
    /// Which one, and who solved the increments up to it.
    pub key: RunKey,
    /// Ends of the names of the files, e.g. `local.hdf5`, and their contents.
    pub files: Vec<(&'static str, Vec<u8>)>,
}

/// Why there is nothing to export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The case or its discretisation.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// Writing.
    #[error(transparent)]
    Interchange(#[from] InterchangeError),
    /// No such increment, or several answers where one was asked for.
    #[error("{0}")]
    Question(String),
    /// The state the increment starts from, or its solution, is not to be had.
    #[error("increment {increment} was not solved by {method} ({verdict}): try another --method")]
    Unsolved {
        /// Increment.
        increment: usize,
        /// Method.
        method: String,
        /// Its fate.
        verdict: Verdict,
    },
}

/// Solves the increments up to the one asked for and puts that one into files.
///
/// # Errors
/// [`ExportError`]. Only solved increments are exported.
pub fn export(case: &Case, request: &Request) -> Result<ExportedIncrement, ExportError> {
    let last = case.path.increments;
    let wanted = request.increment.unwrap_or(last);
    if !(1..=last).contains(&wanted) {
        return Err(ExportError::Question(format!(
            "--increment {wanted}: `{}` has the increments 1 to {last}",
            case.name
        )));
    }
    let refine = request.refine.or(case.sweep.refine.first().copied());
    // The files hold all rows, also where nothing rubs.
    let needs = Needs {
        frictionless: Vec::new(),
        traction: request.choice.needs_traction(),
    };
    let friction = friction(case, request.friction)?;
    let body = Body::new(case, refine.unwrap_or(1), &needs)?;
    let of_point = body.points.iter().map(|p| friction[p.crack]);
    let system = ContactSystem::new(body.elastic.clone(), of_point.collect());
    let system = system.map_err(BodyError::from)?;
    let mu = friction.first().copied().unwrap_or(0.0);
    let loading = Loading::new(&body, case, mu)?;
    let run = Run {
        posed: Posed {
            system: &system,
            loads: Loads::Body(&loading),
        },
        choice: &request.choice,
        accuracy: Accuracy::of(case, Tier::High),
        guess: Guess::Before,
    };
    let mut state = ContactState::zero(&system);
    let mut start = state.clone();
    let mut unsolved = None;
    run.follow_to(wanted, &mut |moment| match &moment.solved.judged {
        Some(judged) if moment.solved.verdict.is_solved() => {
            start = std::mem::replace(&mut state, judged.outcome.state.clone());
        }
        _ => {
            unsolved.get_or_insert((moment.number, moment.solved.verdict.clone()));
        }
    });
    if let Some((increment, verdict)) = unsolved {
        return Err(ExportError::Unsolved {
            increment,
            method: request.choice.label.clone(),
            verdict,
        });
    }
    let increment = Increment {
        system: &system,
        load: &loading.at(wanted),
        start_load: &loading.before(wanted),
        start: &start,
        guess: None,
        index: wanted - loading.first(),
        tolerance: run.accuracy.asked,
    };
    let key = RunKey {
        case: case.name.clone(),
        mesh: body.label.clone(),
        space: body.space.clone(),
        method: request.choice.label.clone(),
        friction: mu,
        increment: wanted,
    };
    let info = info(case, &key, &increment);
    Ok(ExportedIncrement {
        files: files(&increment, &state, info)?,
        key,
    })
}

/// Friction per crack.
fn friction(case: &Case, given: Option<f64>) -> Result<Vec<f64>, ExportError> {
    if let Some(mu) = given {
        return Ok(vec![mu; case.cracks.len()]);
    }
    let mut all = friction_values(case);
    if all.len() > 1 {
        let values: Vec<String> = case.sweep.friction.iter().map(f64::to_string).collect();
        return Err(ExportError::Question(format!(
            "`{}` runs with μ = {}: choose one with --friction",
            case.name,
            values.join(", ")
        )));
    }
    Ok(all.pop().unwrap_or_default())
}

fn info(case: &Case, key: &RunKey, increment: &Increment<'_>) -> Info {
    let RunKey { mesh, space, .. } = key;
    let force = if increment.system.dim() == 2 {
        "N per metre of thickness"
    } else {
        "N"
    };
    let floating = increment.system.elastic().floating().len();
    let kernel = match floating {
        0 => "M is positive definite, W positive semi-definite".to_owned(),
        n => format!(
            "rigid motions: {n}; M is singular, W belongs to a pinned body, V spans their jumps"
        ),
    };
    Info {
        title: Some(case.title.clone()),
        description: Some(format!(
            "stickslip {}: {}, mesh {mesh}, {space}, friction {}, increment {}; quasi-static, u is gap and slip \
             increment in m, r the force on the side the normal points to in {force}, compression positive, \
             components normal first",
            env!("CARGO_PKG_VERSION"),
            key.case,
            key.friction,
            key.increment,
        )),
        math_info: Some(kernel),
    }
}

/// Everything as files.
fn files(
    increment: &Increment<'_>,
    solution: &ContactState,
    info: Info,
) -> Result<Vec<(&'static str, Vec<u8>)>, ExportError> {
    let form = increment.local_form().map_err(BodyError::from)?;
    let local = local_problem(increment, &form, solution, info.clone());
    let mut files = vec![("local.hdf5", local.to_bytes()?)];
    if let Some(global) = global_problem(increment, solution, info) {
        files.push(("global.hdf5", global.to_bytes()?));
    }
    Ok(files)
}
