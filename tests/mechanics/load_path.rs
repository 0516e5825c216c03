//! Load paths: the state is the whole history; the discrete energy balance holds in every increment.

use std::sync::Arc;

use crate::common::*;
use stickslip::case::{Case, shipped};
use stickslip::model::body::{Body, Needs};
use stickslip::model::snapshot::Snapshot;
use stickslip::run::registry::methods;
use stickslip::run::verdict::Verdict;
use stickslip::studies::results::Results;
use stickslip_methods::{ContactState, ContactSystem, Increment, Options, Outcome, Silent, Status};

/// One body, one method, increments by hand.
struct Path {
    case: Case,
    body: Body,
    system: Arc<ContactSystem>,
}

impl Path {
    fn new(case: Case) -> Self {
        let needs = Needs {
            traction: true,
            ..Needs::default()
        };
        let body = Body::new(&case, 1, &needs).unwrap();
        let friction = friction(&case, &body);
        let system = ContactSystem::new(body.elastic.clone(), friction).unwrap();
        Path {
            case,
            body,
            system: Arc::new(system),
        }
    }

    /// Solves the increment after so many others by a new instance of a method.
    fn step(&self, method: &str, index: usize, start: &ContactState) -> Outcome {
        let loading = loading(&self.body, &self.case);
        let increment = loading.first() + index;
        let method = stickslip::run::registry::method(method).unwrap();
        let mut enforcement = (method.build)(&Options::new(method.options, &[]).unwrap());
        let increment = Increment {
            system: &self.system,
            load: &loading.at(increment),
            start_load: &loading.before(increment),
            start,
            guess: None,
            index,
            tolerance: self.case.tolerance,
        };
        let outcome = enforcement.solve(&increment, &mut Silent).unwrap();
        assert_eq!(outcome.status, Status::Converged);
        outcome
    }
}

/// Goal: no part of an answer is infinite or undefined unseen.
#[test]
fn mechanics_that_are_not_finite_are_no_answer() {
    let case = shipped::find("plate_mesh1").unwrap().unwrap();
    let body = Body::new(&case, 1, &Needs::default()).unwrap();
    let good = Snapshot::virgin(&body);
    assert_eq!(good.not_finite(), None);
    type Spoil = fn(&mut Snapshot, f64);
    let spoils: [(&str, Spoil); 7] = [
        ("displacements", |s, x| s.u[3] = x),
        ("jumps", |s, x| s.jump[1] = x),
        ("contact forces", |s, x| s.p[0] = x),
        ("nodal forces", |s, x| s.force[5] = x),
        ("energies", |s, x| s.strain_energy = x),
        ("energies", |s, x| s.work.friction[0] = x),
        ("energies", |s, x| s.work.identity = x),
    ];
    for (what, spoil) in spoils {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut bad = good.clone();
            spoil(&mut bad, value);
            assert_eq!(bad.not_finite(), Some(what));
        }
    }
}

fn bits(state: &ContactState) -> Vec<u64> {
    state
        .u
        .iter()
        .chain(&state.p)
        .map(|v| v.to_bits())
        .collect()
}

/// Goal: a method keeps no history: the path in one go, and every increment again from its stored start by a method that
/// never saw the others, in reverse order, give the same bits; and those of the harness's own run. Both paths begin with a
/// loaded state at time 0.
#[test]
fn an_increment_restarted_from_its_stored_state_gives_the_same_bits() {
    for name in ["sliding_block_cycle", "cyclic"] {
        let mut case = shipped::find(name).unwrap().unwrap();
        if name == "cyclic" {
            case.mesh.grid.lines =
                vec![(0..=9).map(|i| -2.0 + 4.0 * f64::from(i) / 9.0).collect(); 2];
        }
        let path = Path::new(case);
        let increments = path.case.path.increments;
        let steps = increments + 1;
        for method in methods() {
            let mut states = vec![ContactState::zero(&path.system)];
            for index in 0..steps {
                states.push(path.step(method.name, index, &states[index]).state);
            }
            for index in (0..steps).rev() {
                let again = path.step(method.name, index, &states[index]).state;
                assert!(
                    bits(&again) == bits(&states[index + 1]),
                    "{name} {} {index}",
                    method.name
                );
            }
            let results = run(&path.case, &[method.name]);
            let last = results
                .points()
                .into_iter()
                .filter(|p| p.key.increment == increments);
            let forces: Vec<f64> = last.flat_map(|p| [p.point.p_n, p.point.p_a]).collect();
            assert_eq!(forces, states[steps].p, "{name} {}", method.name);
        }
    }
}

