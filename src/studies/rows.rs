//! Rows of tables: views of what runs found, each with the name of its run.

use std::cmp::Ordering;

use serde::Serialize;

use crate::model::field_mesh::FieldStep;
use crate::model::quantities::{PointState, Quantity};
use crate::studies::record::{Record, Step};

/// Identity of a run; first columns of every table.
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
    /// Names an increment of a run.
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

    /// The problem that all methods solve: everything but the method.
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

/// One increment of one run.
#[derive(Debug, Clone)]
pub struct IncrementRow<'a> {
    /// Which run.
    pub key: RunKey,
    /// The run.
    pub record: &'a Record,
    /// The findings.
    pub step: &'a Step,
}

impl<'a> IncrementRow<'a> {
    /// Those of a run.
    pub fn of(record: &'a Record) -> impl Iterator<Item = Self> {
        let steps = record.found.increments.iter();
        steps.map(move |step| Self {
            key: RunKey::of(record, step.increment),
            record,
            step,
        })
    }
}

/// One row of `quantities.csv`.
#[derive(Debug, Clone)]
pub struct QuantityRow<'a> {
    /// Which run.
    pub key: RunKey,
    /// The findings.
    pub quantity: &'a Quantity,
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
pub struct PointRow<'a> {
    /// Which run.
    pub key: RunKey,
    /// The findings.
    pub point: &'a PointState,
}

/// A place along a crack of a closed form, 2D only: as a contact point of weight 1 by the method `exact`, so that its forces are
/// tractions [Pa].
#[derive(Debug, Clone, PartialEq)]
pub struct ExactPoint {
    /// Case, friction coefficient and increment; mesh and space are empty.
    pub key: RunKey,
    /// State of the closed form there.
    pub point: PointState,
}

/// The fields of one run: last increment at least, all increments for `.pvd`.
#[derive(Debug, Clone)]
pub struct RunFields<'a> {
    /// Which run; `increment` is the last one.
    pub key: RunKey,
    /// One entry per recorded increment.
    pub steps: &'a [FieldStep],
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
