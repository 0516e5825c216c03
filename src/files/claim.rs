//! An output folder: which results it holds, and which files this program wrote there.
//!
//! ```text
//! DIR/written.toml    what was asked for, and the files that hold it
//! ```
//! Files are written under other names and renamed. The list comes first with the old files and the new, so that a run that is
//! killed leaves nothing unlisted, and last with the new ones. What is not in the list is somebody else's, and is never replaced
//! or removed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::bundle::{Bundle, FolderError, is_inside};
use super::regular;
use super::visible::excerpt;

/// Name of the list in its folder.
pub const LIST: &str = "written.toml";

/// Largest list read [bytes]: a hundred thousand files.
const MOST: u64 = 16 << 20;

/// Most characters shown of where plans differ.
const SHOWN: usize = 100;

/// The message to who opens it.
const HEAD: &str =
    "# What stickslip wrote here. It replaces and removes these files, and no others.\n";

/// The facts that decide the results in a folder, by name: the command, cases, methods, options. Empty: files of several plans,
/// told apart by their names.
pub type Plan = BTreeMap<String, String>;

/// The first thing in which plans differ.
pub const COMMAND: &str = "command";

/// The plan of a command without options.
pub fn plan(command: &str) -> Plan {
    Plan::from([(COMMAND.to_owned(), command.to_owned())])
}

/// The list.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Written {
    plan: Plan,
    /// Paths relative to the folder.
    files: BTreeSet<String>,
    /// The same of files of no plan.
    #[serde(default)]
    beside: BTreeSet<String>,
}

impl Written {
    /// The list of a folder; an empty one where there is none.
    fn read(dir: &Path) -> Result<Self, FolderError> {
        let path = dir.join(LIST);
        let text = match regular::read_text(&path, MOST) {
            Ok(text) => text,
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Self::default()),
            Err(e) => return Err(FolderError::io("read file", &path, e)),
        };
        // A list is believed in what may be removed: never what lies elsewhere.
        let list = toml::from_str::<Self>(&text).ok();
        let list = list.filter(|own| {
            own.files
                .iter()
                .chain(&own.beside)
                .all(|own| is_inside(own))
        });
        let why = "it is no list of this program";
        list.ok_or(FolderError::InTheWay { path, why })
    }

    fn holds(&self, path: &str) -> bool {
        self.files.contains(path) || self.beside.contains(path)
    }

    /// Whether the results of a plan may take the place of those listed.
    fn allow(&self, plan: &Plan, dir: &Path) -> Result<(), FolderError> {
        let first = [COMMAND.to_owned()];
        let mut names = first.iter().chain(self.plan.keys()).chain(plan.keys());
        let other = names.find(|name| self.plan.get(*name) != plan.get(*name));
        let Some(what) = other.filter(|_| !self.plan.is_empty()) else {
            return Ok(());
        };
        let value = |of: &Plan| {
            of.get(what)
                .map_or(String::new(), |own| excerpt(own, SHOWN))
        };
        Err(FolderError::OtherPlan {
            path: dir.to_path_buf(),
            there: value(&self.plan),
            here: value(plan),
            what: what.clone(),
        })
    }
}

/// A folder that was found fit for results.
#[must_use]
#[derive(Debug)]
pub struct Claim {
    dir: PathBuf,
    /// Empty: files are added to those of any plan.
    plan: Plan,
    /// Folders that were made for it, outer ones first.
    made: Vec<PathBuf>,
}

