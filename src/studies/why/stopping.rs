//! Published stopping tests beside the violation of the contact laws: when each would have stopped, and how far off.
//!
//! Tests by what changes between iterates say that a method moves little, not that it has arrived: at a rate of 1 − δ what is
//! left is 1/δ times the last change. Here they are evaluated on all iterates of runs that stop by the violation.

use serde::{Deserialize, Serialize};

use super::watch::Seen;

/// Tolerance of tests that compare real numbers, and of the violation they are held to: tier `mid`.
const TOLERANCE: f64 = 1e-6;

/// Violation that a test on states alone is held to: tier `high`. It claims that the last linear problem was the solution.
const FINITE: f64 = 1e-9;

/// A stopping test.
#[derive(Debug, Clone, Copy)]
pub struct Criterion {
    /// Name in tables.
    pub name: &'static str,
    /// Who published it, in which form.
    pub source: &'static str,
    /// Methods it belongs to; empty: all.
    pub methods: &'static [&'static str],
    /// The comparison it makes.
    measure: fn(&Seen) -> f64,
    /// At most this stops.
    bound: f64,
    /// Violation that its user believes to have reached.
    pub tolerance: f64,
}

/// All tests, in the order of tables.
pub const CRITERIA: [Criterion; 6] = [
    Criterion {
        name: "unchanged-states",
        source: "Alart & Curnier 1991; Hüeber, Stadler & Wohlmuth 2008: no point changes between open, stick and slip",
        methods: &[],
        measure: |seen| seen.changes as f64,
        bound: 0.0,
        tolerance: FINITE,
    },
    Criterion {
        name: "force-change",
        source: "Simo & Laursen 1992; Acary & Brémond 2008: |P_k − P_{k−1}| / |P_k|",
        methods: &[],
        measure: |seen| seen.force_change,
        bound: TOLERANCE,
        tolerance: TOLERANCE,
    },
    Criterion {
        name: "reaction-increment",
        source: "Jean 1999: largest change of a reaction in a sweep over the largest reaction",
        methods: &["nsgs", "projection", "hybrid"],
        measure: |seen| seen.point_change,
        bound: TOLERANCE,
        tolerance: TOLERANCE,
    },
    Criterion {
        name: "penetration",
        source: "Simo & Laursen 1992: deepest penetration over the reference jump",
        methods: &["augmented-lagrangian", "penalty"],
        measure: |seen| seen.penetration,
        bound: TOLERANCE,
        tolerance: TOLERANCE,
    },
    Criterion {
        name: "latin-indicator",
        source: "Ladevèze 1999: |s_k − s_{k−1}| / |s_k + s_{k−1}|, s = (P, ρ v)",
        methods: &["latin"],
        measure: |seen| seen.pair_change,
        bound: TOLERANCE,
        tolerance: TOLERANCE,
    },
    Criterion {
        name: "force-and-jump-change",
        source: "Boyd et al. 2011: primal and dual residual, as relative changes of P and v",
        methods: &["admm"],
        measure: |seen| seen.force_change.max(seen.jump_change),
        bound: TOLERANCE,
        tolerance: TOLERANCE,
    },
];

/// Course of one test in one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// Name of the test.
    pub criterion: String,
    /// Iteration at which it stops, from 0; `None` if it never does.
    pub at: Option<usize>,
    /// Iteration at which the violation is at most what the test is held to.
    pub reached: Option<usize>,
    /// log10 of the violation where it stops over what it is held to; 0 where that is reached.
    pub decades: f64,
}

/// Evaluates every test of a method on its iterates. What an approximate method is held to is not below what it ends with.
pub fn evaluate(method: &str, exact: bool, seen: &[Seen]) -> Vec<Stop> {
    let own = match (exact, seen.last()) {
        (false, Some(last)) => last.violation,
        _ => 0.0,
    };
    let applies = |c: &&Criterion| c.methods.is_empty() || c.methods.contains(&method);
    let criteria = CRITERIA.iter().filter(applies);
    // Without an iteration there is nothing to stop.
    let criteria = criteria.filter(|_| seen.len() > 1);
    criteria
        .map(|c| {
            let held_to = c.tolerance.max(own);
            let at = (1..seen.len()).find(|&k| (c.measure)(&seen[k]) <= c.bound);
            let off = at.map_or(0.0, |k| (seen[k].violation / held_to).log10());
            Stop {
                criterion: c.name.to_owned(),
                at,
                reached: seen.iter().position(|own| own.violation <= held_to),
                decades: off.max(0.0),
            }
        })
        .collect()
}
