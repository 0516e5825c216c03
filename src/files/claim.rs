//! The right to write into a folder, and what is written there: together or not at all, also where the program is killed.
//!
//! ```text
//! DIR/.stickslip-staging-…/new/            files that are not in place yet
//!                          written.toml    the new list, once all files are complete
//! ```
//! All files are completed in the staging folder (same file system, so a rename is atomic), then moved to their places, the
//! list last. A run that is killed before its list is staged has changed nothing; what it leaves later, the next run of any
//! command completes.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::bundle::{Bundle, FolderError, unique};
use super::digest::sha256;
use super::place::{Kind, kind_below, kind_of, open_to_renames};
use super::written::{LIST, Plan, Written};

/// How the names of staging folders, and of single files that are being written, begin. Only who has a folder alone removes
/// what others left of them.
const STAGING: &str = ".stickslip-staging-";

/// The right to write into a folder. Two runs that wrote into one folder would leave some files of each.
#[must_use]
#[derive(Debug)]
pub struct Claim {
    dir: PathBuf,
    /// Empty: files are added to those of any plan.
    plan: Plan,
    /// Whether results of another plan, and files that were changed since, are replaced.
    force: bool,
    /// Holds the lock; the system takes it back also from a process that was killed. None where it knows no locks of folders.
    _lock: Option<fs::File>,
    /// Folders that were made for it, outer ones first.
    made: Vec<PathBuf>,
}

impl Claim {
    /// Proves that files can be written into `dir`, which need not exist yet, and keeps other runs out of it until the claim
    /// is dropped; to be called before any computing. Folders that stay empty go with the claim. Files of an empty plan stand
    /// beside those of any other and replace only their own kind.
    ///
    /// # Errors
    /// [`FolderError::Io`] naming the path, [`FolderError::Busy`] where another run has a claim, [`FolderError::OtherPlan`]
    /// and [`FolderError::InTheWay`] where the folder holds what must not be replaced.
    pub fn new(dir: &Path, plan: Plan, force: bool) -> Result<Self, FolderError> {
        let claim = Self::take(dir, plan, force, fs::File::try_lock)?;
        claim.settle()?;
        claim.check()
    }

    /// As [`Claim::new`], beside others that share the folder with care, such as the shards of a sweep.
    ///
    /// # Errors
    /// Those of [`Claim::new`].
    pub fn shared(dir: &Path, plan: Plan, force: bool) -> Result<Self, FolderError> {
        Self::take(dir, plan, force, fs::File::try_lock_shared)?.check()
    }

    fn take(
        dir: &Path,
        plan: Plan,
        force: bool,
        lock: impl Fn(&fs::File) -> Result<(), fs::TryLockError>,
    ) -> Result<Self, FolderError> {
        let missing = dir.ancestors().take_while(|path| !path.exists());
        let mut made: Vec<PathBuf> = missing.map(Path::to_path_buf).collect();
        // The parent of a lone name is nothing, which is the folder we are in.
        made.retain(|path| !path.as_os_str().is_empty());
        made.reverse();
        let mut claim = Self {
            dir: dir.to_path_buf(),
            plan,
            force,
            _lock: None,
            made,
        };
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
        Ok(claim)
    }

