//! The random robustness study: success rates with their confidence intervals, and every failure.

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::atlas::cause::Diagnosis;
use crate::studies::robustness::atlas::{AtlasRow, StoppingRow};
use crate::studies::robustness::summary::{FailureRow, RobustnessRow};

impl Row for RobustnessRow {
    const NAME: &'static str = "robustness";
    const TITLE: &'static str =
        "Random problems: success rate of every method by dimension and friction coefficient";
    const QUESTION: &'static str = "Which method fails where, how often, and how?";
    const NOTES: &'static str = "Problems are the same for every method and friction coefficient; every one starts from rest. A run of an exact method succeeds if it is `solved`; a run of an approximate method (penalty, barrier, Nitsche) if it keeps its claim, `solved` or `approximate`: how well the contact laws hold then stands in the columns `approximate_…`. Medians, quantiles and shares of points are those of the successful runs.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .key().named("dim") = r.dimension, DIMENSION;
            "method" "" .key() = r.method.clone(), METHOD;
            "friction" "–" .key().named("μ") = r.friction, FRICTION;
            "tier" "" = r.tier.to_string(), TIER;
            "problems" "" .shown() = r.problems, "problems posed";
            "solved" "" = r.solved, "the contact laws hold as claimed";
            "several" "" = r.several, "of these, where different answers hold: which one a method finds depends on where it starts";
            "approximate_high" "" = r.approximate[0], "the method's own laws hold as claimed, and the contact laws to the tier `high`";
            "approximate_mid" "" = r.approximate[1], "the same for `mid`";
            "approximate_low" "" = r.approximate[2], "the same for `low`";
            "approximate_none" "" .named("laws to no tier") = r.approximate[3], "the method's own laws hold as claimed, the contact laws to no tier";
            "gave_up" "" .shown() = r.gave_up, "ended without a claim; the next seven columns tell why";
            "max_iterations" "" = r.gave_up_by[0], "of these, at the limit of iterations";
            "stalled" "" = r.gave_up_by[1], "without progress";
            "singular_tangent" "" = r.gave_up_by[2], "at a matrix that cannot be factored";
            "mechanism" "" = r.gave_up_by[3], "at a body that is held by nothing";
            "no_equilibrium" "" = r.gave_up_by[4], "where no contact force within the cones of friction balances the load, or none opens all gaps";
            "diverged" "" = r.gave_up_by[5], "with numbers that grew without bound";
            "rounding" "" = r.gave_up_by[7], "with forces so large beside what they move that rounding decides";
            "false_claims" "" .shown() = r.false_claims, "claims that the judge refuted";
            "crashed" "" .shown() = r.crashed, "failed with an error, `out-of-memory` among them";
            "refused" "" .shown() = r.refused, "problems the method declines; left out of the rate";
            "success" "" .named("rate of") = if r.exact { "solved" } else { "kept" }, "what the rate counts: `solved`, or for approximate methods claims `kept`, which are those solved and all approximate ones";
            "success_rate" "–" .significant(4).named("success").percent(1) = r.success[0], "successes / (problems − refused)";
            "success_low" "–" .significant(4).named("from").percent(1) = r.success[1], "lower end of Wilson's 95 % confidence interval of the rate";
            "success_high" "–" .significant(4).named("to").percent(1) = r.success[2], "upper end";
            "iterations_median" "" .named("iterations, median") = r.iterations[0], "median of the iterations of the successful runs";
            "iterations_p90" "" = r.iterations[1], "90 % of the runs need no more";
            "iterations_max" "" = r.iterations[2], "largest number";
            "factorisations_median" "" = r.factorisations, "factorisations inside the iteration, dense or sparse";
            "solve_s_median" "s" .time() = r.solve_s, "time of the method on the condensed problem; `NaN` with `--jobs` above 1";
            "natural_map_median" "–" .residual() = r.natural_map, NATURAL_MAP;
            "unique_share" "–" .significant(4) = r.unique_share, "share of the problems with min (W_nn − μ |W_nt|) > 0 over the contact points: each point alone has exactly one solution. Below 1 several solutions may exist";
            "open_share" "–" .significant(4) = r.shares[0], "share of open points";
            "stick_share" "–" .significant(4) = r.shares[1], "share of sticking points";
            "slip_share" "–" .significant(4) = r.shares[2], "share of slipping points, without friction of all closed ones";
        }
    }
}

