//! `index.html`: one page that shows a report folder and needs nothing else: styles, script and figures are inside.
//!
//! ```text
//! folder on disk -> Folder -> tables and figures by chapter of the catalogues -> html -> index.html
//! ```
//!
//! A chapter without files is left out, so one page fits the report of the main job, the results of a single run and the
//! folders of the studies. Columns, headings and digits are those of the [`catalogue`]; numbers are
//! read from the CSV files. The same folder gives the same bytes.

mod error;
mod folder;
mod html;
mod overview;
mod sheet;

use std::path::Path;

pub use error::PageError;
pub use folder::{Budget, Folder};
pub use sheet::Sheet;

use super::figures;
use super::table::Description;
use super::tables::{Chapter, catalogue};
use super::{Bundle, Claim, Plan};
use folder::Link;
use html::{Block, Grid, Section};

/// Name of the page in its folder.
pub const FILE: &str = "index.html";

/// Most bytes of figures inside the page, before they are encoded; what comes later is linked.
const FIGURE_BYTES: usize = 400_000;

/// Longest table inside the page; longer ones are linked.
const ROWS: usize = 250;

/// The page of a folder.
///
/// # Errors
/// [`PageError`] naming file and line where something cannot be read; [`PageError::Empty`] where there is nothing to show.
pub fn of_folder(dir: &Path) -> Result<String, PageError> {
    let page = page(&Folder::open(dir)?)?;
    page.ok_or_else(|| PageError::Empty {
        folder: dir.to_path_buf(),
    })
}

/// None where there is nothing to show.
fn page(folder: &Folder<'_>) -> Result<Option<String>, PageError> {
    let mut budget = Budget::new(FIGURE_BYTES);
    let mut sections: Vec<Section> = overview::section(folder, &mut budget)?
        .into_iter()
        .collect();
    let tables = catalogue();
    for chapter in Chapter::ALL {
        let own = tables.iter().filter(|(of, _)| *of == chapter);
        let own = own.map(|(_, table)| table);
        sections.extend(section(chapter, own, folder, &mut budget)?);
    }
    if sections.is_empty() {
        return Ok(None);
    }
    Ok(Some(html::compose(&sections, &folder.origins()?)))
}

/// Figures, then tables; nothing without any.
fn section<'a>(
    chapter: Chapter,
    tables: impl Iterator<Item = &'a Description>,
    folder: &Folder,
    budget: &mut Budget,
) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for (_, kind) in figures::CATALOGUE.iter().filter(|(own, _)| *own == chapter) {
        blocks.extend(folder.figures(kind, budget)?.map(Block::Figures));
    }
    let mut links = Vec::new();
    for table in tables {
        for path in folder.named(&table.file()) {
            let sheet = folder.sheet(path)?;
            let (rows, columns) = sheet.size();
            match rows {
                0 => {}
                1..=ROWS => blocks.push(Block::Table(Grid::of(table, &sheet, folder, path)?)),
                _ => links.push(Link {
                    text: path.to_owned(),
                    path: path.to_owned(),
                    note: format!("{} {rows} rows, {columns} columns", table.question),
                }),
            }
        }
    }
    if !links.is_empty() {
        blocks.push(Block::Links(links));
    }
    Ok((!blocks.is_empty()).then(|| Section {
        id: chapter.id(),
        title: chapter.title(),
        lead: chapter.lead(),
        blocks,
    }))
}

/// Adds to a bundle the page that shows it.
///
/// # Errors
/// [`PageError`] naming the file that cannot be shown.
pub fn add(bundle: &mut Bundle) -> Result<(), PageError> {
    if let Some(page) = page(&Folder::of(bundle))? {
        bundle.add(FILE, page)?;
    }
    Ok(())
}

/// Writes `index.html` into the folder it shows; size in bytes.
///
/// # Errors
/// Those of [`of_folder`] and [`Claim::commit`].
pub fn write(dir: &Path) -> Result<usize, PageError> {
    let claim = Claim::new(dir, Plan::new(), false)?;
    let page = of_folder(dir)?;
    let size = page.len();
    let mut bundle = Bundle::new();
    bundle.add(FILE, page)?;
    claim.commit(&bundle)?;
    Ok(size)
}
