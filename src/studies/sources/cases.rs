//! Shipped cases and case files.

use std::path::Path;

use super::{Problem, Size, entries};
use crate::case::reader::Value;
use crate::case::{self, Case, CaseError, shipped};
use crate::studies::axes::{Axes, Subject};
use crate::studies::tips::{Regularity, regularity};

impl Problem {
    /// A case, as it says itself where a sweep does not.
    pub fn of(case: &Case) -> Self {
        Self {
            subject: Subject::of(case),
            axes: Axes::of(case),
            cracks: Some(case.cracks.len()),
            size: Some(Size {
                dim: case.model.dim(),
                cells: case.mesh.grid.cells(),
                ends: regularity(case) != Regularity::Smooth,
                increments: case.path.increments,
            }),
        }
    }
}

/// `cases = ["plate_mesh1", "my_case.toml"]`.
///
/// # Errors
/// A name nobody knows, a file that cannot be read or is refused.
pub(crate) fn read(value: Value<'_>, folder: &Path) -> Result<Vec<Problem>, CaseError> {
    entries(value, |v| Ok(Problem::of(&find(v, folder)?)))
}

fn find(value: Value<'_>, folder: &Path) -> Result<Case, CaseError> {
    let name = value.string()?;
    if let Some(case) = shipped::find(name) {
        return case;
    }
    if !name.ends_with(".toml") {
        let known: Vec<&str> = shipped::CASES.iter().map(|c| c.0).collect();
        let allowed = format!("a file.toml, or one of {}", known.join(", "));
        return Err(value.refuse(allowed, "unknown case"));
    }
    // A fault in the case stands there; that there is none is wrong here.
    case::read(folder.join(name)).map_err(|e| match e.line() {
        0 => value.refuse(e.allowed(), format_args!("{}: {}", e.message(), e.value())),
        _ => e,
    })
}
