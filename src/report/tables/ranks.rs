//! Conclusions of a study about the methods: rates, ranks, curves.

use std::cmp::Ordering;

use stickslip_methods::Tier;

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::analysis::compare_methods;
use crate::studies::analysis::costs::Costs;
use crate::studies::analysis::ranking::{PENALTY, Ranking, Standing, ranking};
use crate::studies::analysis::scaling::Growth;
use crate::studies::analysis::series::{Point, Series, Swept, series};
use crate::studies::analysis::success::SuccessRow;
use crate::studies::analysis::test_set::TestSet;
use crate::studies::analysis::{by_problem, problem_names, problems};
use crate::studies::record::{Record, Step};
use crate::studies::statistics::Timing;

/// Order of tiers, from coarse to fine.
fn compare_tiers(a: Tier, b: Tier) -> Ordering {
    b.tolerance().total_cmp(&a.tolerance())
}

impl Row for SuccessRow {
    const NAME: &'static str = "success";
    const PRINTED: bool = true;
    const TITLE: &'static str = "What methods claim, and what the judge confirms, by accuracy, with Wilson's 95 % intervals";
    const QUESTION: &'static str = "Which method is right how often, and how does it fail?";
    const NOTES: &'static str = "Every problem counts, refused ones as not solved.";
    const ORDER: Order<Self> = Order::By(|a, b| {
        (a.class.cmp(&b.class))
            .then_with(|| compare_methods(&a.method, &b.method))
            .then_with(|| compare_tiers(a.tier, b.tier))
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "class" "" .key() = r.class.clone(), "class of the problems, as their source names it, with the friction coefficient where a class has several; empty: all problems";
            "method" "" .key() = r.method.clone(), METHOD;
            "exact" "" = r.exact, "whether its limit are the contact laws";
            "defaults" "" = r.defaults, "whether all options have their default";
            "tier" "" .shown() = r.tier.to_string(), "accuracy asked for";
            "cells" "" .named("problems") = r.cells, "cells, each on a problem of its own";
            "claimed" "" .shown() = r.claimed, "cells that end with a claim, right or wrong: verdicts `solved`, `approximate`, `false-claim`";
            "success_rate" "–" .significant(4) = r.success()[0], "claimed / cells";
            "success_low" "–" .significant(4) = r.success()[1], "lower end of its interval";
            "success_high" "–" .significant(4) = r.success()[2], "upper end";
            "correct" "" .named("right") = r.correct, "cells that are right to the tier";
            "several" "" = r.several, "of these, where different answers are known: far from the converged solution that the solver error refers to, or this of another cell";
            "correct_rate" "–" .significant(4).named("right").percent(1) = r.correctness()[0], "correct / cells";
            "correct_low" "–" .significant(4).named("from").percent(1) = r.correctness()[1], "lower end of its interval";
            "correct_high" "–" .significant(4).named("to").percent(1) = r.correctness()[2], "upper end";
            "inaccurate" "" .shown() = r.failures[0], "not right for another reason than those that follow: laws of its own, solved as claimed";
            "false_claim" "" .named("false claims") = r.failures[1], "claims that the judge refuted";
            "max_iterations" "" .shown() = r.failures[2], "ended without a claim at the limit of iterations";
            "stalled" "" .shown() = r.failures[3], "ended without progress";
            "singular_tangent" "" = r.failures[4], "ended at a matrix that cannot be factored";
            "mechanism" "" = r.failures[5], "ended at a body that is held by nothing";
            "no_equilibrium" "" = r.failures[6], "no contact force within the cones of friction balances the load, or none opens all gaps";
            "diverged" "" = r.failures[7], "ended with numbers that grew without bound";
            "stopped" "" = r.failures[8], "was stopped";
            "rounding" "" = r.failures[9], "ended with forces so large beside what they move that rounding decides";
            "unexplained" "" = r.failures[10], "a program from outside that gave up and did not say why";
            "refused" "" .shown() = r.failures[11], "declined";
            "crashed" "" .shown() = r.failures[12], "failed with an error";
            "timed_out" "" = r.failures[13], "stopped at the time limit";
            "out_of_memory" "" = r.failures[14], "denied memory, by the limit or by the system";
            "iterations_median" "" .named("iterations, median") = r.iterations[0], "median of the iterations of the runs that did what they claim";
            "iterations_p90" "" = r.iterations[1], "90 % of these need no more";
            "iterations_max" "" = r.iterations[2], "largest number";
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
    const PRINTED: bool = true;
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

impl Row for Growth {
    const NAME: &'static str = "scaling";
    const TITLE: &'static str = "How methods grow with the contact unknowns N on bodies of given sizes: time and iterations as powers of N";
    const QUESTION: &'static str = "Which method still works when there are many contact points?";
    const NOTES: &'static str = "Least squares of the logarithms over right answers at tier high with more than 50 unknowns; failures are no part of the exponents.";
    const ORDER: Order<Self> = Order::Given;

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dim" "" .shown() = r.dim, DIMENSION;
            "method" "" .shown() = r.method.clone(), METHOD;
            "bodies" "" .shown() = r.bodies, "bodies it was given, with the friction coefficient that most have";
            "correct" "" .named("right") = r.correct, "of these, with a right answer at tier high in the time allowed";
            "unknowns_from" "" .named("unknowns from") = r.unknowns[0], "fewest contact unknowns of these";
            "unknowns_to" "" .named("to") = r.unknowns[1], "most";
            "exponent_time" "–" .significant(3).named("time ~ N to the power") = r.exponents[0], "exponent of the time of the method; `NaN` where sizes or times do not tell";
            "exponent_iterations" "–" .significant(3).named("iterations ~ N to the power") = r.exponents[1], "exponent of the iterations";
            "points" "" = r.largest.0, "largest number of contact points asked for that it has a right answer to";
            "share" "–" .significant(3).named("part in the largest").percent(0) = r.largest.1, "median part of the time of the method in the whole run there, from the mesh to the contact forces";
        }
    }
}

/// A point of a curve of solver error against work.
pub struct PointRow<'a> {
    /// Name of the problem.
    pub problem: String,
    /// Name of the curve.
    pub label: String,
    /// The quantity that varies along it.
    pub swept: Swept,
    /// Whether the limit of the method are the contact laws.
    pub exact: bool,
    /// The point.
    pub point: Point<'a>,
}

