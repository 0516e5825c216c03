//! One method on a scene: whether it did what it is for, and else why not.

use super::finding::{Cause, Trial};
use crate::run::record::{Results, RunRow};
use crate::run::registry::methods;
use crate::run::verdict::Verdict;
use stickslip_methods::{SWAYING, Status};

/// A method that stopped within this many times its tolerance stopped at rounding.
const FLOOR: f64 = 1e3;

/// One method: whether it did what it is for, and else why not.
pub fn trial(row: &RunRow, results: &Results) -> Trial {
    let own = results.history.iter().filter(|h| h.key == row.key);
    let runs = results
        .runs
        .iter()
        .filter(|r| r.key.method == row.key.method);
    let history: Vec<f64> = own.map(|h| h.violation).collect();
    let name = row.key.method.split('[').next();
    let exact = methods().iter().find(|m| Some(m.name) == name);
    let exact = exact.is_some_and(|m| m.exact);
    let cause = match &row.verdict {
        Verdict::Solved | Verdict::Several | Verdict::Suspect(_) => None,
        Verdict::Approximate(_) if !exact => None,
        Verdict::Approximate(_) | Verdict::GaveUp(_) => Some(gave_up(row, &history)),
        Verdict::FalseClaim => Some(Cause::FalseClaim),
        Verdict::Refused(_) => Some(Cause::Declined),
        Verdict::Crashed(_) => Some(Cause::Factorisation),
        Verdict::TimedOut => Some(Cause::Time),
        Verdict::OutOfMemory => Some(Cause::Memory),
    };
    Trial {
        method: row.key.method.clone(),
        exact,
        verdict: row.verdict.clone(),
        iterations: runs.map(|r| r.iterations).sum(),
        violation: row.violation.is_finite().then_some(row.violation),
        cause,
    }
}

/// Why a method ended without a claim, from how it ended and how it went.
fn gave_up(row: &RunRow, history: &[f64]) -> Cause {
    /// Tolerance of the scenes.
    const ASKED: f64 = 1e-12;
    match row.verdict {
        Verdict::GaveUp(Status::NoEquilibrium) => Cause::NoEquilibrium,
        Verdict::GaveUp(Status::SingularTangent | Status::Mechanism) => Cause::SingularTangent,
        Verdict::GaveUp(Status::Diverged) => Cause::Diverged,
        _ if row.violation <= FLOOR * ASKED => Cause::Floor,
        _ if period(history).is_some() => Cause::Cycling,
        _ if still_falls(history) => Cause::Slow,
        _ if row.sway > SWAYING => Cause::Swaying,
        _ if wanders(history) => Cause::Wandering,
        _ => Cause::Stalled,
    }
}

/// After how many iterations the violation repeats, at the end of a history.
fn period(history: &[f64]) -> Option<usize> {
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    (2..=12).find(|&p| {
        let tail = 3 * p;
        history.len() > tail && {
            let last = &history[history.len() - tail..];
            let moves = last.windows(2).any(|w| !same(w[0], w[1]));
            moves && (p..tail).all(|i| same(last[i], last[i - p]))
        }
    })
}

/// Whether the violation was halved at least over the last half of a history.
fn still_falls(history: &[f64]) -> bool {
    let n = history.len();
    n >= 4 && history[n - 1] < 0.5 * history[n / 2]
}

/// Whether the violation changes by more than a hundredth in most of the last steps.
fn wanders(history: &[f64]) -> bool {
    let last = &history[history.len() / 2..];
    let moves = last.windows(2).filter(|w| (w[1] / w[0] - 1.0).abs() > 0.01);
    2 * moves.count() > last.len()
}
