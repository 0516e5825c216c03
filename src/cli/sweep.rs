//! The verbs `study`, `merge` and `work`: sweeps of cells, each a record of its own.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::arguments::{Output, positive};
use super::error::CliError;
use super::output::{say, warn};
use super::progress::Bar;
use crate::report::{Claim, Provenance, page, plan, sweep};
use crate::studies::memory::is_short;
use crate::studies::stress;
use crate::studies::sweep::analysis::mark_several;
use crate::studies::sweep::conduct::{self, Conduct, Request, Shard, conduct};
use crate::studies::sweep::measure::Bench;
use crate::studies::sweep::merge::merge;
use crate::studies::sweep::plan::Plan;
use crate::studies::sweep::record::{Limits, Origin, Record};
use crate::studies::sweep::store::Store;
use crate::studies::worker::serve;

/// The sweep that is run without a file: work and precision of all methods.
const STANDARD: (&str, &str) = (
    "benches/study.toml",
    include_str!("../../benches/study.toml"),
);

/// Arguments of the verb `study`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Sweep file, or a folder of FCLIB files; by default the sweep of the project's own study
    sweep: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    /// Cells at the same time; times are recorded for 1 only
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Take no times, e.g. on a machine that others use
    #[arg(long)]
    untimed: bool,
    /// Part of the cells, e.g. 2/8; `merge` joins the parts and writes the report
    #[arg(long, value_parser = shard)]
    shard: Option<Shard>,
    /// Time limit per cell with set-up and repetitions, in s
    #[arg(long, default_value_t = 300.0, value_parser = positive)]
    time_limit: f64,
    /// Limit on the address space of the process of a cell, in MB
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    memory_limit: Option<u64>,
    /// Measure cells again whose record was made by another program or machine
    #[arg(long)]
    redo: bool,
    /// Print the ids of the cells, and measure nothing
    #[arg(long)]
    list: bool,
}

/// Arguments of the verb `merge`.
#[derive(Debug, clap::Args)]
pub struct MergeArguments {
    /// Folders with records
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Folder for all records and the report
    #[arg(long)]
    out: PathBuf,
    /// Merge records of different commits or machines, take the first of contradicting ones, and replace results of another
    /// plan in OUT
    #[arg(long)]
    force: bool,
}

/// Arguments of the verb `work`.
#[derive(Debug, clap::Args)]
pub struct WorkArguments {
    /// Limit on the address space, in MB
    #[arg(long)]
    memory_mb: Option<u64>,
    /// Examine scenes of `stress` instead of cells of `study`
    #[arg(long)]
    scenes: bool,
}

pub fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    match parts.map(|(number, of)| (number.parse(), of.parse())) {
        Some((Ok(number), Ok(of))) if 1 <= number && number <= of => Ok(Shard { number, of }),
        _ => Err("i/n with whole numbers 1 <= i <= n".into()),
    }
}

/// Set by an interruption.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Runs the verb `study`; false if cells are left, or in a whole sweep one claimed what does not hold or crashed.
pub fn run(arguments: Arguments) -> Result<bool, CliError> {
    let sweep = match &arguments.sweep {
        Some(folder) if folder.is_dir() => Plan::of_folder(folder)?,
        Some(file) => Plan::read(file)?,
        None => Plan::parse(STANDARD.0.as_ref(), STANDARD.1)?,
    };
    let shard = arguments.shard.unwrap_or(Shard::ALL);
    if arguments.list {
        let own = shard.cells(&sweep.tasks);
        own.iter().for_each(|task| say(format_args!("{}", task.id)));
        return Ok(true);
    }
    let name = arguments.sweep.as_deref().and_then(Path::file_stem);
    let name = name.map_or("study".into(), |name| name.to_string_lossy());
    // Shards measure different cells, so they may fill one folder.
    let claim = match arguments.shard {
        None => arguments.output.claim(&name, plan("study"))?,
        Some(_) => {
            let Output { force, .. } = arguments.output;
            Claim::shared(&arguments.output.folder(&name), plan("study"), force)?
        }
    };
    let store = Store::create(claim.dir(), sweep.contents(), arguments.output.force)?;
    claim.mark()?;
    let program = std::env::current_exe().map_err(CliError::Program)?;
    watch_for_interruption()?;
    if is_short(arguments.memory_limit) {
        warn(format_args!(
            "the shell bounds memory (ulimit -v or -d): a cell that is denied it ends this run"
        ));
    }
    let how = Conduct {
        program: &program,
        jobs: usize::from(arguments.jobs),
        timed: !arguments.untimed,
        limits: Limits {
            seconds: arguments.time_limit,
            memory_mb: arguments.memory_limit,
        },
        shard,
        redo: arguments.redo,
        stop: &STOP,
    };
    let bar = Bar::with_lines();
    let conducted = conduct(&sweep.tasks, sweep.repeats, &store, how, &bar)?;
    bar.finish();
    say(format_args!(
        "{} cells: {} measured before, {} now, {} left",
        conducted.cells,
        conducted.before,
        conducted.now,
        conducted.cells - conducted.before - conducted.now
    ));
    // A part is complete when its cells have a record, whatever it says; the report is written once, by `merge`.
    if arguments.shard.is_some() || !conducted.complete() {
        return Ok(conducted.complete());
    }
    report(&claim, &store, store.records()?)
}