impl PointRow<'_> {
    fn sum(&self, counter: fn(&Step) -> usize) -> usize {
        self.point.record.found.sum(counter)
    }

    fn time(&self, of: fn(&Timing) -> f64) -> f64 {
        self.point.time.as_ref().map_or(f64::NAN, of)
    }
}

impl Row for PointRow<'_> {
    const NAME: &'static str = "time_against_solver_error";
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
            "id" "" = r.point.record.id.clone(), "as in `runs.csv`, like the five that follow";
            "verdict" "" = &r.point.record.found.verdict, "verdict";
            "error_energy" "–" .residual() = r.point.error, "solver error in the energy norm";
            "iterations" "" = r.sum(|i| i.iterations), ITERATIONS;
            "local_solves" "" = r.sum(|i| i.local_solves), LOCALS;
            "tangent_factorisations" "" = r.sum(|i| i.tangent_factorisations), TANGENTS;
            "method_median_s" "s" .time() = r.time(|t| t.median_s), "time of the method: preparation and enforcement, sum of the two medians";
            "method_low_s" "s" .time() = r.time(|t| t.low_s), "sum of the lower ends of their 95 % intervals";
            "method_high_s" "s" .time() = r.time(|t| t.high_s), "upper end";
        }
    }
}

/// The sets compared at every tier.
pub fn sets(records: &[Record]) -> [TestSet<'_>; 3] {
    Tier::ALL.map(|tier| TestSet::new(records, tier))
}

/// Methods by mean time, tier after tier.
pub fn rankings(records: &[Record]) -> Vec<RankingRow> {
    let sets = sets(records);
    let of = |set| Some((set, ranking(&Costs::new(set))?));
    let all = sets.iter().filter_map(of);
    all.flat_map(|(set, own): (&TestSet<'_>, _)| RankingRow::of(set.tier, &own))
        .collect()
}

/// Points of all curves of solver error against work.
pub fn curves(records: &[Record]) -> Vec<PointRow<'_>> {
    let names = problem_names(&problems(records));
    let mut rows = Vec::new();
    for (of_problem, name) in by_problem(records).iter().zip(names) {
        for own in series(of_problem) {
            let Series { label, swept, .. } = own;
            rows.extend(own.points.into_iter().map(|point| PointRow {
                problem: name.clone(),
                label: label.clone(),
                swept: swept.clone(),
                exact: own.exact,
                point,
            }));
        }
    }
    rows
}
