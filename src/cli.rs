//! The command line: verbs, arguments, what is printed.

mod converge;
mod exchange;
mod output;
mod page;
mod progress;
mod spaces;
mod stress;
mod study;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};
use stickslip_methods::{METHODS, Tier};

use self::output::say;
pub use self::output::warn;
use self::progress::Bar;
use crate::analytic::SOLUTIONS;
use crate::harness::body::{Body, Needs};
use crate::harness::case::{self, Case};
use crate::harness::expect;
use crate::harness::export::ExportError;
use crate::harness::infsup::InfSupError;
use crate::harness::loading::Loading;
use crate::harness::problem_file::ProblemFileError;
use crate::harness::record::Results;
use crate::harness::run::{
    Choice, ChoiceError, Fields, RunError, Settings, choices, friction_values, run_case,
};
use crate::harness::shipped;
use crate::harness::stress::StressError;
use crate::pages;
use crate::paper::{self, PaperError};
use crate::report::{self, page::PageError};
use crate::report::{Provenance, ReportError, prepare_output, standard};
use crate::sweep::conduct::ConductError;
use crate::sweep::plan::PlanError;
use crate::sweep::store::StoreError;

/// Compares methods of enforcing frictional contact on crack faces, on one XFEM discretisation.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 all runs as expected, 1 a run or an expected number failed, 2 bad input or files."
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Reproduce the founding paper's tables and run every shipped case (also without any verb)
    Paper {
        /// Folder for the report
        #[arg(long, default_value = "reports")]
        out: PathBuf,
        /// Runs at the same time; times are recorded for 1 only
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
        jobs: u16,
    },
    /// Run cases: files, or names of shipped cases
    Run {
        /// Case files or names
        #[arg(required = true)]
        cases: Vec<String>,
        /// Method with options, NAME or NAME:key=value,key=value; may be repeated
        #[arg(long, short)]
        method: Vec<String>,
        /// Accuracy: low, mid or high (natural map at most 1e-3, 1e-6, 1e-9); the case's own by default
        #[arg(long)]
        tier: Option<Tier>,
        /// Methods whose fields are written for pictures: none, first (the first exact method) or all
        #[arg(long, value_enum, default_value = "first")]
        fields: FieldsOf,
        /// Folder for the results
        #[arg(long, default_value = "results")]
        out: PathBuf,
        /// Runs at the same time; times are recorded for 1 only
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
        jobs: u16,
    },
    /// Run every method on random problems: how often each succeeds, by friction coefficient
    Stress(stress::Arguments),
    /// Measure errors and observed orders on sequences of meshes, by contact space and tip enrichment
    Converge(converge::Arguments),
    /// Test the contact spaces: numerical inf-sup condition on cracks that lie in the grid in many ways
    Spaces(spaces::Arguments),
    /// Sweep over cases, meshes, methods and tolerances: work against precision, a record per cell
    Study(study::Arguments),
    /// Join the records of a sweep that ran in several folders
    Merge(study::MergeArguments),
    /// Show what changed between two runs of a sweep beyond noise
    Compare(study::CompareArguments),
    /// Measure the cells that come in on standard input, as `study` starts it
    #[command(hide = true)]
    Work(study::WorkArguments),
    /// Show a report folder as one page, index.html
    Page(page::Arguments),
    /// Write one increment of a case as files for other programs: FCLIB (HDF5) and MatrixMarket
    Export(exchange::ExportArgs),
    /// Solve contact problems from FCLIB files (HDF5)
    Solve(exchange::SolveArgs),
    /// Judge reactions that other programs found for a problem from an FCLIB file
    Judge(exchange::JudgeArgs),
    /// List the methods and the shipped cases
    List,
    /// Describe a method or a case, or all `methods`
    Show {
        /// Method or case
        name: String,
    },
    /// Check case files without running them
    Check {
        /// Case files
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
}

/// Values of `--fields`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum FieldsOf {
    None,
    First,
    All,
}

