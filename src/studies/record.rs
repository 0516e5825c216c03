//! The record of a task: what was asked, what was found, what was spent.
//!
//! The findings are a function of the task and the program alone; the costs belong to the machine and the moment.
//! The two are kept apart, so that a rerun can be compared bit by bit. Numbers that do not exist are NaN, in a file `null`.

use serde::{Deserialize, Serialize};
use stickslip_methods::{PointStatus, Residuals};

use crate::files::nan;
use crate::model::errors::Deviation;
use crate::model::quantities::{EXACT, Quantity};
use crate::model::resolution::Coarse;
use crate::model::snapshot::Snapshot;
use crate::run::judged::{JudgedIncrement, Seconds, Work};
use crate::run::verdict::Verdict;
use crate::studies::exchange::problem_file::OperatorSize;
use crate::studies::followed::Value;
use crate::studies::origin::{Limits, Origin};
use crate::studies::statistics::{Timing, larger};
use crate::studies::stress::check::Check;
use crate::studies::stress::energy::Joined;
use crate::studies::stress::twin::Change;
use crate::studies::task::{Asked, Looks, Task};
use crate::studies::why::Explanation;
use crate::studies::why::stopping::Stop;

/// A task, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// [`Asked::id`].
    pub id: String,
    /// The task.
    pub asked: Asked,
    /// Its group, for statistics; empty: none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub class: String,
    /// Further looks.
    pub looks: Looks,
    /// By which program on which machine.
    pub origin: Origin,
    /// Limits that ended it, where the verdict is `timed-out` or `out-of-memory`: it says something about them alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
    /// The result; the same on every run of the same program, but for limits.
    pub found: Found,
    /// Times and memory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spent: Option<Spent>,
    /// The same asked for the accuracy of the case, where the error of the mesh decides.
    #[serde(skip)]
    pub beside: Option<Box<Record>>,
}

impl Record {
    /// Findings and costs of this program on this machine, under no limits.
    pub fn here(task: &Task, found: Found, spent: Option<Spent>) -> Self {
        Self::by(&Origin::here(), task, found, spent)
    }

    /// Findings and costs of a program on a machine, under no limits.
    pub fn by(origin: &Origin, task: &Task, found: Found, spent: Option<Spent>) -> Self {
        Self {
            id: task.id(),
            asked: task.asked.clone(),
            class: task.class.clone(),
            looks: task.looks,
            origin: origin.clone(),
            limits: None,
            found,
            spent,
            beside: None,
        }
    }

    /// Relative error of the mesh in the energy norm at the end of the path with its kind.
    pub fn discretisation_error(&self) -> Option<(f64, &str)> {
        let energy = |d: &&Deviation| d.quantity == "energy" && d.at.is_empty();
        let exact = self.found.deviations.iter().find(energy);
        let estimate = self.found.energy_error.as_ref();
        exact
            .map(|own| (own.error, EXACT))
            .or_else(|| estimate.map(|(error, kind)| (*error, kind.as_str())))
    }

    /// Keeps what was to be looked at: more was gathered on the way.
    pub fn keep(&mut self, looks: Looks) {
        if !looks.quantities {
            let steps = self.found.increments.iter_mut();
            steps.for_each(|step| step.quantities.clear());
        }
        self.looks = looks;
    }

    /// Whether the method did what it claims, on every increment and as far as the record itself can tell.
    pub fn is_honest(&self) -> bool {
        let found = &self.found;
        let verdicts = found.increments.iter().map(|i| &i.verdict);
        let mut all = verdicts.chain([&found.verdict]);
        // NaN passes no comparison.
        let agrees = |verdict: &Verdict| match verdict {
            Verdict::Solved | Verdict::Several => found.violation() <= self.asked.tolerance,
            other => other.is_honest() && found.violation().is_finite(),
        };
        !found.increments.is_empty() && all.all(agrees)
    }
}

