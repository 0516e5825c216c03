//! What a run leaves behind: the rows of the tables and the fields of the pictures.
//!
//! Runs fill these types, the report writes them, each as one CSV file (`docs/schema.md`).

use std::cmp::Ordering;

use serde::Serialize;

use crate::model::field_mesh::FieldStep;
use crate::model::quantities::{PointState, Quantity};
use crate::studies::record::{ProblemSize, Step};

/// What identifies a run; first columns of every table.
#[derive(Debug, Clone, PartialEq, PartialOrd, Serialize)]
pub struct RunKey {
    /// Case name.
    pub case: String,
    /// Mesh label, e.g. `22x22`.
    pub mesh: String,
    /// Contact space with its marks, e.g. `edge-pairs`, `edge-pairs/gauss-6`, `star/mean-dilatation`, `node-pairs`.
    pub space: String,
    /// Method label: registry name, with non-default options in brackets.
    pub method: String,
    /// Friction coefficient (of the first crack where cracks differ).
    pub friction: f64,
    /// Increment, from 1; 0: the state at time 0, where something acts then.
    pub increment: usize,
}

impl RunKey {
    /// What all methods solve: everything but the method.
    pub fn problem(&self) -> String {
        let RunKey {
            case,
            mesh,
            space,
            friction,
            increment,
            ..
        } = self;
        format!("{case} {mesh} {space} {friction:e} {increment}")
    }

    /// Order of runs: case, mesh, space, method (as text), friction, increment (as numbers).
    pub fn order(&self, other: &Self) -> Ordering {
        (&self.case, &self.mesh, &self.space, &self.method)
            .cmp(&(&other.case, &other.mesh, &other.space, &other.method))
            .then(self.friction.total_cmp(&other.friction))
            .then(self.increment.cmp(&other.increment))
    }
}

/// Of an increment that was solved at tier high: what tells it from another answer. Not written.
#[derive(Debug, Clone)]
pub struct Jump {
    /// Number of the increment.
    pub increment: usize,
    /// `[[u]]` by contact row [m].
    pub jump: Vec<f64>,
    /// u_ref [m].
    pub reference_jump: f64,
}

/// One row of `runs.csv`: one increment of one run.
#[derive(Debug, Clone)]
pub struct RunRow {
    /// Which run.
    pub key: RunKey,
    /// Requested tier: low, mid or high.
    pub tier: String,
    /// What was found.
    pub step: Step,
    /// What was solved.
    pub size: ProblemSize,
    /// Factorisations of K for this mesh up to this row (shared by all methods, friction values and increments).
    pub factorisations: usize,
    /// Mesh, cracks, sparsity pattern and elimination order, once per mesh [s].
    pub setup_s: f64,
    /// Assembly of K (cell matrices and their sum), once per mesh [s].
    pub assembly_s: f64,
    /// Factorisation of K, once per mesh [s].
    pub factorisation_s: f64,
    /// Condensation to W, once per mesh, for methods that need it with that of the traction operator [s].
    pub condensation_s: f64,
    /// Method's preparation [s].
    pub prepare_s: f64,
    /// Method's solve of this increment [s].
    pub solve_s: f64,
    /// Of these, without load solve, recovery of displacements and checks of equilibrium [s].
    pub enforcement_s: f64,
    /// The same by the account of a program from outside; NaN of all other methods [s].
    pub reported_s: f64,
}

impl RunRow {
    /// Erases the times: published only for honest verdicts of runs that had the machine to themselves.
    pub fn forget_times(&mut self) {
        for time in [
            &mut self.setup_s,
            &mut self.assembly_s,
            &mut self.factorisation_s,
            &mut self.condensation_s,
            &mut self.prepare_s,
            &mut self.solve_s,
            &mut self.enforcement_s,
            &mut self.reported_s,
        ] {
            *time = f64::NAN;
        }
    }
}

/// One row of `quantities.csv`.
#[derive(Debug, Clone)]
pub struct QuantityRow {
    /// Which run.
    pub key: RunKey,
    /// What was found.
    pub quantity: Quantity,
}

/// Iterations up to this one are all recorded.
const RECORDED_TO: usize = 100;

/// Which iterations of a history are recorded: all up to 100, then about 50 per decade, always the last. First-order
/// methods take thousands, of which no reader and no figure needs each. In whole numbers: the same on every machine.
pub fn recorded_iterations(last: usize) -> Vec<usize> {
    let mut recorded: Vec<usize> = (0..=last.min(RECORDED_TO)).collect();
    // 10^(1/50) = 1.0471285.
    let next = |iteration: usize| iteration + (iteration * 471_285 + 5_000_000) / 10_000_000;
    let mut iteration = next(RECORDED_TO);
    while iteration < last {
        recorded.push(iteration);
        iteration = next(iteration);
    }
    if last > RECORDED_TO {
        recorded.push(last);
    }
    recorded
}

/// One row of `history.csv`: one iteration of one increment; see [`recorded_iterations`].
#[derive(Debug, Clone)]
pub struct HistoryRow {
    /// Which run.
    pub key: RunKey,
    /// Iteration, from 0 (the start).
    pub iteration: usize,
    /// Largest violation of the contact laws by the iterate [-].
    pub violation: f64,
}

/// One row of `points.csv`: one contact point of one increment.
#[derive(Debug, Clone)]
pub struct PointRow {
    /// Which run.
    pub key: RunKey,
    /// What was found.
    pub point: PointState,
}

