//! Collections: folders of problem files, by family.
//!
//! ```text
//!   collection/spheres/packing-1.hdf5     problem `spheres.packing-1`, family `spheres`
//!   collection/Capsules-i1.hdf5           problem `Capsules-i1`, family `Capsules`
//! ```

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::problem_file::{Size, file_name};
use crate::run::verdict::Verdict;

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
        /// What is wrong.
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

/// What is found below a folder.
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
                    // What ends a family elsewhere is a part of the name of a folder.
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

/// A problem of a collection: a row of its table.
#[derive(Debug, Clone, PartialEq)]
pub struct ProblemRow {
    /// Name.
    pub problem: String,
    /// What it is, or why no method is asked to solve it.
    pub found: Result<Size, String>,
}

/// What a method made of the problems of a family.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilyRow {
    /// Family.
    pub family: String,
    /// Violation asked for.
    pub accuracy: String,
    /// Method.
    pub method: String,
    /// Problems that it was given.
    pub problems: usize,
    /// Of these, solved or approximate as claimed.
    pub honest: usize,
    /// Of these, refused.
    pub refused: usize,
    /// Median of the iterations where it did what it claims; not-a-number without any.
    pub iterations: f64,
    /// Most of them.
    pub most: usize,
}

/// One run, as far as a family is concerned.
pub struct FamilyRun<'a> {
    /// Problem.
    pub problem: &'a str,
    /// Violation asked for.
    pub accuracy: String,
    /// Method.
    pub method: &'a str,
    /// What came of it.
    pub verdict: &'a Verdict,
    /// Iterations.
    pub iterations: usize,
}

/// Runs by family, accuracy and method, in the order in which they first come.
pub fn by_family<'a>(runs: impl Iterator<Item = FamilyRun<'a>>) -> Vec<FamilyRow> {
    let mut rows: Vec<(FamilyRow, Vec<usize>)> = Vec::new();
    for run in runs {
        let name = (family(run.problem), run.accuracy.as_str(), run.method);
        let own = |(row, _): &(FamilyRow, Vec<usize>)| {
            (
                row.family.as_str(),
                row.accuracy.as_str(),
                row.method.as_str(),
            ) == name
        };
        let place = rows.iter().position(own).unwrap_or(rows.len());
        if place == rows.len() {
            let row = FamilyRow {
                family: name.0.to_owned(),
                accuracy: name.1.to_owned(),
                method: name.2.to_owned(),
                problems: 0,
                honest: 0,
                refused: 0,
                iterations: f64::NAN,
                most: 0,
            };
            rows.push((row, Vec::new()));
        }
        let (row, iterations) = &mut rows[place];
        row.problems += 1;
        row.refused += usize::from(matches!(run.verdict, Verdict::Refused(_)));
        if run.verdict.is_honest() {
            row.honest += 1;
            row.most = row.most.max(run.iterations);
            iterations.push(run.iterations);
        }
    }
    let finished = |(mut row, mut iterations): (FamilyRow, Vec<usize>)| {
        iterations.sort_unstable();
        let count = iterations.len();
        let at = |k: usize| iterations.get(k).map_or(f64::NAN, |&k| k as f64);
        row.iterations = 0.5 * (at(count.saturating_sub(1) / 2) + at(count / 2));
        row
    };
    rows.into_iter().map(finished).collect()
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

    #[test]
    fn medians_are_those_of_what_holds() {
        let gave_up = Verdict::GaveUp(stickslip_methods::Status::Stalled);
        let run = |problem, verdict, iterations| FamilyRun {
            problem,
            accuracy: "high".into(),
            method: "nsgs",
            verdict,
            iterations,
        };
        let runs = [
            run("a-1", &Verdict::Solved, 4),
            run("b-1", &gave_up, 9),
            run("a-2", &gave_up, 100),
            run("a-3", &Verdict::Solved, 7),
        ];
        let rows = by_family(runs.into_iter());
        let found: Vec<_> = (rows.iter())
            .map(|r| (&*r.family, r.problems, r.honest, r.most, r.iterations))
            .collect();
        assert_eq!(found[0], ("a", 3, 2, 7, 5.5));
        assert_eq!((found[1].1, found[1].2, found[1].4.is_nan()), (1, 0, true));
    }
}
