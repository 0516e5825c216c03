//! The verb `export`: one increment of a case as files for other programs.

use std::path::PathBuf;

use super::arguments::find_case;
use super::error::CliError;
use super::output::say;
use crate::report::names::problem_name;
use crate::report::{Bundle, Claim, Plan};
use crate::run::choice::Choice;
use crate::studies::exchange::export::{Request, export};

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
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

/// Solves the increments up to the one asked for and writes that one.
pub fn run(args: Arguments) -> Result<bool, CliError> {
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
