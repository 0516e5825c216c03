//! Problem files as problems of a sweep: named by their place in the collection, told apart by the digest of their bytes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::collection::{self, CollectionError, Entry, family};
use super::{Problem, entries};
use crate::case::CaseError;
use crate::case::reader::Value;
use crate::files::interchange::{Problem as Read, fclib};
use crate::studies::axes::{Axes, Subject};
use crate::studies::task::{Matter, digest_of_bytes};

/// A problem file.
#[derive(Debug, Clone)]
pub struct FileProblem {
    entry: Entry,
    digest: String,
    /// That of the first contact point; none of a file that cannot be read, which the worker refuses.
    friction: Vec<f64>,
}

impl FileProblem {
    /// All problem files among these and below the folders among them.
    ///
    /// # Errors
    /// A folder or file that cannot be read; two files of one name.
    pub fn all(named: &[PathBuf]) -> Result<Vec<Self>, CollectionError> {
        let all = collection::entries(named)?;
        let mut names: Vec<&Entry> = all.iter().collect();
        names.sort();
        if let Some(twins) = names.windows(2).find(|pair| pair[0].name == pair[1].name) {
            return Err(CollectionError::Contents {
                path: twins[1].path.clone(),
                what: format!(
                    "`{}` is named `{}` too",
                    twins[0].path.display(),
                    twins[0].name
                ),
            });
        }
        all.into_iter().map(Self::new).collect()
    }

    /// A file.
    ///
    /// # Errors
    /// One that cannot be read.
    pub fn new(entry: Entry) -> Result<Self, CollectionError> {
        let bytes = std::fs::read(&entry.path).map_err(|source| CollectionError::Io {
            path: entry.path.clone(),
            source,
        })?;
        let digest = digest_of_bytes(&bytes);
        let friction = match fclib::from_bytes(&entry.path, bytes) {
            Ok(Read::Local(problem)) => problem.mu,
            Ok(Read::Global(problem)) => problem.mu,
            Err(_) => Vec::new(),
        };
        Ok(Self {
            entry,
            digest,
            friction: friction.into_iter().take(1).collect(),
        })
    }

    /// As a source yields it.
    pub fn problem(&self) -> Problem {
        Problem {
            subject: Subject {
                name: self.entry.name.clone(),
                class: family(&self.entry.name).to_owned(),
                matter: Arc::new(Matter::File(self.entry.path.clone())),
                digest: self.digest.clone(),
            },
            axes: Axes::of_file(&self.friction),
            cracks: None,
            size: None,
        }
    }
}

/// `files = ["collection", "problem.hdf5"]`.
///
/// # Errors
/// The first entry that cannot be listed or read.
pub(crate) fn read(value: Value<'_>, folder: &Path) -> Result<Vec<Problem>, CaseError> {
    let named = entries(value, |v| Ok(folder.join(v.string()?)))?;
    let allowed = "files, and folders that hold some";
    let files = FileProblem::all(&named).map_err(|e| value.refuse(allowed, e))?;
    Ok(files.iter().map(FileProblem::problem).collect())
}
