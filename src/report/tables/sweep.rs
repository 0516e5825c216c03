//! The study of run time against error: cells, increments, times, rates, ranks, profiles, recommendations, changes.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::convergence::{OfError, of_error};
use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::convergence::orders::ErrorRow;
use crate::studies::sweep::analysis::ranking::{PENALTY, Ranking, Standing};
use crate::studies::sweep::analysis::recommendation::Recommendation;
use crate::studies::sweep::analysis::series::{Point, Swept};
use crate::studies::sweep::analysis::success::SuccessRow;
use crate::studies::sweep::analysis::{
    compare_methods, compare_problems, method_time, published_times,
};
use crate::studies::sweep::compare::Change;
use crate::studies::sweep::record::{
    DeviationFound, IncrementFound, ProblemSize, Record, SolverError, Spent, ValueFound,
};
use crate::studies::sweep::statistics::Timing;

/// A row about a cell.
trait OfCell {
    fn record(&self) -> &Record;
}

/// The columns that name a cell, then those of the row.
fn of_cell<R: OfCell>(own: Vec<Column<R>>) -> Vec<Column<R>> {
    let mut columns = columns! { r: R,
        "id" "" = r.record().id.clone(), "stable name of the cell; joins the files of a study";
        "case" "" .shown() = r.record().cell.case.clone(), "case: a shipped one, a file, or a random problem";
        "refine" "" = r.record().cell.refine, "refinement factor of the mesh";
        "mesh" "" .shown() = size(r.record()).map_or("", |size| &size.mesh), "mesh label; empty where the cell ended before it had a mesh";
        "space" "" .shown() = size(r.record()).map_or(r.record().cell.space.as_deref().unwrap_or("own"), |size| &size.space), SPACE;
        "friction" "–" .named("μ") = r.record().cell.mu(), FRICTION;
        "method" "" .shown() = r.record().found.method.clone(), METHOD;
        "tolerance" "–" .shown() = r.record().cell.tolerance, "natural map asked of the method and accepted by the judge";
    };
    columns.extend(own);
    columns
}

fn size(record: &Record) -> Option<&ProblemSize> {
    record.found.problem.as_ref()
}

/// Order of cells: problem, method, tolerance from coarse to fine.
pub fn compare_cells(a: &Record, b: &Record) -> Ordering {
    compare_problems(&a.cell.problem(), &b.cell.problem())
        .then_with(|| compare_methods(&a.found.method, &b.found.method))
        .then(b.cell.tolerance.total_cmp(&a.cell.tolerance))
        .then_with(|| a.id.cmp(&b.id))
}

/// Order of tiers, from coarse to fine.
fn compare_tiers(a: Tier, b: Tier) -> Ordering {
    b.tolerance().total_cmp(&a.tolerance())
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

    fn sum(&self, counter: fn(&IncrementFound) -> usize) -> usize {
        self.0.found.sum(counter)
    }

    fn natural_map(&self) -> f64 {
        match self.0.found.increments.is_empty() {
            true => f64::NAN,
            false => self.0.found.natural_map(),
        }
    }

    fn discretisation_error(&self) -> Option<f64> {
        let energy = |d: &&DeviationFound| d.quantity == "energy" && d.at.is_empty();
        self.0.found.deviations.iter().find(energy)?.error
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
            "digest" "" = r.0.cell.digest.clone(), "SHA-256 of the case file, 16 digits";
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
            "schema" "" = r.0.schema, "version of the records";
        })
    }
}

