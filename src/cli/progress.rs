//! Progress of a command.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::output::{Form, form, warn};
use crate::run::progress::Progress;

/// Where nobody sees the bar, time between two lines [s].
const BETWEEN_S: f64 = 5.0;

/// A progress bar with the remaining time on a terminal; in a pipe now and then a line, or one per run.
pub struct Bar {
    bar: ProgressBar,
    /// Time between two lines [s]; none on a terminal.
    between_s: Option<f64>,
    told: Mutex<Instant>,
    planned: AtomicUsize,
    done: AtomicUsize,
}

impl Bar {
    /// An empty bar.
    pub fn new() -> Self {
        let terminal = std::io::stderr().is_terminal();
        let quiet = form() == Form::Nothing;
        let bar = if terminal && !quiet {
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
            between_s: (!terminal && !quiet).then_some(BETWEEN_S),
            told: Mutex::new(Instant::now()),
            planned: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
        }
    }

    /// An empty bar that prints a line per run on standard error where that is a pipe.
    pub fn with_lines() -> Self {
        let new = Self::new();
        Self {
            between_s: new.between_s.map(|_| 0.0),
            ..new
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
        if let (Some(between), Ok(mut told)) = (self.between_s, self.told.lock())
            && told.elapsed().as_secs_f64() >= between
        {
            let planned = self.planned.load(Ordering::Relaxed);
            warn(format_args!("[{done}/{planned}] {label}"));
            *told = Instant::now();
        }
        self.bar.set_message(label.to_owned());
        self.bar.inc(1);
    }
}
