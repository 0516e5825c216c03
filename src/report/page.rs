//! `index.html`: one page that shows a report folder and needs nothing else: styles, script and figures are inside.
//!
//! ```text
//! folder on disk -> Folder -> parts (one file each) -> Section … -> compose -> index.html
//! ```
//!
//! A part reads the CSV tables it knows and is left out where there are none, so one page fits the report of the main job,
//! the results of a single run and the folders of the studies. Numbers are those of the tables, with fewer digits; large
//! tables are linked with their size. The same folder gives the same bytes.

mod drawing;
mod error;
mod folder;
mod html;
mod parts;
mod section;
mod sheet;

use std::path::Path;

pub use drawing::Drawing;
pub use error::PageError;
pub use folder::{Budget, Folder};
pub use html::compose;
pub use section::{
    Block, Column, Fact, Figure, Figures, Grid, Kind, Link, Origin, Section, heading,
};
pub use sheet::{Sheet, Show};

use super::Bundle;

/// Name of the page in its folder.
pub const FILE: &str = "index.html";

/// Most bytes of figures inside the page; what comes later is linked. Tables add about a tenth.
const FIGURE_BYTES: usize = 4_000_000;

/// The page of a folder.
///
/// # Errors
/// [`PageError`] naming file and line where something cannot be read; [`PageError::Empty`] where there is nothing to show.
pub fn of_folder(dir: &Path) -> Result<String, PageError> {
    let folder = Folder::open(dir)?;
    let mut budget = Budget::new(FIGURE_BYTES);
    let mut sections = Vec::new();
    for part in parts::PARTS {
        sections.extend(part(&folder, &mut budget)?);
    }
    if sections.is_empty() {
        return Err(PageError::Empty {
            folder: dir.to_path_buf(),
        });
    }
    Ok(compose(&sections, &folder.origins()?))
}

/// Writes `index.html` into the folder it shows; size in bytes.
///
/// # Errors
/// Those of [`of_folder`] and [`Bundle::commit`].
pub fn write(dir: &Path) -> Result<usize, PageError> {
    let page = of_folder(dir)?;
    let size = page.len();
    let mut bundle = Bundle::new();
    bundle.add(FILE, page)?;
    bundle.commit(dir)?;
    Ok(size)
}
