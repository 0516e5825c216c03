//! Output that may close early: `stickslip list | head` is no error.

use std::fmt::Arguments;
use std::io::Write;

use crate::case::label::visible;

/// Prints a line. A reader that has left has seen what it wanted; results are in files, not here.
pub fn say(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    let _gone = writeln!(out, "{}", lines(text)).and_then(|()| out.flush());
}

/// Prints a line on standard error. Where nobody reads it the exit code still tells.
pub fn warn(text: Arguments<'_>) {
    let _gone = writeln!(std::io::stderr().lock(), "{}", lines(text));
}

/// The text without what would command the terminal: names of files and of others' data may hold anything.
fn lines(text: Arguments<'_>) -> String {
    let text = text.to_string();
    let lines = text.split_inclusive(['\n', '\t']);
    let shown = |line: &str| match line.strip_suffix(['\n', '\t']) {
        Some(text) => visible(text) + &line[text.len()..],
        None => visible(line),
    };
    lines.map(shown).collect()
}
