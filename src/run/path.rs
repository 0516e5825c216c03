//! The load path of one run: increment after increment, each from the state in which the one before ended.

use stickslip_methods::{ContactState, ContactSystem, Increment, Load};

use super::attempt::Judged;
use super::record::{HistoryRow, RunKey, RunRow};
use super::step::Solver;
use super::verdict::{Accuracy, Verdict};
use crate::case::Case;
use crate::model::loading::Loading;
use crate::model::quantities::Snapshot;
use crate::run::choice::Choice;

/// One run before it starts.
#[derive(Clone, Copy)]
pub struct Path<'a> {
    /// What is run.
    pub case: &'a Case,
    /// Its discretisation, and what acts on it at this friction.
    pub loading: &'a Loading<'a>,
    /// The contact system on it, with the friction coefficients.
    pub system: &'a ContactSystem,
    /// Method.
    pub choice: &'a Choice,
    /// Accuracy asked for.
    pub accuracy: Accuracy,
}

/// What one increment left behind.
pub struct Ended<'a> {
    /// Row of `runs.csv`.
    pub run: RunRow,
    /// Rows of `history.csv`.
    pub history: Vec<HistoryRow>,
    /// The judgement.
    pub verdict: Verdict,
    /// The answer of the method, judged; `None` if it failed with an error.
    pub answer: Option<&'a Judged>,
    /// The mechanics, of an honest verdict only.
    pub now: Option<&'a Snapshot>,
}

impl Path<'_> {
    /// Follows the path, up to the first increment without an honest verdict: what came after would start from a state
    /// nobody vouches for. `key.increment` is that of the last one. False if the method declined the system or failed
    /// before the first increment.
    pub fn follow(&self, key: &mut RunKey, each: &mut dyn FnMut(&RunKey, Ended<'_>)) -> bool {
        let Path {
            case,
            loading,
            system,
            choice,
            accuracy,
        } = *self;
        let body = loading.body();
        key.increment = 1;
        let mut solver = match Solver::prepare(choice, system, body.setup, accuracy, key) {
            Ok(solver) => solver,
            Err(refused) => {
                let ended = Ended {
                    run: refused.run,
                    history: refused.history,
                    verdict: refused.verdict,
                    answer: None,
                    now: None,
                };
                each(key, ended);
                return false;
            }
        };
        let mut state = ContactState::zero(system);
        let mut now = Snapshot::virgin(body);
        // Nothing acts before the first increment, whatever the histories say at t = 0.
        let mut start_load = Load::zero(&body.elastic);
        for increment in 1..=case.path.increments {
            key.increment = increment;
            let load = loading.at(increment);
            let problem = Increment {
                system,
                load: &load,
                start_load: &start_load,
                start: &state,
                index: increment - 1,
                tolerance: accuracy.asked,
            };
            let step = solver.solve(key, &problem);
            let honest = step.answer.as_ref().filter(|_| step.verdict.is_honest());
            if let Some(judged) = honest {
                now = Snapshot::new(
                    loading,
                    increment,
                    &judged.outcome.state,
                    judged.consistency.as_deref(),
                    judged.status.clone(),
                    &now,
                );
            }
            let ended = Ended {
                now: honest.is_some().then_some(&now),
                run: step.run,
                history: step.history,
                answer: step.answer.as_ref(),
                verdict: step.verdict.clone(),
            };
            each(key, ended);
            match step.answer.filter(|_| step.verdict.is_honest()) {
                Some(judged) => state = judged.outcome.state,
                None => break,
            }
            start_load = load;
        }
        true
    }
}
