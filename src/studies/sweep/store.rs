//! A folder of records: one file per cell, and the list of the cells there are to be.
//!
//! ```text
//!   DIR/sweep.json          what is to be measured: title, repeats, ids of all cells in order
//!   DIR/cells/<id>.json     one record; written under another name and renamed, so that it is whole or absent
//! ```
//! The second line of both is a digest of all other lines: what a disk or a hand has changed is refused, not believed.
//! Several processes may fill one folder, as long as they measure different cells.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::cell::{digest, is_id};
use super::measure::Repeats;
use super::record::{Origin, Record, SCHEMA};
use crate::case::error::clip;
use crate::files::bundle::FolderError;
use crate::files::claim::write_whole;
use crate::files::regular;
use crate::files::visible::{is_label, is_visible};

/// Largest file read [bytes]: a list of a hundred thousand ids has a tenth of it.
const MAX_BYTES: u64 = 64 << 20;

/// What a folder of records is to hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contents {
    /// Version of the format, [`SCHEMA`].
    pub schema: u32,
    /// Title of the sweep.
    pub title: String,
    /// How often cells are repeated for their times.
    pub repeats: Repeats,
    /// Ids of all cells, sorted.
    pub cells: Vec<String>,
}

/// Name of the list of cells.
const SWEEP: &str = "sweep.json";

/// Folder of the records.
pub const CELLS: &str = "cells";

/// Name of a record.
fn name(id: &str) -> String {
    format!("{CELLS}/{id}.json")
}

/// A folder of records.
#[derive(Debug)]
pub struct Store {
    dir: PathBuf,
    contents: Contents,
}

/// Why a folder of records cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file system refused.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A file that is not what its name says.
    #[error("`{}`: {what}", path.display())]
    Broken {
        /// Which file.
        path: PathBuf,
        /// What is wrong, with line and column.
        what: String,
    },
    /// A text that would command a terminal or a spreadsheet, or leave the folder.
    #[error("`{}`: `{found}` is no {what}", path.display())]
    Content {
        /// Which file.
        path: PathBuf,
        /// The text.
        found: String,
        /// What it should be.
        what: &'static str,
    },
    /// A file whose text is not the one that was written.
    #[error(
        "`{}`, line {SEAL}: `{expected}` where the other lines ask for `{found}`: the file was changed after it was written; remove it",
        path.display()
    )]
    Changed {
        /// Which file.
        path: PathBuf,
        /// The line.
        expected: String,
        /// What it should be.
        found: String,
    },
    /// A file under the name of another cell.
    #[error("`{}` holds the record of another cell, `{found}`", path.display())]
    Misnamed {
        /// Which file.
        path: PathBuf,
        /// The id inside.
        found: String,
    },
    /// A folder without `sweep.json`.
    #[error("`{}` holds no sweep: there is no sweep.json in it", dir.display())]
    NoSweep {
        /// The folder.
        dir: PathBuf,
    },
    /// Another sweep has its records there.
    #[error(
        "`{}` holds another sweep, `{title}`: {missing} of its {total} cells are not in this one, {new} of this one are not in it; choose another folder, or --force",
        dir.display()
    )]
    OtherSweep {
        /// The folder.
        dir: PathBuf,
        /// Title of the sweep in it.
        title: String,
        /// Cells only in the folder.
        missing: usize,
        /// Cells in the folder.
        total: usize,
        /// Cells only in the sweep asked for.
        new: usize,
    },
    /// Records of another version of the format.
    #[error("`{}` has schema {found}, this program writes {SCHEMA}", path.display())]
    Schema {
        /// Which file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// Records of another program or machine.
    #[error(
        "`{}` was made by another program or machine ({what}: `{there}`, here `{here}`); {remedy}",
        path.display()
    )]
    Origin {
        /// Which record.
        path: PathBuf,
        /// What differs.
        what: &'static str,
        /// There.
        there: String,
        /// Here.
        here: String,
        /// What can be done.
        remedy: &'static str,
    },
    /// Two records of one cell that differ.
    #[error(
        "cell `{id}` has other numbers in `{}` than in `{}`, though both name the same program",
        first.display(), second.display()
    )]
    Contradiction {
        /// The cell.
        id: String,
        /// One folder.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
}

impl Store {
    /// A folder of records that is not looked at yet.
    pub(super) fn at(dir: &Path, contents: Contents) -> Self {
        let dir = dir.to_path_buf();
        Self { dir, contents }
    }

    /// Opens a folder for a sweep, and makes it if need be. With `force` the sweep takes the place of another one, whose
    /// records stay: cells of both are not measured again.
    ///
    /// # Errors
    /// A folder that cannot be written, or that holds another sweep.
    pub fn create(dir: &Path, contents: Contents, force: bool) -> Result<Self, StoreError> {
        let store = Self::at(dir, contents);
        match Self::open(dir) {
            Ok(found) if found.contents == store.contents => {}
            Ok(found) if !force => return Err(store.other(&found)),
            Ok(_) | Err(StoreError::NoSweep { .. }) => {
                store.write(SWEEP, &store.contents)?;
            }
            Err(error) => return Err(error),
        }
        Ok(store)
    }

    /// Opens a folder that holds a sweep.
    ///
    /// # Errors
    /// A folder without a sweep, or with one of another schema.
    pub fn open(dir: &Path) -> Result<Self, StoreError> {
        let dir = dir.to_path_buf();
        let path = dir.join(SWEEP);
        let Some(contents) = read::<Contents>(&path)? else {
            return Err(StoreError::NoSweep { dir });
        };
        if !is_label(&contents.title) {
            return Err(content(path, &contents.title, "title of a sweep"));
        }
        if let Some(id) = contents.cells.iter().find(|id| !is_id(id)) {
            return Err(content(path, id, "id of a cell"));
        }
        Ok(Self { dir, contents })
    }

