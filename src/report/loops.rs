//! The friction loops of a command: `figures/<problem>.crack-<n>.loop.svg`.

use super::number::significant;
use super::standard::problem_name;
use super::{Bundle, ReportError, plot};
use crate::run::record::{QuantityRow, Results, RunKey};
use std::collections::{BTreeMap, BTreeSet};

/// Significant digits of a dissipation.
const DIGITS: usize = 4;

/// A figure per problem and 2D crack whose load path has at least four increments and runs back.
///
/// # Errors
/// Those of the figures and of [`Bundle::add`].
pub fn add_to(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    // A solid has slip along b too, which is no loop in a plane.
    let solid: BTreeSet<String> = results
        .quantities
        .iter()
        .filter(|row| row.quantity.name == "mean_slip" && row.quantity.component == "b")
        .map(|row| problem_name(&row.key))
        .collect();
    let mut problems: BTreeMap<String, Vec<QuantityRow>> = BTreeMap::new();
    for row in &results.quantities {
        let wanted = ["mean_slip", "contact_force", "dissipation"];
        let name = problem_name(&row.key);
        if wanted.contains(&row.quantity.name.as_str()) && !solid.contains(&name) {
            problems.entry(name).or_default().push(row.clone());
        }
    }
    for (name, rows) in problems {
        let cracks: BTreeSet<usize> = rows
            .iter()
            .filter_map(|row| row.quantity.at.strip_prefix("crack-")?.parse().ok())
            .collect();
        let note = dissipation(&rows, results);
        for crack in cracks {
            if let Some(svg) = plot::friction_loop(&rows, crack, note.as_slice())? {
                bundle.add(format!("figures/{name}.crack-{crack}.loop.svg"), svg)?;
            }
        }
    }
    Ok(())
}

/// What the first method of a problem dissipates over the path, beside the closed form if the case states it.
fn dissipation(rows: &[QuantityRow], results: &Results) -> Option<String> {
    let own = rows.iter().filter(|row| row.quantity.name == "dissipation");
    let last = own.max_by_key(|row| {
        let rank = plot::method_rank(&row.key.method);
        (row.key.increment, std::cmp::Reverse(rank))
    })?;
    let number = |value: f64| significant(value, DIGITS);
    let RunKey {
        method, increment, ..
    } = &last.key;
    let exact = results.expectations.iter().find(|row| {
        let stated = row.kind == "analytic" && row.quantity == "dissipation";
        stated && row.key == last.key
    });
    let exact = exact.map_or(String::new(), |row| {
        format!(", closed form {}", number(row.expected))
    });
    let (found, unit) = (number(last.quantity.value), &last.quantity.unit);
    Some(format!(
        "dissipated up to increment {increment} ({method}): {found} {unit}{exact}"
    ))
}
