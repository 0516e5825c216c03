//! Contact spaces: inf-sup numbers and patch tests, summed up.

use std::collections::BTreeMap;

use super::blocks::{columns, figures, largest, made};
use crate::report::number::value;
use crate::report::page::{Block, Budget, Folder, Grid, Kind, PageError, Section};

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for path in folder.named("infsup.csv") {
        blocks.push(Block::Table(infsup(folder, path)?));
    }
    for path in folder.named("patch.csv") {
        blocks.push(Block::Table(patch(folder, path)?));
    }
    blocks.extend(figures(
        folder,
        budget,
        "Inf-sup numbers against cell size",
        |name| name == "infsup.svg",
    )?);
    let lead = "Which spaces of contact forces are stable on a crack that lies in the grid in any way, and which represent \
                uniform stress exactly.";
    Ok(made("spaces", "Contact spaces", lead, blocks))
}

/// A row per crack and space: coarsest and finest β, slope, share, verdict.
fn infsup(folder: &Folder, path: &str) -> Result<Grid, PageError> {
    let sheet = folder.sheet(path)?;
    let texts = ["dimension", "crack", "space", "verdict"];
    let [dimension, crack, space, verdict] = {
        let [a, b, c, d] = texts.map(|name| sheet.texts(name));
        [a?, b?, c?, d?]
    };
    let (cells, beta) = (sheet.numbers("cells")?, sheet.numbers("beta")?);
    let (kernel, slope) = (sheet.numbers("kernel")?, sheet.numbers("slope")?);
    let share = sheet.numbers("share")?;
    let mut groups: BTreeMap<[&str; 3], Vec<usize>> = BTreeMap::new();
    for k in 0..crack.len() {
        let group = groups
            .entry([dimension[k], crack[k], space[k]])
            .or_default();
        group.push(k);
    }
    let mut grid = folder.empty_grid(
        path,
        "Inf-sup numbers β: a stable space keeps β above a constant on every mesh",
    );
    columns(
        &mut grid,
        &[
            ("dimension", "", Kind::Number),
            ("crack", "", Kind::Text),
            ("space", "", Kind::Text),
            ("meshes", "", Kind::Number),
            ("β, coarsest", "", Kind::Digits(3)),
            ("β, finest", "", Kind::Digits(3)),
            ("largest kernel", "", Kind::Number),
            ("slope", "", Kind::Fixed(2)),
            ("share", "", Kind::Digits(2)),
            ("verdict", "", Kind::Verdict),
        ],
    );
    grid.rows = groups
        .into_iter()
        .filter_map(|([dimension, crack, space], mut own)| {
            own.sort_by(|a, b| cells[*a].total_cmp(&cells[*b]));
            let (first, last) = (*own.first()?, *own.last()?);
            Some(vec![
                dimension.to_owned(),
                crack.to_owned(),
                space.to_owned(),
                own.len().to_string(),
                value(beta[first]),
                value(beta[last]),
                value(largest(own.iter().map(|k| kernel[*k]))),
                value(slope[last]),
                value(share[last]),
                verdict[last].to_owned(),
            ])
        })
        .collect();
    Ok(grid)
}

/// A row per space, patch and boundary: how many positions of the crack pass, and the worst errors.
fn patch(folder: &Folder, path: &str) -> Result<Grid, PageError> {
    let sheet = folder.sheet(path)?;
    let texts = ["space", "dimension", "patch", "boundary", "verdict"];
    let [space, dimension, patch, boundary, verdict] = {
        let [a, b, c, d, e] = texts.map(|name| sheet.texts(name));
        [a?, b?, c?, d?, e?]
    };
    let traction = sheet.numbers("traction_error")?;
    let displacement = sheet.numbers("displacement_error")?;
    let mut groups: BTreeMap<[&str; 4], Vec<usize>> = BTreeMap::new();
    for k in 0..space.len() {
        let key = [space[k], dimension[k], patch[k], boundary[k]];
        groups.entry(key).or_default().push(k);
    }
    let mut grid = folder.empty_grid(
        path,
        "Patch tests by space: all cracks, meshes and distances from a node together",
    );
    columns(
        &mut grid,
        &[
            ("space", "", Kind::Text),
            ("dimension", "", Kind::Number),
            ("patch", "", Kind::Text),
            ("boundary", "", Kind::Text),
            ("tests", "", Kind::Number),
            ("passed", "", Kind::Number),
            ("without answer", "", Kind::Number),
            ("worst traction error", "", Kind::Digits(2)),
            ("worst displacement error", "", Kind::Digits(2)),
            ("verdict", "", Kind::Verdict),
        ],
    );
    grid.rows = groups
        .into_iter()
        .map(|(key, own)| {
            let passed = own.iter().filter(|k| verdict[**k] == "pass").count();
            let silent = own.iter().filter(|k| traction[**k].is_nan()).count();
            let mut row: Vec<String> = key.map(str::to_owned).to_vec();
            row.extend([own.len(), passed, silent].map(|n| n.to_string()));
            row.push(value(largest(own.iter().map(|k| traction[*k]))));
            row.push(value(largest(own.iter().map(|k| displacement[*k]))));
            row.push(if passed == own.len() { "pass" } else { "fail" }.into());
            row
        })
        .collect();
    Ok(grid)
}
