//! Sources of problems: what a sweep file may name. A new one is its file and a line in `SOURCES`.

pub mod bodies;
pub mod cases;
pub mod collection;
pub mod exercises;
pub mod files;
mod problem;
pub mod random;

pub(crate) use problem::entries;
pub use problem::{MOST, Problem, Size};

use std::path::Path;

use crate::case::CaseError;
use crate::case::reader::Value;

/// Reads what a sweep file asks of a source; files are looked for in the folder.
pub(crate) type Source = fn(Value<'_>, &Path) -> Result<Vec<Problem>, CaseError>;

/// All sources, by their keys in a sweep file.
pub(crate) const SOURCES: [(&str, Source); 4] = [
    ("cases", cases::read),
    ("random", random::read),
    ("bodies", bodies::read),
    ("files", files::read),
];
