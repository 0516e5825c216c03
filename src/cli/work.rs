//! The verb `work`: measures what comes in on standard input.

use super::error::CliError;
use crate::studies::lab::{Request, reply};
use crate::studies::measure::Bench;
use crate::studies::worker::serve;

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Limit on the address space, in MB
    #[arg(long)]
    memory_mb: Option<u64>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<bool, CliError> {
    // An interruption at the terminal reaches the whole group of processes; the conductor decides.
    ctrlc::set_handler(|| ()).map_err(CliError::Interrupt)?;
    end_with_parent().map_err(CliError::Work)?;
    let (input, output) = (std::io::stdin().lock(), std::io::stdout().lock());
    let memory = arguments.memory_mb;
    let mut bench = Bench::default();
    let answer = |request: Request| reply(&mut bench, request);
    serve(input, output, memory, answer).map_err(CliError::Work)?;
    Ok(true)
}

/// A worker whose conductor was killed must not go on beside the next run, whose times it would disturb.
#[cfg(target_os = "linux")]
fn end_with_parent() -> std::io::Result<()> {
    use rustix::process::{Signal, set_parent_process_death_signal};
    Ok(set_parent_process_death_signal(Some(Signal::KILL))?)
}

/// Elsewhere a worker ends when it has answered and finds its input closed.
#[cfg(not(target_os = "linux"))]
fn end_with_parent() -> std::io::Result<()> {
    Ok(())
}
