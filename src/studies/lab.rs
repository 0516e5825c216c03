//! Has tasks measured: in this process, or each in a worker under limits, its record kept as soon as it is there.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::run::choice::{Choice, is_outside};
use crate::run::outside::Program;
use crate::run::progress::Progress;
use crate::run::verdict::Verdict;
use crate::studies::measure::{Bench, MeasureError, Repeats, in_turn};
use crate::studies::origin::{Limits, Origin};
use crate::studies::record::{Found, Record, Times};
use crate::studies::records::{Records, RecordsError};
use crate::studies::task::{Asked, Matter, Task, share_traction};
use crate::studies::worker::{Worker, WorkerError, share};

/// The argument that makes the program a worker that measures tasks.
const WORK: &[&str] = &["work"];

/// Request to a worker.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    /// Tasks that differ in the method alone.
    pub tasks: Vec<Task>,
    /// Their problem.
    pub matter: Matter,
    /// None: to measure the one task. Else to time all in turn, which have an honest answer each.
    pub repeats: Option<Repeats>,
    /// Time for the answer [s].
    pub seconds: f64,
}

/// Answer of a worker.
#[derive(Debug, Serialize, Deserialize)]
pub enum Reply {
    /// A task, measured.
    Measured(Box<Record>),
    /// Times by task, or what a method did wrong.
    Timed(Vec<Result<Times, Verdict>>),
}

/// The worker's side. The verdict tells that the case, its discretisation or its method cannot be used.
///
/// # Errors
/// As a verdict.
pub fn reply(bench: &mut Bench, request: Request) -> Result<Reply, Verdict> {
    // A program that this process leaves running would disturb the next task: it is ended before this process is.
    let until = Instant::now() + Duration::from_secs_f64(IN_TIME * request.seconds);
    let chosen = |task: &Task| chosen(&task.asked, request.seconds, until);
    let choices = request.tasks.iter().map(chosen);
    let choices = choices.collect::<Result<Vec<_>, _>>()?;
    let Some((first, choice)) = request.tasks.first().zip(choices.first()) else {
        return Err(Verdict::Crashed("nothing was asked".into()));
    };
    let mut task = first.clone();
    task.matter = request.matter.into();
    Ok(match request.repeats {
        None => Reply::Measured(Box::new(bench.record(&task, choice)?)),
        Some(repeats) => {
            let asked = request.tasks.iter().map(|task| &task.asked);
            let tasks: Vec<_> = asked.zip(&choices).collect();
            Reply::Timed(in_turn(&bench.scene(&task)?, &tasks, repeats))
        }
    })
}

/// Fraction of its time after which a program is ended.
const IN_TIME: f64 = 0.95;

/// The method of a task.
fn chosen(asked: &Asked, seconds: f64, until: Instant) -> Result<Choice, Verdict> {
    let choice = Choice::parse(&asked.method).map_err(MeasureError::from)?;
    if choice.program().map(Program::digest) != asked.program.as_deref() {
        let message = "the program was changed after it was planned with";
        return Err(Verdict::Crashed(message.into()));
    }
    Ok(choice.limited(seconds, Some(until)))
}

/// How tasks are measured.
#[derive(Debug, Clone, Copy)]
pub struct Lab<'a> {
    /// The program that has the verb `work`.
    pub program: &'a Path,
    /// Tasks at the same time; times are taken for one only.
    pub jobs: usize,
    /// How often for times; `None`: no times, e.g. on a machine that others use.
    pub repeats: Option<Repeats>,
    /// Limits on each.
    pub limits: Limits,
    /// Set from outside to end after the tasks that are being measured.
    pub stop: &'a AtomicBool,
}

/// A part of the tasks: they are dealt out in the order of the digests in their ids, which is as good as chance, so that
/// every part has its share of cheap and costly ones, and parts differ by one task at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub number: usize,
    /// How many there are.
    pub of: usize,
}

impl Shard {
    /// All tasks.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Its tasks, in the order of the plan.
    pub fn tasks(&self, tasks: Vec<Task>) -> Vec<Task> {
        let mut dealt: Vec<(usize, Task)> = tasks.into_iter().enumerate().collect();
        dealt.sort_by_cached_key(|(_, task)| task.id().rsplit('.').next().map(str::to_owned));
        let own = dealt.into_iter().skip(self.number - 1).step_by(self.of);
        let mut own: Vec<(usize, Task)> = own.collect();
        own.sort_by_key(|(place, _)| *place);
        own.into_iter().map(|(_, task)| task).collect()
    }
}

