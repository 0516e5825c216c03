//! The program: parses the command line and turns the outcome into an exit code.

use std::process::ExitCode;

use clap::Parser;
use stickslip::cli;

fn main() -> ExitCode {
    match cli::main(cli::Cli::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            cli::warn(format_args!("error: {error}"));
            ExitCode::from(2)
        }
    }
}
