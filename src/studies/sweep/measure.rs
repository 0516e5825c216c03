//! One cell, measured: the load path once for the verdicts and errors. Its times come from [`in_turn`].

mod from_file;
mod reference;
mod rounds;
mod scene;

pub use from_file::{file_in_turn, measure_file};
pub use rounds::{Repeats, in_turn};
pub use scene::{Bench, MeasureError};

use std::time::Instant;

use stickslip_methods::PointStatus;

use super::cell::Cell;
use super::record::{Found, IncrementFound, ProblemSize, Record, Spent};
use super::statistics::Timing;
use crate::model::field_mesh::field_step;
use crate::model::quantities::{Snapshot, point_states, quantities};
use crate::run::choice::Choice;
use crate::run::increment::JudgedIncrement;
use crate::run::load_path::{Guess, LoadPathRun, PathEnd};
use crate::run::record::RunRow;
use crate::run::verdict::Accuracy;
use crate::studies::convergence::{closed_form, followed};
use crate::studies::memory;
use reference::solver_error;
use scene::Scene;

/// Measures a cell; its times are those of one pass. `text`: its case file.
///
/// # Errors
/// [`MeasureError`].
pub fn measure(
    bench: &mut Bench,
    cell: &Cell,
    text: &str,
    choice: &Choice,
) -> Result<Record, MeasureError> {
    let mut scene = bench.scene(cell, text, choice.needs_traction())?;
    let pass = pass(&scene, cell, choice);
    let verdict = pass.end.verdict.clone();
    let mut found = Found {
        problem: Some(size(&scene)),
        increments: pass.increments.clone(),
        ..Found::only(verdict, choice.label.clone(), choice.exact())
    };
    let honest = found.verdict.is_honest();
    let mut output_s = f64::NAN;
    if let (true, Some(now)) = (honest, pass.snapshots.last()) {
        output_s = output(&scene, now);
        match closed_form(&scene.loading, now)? {
            Some(deviations) => found.deviations = deviations,
            None => found.values = followed(scene.case, scene.body, now),
        }
    }
    // Before the reference, which is no part of the cell.
    let peaks = [scene.peak_mb, memory::peak_mb()].into_iter().flatten();
    let peak_mb = peaks.reduce(f64::max);
    if honest {
        found.solver_error = solver_error(&mut scene, &pass.snapshots, choice.name());
    }
    let spent = honest.then(|| spent_of(&pass.rows, output_s, peak_mb));
    Ok(Record::here(cell, found, spent.flatten()))
}

/// What the increments of one pass took; none without increments.
fn spent_of(rows: &[RunRow], output_s: f64, peak_mb: Option<f64>) -> Option<Spent> {
    let sum = |of: fn(&RunRow) -> f64| Timing::of(&[rows.iter().map(of).sum()]);
    let row = rows.last()?;
    Some(Spent {
        setup_s: row.setup_s,
        assembly_s: row.assembly_s,
        factorisation_s: row.factorisation_s,
        condensation_s: row.condensation_s,
        prepare: sum(|row| row.prepare_s)?,
        solve: sum(|row| row.solve_s)?,
        enforcement: sum(|row| row.enforcement_s)?,
        reported: sum(|row| row.reported_s),
        output_s,
        peak_mb,
    })
}

/// The load path, followed once.
struct Pass {
    end: PathEnd,
    rows: Vec<RunRow>,
    increments: Vec<IncrementFound>,
    /// Of honest increments.
    snapshots: Vec<Snapshot>,
}

fn pass(scene: &Scene<'_>, cell: &Cell, choice: &Choice) -> Pass {
    let path = LoadPathRun {
        case: scene.case,
        loading: &scene.loading,
        system: scene.system,
        friction: cell.mu(),
        choice,
        accuracy: Accuracy::exactly(cell.tolerance),
        guess: if cell.cold {
            Guess::Cold
        } else {
            Guess::Before
        },
    };
    let (mut rows, mut increments) = (Vec::new(), Vec::new());
    let mut snapshots = Vec::new();
    let mut status: Option<Vec<PointStatus>> = None;
    let end = path.follow(&mut |key, increment, now| {
        let row = path.row(key, increment, now);
        increments.push(found_of(&row, increment, status.as_deref()));
        rows.push(row);
        if let (Some(judged), Some(now)) = (&increment.judged, now) {
            status = Some(judged.status.clone());
            snapshots.push(now.clone());
        }
    });
    Pass {
        end,
        rows,
        increments,
        snapshots,
    }
}

/// `before`: states of the points at the start; without one all are open.
fn found_of(
    row: &RunRow,
    increment: &JudgedIncrement,
    before: Option<&[PointStatus]>,
) -> IncrementFound {
    let judged = increment.judged.as_ref();
    let began = |point: usize| before.map_or(PointStatus::Open, |before| before[point]);
    let status = judged.map_or(&[][..], |j| &j.status).iter().enumerate();
    let history = judged.map_or(&[][..], |j| &j.outcome.history);
    IncrementFound {
        verdict: row.verdict.clone(),
        natural_map: Some(row.natural_map).filter(|map| map.is_finite()),
        violation: Some(row.violation).filter(|found| found.is_finite()),
        iterations: row.iterations,
        solves: row.solves,
        tangent_factorisations: row.tangent_factorisations,
        global_factorisations: row.global_factorisations,
        local_solves: row.local_solves,
        state_changes: history.iter().map(|i| i.changes).sum(),
        final_changes: status.filter(|(i, now)| **now != began(*i)).count(),
    }
}

/// Seconds to gather the tables and fields of an increment.
fn output(scene: &Scene<'_>, now: &Snapshot) -> f64 {
    let clock = Instant::now();
    let rows = quantities(scene.case, scene.body, now);
    let points = point_states(scene.body, now);
    let fields = field_step(scene.body, now);
    std::hint::black_box((rows, points, fields));
    clock.elapsed().as_secs_f64()
}

fn size(scene: &Scene<'_>) -> ProblemSize {
    let body = scene.body;
    ProblemSize {
        mesh: body.label.clone(),
        space: body.space.clone(),
        h_m: scene.case.mesh.grid.refined(scene.refine).cell_size(),
        dim: body.mesh.dim(),
        dofs: body.elastic.unknowns(),
        points: body.points.len(),
        unknowns: scene.system.rows(),
        operator: None,
    }
}
