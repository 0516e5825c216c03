//! A process with limits on time and output, and what it leaves behind.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::guard::Guarded;

/// Last words of a process that an allocation ended: the runtimes of Rust, C++ and Python, and libraries that panic. Errors are
/// told by type, but a dead process left words only.
const DENIED: [&str; 5] = [
    "memory allocation of",
    "out of memory",
    "OutOfMemory",
    "std::bad_alloc",
    "MemoryError",
];

/// Whether a line says that memory was denied.
pub fn denied(line: &str) -> bool {
    DENIED.iter().any(|words| line.contains(words))
}

/// Variables that keep libraries to one thread: times of methods are compared, not of thread pools.
const THREADS: [&str; 4] = [
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "RAYON_NUM_THREADS",
];

/// How a process ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit code or signal.
    pub status: ExitStatus,
    /// From its start to its end, on the wall clock; late by 2 %, or 5 ms, at most [s].
    pub seconds: f64,
    /// The end of what it printed.
    pub printed: String,
    /// The last line of its complaints.
    pub complaint: Option<String>,
}

/// How often to look whether a process has ended, as a fraction of what it took so far.
const LOOKS: f64 = 0.02;
const SOONEST: Duration = Duration::from_micros(20);
const LATEST: Duration = Duration::from_millis(5);

/// Bytes that are read of what a process printed.
const TAIL: u64 = 1 << 16;

/// Most bytes that it may print, and complain.
const MOST: u64 = 64 << 20;

/// A process that has begun.
pub struct Running<'a> {
    child: Child,
    folder: &'a mut Guarded,
    begin: Instant,
    /// Its output and complaints: the files themselves, for their names may come to stand for a pipe.
    streams: [File; 2],
}

impl<'a> Running<'a> {
    /// Starts a program in a guarded folder, on one thread and with nothing on its standard input.
    ///
    /// # Errors
    /// Those of starting it.
    pub fn start(command: &mut Command, folder: &'a mut Guarded) -> io::Result<Self> {
        let stream = |name| {
            let mut new = OpenOptions::new();
            new.read(true).write(true).create_new(true);
            new.open(folder.path().join(name))
        };
        let streams = [stream("stdout")?, stream("stderr")?];
        command
            .envs(THREADS.map(|name| (name, "1")))
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(streams[0].try_clone()?)
            .stderr(streams[1].try_clone()?);
        #[cfg(unix)]
        folder.hold(command);
        let begin = Instant::now();
        Ok(Self {
            child: command.spawn()?,
            folder,
            begin,
            streams,
        })
    }

    /// Waits for its end, which is that of its whole group; none if time ended it.
    ///
    /// # Errors
    /// More output than it may leave: on a stream, or as the file `answer` of at most `most` bytes. Those of waiting.
    pub fn wait(mut self, until: Instant, answer: &Path, most: u64) -> io::Result<Option<Ended>> {
        let seconds = self.watch(until, answer, most);
        let status = self.kill()?;
        let Some(seconds) = seconds? else {
            return Ok(None);
        };
        let [printed, complaint] = self.streams.map(tail);
        let complaint = complaint?;
        let mut lines = complaint.lines().map(str::trim);
        Ok(Some(Ended {
            status,
            seconds,
            printed: printed?,
            complaint: lines.rfind(|line| !line.is_empty()).map(str::to_owned),
        }))
    }

    fn watch(&mut self, until: Instant, answer: &Path, most: u64) -> io::Result<Option<f64>> {
        loop {
            let ended = has_ended(&mut self.child)?;
            let now = Instant::now();
            let taken = now - self.begin;
            for (what, size, most) in [
                ("standard output", self.streams[0].metadata()?.len(), MOST),
                ("standard error", self.streams[1].metadata()?.len(), MOST),
                (
                    "REACTION",
                    answer.symlink_metadata().map_or(0, |a| a.len()),
                    most,
                ),
            ] {
                if size > most {
                    let what = format!("{what} has more than {most} bytes");
                    return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
                }
            }
            if ended {
                return Ok(Some(taken.as_secs_f64()));
            }
            if now >= until {
                return Ok(None);
            }
            let pause = taken.mul_f64(LOOKS).clamp(SOONEST, LATEST);
            sleep(pause.min(until - now));
        }
    }

    /// Ends the group, and the program if it left that.
    fn kill(&mut self) -> io::Result<ExitStatus> {
        self.folder.end();
        let _ended_before = self.child.kill();
        self.child.wait()
    }
}

/// Whether a process has ended, which is left to be waited for.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> io::Result<bool> {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let look = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    Ok(waitid(WaitId::Pid(Pid::from_child(child)), look)?.is_some())
}

/// Whether a process has ended.
#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> io::Result<bool> {
    Ok(child.try_wait()?.is_some())
}

/// The end of a file, with � for what is no text.
fn tail(mut file: File) -> io::Result<String> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
    let mut bytes = Vec::new();
    file.take(TAIL).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
