//! How often methods solve random, strongly coupled systems, and in how many iterations: the source of the counts on the
//! pages of the methods. Takes minutes, so it runs only when asked for:
//! ```text
//! cargo test --release -p stickslip-methods --test all robustness -- --ignored --nocapture
//! ```
//! K = MᵀM/n + 0.05 I with n unknowns and M uniform in [−1, 1), B = I + 0.3 R with R likewise, off the diagonal, and a
//! load uniform in [−1, 1): every point feels every other, and its normal and tangential rows are as strongly coupled as
//! rows of different points. Counts hold for this family; other random systems are harder or kinder.

use std::sync::Arc;

use crate::toys::*;
use stickslip_methods::*;

const SYSTEMS: u64 = 100;
const POINTS: usize = 12;
const INTERIOR: usize = 12;
const FRICTIONS: [f64; 6] = [0.1, 0.3, 0.6, 1.0, 2.0, 5.0];
const TOLERANCE: f64 = 1e-9;

/// System `k` of a dimension is that of seed 1000 dim + k; its load is the same for all frictions.
fn systems(dim: usize) -> Vec<(Arc<Elastic>, Vec<f64>)> {
    let one = |k: u64| {
        let mut rng = Random(1000 * dim as u64 + k);
        let (stiffness, jump) = random_body(&mut rng, dim, POINTS, INTERIOR, 0.05);
        let body = elastic(dim, &stiffness, &jump, vec![], false);
        let load = rng.vector(body.unknowns());
        (body, load)
    };
    (0..SYSTEMS).map(one).collect()
}

/// Every method that needs no stress, and what the variants and accelerations of some are worth.
fn candidates() -> Vec<(&'static Method, Vec<(&'static str, f64)>)> {
    let mut all: Vec<_> = general().map(|m| (m.method, vec![])).collect();
    for (name, option) in [
        ("socp", ("anderson", 0.0)),
        ("tresca", ("anderson", 0.0)),
        ("admm", ("over_relaxation", 1.0)),
        ("gnm", ("return_map", 0.0)),
        ("nsgs", ("anderson", 5.0)),
        ("latin", ("anderson", 5.0)),
        ("admm", ("anderson", 5.0)),
    ] {
        all.push((method(name).unwrap(), vec![option]));
    }
    all
}

/// Median iterations of the systems solved, and how many failed.
fn tally(
    m: &Method,
    options: &[(&str, f64)],
    bodies: &[(Arc<Elastic>, Vec<f64>)],
    mu: f64,
) -> (usize, usize) {
    let mut iterations = Vec::new();
    for (body, f) in bodies {
        let s = system(body, mu);
        let load = force(&s, f);
        let outcome = run(m, options, &s, &load, TOLERANCE);
        if outcome.status != Status::Converged {
            continue;
        }
        let (rest, start) = (Load::zero(body), ContactState::zero(&s));
        let i = increment(&s, &load, &rest, &start, TOLERANCE);
        let judged = residuals_of(&i, &outcome.state, outcome.claim).unwrap();
        let holds = judged.claimed <= TOLERANCE && judged.claimed_equilibrium <= 1e-12;
        assert!(holds, "{} μ {mu}: {judged:?}", m.name);
        iterations.push(outcome.counters.iterations);
    }
    iterations.sort_unstable();
    let median = iterations.get(iterations.len() / 2).copied().unwrap_or(0);
    (median, bodies.len() - iterations.len())
}

#[test]
#[ignore = "takes minutes"]
fn failures_and_median_iterations_on_random_strongly_coupled_systems() {
    let mut unsolved = 0;
    for dim in [2, 3] {
        let bodies = systems(dim);
        println!("\n{dim}D, {SYSTEMS} systems per entry: median iterations, failures");
        let head: Vec<String> = FRICTIONS.iter().map(|mu| format!("{mu:>10}")).collect();
        println!("{:<32}{}", "μ", head.join(" "));
        for (m, options) in candidates() {
            let entry = |mu: &f64| {
                let (median, failures) = tally(m, &options, &bodies, *mu);
                // At so little friction nothing may fail.
                unsolved += if m.exact && *mu <= 0.1 { failures } else { 0 };
                format!("{median:>5}, {failures:>3}")
            };
            let entries: Vec<String> = FRICTIONS.iter().map(entry).collect();
            let given = options
                .first()
                .map_or(String::new(), |o| format!(" {} {}", o.0, o.1));
            println!("{:<32}{}", format!("{}{given}", m.name), entries.join(" "));
        }
    }
    assert_eq!(unsolved, 0, "at μ = 0.1 every exact method solves all");
}

/// Goal: where friction is so large that solutions vanish along the way, a path that is followed by arc length goes round.
#[test]
fn a_path_followed_by_arc_length_ends_at_a_solution_where_others_stall() {
    let failures = |name: &str| -> usize {
        let of = |dim| tally(method(name).unwrap(), &[], &systems(dim), 5.0).1;
        of(2) + of(3)
    };
    assert_eq!([failures("ipm-anm"), failures("hybrid")], [0, 0]);
    assert!(failures("interior-point") > 5);
}
