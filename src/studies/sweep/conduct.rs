//! Has the cells of a sweep measured, some at a time, and keeps every record as soon as it is there.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::analysis::is_honest;
use super::cell::Task;
use super::cell::{Cell, Source};
use super::measure::{Bench, MeasureError, Repeats, file_in_turn, in_turn, measure, measure_file};
use super::record::{Found, Limits, Origin, Record, SCHEMA, Times};
use super::store::{Store, StoreError};
use crate::run::choice::{Choice, is_outside};
use crate::run::outside::Program;
use crate::run::run_case::Progress;
use crate::run::verdict::Verdict;
use crate::studies::worker::{Worker, WorkerError, share};

/// What makes the program a worker that measures cells.
const WORK: &[&str] = &["work"];

/// What a worker is asked for.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    /// Cells that differ in the method alone.
    pub cells: Vec<Cell>,
    /// Their case file or problem file.
    pub source: Source,
    /// None: to measure the one cell. Else to time all in turn, which have an honest answer each.
    pub repeats: Option<Repeats>,
    /// Time for the answer [s].
    pub seconds: f64,
}

/// What a worker answers.
#[derive(Debug, Serialize, Deserialize)]
pub enum Answer {
    /// A cell, measured.
    Measured(Box<Record>),
    /// Times by cell, or what a method did wrong.
    Timed(Vec<Result<Times, Verdict>>),
}

/// The worker's side. The verdict tells that the case, its discretisation or its method cannot be used.
///
/// # Errors
/// As a verdict.
pub fn answer(bench: &mut Bench, request: &Request) -> Result<Answer, Verdict> {
    let Request {
        cells,
        source,
        repeats,
        seconds,
    } = request;
    // A program that this process leaves running would disturb the next cell: it is ended before this process is.
    let until = Instant::now() + Duration::from_secs_f64(IN_TIME * seconds);
    let choices = cells.iter().map(|cell| chosen(cell, *seconds, until));
    let choices = choices.collect::<Result<Vec<_>, _>>()?;
    let done = match (repeats, cells.as_slice(), choices.as_slice()) {
        (None, [cell], [choice]) => {
            let measured = match source {
                Source::Case(text) => measure(bench, cell, text, choice),
                Source::File(path) => measure_file(bench, cell, path, choice),
            };
            measured.map(|record| Answer::Measured(Box::new(record)))
        }
        (Some(repeats), ..) => match source {
            Source::Case(text) => in_turn(bench, cells, &choices, text, *repeats),
            Source::File(path) => file_in_turn(bench, cells, &choices, path, *repeats),
        }
        .map(Answer::Timed),
        (None, ..) => return Err(Verdict::Crashed("one cell is measured at a time".into())),
    };
    done.map_err(Into::into)
}

/// Fraction of its time after which a program is ended.
const IN_TIME: f64 = 0.95;

/// The method of a cell.
fn chosen(cell: &Cell, seconds: f64, until: Instant) -> Result<Choice, Verdict> {
    let choice = Choice::parse(&cell.method).map_err(MeasureError::from)?;
    if choice.program().map(Program::digest) != cell.program.as_deref() {
        let message = "the program was changed after the sweep began";
        return Err(Verdict::Crashed(message.into()));
    }
    Ok(choice.limited(seconds, Some(until)))
}

/// How the cells are measured.
#[derive(Debug, Clone, Copy)]
pub struct Conduct<'a> {
    /// The program that has the verb `work`.
    pub program: &'a Path,
    /// Cells at the same time; times are taken for one only.
    pub jobs: usize,
    /// Whether times are taken at all: not where others use the machine.
    pub timed: bool,
    /// Limits on each.
    pub limits: Limits,
    /// Which part of the cells.
    pub shard: Shard,
    /// Measure cells again whose record is of another program or machine; otherwise such a record is an error.
    pub redo: bool,
    /// Set from outside to end after the cells that are being measured.
    pub stop: &'a AtomicBool,
}

/// A part of the cells: they are dealt out in the order of the digests in their ids, which is as good as chance, so that
/// every part has its share of cheap and costly cells, and parts differ by one cell at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub number: usize,
    /// How many there are.
    pub of: usize,
}

