//! The verb `stress`: the suite of random scenes.

use super::arguments::Output;
use super::error::CliError;
use super::output::{say, show, warn};
use super::progress::Bar;
use super::study::{STOP, shard, watch_for_interruption};
use crate::files::claim::COMMAND;
use crate::report::{Bundle, Claim, Plan, Provenance, page, stress as report};
use crate::studies::analysis::success::success;
use crate::studies::lab::{Inside, Lab, Shard, Workers};
use crate::studies::origin::Limits;
use crate::studies::record::Record;
use crate::studies::records::Records;
use crate::studies::stress::find::{Effort, find};
use crate::studies::stress::suite::{self, Suite};
use crate::studies::stress::{Family, places, scene, summary};

/// Limits on a method on a scene.
const LIMITS: Limits = Limits {
    seconds: 120.0,
    memory_mb: Some(8000),
};

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
pub struct Arguments {
    /// Seed: the same scenes on every machine
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only scenes of this family: patch-2d, patch-3d, slip-2d, slip-3d, ladder; may be repeated
    #[arg(long, value_parser = family)]
    family: Vec<Family>,
    /// Scenes per family, instead of the numbers of the suite
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    scenes: Option<u64>,
    /// 20 000 scenes, and ladders of other tips and spaces
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
    /// Only ladders whose name has this in it, e.g. "past crack, slips", and all of their steps
    #[arg(long, value_name = "TEXT", conflicts_with = "family")]
    ladders: Option<String>,
    /// Part of the scenes, e.g. 2/8
    #[arg(long, value_parser = shard)]
    shard: Option<Shard>,
}

fn family(text: &str) -> Result<Family, String> {
    let known = Family::ALL.into_iter().find(|f| f.name() == text);
    known.ok_or_else(|| Family::ALL.map(Family::name).join(", "))
}

/// Runs the suite; false if the program was wrong, or the default method missed a scene with one answer.
pub fn run(arguments: Arguments, mut plan: Plan) -> Result<bool, CliError> {
    if let (Some(number), Some(&family)) = (arguments.only, arguments.family.first()) {
        return one(&arguments, family, number);
    }
    let wanted = |f: &Family| match &arguments.ladders {
        Some(_) => *f == Family::Ladder,
        None => arguments.family.is_empty() || arguments.family.contains(f),
    };
    let count = |few: u64, many: u64| {
        let own = if arguments.full { many } else { few };
        arguments.scenes.unwrap_or(own)
    };
    let of = |f: Family, n: u64| {
        if f.is_random() {
            n
        } else {
            n.min(places::count(arguments.full))
        }
    };
    let own = SCENES.into_iter().filter(|(f, ..)| wanted(f));
    let suite = Suite {
        seed: arguments.seed,
        scenes: own
            .map(|(f, few, many)| (f, of(f, count(few, many))))
            .collect(),
        shard: arguments.shard.unwrap_or(Shard::ALL),
        all_steps: arguments.full || arguments.ladders.is_some(),
        ladders: arguments.ladders.clone().unwrap_or_default(),
    };
    let scenes = suite.scenes();
    let program = super::arguments::program_file()?;
    watch_for_interruption()?;
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    // Not how many scenes: records are kept, more may follow.
    plan.retain(|name, _| [COMMAND, "seed"].contains(&name.as_str()));
    let claim = arguments.output.claim("stress", plan)?;
    claim.mark()?;
    let bar = Bar::with_lines();
    let mut workers = Workers {
        lab: Lab {
            program,
            jobs: arguments.jobs.map_or(cores, usize::from),
            repeats: None,
            limits: LIMITS,
            stop: &STOP,
        },
        records: Records::of(claim.dir()),
        progress: &bar,
    };
    let findings = suite::run(&mut workers, &scenes)?;
    bar.finish();
    let provenance =
        Provenance::collect(workers.lab.jobs).with_option("seed", suite.seed.to_string());
    let mut bundle = report::bundle(&findings, &provenance)?;
    page::add(&mut bundle)?;
    claim.commit(&bundle)?;
    show(&summary::faults(&findings), "");
    show(&summary::invariances(&findings), "");
    show(&success(&summary::records(&findings)), "");
    show(&summary::of_ladders(&findings), "");
    say(format_args!(
        "{} of {} scenes. Results: {}",
        findings.len(),
        scenes.len(),
        claim.dir().display()
    ));
    for finding in &findings {
        if let Some(fault) = finding.fault.filter(|fault| fault.is_wrong()) {
            let (name, number) = (finding.scene.family.name(), finding.scene.number);
            warn(format_args!("{fault}: {name} {number}: {}", finding.reason));
        }
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
    let findings = find(&mut Inside::default(), &[scene], Effort::All)?;
    for finding in &findings {
        for Record { found, .. } in &finding.records {
            let iterations = found.sum(|step| step.iterations);
            let (method, verdict) = (&found.method, found.verdict.to_string());
            let cause = found.cause();
            say(format_args!(
                "{method:22} {verdict:24} {iterations:6} {cause}"
            ));
        }
        for seen in &finding.seen {
            say(format_args!("{:34} {seen}", seen.transformation));
        }
        let fault = finding.fault.map_or("right", |fault| fault.name());
        say(format_args!(
            "{fault} {}\nCase: {}",
            finding.reason,
            claim.dir().join(&file).display()
        ));
    }
    Ok(summary::as_expected(&findings))
}
