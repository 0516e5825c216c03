//! Output that may close early: `stickslip show | head` is no error.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::json;

use crate::files::visible::visible;
use crate::report::standard;
use crate::report::table::{Row, objects, readable};
use crate::report::tables::details::ExpectedNumber;
use crate::studies::results::Results;

/// Whether some line could not be printed.
pub static LOST: AtomicBool = AtomicBool::new(false);

/// Form of what standard output is told.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Form {
    /// Words and tables.
    #[default]
    Text,
    /// A JSON object per line: a table with all columns of its file, or words.
    Json,
    /// Nothing.
    Nothing,
}

/// That of this process, settled by its first arguments.
pub static FORM: OnceLock<Form> = OnceLock::new();

pub fn form() -> Form {
    *FORM.get_or_init(Form::default)
}

/// Prints words.
pub fn say(text: Arguments<'_>) {
    match form() {
        Form::Text => print(text),
        Form::Json => print(format_args!("{}", json!({ "text": text.to_string() }))),
        Form::Nothing => {}
    }
}

/// Prints a line. A reader that has left has seen what it wanted; a disk that is full has not.
fn print(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    let said = writeln!(out, "{}", lines(text)).and_then(|()| out.flush());
    if said.is_err_and(|e| e.kind() != ErrorKind::BrokenPipe) {
        LOST.store(true, Ordering::SeqCst);
    }
}

/// Prints a table.
pub fn show<R: Row>(rows: &[R], note: &str) {
    match form() {
        Form::Json => print(format_args!(
            "{}",
            json!({ "table": R::NAME, "rows": objects(rows) })
        )),
        _ => say(format_args!("{}", readable(rows, note).terminal())),
    }
}

/// Prints what runs came to and where it lies; true if all is as expected.
pub fn conclude(results: &Results, dir: &Path) -> bool {
    show(&standard::runs(results), "");
    if !results.expectations.is_empty() {
        show(&ExpectedNumber::of(&results.expectations), "");
    }
    for remark in results.remarks() {
        say(format_args!("{remark}"));
    }
    let summary = standard::summary(results);
    say(format_args!("{summary}\nResults: {}", dir.display()));
    results.as_expected()
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
