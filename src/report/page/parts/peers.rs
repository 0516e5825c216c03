//! Other programs on the same problems.

use super::blocks::{made, tables};
use crate::report::page::{Block, Budget, Folder, Kind, Link, PageError, Section, Show};

const SICONOS: [Show; 13] = [
    Show::new("problem", Kind::Text),
    Show::new("dim", Kind::Number).titled("dimension"),
    Show::new("points", Kind::Number),
    Show::new("method", Kind::Text),
    Show::new("iterations", Kind::Number),
    Show::new("natural_map", Kind::Digits(2)),
    Show::new("time_s", Kind::Digits(3)),
    Show::new("peer", Kind::Text).titled("Siconos"),
    Show::new("peer_iterations", Kind::Number).titled("its iterations"),
    Show::new("peer_natural_map", Kind::Digits(2)).titled("its natural map"),
    Show::new("peer_time_s", Kind::Digits(3)).titled("its time"),
    Show::new("ratio", Kind::Digits(3)).titled("its time / ours"),
    Show::new("difference", Kind::Digits(2)).titled("difference of forces"),
];

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    let title = "Best exact method here beside the best solver of Siconos";
    let name = "siconos_comparison.csv";
    let mut blocks = tables(folder, name, title, &SICONOS)?;
    let notes = folder.named(name).into_iter().map(|path| {
        let readme = path.replace(name, "README.md");
        Link::new("How both were run", readme)
    });
    let notes: Vec<Link> = notes.filter(|link| folder.has(&link.path)).collect();
    if !notes.is_empty() {
        blocks.push(Block::Links(notes));
    }
    let lead = "Problems exported to files, solved by Siconos and by the methods here to the same natural map of 10⁻⁹.";
    Ok(made("peers", "Other programs", lead, blocks))
}
