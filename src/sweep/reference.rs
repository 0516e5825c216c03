//! Solver error: the distance from the converged solution of the same discrete problem.
//!
//! ```text
//!   energy   ‖u − u*‖_K / ‖u*‖_K,  ‖v‖²_K = v·K v         force   |P − P*| / |P*|         jump   |[[u]] − [[u]]*| / |[[u]]*|
//! ```
//! the largest over the increments. Since u − u* = K⁻¹Bᵀ(P − P*), the first is the error of the contact forces in the norm
//! of the Delassus operator: it stays small where forces are not unique but their effect is. It does not see a rigid
//! motion of a floating piece, the third does.

use super::record::SolverError;
use super::setup::Scene;
use crate::harness::path::Path;
use crate::harness::quantities::Snapshot;
use crate::harness::record::RunKey;
use crate::harness::run::Choice;
use crate::harness::verdict::{Accuracy, Verdict};

/// Natural map of the converged solution, three decades below the highest tier.
const TOLERANCE: f64 = 1e-12;

/// Exact methods that converge superlinearly, the most robust one first.
const METHODS: [&str; 5] = ["hybrid", "b-newton", "pdas", "newton-ac", "interior-point"];

/// The converged solution, or that there is none.
pub enum Reference {
    /// Found by the method of this name, with the largest natural map over the increments.
    Found {
        /// Method.
        method: &'static str,
        /// Natural map.
        natural_map: f64,
        /// By increment.
        snapshots: Vec<Snapshot>,
    },
    /// No method reaches the tolerance.
    None,
}

/// Distance of some increments from the converged solution, which is found when it is first asked for; none if no method
/// reaches it.
pub fn solver_error(scene: &mut Scene<'_>, found: &[Snapshot]) -> Option<SolverError> {
    if scene.reference.is_none() {
        *scene.reference = Some(converged(scene));
    }
    let Some(Reference::Found {
        method,
        natural_map,
        snapshots,
    }) = &scene.reference
    else {
        return None;
    };
    let largest = |of: &dyn Fn(&Snapshot, &Snapshot) -> f64| {
        let pairs = found.iter().zip(snapshots);
        pairs.map(|(now, exact)| of(now, exact)).fold(0.0, f64::max)
    };
    let stiffness = &scene.body.stiffness;
    let square = |v: &[f64]| -> f64 {
        let kv = stiffness.mul(v);
        v.iter()
            .zip(&kv)
            .map(|(v, kv)| v * kv)
            .sum::<f64>()
            .max(0.0)
    };
    Some(SolverError {
        reference: (*method).to_owned(),
        reference_natural_map: *natural_map,
        energy: largest(&|now, exact| {
            let difference = difference(&now.u, &exact.u);
            ratio(square(&difference).sqrt(), square(&exact.u).sqrt())
        }),
        force: largest(&|now, exact| relative(&now.p, &exact.p)),
        jump: largest(&|now, exact| relative(&now.jump, &exact.jump)),
    })
}

/// Follows the path with one method after the other, until one is right all along.
fn converged(scene: &Scene<'_>) -> Reference {
    for name in METHODS {
        let Ok(choice) = Choice::parse(name) else {
            continue;
        };
        let path = Path {
            case: scene.case,
            loading: &scene.loading,
            system: scene.system,
            choice: &choice,
            accuracy: Accuracy::exactly(TOLERANCE),
        };
        let mut key = RunKey {
            case: scene.case.name.clone(),
            mesh: scene.body.label.clone(),
            space: scene.body.space.clone(),
            method: choice.label.clone(),
            friction: 0.0,
            increment: 1,
        };
        let (mut snapshots, mut natural_map) = (Vec::new(), 0.0_f64);
        path.follow(&mut key, &mut |_, ended| {
            if ended.verdict == Verdict::Solved {
                natural_map = natural_map.max(ended.run.natural_map);
                snapshots.extend(ended.now.cloned());
            }
        });
        if snapshots.len() == scene.case.path.increments {
            return Reference::Found {
                method: choice.method.name,
                natural_map,
                snapshots,
            };
        }
    }
    Reference::None
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn relative(found: &[f64], exact: &[f64]) -> f64 {
    ratio(norm(&difference(found, exact)), norm(exact))
}

/// Nothing beside nothing is no error.
fn ratio(difference: f64, size: f64) -> f64 {
    if difference == 0.0 {
        0.0
    } else {
        difference / size
    }
}
