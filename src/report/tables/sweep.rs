//! The study of run time against error, cell by cell: what was found, and what it took.

use std::cmp::Ordering;

use super::words::*;
use crate::model::errors::Deviation;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::analysis::accuracy::sequences;
use crate::studies::analysis::{compare_methods, compare_problems, method_time, published_times};
use crate::studies::followed::Value;
use crate::studies::record::{ProblemSize, Record, SolverError, Spent, Step};
use crate::studies::statistics::Timing;
use crate::studies::task::Problem;

/// A row about a cell.
trait OfCell {
    fn record(&self) -> &Record;
}

/// The columns that name a cell, then those of the row.
fn of_cell<R: OfCell>(own: Vec<Column<R>>) -> Vec<Column<R>> {
    let mut columns = columns! { r: R,
        "id" "" = r.record().id.clone(), "stable name of the cell; joins the files of a study";
        "case" "" .shown() = r.record().asked.case.clone(), "case: a shipped one, a file, or a random problem";
        "refine" "" = r.record().asked.refine, "refinement factor of the mesh";
        "mesh" "" .shown() = size(r.record()).map_or("", |size| &size.mesh), "mesh label; empty where the cell ended before it had a mesh";
        "space" "" .shown() = size(r.record()).map_or(r.record().asked.space.as_deref().unwrap_or("own"), |size| &size.space), SPACE;
        "friction" "–" .named("μ") = r.record().asked.mu(), FRICTION;
        "parts" "" = r.record().asked.increments, "equal increments that each of the case's is divided in";
        "start" "" = if r.record().asked.cold { "cold" } else { "warm" }, "where methods begin an increment: from the contact forces at the end of the last one (`warm`), or from none (`cold`)";
        "method" "" .shown() = r.record().found.method.clone(), METHOD;
        "tolerance" "–" .shown() = r.record().asked.tolerance, "violation of the contact laws asked of the method and accepted by the judge";
    };
    columns.extend(own);
    columns
}

fn size(record: &Record) -> Option<&ProblemSize> {
    record.found.problem.as_ref()
}

/// Order of cells: problem, method, tolerance from coarse to fine.
pub fn compare_cells(a: &Record, b: &Record) -> Ordering {
    compare_problems(&a.asked, &b.asked)
        .then_with(|| compare_methods(&a.found.method, &b.found.method))
        .then(b.asked.tolerance.total_cmp(&a.asked.tolerance))
        .then_with(|| a.id.cmp(&b.id))
}

const STATE_CHANGES: &str =
    "changes of a point between open, stick and slip from iterate to iterate, summed";
const FINAL_CHANGES: &str =
    "points that end an increment in another state than the one they began it in";

/// A cell.
pub struct CellRow<'a>(pub &'a Record);

impl OfCell for CellRow<'_> {
    fn record(&self) -> &Record {
        self.0
    }
}

impl CellRow<'_> {
    fn error(&self) -> Option<&SolverError> {
        self.0.found.solver_error.as_ref()
    }

    fn sum(&self, counter: fn(&Step) -> usize) -> usize {
        self.0.found.sum(counter)
    }

    fn natural_map(&self) -> f64 {
        match self.0.found.increments.is_empty() {
            true => f64::NAN,
            false => self.0.found.natural_map(),
        }
    }

    fn discretisation_error(&self) -> Option<f64> {
        let energy = |d: &&Deviation| d.quantity == "energy" && d.at.is_empty();
        self.0.found.deviations.iter().find(energy).map(|d| d.error)
    }

    /// A size of the problem; not-a-number where there is none.
    fn size(&self, of: fn(&ProblemSize) -> usize) -> f64 {
        size(self.0).map_or(f64::NAN, |size| of(size) as f64)
    }
}

