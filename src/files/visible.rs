//! Visible forms of texts that come from elsewhere: names of files, titles, what programs print.
//!
//! A control character commands the terminal that shows it and breaks the line of the table that holds it. The signs of CSV,
//! HTML and LaTeX are escaped by who writes them.

/// Rule for labels.
pub(crate) const LABEL: &str = "one line of visible text";

/// Whether a text may name something on terminals, in tables and in figures.
pub(crate) fn is_label(text: &str) -> bool {
    !text.trim().is_empty() && text.chars().all(is_visible)
}

/// No control character, which the ends of lines are too.
pub(crate) fn is_visible(c: char) -> bool {
    !c.is_control()
}

/// The text with � in place of what is not visible.
pub(crate) fn visible(text: &str) -> String {
    excerpt(text, usize::MAX)
}

/// As [`visible`], at most so many characters of it.
pub(crate) fn excerpt(text: &str, most: usize) -> String {
    let shown = |c| {
        if is_visible(c) {
            c
        } else {
            char::REPLACEMENT_CHARACTER
        }
    };
    let mut chars = text.chars();
    let mut excerpt: String = chars.by_ref().take(most).map(shown).collect();
    if chars.next().is_some() {
        excerpt.push('…');
    }
    excerpt
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_does_not_command_the_terminal() {
        for text in ["Plate, Mesh I", "-", "μ = 0.3", "日本"] {
            assert!(is_label(text) && visible(text) == text, "{text}");
        }
        for text in ["", "  ", "a\u{1b}[31mb", "a\nb", "a\u{9b}31m"] {
            assert!(!is_label(text), "{text:?}");
            assert!(visible(text).chars().all(is_visible));
        }
        assert_eq!(excerpt("a\u{1b}[31mb", 4), "a\u{FFFD}[3…");
    }
}
