//! The verbs that exchange contact problems with other programs.

use std::path::PathBuf;

use clap::Args;
use stickslip_methods::Tier;

use super::arguments::{
    Output, ProgramLimit, find_case, methods_or_all, only, provenance_with, refuse_twins, told,
};
use super::error::CliError;
use super::output::{say, show};
use super::progress::Bar;
use crate::report::names::{self, problem_name};
use crate::report::standard;
use crate::report::table;
use crate::report::{Bundle, Claim, Plan};
use crate::run::choice::Choice;
use crate::run::record::Results;
use crate::run::run_case::{Fields, Progress, Settings};
use crate::studies::exchange::collection::{Entry, FamilyRun, ProblemRow, by_family, entries};
use crate::studies::exchange::export::{Request, export};
use crate::studies::exchange::problem_file::ProblemFile;

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
    #[arg(long, short, default_value = "hybrid")]
    method: String,
    /// Folder for the files
    #[arg(long, default_value = "problems")]
    out: PathBuf,
}

/// Arguments of `solve`.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// FCLIB files (HDF5), local or global, and folders of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Method with options, NAME or NAME:key=value,key=value; may be repeated; all by default
    #[arg(long, short)]
    method: Vec<String>,
    /// Accuracy: low, mid or high (contact laws violated by at most 1e-3, 1e-6, 1e-9)
    #[arg(long, default_value = "high")]
    tier: Tier,
    /// Solutions per method and problem, fewer where they take more than 5 s; times are those of the fastest
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    repeats: u16,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    limit: ProgramLimit,
}

pub fn run_export(args: ExportArgs) -> Result<bool, CliError> {
    let case = find_case(&args.case)?;
    let request = Request {
        increment: args.increment,
        friction: args.friction,
        refine: args.refine.map(usize::from),
        choice: Choice::parse(&args.method)?,
    };
    // Names tell the increments of cases apart: files of several stand beside each other.
    let claim = Claim::new(&args.out, Plan::new(), false)?;
    let exported = export(&case, &request)?;
    let (problem, increment) = (problem_name(&exported.key), exported.key.increment);
    let name = format!("{problem}.increment-{increment}");
    let mut bundle = Bundle::new();
    for (end, contents) in exported.files {
        bundle.add(format!("{name}.{end}"), contents)?;
    }
    claim.commit(&bundle)?;
    say(format_args!("{}", args.out.join(name).display()));
    for path in bundle.paths() {
        say(format_args!("  {path}"));
    }
    Ok(true)
}

pub fn run_solve(args: SolveArgs, mut plan: Plan) -> Result<bool, CliError> {
    let chosen = methods_or_all(&args.method, &args.limit)?;
    let entries = entries(&args.files)?;
    refuse_twins("problem", entries.iter().map(|entry| entry.name.as_str()))?;
    // A file that was named must be readable, one that was found may be refused; neither must hold the memory of all.
    for entry in entries.iter().filter(|entry| !entry.found) {
        ProblemFile::read(&entry.path)?;
    }
    let name = only(entries.iter().map(|entry| entry.name.as_str()), "solve");
    // A folder is what lies in it.
    let files = entries.iter().map(|e| told(&e.name, e.path.to_str()));
    let files: Vec<String> = files.collect();
    plan.insert("files".into(), files.join(", "));
    let claim = args.output.claim(name, plan)?;
    let bar = Bar::new();
    bar.plan(entries.len() * chosen.len());
    let settings = Settings {
        tier: Some(args.tier),
        jobs: 1,
        fields: Fields::None,
        starts: 1,
    };
    let mut results = Results::default();
    let mut solutions = Bundle::new();
    let mut problems = Vec::new();
    for Entry { name, path, found } in entries {
        let problem = match ProblemFile::read_as(&path, name.clone()) {
            Ok(problem) => problem,
            Err(error) if found => {
                let found = Err(error.reason(&path));
                problems.push(ProblemRow {
                    problem: name,
                    found,
                });
                chosen.iter().for_each(|_| bar.done(""));
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        let solved = problem.run(&chosen, args.tier, args.repeats.into(), &bar);
        problems.push(ProblemRow {
            problem: name,
            found: problem.size().map_err(|error| error.to_string()),
        });
        results.append(solved.results);
        for solution in solved.solutions {
            let stem = names::stem(&solution.key);
            for (part, values) in [("r", &solution.reaction), ("u", &solution.velocity)] {
                // The fewest digits that give the number back, as programs from outside answer.
                let lines: String = values.iter().map(|v| format!("{v:e}\n")).collect();
                solutions.add(format!("solutions/{stem}.{part}.txt"), lines)?;
            }
        }
    }
    bar.finish();
    let runs = results.runs.iter().map(|row| FamilyRun {
        problem: &row.key.case,
        accuracy: row.tier.clone(),
        method: &row.key.method,
        verdict: &row.verdict,
        iterations: row.iterations,
    });
    let families = by_family(runs);
    let mut bundle = standard::bundle(&results, &provenance_with(settings, &chosen))?;
    table::add(&mut bundle, &problems, "")?;
    table::add(&mut bundle, &families, "")?;
    bundle.append(solutions)?;
    claim.commit(&bundle)?;
    show(&problems, "");
    show(
        &standard::last_runs(&results.runs),
        ": the last increment of each",
    );
    say(format_args!(
        "{}\nResults: {}",
        standard::summary(&results),
        claim.dir().display()
    ));
    Ok(results.as_expected())
}
