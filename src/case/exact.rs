//! `[exact]` of a case file: the closed form the case has, with its parameters and its history.

use stickslip_xfem::exact::SolutionSpec;

use super::error::{CaseError, Span};
use super::load::{History, history};
use super::reader::Table;
use super::settings::PathSpec;

/// The closed form of a case.
#[derive(Debug, Clone)]
pub struct ExactSpec {
    /// Where the table stands in the file.
    pub span: Span,
    /// Closed form.
    pub solution: &'static SolutionSpec,
    /// Values of its parameters, in their order.
    pub values: Vec<f64>,
    /// Load factor over time.
    pub history: History,
}

impl ExactSpec {
    /// Load factors at time 0 and at the ends of all increments of a path.
    pub fn factors(&self, path: &PathSpec) -> Vec<f64> {
        let factor = |increment| self.history.factor(path.time(increment), path.end);
        (0..=path.increments).map(factor).collect()
    }
}

/// `[exact]`; `cracks` is the number of cracks of the case.
pub(super) fn exact(
    root: &Table<'_>,
    solutions: &'static [SolutionSpec],
    cracks: usize,
) -> Result<Option<ExactSpec>, CaseError> {
    let Some(value) = root.get("exact") else {
        return Ok(None);
    };
    let name = value.any_table()?.required("solution")?;
    if solutions.is_empty() {
        return Err(name.refuse("no name: none is registered", "unknown closed form"));
    }
    let named: Vec<(&str, &'static SolutionSpec)> =
        solutions.iter().map(|spec| (spec.name, spec)).collect();
    let solution = name.one_of(&named)?;
    // Its own keys, that is: another solution's parameter is unknown here.
    let mut keys = vec!["solution"];
    keys.extend(solution.parameters.iter().map(|p| p.name));
    keys.push("history");
    let table = value.table(&keys)?;
    let mut values = Vec::new();
    for parameter in solution.parameters {
        values.push(match (table.get(parameter.name), parameter.default) {
            (Some(given), _) => given.number()?,
            (None, Some(default)) => default,
            (None, None) => table.required(parameter.name)?.number()?,
        });
    }
    if cracks != 1 {
        let message = format!("a closed form beside {cracks} cracks");
        return Err(value.refuse("a case with exactly one [[crack]]", message));
    }
    Ok(Some(ExactSpec {
        span: table.span(),
        solution,
        values,
        history: history(&table)?,
    }))
}