/// An increment of a cell.
pub struct IncrementRow<'a> {
    record: &'a Record,
    number: usize,
    found: &'a IncrementFound,
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
            "increment" "" = r.number, INCREMENT;
            "verdict" "" = &r.found.verdict, "its verdict";
            "natural_map" "–" .residual() = r.found.natural_map.unwrap_or(f64::NAN), "its residual";
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
    quantity: Result<&'a DeviationFound, &'a ValueFound>,
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
            "found" "SI" = r.quantity.map_or_else(|v| v.value, |d| d.found.unwrap_or(f64::NAN)), "value";
            "reference" "SI" = r.quantity.map_or(f64::NAN, |d| d.exact), "exact value; `NaN` of a followed quantity";
            "error" "" .significant(4) = r.quantity.map_or(f64::NAN, |d| d.error.unwrap_or(f64::NAN)), "as in `convergence.csv`; `NaN` of a followed quantity";
            "norm" "SI" = r.quantity.map_or_else(|v| v.norm, |_| f64::NAN), "what errors of a followed quantity are relative to";
        })
    }
}

/// A number about the study as a whole.
pub struct SummaryRow {
    /// What is counted.
    pub quantity: String,
    /// How many.
    pub value: usize,
}

impl Row for SummaryRow {
    const NAME: &'static str = "study";
    const TITLE: &'static str = "The study in numbers";
    const QUESTION: &'static str =
        "How many problems stand behind the comparison, and how many were left out?";
    const READABLE: bool = false;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "quantity" "" .key() = r.quantity.clone(), "`cells` with a record, `cells_of_the_sweep`, `problems`, `schema`; per tier `problems_compared_…` and `problems_left_out_…`, those that some method was not given";
            "value" "" .shown() = r.value, "number";
        }
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
            "method_median_s" "s" .time() = r.method().median_s, "time of the method: sum of the two medians";
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

impl Row for SuccessRow {
    const NAME: &'static str = "success";
    const TITLE: &'static str = "What methods claim, and what the judge confirms, by accuracy, with Wilson's 95 % intervals";
    const QUESTION: &'static str = "Which method is right how often, and how does it fail?";
    const NOTES: &'static str = "Every problem counts, refused ones as not solved.";
    const ORDER: Order<Self> = Order::By(|a, b| {
        compare_methods(&a.method, &b.method).then_with(|| compare_tiers(a.tier, b.tier))
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "method" "" .shown() = r.method.clone(), METHOD;
            "exact" "" = r.exact, "whether its limit are the contact laws";
            "defaults" "" = r.defaults, "whether all options have their default";
            "tier" "" .shown() = r.tier.to_string(), "accuracy asked for";
            "cells" "" .named("problems") = r.cells, "cells, each on a problem of its own";
            "claimed" "" .shown() = r.claimed, "cells that end with a claim, right or wrong: verdicts `solved`, `approximate`, `false-claim`";
            "success_rate" "–" .significant(4) = r.success()[0], "claimed / cells";
            "success_low" "–" .significant(4) = r.success()[1], "lower end of its interval";
            "success_high" "–" .significant(4) = r.success()[2], "upper end";
            "correct" "" .named("right") = r.correct, "cells that are right to the tier";
            "correct_rate" "–" .significant(4).named("right").percent(1) = r.correctness()[0], "correct / cells";
            "correct_low" "–" .significant(4).named("from").percent(1) = r.correctness()[1], "lower end of its interval";
            "correct_high" "–" .significant(4).named("to").percent(1) = r.correctness()[2], "upper end";
            "inaccurate" "" .shown() = r.failures[0], "not right for another reason than those that follow: laws of its own, solved as claimed";
            "false_claim" "" .named("false claims") = r.failures[1], "claims that the judge refuted";
            "max_iterations" "" .shown() = r.failures[2], "ended without a claim at the limit of iterations";
            "stalled" "" .shown() = r.failures[3], "ended without progress";
            "singular_tangent" "" = r.failures[4], "ended at a matrix that cannot be factored";
            "mechanism" "" = r.failures[5], "ended at a body that is held by nothing";
            "diverged" "" = r.failures[6], "ended with numbers that grew without bound";
            "stopped" "" = r.failures[7], "was stopped";
            "refused" "" .shown() = r.failures[8], "declined";
            "crashed" "" .shown() = r.failures[9], "failed with an error";
            "timed_out" "" = r.failures[10], "stopped at the time limit";
            "out_of_memory" "" = r.failures[11], "denied memory, by the limit or by the system";
        }
    }
}

