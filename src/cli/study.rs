//! The verb `study`: many tasks, each a record of its own.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::arguments::{Output, find_cases, positive};
use super::error::CliError;
use super::output::{say, show, warn};
use super::progress::Bar;
use crate::case::parse::read_text;
use crate::report::tables::options::OptionRow;
use crate::report::{Claim, Provenance, add_input, page, plan, sweep};
use crate::run::choice::Choice;
use crate::studies::analysis::mark_several;
use crate::studies::analysis::options::sweeps;
use crate::studies::lab::{Lab, Shard};
use crate::studies::memory::is_short;
use crate::studies::origin::{Limits, Origin};
use crate::studies::plan::Plan;
use crate::studies::record::Record;
use crate::studies::records::Records;
use crate::studies::sources::Problem;
use crate::studies::sources::files::FileProblem;
use crate::studies::task::Task;

/// Sweeps by name; the first one is run where none is named.
const SHIPPED: [(&str, &str); 3] = [
    ("study", include_str!("../../benches/study.toml")),
    (
        "sensitivity",
        include_str!("../../benches/sensitivity.toml"),
    ),
    ("random", include_str!("../../benches/random.toml")),
];

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A sweep file, or a sweep by name (study, sensitivity, random), or cases, files and names, or folders of FCLIB files
    what: Vec<PathBuf>,
    /// Method of cases and folders, NAME or NAME:key=value,key=value; may be repeated; all methods by default
    #[arg(long, short)]
    method: Vec<String>,
    #[command(flatten)]
    output: Output,
    /// Tasks at the same time; times are recorded for 1 only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Take no times, e.g. on a machine that others use
    #[arg(long)]
    untimed: bool,
    /// Part of the tasks, e.g. 2/8, each into a folder of its own; --join joins them
    #[arg(long, value_parser = shard)]
    shard: Option<Shard>,
    /// Folders whose records are taken over first, as --shard left them
    #[arg(long, value_name = "DIR", num_args = 1..)]
    join: Vec<PathBuf>,
    /// Time limit per task with set-up and repetitions, in s
    #[arg(long, default_value_t = 300.0, value_parser = positive)]
    time_limit: f64,
    /// Limit on the address space of the process of a task, in MB
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    memory_limit: Option<u64>,
    /// Print the ids of the tasks, and measure nothing
    #[arg(long)]
    list: bool,
}

pub fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    match parts.map(|(number, of)| (number.parse(), of.parse())) {
        Some((Ok(number), Ok(of))) if 1 <= number && number <= of => Ok(Shard { number, of }),
        _ => Err("i/n with whole numbers 1 <= i <= n".into()),
    }
}

/// The request.
fn planned(what: &[PathBuf], method: &[String]) -> Result<Plan, CliError> {
    let shipped = |name: &Path| SHIPPED.into_iter().find(|own| name == Path::new(own.0));
    let sweep = match what {
        [] => Some(SHIPPED[0]),
        [name] if !name.exists() => shipped(name),
        _ => None,
    };
    let is_sweep = |path: &Path| {
        let text = read_text(path).unwrap_or_default();
        text.lines()
            .any(|line| line.trim_start().starts_with("[[cells]]"))
    };
    let read = match (sweep, what) {
        (Some((name, text)), _) => Some(Plan::parse(format!("{name}.toml").as_ref(), text)?),
        (None, [file]) if is_sweep(file) => Some(Plan::read(file)?),
        _ => None,
    };
    if let Some(plan) = read {
        return match method {
            [] => Ok(plan),
            _ => Err(CliError::MethodOfSweep),
        };
    }
    let choices = match method {
        [] => Choice::all()?,
        named => (named.iter().map(|own| Choice::parse(own))).collect::<Result<_, _>>()?,
    };
    let (folders, cases): (Vec<&PathBuf>, Vec<&PathBuf>) = what.iter().partition(|p| p.is_dir());
    let mut problems = Vec::new();
    if !folders.is_empty() {
        let folders: Vec<PathBuf> = folders.into_iter().cloned().collect();
        problems.extend(FileProblem::all(&folders)?.iter().map(FileProblem::problem));
    }
    let names: Vec<String> = cases
        .iter()
        .map(|case| case.display().to_string())
        .collect();
    problems.extend(find_cases(&names)?.iter().map(Problem::of));
    let names: Vec<String> = what.iter().map(|path| path.display().to_string()).collect();
    Ok(Plan::of_problems(names.join(", "), &problems, &choices))
}

