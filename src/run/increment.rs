//! One method on one increment: prepared, solved, timed, judged, and written into the rows of the tables. Cases, files and
//! random studies go through here alike.

use std::time::Instant;

use stickslip_methods::{
    ContactSystem, Enforcement, Increment, MethodError, Monitor, Outcome, PointStatus, Residuals,
    Silent, Status, Tier, conic::no_equilibrium, consistency, point_status, residuals_of,
};

use crate::model::body::Setup;
use crate::run::choice::Choice;
use crate::run::record::{Answer, HistoryRow, RunKey, RunRow, SCHEMA, recorded_iterations};
use crate::run::verdict::{Accuracy, Verdict};

/// Seconds after which no further solution begins.
const REPEAT_S: f64 = 5.0;

/// What came of an increment.
pub struct JudgedIncrement {
    /// Claim × check.
    pub verdict: Verdict,
    /// Work up to its end; `None` if the method never started.
    pub work: Option<Work>,
    /// What was judged; `None` if the method never started or failed with an error.
    pub judged: Option<Judged>,
    /// `[[u]]` by contact row [m] of an answer that is solved at tier high: what lower tiers leave open is as large as what tells
    /// two answers apart.
    pub jump: Option<Vec<f64>>,
}

/// Work that led to an answer. The first three are shared by all runs on a body.
#[derive(Debug, Clone, Copy)]
pub struct Work {
    /// Factorisations of K so far.
    pub factorisations: usize,
    /// Analysis and factorisation of K [s].
    pub factorisation_s: f64,
    /// Condensation, for methods that need it with that of the traction operator [s].
    pub condensation_s: f64,
    /// Preparation of the method, counted with the first increment [s].
    pub prepare_s: f64,
    /// What the method took, without what it shares with others [s].
    pub solve: Seconds,
    /// Whether the traction operator was needed.
    pub traction: bool,
}

/// Seconds of a call, without the factorisation and condensation that all runs on a body share.
#[derive(Debug, Clone, Copy, Default)]
pub struct Seconds {
    /// All.
    pub total_s: f64,
    /// Enforcement: all but load solves, recovery of displacements and checks of equilibrium, which cost the same whatever
    /// the method.
    pub enforcement_s: f64,
    /// The same by the method's own account, where it runs outside and gives one.
    pub reported_s: Option<f64>,
}

/// An outcome with what the judge found.
pub struct Judged {
    /// As the method returned it.
    pub outcome: Outcome,
    /// Residuals of equilibrium, of the contact laws, and of the laws claimed.
    pub found: Residuals,
    /// Open, stick or slip, by point.
    pub status: Vec<PointStatus>,
    /// See [`consistency`].
    pub consistency: Option<Vec<f64>>,
}

