//! What sections are made of: tables and figures of the folder, tallies of verdicts.

use crate::report::page::folder::split;
use crate::report::page::{Block, Budget, Column, Folder, Grid, Kind, PageError, Section, Show};
use crate::run::verdict::{Verdict, VerdictKind};

/// A section of these blocks; nothing without any.
pub fn made(id: &str, title: &str, lead: &str, blocks: Vec<Block>) -> Option<Section> {
    (!blocks.is_empty()).then(|| Section {
        id: id.into(),
        title: title.into(),
        lead: lead.into(),
        blocks,
    })
}

/// Every table of this file name, as it is, without the times of runs that did not do what they claim.
pub fn tables(
    folder: &Folder,
    name: &str,
    title: &str,
    shows: &[Show],
) -> Result<Vec<Block>, PageError> {
    let paths = folder.named(name).into_iter();
    paths
        .map(|path| {
            let mut grid = folder.grid(path, title, shows)?;
            hide_times(&mut grid, Verdict::is_honest);
            Ok(Block::Table(grid))
        })
        .collect()
}

/// Times stand only in rows whose verdict satisfies `keep`.
pub fn hide_times(grid: &mut Grid, keep: fn(&Verdict) -> bool) {
    let columns = grid.columns.iter();
    let Some(verdict) = columns.clone().position(|c| c.kind == Kind::Verdict) else {
        return;
    };
    let times: Vec<usize> = columns
        .enumerate()
        .filter_map(|(k, column)| (column.unit == "s").then_some(k))
        .collect();
    for row in &mut grid.rows {
        if !row[verdict].parse().is_ok_and(|verdict| keep(&verdict)) {
            times.iter().for_each(|k| row[*k] = "NaN".into());
        }
    }
}

/// Verdicts counted under [`Tally::NAMES`].
#[derive(Clone, Copy, Default)]
pub struct Tally(pub [usize; Tally::NAMES.len()]);

impl Tally {
    pub const NAMES: [&str; 7] = [
        "solved",
        "approximate",
        "refused",
        "gave up or crashed",
        "false claims",
        "timed out",
        "out of memory",
    ];

    /// Counts one more.
    pub fn add(&mut self, kind: VerdictKind) {
        let place = match kind {
            VerdictKind::Solved => 0,
            VerdictKind::Approximate => 1,
            VerdictKind::Refused => 2,
            VerdictKind::GaveUp | VerdictKind::Crashed => 3,
            VerdictKind::FalseClaim => 4,
            VerdictKind::TimedOut => 5,
            VerdictKind::OutOfMemory => 6,
        };
        self.0[place] += 1;
    }

    /// Places and names of what is shown beside each other: ends at a limit only where one of the tallies has any.
    pub fn shown(all: &[Self]) -> Vec<(usize, &'static str)> {
        let places = Self::NAMES.into_iter().enumerate();
        let wanted = |place: usize| place < 5 || all.iter().any(|tally| tally.0[place] > 0);
        places.filter(|(place, _)| wanted(*place)).collect()
    }
}

/// Figures whose path without folders satisfies `wanted`, as one folded group.
pub fn figures(
    folder: &Folder,
    budget: &mut Budget,
    title: &str,
    wanted: impl Fn(&str) -> bool,
) -> Result<Vec<Block>, PageError> {
    let paths = folder.of_kind("svg");
    let paths = paths.filter(|path| wanted(split(path).1));
    let group = folder.figures(title, paths, budget)?;
    Ok(group.map(Block::Figures).into_iter().collect())
}

/// Sets the columns of a table that is gathered here.
pub fn columns(grid: &mut Grid, columns: &[(&str, &str, Kind)]) {
    grid.columns = columns
        .iter()
        .map(|(heading, unit, kind)| Column {
            heading: (*heading).into(),
            unit: (*unit).into(),
            kind: *kind,
        })
        .collect();
}

/// Largest number; NaN of nothing and of NaN only.
pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NAN, f64::max)
}
