//! What may be shown of texts that come from files.

/// No control character, no line separator, no mark of the writing direction.
pub(crate) fn is_visible(c: char) -> bool {
    let marks = matches!(c, '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}' | '\u{FEFF}');
    !c.is_control() && !marks
}

/// The beginning of a text on one line, with � in place of what is not visible.
pub(crate) fn excerpt(text: &str, most: usize) -> String {
    let shown = |c| match is_visible(c) {
        true => c,
        false => char::REPLACEMENT_CHARACTER,
    };
    let mut chars = text.chars();
    let mut excerpt: String = chars.by_ref().take(most).map(shown).collect();
    if chars.next().is_some() {
        excerpt.push('…');
    }
    excerpt
}
