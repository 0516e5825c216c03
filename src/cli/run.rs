//! `stickslip run`: cases.

use std::path::PathBuf;

use stickslip_methods::Tier;

use super::arguments::{ProgramLimit, find_case, provenance_with, refuse_twins};
use super::error::CliError;
use super::output::say;
use super::progress::Bar;
use crate::report::table::readable;
use crate::report::{page, prepare_output, standard};
use crate::run::choice::choices;
use crate::run::expect;
use crate::run::record::Results;
use crate::run::run_case::{Fields, Settings, run_case};

/// Arguments of `stickslip run`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Case files or names
    #[arg(required = true)]
    cases: Vec<String>,
    /// Method with options, NAME or NAME:key=value,key=value; may be repeated
    #[arg(long, short)]
    method: Vec<String>,
    /// Accuracy: low, mid or high (contact laws violated by at most 1e-3, 1e-6, 1e-9); the case's own by default
    #[arg(long)]
    tier: Option<Tier>,
    /// Methods whose fields are written for pictures: none, first (the first exact method) or all
    #[arg(long, value_enum, default_value = "first")]
    fields: FieldsOf,
    /// Folder for the results
    #[arg(long, default_value = "results")]
    out: PathBuf,
    /// Starts from which methods look for further answers: `solved (several)` where two hold; 1 for that of the increment alone
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Runs at the same time; times are recorded for 1 only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    #[command(flatten)]
    limit: ProgramLimit,
}

/// Values of `--fields`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum FieldsOf {
    None,
    First,
    All,
}

/// Runs cases, writes their report and prints what became of them.
pub fn run(arguments: Arguments) -> Result<bool, CliError> {
    let out = &arguments.out;
    let settings = Settings {
        tier: arguments.tier,
        jobs: usize::from(arguments.jobs),
        fields: match arguments.fields {
            FieldsOf::None => Fields::None,
            FieldsOf::First => Fields::First,
            FieldsOf::All => Fields::All,
        },
        starts: usize::from(arguments.starts),
    };
    let cases = arguments
        .cases
        .iter()
        .map(|name| find_case(name))
        .collect::<Result<Vec<_>, _>>()?;
    let given = arguments
        .method
        .iter()
        .map(|m| arguments.limit.parse(m))
        .collect::<Result<Vec<_>, _>>()?;
    refuse_twins("case", cases.iter().map(|case| case.name.as_str()))?;
    for case in &cases {
        let chosen = choices(case, &given)?;
        refuse_twins("method", chosen.iter().map(|choice| choice.label.as_str()))?;
        expect::check(case)?;
    }
    let _claim = prepare_output(out)?;
    let bar = Bar::new();
    let mut results = Results::default();
    for case in &cases {
        results.append(run_case(case, &given, settings, &bar)?);
    }
    bar.finish();
    standard::write(out, &results, &provenance_with(settings, &given))?;
    page::write(out)?;
    say(format_args!(
        "{}",
        readable(
            &standard::last_runs(&results.runs),
            ": the last increment of each"
        )
        .terminal()
    ));
    if !results.expectations.is_empty() {
        say(format_args!(
            "{}",
            readable(&results.expectations, "").terminal()
        ));
    }
    say(format_args!(
        "{}\nResults: {}",
        standard::summary(&results),
        out.display()
    ));
    Ok(results.as_expected())
}
