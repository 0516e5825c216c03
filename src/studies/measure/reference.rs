//! Solver error: the distance from the converged solution of the same discrete problem.
//!
//! ```text
//!   energy   ‖u − u*‖_K / max ‖u*‖_K,  ‖v‖²_K = v·K v
//!   force    |P − P*| / max |P*|
//!   jump     max_i |[[u]] − [[u]]*|_i / max |u*|_i         relative to the largest displacement: a sticking crack has no jump
//! ```
//! the largest over the increments, as are the scales. Since u − u* = K⁻¹Bᵀ(P − P*), the first is the error of the contact forces in the norm
//! of the Delassus operator: it stays small where forces are not unique but their effect is. It does not see a rigid
//! motion of a floating piece, the third does.
//!
//! The converged solution follows the path in the increments of the cell: where friction remembers the path, that of other
//! increments is the answer to another question. It begins each where the last one ended, whatever the cell does.
//!
//! No method is measured against itself: the converged solution for `hybrid` is that of the next method.

use super::bench::{Reference, Scene};
use crate::model::snapshot::Snapshot;
use crate::run::choice::Choice;
use crate::run::path::{Guess, Run};
use crate::run::verdict::Accuracy;
use crate::studies::record::SolverError;

/// Natural map of the converged solution, three decades below the highest tier.
const TOLERANCE: f64 = 1e-12;

/// Exact methods that converge superlinearly, the most robust one first.
const METHODS: [&str; 5] = ["hybrid", "b-newton", "pdas", "newton-ac", "interior-point"];

/// Distance of some increments, found by the method of that name, from the converged solution, which is found when it is
/// first asked for; none if no other method reaches it, or where the solution is zero and the answer is not.
pub fn solver_error(scene: &Scene<'_>, found: &[Snapshot], own: &str) -> Option<SolverError> {
    let mut known = scene.references();
    let mut others = METHODS.into_iter().filter(|name| *name != own);
    let name = others.find(|name| {
        let tried = known.entry(name).or_insert_with(|| follow(scene, name));
        tried.is_some()
    });
    let reference = name.and_then(|name| Some((name, known.get(name)?.as_ref()?)));
    reference.and_then(|(name, own)| distance(scene, found, name, own))
}

fn distance(
    scene: &Scene<'_>,
    found: &[Snapshot],
    method: &str,
    reference: &Reference,
) -> Option<SolverError> {
    let Reference {
        natural_map,
        snapshots,
    } = reference;
    let largest = |of: &dyn Fn(&Snapshot, &Snapshot) -> f64, size: &dyn Fn(&Snapshot) -> f64| {
        let pairs = found.iter().zip(snapshots);
        let difference = pairs.map(|(now, exact)| of(now, exact)).fold(0.0, f64::max);
        let scale = snapshots.iter().map(size).fold(0.0, f64::max);
        // Nothing beside nothing is no error.
        let ratio = if difference == 0.0 {
            0.0
        } else {
            difference / scale
        };
        Some(ratio).filter(|ratio| ratio.is_finite())
    };
    let (_, loading) = scene.body()?;
    let stiffness = &loading.body().stiffness;
    let square = |v: &[f64]| -> f64 {
        let kv = stiffness.mul(v);
        v.iter()
            .zip(&kv)
            .map(|(v, kv)| v * kv)
            .sum::<f64>()
            .max(0.0)
    };
    Some(SolverError {
        reference: method.to_owned(),
        reference_natural_map: *natural_map,
        energy: largest(
            &|now, exact| square(&difference(&now.u, &exact.u)).sqrt(),
            &|exact| square(&exact.u).sqrt(),
        )?,
        force: largest(
            &|now, exact| norm(&difference(&now.p, &exact.p)),
            &|exact| norm(&exact.p),
        )?,
        jump: largest(
            &|now, exact| most(&difference(&now.jump, &exact.jump)),
            &|exact| most(&exact.u),
        )?,
    })
}

/// The solution of a method that is right to the tolerance all along the path.
fn follow(scene: &Scene<'_>, name: &'static str) -> Option<Reference> {
    let choice = Choice::parse(name).ok()?;
    let run = Run {
        posed: scene.posed(),
        choice: &choice,
        accuracy: Accuracy::exactly(TOLERANCE),
        guess: Guess::Before,
    };
    let (mut snapshots, mut natural_map) = (Vec::new(), 0.0_f64);
    run.follow(&mut |moment| {
        let solved = moment.solved;
        if let Some(judged) = (solved.judged.as_ref()).filter(|_| solved.verdict.is_solved()) {
            natural_map = natural_map.max(judged.found.natural_map);
            snapshots.extend(moment.now.cloned());
        }
    });
    let loads = run.posed.loads;
    let complete = snapshots.len() == loads.last() + 1 - loads.first();
    complete.then_some(Reference {
        natural_map,
        snapshots,
    })
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn most(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, x| f64::max(most, x.abs()))
}
