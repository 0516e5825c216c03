//! Other programs on the same problems.

use super::words::*;
use crate::report::table::{About, Description};

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
        printed: false,
        pivot: None,
        columns,
    }
}