/// Why a command ended with exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A run could not start.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The robustness study.
    #[error(transparent)]
    Stress(#[from] StressError),
    /// The study of the contact spaces.
    #[error(transparent)]
    InfSup(#[from] InfSupError),
    /// The main job.
    #[error(transparent)]
    Paper(#[from] PaperError),
    /// Files.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A folder that cannot be shown as a page.
    #[error(transparent)]
    Page(#[from] PageError),
    /// An increment that cannot be exported.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A problem file that cannot be solved.
    #[error(transparent)]
    ProblemFile(#[from] ProblemFileError),
    /// A name nobody knows.
    #[error("unknown {what} `{name}`, known: {known}")]
    Unknown {
        /// Method or case.
        what: &'static str,
        /// As given.
        name: String,
        /// The choices.
        known: String,
    },
    /// Two runs of one name.
    #[error("{what} `{name}` is given twice: their results would have the same name")]
    Twice {
        /// Method or case.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A method whose limit are laws of its own, where errors of the discretisation are asked for.
    #[error(
        "method `{name}` solves laws of its own: its modelling error would hide that of the mesh"
    )]
    Inexact {
        /// The method.
        name: &'static str,
    },
    /// A sweep file.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A folder of records.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A sweep that ended early.
    #[error(transparent)]
    Conduct(#[from] ConductError),
    /// This program cannot be found to start it again.
    #[error("cannot find this program to measure cells in a process of its own: {0}")]
    Program(std::io::Error),
    /// Interruptions cannot be caught.
    #[error("cannot watch for interruptions: {0}")]
    Interrupt(ctrlc::Error),
    /// A worker that lost its conductor, or was refused its memory limit.
    #[error("cannot measure cells: {0}")]
    Work(std::io::Error),
    /// A method with options.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
}

impl From<case::CaseError> for CliError {
    fn from(error: case::CaseError) -> Self {
        CliError::Run(error.into())
    }
}

/// Runs the command; true if everything was as expected (exit code 0), false otherwise (exit code 1).
pub fn main(cli: Cli) -> Result<bool, CliError> {
    let default = Verb::Paper {
        out: "reports".into(),
        jobs: 1,
    };
    match cli.verb.unwrap_or(default) {
        Verb::Paper { out, jobs } => paper_verb(&out, usize::from(jobs)),
        Verb::Run {
            cases,
            method,
            tier,
            fields,
            out,
            jobs,
        } => {
            let settings = Settings {
                tier,
                jobs: usize::from(jobs),
                fields: match fields {
                    FieldsOf::None => Fields::None,
                    FieldsOf::First => Fields::First,
                    FieldsOf::All => Fields::All,
                },
            };
            run_verb(&cases, &method, settings, &out)
        }
        Verb::Stress(arguments) => stress::run(arguments),
        Verb::Converge(arguments) => converge::run(arguments),
        Verb::Spaces(arguments) => spaces::run(arguments),
        Verb::Study(arguments) => study::run(arguments),
        Verb::Merge(arguments) => study::run_merge(arguments),
        Verb::Compare(arguments) => study::run_compare(&arguments),
        Verb::Work(arguments) => study::run_work(&arguments),
        Verb::Page(arguments) => page::run(arguments),
        Verb::Export(args) => exchange::export_verb(args),
        Verb::Solve(args) => exchange::solve_verb(args),
        Verb::Judge(args) => exchange::judge_verb(args),
        Verb::List => {
            say(format_args!("{}", list_text().trim_end()));
            Ok(true)
        }
        Verb::Show { name } => {
            say(format_args!("{}", show_text(&name)?.trim_end()));
            Ok(true)
        }
        Verb::Check { files } => check_verb(&files),
    }
}

fn paper_verb(out: &Path, jobs: usize) -> Result<bool, CliError> {
    prepare_output(out)?;
    let settings = Settings {
        tier: None,
        jobs,
        fields: Fields::First,
    };
    let bar = Bar::new();
    let paper = paper::run(settings, &bar)?;
    bar.finish();
    paper.write(out, &provenance(settings))?;
    report::page::write(out)?;
    say(format_args!("{}", paper.text()?));
    say(format_args!("Report: {}", out.display()));
    print_missed(&paper.results);
    Ok(paper.results.as_expected())
}

fn run_verb(
    names: &[String],
    methods: &[String],
    settings: Settings,
    out: &Path,
) -> Result<bool, CliError> {
    let cases = names
        .iter()
        .map(|name| find_case(name))
        .collect::<Result<Vec<_>, _>>()?;
    let given = methods
        .iter()
        .map(|m| Choice::parse(m))
        .collect::<Result<Vec<_>, _>>()?;
    refuse_twins("case", cases.iter().map(|case| case.name.as_str()))?;
    for case in &cases {
        let chosen = choices(case, &given)?;
        refuse_twins("method", chosen.iter().map(|choice| choice.label.as_str()))?;
        expect::check(case)?;
    }
    prepare_output(out)?;
    let bar = Bar::new();
    let mut results = Results::default();
    for case in &cases {
        results.append(run_case(case, &given, settings, &bar)?);
    }
    bar.finish();
    standard::write(out, &results, &provenance(settings))?;
    report::page::write(out)?;
    say(format_args!(
        "{}",
        standard::runs_table(&results.runs)?.terminal()
    ));
    if !results.expectations.is_empty() {
        say(format_args!(
            "{}",
            standard::expectations_table(&results.expectations)?.terminal()
        ));
    }
    say(format_args!(
        "{}\nResults: {}",
        standard::summary(&results),
        out.display()
    ));
    Ok(results.as_expected())
}

/// Two runs of one name would write the same files.
fn refuse_twins<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a str>,
) -> Result<(), CliError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(CliError::Twice {
                what,
                name: name.into(),
            });
        }
    }
    Ok(())
}

