//! Random problems: success rate of every method by friction coefficient.

use std::collections::BTreeMap;

use super::blocks::{columns, figures, largest, made};
use crate::report::number::value;
use crate::report::page::{Block, Budget, Column, Folder, Grid, Kind, PageError, Section};
use crate::report::plot::rank;

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for path in folder.named("robustness.csv") {
        blocks.push(Block::Table(rates(folder, path)?));
    }
    blocks.extend(figures(
        folder,
        budget,
        "Success rate against friction, with 95 % intervals",
        |name| name == "robustness.svg",
    )?);
    let lead = "The same seeded random problems for every method. Exact methods succeed where they solved the contact laws, \
                approximate ones where they kept their claim. Lowest bound: the least lower end of Wilson's 95 % interval \
                over the friction coefficients.";
    Ok(made("robustness", "Robustness", lead, blocks))
}

/// A row per dimension and method, a column per friction coefficient.
fn rates(folder: &Folder, path: &str) -> Result<Grid, PageError> {
    let sheet = folder.sheet(path)?;
    let (methods, counted) = (sheet.texts("method")?, sheet.texts("success")?);
    let dimensions = sheet.texts("dimension")?;
    let (friction, rate) = (sheet.numbers("friction")?, sheet.numbers("success_rate")?);
    let (low, median) = (
        sheet.numbers("success_low")?,
        sheet.numbers("iterations_median")?,
    );
    let (lies, lawless) = (
        sheet.numbers("false_claims")?,
        sheet.numbers("approximate_none")?,
    );
    let problems = largest(sheet.numbers("problems")?.into_iter());
    let mut coefficients = friction.clone();
    coefficients.sort_by(f64::total_cmp);
    coefficients.dedup();
    let mut groups: BTreeMap<(&str, usize, &str), Vec<usize>> = BTreeMap::new();
    for (k, method) in methods.iter().enumerate() {
        let key = (dimensions[k], rank(method), *method);
        groups.entry(key).or_default().push(k);
    }
    let title = format!(
        "Success rate, {} problems per dimension and friction coefficient",
        value(problems)
    );
    let mut grid = folder.empty_grid(path, &title);
    columns(
        &mut grid,
        &[
            ("dimension", "", Kind::Number),
            ("method", "", Kind::Text),
            ("counts", "", Kind::Text),
        ],
    );
    grid.columns.extend(coefficients.iter().map(|mu| Column {
        heading: format!("μ = {}", value(*mu)),
        unit: String::new(),
        kind: Kind::Percent(1),
    }));
    let mut last = Grid::default();
    columns(
        &mut last,
        &[
            ("lowest bound", "", Kind::Percent(1)),
            ("iterations, worst median", "", Kind::Number),
            ("laws to no tier", "", Kind::Number),
            ("false claims", "", Kind::Number),
        ],
    );
    grid.columns.extend(last.columns);
    grid.rows = groups
        .into_iter()
        .map(|((dimension, _, method), own)| {
            let kinds = own.first().map_or("", |k| counted[*k]);
            let mut row = vec![dimension.to_owned(), method.to_owned(), kinds.to_owned()];
            row.extend(coefficients.iter().map(|mu| {
                let found = own.iter().find(|k| friction[**k] == *mu);
                match found.map(|k| rate[*k]) {
                    Some(rate) if rate.is_finite() => rate.to_string(),
                    Some(_) => "refused".to_owned(),
                    None => String::new(),
                }
            }));
            row.push(value(-largest(own.iter().map(|k| -low[*k]))));
            row.push(value(largest(own.iter().map(|k| median[*k]))));
            row.push(value(own.iter().map(|k| lawless[*k]).sum()));
            row.push(value(own.iter().map(|k| lies[*k]).sum()));
            row
        })
        .collect();
    Ok(grid)
}
