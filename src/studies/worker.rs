//! Work in a process of its own, so that a time limit can end it and a memory limit costs nothing but it.
//!
//! The conductor starts `stickslip work`, writes a request per line to its standard input and reads an answer per line from
//! its standard output. A worker that does not answer in time is killed; one that dies is read as the verdict on its request.
//! Either way the next one gets a new worker.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::memory;
use super::origin::Limits;
use crate::run::outside::process::denied;
use crate::run::verdict::Verdict;

/// Why there is no answer, for a reason that says nothing on what was asked.
#[derive(Debug, thiserror::Error)]
#[error("{what}: {why}; nothing is kept of it, the same command goes on from here")]
pub struct WorkerError {
    /// End of a process that measures.
    pub what: String,
    /// Why.
    pub why: String,
}

impl WorkerError {
    /// That memory was denied by somebody else's limit, where it was: such an end says nothing about what was asked.
    ///
    /// # Errors
    /// That error.
    pub fn if_denied(what: &str, denied: bool, limits: Limits) -> Result<(), Self> {
        if denied && memory::is_short(limits.memory_mb) {
            Err(Self {
                what: what.into(),
                why: "denied memory by a limit of the shell (ulimit -v or -d), not by one that was asked for".into(),
            })
        } else {
            Ok(())
        }
    }
}

/// First line of a worker, once it has begun under its limits: what ends it later may be what it was asked.
const READY: &str = "ready";

/// Time for that [s].
const START: f64 = 60.0;

/// The worker's side: answers what it is asked until its input ends.
///
/// # Errors
/// Input or output that breaks, a memory limit the system refuses.
pub fn serve<Q: DeserializeOwned, A: Serialize>(
    input: impl BufRead,
    mut output: impl Write,
    memory_mb: Option<u64>,
    mut answer: impl FnMut(Q) -> A,
) -> std::io::Result<()> {
    if let Some(megabytes) = memory_mb {
        memory::bound(megabytes)?;
    }
    // A record names what went wrong, not where in which build: neither threads nor folders of a machine.
    std::panic::set_hook(Box::new(|panic| {
        let payload = panic.payload();
        let literal = payload.downcast_ref::<&str>().copied();
        let formatted = payload.downcast_ref::<String>().map(String::as_str);
        let payload = literal.or(formatted).unwrap_or("of unknown kind");
        let text: Vec<&str> = payload.lines().collect();
        let _nobody_listens = writeln!(std::io::stderr(), "panic: {}", text.join(" "));
    }));
    writeln!(output, "{READY}")?;
    output.flush()?;
    for line in input.lines() {
        let mut json = serde_json::to_vec(&answer(serde_json::from_str(&line?)?))?;
        json.push(b'\n');
        output.write_all(&json)?;
        output.flush()?;
    }
    Ok(())
}

/// Shares tasks among some workers at a time. After the first error, or when told to stop, what has begun is ended and nothing
/// else is begun.
///
/// # Errors
/// The first error of a task.
pub fn share<'a, T: Sync, E: Send>(
    tasks: &[T],
    jobs: usize,
    stop: &AtomicBool,
    worker: impl Fn() -> Worker<'a> + Sync,
    task: impl Fn(&mut Worker<'a>, &T) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let failure: Mutex<Option<E>> = Mutex::new(None);
    let failed = || failure.lock().map_or(true, |f| f.is_some());
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                let mut worker = worker();
                while !stop.load(Ordering::SeqCst) && !failed() {
                    let Some(own) = tasks.get(next.fetch_add(1, Ordering::SeqCst)) else {
                        break;
                    };
                    if let Err(error) = task(&mut worker, own)
                        && let Ok(mut failure) = failure.lock()
                    {
                        failure.get_or_insert(error);
                    }
                }
            });
        }
    });
    failure.into_inner().ok().flatten().map_or(Ok(()), Err)
}

/// The conductor's side: a worker that is started when it is first needed, and again after it was lost.
pub struct Worker<'a> {
    program: &'a Path,
    arguments: &'a [&'a str],
    limits: Limits,
    running: Option<Running>,
}

struct Running {
    child: Child,
    input: ChildStdin,
    lines: Receiver<String>,
    complaints: std::thread::JoinHandle<String>,
}

