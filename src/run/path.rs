//! One method along a load path: increment after increment, each from the state in which the one before ended, solved, timed and
//! judged. Cases, files and random problems go through here alike.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use stickslip_methods::{
    ContactState, ContactSystem, Enforcement, Increment, MethodError, Monitor, Outcome, Silent,
    Status, Tier, conic::no_equilibrium, consistency, guess, point_status, residuals_of,
};

use crate::model::loading::Loading;
use crate::model::snapshot::Snapshot;
use crate::run::choice::Choice;
use crate::run::judged::{Judged, JudgedIncrement, Seconds, Work};
use crate::run::loads::Posed;
use crate::run::verdict::{Accuracy, Verdict};

/// One run before it starts.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// The problem.
    pub posed: Posed<'a>,
    /// By which method.
    pub choice: &'a Choice,
    /// How accurately.
    pub accuracy: Accuracy,
    /// Contact forces that every increment begins from.
    pub guess: Guess,
}

/// Contact forces to begin an increment from: a guess, which is no part of the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guess {
    /// Those in which the increment before ended.
    Before,
    /// None.
    Cold,
    /// That of this number among the [`guess`]es that look for further solutions.
    Further(usize),
}

/// An increment, just judged.
pub struct Moment<'a, 's> {
    /// Its number.
    pub number: usize,
    /// The result.
    pub solved: &'a JudgedIncrement,
    /// The mechanics of a body at its end, of an honest verdict only.
    pub now: Option<&'a Snapshot>,
    /// The method and what it was asked; none if it never started.
    pub again: Option<(&'a mut Solver<'s>, &'a Increment<'a>)>,
}

/// How a load path ended.
pub struct PathEnd {
    /// The verdict on the last increment that was tried.
    pub verdict: Verdict,
    /// The mechanics of a body at its end, of an honest verdict only.
    pub now: Option<Snapshot>,
}

impl Run<'_> {
    /// Follows the path, up to the first increment whose algebra the judge does not vouch for: what came after would start
    /// from nothing. On a suspect mesh it goes on, every increment with that verdict. `each` is shown every increment.
    pub fn follow(&self, each: &mut dyn FnMut(Moment<'_, '_>)) -> PathEnd {
        self.follow_to(self.posed.loads.last(), each)
    }

    /// As [`follow`](Self::follow), no farther than an increment.
    pub fn follow_to(&self, last: usize, each: &mut dyn FnMut(Moment<'_, '_>)) -> PathEnd {
        let Posed { system, loads } = self.posed;
        let first = loads.first();
        let mut end = PathEnd {
            verdict: Verdict::Crashed("a load path without increments".into()),
            now: None,
        };
        let mut solver = match Solver::new(self.choice, system) {
            Ok(solver) => solver,
            Err(verdict) => {
                each(Moment {
                    number: first,
                    solved: &JudgedIncrement::not_started(verdict.clone()),
                    now: None,
                    again: None,
                });
                return PathEnd { verdict, now: None };
            }
        };
        let rest = ContactState::zero(system);
        let mut state = rest.clone();
        let mut before = loads.body().map(|loading| Snapshot::virgin(loading.body()));
        let mut start_load = loads.before();
        for number in first..=last {
            before = end.now.take().or(before);
            let load = loads.at(number);
            let mut problem = Increment {
                system,
                load: &load,
                start_load: &start_load,
                start: &state,
                guess: None,
                index: number - first,
                tolerance: self.accuracy.asked,
            };
            let start = match self.guess {
                Guess::Before => None,
                Guess::Cold => Some(rest.p.clone()),
                Guess::Further(number) => guess(&problem, number).ok().flatten(),
            };
            problem.guess = start.as_deref();
            let mut solved = solver.judge(&problem, self.accuracy.accepted);
            if let Some((loading, before)) = loads.body().zip(before.as_ref()) {
                end.now = with_mechanics(&mut solved, loading, number, system, before);
            }
            each(Moment {
                number,
                solved: &solved,
                now: end.now.as_ref(),
                again: Some((&mut solver, &problem)),
            });
            end.verdict = solved.verdict;
            let goes_on = end.now.is_some();
            match solved.judged.filter(|_| goes_on) {
                Some(judged) => state = judged.outcome.state,
                None => break,
            }
            start_load = load;
        }
        end
    }
}

/// The mechanics of a body at the end of an increment whose algebra is vouched for. The verdict becomes that of the mesh where
/// its judge doubts it.
fn with_mechanics(
    solved: &mut JudgedIncrement,
    loading: &Loading<'_>,
    increment: usize,
    system: &ContactSystem,
    before: &Snapshot,
) -> Option<Snapshot> {
    let now = solved.honest().map(|judged| {
        let (state, status) = (&judged.outcome.state, judged.status.clone());
        let consistency = judged.consistency.as_deref();
        let mu = system.friction();
        Snapshot::new(loading, increment, state, consistency, status, mu, before)
    });
    if let Some(what) = now.as_ref().and_then(Snapshot::not_finite) {
        solved.verdict = Verdict::Crashed(format!("{what} of the answer are not finite"));
        return None;
    }
    // The mechanics stay visible: what is suspect can be looked at. That a method gave up there is no fault of its own.
    let gave_up = matches!(solved.verdict, Verdict::GaveUp(_));
    if let Some(judged) = (solved.judged.as_ref()).filter(|_| gave_up || solved.verdict.is_honest())
        && let Some(reason) = loading.body().suspect(judged.found.sway)
    {
        solved.verdict = Verdict::Suspect(reason);
    }
    now
}