/// The result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Claim × check over the whole load path: that of the last increment, which is the first that is not honest.
    pub verdict: Verdict,
    /// Label of the method in tables.
    pub method: String,
    /// Whether the limit of the method are the contact laws.
    pub exact: bool,
    /// The discrete problem; absent where it ended before that was known.
    pub problem: Option<ProblemSize>,
    /// Increment by increment.
    pub increments: Vec<Step>,
    /// Distance from the converged solution of the same discrete problem; absent without an honest verdict or reference.
    pub solver_error: Option<SolverError>,
    /// Distance from the closed form; empty where the case has none, or without an honest verdict.
    pub deviations: Vec<Deviation>,
    /// Quantities of interest at the end of the path; empty without an honest verdict.
    pub values: Vec<Value>,
    /// Relative error of the mesh in the energy norm with its kind, where a second mesh was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy_error: Option<(f64, String)>,
    /// Cracks for which the cells are too coarse.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub coarse: Vec<Coarse>,
    /// Why it gave up, where that was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<Explanation>,
    /// Where published stopping tests would have ended it, where that was asked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<Stop>,
    /// Result of the independent check of the answer, where that was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<Check>,
    /// Change by the view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<Change>,
}

/// Size of a discrete problem.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ProblemSize {
    /// Mesh label, e.g. `22x22`.
    pub mesh: String,
    /// Contact space with its marks, as in `runs.csv`.
    pub space: String,
    /// Largest distance of neighbouring grid lines [m]; 0 of a problem file.
    pub h_m: f64,
    /// Dimension of the body.
    pub dim: usize,
    /// Free displacement unknowns.
    pub dofs: usize,
    /// Contact points.
    pub points: usize,
    /// Contact unknowns.
    pub unknowns: usize,
    /// Residual of uniform stress states on the mesh, found by its judge [-].
    #[serde(default = "nan::nothing", with = "nan")]
    pub uniform_stress: f64,
    /// Ends and bends of cracks that were joined with what they nearly touch.
    #[serde(default)]
    pub joined: Vec<Joined>,
    /// How far cracks were moved to what they nearly touch, at most, in shortest edges; joined ends apart.
    #[serde(default)]
    pub moved: f64,
    /// Whether every contact point alone has exactly one solution; absent where nobody asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unique: Option<bool>,
    /// The operator of a problem file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operator: Option<OperatorSize>,
}

/// One increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Its number, from 1; 0: the state at time 0, where something acts then.
    pub increment: usize,
    /// Its verdict.
    pub verdict: Verdict,
    /// Iterations of the method.
    pub iterations: usize,
    /// Solves with the factor of K.
    pub solves: usize,
    /// Dense factorisations of condensed matrices.
    pub tangent_factorisations: usize,
    /// Sparse factorisations over all unknowns.
    pub global_factorisations: usize,
    /// Evaluations of the contact law at one point.
    pub local_solves: usize,
    /// Findings of the judge.
    #[serde(flatten)]
    pub judge: Judge,
    /// Deepest overlap of the faces anywhere, sampled much closer than the contact points [m].
    #[serde(default = "nan::nothing", with = "nan")]
    pub overlap_m: f64,
    /// Changes of a point between open, stick and slip from iterate to iterate, summed.
    pub state_changes: usize,
    /// Contact points that end in another state than the one they began the increment in.
    pub final_changes: usize,
    /// Points that the method found open, sticking and slipping.
    pub states: [usize; 3],
    /// Quantities of interest, where they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quantities: Vec<Quantity>,
}

/// Findings of the judge on an increment; NaN where there was nothing to judge. See [`Residuals`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "as in `Residuals`")]
pub struct Judge {
    #[serde(with = "nan")]
    pub natural_map: f64,
    #[serde(with = "nan")]
    pub violation: f64,
    #[serde(with = "nan")]
    pub equilibrium: f64,
    #[serde(with = "nan")]
    pub claimed_equilibrium: f64,
    #[serde(with = "nan")]
    pub claimed: f64,
    #[serde(with = "nan")]
    pub penetration: f64,
    #[serde(with = "nan")]
    pub adhesion: f64,
    #[serde(with = "nan")]
    pub complementarity: f64,
    #[serde(with = "nan")]
    pub cone: f64,
    #[serde(with = "nan")]
    pub reference_force: f64,
    #[serde(with = "nan")]
    pub reference_jump_m: f64,
    #[serde(with = "nan")]
    pub sway: f64,
}

