//! Methods from outside: any program that reads a contact problem from a file and writes reactions into another.
//!
//! ```text
//! PROGRAM problem.hdf5 reaction.txt TOLERANCE SECONDS
//! problem.hdf5     u = W r + V λ + q,  Vᵀ r + s = 0, and the contact laws      FCLIB local problem
//! reaction.txt     r, then λ                                                   numbers as text
//! exit code        0 solved, 3 gave up, 4 cannot treat it, else crashed
//! ```
//! docs/protocol.md is the contract. The program is believed nothing: displacements are recovered from its reactions here,
//! and the judge says what they are worth. Only the process is timed as the method, from its start to its end; files are
//! written and read outside that.

mod answer;
mod guard;
pub mod process;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use stickslip_methods::{
    Claim, Counters, Enforcement, Increment, LocalForm, MethodError, Monitor, Needs, Outcome,
    Status,
};

use crate::files::digest::sha256;
use crate::files::interchange::{Info, LocalProblem, Problem, Solution};
use crate::files::regular;
use crate::files::visible::{excerpt, is_label};
use crate::run::local_problem::{local_velocity, unsolved};
use answer::{Said, reactions, said};
use guard::Guarded;
use process::{Ended, Running, denied};

/// Beginning of the argument of a method from outside.
pub const OUTSIDE: &str = "exec:";

/// Seconds for one increment, unless said otherwise.
pub const SECONDS: f64 = 300.0;

/// Exit codes that are no crash.
const SOLVED: i32 = 0;
const GAVE_UP: i32 = 3;
const REFUSED: i32 = 4;

/// Fraction of the tolerance that the program is asked for: the rest is for what rounding adds when displacements are
/// recovered, as methods here leave it.
pub const ASKED: f64 = 0.5;

/// Largest program [bytes].
const MAX_PROGRAM: u64 = 4 << 30;

/// Longest complaint of a program that is shown [characters].
const SHOWN: usize = 200;

/// A program as a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// As given.
    path: String,
    /// Where it lies, whatever the working directory.
    file: PathBuf,
    /// Name of the file.
    name: String,
    /// SHA-256 of the file, the first 16 hexadecimal digits.
    digest: String,
    /// Wall-clock time for one increment [s].
    seconds: f64,
    /// When it has to have ended whatever it began.
    until: Option<Instant>,
}

impl Program {
    /// The program in a file.
    ///
    /// # Errors
    /// Why it cannot be one, in words.
    pub fn find(path: &str) -> Result<Self, String> {
        let file = std::path::absolute(path).map_err(|e| e.to_string())?;
        let bytes = regular::read(&file, MAX_PROGRAM).map_err(|e| e.to_string())?;
        executable(&file)?;
        let name = file.file_name().map(|name| name.to_string_lossy());
        let name = name.filter(|name| is_label(name) && path.chars().all(|c| !c.is_control()));
        Ok(Self {
            name: name.ok_or("its name is not visible text")?.into_owned(),
            path: path.to_owned(),
            file,
            digest: sha256(&bytes)[..16].to_owned(),
            seconds: SECONDS,
            until: None,
        })
    }

    /// As given: what [`find`](Self::find) reads.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Name of the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// SHA-256 of the file, the first 16 hexadecimal digits.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// With a limit on every increment, and one on all together.
    pub fn limited(self, seconds: f64, until: Option<Instant>) -> Self {
        Self {
            seconds,
            until,
            ..self
        }
    }
}

/// Refuses a file that the system would not start.
#[cfg(unix)]
fn executable(file: &Path) -> Result<(), String> {
    use std::os::unix::fs::PermissionsExt;
    let described = std::fs::metadata(file).map_err(|e| e.to_string())?;
    match described.permissions().mode() & 0o111 {
        0 => Err("it is not executable; `chmod +x` makes it so".into()),
        _ => Ok(()),
    }
}

/// Elsewhere no shell can guard it.
#[cfg(not(unix))]
fn executable(_: &Path) -> Result<(), String> {
    Err("methods from outside need a POSIX system".into())
}

/// The method that asks a program.
pub struct Outside {
    program: Program,
    reported_s: Option<f64>,
}

impl Outside {
    /// Of a program.
    pub fn new(program: Program) -> Self {
        Self {
            program,
            reported_s: None,
        }
    }

    /// When it has to have ended, begun now.
    fn until(&self) -> Instant {
        let own = Instant::now() + Duration::from_secs_f64(self.program.seconds);
        self.program.until.map_or(own, |all| all.min(own))
    }
}

impl Enforcement for Outside {
    fn solve(
        &mut self,
        increment: &Increment<'_>,
        _: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        self.reported_s = None;
        let elastic = increment.system.elastic();
        let form = increment.local_form()?;
        if let Some(known) = known(increment, &form) {
            return known;
        }
        let mut folder = elastic
            .on_body(|| Folder::new(increment, &form))?
            .map_err(failed)?;
        let until = self.until();
        if Instant::now() >= until {
            return Err(MethodError::TimeLimit);
        }
        let (reaction, most) = (folder.reaction(), folder.most(&form));
        let mut command = Command::new(&self.program.file);
        command
            .args([&folder.problem(), &reaction])
            .arg(format!("{:e}", ASKED * increment.tolerance))
            .arg(self.program.seconds.to_string());
        let running = Running::start(&mut command, &mut folder.guarded);
        let cannot = |e| failed(format!("cannot start {}: {e}", self.program.name));
        let ended = running.map_err(cannot)?.wait(until, &reaction, most);
        let ended = ended.map_err(|e| failed(e.to_string()))?;
        let ended = ended.ok_or(MethodError::TimeLimit)?;
        let Answer {
            status,
            said,
            found,
        } = elastic.on_body(|| folder.answer(&ended, &form))??;
        // More than all of the process took is no account of it.
        self.reported_s = said.seconds.filter(|own| *own <= ended.seconds);
        let found = found.as_deref().map(|all| all.split_at(form.q.len()));
        outcome(increment, status, said.iterations, found)
    }

