//! What `cargo bench` measured, and other programs on the same problems.

use super::words::*;
use crate::report::table::{About, Column, Description, Order, Row, columns};
use crate::report::timings::TimingRow;
use crate::run::verdict::Verdict;

impl Row for TimingRow {
    const NAME: &'static str = "timings";
    const TITLE: &'static str =
        "Wall times on one thread: median of the samples with its 95 % interval";
    const QUESTION: &'static str = "What do the stages and the methods take on this machine?";
    const NOTES: &'static str = "One row per benchmark with a result of this build: a file of criterion's counts if it is newer than the executable that makes it, whatever run of that executable it comes from. A sample is one call, or the mean of as many calls as fit into its share of the measuring time. The interval covers the scatter within the fraction of a second that a benchmark is measured; a machine that is slower a minute later is another machine. Two medians whose intervals overlap are not told apart.";
    const ORDER: Order<Self> = Order::By(|a, b| a.name.cmp(&b.name));

    fn columns() -> Vec<Column<Self>> {
        columns! { r: Self,
            "group" "" .shown() = r.name.group.clone(), "`discretisation/`, `enforcement/` or `end_to_end/`, then the case, with the mesh, for methods the friction coefficient";
            "function" "" .shown() = r.name.function.clone(), "`mesh to system` (everything up to K and B), of it `assembly` (cell matrices and their sum), `factorisation` (of K), `condensation` (to W); `prepare` and `solve` of a method, from K factored and condensed to a natural map of 1e-9, with an instance that has seen nothing; in `end_to_end/` the method, or `all methods`: all meshes and friction coefficients of the case file, judged and written to memory";
            "value" "" .shown() = r.name.value.clone(), "method; else empty";
            "verdict" "" .shown() = r.verdict.as_ref().map_or_else(String::new, Verdict::to_string), "as in `runs.csv`, of the answer that was timed; empty where there is none, or more than one: those are timed only if no run failed and every expected number came out as stated";
            "samples" "" .shown() = r.timing.samples, "number of samples";
            "median_s" "s" .time().digits(3) = r.timing.median_s, "median of the samples";
            "low_s" "s" .time().digits(3) = r.timing.low_s, "lower end of the 95 % interval of the median by order statistics (binomial, no distribution assumed); of fewer than six samples the least";
            "high_s" "s" .time().digits(3) = r.timing.high_s, "upper end; of fewer than six samples the largest";
            "min_s" "s" .time().digits(3) = r.timing.min_s, "least sample";
        }
    }
}

/// The comparison with solvers of other programs, which the scripts of `benches/peers` write.
pub fn peers() -> Description {
    let about = About::new;
    let mut columns = vec![
        about("problem", "", "name of the exported problem").shown(),
        about("dim", "", DIMENSION).shown(),
        about("points", "", POINTS).shown(),
        about(
            "method",
            "",
            "the fastest exact method here, with default options",
        )
        .shown(),
        about("iterations", "", ITERATIONS).shown(),
        about("time_s", "s", "its time").digits(3),
        about(
            "default_iterations",
            "",
            "iterations of `hybrid`, the default",
        )
        .named("of hybrid"),
        about("default_time_s", "s", "its time")
            .named("hybrid")
            .digits(3),
    ];
    for (name, title, solver, iterations, time, ratio, of_default) in [
        (
            "siconos",
            "Siconos",
            "its fastest solver",
            "siconos_iterations",
            "siconos_time_s",
            "siconos_ratio",
            "siconos_default_ratio",
        ),
        (
            "pinocchio",
            "Pinocchio",
            "its fastest solver",
            "pinocchio_iterations",
            "pinocchio_time_s",
            "pinocchio_ratio",
            "pinocchio_default_ratio",
        ),
    ] {
        columns.extend([
            about(name, "", solver).named(title),
            about(iterations, "", "its iterations").named("its iterations"),
            about(time, "s", "its time").named("its time").digits(3),
            about(ratio, "–", "its time over that of the fastest method here")
                .named("over ours")
                .digits(3),
            about(of_default, "–", "its time over that of `hybrid`")
                .named("over hybrid")
                .digits(3),
        ]);
    }
    columns.extend([
        about(
            "difference",
            "–",
            "largest difference of the contact forces to those of the first peer, relative",
        )
        .named("difference of forces")
        .digits(2),
        about(
            "jump_difference",
            "–",
            "the same of the jumps, relative to those without contact forces",
        )
        .named("of jumps")
        .digits(2),
    ]);
    Description {
        name: "peer_comparison",
        title: "The fastest exact method here and the default beside the fastest solvers of other programs, to the same natural map of 1e-9",
        question: "How do the methods here compare with the best of other programs?",
        notes: "Written by `benches/peers`, whose README says how all were run.",
        readable: true,
        columns,
    }
}
