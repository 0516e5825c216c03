//! Cells whose problem comes from a file: one increment from rest, without mesh, closed form and converged solution.

use std::path::Path;

use stickslip_methods::Load;

use super::rounds::{Repeats, take_rounds};
use super::scene::{Bench, MeasureError};
use super::{found_of, spent_of};
use crate::run::choice::Choice;
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::memory;
use crate::studies::sweep::cell::{Cell, FROM_FILE};
use crate::studies::sweep::record::{Found, ProblemSize, Record, Times};

/// Measures a cell on the problem of a file; its times are those of one pass.
///
/// # Errors
/// [`MeasureError`].
pub fn measure_file(
    bench: &mut Bench,
    cell: &Cell,
    path: &Path,
    choice: &Choice,
) -> Result<Record, MeasureError> {
    let (problem, operator) = bench.problem(cell, path)?;
    let accuracy = Accuracy::exactly(cell.tolerance);
    let (tried, key) = problem.try_method(choice, accuracy, 1);
    let row = tried.run_row(&key, &problem.system, problem.setup, accuracy);
    let honest = tried.verdict.is_honest();
    let found = Found {
        problem: Some(ProblemSize {
            mesh: problem.kind.to_owned(),
            space: FROM_FILE.to_owned(),
            h_m: 0.0,
            dim: problem.system.dim(),
            dofs: problem.system.elastic().unknowns(),
            points: problem.system.points(),
            unknowns: problem.system.rows(),
            operator: Some(operator.clone()),
        }),
        increments: vec![found_of(&row, &tried, None)],
        ..Found::only(tried.verdict.clone(), choice.label.clone(), choice.exact())
    };
    let spent = honest.then(|| spent_of(&[row], 0.0, memory::peak_mb()));
    Ok(Record::here(cell, found, spent.flatten()))
}

/// Times of some methods on the problem of a file, as [`in_turn`](super::in_turn).
///
/// # Errors
/// [`MeasureError`].
pub fn file_in_turn(
    bench: &mut Bench,
    cells: &[Cell],
    choices: &[Choice],
    path: &Path,
    repeats: Repeats,
) -> Result<Vec<Result<Times, Verdict>>, MeasureError> {
    let Some(cell) = cells.first() else {
        return Ok(Vec::new());
    };
    let (problem, _) = bench.problem(cell, path)?;
    let loads: [Load; 2] = [problem.rest.clone(), problem.load.clone()];
    let asked = (&problem.system, &loads[..], cell.tolerance, cell.cold);
    Ok(take_rounds(asked, choices, repeats))
}