    fn needs(&self) -> Needs {
        // The program declines what it cannot treat.
        Needs::ANY_OPERATOR
    }

    fn reported_s(&self) -> Option<f64> {
        self.reported_s
    }
}

/// The outcome where nobody has to be asked: rigid motions that no contact force holds, or no contact points.
pub fn known(increment: &Increment<'_>, form: &LocalForm) -> Option<Result<Outcome, MethodError>> {
    match (form.loose, form.q.is_empty()) {
        (0, false) => None,
        (0, true) => Some(outcome(increment, Status::Converged, 0, Some((&[], &[])))),
        _ => Some(outcome(increment, Status::Mechanism, 0, None)),
    }
}

/// The state of reactions and amplitudes, or the one the increment started from.
///
/// # Errors
/// Arrays of another length.
pub fn outcome(
    increment: &Increment<'_>,
    status: Status,
    iterations: usize,
    found: Option<(&[f64], &[f64])>,
) -> Result<Outcome, MethodError> {
    let state = match found {
        Some((r, amplitudes)) => increment.state_of(r, amplitudes)?,
        None => increment.start.clone(),
    };
    Ok(Outcome {
        status,
        claim: Claim::Exact,
        state,
        history: Vec::new(),
        counters: Counters {
            iterations,
            solves: 1 + usize::from(found.is_some()),
            ..Default::default()
        },
    })
}

fn failed(reason: impl Into<String>) -> MethodError {
    let reason = reason.into();
    MethodError::Failed { reason }
}

/// End of a call.
struct Answer {
    status: Status,
    said: Said,
    /// r, then λ; what a program gave up on need not be there.
    found: Option<Vec<f64>>,
}

/// A folder of its own for every call, gone when the call is over.
struct Folder {
    guarded: Guarded,
    /// Components per point.
    dim: usize,
}

impl Folder {
    /// With the problem in it.
    fn new(increment: &Increment<'_>, form: &LocalForm) -> Result<Self, String> {
        let (guarded, dim) = (Guarded::folder()?, increment.system.dim());
        let folder = Self { guarded, dim };
        let bytes = Problem::Local(problem(increment, form)).to_bytes();
        let bytes = bytes.map_err(|e| e.to_string())?;
        let written = std::fs::write(folder.problem(), bytes);
        written.map_err(|e| format!("cannot write the problem: {e}"))?;
        Ok(folder)
    }

    fn problem(&self) -> PathBuf {
        self.guarded.path().join("problem.hdf5")
    }

    fn reaction(&self) -> PathBuf {
        self.guarded.path().join("reaction.txt")
    }

    /// Largest file of reactions [bytes].
    fn most(&self, form: &LocalForm) -> u64 {
        answer::most(form.q.len() + form.modes.len())
    }

    /// How the program ended, and what it wrote; then the folder goes.
    fn answer(self, ended: &Ended, form: &LocalForm) -> Result<Answer, MethodError> {
        let gave_up = match ended.status.code() {
            Some(SOLVED) => false,
            Some(GAVE_UP) => true,
            _ => return Err(self.complaint(ended)),
        };
        let said = said(&ended.printed).map_err(failed)?;
        let found = self.read(form);
        Ok(if gave_up {
            Answer {
                status: said.status.unwrap_or(Status::Unexplained),
                found: found.ok(),
                said,
            }
        } else {
            Answer {
                status: Status::Converged,
                found: Some(found.map_err(failed)?),
                said,
            }
        })
    }

    /// The numbers the program wrote.
    fn read(&self, form: &LocalForm) -> Result<Vec<f64>, String> {
        let (rows, motions) = (form.q.len(), form.modes.len());
        let text = regular::read_text(&self.reaction(), self.most(form));
        let text = text.map_err(|e| format!("no reactions: {e}"))?;
        reactions(&text, rows, motions, self.dim)
    }

    /// Why the program ended as it did, without the name of this folder, which no two calls share.
    fn complaint(&self, ended: &Ended) -> MethodError {
        let last = ended.complaint.as_deref().unwrap_or_default();
        let last = last.replace(&*self.guarded.path().to_string_lossy(), ".");
        let last = excerpt(&last, SHOWN);
        let separator = if last.is_empty() { "" } else { ": " };
        match ended.status.code() {
            Some(REFUSED) if last.is_empty() => MethodError::Refused {
                reason: format!("exit code {REFUSED}"),
            },
            Some(REFUSED) => MethodError::Refused { reason: last },
            _ if denied(&last) => MethodError::OutOfMemory {
                what: "the program",
            },
            _ => failed(format!("{}{separator}{last}", ended.status)),
        }
    }
}

/// The problem with what methods here start from, as a guess: contact forces, and the jumps at the start of the increment.
fn problem(increment: &Increment<'_>, form: &LocalForm) -> LocalProblem {
    let info = Info {
        title: Some(format!("increment {} of its path", increment.index + 1)),
        description: Some("stickslip: docs/protocol.md".into()),
        math_info: None,
    };
    let guess = Solution {
        v: Vec::new(),
        u: local_velocity(increment, increment.start),
        r: increment.guess().to_vec(),
        l: vec![0.0; form.modes.len()],
    };
    LocalProblem {
        guesses: vec![guess],
        ..unsolved(increment, form, info)
    }
}