    /// That files can be written, and those of the plan replaced.
    fn check(self) -> Result<Self, FolderError> {
        write(&Staging::create(&self.dir)?.new_file("probe"), b"probe")?;
        let written = Written::read(&self.dir)?.unwrap_or_default();
        if !self.plan.is_empty() {
            if !self.force {
                written.allow(&self.plan, &self.dir)?;
            }
            let mut listed = written.files.keys();
            listed.try_for_each(|path| self.free(path, &written))?;
        }
        Ok(self)
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Completes what a killed run had begun to move, and removes what it had not completed.
    fn settle(&self) -> Result<(), FolderError> {
        let listing = |e| FolderError::io("list folder", &self.dir, e);
        for entry in fs::read_dir(&self.dir).map_err(listing)? {
            let root = entry.map_err(listing)?.path();
            let name = root.file_name().unwrap_or_default().to_string_lossy();
            if !name.starts_with(STAGING) {
                continue;
            }
            match kind_of(&root)? {
                Kind::Nothing => {}
                Kind::Folder => {
                    let staging = Staging { root };
                    if let Some(after) = Written::read(&staging.root)? {
                        self.complete(&staging, &after)?;
                    }
                }
                Kind::File => {
                    fs::remove_file(&root).map_err(|e| FolderError::io("remove file", &root, e))?;
                }
            }
        }
        Ok(())
    }

    /// Finds out before any computing whether files of these names can be written; any name stands for those of a sub-folder.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`].
    pub fn expect<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Result<(), FolderError> {
        let written = Written::read(&self.dir)?.unwrap_or_default();
        // Those of the plan were looked at when the folder was claimed.
        let own = |path: &&str| written.files.contains_key(*path);
        let mut names = names.into_iter().filter(|path| !own(path));
        names.try_for_each(|path| self.free(path, &written))
    }

    /// Lists the plan before there are files of it, for results that are kept one by one; those of another plan go.
    ///
    /// # Errors
    /// Those of [`Claim::commit`].
    pub fn mark(&self) -> Result<(), FolderError> {
        match Written::read(&self.dir)?.unwrap_or_default().plan == self.plan {
            true => Ok(()),
            false => self.commit(&Bundle::new()),
        }
    }

    /// Writes all files of a bundle, or none. Listed files of an earlier run that are not in the bundle go, unless the plan is
    /// empty; whatever is not listed stays as it is.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`] and [`FolderError::Io`], naming the path; the folder then holds what it held before, or what
    /// it should after the next run.
    pub fn commit(&self, bundle: &Bundle) -> Result<(), FolderError> {
        let mut after = Written::read(&self.dir)?.unwrap_or_default();
        let (own, other) = match self.plan.is_empty() {
            true => (&mut after.beside, &mut after.files),
            false => {
                after.plan.clone_from(&self.plan);
                after.files.clear();
                (&mut after.files, &mut after.beside)
            }
        };
        let staging = Staging::create(&self.dir)?;
        for (path, contents) in bundle.files() {
            write(&staging.new_file(path), contents)?;
            own.insert(path.to_owned(), sha256(contents));
            other.remove(path);
        }
        self.complete(&staging, &after)
    }

    /// Moves what is staged to its place, after a look that nothing is in the way; can be repeated where it was interrupted.
    fn complete(&self, staging: &Staging, after: &Written) -> Result<(), FolderError> {
        let before = Written::read(&self.dir)?.unwrap_or_default();
        let new = after.paths();
        let new: Vec<&String> = new.filter(|path| staging.new_file(path).exists()).collect();
        let stale = before.paths();
        let stale: Vec<&String> = stale.filter(|path| after.digest(path).is_none()).collect();
        for path in new.iter().chain(&stale) {
            self.free(path, &before)?;
        }
        write(&staging.new_file(LIST), after.to_text().as_bytes())?;
        rename(&staging.new_file(LIST), &staging.root.join(LIST))?;
        for path in new {
            rename(&staging.new_file(path), &self.dir.join(path))?;
        }
        for path in stale.into_iter().map(|path| self.dir.join(path)) {
            match fs::remove_file(&path) {
                Err(e) if e.kind() != ErrorKind::NotFound => {
                    return Err(FolderError::io("remove file", &path, e));
                }
                _ => {}
            }
            let folder = path.parent().filter(|folder| *folder != self.dir);
            // One that holds something else stays.
            let _ = folder.map(fs::remove_dir);
        }
        rename(&staging.root.join(LIST), &self.dir.join(LIST))
    }

    /// That nothing stands at a place, or a file that this program may replace, in a folder where it can: a command that ends
    /// half way leaves half of its files.
    fn free(&self, path: &str, written: &Written) -> Result<(), FolderError> {
        let place = self.dir.join(path);
        if let Some(folder) = place.ancestors().skip(1).find(|folder| folder.is_dir()) {
            open_to_renames(folder, &self.dir)
                .map_err(|e| FolderError::io("write into", folder, e))?;
        }
        let why = match (kind_below(&self.dir, path)?, written.digest(path)) {
            (Kind::Nothing, _) => return Ok(()),
            (Kind::Folder, _) => "a folder stands where a file goes",
            (Kind::File, None) => "it was not written by this program",
            (Kind::File, Some(_)) if self.force => return Ok(()),
            (Kind::File, Some(listed)) => match fs::read(&place) {
                Ok(bytes) if sha256(&bytes) == *listed => return Ok(()),
                Ok(_) => "it was changed after it was written",
                Err(e) => return Err(FolderError::io("read file", &place, e)),
            },
        };
        Err(FolderError::InTheWay { path: place, why })
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // Only empty folders can be removed so.
        let removed = self.made.iter().rev().map(fs::remove_dir);
        let _ = removed.collect::<Result<(), _>>();
    }
}

/// Working folder inside the output folder, removed when dropped, unless it is complete and not all of it in place.
struct Staging {
    root: PathBuf,
}

impl Staging {
    fn create(dir: &Path) -> Result<Self, FolderError> {
        let root = dir.join(format!("{STAGING}{}", unique()));
        fs::create_dir(&root).map_err(|e| FolderError::io("create folder", &root, e))?;
        Ok(Self { root })
    }

    fn new_file(&self, path: &str) -> PathBuf {
        self.root.join("new").join(path)
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        if !self.root.join(LIST).exists() {
            let _ = fs::remove_dir_all(&self.root);
        }
    }
}

/// Writes a single file below `dir` under another name and renames it, so that it is whole or absent; not through a link.
///
/// # Errors
/// [`FolderError`]; then no half-written file remains.
pub fn write_whole(dir: &Path, path: &str, contents: &[u8]) -> Result<(), FolderError> {
    kind_below(dir, path)?;
    let place = dir.join(path);
    place.parent().map_or(Ok(()), create_dir)?;
    let partial = dir.join(format!("{STAGING}{}", unique()));
    let written = fs::File::create_new(&partial)
        .and_then(|mut file| {
            file.write_all(contents)?;
            // A full disk may tell only now; the rename must not come before the contents.
            file.sync_all()
        })
        .and_then(|()| fs::rename(&partial, &place));
    written.map_err(|e| {
        // What the user is told is why it could not be written.
        let _ = fs::remove_file(&partial);
        FolderError::io("write file", &place, e)
    })
}

fn create_dir(dir: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(dir).map_err(|e| FolderError::io("create folder", dir, e))
}

fn rename(from: &Path, to: &Path) -> Result<(), FolderError> {
    to.parent().map_or(Ok(()), create_dir)?;
    fs::rename(from, to).map_err(|e| FolderError::io("write file", to, e))
}

fn write(path: &Path, contents: &[u8]) -> Result<(), FolderError> {
    path.parent().map_or(Ok(()), create_dir)?;
    fs::write(path, contents).map_err(|e| FolderError::io("write file", path, e))
}
