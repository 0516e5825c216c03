//! Loads that keep their shape while a history scales them.

use stickslip_xfem::contact::pairs::ContactPoint;
use stickslip_xfem::loads::nodal_forces::{implied_forces, no_force};
use stickslip_xfem::loads::sides::Sides;
use stickslip_xfem::stiffness::cell_matrix::CellIntegrator;

use crate::case::{Case, History, LoadKind};
use crate::model::nodal_forces::Loaded;
use crate::model::refusals::{BodyError, load_error, one_sided_error};

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
    points: &[ContactPoint],
    with_traction: bool,
) -> Result<Vec<FixedLoad>, BodyError> {
    let loaded = Loaded::new(case, integrator);
    let mut loads: Vec<FixedLoad> = Vec::new();
    let kept = |kind: &LoadKind| !matches!(kind, LoadKind::ExactTraction(_) | LoadKind::ExactBody);
    for load in case.loads.iter().filter(|load| kept(&load.kind)) {
        if let LoadKind::Body(_, Some(side)) = &load.kind {
            let crack = loaded.sides().map(Sides::crack);
            if crack.is_some_and(|crack| !crack.tips().is_empty()) {
                return Err(one_sided_error(case, &side.span).into());
            }
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
        let added = loaded.add(&load.kind, None, &mut alike.force);
        added.map_err(|e| load_error(case, &load.kind, &load.span, e))?;
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
