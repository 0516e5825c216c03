//! Problem files as problems of a sweep: named by their place in the collection, told apart by the digest of their bytes.

use std::path::PathBuf;
use std::sync::Arc;

use super::cell::{Cell, FROM_FILE, Named, Source, Task, digest_of_bytes};
use crate::files::interchange::{Problem, fclib};
use crate::studies::exchange::collection::{CollectionError, Entry, entries};

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
        let all = entries(named)?;
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

    fn new(entry: Entry) -> Result<Self, CollectionError> {
        let bytes = std::fs::read(&entry.path).map_err(|source| CollectionError::Io {
            path: entry.path.clone(),
            source,
        })?;
        let digest = digest_of_bytes(&bytes);
        let friction = match fclib::from_bytes(&entry.path, bytes) {
            Ok(Problem::Local(problem)) => problem.mu,
            Ok(Problem::Global(problem)) => problem.mu,
            Err(_) => Vec::new(),
        };
        Ok(Self {
            entry,
            digest,
            friction: friction.into_iter().take(1).collect(),
        })
    }

    /// Its cells.
    pub(super) fn tasks(&self, methods: &[Named], tolerances: &[f64]) -> Vec<Task> {
        let source = Arc::new(Source::File(self.entry.path.clone()));
        let pairs = methods
            .iter()
            .flat_map(|method| tolerances.iter().map(move |tolerance| (method, *tolerance)));
        let task = |(method, tolerance): (&Named, f64)| {
            let cell = Cell {
                case: self.entry.name.clone(),
                digest: self.digest.clone(),
                refine: 1,
                space: Some(FROM_FILE.into()),
                friction: self.friction.clone(),
                increments: 1,
                cold: false,
                method: method.argument.clone(),
                tolerance,
                program: method.program.clone(),
            };
            Task::new(cell, source.clone())
        };
        pairs.map(task).collect()
    }
}