impl Row for FailureRow {
    const NAME: &'static str = "failures";
    const TITLE: &'static str = "Runs of the robustness study that did not succeed";
    const QUESTION: &'static str =
        "Which problem defeats which method, and how can it be run again?";
    const NOTES: &'static str = "`stickslip stress methods --seed SEED --dim DIMENSION --only PROBLEM` runs the problem again and writes it as a case file `problem-….toml`, which `stickslip run` solves too.";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| {
        (a.dimension, a.problem)
            .cmp(&(b.dimension, b.problem))
            .then(a.friction.total_cmp(&b.friction))
            .then_with(|| a.method.cmp(&b.method))
    });

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "seed" "" = r.seed, "seed of the study";
            "dimension" "" .shown() = r.dimension, DIMENSION;
            "problem" "" .shown() = r.problem, "number of the problem, from 0";
            "friction" "–" .shown() = r.friction, FRICTION;
            "method" "" .shown() = r.method.clone(), METHOD;
            "verdict" "" .shown() = &r.verdict, VERDICT;
            "natural_map" "–" .residual().power(2) = r.natural_map, NATURAL_MAP;
            "unique" "" = r.unique, "`true` if each contact point alone has exactly one solution";
            "points" "" .shown() = r.points, POINTS;
            "cause" "" .shown() = r.explanation.as_ref().map(|own| own.diagnosis.cause.name()), CAUSE;
            "period" "" = diagnosed(r, |own| own.period), "iterations after which a cycle repeats";
            "flips" "" = diagnosed(r, flips), "contact points that change between open, stick and the directions of slip within a cycle, or while wandering, from 0";
            "measure" "–" .significant(3) = diagnosed(r, |own| Some(own.measure)), MEASURE;
            "rate" "–" .significant(6) = diagnosed(r, |own| own.rate), "`conditioning` and `slow`: factor by which an iteration reduces the violation over the last half of the run, of approximate methods the change of forces";
            "more" "" .significant(2) = diagnosed(r, |own| own.more), "iterations that are left at this rate";
            "solutions" "" = r.explanation.as_ref().map(|own| own.solutions), "different solutions of the problem that are known: found by exact methods from several starts, or by trying all states of up to 8 points in the plane";
            "cure" "" .shown() = r.explanation.as_ref().map(|own| own.cure.clone()), CURE;
        }
    }
}

fn diagnosed<T>(row: &FailureRow, get: fn(&Diagnosis) -> Option<T>) -> Option<T> {
    row.explanation.as_ref().and_then(|own| get(&own.diagnosis))
}

/// The points that flip, with blanks between.
fn flips(own: &Diagnosis) -> Option<String> {
    let list: Vec<String> = own.flips.iter().map(usize::to_string).collect();
    (!list.is_empty()).then(|| list.join(" "))
}

const CAUSE: &str = "why the run gave up, decided by running it again under observation: `no-solution`, `singular-tangent`, `inner-iteration`, `floor`, `cycle`, `conditioning`, `slow`, `several-solutions`, `wandering`, `unexplained`, asked in this order (docs/stability.md); empty if it did not give up but failed otherwise";
const MEASURE: &str = "what decided: combinations of states tried (`no-solution`; `NaN` where a certificate proves it), smallest over largest singular value (`singular-tangent`), least violation (`cycle`, `slow`, `unexplained`), violation over its rounding (`floor`), condition number of W on the loaded rows, or at rest along what is missing to the nearest solution (`conditioning`), iterations up to the inner one that failed (`inner-iteration`), points that keep changing (`wandering`), largest difference between two solutions (`several-solutions`)";
const CURE: &str = "first of the documented list that solves the problem: the method with another option, else another method; empty if none does";

