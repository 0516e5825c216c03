//! The command line: verbs, arguments, what is printed.

mod advice;
mod arguments;
mod check;
mod conform;
mod converge;
mod error;
mod export;
pub mod method_manual;
mod output;
mod paper;
mod progress;
mod run;
mod show;
mod solve;
mod stress;
mod study;
mod work;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::Ordering;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use stickslip_methods::Registry;

pub use self::error::CliError;
use self::output::Form;
pub use self::output::warn;
use crate::report::Plan;
use crate::run::registry::install;

/// Compares methods of enforcing frictional contact on crack faces, on one XFEM discretisation.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 all runs as expected, 1 a run or an expected number failed, 2 bad input or files."
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Print nothing but warnings and errors
    #[arg(long, global = true, conflicts_with = "json")]
    quiet: bool,
    /// Print a JSON object per line: every table with all its columns, words as `text`
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Reproduce the founding paper's tables and run every shipped case (also without any verb)
    Paper(paper::Arguments),
    /// Run cases: files, or names of shipped cases
    Run(run::Arguments),
    /// Search for what breaks: random scenes by every method, judged, shrunk, with causes
    Stress(stress::Arguments),
    /// Measure errors and observed orders on sequences of meshes, by contact space and tip enrichment
    Converge(converge::Arguments),
    /// Sweep over problems, meshes, methods and tolerances: work against precision, success rates, a record per task
    Study(study::Arguments),
    /// Measure the tasks that come in on standard input, as `study` starts it
    #[command(hide = true)]
    Work(work::Arguments),
    /// Write one increment of a case as files for other programs: FCLIB (HDF5)
    Export(export::Arguments),
    /// Solve contact problems from FCLIB files (HDF5)
    Solve(solve::Arguments),
    /// Test a method, or a program as one, on small problems with known answers
    Conform(conform::Arguments),
    /// List the methods and the shipped cases, describe one of them, or show a folder of reports as one page
    Show(show::Arguments),
    /// Check case files without running them
    Check(check::Arguments),
}

/// The whole program, with the methods of a registry: reads the command line and says how it ended.
///
/// A program with methods of its own is this call with a registry that holds them.
pub fn program(methods: Registry) -> ExitCode {
    let file = std::env::current_exe().map_err(|e| e.to_string());
    ExitCode::from(program_of(methods, std::env::args_os().collect(), file))
}

/// The same for a command line, the name of the program first, and the file that starts it again: workers are processes of
/// their own. Returns the exit code.
pub fn program_of(
    methods: Registry,
    arguments: Vec<OsString>,
    file: Result<PathBuf, String>,
) -> u8 {
    if !install(methods) || arguments::PROGRAM.set(file).is_err() {
        warn(format_args!(
            "error: the methods of this program are settled already"
        ));
        return 2;
    }
    let mut command = Cli::command();
    command.build();
    let main_job = (arguments.len() <= 1).then(|| "paper".into());
    let arguments = arguments.into_iter().chain(main_job);
    let matches = command.clone().get_matches_from(arguments);
    let plan = arguments::plan(&command, &matches);
    let ended = match Cli::from_arg_matches(&matches) {
        Ok(cli) => main(cli, plan),
        Err(error) => error.exit(),
    };
    if ended.is_ok() && output::LOST.load(Ordering::SeqCst) {
        warn(format_args!("error: standard output cannot be written"));
        return 2;
    }
    match ended {
        Ok(true) => 0,
        Ok(false) => 1,
        Err(error) => {
            warn(format_args!("error: {error}"));
            2
        }
    }
}

/// Runs the command; true if everything was as expected (exit code 0), false otherwise (exit code 1).
pub fn main(cli: Cli, plan: Plan) -> Result<bool, CliError> {
    output::FORM.get_or_init(|| match (cli.json, cli.quiet) {
        (true, _) => Form::Json,
        (_, true) => Form::Nothing,
        _ => Form::Text,
    });
    match cli.verb {
        Verb::Paper(arguments) => paper::run(arguments, plan),
        Verb::Run(arguments) => run::run(arguments, plan),
        Verb::Stress(arguments) => stress::run(arguments, plan),
        Verb::Converge(arguments) => converge::run(arguments, plan),
        Verb::Study(arguments) => study::run(arguments),
        Verb::Work(arguments) => work::run(&arguments),
        Verb::Export(arguments) => export::run(arguments),
        Verb::Solve(arguments) => solve::run(arguments, plan),
        Verb::Conform(arguments) => conform::run(&arguments),
        Verb::Show(arguments) => show::run(arguments),
        Verb::Check(arguments) => check::check(arguments),
    }
}
