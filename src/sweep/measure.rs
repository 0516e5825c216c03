//! One cell, measured: the load path once for the verdicts and errors, which also warms the machine up, then again and
//! again for the times.
//!
//! Every repetition builds and prepares the method anew and solves every increment from the state in which the first pass
//! began it; only these calls are timed. A repetition that ends in other bits than the first pass is an error of the
//! method: the same increment twice must give the same bits.

use std::time::Instant;

use stickslip_methods::{ContactState, Increment, Load, PointStatus};

use super::cell::Cell;
use super::memory;
use super::record::{
    DeviationFound, Found, IncrementFound, Origin, ProblemSize, Record, SCHEMA, Spent, ValueFound,
};
use super::reference::solver_error;
use super::setup::{Bench, Scene};
use super::statistics::Timing;
use crate::harness::attempt::{prepare, solve};
use crate::harness::converge::{closed_form, followed};
use crate::harness::path::{Ended, Path};
use crate::harness::picture::field_step;
use crate::harness::quantities::{Snapshot, point_rows, quantity_rows};
use crate::harness::record::{RunKey, RunRow};
use crate::harness::run::{Choice, ChoiceError, RunError};
use crate::harness::verdict::{Accuracy, Verdict};

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

/// Why a cell could not be measured; what a method does wrong is a verdict.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The case or its discretisation.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The method.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// The contact space.
    #[error("unknown contact space `{0}`")]
    Space(String),
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
    let mut verdict = pass.verdict.clone();
    let honest = verdict.is_honest();
    let timed = if honest && repeats.most > 0 {
        repeat(&scene, &pass, choice, repeats)
    } else {
        Ok(None)
    };
    if let Err(broken) = &timed {
        verdict = broken.clone();
    }
    let mut found = Found {
        verdict: verdict.to_string(),
        method: choice.label.clone(),
        exact: choice.method.exact,
        problem: Some(size(&scene)),
        increments: pass.increments.clone(),
        ..Found::default()
    };
    let mut output_s = f64::NAN;
    if let (true, Some(now)) = (verdict.is_honest(), pass.snapshots.last()) {
        output_s = output(&scene, &pass.key, now);
        let exact = closed_form(&scene.loading, now)?;
        if let Some(deviations) = &exact {
            found.deviations = deviations.iter().map(DeviationFound::of).collect();
        } else {
            let values = followed(scene.case, scene.body, &pass.key, now);
            found.values = values.iter().map(ValueFound::of).collect();
        }
    }
    // Before the reference, which is no part of the cell.
    let peaks = [scene.peak_mb, memory::peak_mb()].into_iter().flatten();
    let peak_mb = peaks.reduce(f64::max);
    if verdict.is_honest() {
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
    key: RunKey,
    /// Of the last increment.
    verdict: Verdict,
    rows: Vec<RunRow>,
    increments: Vec<IncrementFound>,
    /// Of honest increments.
    states: Vec<ContactState>,
    snapshots: Vec<Snapshot>,
    accuracy: Accuracy,
}

fn first_pass(scene: &Scene<'_>, cell: &Cell, choice: &Choice) -> Pass {
    let accuracy = Accuracy::exactly(cell.tolerance);
    let mut pass = Pass {
        key: RunKey {
            case: cell.case.clone(),
            mesh: scene.body.label.clone(),
            space: scene.body.space.clone(),
            method: choice.label.clone(),
            friction: cell.mu(),
            increment: 1,
        },
        verdict: Verdict::Crashed("a load path without increments".into()),
        rows: Vec::new(),
        increments: Vec::new(),
        states: Vec::new(),
        snapshots: Vec::new(),
        accuracy,
    };
    let path = Path {
        case: scene.case,
        loading: &scene.loading,
        system: scene.system,
        choice,
        accuracy,
    };
    let mut key = pass.key.clone();
    let mut status: Option<Vec<PointStatus>> = None;
    path.follow(&mut key, &mut |_, ended| {
        pass.increments.push(increment(&ended, status.as_deref()));
        if let (Some(judged), Some(now)) = (ended.answer, ended.now) {
            status = Some(judged.status.clone());
            pass.states.push(judged.outcome.state.clone());
            pass.snapshots.push(now.clone());
        }
        pass.verdict = ended.verdict;
        pass.rows.push(ended.run);
    });
    pass.key = key;
    pass
}

/// `before`: states of the points at the start; without one all are open.
fn increment(ended: &Ended<'_>, before: Option<&[PointStatus]>) -> IncrementFound {
    let mut row = IncrementFound {
        verdict: ended.verdict.to_string(),
        ..IncrementFound::default()
    };
    let Some(judged) = ended.answer else {
        return row;
    };
    let began = |point: usize| before.map_or(PointStatus::Open, |before| before[point]);
    let status = judged.status.iter().enumerate();
    let counters = &judged.outcome.counters;
    row.natural_map = Some(judged.found.natural_map).filter(|map| map.is_finite());
    row.iterations = counters.iterations;
    row.solves = counters.solves;
    row.tangent_factorisations = counters.factorisations;
    row.global_factorisations = counters.global_factorisations;
    row.local_solves = counters.local_solves;
    row.state_changes = judged.outcome.history.iter().map(|i| i.changes).sum();
    row.final_changes = status.filter(|(i, now)| **now != began(*i)).count();
    row
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
    let loads: Vec<Load> = (0..=pass.states.len())
        .map(|increment| match increment {
            0 => Load::zero(system.elastic()),
            _ => scene.loading.at(increment),
        })
        .collect();
    let rest = ContactState::zero(system);
    let (mut preparing, mut solving) = (Vec::new(), Vec::new());
    let clock = Instant::now();
    while !repeats.enough(solving.len(), clock.elapsed().as_secs_f64()) {
        let (mut method, prepare_s) = prepare(choice, system)?;
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
            let (outcome, solve_s) = solve(method.as_mut(), &problem);
            total_s += solve_s;
            let again = outcome.map_err(|e| Verdict::failed(e.to_string()))?.state;
            if again != *first {
                let message = "the same increment gave other bits when it was solved again";
                return Err(Verdict::Crashed(message.into()));
            }
        }
        preparing.push(prepare_s);
        solving.push(total_s);
    }
    Ok(Timing::of(&preparing).zip(Timing::of(&solving)))
}

/// Seconds to gather the tables and fields of an increment.
fn output(scene: &Scene<'_>, key: &RunKey, now: &Snapshot) -> f64 {
    let clock = Instant::now();
    let rows = quantity_rows(scene.case, scene.body, key, now);
    let points = point_rows(scene.body, key, now);
    let fields = field_step(scene.body, now);
    std::hint::black_box((rows, points, fields));
    clock.elapsed().as_secs_f64()
}

fn size(scene: &Scene<'_>) -> ProblemSize {
    let Scene {
        case, body, system, ..
    } = scene;
    ProblemSize {
        mesh: body.label.clone(),
        space: body.space.clone(),
        h_m: case.mesh.grid.refined(scene.refine).cell_size(),
        dim: body.mesh.dim(),
        dofs: body.elastic.unknowns(),
        points: body.points.len(),
        unknowns: system.rows(),
    }
}
