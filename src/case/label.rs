//! Texts that name things on terminals, in tables and in figures: what they may hold, and what becomes of those that come
//! from elsewhere, such as the names of files.
//!
//! A spreadsheet that opens a table takes a cell that begins with `=`, `+`, `-`, `@`, a tab or a carriage return for a formula
//! and runs it (OWASP, CSV Injection); a control character commands the terminal that shows it, and a change of the writing
//! direction shows something else than what is there.

use std::borrow::Cow;

pub(crate) use crate::files::visible::is_visible;

/// What a label may be.
pub(crate) const ALLOWED: &str =
    "one line of visible text that does not begin like a formula, with =, +, - or @";

/// Whether a text may be a label.
pub(crate) fn is_label(text: &str) -> bool {
    !text.trim().is_empty() && text.chars().all(is_visible) && !is_formula(text)
}

/// The text with � in place of what is no visible character.
pub fn visible(text: &str) -> String {
    let shown = |c| {
        if is_visible(c) {
            c
        } else {
            char::REPLACEMENT_CHARACTER
        }
    };
    text.chars().map(shown).collect()
}

/// The text as the cell of a table that spreadsheets open: a quote before what they would take for a formula.
pub fn cell(text: &str) -> Cow<'_, str> {
    match is_formula(text) {
        true => format!("'{text}").into(),
        false => text.into(),
    }
}

/// Whether a spreadsheet computes what it finds in such a cell. Numbers and lone signs are what they are.
fn is_formula(text: &str) -> bool {
    let begins = text
        .trim_start_matches(' ')
        .starts_with(['=', '+', '-', '@', '\t', '\r']);
    begins && text.trim().len() > 1 && text.trim().parse::<f64>().is_err()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_commands_neither_terminals_nor_spreadsheets() {
        for text in [
            "Plate, Mesh I",
            "-",
            "-1.5",
            "μ = 0.3",
            "a-b",
            "P1@top",
            "日本",
        ] {
            assert!(is_label(text), "{text}");
            assert_eq!((cell(text).as_ref(), visible(text).as_str()), (text, text));
        }
        for text in [
            "=1+1",
            "+A1",
            "-2+3",
            "@SUM(A1)",
            " =cmd|' /C calc'!A0",
            "\t=1",
            "\r=1",
        ] {
            assert!(!is_label(text), "{text}");
            assert_eq!(cell(text), format!("'{text}"));
        }
        for text in [
            "",
            "  ",
            "a\u{1b}[31mb",
            "a\nb",
            "a\u{7}",
            "a\u{202e}b",
            "a\u{9b}31m",
        ] {
            assert!(!is_label(text), "{text:?}");
            assert!(visible(text).chars().all(is_visible));
        }
        assert_eq!(visible("a\u{1b}[31mb"), "a\u{FFFD}[31mb");
    }
}
