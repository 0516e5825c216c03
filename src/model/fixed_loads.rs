//! Loads that keep their shape while a history scales them.

use stickslip_xfem::contact::pairs::ContactPoint;
use stickslip_xfem::cut::placement::ends_inside;
use stickslip_xfem::geometry::{Point, dot};
use stickslip_xfem::stiffness::cell_matrix::CellIntegrator;

use crate::case::{Case, History, LoadKind};
use crate::model::nodal_forces::fixed_forces;
use crate::model::refusals::{BodyError, load_error, one_sided_error};
use crate::model::sides::Sides;

/// A load that keeps its shape: its nodal forces and how they evolve.
pub struct FixedLoad {
    /// Nodal forces at factor 1, over all unknowns [N, in 2D N/m].
    pub force: Vec<f64>,
    /// Contact forces that an initial stress implies at factor 1, `dim` per point [N, in 2D N/m]; empty for all other
    /// loads, and where no method asks for the traction operator.
    pub traction: Vec<f64>,
    /// Whether it is an initial stress.
    pub initial_stress: bool,
    /// Evolution.
    pub history: History,
}

/// The loads of a case that do not come from its closed form.
pub fn fixed_loads(
    case: &Case,
    integrator: &CellIntegrator<'_>,
    points: &[ContactPoint],
    with_traction: bool,
) -> Result<Vec<FixedLoad>, BodyError> {
    let mut sides = None;
    let mut loads = Vec::new();
    for load in &case.loads {
        if let LoadKind::Body(_, Some(side)) = &load.kind {
            let found = sides.take().or_else(|| Sides::new(case, integrator));
            if let Some(sides) = &found
                && !ends_inside(integrator.mesh, sides.crack()).is_empty()
            {
                return Err(one_sided_error(case, &side.span).into());
            }
            sides = found;
        }
        let force = fixed_forces(integrator, sides.as_ref(), &load.kind)
            .map_err(|e| load_error(case, &load.kind, &load.span, e))?;
        let Some(force) = force else { continue };
        let traction = match &load.kind {
            LoadKind::InitialStress(stress) if with_traction => {
                implied_forces(integrator.mesh.dim(), points, stress)
            }
            _ => Vec::new(),
        };
        loads.push(FixedLoad {
            force,
            traction,
            initial_stress: matches!(load.kind, LoadKind::InitialStress(_)),
            history: load.history.clone(),
        });
    }
    Ok(loads)
}

/// Forces on side 1 at the contact points that a uniform stress implies: −w e·σ n for every axis e of the local frame.
fn implied_forces(dim: usize, points: &[ContactPoint], stress: &[Point; 3]) -> Vec<f64> {
    let forces = points.iter().flat_map(|point| {
        let on_normal = stress.map(|row| dot(&row, &point.frame[0]));
        (0..dim).map(move |e| -point.weight * dot(&point.frame[e], &on_normal))
    });
    forces.collect()
}
