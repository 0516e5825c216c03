//! `stickslip run`: cases.

use std::collections::BTreeSet;

use super::advice;
use super::arguments::{Output, TimeLimit, find_cases, only, provenance_with, refuse_twins};
use super::error::CliError;
use super::output::{conclude, show};
use super::progress::Bar;
use crate::case::Target;
use crate::report::{Plan, add_input, page, standard};
use crate::run::choice::choices;
use crate::studies::axes::Subject;
use crate::studies::cases::{Fields, Settings, Why, run_case};
use crate::studies::expect;
use crate::studies::results::Results;

/// Arguments of `stickslip run`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Case files or names
    #[arg(required = true)]
    cases: Vec<String>,
    /// Method with options, NAME or NAME:key=value,key=value; may be repeated
    #[arg(long, short)]
    method: Vec<String>,
    /// Accuracy: low, mid or high (contact laws violated by at most 1e-3, 1e-6, 1e-9), or mesh (a tenth of the error of the mesh, with what that saves); the case's own by default
    #[arg(long)]
    tier: Option<Target>,
    /// Methods whose fields are written for pictures: none, first (the first exact method) or all
    #[arg(long, value_enum, default_value = "first")]
    fields: FieldsOf,
    /// Increments that profiles and pictures are drawn of besides the last, e.g. 4,12
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..))]
    increments: Vec<u16>,
    #[command(flatten)]
    output: Output,
    /// Starts from which methods look for further answers: `solved (several)` where two hold; 1 for that of the increment alone
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Estimate the error of the mesh, in the energy norm and of every quantity, from a second one
    #[arg(long)]
    error: bool,
    /// Look for what solves the problem of a run that gave up
    #[arg(long)]
    explain: bool,
    /// Runs at the same time; times are recorded for 1 only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    #[command(flatten)]
    limit: TimeLimit,
}

/// Values of `--fields`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum FieldsOf {
    None,
    First,
    All,
}

/// Runs cases, writes their report and prints what became of them.
pub fn run(arguments: Arguments, plan: Plan) -> Result<bool, CliError> {
    let settings = Settings {
        tier: arguments.tier,
        error: arguments.error,
        jobs: usize::from(arguments.jobs),
        fields: match arguments.fields {
            FieldsOf::None => Fields::None,
            FieldsOf::First => Fields::First,
            FieldsOf::All => Fields::All,
        },
        starts: usize::from(arguments.starts),
        why: if arguments.explain {
            Why::Remedy
        } else {
            Why::Cause
        },
    };
    let cases = find_cases(&arguments.cases)?;
    let given = arguments
        .method
        .iter()
        .map(|m| arguments.limit.parse(m))
        .collect::<Result<Vec<_>, _>>()?;
    for case in &cases {
        let chosen = choices(case, &given)?;
        refuse_twins("method", chosen.iter().map(|choice| choice.label.as_str()))?;
        expect::check(case)?;
    }
    let most = cases.iter().map(|case| case.path.increments).max();
    let pictured: BTreeSet<usize> = arguments.increments.into_iter().map(usize::from).collect();
    if let Some(beyond) = pictured.last().filter(|k| Some(**k) > most) {
        return Err(CliError::Unknown {
            what: "increment",
            name: beyond.to_string(),
            known: format!("1 to {}", most.unwrap_or(0)),
        });
    }
    let name = only(cases.iter().map(|case| case.name.as_str()), "run");
    let claim = arguments.output.claim(name, plan)?;
    let bar = Bar::new();
    let mut results = Results {
        pictured,
        ..Results::default()
    };
    for case in &cases {
        results.append(run_case(case, &given, settings, &bar)?);
    }
    bar.finish();
    cases
        .iter()
        .for_each(|case| advice::on_results(case, &results));
    let mut bundle = standard::bundle(&results, &provenance_with(settings, &given))?;
    add_input(&mut bundle, Subject::texts(&cases))?;
    page::add(&mut bundle)?;
    claim.commit(&bundle)?;
    if arguments.error {
        show(&results.with_errors(), "");
    }
    Ok(conclude(&results, claim.dir()))
}
