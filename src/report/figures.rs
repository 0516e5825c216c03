//! Figures: one file per kind.

use crate::report::tables::Chapter;

/// A kind of figure.
pub struct Kind {
    /// Name of its files; `*` stands for what tells them apart.
    pub name: &'static str,
    /// The reader's question that it answers.
    pub question: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Where it belongs.
    pub chapter: Chapter,
}

impl Kind {
    /// Whether a file is of this kind.
    pub fn is_of(&self, name: &str) -> bool {
        match self.name.split_once('*') {
            Some((begin, end)) => name.starts_with(begin) && name.ends_with(end),
            None => name == self.name,
        }
    }
}

/// All kinds.
pub const CATALOGUE: [Kind; 0] = [];
