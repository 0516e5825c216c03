//! `stress methods`: the random robustness study.

use stickslip_methods::Tier;

use super::arguments::{Output, ProgramLimit, methods_or_all};
use super::error::CliError;
use super::output::{say, show, warn};
use super::progress::Bar;
use crate::report::{Plan, Provenance, robustness as report};
use crate::studies::robustness;
use crate::studies::robustness::RobustnessPlan;
use crate::studies::robustness::atlas::atlas;
use crate::studies::robustness::summary::{RobustnessRow, rows};

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Problems per friction coefficient and dimension
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    problems: u32,
    /// Seed: the same problems on every machine
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only this problem of the study, e.g. one of failures.csv; its case files are written too
    #[arg(long, value_name = "INDEX")]
    only: Option<u32>,
    /// Dimension, 2 or 3; may be repeated
    #[arg(long = "dim", default_values_t = [2, 3], value_parser = clap::value_parser!(u8).range(2..=3))]
    dims: Vec<u8>,
    /// Friction coefficients
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 0.1, 0.3, 0.6, 1.0, 2.0, 5.0], value_parser = friction)]
    friction: Vec<f64>,
    /// Method with options, NAME or NAME:key=value,key=value; may be repeated; all methods by default
    #[arg(long, short)]
    method: Vec<String>,
    /// Accuracy: low, mid or high (contact laws violated by at most 1e-3, 1e-6, 1e-9)
    #[arg(long, default_value = "high")]
    tier: Tier,
    #[command(flatten)]
    output: Output,
    /// Bodies worked on at the same time; times are recorded for 1 only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    #[command(flatten)]
    limit: ProgramLimit,
}

fn friction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(mu) if mu >= 0.0 && mu.is_finite() => Ok(mu),
        _ => Err("a finite number >= 0".into()),
    }
}

/// Runs the study; false if a method claimed what does not hold, or failed with an error. Giving up is a result here.
pub fn run(arguments: Arguments, whole: Plan) -> Result<bool, CliError> {
    let choices = methods_or_all(&arguments.method, &arguments.limit)?;
    let sorted = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let mut dims: Vec<usize> = arguments.dims.iter().map(|&d| usize::from(d)).collect();
    dims.sort_unstable();
    dims.dedup();
    let plan = RobustnessPlan {
        seed: arguments.seed,
        dims,
        problems: arguments.problems as usize,
        only: arguments.only.map(|index| index as usize),
        friction: sorted(arguments.friction),
        tier: arguments.tier,
        jobs: usize::from(arguments.jobs),
    };
    let claim = arguments.output.claim("stress-methods", whole)?;
    let bar = Bar::new();
    let trials = robustness::run(&plan, &choices, &bar)?;
    bar.finish();

    let provenance = Provenance::collect(plan.jobs)
        .with_option("jobs", plan.jobs.to_string())
        .with_option("tier", plan.tier.to_string())
        .with_option("seed", plan.seed.to_string())
        .with_option("problems", plan.problems.to_string());
    let rows = rows(&plan, &trials);
    let mut bundle = report::bundle(&plan, &trials, &rows, &provenance)?;
    if let Some(problem) = plan.only {
        for &dim in &plan.dims {
            let name = format!("problem-{dim}d-{problem}.toml");
            bundle.add(name, robustness::case_of(&plan, &choices, dim, problem)?)?;
        }
    }
    claim.commit(&bundle)?;
    show(&rows, "");
    let causes = atlas(&trials);
    if !causes.is_empty() {
        show(&causes, "");
    }
    say(format_args!(
        "{}\nResults: {}",
        summary(&rows),
        claim.dir().display()
    ));
    for trial in trials.iter().filter(|t| t.is_wrong()) {
        warn(format_args!(
            "{}: {}D problem {} mu={} {}",
            trial.verdict, trial.dim, trial.problem, trial.friction, trial.method
        ));
    }
    Ok(robustness::as_expected(&trials))
}

fn summary(rows: &[RobustnessRow]) -> String {
    let sum = |count: fn(&RobustnessRow) -> usize| rows.iter().map(count).sum::<usize>();
    format!(
        "{} runs: {} solved, {} approximate, {} gave up, {} refused, {} false claims, {} crashed",
        sum(|row| row.problems),
        sum(|row| row.solved),
        sum(|row| row.approximate.iter().sum()),
        sum(|row| row.gave_up),
        sum(|row| row.refused),
        sum(|row| row.false_claims),
        sum(|row| row.crashed),
    )
}
