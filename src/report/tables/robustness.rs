//! The random robustness study: success rates with their confidence intervals, and every failure.

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
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
            "approximate_high" "" = r.approximate[0], "the method's own laws hold as claimed, and the contact laws to the tier `high`";
            "approximate_mid" "" = r.approximate[1], "the same for `mid`";
            "approximate_low" "" = r.approximate[2], "the same for `low`";
            "approximate_none" "" .named("laws to no tier") = r.approximate[3], "the method's own laws hold as claimed, the contact laws to no tier";
            "gave_up" "" .shown() = r.gave_up, "ended without a claim; the next six columns tell why";
            "max_iterations" "" = r.gave_up_by[0], "of these, at the limit of iterations";
            "stalled" "" = r.gave_up_by[1], "without progress";
            "singular_tangent" "" = r.gave_up_by[2], "at a matrix that cannot be factored";
            "mechanism" "" = r.gave_up_by[3], "at a body that is held by nothing";
            "no_equilibrium" "" = r.gave_up_by[4], "where no contact force within the cones of friction balances the load";
            "diverged" "" = r.gave_up_by[5], "with numbers that grew without bound";
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
        }
    }
}
