//! Patch tests: bodies in uniform stress, whose contact tractions a sound contact space finds to rounding.
//!
//! ```text
//!   traction error       max over the contact points |P/w − t|, t = −σ n in the frame of the point, over max |σ_ab|
//!   displacement error   max |u_h − u| over the nodes and max |[[u_h]] − [[u]]| over the crack, over max |u|
//! ```
//!
//! Taylor, Simo, Zienkiewicz & Chan, Int. J. Numer. Meth. Engng 22 (1986) 39, asked it of elements; of cut cells it asks
//! more: the answer may not depend on how close the crack comes to a node. [`catalogue`] lists bodies and cracks, [`run`]
//! runs them through the normal path of a case.

mod catalogue;
mod text;

pub use catalogue::{DISTANCES, Loaded, Patch, State, catalogue, flat, solid};

use std::collections::BTreeSet;

use rayon::prelude::*;
use stickslip_methods::Tier;
use stickslip_xfem::exact::{Field, Setting, solution};
use stickslip_xfem::geometry::{dot, norm, sub};

use crate::case::{Case, ContactSpace};
use crate::model::body::Body;
use crate::model::quantities::Snapshot;
use crate::model::sides::Sides;
use crate::run::choice::Choice;
use crate::run::load_path::Posed;
use crate::run::run_case::{Progress, RunError, needs};
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::sweep::statistics::larger;

/// Largest errors of a patch test that counts as passed.
pub const PASSED: f64 = 1e-10;

/// One patch test in one contact space.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchRow {
    /// What the crack does.
    pub state: State,
    /// What the boundary is given.
    pub loaded: Loaded,
    /// Space dimension.
    pub dimension: usize,
    /// Shape and direction of the crack.
    pub crack: String,
    /// Mesh.
    pub mesh: String,
    /// Distance of the crack from a node in cell sizes; positive with the node on side 2.
    pub distance: f64,
    /// Contact space.
    pub space: String,
    /// Contact points; 0 if the body was refused.
    pub points: usize,
    /// Verdict on the run; refused where there is no body to run.
    pub verdict: Verdict,
    /// Traction error; NaN without an honest verdict.
    pub traction: f64,
    /// Displacement error; NaN without an honest verdict.
    pub displacement: f64,
}

impl PatchRow {
    /// Whether both errors are below [`PASSED`].
    pub fn passed(&self) -> bool {
        self.traction <= PASSED && self.displacement <= PASSED
    }
}

/// Runs patch tests in some contact spaces, in the order given.
///
/// # Errors
/// A patch that is no case, or that its closed form does not hold for; what the discretisation refuses is a row.
pub fn run(
    patches: &[Patch],
    spaces: &[ContactSpace],
    choice: &Choice,
    progress: &dyn Progress,
) -> Result<Vec<PatchRow>, RunError> {
    progress.plan(patches.len());
    let of_patch = |patch: &Patch| -> Result<Vec<PatchRow>, RunError> {
        let mut rows: Vec<PatchRow> = Vec::new();
        let mut seen = BTreeSet::new();
        let mut case = patch.case()?;
        for &space in spaces {
            case.cracks.iter_mut().for_each(|c| c.contact = space);
            let row = run_one(patch, &case, space, choice)?;
            if seen.insert(row.space.clone()) {
                rows.push(row);
            }
        }
        progress.done(&patch.to_string());
        Ok(rows)
    };
    let rows: Vec<Vec<PatchRow>> = patches.par_iter().map(of_patch).collect::<Result<_, _>>()?;
    Ok(rows.into_iter().flatten().collect())
}

/// One patch test in the contact space of its case.
fn run_one(
    patch: &Patch,
    case: &Case,
    space: ContactSpace,
    choice: &Choice,
) -> Result<PatchRow, RunError> {
    let row = |space: &str, points, verdict| PatchRow {
        state: patch.state,
        loaded: patch.loaded,
        dimension: case.model.dim(),
        crack: patch.crack.clone(),
        mesh: patch.mesh.clone(),
        distance: patch.distance,
        space: space.to_owned(),
        points,
        verdict,
        traction: f64::NAN,
        displacement: f64::NAN,
    };
    let friction: Vec<f64> = case.cracks.iter().map(|c| c.friction).collect();
    let frictions = std::slice::from_ref(&friction);
    let body = match Body::new(case, 1, needs(frictions, std::slice::from_ref(choice))) {
        Ok(body) => body,
        Err(refused) => return Ok(row(space.name(), 0, Verdict::Refused(refused.to_string()))),
    };
    let posed = Posed::new(&body, case, &friction)?;
    let path = posed.run(choice, Accuracy::of(case, Tier::High));
    let end = path.follow(&mut |_, _, _| ());
    let mut row = row(&body.space, body.points.len(), end.verdict);
    let Some(now) = end.now else { return Ok(row) };
    let hydrostatic;
    let field = match posed.loading.exact(case.path.increments) {
        Some(field) => field,
        None => {
            hydrostatic = pressed(case)?;
            hydrostatic.as_ref()
        }
    };
    row.traction = traction_error(&body, field, &now);
    row.displacement = displacement_error(case, &body, field, &now);
    Ok(row)
}

/// Hydrostatic pressure about the middle of the first crack: the closed form of several cracks.
fn pressed(case: &Case) -> Result<Box<dyn Field>, RunError> {
    let refuse = |message: String| {
        let allowed = "a body in hydrostatic pressure";
        RunError::from(case.error(&case.mesh.span, &case.title, allowed, message))
    };
    let (Some(spec), Some(crack)) = (solution("uniform-stress"), case.cracks.first()) else {
        return Err(refuse("no crack, or no closed form".into()));
    };
    let setting = Setting {
        material: case.material,
        model: case.model,
        friction: 0.0,
        crack: &crack.geometry,
        body: [[0.0; 3]; 2],
    };
    let value = |name: &str, default: Option<f64>| match name {
        "stress_xx_pa" | "stress_yy_pa" => -text::PRESSURE,
        _ => default.unwrap_or_default(),
    };
    let parameters = spec.parameters.iter();
    let stress: Vec<f64> = parameters.map(|p| value(p.name, p.default)).collect();
    let solution = (spec.build)(&setting, &stress).map_err(refuse)?;
    solution.at(&[1.0]).map_err(refuse)
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
    let sides = Sides::new(case, &integrator);
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
