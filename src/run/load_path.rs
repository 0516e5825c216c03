//! The load path of one run: increment after increment, each from the state in which the one before ended.

use stickslip_methods::{ContactState, ContactSystem, Increment, guess};

use crate::case::Case;
use crate::model::body::{Body, BodyError};
use crate::model::loading::Loading;
use crate::model::quantities::Snapshot;
use crate::run::choice::Choice;
use crate::run::increment::{JudgedIncrement, Solver};
use crate::run::record::{RunKey, RunRow};
use crate::run::verdict::{Accuracy, Verdict};

/// A body with its contact system at one friction, and what acts on it: what all methods share.
pub struct Posed<'a> {
    /// The case.
    pub case: &'a Case,
    /// What acts on the body.
    pub loading: Loading<'a>,
    /// The contact system.
    pub system: ContactSystem,
    /// Friction coefficient that names the runs: that of the first crack, 0 without cracks.
    pub friction: f64,
}

impl<'a> Posed<'a> {
    /// `friction`: coefficient of every crack.
    ///
    /// # Errors
    /// Coefficients that the system or the closed form of the case refuses.
    pub fn new(body: &'a Body, case: &'a Case, friction: &[f64]) -> Result<Self, BodyError> {
        let of_point = body.points.iter().map(|p| friction[p.crack]).collect();
        let system = ContactSystem::new(body.elastic.clone(), of_point)?;
        let first = friction.first().copied().unwrap_or(0.0);
        Ok(Self {
            case,
            loading: Loading::new(body, case, first)?,
            system,
            friction: first,
        })
    }

    /// The run of a method.
    pub fn run(&'a self, choice: &'a Choice, accuracy: Accuracy) -> LoadPathRun<'a> {
        LoadPathRun {
            case: self.case,
            loading: &self.loading,
            system: &self.system,
            friction: self.friction,
            choice,
            accuracy,
            guess: Guess::Before,
        }
    }
}

/// One run before it starts.
#[derive(Clone, Copy)]
pub struct LoadPathRun<'a> {
    /// What is run.
    pub case: &'a Case,
    /// Its discretisation, and what acts on it at this friction.
    pub loading: &'a Loading<'a>,
    /// The contact system on it, with the friction coefficients.
    pub system: &'a ContactSystem,
    /// Friction coefficient that names the run.
    pub friction: f64,
    /// Method.
    pub choice: &'a Choice,
    /// Accuracy asked for.
    pub accuracy: Accuracy,
    /// Contact forces that methods begin every increment from.
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

/// Is shown an increment, with the mechanics at its end where the verdict is honest.
pub type Witness<'a> = dyn FnMut(&RunKey, &JudgedIncrement, Option<&Snapshot>) + 'a;

/// How a load path ended.
pub struct PathEnd {
    /// The last increment that was tried.
    pub key: RunKey,
    /// False if the method declined the system or failed before the first increment.
    pub started: bool,
    /// Its verdict.
    pub verdict: Verdict,
    /// The mechanics at its end, of an honest verdict only.
    pub now: Option<Snapshot>,
}

impl LoadPathRun<'_> {
    /// Names an increment.
    pub fn key(&self, increment: usize) -> RunKey {
        let body = self.loading.body();
        RunKey {
            case: self.case.name.clone(),
            mesh: body.label.clone(),
            space: body.space.clone(),
            method: self.choice.label.clone(),
            friction: self.friction,
            increment,
        }
    }

    /// Row of `runs.csv`.
    pub fn row(&self, key: &RunKey, increment: &JudgedIncrement, now: Option<&Snapshot>) -> RunRow {
        let body = self.loading.body();
        let row = increment.run_row(key, self.system, body.setup, self.accuracy);
        RunRow {
            uniform_stress: body.checks.uniform,
            overlap_m: now.map_or(f64::NAN, Snapshot::deepest_overlap),
            ..row
        }
    }

    /// Follows the path, up to the first increment whose algebra the judge does not vouch for: what came after would start
    /// from nothing. On a suspect mesh it goes on, every increment with that verdict. `each` is shown every increment, with
    /// the mechanics at its end where the algebra is vouched for.
    pub fn follow(&self, each: &mut Witness<'_>) -> PathEnd {
        self.follow_to(self.case.path.increments, each)
    }

    /// As [`follow`](Self::follow), no farther than an increment.
    pub fn follow_to(&self, last: usize, each: &mut Witness<'_>) -> PathEnd {
        let Self {
            loading,
            system,
            choice,
            accuracy,
            ..
        } = *self;
        let body = loading.body();
        let mut end = PathEnd {
            key: self.key(loading.first()),
            started: true,
            verdict: Verdict::Crashed("a load path without increments".into()),
            now: None,
        };
        let mut solver = match Solver::new(choice, system) {
            Ok(solver) => solver,
            Err(verdict) => {
                let only = JudgedIncrement::not_started(verdict);
                each(&end.key, &only, None);
                (end.started, end.verdict) = (false, only.verdict);
                return end;
            }
        };
        let rest = ContactState::zero(system);
        let mut state = rest.clone();
        let mut before = Snapshot::virgin(body);
        let mut start_load = loading.before(loading.first());
        for increment in loading.first()..=last {
            end.key.increment = increment;
            if let Some(now) = end.now.take() {
                before = now;
            }
            let load = loading.at(increment);
            let mut problem = Increment {
                system,
                load: &load,
                start_load: &start_load,
                start: &state,
                guess: None,
                index: increment - loading.first(),
                tolerance: accuracy.asked,
            };
            let start = match self.guess {
                Guess::Before => None,
                Guess::Cold => Some(rest.p.clone()),
                Guess::Further(number) => guess(&problem, number).ok().flatten(),
            };
            problem.guess = start.as_deref();
            let mut solved = solver.judge(&problem, accuracy.accepted);
            end.now = solved.honest().map(|judged| {
                Snapshot::new(
                    loading,
                    increment,
                    &judged.outcome.state,
                    judged.consistency.as_deref(),
                    judged.status.clone(),
                    system.friction(),
                    &before,
                )
            });
            if let Some(what) = end.now.as_ref().and_then(Snapshot::not_finite) {
                solved.verdict = Verdict::Crashed(format!("{what} of the answer are not finite"));
                end.now = None;
            }
            // The mechanics stay visible: what is suspect can be looked at. That a method gave up there is no fault of its own.
            let gave_up = matches!(solved.verdict, Verdict::GaveUp(_));
            if let Some(judged) =
                (solved.judged.as_ref()).filter(|_| gave_up || solved.verdict.is_honest())
                && let Some(reason) = body.suspect(judged.found.sway)
            {
                solved.verdict = Verdict::Suspect(reason);
            }
            each(&end.key, &solved, end.now.as_ref());
            end.verdict = solved.verdict;
            match solved.judged.filter(|_| end.now.is_some()) {
                Some(judged) => state = judged.outcome.state,
                None => break,
            }
            start_load = load;
        }
        end
    }
}
