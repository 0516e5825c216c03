//! Faults of a case file, with their places.

use std::fmt;
use std::ops::Range;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::thread;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::files::visible::{self, visible};

/// Byte range of a key's value in the case file, for error messages.
pub type Span = Range<usize>;

/// Longest value, key or source line printed, in characters: a megabyte of garbage must not flood a terminal.
const WIDTH: usize = 80;

/// Most further faults printed, and looked for among entries of one kind: the place of each is found by reading the text anew.
pub(crate) const SHOWN: usize = 9;

/// Depth to which keys are named in messages; the format itself is at most five levels deep.
const DEPTH: usize = 8;

/// A case file that cannot be used: where, which value, and what would be allowed.
///
/// Displays as `file:line:column: key: message: got VALUE, allowed: RANGE`, followed by the source line with the value
/// underlined. Values and lines are cut to 80 characters.
#[derive(Debug, Clone, thiserror::Error)]
pub struct CaseError(Box<Complaint>);

// Boxed: an error type above 128 bytes would make every `Result` of the reader large.
#[derive(Debug, Clone, Default)]
struct Complaint {
    file: PathBuf,
    line: usize,
    column: usize,
    source_line: String,
    underline: String,
    key: String,
    value: String,
    allowed: String,
    message: String,
    more: Vec<CaseError>,
}

impl CaseError {
    /// All of some faults as one, in the order of the file; what several say is said once.
    ///
    /// # Errors
    /// If there are any.
    pub(crate) fn all(faults: impl IntoIterator<Item = Self>) -> Result<(), Self> {
        let mut all: Vec<Self> = faults.into_iter().flat_map(Self::faults).collect();
        all.sort_by_key(|own| (own.line(), own.column()));
        all.dedup_by(|a, b| a.to_string() == b.to_string());
        let mut all = all.into_iter();
        let Some(mut first) = all.next() else {
            return Ok(());
        };
        first.0.more = all.collect();
        Err(first)
    }

    /// The faults of the file, each by itself.
    pub fn faults(mut self) -> Vec<Self> {
        let more = std::mem::take(&mut self.0.more);
        std::iter::once(self).chain(more).collect()
    }

    /// File as given by the caller.
    pub fn file(&self) -> &Path {
        &self.0.file
    }

    /// Line, from 1; 0 where the file could not be read at all.
    pub fn line(&self) -> usize {
        self.0.line
    }

    /// Column in characters, from 1; 0 where the file could not be read at all.
    pub fn column(&self) -> usize {
        self.0.column
    }

    /// Offending line, cut to 80 characters around the value; control characters are replaced.
    pub fn source_line(&self) -> &str {
        &self.0.source_line
    }

    /// Dotted key, e.g. `crack[1].points_m` (array entries counted from 1); empty where no key is meant.
    pub fn key(&self) -> &str {
        &self.0.key
    }

    /// Offending value as written, cut to 80 characters.
    pub fn value(&self) -> &str {
        &self.0.value
    }

    /// Allowed values.
    pub fn allowed(&self) -> &str {
        &self.0.allowed
    }

    /// The fault, in words.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// A file that cannot be opened or read: no position, no source line.
    pub(crate) fn unreadable(
        file: &Path,
        value: impl fmt::Display,
        allowed: &str,
        message: &str,
    ) -> Self {
        CaseError(Box::new(Complaint {
            file: file.to_path_buf(),
            value: clip(&value.to_string()),
            allowed: allowed.to_string(),
            message: message.to_string(),
            ..Complaint::default()
        }))
    }
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let c = &*self.0;
        write!(f, "{}:", visible(&c.file.to_string_lossy()))?;
        if c.line > 0 {
            write!(f, "{}:{}:", c.line, c.column)?;
        }
        if !c.key.is_empty() {
            write!(f, " {}:", c.key)?;
        }
        write!(f, " {}: got {}, allowed: {}", c.message, c.value, c.allowed)?;
        if !c.source_line.is_empty() {
            write!(f, "\n    {}\n    {}", c.source_line, c.underline)?;
        }
        let shown = c.more.iter().take(SHOWN);
        shown.clone().try_for_each(|own| write!(f, "\n{own}"))?;
        if c.more.len() > SHOWN {
            f.write_str("\nand more")?;
        }
        Ok(())
    }
}

/// The text of a case file, which turns byte ranges into positions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Source<'a> {
    /// File as given by the caller.
    pub(crate) file: &'a Path,
    /// Its text.
    pub(crate) text: &'a str,
}

