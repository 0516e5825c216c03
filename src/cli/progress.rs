//! Progress of a command.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use crate::harness::run::Progress;

/// A progress bar on a terminal, nothing in a pipe.
pub struct Bar(ProgressBar);

impl Bar {
    /// An empty bar.
    pub fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Bar(ProgressBar::hidden());
        }
        let bar = ProgressBar::new(0);
        if let Ok(style) =
            ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed}, {eta} left  {msg}")
        {
            bar.set_style(style);
        }
        Bar(bar)
    }

    /// Clears the bar.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn plan(&self, runs: usize) {
        self.0.inc_length(runs as u64);
    }

    fn done(&self, label: &str) {
        self.0.set_message(label.to_owned());
        self.0.inc(1);
    }
}