/// A method prepared for one system.
pub struct Solver<'a> {
    system: &'a ContactSystem,
    method: Box<dyn Enforcement>,
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
            prepare_s: prepare.total_s,
        })
    }

    /// Solves an increment, unjudged: what the method returned and its seconds.
    pub fn solve(&mut self, increment: &Increment<'_>) -> (Result<Outcome, MethodError>, Seconds) {
        let solve = || self.method.solve(increment, &mut Silent);
        let (outcome, mut seconds) = timed(self.system, solve);
        seconds.reported_s = self.method.reported_s();
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
        self.judge_fastest(increment, accepted, 1)
    }

    /// The same, the time that of the fastest of so many solutions, or of as many as begin within five seconds: all give the
    /// same bits, the first one pays for cold caches.
    pub fn judge_fastest(
        &mut self,
        increment: &Increment<'_>,
        accepted: f64,
        repeats: usize,
    ) -> JudgedIncrement {
        let clock = Instant::now();
        let (solved, mut solve) = self.solve(increment);
        for _ in 1..repeats {
            if clock.elapsed().as_secs_f64() > REPEAT_S {
                break;
            }
            let (_, again) = self.solve(increment);
            if again.total_s < solve.total_s {
                solve = again;
            }
        }
        let judged = solved.and_then(|mut outcome| {
            // What nothing can balance is no fault of the method.
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

impl JudgedIncrement {
    /// The method declined the system or could not be prepared.
    pub fn not_started(verdict: Verdict) -> Self {
        Self {
            verdict,
            work: None,
            judged: None,
            jump: None,
        }
    }

    /// The answer, if it is what the method claims.
    pub fn honest(&self) -> Option<&Judged> {
        self.judged.as_ref().filter(|_| self.verdict.is_honest())
    }

    /// Row of `runs.csv`. Times of a run that started stand there beside an honest verdict only.
    pub fn run_row(
        &self,
        key: &RunKey,
        system: &ContactSystem,
        setup: Setup,
        accuracy: Accuracy,
    ) -> RunRow {
        let judged = self.judged.as_ref();
        let found =
            |residual: fn(&Residuals) -> f64| judged.map_or(f64::NAN, |j| residual(&j.found));
        let counters = judged.map(|j| j.outcome.counters).unwrap_or_default();
        let time = |of: fn(&Work) -> f64| self.work.as_ref().map_or(f64::NAN, of);
        let traction = self.work.is_some_and(|work| work.traction);
        let owed_s = if traction { setup.traction_s } else { 0.0 };
        let mut row = RunRow {
            key: key.clone(),
            tier: accuracy.to_string(),
            verdict: self.verdict.clone(),
            natural_map: found(|f| f.natural_map),
            violation: found(|f| f.violation),
            iterations: counters.iterations,
            factorisations: self.work.map_or(0, |work| work.factorisations),
            solves: counters.solves,
            unknowns: system.rows(),
            points: system.points(),
            dofs: system.elastic().unknowns(),
            setup_s: setup.setup_s + owed_s,
            assembly_s: setup.assembly_s,
            factorisation_s: time(|work| work.factorisation_s),
            condensation_s: time(|work| work.condensation_s),
            prepare_s: time(|work| work.prepare_s),
            solve_s: time(|work| work.solve.total_s),
            enforcement_s: time(|work| work.solve.enforcement_s),
            reported_s: time(|work| work.solve.reported_s.unwrap_or(f64::NAN)),
            equilibrium: found(|f| f.equilibrium),
            claimed_equilibrium: found(|f| f.claimed_equilibrium),
            claimed: found(|f| f.claimed),
            penetration: found(|f| f.penetration),
            adhesion: found(|f| f.adhesion),
            complementarity: found(|f| f.complementarity),
            cone: found(|f| f.cone),
            reference_force: found(|f| f.reference_force),
            reference_jump_m: found(|f| f.reference_jump),
            sway: found(|f| f.sway),
            uniform_stress: f64::NAN,
            overlap_m: f64::NAN,
            tangent_factorisations: counters.factorisations,
            global_factorisations: counters.global_factorisations,
            local_solves: counters.local_solves,
            schema: SCHEMA,
        };
        if self.work.is_some() && !self.verdict.is_honest() {
            row.forget_times();
        }
        row
    }

    /// The answer, to be told from others of the same problem.
    pub fn answer(&self, problem: String) -> Option<Answer> {
        Some(Answer {
            problem,
            jump: self.jump.clone()?,
            reference_jump: self.judged.as_ref()?.found.reference_jump,
        })
    }

    /// Rows of `history.csv`, a long history thinned.
    pub fn history_rows(&self, key: &RunKey) -> Vec<HistoryRow> {
        let history = self.judged.as_ref().map_or(&[][..], |j| &j.outcome.history);
        let Some(last) = history.len().checked_sub(1) else {
            return Vec::new();
        };
        let row = |iteration: usize| HistoryRow {
            key: key.clone(),
            iteration,
            violation: history[iteration].violation,
        };
        recorded_iterations(last).into_iter().map(row).collect()
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