/// Set by an interruption.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Runs the verb; false if tasks are left, or in a whole sweep one claimed what does not hold or crashed.
pub fn run(arguments: Arguments) -> Result<bool, CliError> {
    let sweep = planned(&arguments.what, &arguments.method)?;
    let total = sweep.tasks.len();
    let tasks = arguments.shard.unwrap_or(Shard::ALL).tasks(sweep.tasks);
    if arguments.list {
        tasks
            .iter()
            .for_each(|task| say(format_args!("{}", task.id())));
        return Ok(true);
    }
    let name = match &arguments.what[..] {
        [one] => one.file_stem().map(|name| name.to_string_lossy()),
        _ => None,
    };
    let mut whole = plan("study");
    whole.insert("title".into(), sweep.title.clone());
    let claim = arguments
        .output
        .claim(&name.unwrap_or("study".into()), whole)?;
    claim.mark()?;
    let records = Records::of(claim.dir());
    let program = super::arguments::program_file()?;
    watch_for_interruption()?;
    if is_short(arguments.memory_limit) {
        warn(format_args!(
            "the shell bounds memory (ulimit -v or -d): a task that is denied it ends this run"
        ));
    }
    if let Some(seconds) = sweep.seconds {
        let told = format_args!("{} tasks: about {seconds:.0} s on one core", tasks.len());
        say(told);
    }
    let lab = Lab {
        program,
        jobs: usize::from(arguments.jobs),
        repeats: (!arguments.untimed).then_some(sweep.repeats),
        limits: Limits {
            seconds: arguments.time_limit,
            memory_mb: arguments.memory_limit,
        },
        stop: &STOP,
    };
    for folder in &arguments.join {
        join(&lab, &tasks, &Records::of(folder), &records)?;
    }
    let bar = Bar::with_lines();
    let now = lab.measure(&tasks, &records, &bar)?;
    bar.finish();
    let known = records.read(&tasks)?;
    let found: Vec<Record> = tasks
        .iter()
        .filter_map(|task| known.get(&task.id()).cloned())
        .collect();
    let left = tasks.len() - found.len();
    say(format_args!(
        "{} tasks: {now} measured now, {left} left",
        tasks.len()
    ));
    // A part is complete when its tasks have a record, whatever it says; the report is written once, of all.
    if arguments.shard.is_some() || left > 0 || STOP.load(Ordering::SeqCst) {
        return Ok(left == 0);
    }
    report(&claim, &sweep.title, &sweep.input, total, found)
}

/// Takes over the records of another folder that answer a task better than what is there.
fn join(lab: &Lab<'_>, tasks: &[Task], from: &Records, into: &Records) -> Result<(), CliError> {
    let (here, known, found) = (Origin::here(), into.read(tasks)?, from.read(tasks)?);
    for task in tasks {
        let answers = |record: &&Record| lab.is_answered(task, record, &here);
        let id = task.id();
        if known.get(&id).filter(answers).is_none()
            && let Some(record) = found.get(&id).filter(answers)
        {
            into.append(record)?;
        }
    }
    Ok(())
}

/// The first interruption lets the tasks end, another one does not. Batch systems send one to a process and again to its
/// group: what comes within a second is the same one.
pub fn watch_for_interruption() -> Result<(), CliError> {
    let mut first: Option<Instant> = None;
    ctrlc::set_handler(move || match first {
        None => {
            first = Some(Instant::now());
            STOP.store(true, Ordering::SeqCst);
            warn(format_args!(
                "Interrupted: finishing the tasks that are being measured"
            ));
        }
        Some(before) if before.elapsed() > Duration::from_secs(1) => std::process::exit(130),
        Some(_) => {}
    })
    .map_err(CliError::Interrupt)
}

/// Writes the report beside the records, and prints it; false if a method was wrong.
fn report(
    claim: &Claim,
    title: &str,
    input: &[(String, String)],
    total: usize,
    mut records: Vec<Record>,
) -> Result<bool, CliError> {
    mark_several(&mut records);
    let wrong = |r: &&Record| r.found.verdict.is_wrong();
    for record in records.iter().filter(wrong) {
        warn(format_args!("{}: {}", record.found.verdict, record.id));
    }
    let mut bundle = sweep::bundle(&records, total, &provenance(title, &records))?;
    add_input(&mut bundle, input.to_vec())?;
    page::add(&mut bundle)?;
    claim.commit(&bundle)?;
    let sweeps = sweeps(&records);
    if !sweeps.is_empty() {
        show(&OptionRow::of(&sweeps), "");
    }
    say(format_args!("Results: {}", claim.dir().display()));
    Ok(!records.iter().any(|r| wrong(&r)))
}

/// Of this program, which wrote the report, and where they differ of those that measured.
fn provenance(title: &str, records: &[Record]) -> Provenance {
    let here = Origin::here();
    let mut provenance = Provenance::collect(1).with_option("sweep", title);
    let others: BTreeSet<&Origin> = records.iter().map(|record| &record.origin).collect();
    for (number, origin) in others.into_iter().filter(|o| **o != here).enumerate() {
        provenance =
            provenance.with_option(format!("measured by {}", number + 1), origin.to_string());
    }
    provenance
}