/// One row of `exact.csv`: the closed form of a case at a place along its crack; 2D only.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactRow {
    /// Case name.
    pub case: String,
    /// Friction coefficient.
    pub friction: f64,
    /// Increment, as in [`RunKey`].
    pub increment: usize,
    /// Crack number, from 1.
    pub crack: usize,
    /// Distance along the crack from its first point [m].
    pub s_m: f64,
    /// Position [m].
    pub x_m: f64,
    /// Position [m].
    pub y_m: f64,
    /// Normal gap, open > 0 [m].
    pub gap_m: f64,
    /// Tangential jump along a, total [m].
    pub slip_a_m: f64,
    /// Contact traction along n on side 1, compression > 0 [Pa].
    pub p_n_pa: f64,
    /// Contact traction along a on side 1 [Pa].
    pub p_a_pa: f64,
}

/// The fields of one run: last increment at least, all increments for `.pvd`.
#[derive(Debug, Clone)]
pub struct RunFields {
    /// Which run; `increment` is the last one.
    pub key: RunKey,
    /// One entry per recorded increment.
    pub steps: Vec<FieldStep>,
}

/// Verdict of a number within its tolerance.
pub const MET: &str = "met";
/// Verdict of a documented limitation.
pub const MISSED_AS_DOCUMENTED: &str = "missed as documented";

/// Outcome of one `[[expect]]` block for one run.
#[derive(Debug, Clone)]
pub struct ExpectRow {
    /// Which run.
    pub key: RunKey,
    /// Quantity.
    pub quantity: String,
    /// Place.
    pub at: String,
    /// Component.
    pub component: String,
    /// Expected.
    pub expected: f64,
    /// Found; NaN where the run has no such quantity.
    pub found: f64,
    /// Allowed |found − expected|.
    pub allowed: f64,
    /// Unit.
    pub unit: String,
    /// analytic, published, independent or snapshot.
    pub kind: String,
    /// Source.
    pub source: String,
    /// `met`, `missed`, `missed as documented` (a stated limitation) or `met against the documentation`.
    pub verdict: String,
}

/// Everything a command produced, before it is written.
#[derive(Debug, Clone, Default)]
pub struct Results {
    /// runs.csv
    pub runs: Vec<RunRow>,
    /// quantities.csv
    pub quantities: Vec<QuantityRow>,
    /// history.csv
    pub history: Vec<HistoryRow>,
    /// points.csv
    pub points: Vec<PointRow>,
    /// exact.csv
    pub exact: Vec<ExactRow>,
    /// expectations.csv
    pub expectations: Vec<ExpectRow>,
    /// Fields of selected runs.
    pub fields: Vec<RunFields>,
    /// Answers, to be told apart, with the problem of each.
    pub answers: Vec<(String, Jump)>,
    /// Why runs gave up and what to change, a line each; not written.
    pub remarks: Vec<String>,
}

impl Results {
    /// Adds the results of another run.
    pub fn append(&mut self, other: Results) {
        self.runs.extend(other.runs);
        self.quantities.extend(other.quantities);
        self.history.extend(other.history);
        self.points.extend(other.points);
        self.exact.extend(other.exact);
        self.expectations.extend(other.expectations);
        self.fields.extend(other.fields);
        self.answers.extend(other.answers);
        self.remarks.extend(other.remarks);
    }

    /// The part of these results that is about some cases.
    pub fn of_cases(&self, names: &[&str]) -> Self {
        fn part<R: Clone>(rows: &[R], wanted: impl Fn(&R) -> bool) -> Vec<R> {
            rows.iter().filter(|row| wanted(row)).cloned().collect()
        }
        let wanted = |name: &str| names.contains(&name);
        Self {
            runs: part(&self.runs, |row| wanted(&row.key.case)),
            quantities: part(&self.quantities, |row| wanted(&row.key.case)),
            history: part(&self.history, |row| wanted(&row.key.case)),
            points: part(&self.points, |row| wanted(&row.key.case)),
            exact: part(&self.exact, |row| wanted(&row.case)),
            expectations: part(&self.expectations, |row| wanted(&row.key.case)),
            fields: part(&self.fields, |run| wanted(&run.key.case)),
            answers: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// Number of runs that were to solve a case and did not, for whatever reason; declined ones are none of them.
    pub fn failures(&self) -> usize {
        self.runs
            .iter()
            .filter(|r| r.step.verdict.is_failure())
            .count()
    }

    /// True if no run failed and every expected number came out as stated: the exit code of what made these results.
    pub fn as_expected(&self) -> bool {
        self.failures() == 0 && self.expectations.iter().all(ExpectRow::as_stated)
    }
}

impl ExpectRow {
    /// True if the number came out as the case says it would.
    pub fn as_stated(&self) -> bool {
        [MET, MISSED_AS_DOCUMENTED].contains(&self.verdict.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: no short history loses an entry, every history keeps its first and last one, and a long one has about 50 per
    /// decade.
    #[test]
    fn long_histories_are_thinned_evenly() {
        for last in [0, 1, 57, 100] {
            assert_eq!(recorded_iterations(last), (0..=last).collect::<Vec<_>>());
        }
        for last in [101, 104, 105, 106, 999, 4232, 123_456] {
            let recorded = recorded_iterations(last);
            assert_eq!(recorded[..=100], (0..=100).collect::<Vec<_>>());
            assert_eq!(recorded.last(), Some(&last));
            assert!(recorded.windows(2).all(|pair| pair[0] < pair[1]), "{last}");
            // Gaps of 5 % of the number, in whole numbers.
            let gap = |pair: &[usize]| pair[1] - pair[0] <= pair[0] / 20 + 1;
            assert!(recorded.windows(2).all(gap), "{last}");
        }
        let recorded = recorded_iterations(100_000);
        for decade in [100, 1000, 10_000] {
            let within = recorded
                .iter()
                .filter(|i| (decade..10 * decade).contains(*i));
            let count = within.count();
            assert!((48..=52).contains(&count), "{count} from {decade}");
        }
    }
}
