//! A process with a time limit, and what it leaves behind.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// What a process says that an allocation ended: the runtimes of Rust, C++ and Python, and libraries that panic. Errors are
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

/// Runs a program in a folder, on one thread and with nothing on its standard input. None if it had to be ended, with all
/// processes that it started.
///
/// # Errors
/// Those of starting it.
pub fn run(command: &mut Command, folder: &Path, until: Instant) -> io::Result<Option<Ended>> {
    let (printed, complained) = (folder.join("stdout"), folder.join("stderr"));
    command
        .envs(THREADS.map(|name| (name, "1")))
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(File::create(&printed)?)
        .stderr(File::create(&complained)?);
    // A group of its own, so that it can be ended with all that it starts.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let begin = Instant::now();
    if begin >= until {
        return Ok(None);
    }
    let mut child = Group(command.spawn()?);
    let status = loop {
        if let Some(status) = child.0.try_wait()? {
            break status;
        }
        let now = Instant::now();
        if now >= until {
            return Ok(None);
        }
        let pause = (now - begin).mul_f64(LOOKS).clamp(SOONEST, LATEST);
        sleep(pause.min(until - now));
    };
    let seconds = begin.elapsed().as_secs_f64();
    let complaint = tail(&complained)?;
    let mut lines = complaint.lines().map(str::trim);
    Ok(Some(Ended {
        status,
        seconds,
        printed: tail(&printed)?,
        complaint: lines.rfind(|line| !line.is_empty()).map(str::to_owned),
    }))
}

/// A process that does not outlive its owner.
struct Group(Child);

impl Drop for Group {
    fn drop(&mut self) {
        // Once it was waited for, its number may be another's.
        if matches!(self.0.try_wait(), Ok(Some(_))) {
            return;
        }
        #[cfg(unix)]
        {
            use rustix::process::{Pid, Signal, kill_process_group};
            let _gone = kill_process_group(Pid::from_child(&self.0), Signal::KILL);
        }
        let _ended_before = self.0.kill();
        let _status = self.0.wait();
    }
}

/// The end of a file, with � for what is no text.
fn tail(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
    let mut bytes = Vec::new();
    file.take(TAIL).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