impl Source<'_> {
    /// Error about the value at `span`; the key is found from the position.
    pub(crate) fn error(
        &self,
        span: &Span,
        value: impl fmt::Display,
        allowed: impl fmt::Display,
        message: impl fmt::Display,
    ) -> CaseError {
        let start = self.boundary(span.start);
        let end = self.boundary(span.end).max(start);
        let before = &self.text[..start];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let first_line =
            |from: usize, to: usize| self.text[from..to].lines().next().unwrap_or_default();
        let line_text = first_line(line_start, self.text.len());
        let column = self.text[line_start..start].chars().count() + 1;
        let marked = first_line(start, end).chars().count();
        let (source_line, underline) = underlined(line_text, column, marked);
        CaseError(Box::new(Complaint {
            file: self.file.to_path_buf(),
            line: before.matches('\n').count() + 1,
            column,
            source_line,
            underline,
            key: clip(&key_at(self.text, span)),
            value: clip(&value.to_string()),
            allowed: visible::excerpt(&allowed.to_string(), 4 * WIDTH),
            message: visible::excerpt(&message.to_string(), 4 * WIDTH),
            more: Vec::new(),
        }))
    }

    /// Text at `span`, for messages.
    pub(crate) fn slice(&self, span: &Span) -> &str {
        let start = self.boundary(span.start);
        &self.text[start..self.boundary(span.end).max(start)]
    }

    /// Largest character boundary not after `index`.
    fn boundary(&self, index: usize) -> usize {
        let mut index = index.min(self.text.len());
        while !self.text.is_char_boundary(index) {
            index -= 1;
        }
        index
    }
}

/// The beginning of a text, on one line.
pub(crate) fn clip(text: &str) -> String {
    visible::excerpt(text, WIDTH)
}

/// The part of a line around a column, and the carets under it.
fn underlined(line: &str, column: usize, length: usize) -> (String, String) {
    // A third of the width is left for what precedes the value.
    let long = line.chars().count() > WIDTH;
    let first = if long {
        (column - 1).saturating_sub(WIDTH / 3)
    } else {
        0
    };
    let cut = if first > 0 { "…" } else { "" };
    let rest: String = line.chars().skip(first).collect();
    let shown = cut.to_owned() + &clip(&rest.replace('\t', " "));
    let before = column - 1 - first + cut.chars().count();
    let most = shown.chars().count().saturating_sub(before).max(1);
    let carets = "^".repeat(length.clamp(1, most));
    (shown, " ".repeat(before) + &carets)
}

/// Stack for the parser of TOML [bytes], taken only as far as it is used: on its way past an error it recurses into every
/// bracket that is never closed, which in the largest case file are seventy thousand.
const STACK: usize = 256 << 20;

/// The document of a text.
pub(crate) fn parsed(text: &str) -> Result<Spanned<DeTable<'_>>, toml::de::Error> {
    thread::scope(|scope| {
        let thread = thread::Builder::new().stack_size(STACK);
        match thread.spawn_scoped(scope, || DeTable::parse(text)) {
            Ok(parsing) => parsing.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(_) => DeTable::parse(text),
        }
    })
}

/// Dotted name of the innermost key whose name or value covers `span`; empty in text that is not TOML.
fn key_at(text: &str, span: &Span) -> String {
    let mut found = (usize::MAX, String::new());
    for (key, value) in parsed(text).iter().flat_map(|root| root.get_ref()) {
        let name = key.get_ref().to_string();
        search(
            name,
            [key.span(), value.span()],
            value,
            span,
            DEPTH,
            &mut found,
        );
    }
    found.1
}

/// Looks for a shorter place around `span` among those of a name and what is in its value.
fn search(
    name: String,
    places: [Span; 2],
    value: &Spanned<DeValue<'_>>,
    span: &Span,
    depth: usize,
    found: &mut (usize, String),
) {
    for place in places {
        if place.start <= span.start && span.end <= place.end && place.len() <= found.0 {
            *found = (place.len(), name.clone());
        }
    }
    match value.get_ref() {
        DeValue::Table(table) if depth > 1 => {
            for (key, value) in table {
                let name = format!("{name}.{}", key.get_ref());
                search(
                    name,
                    [key.span(), value.span()],
                    value,
                    span,
                    depth - 1,
                    found,
                );
            }
        }
        DeValue::Array(array) if depth > 1 => {
            for (i, value) in array.iter().enumerate() {
                let places = [value.span(), value.span()];
                search(
                    format!("{name}[{}]", i + 1),
                    places,
                    value,
                    span,
                    depth - 1,
                    found,
                );
            }
        }
        _ => {}
    }
}
