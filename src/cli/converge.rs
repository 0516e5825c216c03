//! The verb `converge`: errors and observed orders on sequences of meshes.

use super::arguments::{Output, find_cases, only};
use super::error::CliError;
use super::output::{say, show, warn};
use super::progress::Bar;
use crate::case::{ContactSpace, Tip};
use crate::report::{Plan, Provenance, add_input};
use crate::run::choice::Choice;
use crate::studies::axes::Subject;
use crate::studies::convergence::{self, ConvergencePlan, orders};
use crate::studies::tips::tip_named;

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Case files or names
    #[arg(required = true)]
    cases: Vec<String>,
    /// Refinement factors, e.g. 1,2,4,8; by default those of the case if it has several, else 1,2,4,8
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=1024))]
    refine: Vec<u16>,
    /// Contact spaces of all cracks: star, edge-pairs; by default star and the case's own
    #[arg(long, value_delimiter = ',', value_parser = space)]
    spaces: Vec<ContactSpace>,
    /// Enrichment of all tips: none, branch, or a radius in m; by default the case's own
    #[arg(long, value_delimiter = ',', value_parser = tip)]
    tips: Vec<Tip>,
    /// Exact method with options, NAME or NAME:key=value,key=value
    #[arg(long, short, default_value = "hybrid")]
    method: String,
    #[command(flatten)]
    output: Output,
}

fn space(text: &str) -> Result<ContactSpace, String> {
    let known = || ContactSpace::ALL.map(ContactSpace::name).join(", ");
    ContactSpace::named(text).ok_or_else(|| format!("one of {}", known()))
}

fn tip(text: &str) -> Result<Tip, String> {
    tip_named(text).ok_or_else(|| "none, auto, branch, or a radius > 0 in m".into())
}

/// None of nothing.
fn given<T>(values: Vec<T>) -> Option<Vec<T>> {
    (!values.is_empty()).then_some(values)
}

/// Runs the study; false if a mesh was not solved.
pub fn run(arguments: Arguments, whole: Plan) -> Result<bool, CliError> {
    let cases = find_cases(&arguments.cases)?;
    let choice = Choice::parse(&arguments.method)?;
    if !choice.exact() {
        return Err(CliError::Inexact {
            name: choice.name().to_owned(),
        });
    }
    let mut refine: Vec<usize> = arguments.refine.into_iter().map(usize::from).collect();
    refine.sort_unstable();
    refine.dedup();
    let plan = ConvergencePlan {
        refine: given(refine),
        spaces: given(arguments.spaces),
        tips: given(arguments.tips),
        choice,
    };
    let name = only(cases.iter().map(|case| case.name.as_str()), "converge");
    let claim = arguments.output.claim(name, whole)?;
    let bar = Bar::new();
    let mut samples = Vec::new();
    for case in &cases {
        samples.extend(convergence::run(case, &plan, &bar)?);
    }
    bar.finish();

    let (errors, orders) = orders::rows(&samples);
    let provenance = Provenance::collect(rayon::current_num_threads())
        .with_option("method", plan.choice.label.clone());
    let mut bundle = crate::report::convergence::bundle(&errors, &orders, &provenance)?;
    add_input(&mut bundle, Subject::texts(&cases))?;
    claim.commit(&bundle)?;
    show(&orders, "");
    let failed = || samples.iter().filter(|s| !s.verdict.is_honest());
    say(format_args!(
        "{} runs: {} solved, {} not\nResults: {}",
        samples.len(),
        samples.len() - failed().count(),
        failed().count(),
        claim.dir().display()
    ));
    for sample in failed() {
        warn(format_args!(
            "{}: {} {} {} {} mu={}",
            sample.verdict,
            sample.variant.case,
            sample.mesh,
            sample.variant.space,
            sample.variant.tip,
            sample.variant.friction
        ));
    }
    Ok(failed().next().is_none())
}
