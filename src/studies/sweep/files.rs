//! Problem files as problems of a sweep: named by their place in the collection, told apart by the digest of their bytes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use stickslip_methods::Tier;

use super::cell::{Cell, FROM_FILE, Named, Source, Task, digest_of_bytes};
use super::measure::Repeats;
use super::plan::Plan;
use crate::files::interchange::{Problem, fclib};
use crate::run::registry::methods;
use crate::studies::exchange::collection::{CollectionError, Entry, entries};
use crate::studies::exchange::problem_file::file_name;

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
                method: method.argument.clone(),
                tolerance,
                program: method.program.clone(),
            };
            Task {
                id: cell.id(),
                cell,
                source: source.clone(),
            }
        };
        pairs.map(task).collect()
    }
}

impl Plan {
    /// Every method with its defaults at every tier on the problem files of a folder.
    ///
    /// # Errors
    /// A folder that cannot be listed.
    pub fn of_folder(folder: &Path) -> Result<Self, CollectionError> {
        let files = FileProblem::all(&[folder.into()])?;
        let methods: Vec<Named> = methods()
            .iter()
            .map(|m| Named {
                argument: m.name.to_owned(),
                program: None,
            })
            .collect();
        let tolerances = Tier::ALL.map(Tier::tolerance);
        let of_file = |file: &FileProblem| file.tasks(&methods, &tolerances);
        let mut tasks: Vec<Task> = files.iter().flat_map(of_file).collect();
        tasks.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(Self {
            title: format!("Problems of {}", file_name(folder)),
            repeats: Repeats::DEFAULT,
            tasks,
        })
    }
}
