//! Expected numbers: how many of each case were met, and the ones that were not.

use std::collections::BTreeMap;

use super::blocks::{columns, made};
use crate::report::page::{Block, Budget, Folder, Grid, Kind, PageError, Section, Show};
use crate::run::record::{MET, MISSED_AS_DOCUMENTED};

const MISSED: [Show; 12] = [
    Show::new("case", Kind::Text),
    Show::new("mesh", Kind::Text),
    Show::new("method", Kind::Text),
    Show::new("friction", Kind::Number),
    Show::new("quantity", Kind::Text),
    Show::new("at", Kind::Text),
    Show::new("expected", Kind::Digits(6)),
    Show::new("found", Kind::Digits(6)),
    Show::new("allowed", Kind::Digits(2)),
    Show::new("unit", Kind::Text),
    Show::new("kind", Kind::Text),
    Show::new("verdict", Kind::Verdict),
];

/// The section.
pub fn section(folder: &Folder, _: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for path in folder.named("expectations.csv") {
        blocks.push(Block::Table(by_case(folder, path)?));
        let mut grid = folder.grid(path, "Expected numbers that were not met", &MISSED)?;
        grid.id += "-missed";
        let verdict = MISSED.len() - 1;
        grid.rows.retain(|row| row[verdict] != MET);
        if !grid.rows.is_empty() {
            blocks.push(Block::Table(grid));
        }
    }
    let lead = "Closed forms and published numbers that the cases must reproduce, by every exact method. Missed as \
                documented: a limitation that the case file states.";
    Ok(made("expected", "Expected numbers", lead, blocks))
}

#[derive(Default)]
struct Tally<'a> {
    kinds: Vec<&'a str>,
    numbers: usize,
    met: usize,
    documented: usize,
    worst: f64,
}

fn by_case(folder: &Folder, path: &str) -> Result<Grid, PageError> {
    let sheet = folder.sheet(path)?;
    let (cases, kinds) = (sheet.texts("case")?, sheet.texts("kind")?);
    let verdicts = sheet.texts("verdict")?;
    let (expected, found) = (sheet.numbers("expected")?, sheet.numbers("found")?);
    let allowed = sheet.numbers("allowed")?;
    let mut tallies: BTreeMap<&str, Tally> = BTreeMap::new();
    for (k, case) in cases.iter().enumerate() {
        let tally = tallies.entry(case).or_default();
        tally.numbers += 1;
        if !tally.kinds.contains(&kinds[k]) {
            tally.kinds.push(kinds[k]);
        }
        if verdicts[k] == MET {
            tally.met += 1;
            tally.worst = ((found[k] - expected[k]).abs() / allowed[k]).max(tally.worst);
        }
        tally.documented += usize::from(verdicts[k] == MISSED_AS_DOCUMENTED);
    }
    let mut grid = folder.empty_grid(path, "Expected numbers by case, all exact methods");
    columns(
        &mut grid,
        &[
            ("case", "", Kind::Text),
            ("kind", "", Kind::Text),
            ("numbers", "", Kind::Number),
            ("met", "", Kind::Number),
            ("missed as documented", "", Kind::Number),
            ("not as stated", "", Kind::Number),
            ("worst met, of its tolerance", "", Kind::Digits(2)),
        ],
    );
    grid.rows = tallies
        .into_iter()
        .map(|(case, tally)| {
            vec![
                case.to_owned(),
                tally.kinds.join(", "),
                tally.numbers.to_string(),
                tally.met.to_string(),
                tally.documented.to_string(),
                (tally.numbers - tally.met - tally.documented).to_string(),
                tally.worst.to_string(),
            ]
        })
        .collect();
    Ok(grid)
}
