//! Has the cells of a sweep measured, some at a time, and keeps every record as soon as it is there.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use serde::{Deserialize, Serialize};

use super::analysis::is_honest;
use super::cell::Cell;
use super::measure::{Bench, Repeats, measure};
use super::plan::Task;
use super::record::{Found, Limits, Origin, Record, SCHEMA};
use super::store::{Store, StoreError};
use crate::run::choice::Choice;
use crate::run::run_case::Progress;
use crate::run::verdict::Verdict;
use crate::studies::worker::{Worker, WorkerError, share};

/// What makes the program a worker that measures cells.
const WORK: &[&str] = &["work"];

/// One cell to measure.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    /// The cell.
    pub cell: Cell,
    /// Its case file.
    pub text: String,
    /// How often to repeat it.
    pub repeats: Repeats,
}

/// The worker's side: measures a cell. The verdict tells that the case, its discretisation or its method cannot be used.
///
/// # Errors
/// As a verdict.
pub fn answer(bench: &mut Bench, request: &Request) -> Result<Box<Record>, Verdict> {
    let Request {
        cell,
        text,
        repeats,
    } = request;
    let choice = Choice::parse(&cell.method).map_err(Into::into);
    let measured = choice.and_then(|choice| measure(bench, cell, text, &choice, *repeats));
    measured.map(Box::new).map_err(Into::into)
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
    let repeats = if timed { repeats } else { Repeats::NONE };
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
                if other_limits || untimed {
                    left.push(*task);
                }
            }
        }
    }
    let ids: Vec<String> = left.iter().map(|task| task.id.clone()).collect();
    store.clear_partial(&ids)?;
    progress.plan(left.len());

    let done = AtomicUsize::new(0);
    let worker = || Worker::new(how.program, WORK, how.limits);
    share(&left, how.jobs, how.stop, worker, |worker, task| {
        let record = one(task, repeats, how.limits, worker, &origin)?;
        store.put(&record)?;
        done.fetch_add(1, Ordering::SeqCst);
        progress.done(&line(&record));
        Ok::<(), ConductError>(())
    })?;
    Ok(Conducted {
        cells: own.len(),
        before: own.len() - left.len(),
        now: done.into_inner(),
    })
}

const REMEDY: &str = "choose another folder, or --redo to measure such cells again";

fn one(
    task: &Task,
    repeats: Repeats,
    limits: Limits,
    worker: &mut Worker<'_>,
    origin: &Origin,
) -> Result<Record, ConductError> {
    let request = Request {
        cell: task.cell.clone(),
        text: task.text.to_string(),
        repeats,
    };
    let answer = worker.ask::<_, Result<Box<Record>, Verdict>>(&request)?;
    let mut record = match answer.and_then(|answer| answer) {
        Ok(record) => *record,
        Err(verdict) => {
            let choice = Choice::parse(&task.cell.method).ok();
            let label = choice.as_ref().map_or(&task.cell.method, |c| &c.label);
            let exact = choice.as_ref().is_some_and(|c| c.method.exact);
            Record {
                schema: SCHEMA,
                id: task.id.clone(),
                cell: task.cell.clone(),
                origin: origin.clone(),
                limits: None,
                found: Found::only(verdict, label.clone(), exact),
                spent: None,
            }
        }
    };
    record.limits = record.found.verdict.kind().is_limit().then_some(limits);
    Ok(record)
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
