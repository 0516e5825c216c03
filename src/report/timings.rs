//! Timings: what the benchmarks measured, as `timings.csv` and tables.
//!
//! Criterion leaves one `raw.csv` per benchmark in `<home>/<group>/<function>/<value>/new/`, the only file whose form it
//! documents. [`harvest`] reads them and nothing else. Folders stay behind when a benchmark is renamed, left out or not run
//! again, so a file counts only where its benchmark is [`Expected`] and it is newer than the executable that makes it, see
//! [`last_built`]: every number of the table then comes from this build, and a run of some of the benchmarks brings only
//! theirs up to date. Folder names are shortened and cleaned by criterion: a benchmark is known by the columns in its file.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Deserialize;

use super::{Bundle, ReportError, table};
use crate::run::verdict::Verdict;
use crate::studies::sweep::statistics::Timing;

/// Name of a benchmark.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct BenchmarkName {
    /// What is measured on which problem, e.g. `enforcement/plate_mesh1 88x88 mu=0.8`.
    pub group: String,
    /// Stage, e.g. `solve`.
    pub function: String,
    /// Method; empty where there is none.
    pub value: String,
}

impl BenchmarkName {
    /// A name from its parts.
    pub fn new(
        group: impl Into<String>,
        function: impl Into<String>,
        value: impl Into<String>,
    ) -> Self {
        Self {
            group: group.into(),
            function: function.into(),
            value: value.into(),
        }
    }
}

/// A benchmark whose result belongs into the table.
#[derive(Debug, Clone)]
pub struct Expected {
    /// Its name.
    pub name: BenchmarkName,
    /// What the judge said of the answer that was timed; none where there is no answer.
    pub verdict: Option<Verdict>,
    /// A result that is not newer is stale.
    pub newer_than: SystemTime,
}

/// One row of `timings.csv`.
#[derive(Debug, Clone)]
pub struct TimingRow {
    /// What was timed.
    pub name: BenchmarkName,
    /// As in [`Expected`].
    pub verdict: Option<Verdict>,
    /// Seconds per call.
    pub timing: Timing,
}

/// What [`harvest`] found.
#[derive(Debug, Default)]
pub struct Harvest {
    /// Benchmarks with a result, by name.
    pub rows: Vec<TimingRow>,
    /// Expected benchmarks without one, by name.
    pub missing: Vec<BenchmarkName>,
    /// Files left aside, by path.
    pub ignored: Vec<(PathBuf, Ignored)>,
}

/// Why a file was left aside.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ignored {
    /// Nobody asked for this benchmark.
    Unknown,
    /// From before the benchmark was last built, or older than another result of the same benchmark.
    Stale,
    /// Unreadable, with the reason.
    Broken(String),
}

/// Reads the results of expected benchmarks below criterion's folder. That there are none, or no folder, is no error.
pub fn harvest(home: &Path, expected: &[Expected]) -> Harvest {
    let mut files = Vec::new();
    find(home, &mut files);
    files.sort();
    let mut harvest = Harvest::default();
    let wanted: BTreeMap<&BenchmarkName, &Expected> =
        expected.iter().map(|e| (&e.name, e)).collect();
    let mut found: BTreeMap<BenchmarkName, (SystemTime, PathBuf, Timing)> = BTreeMap::new();
    for path in files {
        let (name, timing, modified) = match read(&path) {
            Ok(result) => result,
            Err(reason) => {
                harvest.ignored.push((path, Ignored::Broken(reason)));
                continue;
            }
        };
        let Some(expected) = wanted.get(&name) else {
            harvest.ignored.push((path, Ignored::Unknown));
            continue;
        };
        let newest = found.get(&name).map_or(expected.newer_than, |own| own.0);
        if modified <= newest {
            harvest.ignored.push((path, Ignored::Stale));
        } else if let Some(older) = found.insert(name, (modified, path, timing)) {
            harvest.ignored.push((older.1, Ignored::Stale));
        }
    }
    for (name, expected) in wanted {
        match found.get(name) {
            Some((_, _, timing)) => harvest.rows.push(TimingRow {
                name: name.clone(),
                verdict: expected.verdict.clone(),
                timing: *timing,
            }),
            None => harvest.missing.push(name.clone()),
        }
    }
    harvest.ignored.sort_by(|a, b| a.0.cmp(&b.0));
    harvest
}

/// When the executable of a bench target was last built: what is older was measured by another build. Cargo puts the
/// executables of all targets into one folder, each as `<target>-<hash>`. `None` if there is none.
pub fn last_built(folder: &Path, target: &str) -> Option<SystemTime> {
    let own = |file: &str| {
        let hash = file.strip_prefix(target)?.strip_prefix('-')?;
        let hash = hash.strip_suffix(std::env::consts::EXE_SUFFIX)?;
        (!hash.is_empty() && hash.chars().all(|c| c.is_ascii_hexdigit())).then_some(())
    };
    let entries = fs::read_dir(folder).ok()?.flatten();
    let executables = entries.filter(|e| e.file_name().to_str().and_then(own).is_some());
    let times = executables.filter_map(|e| e.metadata().and_then(|data| data.modified()).ok());
    times.max()
}

/// Every `new/raw.csv` below a folder; baselines have other folders. What cannot be listed holds no results.
fn find(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if !entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            continue;
        }
        if entry.file_name() == "new" && path.join("raw.csv").is_file() {
            files.push(path.join("raw.csv"));
        } else {
            find(&path, files);
        }
    }
}

/// One line of `raw.csv`: a sample of so many calls.
#[derive(Deserialize)]
struct Sample {
    group: String,
    function: Option<String>,
    value: Option<String>,
    sample_measured_value: f64,
    unit: String,
    iteration_count: u64,
}

/// Benchmark, seconds per call, time of the last change.
fn read(path: &Path) -> Result<(BenchmarkName, Timing, SystemTime), String> {
    let modified = fs::metadata(path).and_then(|data| data.modified());
    let modified = modified.map_err(|e| e.to_string())?;
    let mut reader = ::csv::Reader::from_path(path).map_err(|e| e.to_string())?;
    let mut name = None;
    let mut seconds = Vec::new();
    for sample in reader.deserialize() {
        let sample: Sample = sample.map_err(|e| e.to_string())?;
        let own = BenchmarkName {
            group: sample.group,
            function: sample.function.unwrap_or_default(),
            value: sample.value.unwrap_or_default(),
        };
        if *name.get_or_insert_with(|| own.clone()) != own {
            return Err("samples of several benchmarks".into());
        }
        if sample.unit != "ns" {
            return Err(format!("unit `{}`, expected ns", sample.unit));
        }
        let per_call = sample.sample_measured_value / sample.iteration_count as f64 * 1e-9;
        if !(per_call.is_finite() && per_call >= 0.0) {
            return Err(format!(
                "{} ns for {} calls",
                sample.sample_measured_value, sample.iteration_count
            ));
        }
        seconds.push(per_call);
    }
    match (name, Timing::of(&seconds)) {
        (Some(name), Some(timing)) => Ok((name, timing, modified)),
        _ => Err("no samples".into()),
    }
}

/// Adds `timings.csv`, `timings.md` and `timings.tex`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_to(bundle: &mut Bundle, rows: &[TimingRow]) -> Result<(), ReportError> {
    table::add(bundle, rows, "")
}