fn check_verb(files: &[PathBuf]) -> Result<bool, CliError> {
    for file in files {
        let case = case::read(file)?;
        choices(&case, &[])?;
        expect::check(&case)?;
        for &refine in &case.sweep.refine {
            let body = Body::new(&case, refine, Needs::default()).map_err(RunError::from)?;
            for per_crack in friction_values(&case) {
                let friction = per_crack.first().copied().unwrap_or(0.0);
                Loading::new(&body, &case, friction).map_err(RunError::from)?;
            }
            say(format_args!(
                "{}: {}, {} cells, {} unknowns, {} contact points ({})",
                file.display(),
                body.label,
                body.mesh.cell_count(),
                body.elastic.unknowns(),
                body.points.len(),
                body.space
            ));
        }
    }
    Ok(true)
}

fn provenance(settings: Settings) -> Provenance {
    let tier = settings
        .tier
        .map_or_else(|| "of each case".to_owned(), |t| t.to_string());
    Provenance::collect(settings.jobs.max(rayon::current_num_threads()))
        .with_option("jobs", settings.jobs.to_string())
        .with_option("tier", tier)
}

/// Expected numbers that were missed, on standard error.
fn print_missed(results: &Results) {
    for e in results.expectations.iter().filter(|e| !e.as_stated()) {
        let k = &e.key;
        warn(format_args!(
            "{}: {} {} {} mu={} increment {}: {} {} {} is {:e}, expected {:e} ± {:e} {}",
            e.verdict,
            k.case,
            k.mesh,
            k.method,
            k.friction,
            k.increment,
            e.quantity,
            e.at,
            e.component,
            e.found,
            e.expected,
            e.allowed,
            e.unit
        ));
    }
}

/// A case by file, or by the name of a shipped one.
fn find_case(name: &str) -> Result<Case, CliError> {
    if !Path::new(name).exists() {
        if let Some(case) = shipped::find(name) {
            return Ok(case?);
        }
        if !name.ends_with(".toml") {
            return Err(CliError::Unknown {
                what: "case",
                name: name.into(),
                known: shipped::CASES
                    .iter()
                    .map(|c| c.0)
                    .collect::<Vec<_>>()
                    .join(", "),
            });
        }
    }
    Ok(case::read(name)?)
}

/// The methods named, or all of them with their defaults.
fn methods_or_all(named: &[String]) -> Result<Vec<Choice>, CliError> {
    if named.is_empty() {
        let all = METHODS.iter().map(|method| Choice::parse(method.name));
        return Ok(all.collect::<Result<_, _>>()?);
    }
    let chosen = named.iter().map(|argument| Choice::parse(argument));
    let chosen = chosen.collect::<Result<Vec<_>, _>>()?;
    refuse_twins("method", chosen.iter().map(|choice| choice.label.as_str()))?;
    Ok(chosen)
}

fn list_text() -> String {
    let mut text = String::from("Methods\n");
    for method in METHODS {
        text += &format!("  {:<22} {}\n", method.name, method.summary);
    }
    text += "\nCases\n";
    for (name, _) in shipped::CASES {
        let title = match shipped::find(name) {
            Some(Ok(case)) => case.title,
            _ => "does not parse".into(),
        };
        text += &format!("  {name:<32} {title}\n");
    }
    text += "\nClosed forms for [exact]\n";
    for solution in SOLUTIONS {
        text += &format!("  {:<22} {}\n", solution.name, solution.summary);
        for parameter in solution.parameters {
            let default = parameter
                .default
                .map_or_else(String::new, |v| format!(" (default {v})"));
            text += &format!(
                "  {:<22}   {}: {}{default}\n",
                "", parameter.name, parameter.summary
            );
        }
    }
    text
}

fn show_text(name: &str) -> Result<String, CliError> {
    if name == "methods" {
        return Ok(pages::all());
    }
    if let Some((_, text)) = shipped::CASES.iter().find(|(own, _)| *own == name) {
        return Ok((*text).to_owned());
    }
    if Path::new(name).exists() {
        return Ok(case::read(name)?.source);
    }
    let method = stickslip_methods::method(name).ok_or_else(|| CliError::Unknown {
        what: "method or case",
        name: name.into(),
        known: METHODS
            .iter()
            .map(|m| m.name)
            .chain(shipped::CASES.iter().map(|c| c.0))
            .collect::<Vec<_>>()
            .join(", "),
    })?;
    Ok(pages::page(method))
}
