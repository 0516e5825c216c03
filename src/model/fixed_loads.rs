//! Loads that keep their shape while a history scales them.

use stickslip_xfem::contact::pairs::ContactPoint;
use stickslip_xfem::cut::placement::ends_inside;
use stickslip_xfem::geometry::{Point, dot};
use stickslip_xfem::stiffness::cell_matrix::CellIntegrator;

use crate::case::{Case, History, LoadKind};
use crate::model::border::Border;
use crate::model::nodal_forces::{add_fixed_forces, no_force};
use crate::model::refusals::{BodyError, load_error, one_sided_error};
use crate::model::sides::Sides;

/// Loads that keep their shape and evolve alike.
pub struct FixedLoad {
    /// Nodal forces at factor 1, over all unknowns [N, in 2D N/m].
    pub force: Vec<f64>,
    /// Contact forces that initial stresses imply at factor 1, `dim` per point [N, in 2D N/m]; empty without, and where no
    /// method asks for the traction operator.
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
    border: &Border<'_>,
    points: &[ContactPoint],
    with_traction: bool,
) -> Result<Vec<FixedLoad>, BodyError> {
    let mut sides = None;
    let mut loads: Vec<FixedLoad> = Vec::new();
    let kept = |kind: &LoadKind| !matches!(kind, LoadKind::ExactTraction(_) | LoadKind::ExactBody);
    for load in case.loads.iter().filter(|load| kept(&load.kind)) {
        if let LoadKind::Body(_, Some(side)) = &load.kind {
            let found = sides.take().or_else(|| Sides::new(case, integrator));
            if let Some(sides) = &found
                && !ends_inside(integrator.mesh, sides.crack()).is_empty()
            {
                return Err(one_sided_error(case, &side.span).into());
            }
            sides = found;
        }
        let initial_stress = matches!(load.kind, LoadKind::InitialStress(_));
        let alike = |l: &FixedLoad| l.history == load.history && l.initial_stress == initial_stress;
        let place = loads.iter().position(alike);
        let place = place.unwrap_or_else(|| {
            loads.push(FixedLoad {
                force: no_force(integrator),
                traction: Vec::new(),
                initial_stress,
                history: load.history.clone(),
            });
            loads.len() - 1
        });
        let alike = &mut loads[place];
        add_fixed_forces(
            integrator,
            border,
            sides.as_ref(),
            &load.kind,
            &mut alike.force,
        )
        .map_err(|e| load_error(case, &load.kind, &load.span, e))?;
        if let (LoadKind::InitialStress(stress), true) = (&load.kind, with_traction) {
            let implied = implied_forces(integrator.mesh.dim(), points, stress);
            alike.traction.resize(implied.len(), 0.0);
            alike
                .traction
                .iter_mut()
                .zip(implied)
                .for_each(|(t, v)| *t += v);
        }
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