impl Row for CellRow<'_> {
    const NAME: &'static str = "cells";
    const TITLE: &'static str = "What every cell of the study found";
    const QUESTION: &'static str =
        "Is the answer of a method right, how exact, after how much work?";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| compare_cells(a.0, b.0));

    fn columns() -> Vec<Column<Self>> {
        of_cell(columns! { r: Self,
            "digest" "" = r.0.asked.digest.clone(), "SHA-256 of the case file, 16 digits";
            "exact" "" = r.0.found.exact, "whether the limit of the method are the contact laws";
            "verdict" "" .shown() = &r.0.found.verdict, "as in `runs.csv`; of the last increment, which is the first that is not honest";
            "natural_map" "–" .residual().power(2) = r.natural_map(), "residual of the contact conditions found by the judge, the largest over the increments";
            "error_energy" "–" .residual().shown() = r.error().map_or(f64::NAN, |e| e.energy), "solver error: distance of u from the converged solution of the same discrete problem in the energy norm, relative; the largest over the increments, like the two that follow";
            "error_force" "–" .residual() = r.error().map_or(f64::NAN, |e| e.force), "that of the contact forces";
            "error_jump" "–" .residual() = r.error().map_or(f64::NAN, |e| e.jump), "largest difference of a jump, over the largest displacement";
            "reference" "" = r.error().map_or("", |e| &e.reference), "method that found the converged solution";
            "reference_natural_map" "–" .residual() = r.error().map_or(f64::NAN, |e| e.reference_natural_map), "its residual";
            "discretisation_error" "–" .significant(4) = r.discretisation_error().unwrap_or(f64::NAN), "error in the energy norm against the closed form, at the end of the path; `NaN` where the case has none";
            "dim" "" = r.size(|size| size.dim), DIMENSION;
            "dofs" "" = r.size(|size| size.dofs), DOFS;
            "points" "" = r.size(|size| size.points), POINTS;
            "unknowns" "" .shown() = r.size(|size| size.unknowns), "contact unknowns";
            "h_m" "m" = size(r.0).map_or(f64::NAN, |size| size.h_m), CELL_WIDTH;
            "increments" "" = r.0.found.increments.len(), "increments that were run; the seven counters that follow are their sums";
            "iterations" "" .shown() = r.sum(|i| i.iterations), ITERATIONS;
            "solves" "" = r.sum(|i| i.solves), SOLVES;
            "tangent_factorisations" "" = r.sum(|i| i.tangent_factorisations), TANGENTS;
            "global_factorisations" "" = r.sum(|i| i.global_factorisations), GLOBALS;
            "local_solves" "" = r.sum(|i| i.local_solves), LOCALS;
            "state_changes" "" = r.sum(|i| i.state_changes), STATE_CHANGES;
            "final_changes" "" = r.sum(|i| i.final_changes), FINAL_CHANGES;
        })
    }
}

/// An increment of a cell.
pub struct IncrementRow<'a> {
    record: &'a Record,
    number: usize,
    found: &'a Step,
}

impl<'a> IncrementRow<'a> {
    /// Those of a cell.
    pub fn of(record: &'a Record) -> impl Iterator<Item = Self> {
        let all = record.found.increments.iter().enumerate();
        all.map(move |(index, found)| Self {
            record,
            number: index + 1,
            found,
        })
    }
}

impl OfCell for IncrementRow<'_> {
    fn record(&self) -> &Record {
        self.record
    }
}

impl Row for IncrementRow<'_> {
    const NAME: &'static str = "increments";
    const TITLE: &'static str = "What every increment of every cell found";
    const QUESTION: &'static str = "Which increment of a path costs how much?";
    const READABLE: bool = false;
    const ORDER: Order<Self> =
        Order::By(|a, b| compare_cells(a.record, b.record).then(a.number.cmp(&b.number)));

    fn columns() -> Vec<Column<Self>> {
        of_cell(columns! { r: Self,
            "increment" "" = r.number, "place of the increment in the path, from 1; the state at time 0 takes the first where something acts then";
            "verdict" "" = &r.found.verdict, "its verdict";
            "natural_map" "–" .residual() = r.found.judge.natural_map, "its residual";
            "iterations" "" = r.found.iterations, ITERATIONS;
            "solves" "" = r.found.solves, SOLVES;
            "tangent_factorisations" "" = r.found.tangent_factorisations, TANGENTS;
            "global_factorisations" "" = r.found.global_factorisations, GLOBALS;
            "local_solves" "" = r.found.local_solves, LOCALS;
            "state_changes" "" = r.found.state_changes, STATE_CHANGES;
            "final_changes" "" = r.found.final_changes, FINAL_CHANGES;
        })
    }
}