impl Claim {
    /// Makes the folder if need be and proves that files can be written there, before any computing. Folders that stay empty go
    /// with the claim. Files of an empty plan stand beside those of any other.
    ///
    /// # Errors
    /// [`FolderError::Io`] naming the path; [`FolderError::OtherPlan`] without `force` where the folder holds other results.
    pub fn new(dir: &Path, plan: Plan, force: bool) -> Result<Self, FolderError> {
        let missing = dir.ancestors().take_while(|path| !path.exists());
        let mut made: Vec<PathBuf> = missing.map(Path::to_path_buf).collect();
        // The parent of a lone name is nothing, which is the folder we are in.
        made.retain(|path| !path.as_os_str().is_empty());
        made.reverse();
        let dir = dir.to_path_buf();
        let claim = Self { dir, plan, made };
        create_dir(&claim.dir)?;
        let probe = claim.partial("probe");
        fs::write(&probe, b"probe")
            .and_then(|()| fs::remove_file(&probe))
            .map_err(|e| FolderError::io("write file", &probe, e))?;
        let written = Written::read(&claim.dir)?;
        if !claim.plan.is_empty() && !force {
            written.allow(&claim.plan, &claim.dir)?;
        }
        Ok(claim)
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Finds out before any computing whether files of these names can be written; any name stands for those of a sub-folder.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`].
    pub fn expect<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Result<(), FolderError> {
        let written = Written::read(&self.dir)?;
        names
            .into_iter()
            .try_for_each(|path| self.free(path, &written))
    }

    /// Lists the plan before there are files of it, for results that are kept one by one; those of another plan go.
    ///
    /// # Errors
    /// Those of [`Claim::commit`].
    pub fn mark(&self) -> Result<(), FolderError> {
        if Written::read(&self.dir)?.plan == self.plan {
            Ok(())
        } else {
            self.commit(&Bundle::new())
        }
    }

    /// Writes all files of a bundle. Listed files of an earlier run that are not in the bundle go, unless the plan is empty;
    /// whatever is not listed stays as it is.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`], before anything is written, and [`FolderError::Io`], naming the path.
    pub fn commit(&self, bundle: &Bundle) -> Result<(), FolderError> {
        let before = Written::read(&self.dir)?;
        bundle
            .paths()
            .try_for_each(|path| self.free(path, &before))?;
        let names: BTreeSet<String> = bundle.paths().map(str::to_owned).collect();
        let mut after = before.clone();
        if self.plan.is_empty() {
            after.files.retain(|path| !names.contains(path));
            after.beside.extend(names);
        } else {
            after.beside.retain(|path| !names.contains(path));
            (after.plan, after.files) = (self.plan.clone(), names);
        }
        let mut both = after.clone();
        both.files.extend(before.files.iter().cloned());
        self.list(&both)?;
        for (path, contents) in bundle.files() {
            self.write(path, contents)?;
        }
        for path in before.files.iter().filter(|path| !after.holds(path)) {
            let path = self.dir.join(path);
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
        self.list(&after)
    }

    fn list(&self, written: &Written) -> Result<(), FolderError> {
        let list = HEAD.to_owned() + &toml::to_string(written).unwrap_or_default();
        self.write(LIST, list.as_bytes())
    }

    /// That nothing stands at a place, or a file of this program.
    fn free(&self, path: &str, written: &Written) -> Result<(), FolderError> {
        let place = self.dir.join(path);
        let parents = place
            .ancestors()
            .skip(1)
            .take_while(|own| own.starts_with(&self.dir));
        if let Some(file) = parents
            .into_iter()
            .find(|own| own.exists() && !own.is_dir())
        {
            let why = "a file stands where a folder goes";
            return Err(FolderError::InTheWay {
                path: file.to_path_buf(),
                why,
            });
        }
        let why = match fs::symlink_metadata(&place) {
            Err(_) => return Ok(()),
            Ok(own) if own.is_dir() => "a folder stands where a file goes",
            Ok(_) if written.holds(path) => return Ok(()),
            Ok(_) => "it was not written by this program",
        };
        Err(FolderError::InTheWay { path: place, why })
    }

    /// Name of a file that is not whole yet.
    fn partial(&self, path: &str) -> PathBuf {
        self.dir
            .join(format!("{path}.partial-{}", std::process::id()))
    }

    fn write(&self, path: &str, contents: &[u8]) -> Result<(), FolderError> {
        let (place, partial) = (self.dir.join(path), self.partial(path));
        place.parent().map_or(Ok(()), create_dir)?;
        fs::write(&partial, contents)
            .and_then(|()| fs::rename(&partial, &place))
            .map_err(|e| {
                // The user is told why it could not be written.
                let _ = fs::remove_file(&partial);
                FolderError::io("write file", &place, e)
            })
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // Only empty folders can be removed so.
        let removed = self.made.iter().rev().map(fs::remove_dir);
        let _ = removed.collect::<Result<(), _>>();
    }
}

fn create_dir(dir: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(dir).map_err(|e| FolderError::io("create folder", dir, e))
}