impl Row for AtlasRow {
    const NAME: &'static str = "atlas";
    const TITLE: &'static str = "Failure atlas: why methods gave up, and what cures it";
    const QUESTION: &'static str = "Why does a method give up, how often for which cause, and what solves the problem instead?";
    const NOTES: &'static str = "Every run that gave up is run again under observation; the method does not know. Causes are measurements with thresholds, asked in a fixed order: docs/stability.md has them. A cure is tried on every failed run: the method with one other option (`r`, `kinks`, `anderson`, `spectral`, `step`, `variant`), then `newton-ac`, `pdas`, `hybrid`, `interior-point`; the first that solves it counts.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "method" "" .key() = r.method.clone(), METHOD;
            "cause" "" .key() = r.cause.name(), CAUSE;
            "runs" "" .shown() = r.count, "runs that gave up for this cause";
            "share" "–" .significant(4).percent(1) = r.share, "of all runs of the method that gave up";
            "measure_median" "–" .significant(3).named("measure, median").power(2) = r.measure, MEASURE;
            "period_median" "" .named("period, median") = r.period, "iterations after which a cycle repeats";
            "more_median" "" .significant(2).named("iterations left, median").power(2) = r.more, "iterations that are left at the observed rate";
            "several" "" .named("several solutions") = r.several, "of these runs, on problems of which several solutions are known";
            "cured" "" .shown() = r.cured, "of these runs, with a cure";
            "cure" "" .shown() = r.cure.clone(), "the cure that worked most often";
            "example_dimension" "" = r.example.0, "the problem with the fewest contact points: its dimension";
            "example_problem" "" .named("example") = r.example.1, "its number: `stickslip stress methods --seed SEED --dim DIMENSION --only PROBLEM` runs it again";
            "example_friction" "–" .named("its μ") = r.example.2, "its friction coefficient";
            "example_points" "" .named("its points") = r.example.3, "its contact points";
        }
    }
}

impl Row for StoppingRow {
    const NAME: &'static str = "stopping";
    const TITLE: &'static str = "Published stopping tests beside the violation of the contact laws";
    const QUESTION: &'static str = "Which stopping test lies, how often, and by how many decades?";
    const NOTES: &'static str = "On the first problem of every body all methods run once more, asked for tier `high` whatever the study asks for, and every test is evaluated on every iterate; nothing stops by it. A test lies where the violation at its first stop exceeds the tolerance it is used with, or, of an approximate method, what the run ends with if that is more. Programs from outside show no iterates.";

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "dimension" "" .key().named("dim") = r.dimension, DIMENSION;
            "method" "" .key() = r.method.clone(), METHOD;
            "criterion" "" .key() = r.criterion.name, "stopping test";
            "source" "" = r.criterion.source, "who published it, in which form";
            "tolerance" "–" .significant(2).power(1) = r.criterion.tolerance, "violation that the test is held to; tests that compare real numbers stop at this number themselves, `unchanged-states` at no change";
            "runs" "" .shown() = r.runs, "runs with at least one iteration";
            "early_share" "–" .significant(4).named("lies").percent(1) = r.early, "share of the runs that it stops before the violation is there";
            "decades_median" "–" .significant(3).named("decades, median").fixed(1) = r.decades[0], "median of log10(violation/tolerance) where it lies";
            "decades_max" "–" .significant(3).named("largest").fixed(1) = r.decades[1], "largest of them";
            "never_share" "–" .significant(4).named("never").percent(1) = r.never, "share of the runs that it never stops";
            "stopped_median" "" .named("stops at, median") = r.stopped, "median iteration at which it stops, from 0";
            "reached_median" "" .named("there at, median") = r.reached, "median iteration at which the violation is at most the tolerance";
            "worst_problem" "" = r.worst.map(|own| own.0), "number of the problem with the most decades; empty where it never lies";
            "worst_friction" "–" = r.worst.map(|own| own.1), "its friction coefficient";
        }
    }
}
