//! Methods against each other: every case by every method, and all variants on plate and beam.

use std::collections::BTreeMap;

use super::blocks::{Tally, columns, figures, made, tables};
use crate::report::page::{Block, Budget, Folder, Grid, Kind, PageError, Section, Show};
use crate::report::plot::rank;

const COMPARISON: [Show; 9] = [
    Show::new("case", Kind::Text),
    Show::new("method", Kind::Text),
    Show::new("increments", Kind::Number),
    Show::new("verdict", Kind::Verdict).titled("worst verdict"),
    Show::new("natural_map", Kind::Digits(2)).titled("largest natural map"),
    Show::new("iterations", Kind::Number),
    Show::new("tangent_factorisations", Kind::Number).titled("dense factorisations"),
    Show::new("local_solves", Kind::Number),
    Show::new("solve_s", Kind::Digits(3)),
];

const VARIANTS: [Show; 12] = [
    Show::new("case", Kind::Text),
    Show::new("friction", Kind::Number),
    Show::new("method", Kind::Text),
    Show::new("verdict", Kind::Verdict),
    Show::new("quantity", Kind::Text),
    Show::new("value", Kind::Digits(7)).titled("value [SI]"),
    Show::new("deviation", Kind::Digits(2)),
    Show::new("natural_map", Kind::Digits(2)),
    Show::new("iterations", Kind::Number),
    Show::new("tangent_factorisations", Kind::Number).titled("dense"),
    Show::new("global_factorisations", Kind::Number).titled("sparse"),
    Show::new("solve_s", Kind::Digits(3)),
];

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for path in folder.named("comparison.csv") {
        blocks.push(Block::Table(by_method(folder, path)?));
    }
    let title = "Every case by every method: all meshes, friction coefficients and increments";
    blocks.extend(tables(folder, "comparison.csv", title, &COMPARISON)?);
    let title = "Plate and beam by every method and variant";
    blocks.extend(tables(folder, "variants.csv", title, &VARIANTS)?);
    blocks.extend(figures(
        folder,
        budget,
        "Iterations and solve time by case",
        |name| name == "cost.svg",
    )?);
    let lead = "The same problems for every method. Dense factorisations are those of condensed matrices; the matrix of the \
                body is factored once per mesh and shared, except by monolithic variants.";
    Ok(made("methods", "Methods", lead, blocks))
}

/// Cases by their worst verdict, a row per method.
fn by_method(folder: &Folder, path: &str) -> Result<Grid, PageError> {
    let sheet = folder.sheet(path)?;
    let methods = sheet.texts("method")?;
    let mut tallies: BTreeMap<(usize, &str), Tally> = BTreeMap::new();
    for (method, verdict) in methods.iter().zip(sheet.verdicts()?) {
        let own = tallies.entry((rank(method), method)).or_default();
        own.add(verdict.kind());
    }
    let all: Vec<Tally> = tallies.values().copied().collect();
    let counts = Tally::shown(&all);
    let mut grid = folder.empty_grid(path, "Cases by method, each by the worst of its increments");
    grid.id += "-methods";
    let mut headings = vec![("method", "", Kind::Text)];
    headings.extend(counts.iter().map(|(_, name)| (*name, "", Kind::Number)));
    columns(&mut grid, &headings);
    grid.rows = tallies
        .into_iter()
        .map(|((_, method), tally)| {
            let counts = counts.iter().map(|(place, _)| tally.0[*place].to_string());
            std::iter::once(method.to_owned()).chain(counts).collect()
        })
        .collect();
    Ok(grid)
}