/// A step of a performance profile.
pub struct ProfileRow {
    /// Accuracy asked for.
    pub tier: Tier,
    /// Method.
    pub method: String,
    /// Ratio, and fraction from there on.
    pub step: [f64; 2],
    /// Problems of the tier.
    pub problems: usize,
}

impl Row for ProfileRow {
    const NAME: &'static str = "time_profiles";
    const TITLE: &'static str = "Performance profiles of the time of the method (Dolan & Moré, Math. Program. 91 (2002) 201): the fraction of problems that a method solves within τ times the least time of all methods";
    const QUESTION: &'static str = "How often is a method how far from the fastest?";
    const NOTES: &'static str = "A row where the fraction jumps up. Ratios below 1 + the width of the intervals mean nothing.";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| {
        compare_tiers(a.tier, b.tier)
            .then_with(|| compare_methods(&a.method, &b.method))
            .then(a.step[0].total_cmp(&b.step[0]))
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "tier" "" = r.tier.to_string(), "accuracy asked for";
            "method" "" = r.method.clone(), METHOD;
            "tau" "–" .significant(6) = r.step[0], "bound on time / least time";
            "fraction" "–" .significant(6) = r.step[1], "fraction of the problems within it, those that no method solves included";
            "problems" "" = r.problems, "problems";
        }
    }
}

/// A method among all at one tier.
pub struct RankingRow {
    /// Accuracy asked for.
    pub tier: Tier,
    /// Method.
    pub method: String,
    /// First and last rank that its interval allows.
    pub rank: [usize; 2],
    /// Mean, lower and upper end [s].
    pub mean: [f64; 3],
    problems: usize,
    correct: usize,
    unsolved: usize,
    width: f64,
    shift: f64,
    penalty: f64,
}

impl RankingRow {
    /// Those of a tier.
    pub fn of(tier: Tier, ranking: &Ranking<'_>) -> Vec<Self> {
        let of = |s: &Standing<'_>| Self {
            tier,
            method: s.method.to_owned(),
            rank: s.rank,
            mean: [s.mean.value, s.mean.low, s.mean.high],
            problems: ranking.problems,
            correct: s.correct,
            unsolved: ranking.unsolved,
            width: s.width,
            shift: ranking.shift,
            penalty: PENALTY,
        };
        ranking.standings.iter().map(of).collect()
    }
}

impl Row for RankingRow {
    const NAME: &'static str = "ranking";
    const TITLE: &'static str = "Shifted geometric mean of the time of the method over all problems; methods whose intervals overlap share a rank";
    const QUESTION: &'static str = "Which method is fastest at which accuracy?";
    const NOTES: &'static str = "exp(mean ln(t + shift)) − shift (Achterberg 2007). A method without any right answer has no rank.";
    const ORDER: Order<Self> = Order::By(|a, b| {
        compare_tiers(a.tier, b.tier)
            .then(a.mean[0].total_cmp(&b.mean[0]))
            .then_with(|| compare_methods(&a.method, &b.method))
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "tier" "" .shown() = r.tier.to_string(), "accuracy asked for";
            "method" "" .shown() = r.method.clone(), METHOD;
            "rank_first" "" .named("rank from") = r.rank[0], "1 + number of methods whose interval lies below its own";
            "rank_last" "" .named("to") = r.rank[1], "number of methods − number whose interval lies above its own";
            "mean_s" "s" .time().digits(3) = r.mean[0], "shifted geometric mean of the medians";
            "low_s" "s" .time().named("from").digits(3) = r.mean[1], "that of the lower ends";
            "high_s" "s" .time().named("to").digits(3) = r.mean[2], "that of the upper ends";
            "problems" "" .shown() = r.problems, "problems in the mean";
            "correct" "" .named("right") = r.correct, "of these, with a right answer";
            "unsolved" "" = r.unsolved, "problems that no method solves, left out";
            "interval_width" "–" .significant(3).named("median interval").percent(0) = r.width, "median over the problems of (high − low) / median of the time";
            "shift_s" "s" .time() = r.shift, "shift: the power of ten at or below the median over the problems of the fastest right time, so that problems that take no time do not rule the mean";
            "penalty" "–" .significant(3) = r.penalty, "a problem without right answer enters with so many times the slowest right time of any method on it (PAR10: Hutter et al. 2009)";
        }
    }
}

