//! What is measured: one case on one mesh, with one contact space, friction, number of increments, start, method and tolerance.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::files::digest::sha256;
use crate::run::choice::Choice;

/// Longest id: with the ending of a file that is being written it is the name of a file.
const MAX_ID: usize = 200;

/// What describes the problem of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Source {
    /// Text of a case file.
    Case(String),
    /// Path of a problem file.
    File(PathBuf),
}

/// One cell of a sweep. Everything that decides about its numbers is in here, and nothing else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the case, or of the problem of a file.
    pub case: String,
    /// SHA-256 of the case file or problem file, the first 16 hexadecimal digits.
    pub digest: String,
    /// Refinement factor of the mesh, from 1.
    pub refine: usize,
    /// Contact space of all cracks; `None`: the case's own; `fclib` of a problem file.
    pub space: Option<String>,
    /// Friction coefficient of every crack.
    pub friction: Vec<f64>,
    /// Equal increments that each of the case's is divided in, from 1.
    pub increments: usize,
    /// Whether methods begin every increment from no contact forces in place of those in which the one before ended. Slip is
    /// measured from there all the same.
    pub cold: bool,
    /// Method as on the command line: `name` or `name:option=value,…`.
    pub method: String,
    /// Natural map asked of the method and accepted by the judge.
    pub tolerance: f64,
    /// Digest of the file where the method is a [`Program`](crate::run::outside::Program). No part of the id: a program that
    /// changed is measured again, in place of what it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
}

/// Contact space of problems from files, in place of that of a case.
pub const FROM_FILE: &str = "fclib";

impl Cell {
    /// Whether its problem comes from a problem file.
    pub fn is_from_file(&self) -> bool {
        self.space.as_deref() == Some(FROM_FILE)
    }

    /// Friction coefficient of the first crack; 0 without cracks.
    pub fn mu(&self) -> f64 {
        self.friction.first().copied().unwrap_or(0.0)
    }

    /// Stable name, also of the record's file: what a reader wants to know, then 8 hexadecimal digits of the SHA-256 of
    /// the cell, which tell apart what the readable part does not (the case file, the coefficients of further cracks).
    pub fn id(&self) -> String {
        let space = self.space.as_deref().unwrap_or("own");
        let (case, mu) = (&self.case, self.mu());
        let how = format!("{}.tol-{:e}", self.method, self.tolerance);
        let path = self.problem().path_name();
        let readable = format!("{case}.r{}.{space}.mu-{mu}{path}.{how}", self.refine);
        let exact = format!("{readable} {} {:?}", self.digest, self.friction);
        let safe = |c: char| if is_safe(c) { c } else { '-' };
        // The digest tells apart what is cut off.
        let name: String = readable.chars().map(safe).take(MAX_ID - 9).collect();
        format!("{name}.{}", &sha256(exact.as_bytes())[..8])
    }

    /// What methods are given alike: the id without method and tolerance.
    pub fn problem(&self) -> Problem {
        Problem {
            case: self.case.clone(),
            digest: self.digest.clone(),
            refine: self.refine,
            space: self.space.clone(),
            friction: self.friction.clone(),
            increments: self.increments,
            cold: self.cold,
        }
    }
}

/// Whether a text may be an id, and so the name of a file in the folder of the records and nowhere else.
pub(super) fn is_id(text: &str) -> bool {
    (1..=MAX_ID).contains(&text.len()) && text.chars().all(is_safe)
}

fn is_safe(c: char) -> bool {
    c.is_ascii_alphanumeric() || "._-=".contains(c)
}

/// A cell with what it takes to measure it anywhere.
#[derive(Debug, Clone)]
pub struct Task {
    /// [`Cell::id`].
    pub id: String,
    /// The cell.
    pub cell: Cell,
    /// Its case file or problem file.
    pub source: Arc<Source>,
}

impl Task {
    /// A cell under its id.
    pub fn new(cell: Cell, source: Arc<Source>) -> Self {
        Self {
            id: cell.id(),
            cell,
            source,
        }
    }
}

/// A method of some cells.
pub(super) struct Named {
    /// As in [`Cell::method`].
    pub argument: String,
    /// As in [`Cell::program`].
    pub program: Option<String>,
}

impl Named {
    pub fn of(choice: &Choice) -> Self {
        Self {
            argument: choice.argument(),
            program: choice.program().map(|own| own.digest().to_owned()),
        }
    }
}

/// What several cells solve. Methods are compared from the same start and in the same increments, so other ones make it another
/// problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// As in [`Cell`].
    pub case: String,
    /// As in [`Cell`].
    pub digest: String,
    /// As in [`Cell`].
    pub refine: usize,
    /// As in [`Cell`].
    pub space: Option<String>,
    /// As in [`Cell`].
    pub friction: Vec<f64>,
    /// As in [`Cell`].
    pub increments: usize,
    /// As in [`Cell`].
    pub cold: bool,
}

impl Problem {
    /// How the path is followed, as a part of names: nothing where it is followed as the case says, from warm starts.
    pub fn path_name(&self) -> String {
        let mut name = match self.increments {
            1 => String::new(),
            many => format!(".increments-{many}"),
        };
        if self.cold {
            name += ".cold";
        }
        name
    }

    /// The same whatever the mesh.
    pub fn without_mesh(&self) -> Self {
        Self {
            refine: 0,
            ..self.clone()
        }
    }
}

/// Digest of a case file, as in [`Cell::digest`].
pub fn digest(text: &str) -> String {
    digest_of_bytes(text.as_bytes())
}

/// The same of a file of any kind.
pub fn digest_of_bytes(bytes: &[u8]) -> String {
    sha256(bytes)[..16].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> Cell {
        Cell {
            case: "plate".into(),
            digest: digest("text"),
            refine: 2,
            space: None,
            friction: vec![0.1, 0.2],
            increments: 1,
            cold: false,
            method: "penalty:normal=1e2".into(),
            tolerance: 1e-6,
            program: None,
        }
    }

    #[test]
    fn the_digest_is_sha_256() {
        // FIPS 180-2, appendix B.1: SHA-256 of "abc".
        assert_eq!(digest("abc"), "ba7816bf8f01cfea");
    }

    #[test]
    fn an_id_can_be_read_and_is_a_file_name() {
        let id = cell().id();
        let readable = "plate.r2.own.mu-0.1.penalty-normal=1e2.tol-1e-6.";
        assert!(id.starts_with(readable), "{id}");
        assert_eq!(id.len(), readable.len() + 8);
        let path = Cell {
            increments: 10,
            cold: true,
            ..cell()
        };
        assert!(path.id().contains(".mu-0.1.increments-10.cold.penalty"));
    }

    #[test]
    fn whatever_changes_a_cell_changes_its_id() {
        let changes: [fn(&mut Cell); 10] = [
            |c| c.case.push('x'),
            |c| c.digest = digest("other"),
            |c| c.refine = 3,
            |c| c.space = Some("star".into()),
            |c| c.friction[1] = 0.3,
            |c| c.friction[0] = 0.3,
            |c| c.increments = 10,
            |c| c.cold = true,
            |c| c.method = "penalty,normal=1e2".into(),
            |c| c.tolerance = 1e-7,
        ];
        let mut ids = vec![cell().id()];
        for change in changes {
            let mut changed = cell();
            change(&mut changed);
            ids.push(changed.id());
        }
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), 11);
        assert_eq!(cell().id(), cell().id());
    }
}
