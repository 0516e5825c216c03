//! Files of one command, collected in memory; a [`Claim`](super::claim::Claim) writes them together or not at all. What may
//! go wrong, and names.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Failure to write into a folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// The file system refused.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// The attempt, e.g. `create folder`.
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Something that this program did not write stands where it writes, or a link.
    #[error("`{}` is in the way: {why}; move it away, or choose another folder", path.display())]
    InTheWay {
        /// The text there.
        path: PathBuf,
        /// Why it is not replaced.
        why: &'static str,
    },
    /// The folder holds the results of another plan.
    #[error(
        "`{}` holds results of another plan ({what}: `{there}`, here `{here}`); choose another folder with --out, or --force to replace them",
        path.display()
    )]
    OtherPlan {
        /// The folder.
        path: PathBuf,
        /// The difference.
        what: String,
        /// There.
        there: String,
        /// Here.
        here: String,
    },
    /// Two outputs were given the same file name.
    #[error("two outputs are named `{path}`")]
    Duplicate {
        /// File name relative to the output folder.
        path: String,
    },
    /// An output name that would leave the output folder.
    #[error("output name `{path}` is not a relative path inside the output folder")]
    OutsideFolder {
        /// The refused name.
        path: String,
    },
}

impl FolderError {
    /// The file system refused an action on a path.
    pub fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io {
            action,
            path: path.to_path_buf(),
            source,
        }
    }
}

/// Parts joined by dots; other characters than letters, digits, `.`, `-`, `_` and `=` become `-`.
pub fn file_name(parts: &[&str]) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "._-=".contains(c);
    let clean = |c: char| if allowed(c) { c } else { '-' };
    parts.join(".").chars().map(clean).collect()
}

/// Files of one command, by path relative to the output folder.
#[derive(Debug, Default)]
pub struct Bundle {
    files: BTreeMap<String, Vec<u8>>,
}

impl Bundle {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one file; `path` is relative, with `/` between folders.
    ///
    /// # Errors
    /// [`FolderError::Duplicate`] when the name is taken, [`FolderError::OutsideFolder`] when it is absolute, empty or
    /// climbs out of the folder.
    pub fn add(
        &mut self,
        path: impl Into<String>,
        contents: impl Into<Vec<u8>>,
    ) -> Result<(), FolderError> {
        let path = path.into();
        if !is_inside(&path) {
            return Err(FolderError::OutsideFolder { path });
        }
        if self.files.contains_key(&path) {
            return Err(FolderError::Duplicate { path });
        }
        self.files.insert(path, contents.into());
        Ok(())
    }

    /// Adds the files of another bundle.
    ///
    /// # Errors
    /// Those of [`Bundle::add`].
    pub fn append(&mut self, other: Bundle) -> Result<(), FolderError> {
        let mut files = other.files.into_iter();
        files.try_for_each(|(path, contents)| self.add(path, contents))
    }

    /// Names of the files, sorted.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// Names and contents, sorted by name.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        let files = self.files.iter();
        files.map(|(path, contents)| (path.as_str(), contents.as_slice()))
    }

    /// Contents of one file.
    pub fn get(&self, path: &str) -> Option<&[u8]> {
        self.files.get(path).map(Vec::as_slice)
    }
}

/// Whether a name stays below its folder.
pub(super) fn is_inside(path: &str) -> bool {
    let parts = Path::new(path).components();
    let below = parts.filter(|part| matches!(part, Component::Normal(_)));
    !path.is_empty() && below.collect::<PathBuf>().as_os_str() == path
}