/// A point of a curve of solver error against work.
pub struct PointRow<'a> {
    /// Name of the problem.
    pub problem: String,
    /// Name of the curve.
    pub label: String,
    /// What varies along it.
    pub swept: Swept,
    /// Whether the limit of the method are the contact laws.
    pub exact: bool,
    /// The point.
    pub point: Point<'a>,
}

impl PointRow<'_> {
    fn sum(&self, counter: fn(&IncrementFound) -> usize) -> usize {
        self.point.record.found.sum(counter)
    }

    fn time(&self, of: fn(&Timing) -> f64) -> f64 {
        self.point.time.as_ref().map_or(f64::NAN, of)
    }
}

impl Row for PointRow<'_> {
    const NAME: &'static str = "work_precision";
    const TITLE: &'static str = "Solver error against work: a row per point of a curve, only honest verdicts with a solver error";
    const QUESTION: &'static str = "What does a method spend for which accuracy?";
    const READABLE: bool = false;
    // They come by problem, series and value.
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "problem" "" = r.problem.clone(), "case, refinement, contact space, friction";
            "series" "" = r.label.clone(), "method of the curve; options along which it goes in brackets, then others that are not the default";
            "swept" "" = r.swept.name(), "`tolerance`, or the option that takes most values and those that follow from it";
            "value" "–" = r.point.value, "tolerance, or value of the option; the defaults stand among them";
            "exact" "" = r.exact, "whether the limit of the method are the contact laws";
            "id" "" = r.point.record.id.clone(), "as in `cells.csv`, like the five that follow";
            "verdict" "" = &r.point.record.found.verdict, "verdict";
            "error_energy" "–" .residual() = r.point.error, "solver error in the energy norm";
            "iterations" "" = r.sum(|i| i.iterations), ITERATIONS;
            "local_solves" "" = r.sum(|i| i.local_solves), LOCALS;
            "tangent_factorisations" "" = r.sum(|i| i.tangent_factorisations), TANGENTS;
            "method_median_s" "s" .time() = r.time(|t| t.median_s), "as in `times.csv`, like the two that follow";
            "method_low_s" "s" .time() = r.time(|t| t.low_s), "lower end";
            "method_high_s" "s" .time() = r.time(|t| t.high_s), "upper end";
        }
    }
}

/// The discretisation error of a mesh with the time to the answer.
pub struct AccuracyRow<'a>(pub &'a ErrorRow);

impl OfError for AccuracyRow<'_> {
    fn error(&self) -> &ErrorRow {
        self.0
    }
}

impl Row for AccuracyRow<'_> {
    const NAME: &'static str = "time_to_accuracy";
    const TITLE: &'static str = "Discretisation error beside the time to the answer, mesh by mesh";
    const QUESTION: &'static str = "What does an accurate answer take, mesh and method together?";
    const NOTES: &'static str = "Exact methods with default options, at the finest tolerance that was asked for on every mesh of the sequence. The energy norm of the error where there is a closed form, otherwise the strain energy or the first followed quantity against its limit. Times are medians where there are repetitions; those of the body are the least of all cells on the mesh, which build the same one.";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| match ErrorRow::ORDER {
        Order::By(compare) => compare(a.0, b.0),
        _ => Ordering::Equal,
    });

    fn columns() -> Vec<Column<Self>> {
        let mut columns = of_error();
        // The records do not know the enrichment of the tips.
        columns.retain(|column| column.about.name != "tip");
        columns
    }
}

/// What stands for "anything".
const ANY: &str = "any";

