//! FCLIB files, of the local or the global problem.
//!
//! ```text
//! /fclib_local  or  /fclib_global     spacedim, matrices, vectors, info
//! /solution                           v, u, r, l
//! /guesses                            number_of_guesses; 1, 2, …: v, u, r, l
//! matrix                              m, n, nzmax, nz, p, i, x
//! ```

use std::path::Path;

use super::error::InterchangeError;
use super::fclib_global::GlobalProblem;
use super::fclib_local::LocalProblem;
use super::hdf5::Tree;

/// A problem file.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// Condensed to the contact points.
    Local(LocalProblem),
    /// With all displacement unknowns.
    Global(GlobalProblem),
}

/// Reads a file of either kind.
///
/// # Errors
/// [`InterchangeError`], naming file, dataset, index, value and what is allowed.
pub fn read(path: &Path) -> Result<Problem, InterchangeError> {
    let bytes = std::fs::read(path).map_err(|source| InterchangeError::Io {
        path: path.into(),
        source,
    })?;
    from_bytes(path, bytes)
}

/// Reads the bytes of a file of either kind; `path` is only for messages.
///
/// # Errors
/// Those of [`read`].
pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Problem, InterchangeError> {
    let tree = Tree::open(path, bytes)?;
    let none = |found| {
        let allowed = "one of the groups /fclib_local and /fclib_global";
        InterchangeError::unexpected(path, found, allowed)
    };
    match (
        tree.has_group("fclib_local")?,
        tree.has_group("fclib_global")?,
    ) {
        (true, false) => LocalProblem::read(&tree).map(Problem::Local),
        (false, true) => GlobalProblem::read(&tree).map(Problem::Global),
        (true, true) => Err(none("it holds two problems")),
        (false, false) => Err(none("it holds no problem")),
    }
}

impl Problem {
    /// The bytes of the file.
    ///
    /// # Errors
    /// [`InterchangeError::Unwritable`] if the parts do not fit or exceed 32-bit integers.
    pub fn to_bytes(&self) -> Result<Vec<u8>, InterchangeError> {
        match self {
            Problem::Local(problem) => problem.to_bytes(),
            Problem::Global(problem) => problem.to_bytes(),
        }
    }
}