impl Shard {
    /// All cells.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Its cells, in the order of the plan.
    pub fn cells<'a>(&self, tasks: &'a [Task]) -> Vec<&'a Task> {
        let digest = |k: &usize| tasks[*k].id.rsplit('.').next();
        let mut dealt: Vec<usize> = (0..tasks.len()).collect();
        dealt.sort_by_key(digest);
        let mut own: Vec<usize> = dealt
            .into_iter()
            .skip(self.number - 1)
            .step_by(self.of)
            .collect();
        own.sort_unstable();
        own.into_iter().map(|k| &tasks[k]).collect()
    }
}

/// What was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Conducted {
    /// Cells of this shard.
    pub cells: usize,
    /// Of these, measured before.
    pub before: usize,
    /// Measured now.
    pub now: usize,
}

impl Conducted {
    /// Whether nothing is left.
    pub fn complete(&self) -> bool {
        self.before + self.now == self.cells
    }
}

/// Why a sweep ended early, apart from being told to.
#[derive(Debug, thiserror::Error)]
pub enum ConductError {
    /// The folder of records.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The workers.
    #[error(transparent)]
    Worker(#[from] WorkerError),
}

/// Measures the cells of a shard that have no record yet.
///
/// # Errors
/// The first [`ConductError`]; records that were kept before it stay.
pub fn conduct(
    tasks: &[Task],
    repeats: Repeats,
    store: &Store,
    how: Conduct<'_>,
    progress: &dyn Progress,
) -> Result<Conducted, ConductError> {
    let origin = Origin::here();
    // Times of cells that share the machine mean nothing, so none are taken.
    let timed = how.timed && how.jobs == 1;
    let own = how.shard.cells(tasks);
    let mut left = Vec::new();
    for task in &own {
        match store.get(&task.id)? {
            None => left.push(*task),
            Some(record) if how.redo && record.origin.difference(&origin).is_some() => {
                left.push(*task);
            }
            Some(record) => {
                store.check_origin(&record, &origin, REMEDY)?;
                let other_limits = record.limits.is_some_and(|limits| limits != how.limits);
                let untimed = timed && is_honest(&record) && record.spent.is_none();
                let other_program = record.cell.program != task.cell.program;
                if other_limits || untimed || other_program {
                    left.push(*task);
                }
            }
        }
    }
    progress.plan(left.len());

    let done = AtomicUsize::new(0);
    let worker = || Worker::new(how.program, WORK, how.limits);
    let groups = in_groups(left.clone());
    let seconds = how.limits.seconds;
    share(&groups, how.jobs, how.stop, worker, |worker, group| {
        let mut records = Vec::new();
        for task in group {
            if how.stop.load(Ordering::SeqCst) {
                return Ok(());
            }
            let mut record = one(task, how.limits, worker, &origin)?;
            denied(&record, how.limits)?;
            // None until they are taken in turn, so that a run that ends here goes on with this cell.
            let spent = record.spent.take().filter(|_| timed);
            store.put(&record)?;
            done.fetch_add(1, Ordering::SeqCst);
            record.spent = spent;
            progress.done(&line(&record));
            records.push(record);
        }
        records.retain(|record| timed && is_honest(record));
        for mut record in with_times(records, &group[0].source, repeats, seconds, worker)? {
            denied(&record, how.limits)?;
            record.limits = limits_of(&record, how.limits);
            store.put(&record)?;
        }
        Ok::<(), ConductError>(())
    })?;
    Ok(Conducted {
        cells: own.len(),
        before: own.len() - left.len(),
        now: done.into_inner(),
    })
}

const REMEDY: &str = "choose another folder, or --redo to measure such cells again";

/// Cells of one problem, tolerance and body: methods that need more of it stand apart.
fn in_groups(mut tasks: Vec<&Task>) -> Vec<Vec<&Task>> {
    let traction = |task: &Task| {
        // Whose file need not be read for that.
        if is_outside(&task.cell.method) {
            return false;
        }
        let choice = Choice::parse(&task.cell.method);
        choice.is_ok_and(|choice| choice.needs_traction())
    };
    // Neighbouring groups have the same body.
    let key = |task: &&Task| {
        let Cell {
            case,
            digest,
            refine,
            space,
            friction,
            increments,
            cold,
            tolerance,
            ..
        } = &task.cell;
        let problem = (case.clone(), digest.clone(), *refine, space.clone());
        let coefficients: Vec<u64> = friction.iter().map(|mu| mu.to_bits()).collect();
        let path = (*increments, *cold);
        (
            problem,
            traction(task),
            coefficients,
            path,
            tolerance.to_bits(),
        )
    };
    tasks.sort_by_cached_key(key);
    let same = |a: &&Task, b: &&Task| key(a) == key(b);
    tasks.chunk_by(same).map(<[&Task]>::to_vec).collect()
}

/// Honest records of one group with their times. Where the worker dies of them all, each is tried by itself.
fn with_times(
    records: Vec<Record>,
    source: &Source,
    repeats: Repeats,
    seconds: f64,
    worker: &mut Worker<'_>,
) -> Result<Vec<Record>, WorkerError> {
    let request = Request {
        cells: records.iter().map(|record| record.cell.clone()).collect(),
        source: source.clone(),
        repeats: Some(repeats),
        seconds: seconds * records.len() as f64,
    };
    let answer = match records.len() {
        0 => return Ok(records),
        many => worker.ask::<_, Result<Answer, Verdict>>(&request, many)?,
    };
    let verdict = match answer.and_then(|answer| answer) {
        Ok(Answer::Timed(times)) if times.len() == records.len() => {
            let pairs = records.into_iter().zip(times);
            return Ok(pairs.map(|(record, own)| record.retimed(own)).collect());
        }
        _ if records.len() > 1 => {
            let alone = records.into_iter().map(|record| vec![record]);
            let each = alone.map(|record| with_times(record, source, repeats, seconds, worker));
            return Ok(each.collect::<Result<Vec<_>, _>>()?.concat());
        }
        other => no_answer(other),
    };
    let broken = |record: Record| record.retimed(Err(verdict.clone()));
    Ok(records.into_iter().map(broken).collect())
}

/// Why there is no answer of the kind asked for.
fn no_answer(answer: Result<Answer, Verdict>) -> Verdict {
    let other = || Verdict::Crashed("the worker answered what it was not asked".into());
    answer.err().unwrap_or_else(other)
}

fn one(
    task: &Task,
    limits: Limits,
    worker: &mut Worker<'_>,
    origin: &Origin,
) -> Result<Record, ConductError> {
    let request = Request {
        cells: vec![task.cell.clone()],
        source: (*task.source).clone(),
        repeats: None,
        seconds: limits.seconds,
    };
    let answer = worker.ask::<_, Result<Answer, Verdict>>(&request, 1)?;
    let mut record = match answer.and_then(|answer| answer) {
        Ok(Answer::Measured(record)) => *record,
        other => {
            let choice = Choice::parse(&task.cell.method).ok();
            let label = choice.as_ref().map_or(&task.cell.method, |c| &c.label);
            let exact = choice.as_ref().is_some_and(Choice::exact);
            Record {
                schema: SCHEMA,
                id: task.id.clone(),
                cell: task.cell.clone(),
                origin: origin.clone(),
                limits: None,
                found: Found::only(no_answer(other), label.clone(), exact),
                spent: None,
            }
        }
    };
    record.limits = limits_of(&record, limits);
    Ok(record)
}

/// That no record is made of what the shell denied.
fn denied(record: &Record, limits: Limits) -> Result<(), WorkerError> {
    WorkerError::if_denied(
        &record.id,
        record.found.verdict == Verdict::OutOfMemory,
        limits,
    )
}

fn limits_of(record: &Record, limits: Limits) -> Option<Limits> {
    let ended = record.found.verdict.kind().is_limit();
    ended.then_some(limits)
}

/// One line on a cell: id, verdict, and what it took.
fn line(record: &Record) -> String {
    let Record {
        id, found, spent, ..
    } = record;
    let iterations = found.sum(|i| i.iterations);
    let time = spent.as_ref().map_or_else(String::new, |spent| {
        format!(", {:.3} ms", 1e3 * spent.solve.median_s)
    });
    format!("{id}: {}, {iterations} iterations{time}", found.verdict)
}
