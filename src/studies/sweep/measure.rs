//! One cell, measured: the load path once for the verdicts and errors, which also warms the machine up, then again and
//! again for the times.
//!
//! Every repetition builds and prepares the method anew and solves every increment from the state in which the first pass
//! began it; only these calls are timed. A repetition that ends in other bits than the first pass is an error of the
//! method: the same increment twice must give the same bits.

mod reference;
mod scene;

pub use scene::{Bench, MeasureError};

use std::time::Instant;

use stickslip_methods::{ContactState, Increment, Load, PointStatus};

use super::cell::Cell;
use super::record::{Found, IncrementFound, Origin, ProblemSize, Record, SCHEMA, Spent};
use super::statistics::Timing;
use crate::model::field_mesh::field_step;
use crate::model::quantities::{Snapshot, point_states, quantities};
use crate::run::choice::Choice;
use crate::run::increment::{JudgedIncrement, Solver};
use crate::run::load_path::{LoadPathRun, PathEnd};
use crate::run::record::RunRow;
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::convergence::{closed_form, followed};
use crate::studies::memory;
use reference::solver_error;
use scene::Scene;

/// How often a cell is repeated for its times.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Repeats {
    /// At least so often, unless `patience_s` is spent; 0: no times at all.
    pub least: usize,
    /// At most so often.
    pub most: usize,
    /// Until so much time was spent in the repetitions [s].
    pub seconds: f64,
    /// Never longer than this, apart from the repetition that crosses it [s].
    pub patience_s: f64,
}

impl Repeats {
    /// Seven for an interval of the median, more while they cost little.
    pub const DEFAULT: Self = Self {
        least: 7,
        most: 200,
        seconds: 0.05,
        patience_s: 2.0,
    };
    /// No times.
    pub const NONE: Self = Self {
        least: 0,
        most: 0,
        seconds: 0.0,
        patience_s: 0.0,
    };

    fn enough(&self, done: usize, spent_s: f64) -> bool {
        done >= self.most
            || (done >= self.least && spent_s >= self.seconds)
            || (done > 0 && spent_s >= self.patience_s)
    }
}

/// Measures a cell. `text`: its case file.
///
/// # Errors
/// [`MeasureError`].
pub fn measure(
    bench: &mut Bench,
    cell: &Cell,
    text: &str,
    choice: &Choice,
    repeats: Repeats,
) -> Result<Record, MeasureError> {
    let mut scene = bench.scene(cell, text, choice.needs_traction())?;
    let pass = first_pass(&scene, cell, choice);
    let mut verdict = pass.end.verdict.clone();
    let timed = if verdict.is_honest() && repeats.most > 0 {
        repeat(&scene, &pass, choice, repeats)
    } else {
        Ok(None)
    };
    if let Err(broken) = &timed {
        verdict = broken.clone();
    }
    let mut found = Found {
        problem: Some(size(&scene)),
        increments: pass.increments.clone(),
        ..Found::only(verdict, choice.label.clone(), choice.method.exact)
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
        found.solver_error = solver_error(&mut scene, &pass.snapshots, choice.method.name);
    }
    let spent = timed.ok().flatten().zip(pass.rows.last());
    let spent = spent.map(|((prepare, solve), row)| Spent {
        setup_s: row.setup_s,
        assembly_s: row.assembly_s,
        factorisation_s: row.factorisation_s,
        condensation_s: row.condensation_s,
        prepare,
        solve,
        output_s,
        peak_mb,
    });
    Ok(Record {
        schema: SCHEMA,
        id: cell.id(),
        cell: cell.clone(),
        origin: Origin::here(),
        limits: None,
        found,
        spent,
    })
}

/// The load path, followed once.
struct Pass {
    end: PathEnd,
    rows: Vec<RunRow>,
    increments: Vec<IncrementFound>,
    /// Of honest increments.
    states: Vec<ContactState>,
    snapshots: Vec<Snapshot>,
    accuracy: Accuracy,
}

fn first_pass(scene: &Scene<'_>, cell: &Cell, choice: &Choice) -> Pass {
    let path = LoadPathRun {
        case: scene.case,
        loading: &scene.loading,
        system: scene.system,
        friction: cell.mu(),
        choice,
        accuracy: Accuracy::exactly(cell.tolerance),
    };
    let (mut rows, mut increments) = (Vec::new(), Vec::new());
    let (mut states, mut snapshots) = (Vec::new(), Vec::new());
    let mut status: Option<Vec<PointStatus>> = None;
    let end = path.follow(&mut |key, increment, now| {
        let row = path.row(key, increment, now);
        increments.push(found_of(&row, increment, status.as_deref()));
        rows.push(row);
        if let (Some(judged), Some(now)) = (&increment.judged, now) {
            status = Some(judged.status.clone());
            states.push(judged.outcome.state.clone());
            snapshots.push(now.clone());
        }
    });
    Pass {
        end,
        rows,
        increments,
        states,
        snapshots,
        accuracy: path.accuracy,
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

/// Preparation and solution of all increments, repeated.
///
/// # Errors
/// The verdict on a method that errs or finds other bits when asked again.
fn repeat(
    scene: &Scene<'_>,
    pass: &Pass,
    choice: &Choice,
    repeats: Repeats,
) -> Result<Option<(Timing, Timing)>, Verdict> {
    let system = scene.system;
    let increments = 0..=pass.states.len();
    let loads: Vec<Load> = increments.map(|k| scene.loading.at(k)).collect();
    let rest = ContactState::zero(system);
    let (mut preparing, mut solving) = (Vec::new(), Vec::new());
    let clock = Instant::now();
    while !repeats.enough(solving.len(), clock.elapsed().as_secs_f64()) {
        let mut solver = Solver::new(choice, system)?;
        let mut total_s = 0.0;
        for (index, first) in pass.states.iter().enumerate() {
            let problem = Increment {
                system,
                load: &loads[index + 1],
                start_load: &loads[index],
                start: index.checked_sub(1).map_or(&rest, |i| &pass.states[i]),
                index,
                tolerance: pass.accuracy.asked,
            };
            let (outcome, solve_s) = solver.solve(&problem);
            total_s += solve_s;
            let again = outcome?.state;
            if again != *first {
                let message = "the same increment gave other bits when it was solved again";
                return Err(Verdict::Crashed(message.into()));
            }
        }
        preparing.push(solver.prepare_s);
        solving.push(total_s);
    }
    Ok(Timing::of(&preparing).zip(Timing::of(&solving)))
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
    }
}
