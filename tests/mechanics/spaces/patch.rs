//! Patch tests: bodies in uniform stress, whose contact tractions a sound contact space finds to rounding.
//!
//! ```text
//!   traction error       max over the contact points |P/w − t|, t = −σ n in the frame of the point, over max |σ_ab|
//!   displacement error   max |u_h − u| over the nodes and max |[[u_h]] − [[u]]| over the crack, over max |u|
//! ```
//!
//! Taylor, Simo, Zienkiewicz & Chan, Int. J. Numer. Meth. Engng 22 (1986) 39, asked it of elements; of cut cells it asks
//! more: the answer may not depend on how close the crack comes to a node. [`catalogue`](super::catalogue) lists bodies and
//! cracks, [`rows`] runs them through the normal path of a case.

use std::collections::BTreeSet;

use crate::common::{choices, friction, loading, parse, sides};
use rayon::prelude::*;
use stickslip::case::{Case, ContactSpace};
use stickslip::model::body::{Body, Needs};
use stickslip::model::snapshot::Snapshot;
use stickslip::run::loads::{Loads, Posed};
use stickslip::run::path::{Guess, Run};
use stickslip::run::verdict::{Accuracy, Verdict};
use stickslip::studies::statistics::larger;
use stickslip_methods::{ContactSystem, Tier};
use stickslip_xfem::exact::{Field, Setting, solution};
use stickslip_xfem::geometry::{dot, norm, sub};

use super::catalogue::{Patch, State};
use super::text::PRESSURE;

/// Largest errors of a patch test that counts as passed.
const PASSED: f64 = 1e-10;

/// One patch test in one contact space.
#[derive(Debug)]
pub struct PatchRow {
    /// Course of the crack.
    pub state: State,
    /// Shape and direction of the crack.
    pub crack: String,
    /// Distance of the crack from a node in cell sizes; positive with the node on side 2.
    pub distance: f64,
    /// Contact space.
    pub space: String,
    /// Verdict on the run; refused where there is no body to run.
    pub verdict: Verdict,
    /// Traction error; NaN without an honest verdict.
    pub traction: f64,
    /// Displacement error; NaN without an honest verdict.
    pub displacement: f64,
    /// How far the crack was moved to what it nearly touches, in cell sizes, as the body tells.
    pub moved: f64,
}

impl PatchRow {
    /// Whether both errors are below [`PASSED`], of the crack as it is told: one bent by so much at one place turns by ten times
    /// as much where that lies a tenth of a cell from the next.
    pub fn passed(&self) -> bool {
        let most = PASSED + 10.0 * self.moved;
        self.traction <= most && self.displacement <= most
    }
}

/// Runs patch tests in some contact spaces, in the order given, by a method that takes whatever contact state comes; what the
/// discretisation refuses is a row.
pub fn rows(patches: &[Patch], spaces: &[ContactSpace]) -> Vec<PatchRow> {
    assert!(!patches.is_empty());
    let of_patch = |patch: &Patch| {
        let mut seen = BTreeSet::new();
        let mut case = parse(&patch.text);
        let mut row = |&space: &ContactSpace| {
            case.cracks.iter_mut().for_each(|c| c.contact = space);
            run(patch, &case, space)
        };
        let mut rows: Vec<PatchRow> = spaces.iter().map(&mut row).collect();
        rows.retain(|row| seen.insert(row.space.clone()));
        rows
    };
    patches.par_iter().flat_map(of_patch).collect()
}

