//! Where a record comes from: the program, the machine, and the limits that it was measured under.

use std::fmt;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::run::provenance::Provenance;

/// Limits on a task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Wall-clock time with set-up and repeats [s].
    pub seconds: f64,
    /// Address space of the process [MB]; none: unlimited.
    pub memory_mb: Option<u64>,
}

/// Program and machine.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Origin {
    /// Version of this crate.
    pub version: String,
    /// Git commit of the sources, or `unknown`.
    pub commit: String,
    /// Whether the sources differed from it: `true`, `false` or `unknown`.
    pub dirty: String,
    /// Digest of the sources, which a commit with further changes does not tell.
    pub sources: String,
    /// Compiler.
    pub rustc: String,
    /// `debug` or `release`.
    pub profile: String,
    /// Operating system and processor model.
    pub machine: String,
}

impl Origin {
    /// This program on this machine; found out once.
    pub fn here() -> Self {
        static HERE: OnceLock<Origin> = OnceLock::new();
        HERE.get_or_init(Self::collect).clone()
    }

    fn collect() -> Self {
        let build = Provenance::collect(1);
        Self {
            version: build.version,
            commit: build.commit,
            dirty: build.dirty,
            sources: env!("STICKSLIP_BUILD_SOURCES").into(),
            rustc: build.rustc,
            profile: build.profile,
            machine: format!("{}, {}", build.os, build.cpu),
        }
    }

    /// Whether the same program was built there: what it finds are the same bits.
    pub fn same_program(&self, other: &Self) -> bool {
        let program = |own: &Self| Self {
            machine: String::new(),
            ..own.clone()
        };
        program(self) == program(other)
    }
}

impl fmt::Display for Origin {
    /// `version 0.1.0, commit …, machine …`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            ("version", &self.version),
            ("commit", &self.commit),
            ("uncommitted changes", &self.dirty),
            ("sources", &self.sources),
            ("compiler", &self.rustc),
            ("profile", &self.profile),
            ("machine", &self.machine),
        ];
        f.write_str(
            &parts
                .map(|(name, value)| format!("{name} {value}"))
                .join(", "),
        )
    }
}