/// A method prepared for one system.
pub struct Solver<'a> {
    system: &'a ContactSystem,
    method: Box<dyn Enforcement>,
    /// Time for an increment [s], and what else ends it.
    seconds: f64,
    stop: Arc<AtomicBool>,
    /// Time the preparation took, until an increment counted it [s].
    pub prepare_s: f64,
}

impl<'a> Solver<'a> {
    /// Builds and prepares a method.
    ///
    /// # Errors
    /// The verdict on one that declines the system, or fails.
    pub fn new(choice: &Choice, system: &'a ContactSystem) -> Result<Self, Verdict> {
        let mut method = choice.build();
        if let Some(reason) = method.refuses(system) {
            return Err(Verdict::Refused(reason));
        }
        let (prepared, prepare) = timed(system, || method.prepare(system));
        prepared?;
        Ok(Self {
            system,
            method,
            seconds: choice.seconds,
            stop: choice.stop.clone(),
            prepare_s: prepare.total_s,
        })
    }

    /// Solves an increment, unjudged: what the method returned and its seconds.
    pub fn solve(&mut self, increment: &Increment<'_>) -> (Result<Outcome, MethodError>, Seconds) {
        self.solve_before(increment, &mut Silent)
    }

    /// The same before the eyes of a monitor, who may end it: a time limit of its own.
    fn solve_before(
        &mut self,
        increment: &Increment<'_>,
        eyes: &mut dyn Monitor,
    ) -> (Result<Outcome, MethodError>, Seconds) {
        // What every method and the judge begin with is no method's time; if it fails, so will they.
        let _ = self.system.elastic().free(&increment.load.force);
        let mut deadline = Deadline {
            begin: Instant::now(),
            seconds: self.seconds,
            stop: &self.stop,
            eyes,
        };
        let solve = || self.method.solve(increment, &mut deadline);
        let (outcome, mut seconds) = timed(self.system, solve);
        seconds.reported_s = self.method.reported_s();
        let outcome = outcome.and_then(|found| match found.status {
            Status::Stopped => Err(MethodError::TimeLimit),
            _ => Ok(found),
        });
        (outcome, seconds)
    }

    /// Solves an increment under the eyes of a monitor, unjudged and not timed.
    ///
    /// # Errors
    /// Input that no method could treat.
    pub fn watched(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        self.method.solve(increment, monitor)
    }

    /// Solves an increment and judges the outcome against the violation accepted.
    pub fn judge(&mut self, increment: &Increment<'_>, accepted: f64) -> JudgedIncrement {
        self.judge_before(increment, accepted, &mut Silent)
    }

    /// The same before the eyes of a monitor.
    pub fn judge_before(
        &mut self,
        increment: &Increment<'_>,
        accepted: f64,
        eyes: &mut dyn Monitor,
    ) -> JudgedIncrement {
        let (solved, solve) = self.solve_before(increment, eyes);
        let judged = solved.and_then(|mut outcome| {
            // A load that nothing can balance is no fault of the method.
            if outcome.status != Status::Converged && no_equilibrium(increment)? {
                outcome.status = Status::NoEquilibrium;
            }
            Ok(Judged {
                found: residuals_of(increment, &outcome.state, outcome.claim)?,
                status: point_status(increment, &outcome.state)?,
                consistency: consistency(increment, &outcome.state, outcome.claim)?,
                outcome,
            })
        });
        let (verdict, judged) = match judged {
            Ok(own) => (Verdict::of(&own.outcome, &own.found, accepted), Some(own)),
            Err(error) => (error.into(), None),
        };
        let answer = judged
            .as_ref()
            .filter(|_| verdict.is_solved() && accepted <= Tier::High.tolerance());
        let jump = answer.map(|own| increment.jump(&own.outcome.state.u));
        let elastic = self.system.elastic();
        let shared = elastic.timings();
        let traction = self.method.needs().traction;
        let traction_s = if traction { shared.traction_s } else { 0.0 };
        JudgedIncrement {
            verdict,
            work: Some(Work {
                factorisations: elastic.counters().factorisations,
                factorisation_s: shared.analysis_s + shared.factorisation_s,
                condensation_s: shared.condensation_s + traction_s,
                prepare_s: std::mem::take(&mut self.prepare_s),
                solve,
                traction,
            }),
            judged,
            jump,
        }
    }
}

/// Stops a method that takes more than so many seconds, or that somebody else stops.
struct Deadline<'a> {
    begin: Instant,
    seconds: f64,
    stop: &'a AtomicBool,
    eyes: &'a mut dyn Monitor,
}

impl Monitor for Deadline<'_> {
    fn step(&mut self, iteration: usize, violation: f64) -> bool {
        let goes_on = self.eyes.step(iteration, violation) && !self.stop.load(Ordering::Relaxed);
        goes_on && self.begin.elapsed().as_secs_f64() < self.seconds
    }
}

/// Calls something by the clock.
fn timed<T>(system: &ContactSystem, call: impl FnOnce() -> T) -> (T, Seconds) {
    let with_k = || {
        let t = system.elastic().timings();
        let shared = t.analysis_s + t.factorisation_s + t.condensation_s + t.traction_s;
        [shared, t.on_body_s]
    };
    let (before, clock) = (with_k(), Instant::now());
    let value = call();
    let elapsed = clock.elapsed().as_secs_f64();
    let after = with_k();
    let total_s = (elapsed - (after[0] - before[0])).max(0.0);
    let enforcement_s = (total_s - (after[1] - before[1])).max(0.0);
    let seconds = Seconds {
        total_s,
        enforcement_s,
        reported_s: None,
    };
    (value, seconds)
}
