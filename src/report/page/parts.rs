//! The sections of a page, one file each, in the order of the page. A part that finds nothing of its own is left out.
//!
//! To add one: a file with `pub fn section(folder, budget) -> Result<Option<Section>, PageError>`, and a line in [`PARTS`].

mod accuracy;
mod blocks;
mod cases;
mod choice;
mod expected;
mod files;
mod methods;
mod paper;
mod peers;
mod robustness;
mod runs;
mod spaces;
mod summary;
mod sweep;

use super::{Budget, Folder, PageError, Section};

/// Reads what it knows in the folder; nothing where there is nothing.
pub type Part = fn(&Folder, &mut Budget) -> Result<Option<Section>, PageError>;

/// All parts in the order of the page, which is also the order in which figures get room.
pub const PARTS: [Part; 13] = [
    summary::section,
    choice::section,
    paper::section,
    sweep::section,
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