impl Judge {
    /// `None`: there was nothing to judge.
    pub fn of(found: Option<&Residuals>) -> Self {
        let number = |of: fn(&Residuals) -> f64| found.map_or(f64::NAN, of);
        Self {
            natural_map: number(|f| f.natural_map),
            violation: number(|f| f.violation),
            equilibrium: number(|f| f.equilibrium),
            claimed_equilibrium: number(|f| f.claimed_equilibrium),
            claimed: number(|f| f.claimed),
            penetration: number(|f| f.penetration),
            adhesion: number(|f| f.adhesion),
            complementarity: number(|f| f.complementarity),
            cone: number(|f| f.cone),
            reference_force: number(|f| f.reference_force),
            reference_jump_m: number(|f| f.reference_jump),
            sway: number(|f| f.sway),
        }
    }
}

impl Step {
    /// `before`: states of the points at the start, without which all are open. `now`: the mechanics at the end, of an honest
    /// verdict.
    pub fn of(
        increment: usize,
        solved: &JudgedIncrement,
        before: Option<&[PointStatus]>,
        now: Option<&Snapshot>,
    ) -> Self {
        let judged = solved.judged.as_ref();
        let counters = judged.map(|j| j.outcome.counters).unwrap_or_default();
        let history = judged.map_or(&[][..], |j| &j.outcome.history);
        let status = judged.map_or(&[][..], |j| &j.status);
        let began = |point: usize| before.map_or(PointStatus::Open, |before| before[point]);
        let moved = status
            .iter()
            .enumerate()
            .filter(|(i, now)| **now != began(*i));
        let count = |of| status.iter().filter(|own| **own == of).count();
        Self {
            increment,
            verdict: solved.verdict.clone(),
            iterations: counters.iterations,
            solves: counters.solves,
            tangent_factorisations: counters.factorisations,
            global_factorisations: counters.global_factorisations,
            local_solves: counters.local_solves,
            judge: Judge::of(judged.map(|j| &j.found)),
            overlap_m: now.map_or(f64::NAN, |now| now.largest()[0]),
            state_changes: history.iter().map(|i| i.changes).sum(),
            final_changes: moved.count(),
            states: [PointStatus::Open, PointStatus::Stick, PointStatus::Slip].map(count),
            quantities: Vec::new(),
        }
    }
}

/// Distance from the converged solution of the same discrete problem: the largest over the increments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolverError {
    /// Method that found the converged solution.
    pub reference: String,
    /// Its natural map, the largest over the increments [-].
    pub reference_natural_map: f64,
    /// ‖u − u*‖_K / ‖u*‖_K [-].
    pub energy: f64,
    /// |P − P*| / |P*| [-].
    pub force: f64,
    /// max |[[u]] − [[u]]*| / max |u*| [-].
    pub jump: f64,
}

/// Times and memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Mesh, cracks, sparsity pattern and elimination order [s]. This and the next three are measured once per body.
    pub setup_s: f64,
    /// Assembly of K [s].
    pub assembly_s: f64,
    /// Factorisation of K [s].
    pub factorisation_s: f64,
    /// Condensation to the contact points [s].
    pub condensation_s: f64,
    /// Factorisations of K so far, by all that used the body before.
    pub factorisations: usize,
    /// Preparation of the method.
    pub prepare: Timing,
    /// All increments of the path.
    pub solve: Timing,
    /// Its part without load solves, recovery of displacements and checks of equilibrium.
    pub enforcement: Timing,
    /// Enforcement by the account of a program from outside, where it gives one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reported: Option<Timing>,
    /// Of one pass, by increment.
    pub steps: Vec<Seconds>,
    /// Tables and fields of the last increment, in memory [s].
    #[serde(default = "nan::nothing", with = "nan")]
    pub output_s: f64,
    /// Largest resident memory of the process from the mesh to the end of the repeats [MB]; absent where the system does
    /// not tell.
    pub peak_mb: Option<f64>,
}

