//! Common parts of sources: the problems that they yield, and lists of a sweep file.

use crate::case::CaseError;
use crate::case::reader::Value;
use crate::studies::axes::{Axes, Subject};

/// A problem with what it is combined with where the sweep does not say.
pub struct Problem {
    /// The problem.
    pub subject: Subject,
    /// Its own axes.
    pub axes: Axes,
    /// Number of its cracks, which a friction coefficient of the sweep is for; none: it has no axes but methods and tolerances.
    pub cracks: Option<usize>,
    /// What its time depends on; none of a file.
    pub size: Option<Size>,
}

/// What the time that a case takes depends on.
#[derive(Clone, Copy)]
pub struct Size {
    /// Dimension.
    pub dim: usize,
    /// Number of cells at refinement 1.
    pub cells: f64,
    /// Whether a crack ends inside the body.
    pub ends: bool,
    /// Increments of its path.
    pub increments: usize,
}

/// Largest number of problems that one entry of a sweep file asks for: all are read or drawn before anything is measured.
pub const MOST: usize = 10_000;

/// A list with at least one entry.
///
/// # Errors
/// The first entry that is refused, or an empty list.
pub(crate) fn entries<'a, T>(
    list: Value<'a>,
    mut read: impl FnMut(Value<'a>) -> Result<T, CaseError>,
) -> Result<Vec<T>, CaseError> {
    let values = list.list()?;
    if values.is_empty() {
        return Err(list.refuse("at least one entry", "empty list"));
    }
    values.into_iter().map(&mut read).collect()
}
