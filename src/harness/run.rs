//! Runs: a case times its meshes, friction values and methods, increment by increment.

use std::sync::Arc;

use rayon::prelude::*;
use stickslip_methods::{ContactSystem, Method, OptionError, Options, Tier};

use crate::harness::body::{Body, BodyError, Needs};
use crate::harness::case::{Case, CaseError, MethodSpec};
use crate::harness::exact_curve::exact_rows;
use crate::harness::expect::{self, expectation_rows};
use crate::harness::load_path::LoadPathRun;
use crate::harness::loading::Loading;
use crate::harness::picture::field_step;
use crate::harness::quantities::{point_rows, quantity_rows};
use crate::harness::record::{Results, RunFields, RunRow};
use crate::harness::verdict::Accuracy;

/// A method with its options.
#[derive(Debug, Clone)]
pub struct Choice {
    /// Method.
    pub method: &'static Method,
    /// Options, defaults filled in.
    pub options: Options,
    /// Name in tables: registry name, changed options in brackets.
    pub label: String,
}

impl Choice {
    /// A method with some of its options changed.
    pub fn new(method: &'static Method, given: &[(String, f64)]) -> Result<Self, OptionError> {
        let options = Options::new(method.options, given)?;
        let label = match changed(&options).as_str() {
            "" => method.name.to_owned(),
            list => format!("{}[{list}]", method.name),
        };
        Ok(Choice {
            method,
            options,
            label,
        })
    }

    /// A method as on the command line: `name` or `name:option=value,option=value`.
    ///
    /// # Errors
    /// [`ChoiceError`].
    pub fn parse(argument: &str) -> Result<Self, ChoiceError> {
        let (name, list) = argument.split_once(':').unwrap_or((argument, ""));
        let method = stickslip_methods::method(name).ok_or_else(|| ChoiceError::Unknown {
            name: name.into(),
            known: method_names(),
        })?;
        let mut options = Vec::new();
        for part in list.split(',').filter(|part| !part.is_empty()) {
            let pair = part.split_once('=');
            let Some((key, Ok(value))) = pair.map(|(k, v)| (k, v.parse::<f64>())) else {
                return Err(ChoiceError::Syntax {
                    argument: argument.into(),
                    part: part.into(),
                });
            };
            options.push((key.to_owned(), value));
        }
        Choice::new(method, &options).map_err(|source| ChoiceError::Option {
            argument: argument.into(),
            source,
        })
    }

    /// As [`parse`](Self::parse) reads it, without options that have their defaults.
    pub fn argument(&self) -> String {
        match changed(&self.options).as_str() {
            "" => self.method.name.to_owned(),
            list => format!("{}:{list}", self.method.name),
        }
    }

    /// Whether the method asks for the traction operator.
    pub fn needs_traction(&self) -> bool {
        // A method that cannot be built is reported by its run.
        (self.method.build)(&self.options).is_ok_and(|method| method.needs_traction())
    }

    /// Every registered method with its defaults.
    pub fn all() -> Result<Vec<Self>, OptionError> {
        let all = stickslip_methods::METHODS.iter();
        all.map(|method| Choice::new(method, &[])).collect()
    }
}

/// The options that differ from their defaults, in the order of the method: the same settings give the same text.
fn changed(options: &Options) -> String {
    let changed = options.iter().filter(|(spec, v)| *v != spec.default);
    let changed: Vec<String> = changed
        .map(|(spec, value)| format!("{}={value:e}", spec.name))
        .collect();
    changed.join(",")
}

/// Names of all methods, separated by commas.
pub fn method_names() -> String {
    let names = stickslip_methods::METHODS.iter().map(|m| m.name);
    names.collect::<Vec<_>>().join(", ")
}

/// Why a text names no method with options.
#[derive(Debug, thiserror::Error)]
pub enum ChoiceError {
    /// A name nobody knows.
    #[error("unknown method `{name}`, known: {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The choices.
        known: String,
    },
    /// An option the method does not have or does not accept.
    #[error("method {argument}: {source}")]
    Option {
        /// As given.
        argument: String,
        /// What is wrong.
        source: OptionError,
    },
    /// An option that is no `key=value`.
    #[error("method {argument}: `{part}` is not key=value with a number")]
    Syntax {
        /// As given.
        argument: String,
        /// The part in question.
        part: String,
    },
}

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

/// Methods a case runs: its own list, or the given ones, or all of the registry.
pub fn choices(case: &Case, given: &[Choice]) -> Result<Vec<Choice>, CaseError> {
    if !given.is_empty() {
        return Ok(given.to_vec());
    }
    if case.methods.is_empty() {
        return Choice::all().map_err(|e| {
            let message = "a method refuses its own defaults";
            case.error(&case.mesh.span, "methods", e, message)
        });
    }
    case.methods
        .iter()
        .map(|spec| {
            let Some(method) = stickslip_methods::method(&spec.name) else {
                return Err(case.error(&spec.span, &spec.name, method_names(), "unknown method"));
            };
            Choice::new(method, &spec.options).map_err(|e| option_error(case, spec, &e))
        })
        .collect()
}

fn option_error(case: &Case, spec: &MethodSpec, error: &OptionError) -> CaseError {
    let (name, allowed) = match error {
        OptionError::Unknown { name, known, .. } => (name, known.clone()),
        OptionError::OutOfRange { name, allowed, .. } => (name, allowed.clone()),
        OptionError::Repeated { name, .. } => (name, "each option once".to_owned()),
    };
    // The last one of the name: a repeated option is wrong where it stands again.
    let position = spec.options.iter().rposition(|(given, _)| given == name);
    let span = position.map_or(&spec.span, |i| &spec.option_spans[i]);
    case.error(span, case.text(span), allowed, error)
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
        results
            .quantities
            .extend(quantity_rows(case, body, key, now));
        results.points.extend(point_rows(body, key, now));
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