/// Times of a method, taken in turn with others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// As in [`Spent`].
    pub prepare: Timing,
    /// As in [`Spent`].
    pub solve: Timing,
    /// As in [`Spent`].
    pub enforcement: Timing,
    /// As in [`Spent`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reported: Option<Timing>,
}

impl Spent {
    /// Times of one pass, given what its last increment shared and what every increment took; none where a method never
    /// started. `setup_s`, `assembly_s`: those of the body.
    pub fn of([setup_s, assembly_s]: [f64; 2], work: &[Work]) -> Option<Self> {
        let last = work.last()?;
        let sum = |of: fn(&Work) -> f64| Timing::of(&[work.iter().map(of).sum()]);
        Some(Self {
            setup_s,
            assembly_s,
            factorisation_s: last.factorisation_s,
            condensation_s: last.condensation_s,
            factorisations: last.factorisations,
            prepare: sum(|work| work.prepare_s)?,
            solve: sum(|work| work.solve.total_s)?,
            enforcement: sum(|work| work.solve.enforcement_s)?,
            reported: sum(|work| work.solve.reported_s.unwrap_or(f64::NAN)),
            steps: work.iter().map(|work| work.solve).collect(),
            output_s: f64::NAN,
            peak_mb: None,
        })
    }
}

impl Record {
    /// The record with times in place of those of one pass; a method that broke on the way has none.
    pub fn retimed(mut self, times: Result<Times, Verdict>) -> Self {
        match times {
            Ok(times) => {
                if let Some(spent) = &mut self.spent {
                    spent.prepare = times.prepare;
                    spent.solve = times.solve;
                    spent.enforcement = times.enforcement;
                    spent.reported = times.reported;
                    // Of one increment the fastest.
                    if let [step] = &mut spent.steps[..] {
                        step.total_s = times.solve.min_s;
                        step.enforcement_s = times.enforcement.min_s;
                        step.reported_s = times.reported.map(|own| own.min_s);
                    }
                }
            }
            Err(verdict) => {
                let Found { method, exact, .. } = self.found;
                (self.found, self.spent) = (Found::only(verdict, method, exact), None);
            }
        }
        self
    }
}

impl Found {
    /// Why it gave up, as tables name it; empty where nobody asked.
    pub fn cause(&self) -> &'static str {
        let why = self.why.as_ref();
        why.map_or("", |why| why.diagnosis.cause.name())
    }

    /// A task of which only the verdict is known.
    pub fn only(verdict: Verdict, method: String, exact: bool) -> Self {
        Self {
            verdict,
            method,
            exact,
            problem: None,
            increments: Vec::new(),
            solver_error: None,
            deviations: Vec::new(),
            values: Vec::new(),
            energy_error: None,
            coarse: Vec::new(),
            why: None,
            stops: Vec::new(),
            check: None,
            change: None,
        }
    }

    /// Whether another record has the same bits: NaN is like NaN.
    pub fn same_bits(&self, other: &Self) -> bool {
        let text = |found| serde_json::to_string(found).ok();
        text(self) == text(other)
    }

    /// Largest natural map over the increments; NaN where one has none.
    pub fn natural_map(&self) -> f64 {
        self.worst(|i| i.judge.natural_map)
    }

    /// Largest violation over the increments; NaN where one has none.
    pub fn violation(&self) -> f64 {
        self.worst(|i| i.judge.violation)
    }

    fn worst(&self, of: fn(&Step) -> f64) -> f64 {
        self.increments.iter().map(of).fold(0.0, larger)
    }

    /// A counter summed over the increments.
    pub fn sum(&self, counter: fn(&Step) -> usize) -> usize {
        self.increments.iter().map(counter).sum()
    }
}
