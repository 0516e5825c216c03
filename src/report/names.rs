//! Names of files.

use super::number::value;
pub use crate::files::bundle::file_name;
use crate::studies::rows::RunKey;

/// File name part for a run without its increment: `case.mesh.space.method.mu-0.1`, other characters than letters,
/// digits, `.`, `-`, `_` and `=` replaced by `-`.
pub fn stem(key: &RunKey) -> String {
    let friction = value(key.friction);
    file_name(&[
        &key.case,
        &key.mesh,
        &key.space,
        &key.method,
        &format!("mu-{friction}"),
    ])
}

/// File name part for the problem of a run, without its method: `case.mesh.space.mu-0.1`.
pub fn problem_name(key: &RunKey) -> String {
    let friction = format!("mu-{}", value(key.friction));
    file_name(&[&key.case, &key.mesh, &key.space, &friction])
}