/// The fastest methods.
fn fastest(row: &Recommendation) -> String {
    let names = row.fastest.iter().map(|f| f.method.as_str());
    names.collect::<Vec<_>>().join("; ")
}

impl Row for Recommendation {
    const NAME: &'static str = "recommendations";
    const TITLE: &'static str =
        "Fastest methods among those that are right most often, by accuracy and class of problems";
    const QUESTION: &'static str = "Which method should I use?";
    const NOTES: &'static str = "From all problems down to classes of one kind; classes that hold the same problems as a coarser one are left out.";
    // They come from coarse to fine.
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "tier" "" .shown() = r.tier.to_string(), "accuracy asked for";
            "dimension" "" .named("dim") = r.class.dim.map_or_else(|| ANY.into(), |dim| dim.to_string()), "2, 3 or `any`";
            "friction" "" .shown() = r.class.friction.map_or_else(|| ANY.into(), |friction| friction.to_string()), "`frictionless`, `slip`, `stick` (nothing slips) or `any`";
            "loading" "" .shown() = r.class.path.map_or(ANY, |path| if path { "path" } else { "single increment" }), "`single increment`, `path` or `any`";
            "unknowns" "" .shown() = r.class.size.map_or_else(|| ANY.into(), |size| size.to_string()), "contact unknowns: `up to 100`, `101 to 1000`, `over 1000` or `any`";
            "problems" "" .shown() = r.problems, "problems of the class";
            "timed" "" = r.timed, "of these, solved by some method, with times that can be compared";
            "fastest" "" .shown() = fastest(r), "among the methods that are right most often those that none is faster than beyond the intervals of the means in `ranking.csv`, separated by `; `; first the one that is among the fastest of all methods on most problems; empty without times";
            "among" "" .named("first among the fastest on") = r.fastest.first().map_or(0, |first| first.among), "problems on which no method is faster than the first beyond the intervals";
            "alone" "" = r.fastest.first().map_or(0, |first| first.alone), "of these, problems on which it is faster than all others";
            "evidence" "" = r.evidence(), "the same in words, with the next ones";
            "confidence" "" .shown() = r.confidence.to_string(), "of the first, with k = among of n = timed: `sure` if Wilson's 95 % interval of k/n lies above ½, `likely` if k/n does and n ≥ 3, `open` otherwise";
            "reliable" "" = r.reliable.join("; "), "methods that are right most often, separated by `; `";
            "correct" "" .named("right on") = r.correct, "problems that they solve";
            "correct_rate" "–" .significant(4) = r.rate()[0], "correct / problems";
            "correct_low" "–" .significant(4) = r.rate()[1], "lower end of Wilson's 95 % interval";
            "correct_high" "–" .significant(4) = r.rate()[2], "upper end";
        }
    }
}

/// What changed from one set of records to another.
pub struct ChangeRow<'a>(pub &'a Change);

impl Row for ChangeRow<'_> {
    const NAME: &'static str = "compare";
    const TITLE: &'static str = "What changed from A to B";
    const QUESTION: &'static str = "What is better or worse than before?";
    const NOTES: &'static str = "A time changed if the intervals of the two medians are disjoint, the drift taken out, and |ln(b/a) − drift| > max(3 noise, ln 1.1); drift is the median of ln(b/a) over all cells, noise 1.4826 times the median absolute deviation from it. Times are compared where machine and build profile agree.";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| a.0.id.cmp(&b.0.id));

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "id" "" .named("cell") = r.0.id.clone(), "cell";
            "what" "" .shown() = r.0.what.name(), "`only in A`, `only in B`, `verdict`, a counter of `cells.csv`, `solver_error` (by more than 1 %), `time`, or `bits`: something else in what was found";
            "direction" "" .shown() = r.0.direction.name(), "`better`, `worse` or `other`";
            "a" "" .named("A") = r.0.a.clone(), "in A";
            "b" "" .named("B") = r.0.b.clone(), "in B";
            "ratio" "–" .significant(4).digits(3) = r.0.ratio, "B / A; of times with the drift of the machine taken out";
        }
    }
}
