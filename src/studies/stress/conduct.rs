//! Has scenes examined in processes of their own, keeps every finding as soon as it is there, and makes small what fails.
//!
//! ```text
//!   DIR/scenes.jsonl    first a line that says which suite it is, then a line per scene, each with a digest of its text
//! ```
//! What is in the file is not examined again, so that a run can be interrupted and gone on with.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::examine::{Effort, ended, examine};
use super::finding::{Cause, Finding};
use super::scene::{Family, Scene, scene};
use super::shrink::smaller;
use crate::files::bundle::FolderError;
use crate::files::claim::{Claim, write_whole};
use crate::files::regular;
use crate::run::run_case::Progress;
use crate::run::verdict::Verdict;
use crate::studies::sweep::cell::digest;
use crate::studies::sweep::record::{Limits, Origin};
use crate::studies::worker::{Worker, WorkerError, share};

/// Name of the file of findings.
pub const FILE: &str = "scenes.jsonl";

/// Largest file of findings read [bytes]: a million of them.
const MOST: u64 = 4 << 30;

/// What makes the program a worker that examines scenes.
const WORK: &[&str] = &["work", "--scenes"];

/// Limits on a scene with all its methods and transformations.
pub const LIMITS: Limits = Limits {
    seconds: 120.0,
    memory_mb: Some(8000),
};

/// Scenes of one family, category and cause that are made small: they are likely the same.
const SHRUNK: usize = 2;

/// Attempts to make a scene smaller.
const ATTEMPTS: usize = 80;

/// A suite: how many scenes of every family, and which seed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Suite {
    /// Seed of all scenes.
    pub seed: u64,
    /// Scenes per family.
    pub scenes: BTreeMap<Family, u64>,
}

/// First line of a file of findings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Head {
    suite: u64,
    origin: Origin,
}

/// A line of a file of findings.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    digest: String,
    finding: Finding,
}

/// How scenes are examined.
#[derive(Debug, Clone, Copy)]
pub struct Conduct<'a> {
    /// The program that has the verb `work`.
    pub program: &'a Path,
    /// Scenes at the same time.
    pub jobs: usize,
    /// Part `number` of `of`, from 1.
    pub shard: (u64, u64),
    /// Set from outside to end after the scenes that are being examined.
    pub stop: &'a AtomicBool,
}

