//! `stickslip paper`: the main job.

use super::arguments::{Output, provenance};
use super::error::CliError;
use super::output::{say, warn};
use super::progress::Bar;
use crate::report::{Plan, page, paper as report};
use crate::studies::cases::{Fields, Settings};
use crate::studies::paper::{self, Extent};
use crate::studies::results::Results;

/// Arguments of `stickslip paper`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    output: Output,
    /// Runs at the same time; times are recorded for 1 only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Also what takes minutes: the long cases, converged sequences, variants of methods, figures of every case
    #[arg(long)]
    full: bool,
}

/// Prints the paper's tables, runs everything, writes the report and prints what it found.
pub fn run(arguments: Arguments, plan: Plan) -> Result<bool, CliError> {
    let Arguments { output, jobs, full } = arguments;
    let claim = output.claim("paper", plan)?;
    let settings = Settings {
        jobs: usize::from(jobs),
        fields: Fields::First,
        ..Settings::PLAIN
    };
    let bar = Bar::new();
    let (table1, table2) = paper::first_tables(settings, &bar)?;
    bar.finish();
    say(format_args!("{}", report::tables(&table1, &table2)));
    let extent = if full { Extent::Full } else { Extent::Quick };
    let bar = Bar::new();
    let paper = paper::run(extent, settings, &bar)?;
    bar.finish();
    let mut bundle = report::bundle(&paper, &provenance(settings))?;
    page::add(&mut bundle)?;
    claim.commit(&bundle)?;
    say(format_args!("{}", report::text(&paper)));
    say(format_args!(
        "Report: {}",
        claim.dir().join(page::FILE).display()
    ));
    if !full {
        say(format_args!(
            "Left for --full: converged reactions of the plate on meshes up to 352x352, cases with several cracks, with \
             kinks and branches and with cracks in solids, variants of the methods, figures of the other cases"
        ));
    }
    print_missed(&paper.results);
    Ok(paper.results.as_expected())
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