/// Kind of a quantity beside its closed form.
const EXACT: &str = "exact";

/// A quantity of a cell, beside its closed form or followed over meshes.
pub struct DeviationRow<'a> {
    record: &'a Record,
    quantity: Result<&'a Deviation, &'a Value>,
}

impl<'a> DeviationRow<'a> {
    /// Those of a cell.
    pub fn of(record: &'a Record) -> impl Iterator<Item = Self> {
        let exact = record.found.deviations.iter().map(Ok);
        let followed = record.found.values.iter().map(Err);
        exact
            .chain(followed)
            .map(move |quantity| Self { record, quantity })
    }

    /// Whether there is a closed form.
    pub fn is_exact(&self) -> bool {
        self.quantity.is_ok()
    }

    fn names(&self) -> [&'a str; 2] {
        match self.quantity {
            Ok(d) => [&d.quantity, &d.at],
            Err(v) => [&v.quantity, &v.at],
        }
    }
}

impl<'a> DeviationRow<'a> {
    /// All; a quantity without exact value says something only beside that of another mesh.
    pub fn all(records: &'a [Record]) -> Vec<Self> {
        let refined: Vec<Problem> = sequences(records).into_iter().flatten().collect();
        let own = records.iter().flat_map(|record| {
            let mut all = refined.iter();
            let several = all.any(|own| own.is_same_problem(&record.asked));
            Self::of(record).filter(move |row| several || row.is_exact())
        });
        own.collect()
    }
}

impl OfCell for DeviationRow<'_> {
    fn record(&self) -> &Record {
        self.record
    }
}

impl Row for DeviationRow<'_> {
    const NAME: &'static str = "deviations";
    const TITLE: &'static str =
        "Quantities at the end of the path, of cells with an honest verdict";
    const QUESTION: &'static str = "How far is the mesh from the exact solution?";
    const NOTES: &'static str =
        "Without a closed form only of cases that the study has on several meshes.";
    const READABLE: bool = false;
    const ORDER: Order<Self> =
        Order::By(|a, b| compare_cells(a.record, b.record).then_with(|| a.names().cmp(&b.names())));

    fn columns() -> Vec<Column<Self>> {
        of_cell(columns! { r: Self,
            "kind" "" = if r.is_exact() { EXACT } else { "followed" }, "`exact`: beside the closed form; `followed`: a quantity of interest of a case without";
            "quantity" "" = r.names()[0], "as in `convergence.csv`";
            "at" "" = r.names()[1], "place and component; empty: the whole body";
            "found" "SI" = r.quantity.map_or_else(|v| v.value, |d| d.found), "value";
            "reference" "SI" = r.quantity.map_or(f64::NAN, |d| d.exact), "exact value; `NaN` of a followed quantity";
            "error" "" .significant(4) = r.quantity.map_or(f64::NAN, |d| d.error), "as in `convergence.csv`; `NaN` of a followed quantity";
            "norm" "SI" = r.quantity.map_or_else(|v| v.norm, |_| f64::NAN), "what errors of a followed quantity are relative to";
        })
    }
}

/// Stages of a cell in the order in which they come.
pub const STAGES: [&str; 7] = [
    "setup",
    "assembly",
    "factorisation",
    "condensation",
    "prepare",
    "solve",
    "output",
];

/// The times of a cell that may be shown.
pub struct TimeRow<'a> {
    /// The cell.
    pub record: &'a Record,
    spent: &'a Spent,
}

