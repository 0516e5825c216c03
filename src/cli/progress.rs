//! Progress of a command.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

use super::output::warn;
use crate::run::progress::Progress;

/// A progress bar with the remaining time on a terminal; in a pipe nothing, or a line per run.
pub struct Bar {
    bar: ProgressBar,
    lines: bool,
    planned: AtomicUsize,
    done: AtomicUsize,
}

impl Bar {
    /// An empty bar, silent in a pipe.
    pub fn new() -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = if terminal {
            ProgressBar::new(0)
        } else {
            ProgressBar::hidden()
        };
        if let Ok(style) =
            ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed}, {eta} left  {msg}")
        {
            bar.set_style(style);
        }
        Self {
            bar,
            lines: false,
            planned: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
        }
    }

    /// An empty bar that prints a line per run on standard error where that is a pipe.
    pub fn with_lines() -> Self {
        Self {
            lines: !std::io::stderr().is_terminal(),
            ..Self::new()
        }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn plan(&self, runs: usize) {
        self.planned.fetch_add(runs, Ordering::Relaxed);
        self.bar.inc_length(runs as u64);
    }

    fn done(&self, label: &str) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if self.lines {
            let planned = self.planned.load(Ordering::Relaxed);
            warn(format_args!("[{done}/{planned}] {label}"));
        }
        self.bar.set_message(label.to_owned());
        self.bar.inc(1);
    }
}
