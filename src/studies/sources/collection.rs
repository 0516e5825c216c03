//! Collections: folders of problem files, by family.
//!
//! ```text
//!   collection/spheres/packing-1.hdf5     problem `spheres.packing-1`, family `spheres`
//!   collection/Capsules-i1.hdf5           problem `Capsules-i1`, family `Capsules`
//! ```

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::studies::exchange::problem_file::file_name;

/// Endings of problem files.
const ENDINGS: [&str; 2] = ["hdf5", "h5"];

/// Largest number of files of a collection.
const MAX_FILES: usize = 10_000;

/// Largest number of files and folders looked at for them.
const MAX_LOOKED_AT: usize = 100_000;

/// Deepest nesting of folders.
const MAX_DEPTH: usize = 8;

/// A problem file with its name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// Name of the problem.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// Whether it was found in a folder, not named.
    pub found: bool,
}

/// Why a collection cannot be listed.
#[derive(Debug, thiserror::Error)]
pub enum CollectionError {
    /// The file system refused.
    #[error("cannot read `{}`: {source}", path.display())]
    Io {
        /// Which folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Nothing, or too much, is there.
    #[error("`{}`: {what}", path.display())]
    Contents {
        /// Which folder.
        path: PathBuf,
        /// The fault, in words.
        what: String,
    },
}

/// Files as named, and all problem files in the folders named and below, by name.
///
/// # Errors
/// A folder that cannot be read, holds no such file, or too many.
pub fn entries(named: &[PathBuf]) -> Result<Vec<Entry>, CollectionError> {
    let mut all = Vec::new();
    for path in named {
        if !path.is_dir() {
            all.push(Entry {
                name: file_name(path),
                path: path.clone(),
                found: false,
            });
            continue;
        }
        let unfit = |what: String| CollectionError::Contents {
            path: path.clone(),
            what,
        };
        let mut walk = Walk::default();
        walk.add(path, "", 0)?;
        let found = &mut walk.found;
        if found.len() > MAX_FILES {
            return Err(unfit(format!("more than {MAX_FILES} problem files")));
        }
        if walk.looked_at > MAX_LOOKED_AT {
            let what = format!("more than {MAX_LOOKED_AT} files and folders in it and below");
            return Err(unfit(what));
        }
        if found.is_empty() {
            return Err(unfit("no file.hdf5 or file.h5 in it or below".into()));
        }
        found.sort();
        all.append(found);
    }
    Ok(all)
}

/// Files below a folder.
#[derive(Default)]
struct Walk {
    found: Vec<Entry>,
    looked_at: usize,
}

impl Walk {
    /// Adds the files of a folder, under names that begin with `prefix`, and of the folders in it. Hidden ones are left out,
    /// and folders that are links. Ends early where there are too many.
    fn add(&mut self, dir: &Path, prefix: &str, depth: usize) -> Result<(), CollectionError> {
        let unreadable = |source| CollectionError::Io {
            path: dir.into(),
            source,
        };
        for item in fs::read_dir(dir).map_err(unreadable)? {
            self.looked_at += 1;
            if self.looked_at > MAX_LOOKED_AT || self.found.len() > MAX_FILES {
                break;
            }
            let item = item.map_err(unreadable)?;
            if item.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            let path = item.path();
            let own = file_name(&path);
            let ending = path.extension().and_then(|end| end.to_str());
            if item.file_type().map_err(unreadable)?.is_dir() {
                if depth < MAX_DEPTH {
                    // A sign that ends a family elsewhere is a part of the name of a folder.
                    let folder = own.replace(['-', '.'], "_");
                    self.add(&path, &format!("{prefix}{folder}."), depth + 1)?;
                }
            } else if ending.is_some_and(|end| ENDINGS.contains(&end)) && path.is_file() {
                self.found.push(Entry {
                    name: format!("{prefix}{own}"),
                    path,
                    found: true,
                });
            }
        }
        Ok(())
    }
}

/// The family of a problem, by its name: the folder below the collection, otherwise what precedes the first `-` or `.`.
pub fn family(problem: &str) -> &str {
    let end = problem.find(['-', '.']).filter(|&end| end > 0);
    &problem[..end.unwrap_or(problem.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_folders_or_prefixes() {
        for (name, expected) in [
            ("spheres.packing-1", "spheres"),
            ("Capsules-i122-1617", "Capsules"),
            ("plate_mesh1.22x22.local", "plate_mesh1"),
            ("alone", "alone"),
            ("-odd", "-odd"),
        ] {
            assert_eq!(family(name), expected);
        }
    }

    #[test]
    fn a_folder_is_walked_by_name_and_hidden_files_are_left_out() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str| {
            let path = dir.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"").unwrap();
        };
        for name in ["b.hdf5", "a-x.h5", "c.txt", ".d.hdf5", "low-mu.2/e.f.hdf5"] {
            write(name);
        }
        let found = entries(&[dir.path().into(), "z/named.hdf5".into()]).unwrap();
        let names: Vec<(&str, bool)> = found.iter().map(|e| (&*e.name, e.found)).collect();
        let expected = [
            ("a-x", true),
            ("b", true),
            ("low_mu_2.e.f", true),
            ("named", false),
        ];
        assert_eq!(names, expected);
        let empty = tempfile::tempdir().unwrap();
        let error = entries(&[empty.path().into()]).unwrap_err().to_string();
        assert!(error.contains("no file.hdf5"), "{error}");
    }
}
