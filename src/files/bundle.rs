//! Files written together or not at all.
//!
//! Contents are collected in memory, written to a staging folder inside the output folder (same file system, so a rename
//! is atomic), and renamed only when every file is complete. A file that stood in the way is moved aside first and moved
//! back when a later rename fails.

use std::collections::BTreeMap;
use std::fs;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::{Component, Path, PathBuf};

/// Failure to write into a folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// The file system refused.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// What was tried, e.g. `create folder`.
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Another process writes there.
    #[error("another run is writing into `{}`: wait for it, or choose another folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
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
        let inside = !path.is_empty()
            && Path::new(&path)
                .components()
                .all(|c| matches!(c, Component::Normal(_)));
        if !inside {
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

    /// Contents of one file.
    pub fn get(&self, path: &str) -> Option<&[u8]> {
        self.files.get(path).map(Vec::as_slice)
    }

    /// As [`commit`](Self::commit); then files of the sub-folder `own` that are not in the bundle go: what an earlier run drew
    /// and this one does not would stay as if it were of this run.
    ///
    /// # Errors
    /// Those of [`commit`](Self::commit), and a folder that cannot be listed or cleared.
    pub fn commit_all(&self, dir: &Path, own: &str) -> Result<(), FolderError> {
        self.commit(dir)?;
        let folder = dir.join(own);
        if !folder.is_dir() {
            return Ok(());
        }
        let listing = |e| FolderError::io("list folder", &folder, e);
        for entry in fs::read_dir(&folder).map_err(listing)? {
            let path = entry.map_err(listing)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if path.is_file() && !self.files.contains_key(&format!("{own}/{name}")) {
                fs::remove_file(&path).map_err(|e| FolderError::io("remove file", &path, e))?;
            }
        }
        Ok(())
    }

    /// Writes everything into `dir`, replacing files of the same name; other files stay.
    ///
    /// # Errors
    /// [`FolderError::Io`] naming the path; the folder then holds what it held before.
    pub fn commit(&self, dir: &Path) -> Result<(), FolderError> {
        create_dir(dir)?;
        let staging = Staging::create(dir)?;
        for (name, contents) in &self.files {
            write(&staging.new_files().join(name), contents)?;
        }
        let mut swapped = Vec::new();
        for name in self.files.keys() {
            if let Err(error) = staging.swap_in(dir, name, &mut swapped) {
                staging.swap_out(dir, &swapped);
                return Err(error);
            }
        }
        Ok(())
    }
}

/// Proves that files can be written into `dir`, which need not exist yet, and keeps other runs out of it until the claim
/// is dropped; to be called before any computing. Folders that stay empty go with the claim.
///
/// # Errors
/// [`FolderError::Io`] naming the path, [`FolderError::Busy`] where another run has a claim.
pub fn prepare_output(dir: &Path) -> Result<Claim, FolderError> {
    Claim::new(dir, fs::File::try_lock)
}

/// As [`prepare_output`], beside others that share the folder with care, such as the shards of a sweep.
///
/// # Errors
/// Those of [`prepare_output`].
pub fn prepare_shared_output(dir: &Path) -> Result<Claim, FolderError> {
    Claim::new(dir, fs::File::try_lock_shared)
}

/// The right to write into a folder. Two runs that wrote into one folder would leave some files of each.
#[must_use]
#[derive(Debug)]
pub struct Claim {
    /// Holds the lock; the system takes it back also from a process that was killed. None where it knows no locks of folders.
    _lock: Option<fs::File>,
    /// Folders that were made for it, outer ones first.
    made: Vec<PathBuf>,
}

