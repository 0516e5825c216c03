//! The verb `solve`: contact problems of files.

use std::path::PathBuf;

use stickslip_methods::Tier;

use super::arguments::{
    Output, TimeLimit, methods_or_all, only, provenance_with, refuse_twins, told,
};
use super::error::CliError;
use super::output::{conclude, show};
use super::progress::Bar;
use crate::case::Target;
use crate::report::tables::problems::of_files;
use crate::report::{Bundle, Plan, names, standard, table};
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::analysis::success::success;
use crate::studies::axes::named;
use crate::studies::cases::{Settings, Why};
use crate::studies::exchange::problem_file::ProblemFile;
use crate::studies::lab::unmeasured;
use crate::studies::measure::{Bench, MeasureError, Repeats, RunError, here};
use crate::studies::origin::Origin;
use crate::studies::record::Record;
use crate::studies::results::Results;
use crate::studies::rows::RunKey;
use crate::studies::several::mark_several;
use crate::studies::sources::collection::entries;
use crate::studies::sources::files::FileProblem;
use crate::studies::task::Looks;

/// Seconds after which no further solution begins.
const REPEAT_S: f64 = 5.0;

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// FCLIB files (HDF5), local or global, and folders of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Method with options, NAME or NAME:key=value,key=value; may be repeated; all by default
    #[arg(long, short)]
    method: Vec<String>,
    /// Accuracy: low, mid or high (contact laws violated by at most 1e-3, 1e-6, 1e-9)
    #[arg(long, default_value = "high")]
    tier: Tier,
    /// Solutions per method and problem, fewer where they take more than 5 s; times are their medians
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    repeats: u16,
    /// Look for what solves a problem that a method gave up
    #[arg(long)]
    explain: bool,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    limit: TimeLimit,
}

/// Runs the verb; false if a problem was not solved.
pub fn run(args: Arguments, mut plan: Plan) -> Result<bool, CliError> {
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
    let (mut results, mut solutions) = (Results::default(), Bundle::new());
    let mut refusals = Vec::new();
    let mut bench = Bench::default();
    let looks = Looks {
        curves: true,
        truth: true,
        why: true,
        remedy: args.explain,
        ..Looks::default()
    };
    let accuracy = Accuracy::exactly(args.tier.tolerance());
    let repeats = (args.repeats > 1).then(|| Repeats {
        least: args.repeats.into(),
        most: args.repeats.into(),
        seconds: 0.0,
        patience_s: REPEAT_S,
    });
    for entry in entries {
        let found = entry.found;
        let problem = FileProblem::new(entry)?.problem();
        let tasks = problem
            .subject
            .tasks(&problem.axes, &named(&chosen), &[accuracy], looks);
        let answers = match here(
            &mut bench,
            &tasks,
            &chosen,
            1,
            repeats,
            &bar,
            &mut |_, _| (),
        ) {
            Ok(answers) => answers,
            Err(RunError::Measure(MeasureError::File(reason))) if found => {
                let verdict = Verdict::Refused(reason);
                let refused = |task| unmeasured(task, verdict.clone(), &Origin::here());
                refusals.extend(tasks.iter().take(1).map(refused));
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        for answer in &answers {
            let stem = names::stem(&RunKey::of(&answer.record, 1));
            for (part, values) in ["r", "u"].into_iter().zip(answer.solution.iter().flatten()) {
                // The fewest digits that give the number back, as programs from outside answer.
                let lines: String = values.iter().map(|v| format!("{v:e}\n")).collect();
                solutions.add(format!("solutions/{stem}.{part}.txt"), lines)?;
            }
        }
        results.answers.extend(answers);
    }
    mark_several(&mut results.answers);
    bar.finish();
    let settings = Settings {
        tier: Some(Target::Tier(args.tier)),
        why: Why::Cause,
        ..Settings::PLAIN
    };
    let mut bundle = standard::bundle(&results, &provenance_with(settings, &chosen))?;
    let mut records: Vec<Record> = results.records().cloned().collect();
    table::add(&mut bundle, &success(&records), "")?;
    records.extend(refusals);
    let problems = of_files(&records);
    table::add(&mut bundle, &problems, "")?;
    bundle.append(solutions)?;
    claim.commit(&bundle)?;
    show(&problems, "");
    Ok(conclude(&results, claim.dir()))
}
