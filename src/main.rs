//! The program with the methods of `stickslip-methods`.

use std::process::ExitCode;

use stickslip_methods::Registry;

fn main() -> ExitCode {
    stickslip::cli::program(Registry::standard())
}
