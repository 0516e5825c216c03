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

/// The comparison with Siconos, which a script of `benches/peers` writes.
pub fn siconos() -> Description {
    let about = About::new;
    Description {
        name: "siconos_comparison",
        title: "Best exact method here beside the best solver of Siconos, to the same natural map of 1e-9",
        question: "How does the best method here compare with the best of another program?",
        notes: "Written by `benches/peers`, whose README says how both were run.",
        readable: true,
        columns: vec![
            about("problem", "", "name of the exported problem").shown(),
            about("dim", "", DIMENSION).shown(),
            about("points", "", POINTS).shown(),
            about("method", "", METHOD).shown(),
            about("iterations", "", ITERATIONS).shown(),
            about("natural_map", "–", NATURAL_MAP).digits(2),
            about("time_s", "s", "time of the method").digits(3),
            about("peer", "", "solver of Siconos").named("Siconos"),
            about("peer_iterations", "", "its iterations").named("its iterations"),
            about(
                "peer_natural_map",
                "–",
                "natural map of its answer, found by the judge here",
            )
            .named("its natural map")
            .digits(2),
            about("peer_time_s", "s", "its time")
                .named("its time")
                .digits(3),
            about("ratio", "–", "its time / ours")
                .named("its time / ours")
                .digits(3),
            about(
                "difference",
                "–",
                "largest difference of the contact forces, relative",
            )
            .named("difference of forces")
            .digits(2),
        ],
    }
}