/// One patch test in the contact space of its case.
fn run(patch: &Patch, case: &Case, space: ContactSpace) -> PatchRow {
    let row = |space: &str, verdict| PatchRow {
        state: patch.state,
        crack: patch.crack.clone(),
        distance: patch.distance,
        space: space.to_owned(),
        verdict,
        traction: f64::NAN,
        displacement: f64::NAN,
        moved: 0.0,
    };
    let choices = choices(&["hybrid"]);
    let needs = Needs {
        frictionless: case.cracks.iter().map(|c| c.friction == 0.0).collect(),
        traction: choices[0].needs_traction(),
    };
    let body = match Body::new(case, 1, &needs) {
        Ok(body) => body,
        Err(refused) => return row(space.name(), Verdict::Refused(refused.to_string())),
    };
    let system = ContactSystem::new(body.elastic.clone(), friction(case, &body)).unwrap();
    let loading = loading(&body, case);
    let run = Run {
        posed: Posed {
            system: &system,
            loads: Loads::Body(&loading),
        },
        choice: &choices[0],
        accuracy: Accuracy::of(case, Tier::High),
        guess: Guess::Before,
    };
    let end = run.follow(&mut |_| ());
    let mut row = row(&body.space, end.verdict);
    let Some(now) = end.now else { return row };
    let hydrostatic;
    let field = match loading.exact(case.path.increments) {
        Some(field) => field,
        None => {
            hydrostatic = pressed(case);
            hydrostatic.as_ref()
        }
    };
    let moved = body.moved.iter().map(|m| norm(&sub(&m.from, &m.to)));
    row.moved = moved.fold(0.0, f64::max) / body.mesh.smallest_edge();
    row.traction = traction_error(&body, field, &now);
    row.displacement = displacement_error(case, &body, field, &now);
    row
}

/// Hydrostatic pressure about the middle of the first crack: the closed form of several cracks.
fn pressed(case: &Case) -> Box<dyn Field> {
    let spec = solution("uniform-stress").unwrap();
    let setting = Setting {
        material: case.material,
        model: case.model,
        friction: 0.0,
        crack: &case.cracks[0].geometry,
        body: [[0.0; 3]; 2],
    };
    let value = |name: &str, default: Option<f64>| match name {
        "stress_xx_pa" | "stress_yy_pa" => -PRESSURE,
        _ => default.unwrap_or_default(),
    };
    let parameters = spec.parameters.iter();
    let stress: Vec<f64> = parameters.map(|p| value(p.name, p.default)).collect();
    (spec.build)(&setting, &stress).unwrap().at(&[1.0]).unwrap()
}

fn traction_error(body: &Body, field: &dyn Field, now: &Snapshot) -> f64 {
    let dim = body.mesh.dim();
    let (mut worst, mut size) = (0.0, 0.0);
    for (point, p) in body.points.iter().zip(now.p.chunks_exact(dim)) {
        let stress = field.stress(&point.x, 1.0);
        let on_normal = stress.map(|row| dot(&row, &point.frame[0]));
        let difference: Vec<f64> = (0..dim)
            .map(|k| p[k] / point.weight + dot(&point.frame[k], &on_normal))
            .collect();
        worst = larger(worst, difference.iter().map(|d| d * d).sum::<f64>().sqrt());
        let components = stress.as_flattened().iter();
        size = components.fold(size, |m: f64, s| m.max(s.abs()));
    }
    worst / size
}

fn displacement_error(case: &Case, body: &Body, field: &dyn Field, now: &Snapshot) -> f64 {
    let dim = body.mesh.dim();
    let integrator = body.integrator();
    let sides = sides(case, body);
    let (mut worst, mut size) = (0.0, 0.0);
    for (node, x) in body.mesh.nodes.iter().enumerate() {
        let side = sides.as_ref().map_or(1.0, |s| s.of_node(node));
        let exact = field.displacement(x, side);
        let mut found = [0.0; 3];
        found[..dim].copy_from_slice(&now.u[node * dim..(node + 1) * dim]);
        worst = larger(worst, norm(&sub(&found, &exact)));
        size = larger(size, norm(&exact));
    }
    for q in &body.surface.quadrature {
        let found = q.local(&q.jump(&integrator, &now.u));
        worst = larger(worst, norm(&sub(&found, &field.jump(&q.x))));
    }
    worst / size
}
