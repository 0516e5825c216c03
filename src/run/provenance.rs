//! Which program on which machine made the numbers: a file of its own, so that a rerun changes only what changed.
//!
//! No time of day and no host name; nothing of this appears in the files of numbers.

use serde::Serialize;
use std::collections::BTreeMap;

use crate::files::visible::visible;

/// Origin of a set of reports.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Provenance {
    /// Command line.
    pub command: String,
    /// Version of this crate.
    pub version: String,
    /// Git commit of the sources, or `unknown`.
    pub commit: String,
    /// Whether the sources differed from that commit: `true`, `false` or `unknown`.
    pub dirty: String,
    /// Compiler.
    pub rustc: String,
    /// Target triple.
    pub target: String,
    /// Build profile: `debug` or `release`.
    pub profile: String,
    /// Operating system.
    pub os: String,
    /// Processor model, or `unknown`.
    pub cpu: String,
    /// Threads the run used.
    pub threads: usize,
    /// Options of the command by name, e.g. `tier = "high"`.
    pub options: BTreeMap<String, String>,
}

impl Provenance {
    /// Facts about this build and this machine; `threads` as the run used them.
    pub fn collect(threads: usize) -> Self {
        Self {
            command: command(),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: env!("STICKSLIP_BUILD_COMMIT").into(),
            dirty: env!("STICKSLIP_BUILD_DIRTY").into(),
            rustc: env!("STICKSLIP_BUILD_RUSTC").into(),
            target: env!("STICKSLIP_BUILD_TARGET").into(),
            profile: env!("STICKSLIP_BUILD_PROFILE").into(),
            os: std::env::consts::OS.into(),
            cpu: cpu_model(),
            threads,
            options: BTreeMap::new(),
        }
    }

    /// Adds one option of the command.
    #[must_use]
    pub fn with_option(mut self, name: impl Into<String>, value: impl Into<String>) -> Self {
        self.options.insert(name.into(), value.into());
        self
    }

    /// The contents of `provenance.toml`.
    ///
    /// # Errors
    /// Values without a TOML form.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}

/// The command line, as a shell would take it.
fn command() -> String {
    let quoted = |word: &str| {
        let plain = |c: char| c.is_alphanumeric() || "-_=:,./+%@".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word.to_owned()
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| quoted(&visible(&word.to_string_lossy())));
    let name = env!("CARGO_PKG_NAME").to_owned();
    std::iter::once(name)
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Processor model as Linux tells it; elsewhere only the architecture is known without extra libraries.
fn cpu_model() -> String {
    let named = std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            text.lines()
                .find_map(|line| line.strip_prefix("model name"))
                .and_then(|rest| rest.split_once(':'))
                .map(|(_, model)| model.trim().to_owned())
        });
    named.unwrap_or_else(|| format!("unknown ({})", std::env::consts::ARCH))
}
