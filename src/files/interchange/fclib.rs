//! FCLIB files, of the local or the global problem.
//!
//! ```text
//! /fclib_local  or  /fclib_global     spacedim, matrices, vectors, info
//! /solution                           v, u, r, l
//! /guesses                            number_of_guesses; 1, 2, …: v, u, r, l
//! matrix                              m, n, nzmax, nz, p, i, x
//! ```

use std::path::Path;
use std::thread;

use super::error::InterchangeError;
use super::fclib_global::GlobalProblem;
use super::fclib_local::LocalProblem;
use super::hdf5::{Tree, is_signed};
use crate::files::regular;
use crate::files::visible::excerpt;

/// Largest file read [bytes]; those of the FCLIB collection have some hundred megabytes.
const MAX_BYTES: u64 = 4 << 30;

/// Stack for decoding [bytes], taken only as far as it is used. Types of HDF5 nest up to eight thousand deep, as many as a
/// header of 64 kB holds, and the library recurses into each.
const STACK: usize = 256 << 20;

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
    let unreadable = |source| InterchangeError::Io {
        path: path.into(),
        source,
    };
    let (mut file, len) = regular::open(path).map_err(unreadable)?;
    // A large file of something else is not worth the memory.
    if !is_signed(&mut file, len).map_err(unreadable)? {
        let reason = "it does not begin like HDF5";
        return Err(InterchangeError::unreadable(path, "", reason));
    }
    let bytes = regular::rest(file, MAX_BYTES).map_err(unreadable)?;
    from_bytes(path, bytes)
}

/// Reads the bytes of a file of either kind; `path` is only for messages.
///
/// # Errors
/// Those of [`read`].
pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Problem, InterchangeError> {
    let failed = || InterchangeError::refused(path, "the decoder of HDF5 broke down on it");
    thread::scope(|scope| {
        let thread = thread::Builder::new().stack_size(STACK);
        let decoding = thread.spawn_scoped(scope, move || decode(path, bytes));
        let decoding = decoding.map_err(|source| InterchangeError::Io {
            path: path.into(),
            source,
        })?;
        // No bytes are known on which the library panics; with such it would not take the program along.
        decoding.join().unwrap_or_else(|_| Err(failed()))
    })
}

fn decode(path: &Path, bytes: Vec<u8>) -> Result<Problem, InterchangeError> {
    let tree = Tree::open(path, bytes)?;
    if let Some(sign) = rolling(&tree) {
        let what = format!(
            "rolling-friction problem: {sign}; only Coulomb friction of contact forces is solved, not of moments"
        );
        return Err(InterchangeError::refused(path, what));
    }
    let has = |group| tree.has_group(group);
    let found = match (has("fclib_local")?, has("fclib_global")?) {
        (true, false) => return LocalProblem::read(&tree).map(Problem::Local),
        (false, true) => return GlobalProblem::read(&tree).map(Problem::Global),
        (true, true) => "two problems",
        (false, false) => "no problem",
    };
    let what =
        format!("it holds {found}, expected one of the groups /fclib_local and /fclib_global");
    Err(InterchangeError::refused(path, what))
}

/// By what a file shows that its contacts resist rolling, with a moment beside the force at every contact: a group of its own,
/// as `/fclib_global_rolling` of FCLIB since 2021, coefficients of rolling friction μ_r beside μ, or the components (n, a, b)
/// with two moments. In the plane (n, a) with one moment has as many components as a point in space: μ_r tells.
fn rolling(tree: &Tree) -> Option<String> {
    /// Longest name shown.
    const SHOWN: usize = 60;
    let named = |group: &str, is_one: fn(&str) -> bool| {
        let found = tree.names(group).into_iter().find(|name| is_one(name));
        found.map(|name| excerpt(&name, SHOWN))
    };
    if let Some(name) = named("", |name| name.to_lowercase().contains("rolling")) {
        return Some(format!("group /{name}"));
    }
    let groups = ["fclib_local", "fclib_global"].into_iter();
    groups.into_iter().find_map(|group| {
        let vectors = format!("{group}/vectors");
        let coefficient = |name: &str| ["mu_r", "mur"].contains(&name) || name.contains("roll");
        if let Some(name) = named(&vectors, coefficient) {
            return Some(format!(
                "{vectors}/{name}, coefficients of rolling friction"
            ));
        }
        let five = tree.integer(&format!("{group}/spacedim")).ok() == Some(5);
        five.then(|| format!("{group}/spacedim = 5, a force and two moments per contact"))
    })
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