impl Claim {
    fn new(
        dir: &Path,
        lock: impl Fn(&fs::File) -> Result<(), fs::TryLockError>,
    ) -> Result<Self, FolderError> {
        let missing = dir.ancestors().take_while(|path| !path.exists());
        let mut made: Vec<PathBuf> = missing.map(Path::to_path_buf).collect();
        // The parent of a lone name is nothing, which is the folder we are in.
        made.retain(|path| !path.as_os_str().is_empty());
        made.reverse();
        let mut claim = Self { _lock: None, made };
        create_dir(dir)?;
        if let Ok(folder) = fs::File::open(dir) {
            match lock(&folder) {
                Ok(()) => claim._lock = Some(folder),
                Err(fs::TryLockError::WouldBlock) => {
                    // The folders are the other run's, which may have made nothing in them yet.
                    claim.made.clear();
                    let path = dir.to_path_buf();
                    return Err(FolderError::Busy { path });
                }
                // Some file systems know no locks.
                Err(fs::TryLockError::Error(_)) => {}
            }
        }
        let staging = Staging::create(dir)?;
        write(&staging.new_files().join("probe"), b"probe")?;
        drop(staging);
        Ok(claim)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // Only empty folders can be removed so.
        let removed = self.made.iter().rev().map(fs::remove_dir);
        let _ = removed.collect::<Result<(), _>>();
    }
}

/// Working folder inside the output folder, removed when dropped.
struct Staging {
    root: PathBuf,
}

/// One file that has been put in place.
struct Swapped<'a> {
    name: &'a str,
    replaced: bool,
}

impl Staging {
    fn create(dir: &Path) -> Result<Self, FolderError> {
        let root = dir.join(format!(".stickslip-partial-{}", unique()));
        fs::create_dir(&root).map_err(|e| FolderError::io("create folder", &root, e))?;
        Ok(Self { root })
    }

    fn new_files(&self) -> PathBuf {
        self.root.join("new")
    }

    fn old_files(&self) -> PathBuf {
        self.root.join("old")
    }

    /// Moves one staged file to its place; what stood there is kept in the staging folder.
    fn swap_in<'a>(
        &self,
        dir: &Path,
        name: &'a str,
        swapped: &mut Vec<Swapped<'a>>,
    ) -> Result<(), FolderError> {
        let target = dir.join(name);
        if let Some(parent) = target.parent() {
            create_dir(parent)?;
        }
        if target.is_dir() {
            let source = std::io::Error::new(
                std::io::ErrorKind::IsADirectory,
                "a folder stands where a file goes",
            );
            return Err(FolderError::io("write file", &target, source));
        }
        let replaced = target.exists();
        if replaced {
            let old = self.old_files().join(name);
            if let Some(parent) = old.parent() {
                create_dir(parent)?;
            }
            fs::rename(&target, &old).map_err(|e| FolderError::io("replace file", &target, e))?;
        }
        swapped.push(Swapped { name, replaced });
        fs::rename(self.new_files().join(name), &target)
            .map_err(|e| FolderError::io("write file", &target, e))
    }

    /// Undoes [`Staging::swap_in`]. The first failure is what the user is told, so failures in here are not reported.
    fn swap_out(&self, dir: &Path, swapped: &[Swapped<'_>]) {
        for file in swapped.iter().rev() {
            let target = dir.join(file.name);
            let _ = fs::remove_file(&target);
            if file.replaced {
                let _ = fs::rename(self.old_files().join(file.name), &target);
            }
        }
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.root);
    }
}

/// A word that no other command uses at the same time, also on other machines and in containers whose processes have the
/// same numbers.
pub fn unique() -> String {
    // The standard library seeds its hash maps at random.
    let random = RandomState::new().build_hasher().finish();
    format!("{}-{random:016x}", std::process::id())
}

fn create_dir(dir: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(dir).map_err(|e| FolderError::io("create folder", dir, e))
}

fn write(path: &Path, contents: &[u8]) -> Result<(), FolderError> {
    if let Some(parent) = path.parent() {
        create_dir(parent)?;
    }
    fs::write(path, contents).map_err(|e| FolderError::io("write file", path, e))
}