/// The first interruption lets the cells end, another one does not. Batch systems send one to a process and again to its
/// group: what comes within a second is the same one.
pub fn watch_for_interruption() -> Result<(), CliError> {
    let mut first: Option<Instant> = None;
    ctrlc::set_handler(move || match first {
        None => {
            first = Some(Instant::now());
            STOP.store(true, Ordering::SeqCst);
            warn(format_args!(
                "Interrupted: finishing the cells that are being measured"
            ));
        }
        Some(before) if before.elapsed() > Duration::from_secs(1) => std::process::exit(130),
        Some(_) => {}
    })
    .map_err(CliError::Interrupt)
}

/// Runs the verb `merge`; false if cells are missing. What the cells say is in the report.
pub fn run_merge(arguments: MergeArguments) -> Result<bool, CliError> {
    let output = Output {
        out: Some(arguments.out.clone()),
        force: arguments.force,
    };
    let claim = output.claim("", plan("study"))?;
    let merged = merge(&arguments.folders, &arguments.out, arguments.force)?;
    let total = merged.store.contents().cells.len();
    say(format_args!("{} of {total} cells", merged.records.len()));
    for id in &merged.missing {
        warn(format_args!("missing: {id}"));
    }
    claim.mark()?;
    report(&claim, &merged.store, merged.records)?;
    Ok(merged.missing.is_empty())
}

/// Runs the verb `work`.
pub fn run_work(arguments: &WorkArguments) -> Result<bool, CliError> {
    // An interruption at the terminal reaches the whole group of processes; the conductor decides.
    ctrlc::set_handler(|| ()).map_err(CliError::Interrupt)?;
    end_with_parent().map_err(CliError::Work)?;
    let (input, output) = (std::io::stdin().lock(), std::io::stdout().lock());
    let memory = arguments.memory_mb;
    if arguments.scenes {
        serve(input, output, memory, stress::conduct::answer).map_err(CliError::Work)?;
    } else {
        let mut bench = Bench::default();
        let measured = |request: Request| conduct::answer(&mut bench, &request);
        serve(input, output, memory, measured).map_err(CliError::Work)?;
    }
    Ok(true)
}

/// A worker whose conductor was killed must not go on beside the next run, whose times it would disturb.
#[cfg(target_os = "linux")]
fn end_with_parent() -> std::io::Result<()> {
    use rustix::process::{Signal, set_parent_process_death_signal};
    Ok(set_parent_process_death_signal(Some(Signal::KILL))?)
}

/// Elsewhere a worker ends when it has answered and finds its input closed.
#[cfg(not(target_os = "linux"))]
fn end_with_parent() -> std::io::Result<()> {
    Ok(())
}

/// Writes the report beside the records, and prints it; false if a method was wrong.
fn report(claim: &Claim, store: &Store, mut records: Vec<Record>) -> Result<bool, CliError> {
    mark_several(&mut records);
    let wrong = |r: &&Record| r.found.verdict.is_wrong();
    for record in records.iter().filter(wrong) {
        warn(format_args!("{}: {}", record.found.verdict, record.id));
    }
    let total = store.contents().cells.len();
    let mut bundle = sweep::bundle(&records, total, &provenance(store, &records))?;
    page::add(&mut bundle)?;
    claim.commit(&bundle)?;
    for sentence in sweep::sensitivity_sentences(&records) {
        say(format_args!("{sentence}"));
    }
    say(format_args!("Results: {}", store.dir().display()));
    Ok(!records.iter().any(|r| wrong(&r)))
}

/// Of this program, which wrote the report, and where they differ of those that measured.
fn provenance(store: &Store, records: &[Record]) -> Provenance {
    let here = Origin::here();
    let mut provenance =
        Provenance::collect(1).with_option("sweep", store.contents().title.clone());
    let others: BTreeSet<&Origin> = records.iter().map(|record| &record.origin).collect();
    for (number, origin) in others.into_iter().filter(|o| **o != here).enumerate() {
        provenance =
            provenance.with_option(format!("measured by {}", number + 1), origin.to_string());
    }
    provenance
}
