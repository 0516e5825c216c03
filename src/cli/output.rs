//! Output that may close early: `stickslip list | head` is no error.

use std::fmt::Arguments;
use std::io::Write;

/// Prints a line. A reader that has left has seen what it wanted; results are in files, not here.
pub fn say(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    let _gone = writeln!(out, "{text}").and_then(|()| out.flush());
}

/// Prints a line on standard error. Where nobody reads it the exit code still tells.
pub fn warn(text: Arguments<'_>) {
    let _gone = writeln!(std::io::stderr().lock(), "{text}");
}
