//! The sections of a page, one file each, in the order of the page. A part that finds nothing of its own is left out.
//!
//! To add one: a file with `pub fn section(folder, budget) -> Result<Option<Section>, PageError>`, and a line in [`PARTS`].

mod accuracy;
mod cases;
mod expected;
mod files;
mod methods;
mod paper;
mod peers;
mod robustness;
mod runs;
mod spaces;
mod summary;

use super::{Block, Budget, Folder, Grid, Kind, PageError, Section, Show};

/// Reads what it knows in the folder; nothing where there is nothing.
pub type Part = fn(&Folder, &mut Budget) -> Result<Option<Section>, PageError>;

/// All parts in the order of the page, which is also the order in which figures get room.
pub const PARTS: [Part; 11] = [
    summary::section,
    paper::section,
    methods::section,
    runs::section,
    expected::section,
    accuracy::section,
    spaces::section,
    robustness::section,
    peers::section,
    cases::section,
    files::section,
];

/// A section of these blocks; nothing without any.
fn made(id: &str, title: &str, lead: &str, blocks: Vec<Block>) -> Option<Section> {
    (!blocks.is_empty()).then(|| Section {
        id: id.into(),
        title: title.into(),
        lead: lead.into(),
        blocks,
    })
}

/// A title, with the folder where it is not the page's own.
fn titled(title: &str, path: &str) -> String {
    match super::folder::split(path).0 {
        "" => title.to_owned(),
        folder => format!("{title} ({folder})"),
    }
}

/// Every table of this file name, as it is.
fn tables(
    folder: &Folder,
    name: &str,
    title: &str,
    shows: &[Show],
) -> Result<Vec<Block>, PageError> {
    let paths = folder.named(name).into_iter();
    paths
        .map(|path| Ok(Block::Table(folder.grid(path, title, shows)?)))
        .collect()
}

/// Figures whose path without folders satisfies `wanted`, as one folded group.
fn figures(
    folder: &Folder,
    budget: &mut Budget,
    title: &str,
    wanted: impl Fn(&str) -> bool,
) -> Result<Vec<Block>, PageError> {
    let paths = folder.of_kind("svg");
    let paths = paths.filter(|path| wanted(super::folder::split(path).1));
    let group = folder.figures(title, paths, budget)?;
    Ok(group.map(Block::Figures).into_iter().collect())
}

/// Sets the columns of a table that is gathered here.
fn columns(grid: &mut Grid, columns: &[(&str, &str, Kind)]) {
    grid.columns = columns
        .iter()
        .map(|(heading, unit, kind)| super::Column {
            heading: (*heading).into(),
            unit: (*unit).into(),
            kind: *kind,
        })
        .collect();
}

/// Largest number; NaN of nothing and of NaN only.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NAN, f64::max)
}