/// Why not all was measured, apart from being told to stop.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// The folder of records.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// The workers.
    #[error(transparent)]
    Worker(#[from] WorkerError),
}

/// Has tasks answered, whoever does.
pub trait Ask {
    /// The records of some tasks, in their order; fewer where it was told to stop.
    ///
    /// # Errors
    /// [`LabError`].
    fn ask(&mut self, tasks: &[Task]) -> Result<Vec<Record>, LabError>;
}

/// By workers, each record kept.
pub struct Workers<'a> {
    /// How.
    pub lab: Lab<'a>,
    /// Where records are kept.
    pub records: Records,
    /// Who is told.
    pub progress: &'a dyn Progress,
}

impl Ask for Workers<'_> {
    fn ask(&mut self, tasks: &[Task]) -> Result<Vec<Record>, LabError> {
        self.lab.measure(tasks, &self.records, self.progress)?;
        let mut known = self.records.read(tasks)?;
        Ok(tasks
            .iter()
            .filter_map(|task| known.remove(&task.id()))
            .collect())
    }
}

/// In this process, without limits and times; nothing is kept.
#[derive(Default)]
pub struct Inside {
    bench: Bench,
}

impl Ask for Inside {
    fn ask(&mut self, tasks: &[Task]) -> Result<Vec<Record>, LabError> {
        let mut record = |task: &Task| {
            let choice = Choice::parse(&task.asked.method).map_err(MeasureError::from);
            let found = choice.and_then(|choice| self.bench.record(task, &choice));
            found.unwrap_or_else(|error| unmeasured(task, error.into(), &Origin::here()))
        };
        Ok(tasks.iter().map(&mut record).collect())
    }
}

/// The record of a task that could not be measured.
pub fn unmeasured(task: &Task, verdict: Verdict, origin: &Origin) -> Record {
    let choice = Choice::parse(&task.asked.method).ok();
    let label = choice.as_ref().map_or(&task.asked.method, |c| &c.label);
    let exact = choice.as_ref().is_some_and(Choice::exact);
    let found = Found::only(verdict, label.clone(), exact);
    Record::by(origin, task, found, None)
}