/// Source: numerics, monotone loading of the confined block: slip never turns back. Goal: one increment gives what 2, 5
/// and 16 equal ones give. Tolerance 1e-10: each increment ends within 1e-13 of equilibrium.
#[test]
fn monotone_loading_does_not_depend_on_the_number_of_increments() {
    let mut case = shipped::find("sliding_block_embedded").unwrap().unwrap();
    case.sweep.refine = vec![1];
    case.sweep.friction = vec![0.2];
    case.expects.clear();
    // Side pressure from the first increment on, as the file says; the push grows.
    let mut found: Vec<Vec<f64>> = Vec::new();
    for increments in [1, 2, 5, 16] {
        case.path.increments = increments;
        let results = run(&case, &[METHOD]);
        let last = |q: [&str; 3]| value(&results, |k| k.increment == increments, q);
        found.push(vec![
            last(["reaction", "top", "y"]),
            last(["contact_force", "crack-1", "n"]),
            last(["contact_force", "crack-1", "a"]),
            last(["max_slip", "crack-1", ""]),
            last(["strain_energy", "", ""]),
        ]);
    }
    for other in &found[1..] {
        for (a, b) in other.iter().zip(&found[0]) {
            assert!((a - b).abs() < 1e-10 * b.abs(), "{a:e} {b:e}");
        }
    }
}

/// Per run: values of a quantity by increment.
fn histories(results: &Results, quantity: &str) -> Vec<(String, Vec<f64>)> {
    let mut found: Vec<(String, Vec<f64>)> = Vec::new();
    for q in results
        .quantities()
        .iter()
        .filter(|q| q.quantity.name == quantity && q.quantity.at.is_empty())
    {
        let k = &q.key;
        let run = format!("{} {} {} {}", k.case, k.mesh, k.method, k.friction);
        match found.last_mut() {
            Some((name, values)) if *name == run => values.push(q.quantity.value),
            _ => found.push((run, vec![q.quantity.value])),
        }
    }
    found
}

/// Source: statics, and the expectations of the cases, among them those of load cycles (E7). Goal: every 2D case has what it
/// expects by every exact method on its first mesh; supports and loads do what is stored and what the faces take, in every
/// increment and at time 0; and friction only takes energy.
///
/// Tolerance: that of equilibrium, 1e-12 in an accepted run, enters divided by the share of the strain energy in |K| |u|².
#[test]
fn every_2d_case_has_what_it_expects_its_energy_balances_and_friction_only_dissipates() {
    let exact = methods().iter().filter(|m| m.exact);
    let exact: Vec<&str> = exact.map(|m| m.name).collect();
    let (mut increments, mut dissipating) = (0, 0);
    for (name, _) in shipped::CASES {
        let mut case = shipped::find(name).unwrap().unwrap();
        if case.model.dim() == 3 {
            continue;
        }
        case.sweep.refine = vec![1];
        case.expects
            .retain(|e| e.refine.is_none_or(|refine| refine == 1));
        let results = run(&case, &exact);
        assert!(results.as_expected(), "{name}: {:?}", results.expectations);
        for row in results.increments() {
            assert_eq!(row.step.verdict, Verdict::Solved, "{:?}", row.key);
        }
        for (run, values) in histories(&results, "energy_identity") {
            let at_time_0 = results.increments()[0].key.increment == 0;
            let count = case.path.increments + usize::from(at_time_0);
            assert_eq!(values.len(), count, "{run}");
            for value in values {
                increments += 1;
                assert!(value < 1e-10, "{run}: {value:e}");
            }
        }
        let stored = histories(&results, "strain_energy");
        for ((run, values), (_, energy)) in histories(&results, "dissipation").iter().zip(&stored) {
            let size = energy.iter().fold(0.0f64, |m, e| m.max(*e));
            let mut before = 0.0;
            for &value in values {
                assert!(value >= before, "{run}: {before:e} {value:e}");
                dissipating += usize::from(value > before + 1e-3 * size);
                before = value;
            }
        }
    }
    assert!(
        increments > 100 && dissipating > 20,
        "{increments} {dissipating}"
    );
}
