//! The verbs that exchange contact problems with other programs.

use std::path::PathBuf;

use clap::Args;
use stickslip_methods::Tier;

use super::{Bar, CliError, find_case, parse_choice, provenance, refuse_twins};
use crate::harness::export::{Request, export};
use crate::harness::problem_file::ProblemFile;
use crate::harness::record::Results;
use crate::harness::run::{Choice, Fields, Progress, Settings};
use crate::paper;
use crate::report::{prepare_output, standard};

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Case file or name of a shipped case
    case: String,
    /// Increment, from 1; the last by default
    #[arg(long)]
    increment: Option<usize>,
    /// Friction coefficient of all cracks; the case's own by default
    #[arg(long)]
    friction: Option<f64>,
    /// Mesh refinement; the first of the case by default
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1000))]
    refine: Option<u16>,
    /// Method that solves the increments, NAME or NAME:key=value,key=value
    #[arg(long, short, default_value = "b-newton")]
    method: String,
    /// Folder for the files
    #[arg(long, default_value = "problems")]
    out: PathBuf,
}

/// Arguments of `solve`.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// FCLIB files (HDF5), local or global
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Method with options, NAME or NAME:key=value,key=value; may be repeated; all by default
    #[arg(long, short)]
    method: Vec<String>,
    /// Accuracy: low, mid or high (natural map at most 1e-3, 1e-6, 1e-9)
    #[arg(long, default_value = "high")]
    tier: Tier,
    /// Folder for the results
    #[arg(long, default_value = "results")]
    out: PathBuf,
}

pub(super) fn export_verb(args: ExportArgs) -> Result<bool, CliError> {
    let case = find_case(&args.case)?;
    let request = Request {
        increment: args.increment,
        friction: args.friction,
        refine: args.refine.map(usize::from),
        choice: parse_choice(&args.method)?,
    };
    prepare_output(&args.out)?;
    let (name, bundle) = export(&case, &request)?;
    bundle.commit(&args.out)?;
    println!("{}", args.out.join(name).display());
    for path in bundle.paths() {
        println!("  {path}");
    }
    Ok(true)
}

pub(super) fn solve_verb(args: SolveArgs) -> Result<bool, CliError> {
    let mut chosen = (args.method.iter())
        .map(|m| parse_choice(m))
        .collect::<Result<Vec<_>, _>>()?;
    if chosen.is_empty() {
        chosen = Choice::all().map_err(|source| CliError::Option {
            argument: "defaults".into(),
            source,
        })?;
    }
    refuse_twins("method", chosen.iter().map(|choice| choice.label.as_str()))?;
    let problems = (args.files.iter())
        .map(|file| ProblemFile::read(file))
        .collect::<Result<Vec<_>, _>>()?;
    refuse_twins(
        "problem",
        problems.iter().map(|problem| problem.name.as_str()),
    )?;
    prepare_output(&args.out)?;
    let bar = Bar::new();
    bar.plan(problems.len() * chosen.len());
    let settings = Settings {
        tier: Some(args.tier),
        jobs: 1,
        fields: Fields::None,
    };
    let mut results = Results::default();
    let mut solutions = crate::report::Bundle::new();
    for problem in &problems {
        results.append(problem.run(&chosen, args.tier, &bar, &mut solutions)?);
    }
    bar.finish();
    let mut bundle = standard::bundle(&results, &provenance(settings))?;
    bundle.append(solutions)?;
    bundle.commit(&args.out)?;
    println!("{}", standard::runs_table(&results.runs)?.terminal());
    println!(
        "{}\nResults: {}",
        paper::summary(&results),
        args.out.display()
    );
    Ok(paper::as_expected(&results))
}