impl<'a> Worker<'a> {
    /// A worker of that program, whose arguments make it [`serve`].
    pub fn new(program: &'a Path, arguments: &'a [&'a str], limits: Limits) -> Self {
        Self {
            program,
            arguments,
            limits,
            running: None,
        }
    }

    /// Has one request answered, in the time of so many; where the worker dies of it, by the verdict on that.
    ///
    /// # Errors
    /// [`WorkerError`].
    pub fn ask<Q: Serialize, A: DeserializeOwned>(
        &mut self,
        request: &Q,
        many: usize,
    ) -> Result<Result<A, Verdict>, WorkerError> {
        let mut running = match self.running.take() {
            Some(running) => running,
            None => self.start()?,
        };
        let mut line = serde_json::to_vec(request).unwrap_or_default();
        line.push(b'\n');
        // A worker that is already gone is found out below.
        let _gone = running
            .input
            .write_all(&line)
            .and_then(|()| running.input.flush());
        let limit = Duration::from_secs_f64(self.limits.seconds * many as f64);
        let verdict = match running.lines.recv_timeout(limit) {
            Ok(line) => match serde_json::from_str(&line) {
                Ok(answer) => {
                    self.running = Some(running);
                    return Ok(Ok(answer));
                }
                Err(_) => {
                    running.kill();
                    Verdict::Crashed("the worker answered what is no record".into())
                }
            },
            Err(RecvTimeoutError::Timeout) => {
                running.kill();
                Verdict::TimedOut
            }
            Err(RecvTimeoutError::Disconnected) => running.post_mortem()?,
        };
        Ok(Err(verdict))
    }

    fn start(&self) -> Result<Running, WorkerError> {
        let failed = |source: std::io::Error| WorkerError {
            what: format!("cannot start `{}`", self.program.display()),
            why: source.to_string(),
        };
        let mut command = Command::new(self.program);
        command.args(self.arguments);
        if let Some(megabytes) = self.limits.memory_mb {
            command.arg("--memory-mb").arg(megabytes.to_string());
        }
        // One thread: times of methods are compared, not of thread pools.
        let piped = command
            .env("RAYON_NUM_THREADS", "1")
            // The C library reserves address space per arena, as many as threads happen to meet: limits would be luck.
            .env("MALLOC_ARENA_MAX", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = piped.spawn().map_err(failed)?;
        let missing = || failed(std::io::ErrorKind::BrokenPipe.into());
        let input = child.stdin.take().ok_or_else(missing)?;
        let output = child.stdout.take().ok_or_else(missing)?;
        let mut errors = child.stderr.take().ok_or_else(missing)?;
        let (send, lines) = channel();
        std::thread::spawn(move || {
            let all = BufReader::new(output).lines().map_while(Result::ok);
            // The conductor has stopped listening when it has killed the worker.
            all.take_while(|line| send.send(line.clone()).is_ok())
                .for_each(drop);
        });
        let complaints = std::thread::spawn(move || {
            let mut text = Vec::new();
            let _unreadable = errors.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        let mut running = Running {
            child,
            input,
            lines,
            complaints,
        };
        match running.lines.recv_timeout(Duration::from_secs_f64(START)) {
            Ok(line) if line == READY => Ok(running),
            _ => {
                let _ended_before = running.child.kill();
                let (status, complaint) = running.ended();
                Err(WorkerError {
                    what: "a process that measures did not start".into(),
                    why: format!("{}: {complaint}", told(&status)),
                })
            }
        }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        if let Some(running) = self.running.take() {
            running.kill();
        }
    }
}

impl Running {
    fn kill(mut self) {
        let _ended_before = self.child.kill();
        let _status = self.child.wait();
    }

    /// How it ended, and the first line of its complaints.
    fn ended(mut self) -> (std::io::Result<ExitStatus>, String) {
        drop(self.input);
        let status = self.child.wait();
        let complaints = self.complaints.join().unwrap_or_default();
        let first = complaints.lines().find(|line| !line.is_empty());
        (status, first.unwrap_or_default().to_owned())
    }

    /// Why the worker died of its request.
    fn post_mortem(self) -> Result<Verdict, WorkerError> {
        let (status, complaint) = self.ended();
        let ended = told(&status);
        match complaint.as_str() {
            _ if status.is_ok_and(from_outside) => Err(WorkerError {
                what: "a process that measures was ended by the system for want of memory, a limit of the shell, or by hand"
                    .into(),
                why: ended,
            }),
            line if denied(line) => Ok(Verdict::OutOfMemory),
            "" => Ok(Verdict::Crashed(ended)),
            line => Ok(Verdict::Crashed(format!("{ended}: {line}"))),
        }
    }
}

fn told(status: &std::io::Result<ExitStatus>) -> String {
    let told = status.as_ref().map(ExitStatus::to_string);
    told.unwrap_or_else(|e| e.to_string())
}

/// Whether a process was ended by a signal that it does not bring upon itself; this one kills what is past its time, and
/// does not ask how that ended.
fn from_outside(status: ExitStatus) -> bool {
    #[cfg(unix)]
    {
        use rustix::process::Signal;
        use std::os::unix::process::ExitStatusExt;
        let own = [
            Signal::ABORT,
            Signal::BUS,
            Signal::FPE,
            Signal::ILL,
            Signal::SEGV,
        ];
        let own = own.map(Signal::as_raw);
        status.signal().is_some_and(|signal| !own.contains(&signal))
    }
    #[cfg(not(unix))]
    false
}