    /// What the folder is to hold.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The record of a cell; none if it was not measured to the end.
    ///
    /// # Errors
    /// A file that is no record, or that of another cell.
    pub fn get(&self, id: &str) -> Result<Option<Record>, StoreError> {
        let path = self.path(id);
        let Some(record) = read::<Record>(&path)? else {
            return Ok(None);
        };
        if record.id != id || record.cell.id() != id {
            return Err(StoreError::Misnamed {
                path,
                found: clip(&record.id),
            });
        }
        Ok(Some(record))
    }

    /// Keeps a record, in place of one that was there.
    ///
    /// # Errors
    /// The file system; then no half-written record remains.
    pub fn put(&self, record: &Record) -> Result<(), StoreError> {
        self.write(&name(&record.id), record)
    }

    /// All records there are, in the order of the sweep.
    ///
    /// # Errors
    /// Those of [`Store::get`].
    pub fn records(&self) -> Result<Vec<Record>, StoreError> {
        let ids = self.contents.cells.iter();
        let records = ids.map(|id| self.get(id)).collect::<Result<Vec<_>, _>>()?;
        Ok(records.into_iter().flatten().collect())
    }

    /// Whether a record was made by this program on this machine.
    ///
    /// # Errors
    /// [`StoreError::Origin`], with what can be done.
    pub fn check_origin(
        &self,
        record: &Record,
        origin: &Origin,
        remedy: &'static str,
    ) -> Result<(), StoreError> {
        match record.origin.difference(origin) {
            None => Ok(()),
            Some((what, there, here)) => Err(StoreError::Origin {
                path: self.path(&record.id),
                what,
                there: clip(&there),
                here,
                remedy,
            }),
        }
    }

    fn path(&self, id: &str) -> PathBuf {
        self.dir.join(name(id))
    }

    /// Writes a file of the folder.
    fn write<T: Serialize>(&self, name: &str, value: &T) -> Result<(), StoreError> {
        let json = serde_json::to_string_pretty(value);
        let mut json = json.map_err(|e| broken(&self.dir.join(name), e))?;
        json.push('\n');
        Ok(write_whole(&self.dir, name, sealed(&json).as_bytes())?)
    }

    /// That another folder, or this one before, holds another sweep.
    pub(super) fn other(&self, found: &Store) -> StoreError {
        let dir = found.dir.clone();
        let found = &found.contents;
        let only = |a: &Contents, b: &Contents| {
            let known: BTreeSet<&String> = b.cells.iter().collect();
            a.cells.iter().filter(|id| !known.contains(id)).count()
        };
        StoreError::OtherSweep {
            dir,
            title: clip(&found.title),
            missing: only(found, &self.contents),
            total: found.cells.len(),
            new: only(&self.contents, found),
        }
    }
}

/// A file of this schema, if it is there; the version is looked at first, so that a newer format is not called broken.
fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<Option<T>, StoreError> {
    #[derive(Deserialize)]
    struct Version {
        schema: u32,
    }
    let text = match regular::read_text(path, MAX_BYTES) {
        Ok(text) => text,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(FolderError::io("read", path, e).into()),
    };
    if let Some(line) = text.lines().find(|line| !is_plain(line)) {
        return Err(content(path.to_path_buf(), line, "visible text"));
    }
    let Version { schema } = serde_json::from_str(&text).map_err(|e| broken(path, e))?;
    if schema != SCHEMA {
        return Err(StoreError::Schema {
            path: path.to_path_buf(),
            found: schema,
        });
    }
    let (seal, others) = unseal(&text);
    let found = seal_of(&others);
    if seal != found {
        return Err(StoreError::Changed {
            path: path.to_path_buf(),
            expected: clip(seal.trim()),
            found: found.trim().to_owned(),
        });
    }
    serde_json::from_str(&text).map_err(|e| broken(path, e))
}

/// Whether a line of JSON holds no control character, neither as it stands nor escaped: texts end up on terminals, in tables
/// and in figures.
fn is_plain(line: &str) -> bool {
    let rest = line.replace(r"\\", "").replace("\\\"", "");
    !rest.contains('\\') && line.chars().all(is_visible)
}

/// The line of the seal, from 1.
const SEAL: usize = 2;

/// JSON of an object, one entry per line, with the seal under which it is read back; one that it has is replaced.
pub fn sealed(json: &str) -> String {
    let (_, others) = unseal(json);
    let first = others.find('\n').map_or(others.len(), |end| end + 1);
    let (open, rest) = others.split_at(first);
    format!("{open}{}{rest}", seal_of(&others))
}

/// The line that names the digest of all others.
fn seal_of(others: &str) -> String {
    format!("{SEAL_KEY}\"{}\",\n", digest(others))
}

/// How that line begins.
const SEAL_KEY: &str = "  \"digest\": ";

/// The seal, if there is one, and all other lines.
fn unseal(text: &str) -> (&str, String) {
    let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
    let seal = match lines.get(SEAL - 1) {
        Some(line) if line.starts_with(SEAL_KEY) => lines.remove(SEAL - 1),
        _ => "",
    };
    (seal, lines.concat())
}

fn broken(path: &Path, source: serde_json::Error) -> StoreError {
    let whole = source.to_string();
    let shown = clip(&whole);
    // What was cut off ends with the place.
    let what = match shown.ends_with('…') {
        true => format!(
            "{shown} at line {} column {}",
            source.line(),
            source.column()
        ),
        false => shown,
    };
    StoreError::Broken {
        path: path.to_path_buf(),
        what,
    }
}

fn content(path: PathBuf, found: &str, what: &'static str) -> StoreError {
    StoreError::Content {
        path,
        found: clip(found),
        what,
    }
}
