//! Records made by hand, for tests.

use stickslip_methods::Tier;

use super::costs::Costs;
use super::test_set::TestSet;
use crate::run::verdict::Verdict;
use crate::studies::origin::Origin;
use crate::studies::record::{Found, Judge, ProblemSize, Record, SolverError, Spent, Step};
use crate::studies::statistics::Timing;
use crate::studies::task::{Asked, Looks};

/// A timing with an interval of ±10 % about its median.
pub fn timing(median_s: f64) -> Timing {
    Timing {
        median_s,
        min_s: 0.85 * median_s,
        low_s: 0.9 * median_s,
        high_s: 1.1 * median_s,
        samples: 9,
    }
}

/// A solved cell of one increment without times: refinement 1, μ = 0.3, 10 iterations and 110 local solves on 11 points,
/// natural map half the tolerance, solver error the tolerance.
pub fn record(case: &str, method: &str, tolerance: f64) -> Record {
    let asked = Asked {
        case: case.into(),
        digest: "0123456789abcdef".into(),
        refine: 1,
        friction: vec![0.3],
        increments: 1,
        method: method.into(),
        tolerance,
        ..Asked::default()
    };
    let label = match method.split_once(':') {
        Some((name, options)) => format!("{name}[{options}]"),
        None => method.to_owned(),
    };
    let name = method.split(':').next().unwrap_or(method);
    let exact = !["penalty", "barrier", "nitsche"].contains(&name);
    Record {
        id: asked.id(),
        asked,
        class: String::new(),
        looks: Looks::default(),
        origin: Origin {
            version: "0.1.0".into(),
            commit: "abc".into(),
            dirty: "false".into(),
            sources: "0123456789abcdef".into(),
            rustc: "1.89".into(),
            profile: "release".into(),
            machine: "linux, one".into(),
        },
        found: Found {
            problem: Some(ProblemSize {
                mesh: "22x22".into(),
                space: "star".into(),
                h_m: 0.1,
                dim: 2,
                dofs: 1000,
                points: 11,
                unknowns: 22,
                uniform_stress: 0.0,
                joined: Vec::new(),
                moved: 0.0,
                unique: None,
                operator: None,
            }),
            increments: vec![Step {
                verdict: Verdict::Solved,
                increment: 1,
                judge: Judge {
                    natural_map: 0.5 * tolerance,
                    violation: 0.5 * tolerance,
                    ..Judge::of(None)
                },
                overlap_m: 0.0,
                states: [0, 0, 11],
                quantities: Vec::new(),
                iterations: 10,
                solves: 1,
                tangent_factorisations: 3,
                global_factorisations: 0,
                local_solves: 110,
                state_changes: 4,
                final_changes: 2,
            }],
            solver_error: Some(SolverError {
                reference: "b-newton".into(),
                reference_natural_map: 1e-15,
                energy: tolerance,
                force: tolerance,
                jump: tolerance,
            }),
            ..Found::only(Verdict::Solved, label, exact)
        },
        limits: None,
        spent: None,
        beside: None,
    }
}

/// The record with times: preparation 10 % and enforcement 90 % of `seconds`, the solution as much as both, each with an
/// interval of ±10 %; factorisation of K 0.1 s, the other stages 0.01 s.
pub fn timed(mut record: Record, seconds: f64) -> Record {
    record.spent = Some(Spent {
        setup_s: 0.01,
        assembly_s: 0.01,
        factorisation_s: 0.1,
        condensation_s: 0.01,
        factorisations: 1,
        steps: Vec::new(),
        prepare: timing(0.1 * seconds),
        solve: timing(seconds),
        enforcement: timing(0.9 * seconds),
        reported: None,
        output_s: 0.01,
        peak_mb: Some(40.0),
    });
    record
}

/// A record with this verdict that carries times all the same.
pub fn lying(verdict: &str) -> Record {
    let mut record = timed(record("plate", "latin", 1e-6), 123.4567);
    end_with(&mut record, verdict);
    record
}

/// Cells of one problem asked for 1e-6 and solved, by method and time [s].
pub fn solved(case: &str, times: &[(&str, f64)]) -> Vec<Record> {
    let cell = |(method, t): &(&str, f64)| timed(record(case, method, 1e-6), *t);
    times.iter().map(cell).collect()
}

/// A cell of a problem that a method gave up.
pub fn failed(case: &str, method: &str) -> Record {
    let mut failed = of_case(lying("gave-up: stalled"), case);
    failed.asked.method = method.into();
    failed.found.method = method.into();
    failed
}

/// Costs at the middle tier.
pub fn costs(records: &[Record]) -> Costs<'_> {
    Costs::new(&TestSet::new(records, Tier::Mid))
}

/// Gives a cell of one increment another verdict.
pub fn end_with(record: &mut Record, verdict: &str) {
    record.found.verdict = verdict.parse().expect("a verdict");
    record.found.increments[0].verdict = record.found.verdict.clone();
}

/// Another problem: the record with another case, and the id that belongs to it.
pub fn of_case(mut record: Record, case: &str) -> Record {
    record.asked.case = case.into();
    record.id = record.asked.id();
    record
}
