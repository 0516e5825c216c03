//! The folder a page is made from: which files there are, and what is in them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::{Drawing, Figure, Figures, Grid, Link, Origin, PageError, Sheet, Show};
use crate::files::bundle::FolderError;

/// Folders inside folders that are looked into: `accuracy/figures`, one more for what users arrange.
const DEPTH: usize = 3;

/// Kinds of files that a page knows.
const KINDS: [&str; 5] = ["csv", "md", "tex", "svg", "toml"];

/// Folders that are left out: fields for ParaView are many, large and not for reading.
const SKIPPED: [&str; 1] = ["fields"];

/// Largest figure inside the page, in bytes.
const LARGEST: usize = 200_000;

/// A report folder.
#[derive(Debug)]
pub struct Folder {
    root: PathBuf,
    /// Paths relative to the root, `/` between folders.
    files: BTreeSet<String>,
}

/// Bytes of figures that the page still takes.
#[derive(Debug)]
pub struct Budget {
    left: usize,
}

impl Budget {
    /// So many bytes.
    pub fn new(bytes: usize) -> Self {
        Self { left: bytes }
    }
}

impl Folder {
    /// Looks into a folder and those below it.
    ///
    /// # Errors
    /// [`FolderError::Io`] where one cannot be listed.
    pub fn open(root: &Path) -> Result<Self, PageError> {
        let mut files = BTreeSet::new();
        list(root, "", DEPTH, &mut files)?;
        Ok(Self {
            root: root.to_path_buf(),
            files,
        })
    }

    /// Whether there is a file of this path.
    pub fn has(&self, path: &str) -> bool {
        self.files.contains(path)
    }

    /// Paths whose last part is `name`, those nearer to the top first.
    pub fn named(&self, name: &str) -> Vec<&str> {
        let mut found: Vec<&str> = self
            .files
            .iter()
            .map(String::as_str)
            .filter(|path| split(path).1 == name)
            .collect();
        found.sort_by_key(|path| (path.matches('/').count(), *path));
        found
    }

    /// Paths that end in `.kind`, sorted.
    pub fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a str> {
        let files = self.files.iter().map(String::as_str);
        files.filter(move |path| path.rsplit_once('.').is_some_and(|(_, own)| own == kind))
    }

    fn bytes(&self, path: &str) -> Result<Vec<u8>, PageError> {
        let full = self.root.join(path);
        fs::read(&full).map_err(|e| FolderError::io("read file", &full, e).into())
    }

    fn text(&self, path: &str) -> Result<String, PageError> {
        String::from_utf8(self.bytes(path)?).map_err(|_| self.content(path, "is no UTF-8 text"))
    }

    fn content(&self, path: &str, reason: impl Into<String>) -> PageError {
        PageError::Content {
            file: self.root.join(path),
            reason: reason.into(),
        }
    }

    /// A table.
    ///
    /// # Errors
    /// Those of [`Sheet::read`].
    pub fn sheet(&self, path: &str) -> Result<Sheet, PageError> {
        Sheet::read(&self.root.join(path), &self.bytes(path)?)
    }

    /// A table to be shown as it is, with links to its files.
    ///
    /// # Errors
    /// Those of [`Sheet::read`] and [`Sheet::shown`].
    pub fn grid(&self, path: &str, title: &str, shows: &[Show]) -> Result<Grid, PageError> {
        let (columns, rows) = self.sheet(path)?.shown(shows)?;
        Ok(Grid {
            columns,
            rows,
            ..self.empty_grid(path, title)
        })
    }

    /// A table without columns and rows yet, with its links and an anchor made from its path; the title tells the folder
    /// where several have such a table.
    pub fn empty_grid(&self, path: &str, title: &str) -> Grid {
        let stem = path.strip_suffix(".csv").unwrap_or(path);
        let (place, name) = split(path);
        let alone = place.is_empty() || self.named(name).len() == 1;
        Grid {
            id: anchor(stem),
            title: match alone {
                true => title.to_owned(),
                false => format!("{title} ({place})"),
            },
            links: self.forms(stem),
            ..Grid::default()
        }
    }

