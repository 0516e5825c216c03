//! `stickslip page`: a report folder as one page.

use std::path::PathBuf;

use super::error::CliError;
use super::output::say;
use crate::report::page;

/// Arguments of `stickslip page`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder of a report, or of several in folders below it; the page is written into it
    #[arg(default_value = "results")]
    dir: PathBuf,
}

/// Writes `index.html` and says how large it is.
pub fn run(arguments: Arguments) -> Result<bool, CliError> {
    let bytes = page::write(&arguments.dir)?;
    say(format_args!(
        "{}: {:.1} MB",
        arguments.dir.join(page::FILE).display(),
        bytes as f64 / 1e6
    ));
    Ok(true)
}
