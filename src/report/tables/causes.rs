//! Why runs gave up.

use super::words::*;
use crate::report::table::{Column, Row, columns};
use crate::studies::analysis::causes::{CauseRow, StoppingRow};

impl Row for CauseRow {
    const NAME: &'static str = "causes";
    const TITLE: &'static str = "Why methods gave up, and what remedies it";
    const QUESTION: &'static str = "Why does a method give up, how often for which cause, and what solves the problem instead?";
    const NOTES: &'static str = "Every run that gave up is run again under observation; the method does not know. Causes are measurements with thresholds, asked in a fixed order: docs/stability.md has them. A remedy is tried on every failed run: the method with one other option (`r`, `kinks`, `anderson`, `spectral`, `step`, `variant`), then `newton-ac`, `pdas`, `hybrid`, `interior-point`; the first that solves it counts.";

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
            "remedied" "" .shown() = r.remedied, "of these runs, with a remedy";
            "remedy" "" .shown() = r.remedy.clone(), "the remedy that worked most often";
            "example" "" = r.example.0.clone(), "the problem with the fewest contact points";
            "example_friction" "–" .named("its μ") = r.example.1, "its friction coefficient";
            "example_points" "" .named("its points") = r.example.2, "its contact points";
        }
    }
}

impl Row for StoppingRow {
    const NAME: &'static str = "stopping";
    const TITLE: &'static str = "Published stopping tests beside the violation of the contact laws";
    const QUESTION: &'static str = "Which stopping test lies, how often, and by how many decades?";
    const NOTES: &'static str = "All methods run once more, asked for tier `high` whatever the study asks for, and every test is evaluated on every iterate; nothing stops by it. A test lies where the violation at its first stop exceeds the tolerance it is used with, or, of an approximate method, what the run ends with if that is more. Programs from outside show no iterates.";

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
            "worst_problem" "" = r.worst.as_ref().map(|own| own.0.clone()), "problem with the most decades; empty where it never lies";
            "worst_friction" "–" = r.worst.as_ref().map(|own| own.1), "its friction coefficient";
        }
    }
}