/// Why a suite ended early, apart from being told to.
#[derive(Debug, thiserror::Error)]
pub enum ConductError {
    /// The file of findings cannot be read or written.
    #[error("`{}`: {source}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A line that was changed after it was written, or is none.
    #[error("`{}`, line {line}: not what was written there; remove the file to begin anew", path.display())]
    Changed {
        /// Which file.
        path: PathBuf,
        /// From 1.
        line: usize,
    },
    /// Findings of another seed, program or machine.
    #[error("`{}` holds findings of another seed, program or machine: choose another folder, or --force", path.display())]
    Other {
        /// Which file.
        path: PathBuf,
    },
    /// The folder.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The workers.
    #[error(transparent)]
    Worker(#[from] WorkerError),
}

/// Examines all scenes of a suite that have no finding in a folder yet, which is marked as theirs; all findings, in order.
///
/// # Errors
/// The first [`ConductError`]; findings that were kept before it stay.
pub fn conduct(
    suite: &Suite,
    claim: &Claim,
    force: bool,
    how: Conduct<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Finding>, ConductError> {
    let path = claim.dir().join(FILE);
    let failed = |source| ConductError::File {
        path: path.clone(),
        source,
    };
    let head = Head {
        suite: suite.seed,
        origin: Origin::here(),
    };
    let (mut findings, text) = read(&path, &head, force)?;
    claim.mark()?;
    let wanted = |f: &Finding| suite.scenes.get(&f.family).is_some_and(|n| f.number < *n);
    findings.retain(wanted);
    let known: BTreeSet<(Family, u64)> = findings.iter().map(|f| (f.family, f.number)).collect();
    let all = (suite.scenes.iter()).flat_map(|(&family, &n)| (0..n).map(move |k| (family, k)));
    let (number, of) = how.shard;
    let left: Vec<(Family, u64)> = all
        .filter(|own| own.1 % of == number - 1 && !known.contains(own))
        .collect();
    progress.plan(left.len());
    // A line that was being written when the program was ended is written again.
    write_whole(claim.dir(), FILE, text.as_bytes())?;
    let file = File::options().append(true).open(&path).map_err(failed)?;
    let kept = Mutex::new((file, findings));
    let shrunk: Mutex<BTreeMap<(Family, String, Cause), usize>> = Mutex::default();
    let is_new = |finding: &Finding, cause: Cause| {
        let key = (finding.family, finding.category.clone(), cause);
        let mut shrunk = shrunk.lock().unwrap_or_else(|e| e.into_inner());
        let count = shrunk.entry(key).or_default();
        *count += 1;
        *count <= SHRUNK
    };
    let worker = || Worker::new(how.program, WORK, LIMITS);
    share(&left, how.jobs, how.stop, worker, |worker, own| {
        let scene = scene(own.0, suite.seed, own.1);
        let mut finding = ask(worker, &scene)?;
        // Beyond any mesh of such cells: nothing failed.
        let broken = finding.cause.filter(|&cause| cause != Cause::Beyond);
        if broken.is_some_and(|cause| is_new(&finding, cause)) {
            finding.minimal = Some(shrink(worker, &scene, &finding)?);
        }
        let mut kept = kept.lock().unwrap_or_else(|e| e.into_inner());
        let line = line(&finding);
        kept.0.write_all(line.as_bytes()).map_err(failed)?;
        progress.done(&told(&finding));
        kept.1.push(finding);
        Ok::<(), ConductError>(())
    })?;
    let mut findings = kept.into_inner().unwrap_or_else(|e| e.into_inner()).1;
    findings.sort_by_key(|f| (f.family, f.number));
    Ok(findings)
}

/// Findings in a file, and its whole lines; those of a new one if there is none.
fn read(path: &Path, head: &Head, force: bool) -> Result<(Vec<Finding>, String), ConductError> {
    let mut text = serde_json::to_string(head).unwrap_or_default() + "\n";
    let mut findings = Vec::new();
    let bytes = match regular::read(path, MOST) {
        Ok(bytes) => bytes,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok((findings, text)),
        Err(source) => {
            let path = path.to_path_buf();
            return Err(ConductError::File { path, source });
        }
    };
    let lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
    for (index, own) in lines.iter().enumerate() {
        if index == 0 {
            match serde_json::from_slice::<Head>(own) {
                Ok(found) if found == *head => continue,
                Ok(_) if force => return Ok((findings, text)),
                _ => {
                    let path = path.to_path_buf();
                    return Err(ConductError::Other { path });
                }
            }
        }
        let sound = serde_json::from_slice::<Line>(own).ok();
        let sound = sound.filter(|l| l.digest == seal(&l.finding));
        match sound {
            Some(own) => {
                text += &line(&own.finding);
                findings.push(own.finding);
            }
            // The last line may have been cut off.
            None if index + 1 == lines.len() => {}
            None => {
                return Err(ConductError::Changed {
                    path: path.to_path_buf(),
                    line: index + 1,
                });
            }
        }
    }
    Ok((findings, text))
}

fn seal(finding: &Finding) -> String {
    digest(&serde_json::to_string(finding).unwrap_or_default())
}

fn line(finding: &Finding) -> String {
    let line = Line {
        digest: seal(finding),
        finding: finding.clone(),
    };
    serde_json::to_string(&line).unwrap_or_default() + "\n"
}

/// Examines a scene in a worker.
fn ask(worker: &mut Worker<'_>, scene: &Scene) -> Result<Finding, WorkerError> {
    let finding = match worker.ask::<Scene, Finding>(scene, 1)? {
        Ok(finding) => finding,
        Err(Verdict::TimedOut) => {
            let limit = format!("no answer in {} s", LIMITS.seconds);
            ended(scene, Cause::Time, &limit)
        }
        Err(Verdict::OutOfMemory) => ended(scene, Cause::Memory, "denied memory"),
        Err(verdict) => ended(scene, Cause::Panic, &verdict.to_string()),
    };
    let denied = |cause: Option<Cause>| cause == Some(Cause::Memory);
    let any = denied(finding.cause) || finding.trials.iter().any(|t| denied(t.cause));
    let what = format!("{} {}", scene.family.name(), scene.number);
    WorkerError::if_denied(&what, any, LIMITS).and(Ok(finding))
}

/// The worker's side.
pub fn answer(scene: Scene) -> Finding {
    examine(&scene, Effort::All)
}

/// The smallest case found that fails for the same cause.
fn shrink(
    worker: &mut Worker<'_>,
    scene: &Scene,
    finding: &Finding,
) -> Result<String, WorkerError> {
    // What takes long or hangs is not tried often.
    let mut left = if finding.seconds > 5.0 {
        ATTEMPTS / 8
    } else {
        ATTEMPTS
    };
    let mut best = scene.clone();
    'smaller: loop {
        for text in smaller(&best.text) {
            if left == 0 {
                break 'smaller;
            }
            left -= 1;
            let candidate = Scene {
                text,
                ..scene.clone()
            };
            if ask(worker, &candidate)?.cause == finding.cause {
                best = candidate;
                continue 'smaller;
            }
        }
        break;
    }
    Ok(best.text)
}

/// One line on a scene.
fn told(finding: &Finding) -> String {
    let name = finding.family.name();
    let cause = finding.cause.map_or("right", Cause::name);
    format!("{name} {} {}: {cause}", finding.number, finding.category)
}