    /// Links to the forms of a table.
    pub fn forms(&self, stem: &str) -> Vec<Link> {
        [("CSV", "csv"), ("LaTeX", "tex"), ("Markdown", "md")]
            .into_iter()
            .map(|(text, kind)| Link::new(text, format!("{stem}.{kind}")))
            .filter(|link| self.has(&link.path))
            .collect()
    }

    /// A group of figures in the order of `paths`: inside the page while they are not too large and there is room, linked
    /// otherwise. `None` without any.
    ///
    /// # Errors
    /// [`PageError::Content`] at a file that is no drawing.
    pub fn figures<'a>(
        &self,
        title: impl Into<String>,
        paths: impl IntoIterator<Item = &'a str>,
        budget: &mut Budget,
    ) -> Result<Option<Figures>, PageError> {
        let mut group = Figures {
            title: title.into(),
            open: false,
            figures: Vec::new(),
            links: Vec::new(),
        };
        for path in paths {
            let name = split(path).1;
            let caption = name.strip_suffix(".svg").unwrap_or(name);
            let drawing = Drawing::read(&self.text(path)?).map_err(|e| self.content(path, e))?;
            if drawing.size() > LARGEST.min(budget.left) {
                group.links.push(Link::new(caption, path));
                continue;
            }
            budget.left -= drawing.size();
            group.figures.push(Figure {
                caption: caption.to_owned(),
                path: path.to_owned(),
                drawing,
            });
        }
        let any = !group.figures.is_empty() || !group.links.is_empty();
        Ok(any.then_some(group))
    }

    /// All `provenance.toml`, that of the page's own folder first.
    ///
    /// # Errors
    /// [`PageError::Content`] where one is no TOML.
    pub fn origins(&self) -> Result<Vec<Origin>, PageError> {
        let read = |path: &str| {
            let table: toml::Table = self
                .text(path)?
                .parse()
                .map_err(|e: toml::de::Error| self.content(path, e.to_string()))?;
            let mut entries = Vec::new();
            for (name, value) in &table {
                match value {
                    toml::Value::Table(options) => {
                        let option = |(key, value)| (format!("{name}: {key}"), plain(value));
                        entries.extend(options.iter().map(option));
                    }
                    other => entries.push((name.clone(), plain(other))),
                }
            }
            Ok(Origin {
                folder: split(path).0.to_owned(),
                entries,
            })
        };
        self.named("provenance.toml")
            .into_iter()
            .map(read)
            .collect()
    }
}

fn plain(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}

/// Folder and name of a path.
pub(super) fn split(path: &str) -> (&str, &str) {
    path.rsplit_once('/').unwrap_or(("", path))
}

/// An anchor from a path.
pub(super) fn anchor(path: &str) -> String {
    let clean = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    format!("table-{}", path.chars().map(clean).collect::<String>())
}

fn list(
    dir: &Path,
    below: &str,
    depth: usize,
    files: &mut BTreeSet<String>,
) -> Result<(), PageError> {
    let fail = |e| FolderError::io("list folder", dir, e);
    for entry in fs::read_dir(dir).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let kind = entry.file_type().map_err(fail)?;
        let Some(name) = entry.file_name().to_str().map(str::to_owned) else {
            continue;
        };
        let path = format!("{below}{name}");
        if kind.is_dir() {
            let hidden = name.starts_with('.') || SKIPPED.contains(&name.as_str());
            if depth > 0 && !hidden {
                list(&entry.path(), &format!("{path}/"), depth - 1, files)?;
            }
        } else if kind.is_file()
            && name
                .rsplit_once('.')
                .is_some_and(|(_, k)| KINDS.contains(&k))
        {
            files.insert(path);
        }
    }
    Ok(())
}