impl Lab<'_> {
    /// Whether times are taken: not of tasks that share the machine.
    fn repeats(&self) -> Option<Repeats> {
        self.repeats.filter(|_| self.jobs == 1)
    }

    /// Whether a record answers a task, so that it is not measured again: it was found by this program, with the same limits where
    /// they decided, all that is looked at, and times of this machine where they are wanted.
    pub fn is_answered(&self, task: &Task, record: &Record, here: &Origin) -> bool {
        let limited = record.limits.is_some_and(|limits| limits != self.limits);
        let timed = || record.spent.is_some() && record.origin.machine == here.machine;
        let wants_times = self.repeats().is_some() && record.is_honest();
        record.origin.same_program(here)
            && record.asked.program == task.asked.program
            && record.looks.cover(task.looks)
            && !limited
            && (!wants_times || timed())
    }

    /// Measures the tasks whose record does not answer them yet; how many.
    ///
    /// # Errors
    /// The first [`LabError`]; records that were kept before it stay.
    pub fn measure(
        &self,
        tasks: &[Task],
        records: &Records,
        progress: &dyn Progress,
    ) -> Result<usize, LabError> {
        let (origin, known) = (Origin::here(), records.read(tasks)?);
        let answered = |task: &&Task| {
            let own = known.get(&task.id());
            own.is_some_and(|record| self.is_answered(task, record, &origin))
        };
        let left = tasks.iter().filter(|task| !answered(task));
        let left: Vec<Task> = left.cloned().collect();
        progress.plan(left.len());
        let done = AtomicUsize::new(0);
        let worker = || Worker::new(self.program, WORK, self.limits);
        share(
            &in_groups(left),
            self.jobs,
            self.stop,
            worker,
            |worker, group| {
                let mut honest = Vec::new();
                for task in group {
                    if self.stop.load(Ordering::SeqCst) {
                        return Ok(());
                    }
                    let mut record = self.one(task, worker, &origin)?;
                    // None until they are taken in turn, so that a run that ends here goes on with this task.
                    let spent = record.spent.take();
                    records.append(&record)?;
                    done.fetch_add(1, Ordering::SeqCst);
                    progress.done(&line(&record));
                    if self.repeats().is_some() && record.is_honest() {
                        honest.push((task, Record { spent, ..record }));
                    }
                }
                for record in self.with_times(honest, worker)? {
                    records.append(&record)?;
                }
                Ok::<(), LabError>(())
            },
        )?;
        Ok(done.into_inner())
    }

    fn one(
        &self,
        task: &Task,
        worker: &mut Worker<'_>,
        origin: &Origin,
    ) -> Result<Record, WorkerError> {
        let request = self.request(vec![task.clone()], None);
        let record = match worker
            .ask::<_, Result<Reply, Verdict>>(&request, 1)?
            .flatten()
        {
            Ok(Reply::Measured(record)) => *record,
            other => unmeasured(task, no_answer(other), origin),
        };
        self.checked(record)
    }

    /// The request for some tasks of one problem.
    fn request(&self, tasks: Vec<Task>, repeats: Option<Repeats>) -> Request {
        let matter = tasks.first().map(|task| (*task.matter).clone());
        Request {
            seconds: self.limits.seconds * tasks.len() as f64,
            matter: matter.unwrap_or(Matter::Bytes(Vec::new())),
            tasks,
            repeats,
        }
    }

    /// A record with the limits that ended it. None is made of what the shell denied.
    fn checked(&self, mut record: Record) -> Result<Record, WorkerError> {
        let verdict = &record.found.verdict;
        record.limits = verdict.kind().is_limit().then_some(self.limits);
        WorkerError::if_denied(&record.id, *verdict == Verdict::OutOfMemory, self.limits)?;
        Ok(record)
    }

    /// Honest records of one group with their times. Where the worker dies of them all, each is tried by itself.
    fn with_times(
        &self,
        records: Vec<(&Task, Record)>,
        worker: &mut Worker<'_>,
    ) -> Result<Vec<Record>, WorkerError> {
        let many = records.len();
        if many == 0 {
            return Ok(Vec::new());
        }
        let tasks = records.iter().map(|(task, _)| (*task).clone()).collect();
        let request = self.request(tasks, self.repeats());
        let verdict = match worker
            .ask::<_, Result<Reply, Verdict>>(&request, many)?
            .flatten()
        {
            Ok(Reply::Timed(times)) if times.len() == many => {
                let pairs = records.into_iter().zip(times);
                let timed = pairs.map(|((_, record), own)| self.checked(record.retimed(own)));
                return timed.collect();
            }
            _ if many > 1 => {
                let alone = records.into_iter().map(|own| vec![own]);
                let each = alone.map(|own| self.with_times(own, worker));
                return Ok(each.collect::<Result<Vec<_>, _>>()?.concat());
            }
            other => no_answer(other),
        };
        let broken = |(_, record): (_, Record)| record.retimed(Err(verdict.clone()));
        let broken = records.into_iter().map(broken);
        broken.map(|record| self.checked(record)).collect()
    }
}

/// Tasks of one problem and accuracy; neighbouring groups have the same body.
fn in_groups(mut tasks: Vec<Task>) -> Vec<Vec<Task>> {
    let key = |task: &Task| {
        let asked = task.asked.clone();
        let friction: Vec<u64> = asked.friction.iter().map(|mu| mu.to_bits()).collect();
        let finer = asked.finer.map(f64::to_bits);
        let path = (asked.increments, asked.cold);
        let (case, cracks) = ((asked.case, asked.digest), (asked.space, asked.tip));
        let body = (case, asked.refine, cracks);
        (body, friction, path, asked.tolerance.to_bits(), finer)
    };
    let needs_traction = |task: &Task| {
        // Programs need none, and their files need not be read for that.
        let choice = (!is_outside(&task.asked.method)).then(|| Choice::parse(&task.asked.method));
        choice.is_some_and(|choice| choice.is_ok_and(|own| own.needs_traction()))
    };
    tasks.sort_by_cached_key(key);
    share_traction(&mut tasks, needs_traction);
    let groups = tasks.chunk_by(|a, b| key(a) == key(b));
    groups.map(<[Task]>::to_vec).collect()
}

/// Why there is no answer of the kind asked for.
fn no_answer(reply: Result<Reply, Verdict>) -> Verdict {
    let other = || Verdict::Crashed("the worker answered what it was not asked".into());
    reply.err().unwrap_or_else(other)
}

/// One line on a task: id, verdict, iterations.
fn line(record: &Record) -> String {
    let Record { id, found, .. } = record;
    let iterations = found.sum(|i| i.iterations);
    format!("{id}: {}, {iterations} iterations", found.verdict)
}
