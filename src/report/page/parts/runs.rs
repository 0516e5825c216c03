//! The runs themselves, where no comparison sums them up: the results of `stickslip run`.

use super::blocks::{hide_times, made, tables};
use crate::report::page::{Block, Budget, Folder, Kind, PageError, Section, Show};
use crate::run::verdict::Verdict;

/// Longest table inside the page; of longer ones the beginning is shown.
const ROWS: usize = 2000;

const RUNS: [Show; 13] = [
    Show::new("case", Kind::Text),
    Show::new("mesh", Kind::Text),
    Show::new("space", Kind::Text),
    Show::new("method", Kind::Text),
    Show::new("friction", Kind::Number),
    Show::new("increment", Kind::Number),
    Show::new("tier", Kind::Text),
    Show::new("verdict", Kind::Verdict),
    Show::new("natural_map", Kind::Digits(2)),
    Show::new("iterations", Kind::Number),
    Show::new("tangent_factorisations", Kind::Number).titled("dense factorisations"),
    Show::new("points", Kind::Number),
    Show::new("solve_s", Kind::Digits(3)),
];

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    if !folder.named("comparison.csv").is_empty() {
        return Ok(None);
    }
    let mut blocks = tables(folder, "runs.csv", "Runs, every increment", &RUNS)?;
    for block in &mut blocks {
        if let Block::Table(grid) = block {
            hide_times(grid, |verdict| *verdict == Verdict::Solved);
            if grid.rows.len() > ROWS {
                grid.title += &format!(": the first {ROWS} of {}", grid.rows.len());
                grid.rows.truncate(ROWS);
            }
        }
    }
    Ok(made("runs", "Runs", "", blocks))
}
