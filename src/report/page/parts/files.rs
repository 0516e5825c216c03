//! Every table of the folder: CSV with its size, those too large for the page among them, and the forms for documents.

use super::blocks::made;
use crate::report::page::{Block, Budget, Folder, Link, PageError, Section};

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut rows = Vec::new();
    for path in folder.of_kind("csv") {
        let (lines, columns) = folder.sheet(path)?.size();
        rows.push(Link {
            note: format!("{lines} × {columns}"),
            ..Link::new(path, path)
        });
    }
    if rows.is_empty() {
        return Ok(None);
    }
    let mut blocks = vec![Block::Links(rows)];
    let documents: Vec<Link> = ["tex", "md"]
        .iter()
        .flat_map(|kind| folder.of_kind(kind))
        .map(|path| Link::new(path, path))
        .collect();
    if !documents.is_empty() {
        blocks.push(Block::Heading("For documents".into()));
        blocks.push(Block::Links(documents));
    }
    let lead = "Behind a table: rows × columns. pandas.read_csv reads every CSV file; units stand in the column names.";
    Ok(made("files", "Files", lead, blocks))
}
