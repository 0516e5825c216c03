//! The verb `stress`: the suite of random scenes, and the study of all methods on random problems.

use super::arguments::Output;
use super::error::CliError;
use super::output::{say, show, warn};
use super::progress::Bar;
use super::robustness;
use super::sweep::{STOP, shard, watch_for_interruption};
use crate::files::written::COMMAND;
use crate::report::{Bundle, Claim, Plan, Provenance, page, stress as report};
use crate::studies::stress::conduct::{Conduct, Suite, conduct};
use crate::studies::stress::examine::{Effort, examine};
use crate::studies::stress::{Family, ladder, rungs, scene, summary};
use crate::studies::sweep::conduct::Shard;

/// Scenes of every family by default, and with `--full`: about 10 minutes, and a night, on two cores.
const SCENES: [(Family, u64, u64); 5] = [
    (Family::Patch2d, 360, 11_000),
    (Family::Patch3d, 44, 1000),
    (Family::Slip2d, 270, 7000),
    (Family::Slip3d, 33, 1000),
    (Family::Ladder, u64::MAX, u64::MAX),
];

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    part: Option<Part>,
    /// Seed: the same scenes on every machine
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only scenes of this family: patch-2d, patch-3d, slip-2d, slip-3d, ladder; may be repeated
    #[arg(long, value_parser = family)]
    family: Vec<Family>,
    /// Scenes per family, instead of the numbers of the suite
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    scenes: Option<u64>,
    /// 20 000 scenes
    #[arg(long, conflicts_with = "scenes")]
    full: bool,
    /// Only this scene of a family, in this process: its case file is written to the folder of the results
    #[arg(long, value_name = "NUMBER", requires = "family")]
    only: Option<u64>,
    #[command(flatten)]
    output: Output,
    /// Scenes at the same time; by default as many as there are cores
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Part of the scenes, e.g. 2/8
    #[arg(long, value_parser = shard)]
    shard: Option<Shard>,
}

/// What else there is.
#[derive(Debug, clap::Subcommand)]
enum Part {
    /// Every method on random problems with one crack: how often each succeeds, by friction coefficient
    Methods(robustness::Arguments),
}

fn family(text: &str) -> Result<Family, String> {
    let known = Family::ALL.into_iter().find(|f| f.name() == text);
    known.ok_or_else(|| Family::ALL.map(Family::name).join(", "))
}

/// Runs the suite; false if the program was wrong, or the default method missed a scene with one answer.
pub fn run(arguments: Arguments, mut plan: Plan) -> Result<bool, CliError> {
    if let Some(Part::Methods(methods)) = arguments.part {
        return robustness::run(methods, plan);
    }
    if let (Some(number), Some(&family)) = (arguments.only, arguments.family.first()) {
        return one(&arguments, family, number);
    }
    let wanted = |f: &Family| arguments.family.is_empty() || arguments.family.contains(f);
    let count = |few: u64, many: u64| {
        let own = if arguments.full { many } else { few };
        arguments.scenes.unwrap_or(own)
    };
    let of = |f: Family, n: u64| {
        if f.is_random() {
            n
        } else {
            n.min(ladder::count())
        }
    };
    let own = SCENES.into_iter().filter(|(f, ..)| wanted(f));
    let suite = Suite {
        seed: arguments.seed,
        scenes: own
            .map(|(f, few, many)| (f, of(f, count(few, many))))
            .collect(),
    };
    let program = std::env::current_exe().map_err(CliError::Program)?;
    watch_for_interruption()?;
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let shard = arguments.shard.unwrap_or(Shard::ALL);
    let how = Conduct {
        program: &program,
        jobs: arguments.jobs.map_or(cores, usize::from),
        shard: (shard.number as u64, shard.of as u64),
        stop: &STOP,
    };
    // Not how many scenes: findings are kept, more may follow.
    plan.retain(|name, _| [COMMAND, "seed"].contains(&name.as_str()));
    let claim = arguments.output.claim("stress", plan)?;
    let bar = Bar::with_lines();
    let findings = conduct(&suite, &claim, arguments.output.force, how, &bar)?;
    bar.finish();
    let provenance = Provenance::collect(how.jobs).with_option("seed", suite.seed.to_string());
    let mut bundle = report::bundle(&suite, &findings, &provenance)?;
    page::add(&mut bundle)?;
    claim.commit(&bundle)?;
    show(&summary::causes(&findings), "");
    show(&summary::invariances(&findings), "");
    show(&summary::methods(&findings), "");
    show(&rungs::of_scenes(&findings), "");
    show(&rungs::of_options(&findings), "");
    let total: u64 = suite.scenes.values().sum();
    say(format_args!(
        "{} of {total} scenes. Results: {}",
        findings.len(),
        claim.dir().display()
    ));
    for finding in findings
        .iter()
        .filter(|f| f.cause.is_some_and(|c| c.is_fault()))
    {
        let (name, number) = (finding.family.name(), finding.number);
        let cause = finding.cause.map_or("", |c| c.name());
        warn(format_args!("{cause}: {name} {number}: {}", finding.reason));
    }
    Ok(summary::as_expected(&findings))
}

/// One scene: its case file, and what is found.
fn one(arguments: &Arguments, family: Family, number: u64) -> Result<bool, CliError> {
    let scene = scene(family, arguments.seed, number);
    let claim = Claim::new(
        &arguments.output.folder("stress"),
        Plan::new(),
        arguments.output.force,
    )?;
    let mut bundle = Bundle::new();
    let file = format!("{}-{number}.toml", family.name());
    bundle.add(file.clone(), scene.text.clone())?;
    claim.commit(&bundle)?;
    let finding = examine(&scene, Effort::All);
    for trial in &finding.trials {
        let cause = trial.cause.map_or("", |c| c.name());
        let (method, verdict) = (&trial.method, trial.verdict.to_string());
        say(format_args!(
            "{method:22} {verdict:24} {:6} {cause}",
            trial.iterations
        ));
    }
    for change in &finding.invariance {
        say(format_args!("{:34} {change}", change.transformation));
    }
    let cause = finding.cause.map_or("right", |c| c.name());
    say(format_args!(
        "{cause} {}\nCase: {}",
        finding.reason,
        claim.dir().join(file).display()
    ));
    Ok(summary::as_expected(&[finding]))
}
