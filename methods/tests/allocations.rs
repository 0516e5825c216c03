//! How often iterations ask for memory.

use allocation_counter::measure;
use stickslip_methods::*;

use crate::toys::*;

/// Stops a method at an iteration.
struct StopAt(usize);

impl Monitor for StopAt {
    fn step(&mut self, iteration: usize, _violation: f64) -> bool {
        iteration < self.0
    }
}

/// Requests for memory by `more` iterations after the first three, by method.
fn requests(m: &Method, s: &ContactSystem, load: &Load, more: usize) -> u64 {
    let (rest, start) = (Load::zero(s.elastic()), ContactState::zero(s));
    let posed = increment(s, load, &rest, &start, 1e-300);
    let mut solver = build(m, &[]);
    let mut count = |last: usize| {
        let mut iterations = 0;
        let found = measure(|| {
            let outcome = solver.solve(&posed, &mut StopAt(last)).unwrap();
            iterations = outcome.counters.iterations;
        });
        assert_eq!(iterations, last, "{} ended by itself", m.name);
        found.count_total
    };
    // The first solve makes what all others use again.
    count(3);
    count(3 + more) - count(3)
}

/// Goal: an iteration works in the memory of the one before. On 36 rows, where `hybrid` runs Newton's method: larger dense
/// factorisations borrow blocks, and floating bodies balance forces.
#[test]
fn iterations_of_newton_and_splitting_methods_ask_for_no_memory() {
    let mut rng = Random(33);
    let (k, b) = random_body(&mut rng, 3, 12, 10, 0.1);
    let s = system(&elastic(3, &k, &b, vec![], false), 0.6);
    let load = force(&s, &rng.vector(k.len()));
    for name in [
        "b-newton",
        "newton-ac",
        "pdas",
        "gnm",
        "ncp-newton",
        "hybrid",
        "interior-point",
        "nsgs",
        "latin",
        "admm",
        "projection",
        "augmented-lagrangian",
        "accelerated-gradient",
    ] {
        let found = requests(method(name).unwrap(), &s, &load, 6);
        assert_eq!(found, 0, "{name}");
    }
}