impl<'a> TimeRow<'a> {
    /// Those of a cell, if they may be shown.
    pub fn of(record: &'a Record) -> Option<Self> {
        let spent = published_times(record)?;
        Some(Self { record, spent })
    }

    /// Medians of [`STAGES`] [s].
    pub fn stages(&self) -> [f64; 7] {
        let s = self.spent;
        let (prepare, solve) = (s.prepare.median_s, s.solve.median_s);
        [
            s.setup_s,
            s.assembly_s,
            s.factorisation_s,
            s.condensation_s,
            prepare,
            solve,
            s.output_s,
        ]
    }

    /// Preparation and solution of all increments.
    pub fn method(&self) -> Timing {
        method_time(self.spent)
    }

    /// All stages [s].
    pub fn total(&self) -> f64 {
        self.stages().iter().sum()
    }
}

impl OfCell for TimeRow<'_> {
    fn record(&self) -> &Record {
        self.record
    }
}

const LOW: &str =
    "lower end of the 95 % interval of the median; of fewer than six repetitions the least";

impl Row for TimeRow<'_> {
    const NAME: &'static str = "times";
    const TITLE: &'static str = "What every cell took, where its times may be shown";
    const QUESTION: &'static str = "What does a run take, and which stage takes it?";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| compare_cells(a.record, b.record));

    fn columns() -> Vec<Column<Self>> {
        of_cell(columns! { r: Self,
            "verdict" "" = &r.record.found.verdict, "`solved` or `approximate: …`";
            "setup_s" "s" .time() = r.spent.setup_s, SETUP_S;
            "assembly_s" "s" .time() = r.spent.assembly_s, ASSEMBLY_S;
            "factorisation_s" "s" .time() = r.spent.factorisation_s, FACTORISATION_S;
            "condensation_s" "s" .time() = r.spent.condensation_s, CONDENSATION_S;
            "prepare_median_s" "s" .time() = r.spent.prepare.median_s, "preparation of the method: median of the repetitions";
            "prepare_min_s" "s" .time() = r.spent.prepare.min_s, "least of the repetitions";
            "prepare_low_s" "s" .time() = r.spent.prepare.low_s, LOW;
            "prepare_high_s" "s" .time() = r.spent.prepare.high_s, "upper end";
            "prepare_samples" "" = r.spent.prepare.samples, "repetitions";
            "solve_median_s" "s" .time() = r.spent.solve.median_s, "solution of all increments: median of the repetitions";
            "solve_min_s" "s" .time() = r.spent.solve.min_s, "least of the repetitions";
            "solve_low_s" "s" .time() = r.spent.solve.low_s, LOW;
            "solve_high_s" "s" .time() = r.spent.solve.high_s, "upper end";
            "solve_samples" "" = r.spent.solve.samples, "repetitions";
            "enforcement_median_s" "s" .time() = r.spent.enforcement.median_s, ENFORCEMENT_S;
            "enforcement_low_s" "s" .time() = r.spent.enforcement.low_s, LOW;
            "enforcement_high_s" "s" .time() = r.spent.enforcement.high_s, "upper end";
            "reported_median_s" "s" .time() = r.spent.reported.map_or(f64::NAN, |own| own.median_s), REPORTED_S;
            "method_median_s" "s" .time() = r.method().median_s, "time of the method: preparation and enforcement, sum of the two medians";
            "method_low_s" "s" .time() = r.method().low_s, "sum of the lower ends";
            "method_high_s" "s" .time() = r.method().high_s, "sum of the upper ends";
            "output_s" "s" .time() = r.spent.output_s, "tables and fields of the last increment, in memory";
            "total_s" "s" .time() = r.total(), "all stages";
            "peak_mb" "MB" .significant(4) = r.spent.peak_mb.unwrap_or(f64::NAN), "largest resident memory of the process; `NaN` where the system does not tell";
            "machine" "" = r.record.origin.machine.clone(), "operating system and processor";
            "profile" "" = r.record.origin.profile.clone(), "build profile";
        })
    }
}
