//! Records as rows of the tables of a run.

use crate::studies::measure::Answer;
use crate::studies::record::{Record, Step};
use crate::studies::rows::{
    HistoryRow, PointRow, QuantityRow, Results, RunFields, RunKey, RunRow, recorded_iterations,
};

impl RunKey {
    /// Names an increment of a record.
    pub fn of(record: &Record, increment: usize) -> Self {
        let size = record.found.problem.as_ref();
        RunKey {
            case: record.asked.case.clone(),
            mesh: size.map_or_else(String::new, |size| size.mesh.clone()),
            space: size.map_or_else(String::new, |size| size.space.clone()),
            method: record.found.method.clone(),
            friction: record.asked.mu(),
            increment,
        }
    }
}

/// Adds the rows of a task.
pub fn add(results: &mut Results, answer: Answer) {
    let Answer {
        record,
        histories,
        points,
        fields,
        jumps,
        ..
    } = answer;
    let steps = &record.found.increments;
    let key = |step: &Step| RunKey::of(&record, step.increment);
    results.runs.extend(rows(&record));
    for (step, history) in steps.iter().zip(histories) {
        let Some(last) = history.len().checked_sub(1) else {
            continue;
        };
        let row = |iteration: usize| HistoryRow {
            key: key(step),
            iteration,
            violation: history[iteration],
        };
        results
            .history
            .extend(recorded_iterations(last).into_iter().map(row));
    }
    for step in steps {
        let row = |quantity| QuantityRow {
            key: key(step),
            quantity,
        };
        let own = step.quantities.iter().cloned();
        results.quantities.extend(own.map(row));
    }
    for (step, points) in steps.iter().zip(points) {
        let row = |point| PointRow {
            key: key(step),
            point,
        };
        results.points.extend(points.into_iter().map(row));
    }
    for jump in jumps {
        let problem = RunKey::of(&record, jump.increment).problem();
        results.answers.push((problem, jump));
    }
    if let (Some(why), Some(last)) = (&record.found.why, steps.last()) {
        let RunKey {
            case,
            mesh,
            method,
            friction,
            increment,
            ..
        } = key(last);
        let remark = format!("{case} {mesh} mu={friction} {method} increment {increment}");
        results
            .remarks
            .push(format!("{remark}: {}: {why}", record.found.verdict));
    }
    if let (Some(last), false) = (steps.last(), fields.is_empty()) {
        results.fields.push(RunFields {
            key: key(last),
            steps: fields,
        });
    }
}

/// Rows of `runs.csv`. Times stand beside an honest verdict only.
pub fn rows(record: &Record) -> Vec<RunRow> {
    let steps = record.found.increments.iter();
    steps
        .enumerate()
        .map(|(k, step)| row(record, k, step))
        .collect()
}

fn row(record: &Record, k: usize, step: &Step) -> RunRow {
    let spent = record.spent.as_ref();
    let time = |own: Option<f64>| own.unwrap_or(f64::NAN);
    let own = spent.and_then(|spent| spent.steps.get(k));
    let prepare_s = spent.map(|spent| spent.prepare.median_s);
    let mut row = RunRow {
        key: RunKey::of(record, step.increment),
        tier: record.asked.accuracy().to_string(),
        step: step.clone(),
        size: record.found.problem.clone().unwrap_or_default(),
        factorisations: spent.map_or(0, |spent| spent.factorisations),
        setup_s: time(spent.map(|spent| spent.setup_s)),
        assembly_s: time(spent.map(|spent| spent.assembly_s)),
        factorisation_s: time(spent.map(|spent| spent.factorisation_s)),
        condensation_s: time(spent.map(|spent| spent.condensation_s)),
        prepare_s: time(prepare_s.map(|all| if k == 0 { all } else { 0.0 })),
        solve_s: time(own.map(|own| own.total_s)),
        enforcement_s: time(own.map(|own| own.enforcement_s)),
        reported_s: time(own.and_then(|own| own.reported_s)),
    };
    if !step.verdict.is_honest() {
        row.forget_times();
    }
    row
}
