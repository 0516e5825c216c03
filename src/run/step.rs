//! One increment of one run: solved by a method, checked by the judge, written into the rows of the tables.

use stickslip_methods::{ContactSystem, Enforcement, Increment, Iteration};

use crate::model::body::Setup;
use crate::run::attempt::{Judged, attempt, prepare};
use crate::run::choice::Choice;
use crate::run::record::{HistoryRow, RunKey, RunRow, SCHEMA, recorded_iterations};
use crate::run::verdict::{Accuracy, Verdict};

/// A method prepared for one system.
pub struct Solver<'a> {
    system: &'a ContactSystem,
    setup: Setup,
    accuracy: Accuracy,
    method: Box<dyn Enforcement>,
    prepare_s: f64,
}

/// What became of an increment.
pub struct Step {
    /// Row of `runs.csv`.
    pub run: RunRow,
    /// Rows of `history.csv`, a long history thinned.
    pub history: Vec<HistoryRow>,
    /// The judgement.
    pub verdict: Verdict,
    /// Answer of the method, judged; `None` if it failed with an error.
    pub answer: Option<Judged>,
}

impl<'a> Solver<'a> {
    /// Builds and prepares a method; the row of a run that cannot start otherwise.
    pub fn prepare(
        choice: &Choice,
        system: &'a ContactSystem,
        setup: Setup,
        accuracy: Accuracy,
        key: &RunKey,
    ) -> Result<Self, Box<Step>> {
        prepare(choice, system)
            .map(|(method, prepare_s)| Self {
                system,
                setup,
                accuracy,
                method,
                prepare_s,
            })
            .map_err(|verdict| {
                let mut run = row(key, system, setup, accuracy);
                run.prepare_s = f64::NAN;
                run.verdict = verdict.to_string();
                Box::new(Step {
                    run,
                    history: Vec::new(),
                    verdict,
                    answer: None,
                })
            })
    }

    /// Solves and judges one increment.
    pub fn solve(&mut self, key: &RunKey, increment: &Increment<'_>) -> Step {
        let system = self.system;
        let tried = attempt(self.method.as_mut(), increment, self.accuracy.accepted);
        let mut run = row(key, system, self.setup, self.accuracy);
        // Paid once, so counted with the first increment.
        run.prepare_s = std::mem::take(&mut self.prepare_s);
        let shared = system.elastic().timings();
        run.factorisations = system.elastic().counters().factorisations;
        run.factorisation_s = shared.analysis_s + shared.factorisation_s;
        run.condensation_s = shared.condensation_s;
        if self.method.needs().traction {
            run.condensation_s += shared.traction_s;
        }
        run.solve_s = tried.solve_s;
        let verdict = tried.verdict;
        let Some(judged) = tried.judged else {
            run.verdict = verdict.to_string();
            run.forget_times();
            return Step {
                run,
                history: Vec::new(),
                verdict,
                answer: None,
            };
        };
        record(&mut run, &verdict, &judged);
        Step {
            run,
            history: history_rows(key, &judged.outcome.history),
            verdict,
            answer: Some(judged),
        }
    }
}

fn history_rows(key: &RunKey, history: &[Iteration]) -> Vec<HistoryRow> {
    let Some(last) = history.len().checked_sub(1) else {
        return Vec::new();
    };
    let row = |iteration: usize| HistoryRow {
        key: key.clone(),
        iteration,
        natural_map: history[iteration].natural_map,
    };
    recorded_iterations(last).into_iter().map(row).collect()
}

fn row(key: &RunKey, system: &ContactSystem, setup: Setup, accuracy: Accuracy) -> RunRow {
    RunRow {
        key: key.clone(),
        tier: accuracy.to_string(),
        verdict: String::new(),
        natural_map: f64::NAN,
        iterations: 0,
        factorisations: 0,
        solves: 0,
        unknowns: system.rows(),
        points: system.points(),
        dofs: system.elastic().unknowns(),
        setup_s: setup.setup_s,
        assembly_s: setup.assembly_s,
        factorisation_s: f64::NAN,
        condensation_s: f64::NAN,
        prepare_s: 0.0,
        solve_s: f64::NAN,
        equilibrium: f64::NAN,
        claimed_equilibrium: f64::NAN,
        claimed: f64::NAN,
        tangent_factorisations: 0,
        global_factorisations: 0,
        local_solves: 0,
        schema: SCHEMA,
    }
}

fn record(run: &mut RunRow, verdict: &Verdict, judged: &Judged) {
    let Judged { outcome, found, .. } = judged;
    run.verdict = verdict.to_string();
    run.natural_map = found.natural_map;
    run.equilibrium = found.equilibrium;
    run.claimed_equilibrium = found.claimed_equilibrium;
    run.claimed = found.claimed;
    run.iterations = outcome.counters.iterations;
    run.solves = outcome.counters.solves;
    run.tangent_factorisations = outcome.counters.factorisations;
    run.global_factorisations = outcome.counters.global_factorisations;
    run.local_solves = outcome.counters.local_solves;
    if !verdict.is_honest() {
        run.forget_times();
    }
}
