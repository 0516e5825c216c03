//! Loads, from the words of a case to densities and their nodal forces.

use stickslip_xfem::exact::Field;
use stickslip_xfem::geometry::{Point, dot};
use stickslip_xfem::loads::border::Border;
use stickslip_xfem::loads::nodal_forces::{self as xfem, Domain, LoadError, Place, Rule};
use stickslip_xfem::loads::sides::Sides;
use stickslip_xfem::stiffness::cell_matrix::CellIntegrator;

use crate::case::{Case, CrackSide, LoadKind};
use crate::model::boundary::part;

/// The body that loads act on.
pub struct Loaded<'a> {
    integrator: &'a CellIntegrator<'a>,
    border: Border<'a>,
    sides: Option<Sides>,
}

impl<'a> Loaded<'a> {
    /// Border and sides of a body.
    pub fn new(case: &Case, integrator: &'a CellIntegrator<'a>) -> Self {
        let first = case.cracks.first();
        Loaded {
            integrator,
            border: Border::new(integrator.mesh),
            sides: Sides::new(first.map(|spec| (&spec.geometry, spec.tip)), integrator),
        }
    }

    /// Border.
    pub fn border(&self) -> &Border<'a> {
        &self.border
    }

    /// Sides of the first crack; none without crack.
    pub fn sides(&self) -> Option<&Sides> {
        self.sides.as_ref()
    }

    fn side(&self, at: &Place<'_>) -> f64 {
        let side = |sides: &Sides| sides.of_point(self.integrator, at.cell, at.x, at.region);
        self.sides.as_ref().map_or(1.0, side)
    }

    /// Adds the nodal forces of a load at factor 1, or by its closed form, over all unknowns [N, in 2D N/m]; none of those that
    /// take their values from a closed form without one.
    ///
    /// # Errors
    /// See [`xfem::add_forces`].
    pub fn add(
        &self,
        kind: &LoadKind,
        field: Option<&dyn Field>,
        force: &mut [f64],
    ) -> Result<(), LoadError> {
        let mut add = |on, rule, density: xfem::Density<'_>| {
            xfem::add_forces(self.integrator, &self.border, on, rule, density, force)
        };
        match (kind, field) {
            (LoadKind::Traction(on, traction), _) => {
                let at = |at: &Place<'_>| {
                    [0, 1, 2].map(|a| {
                        traction
                            .get(a)
                            .map_or(0.0, |polynomial| polynomial.at(at.x))
                    })
                };
                add(Domain::Facets(part(on)), Rule::Fixed, &at)
            }
            (LoadKind::Pressure(on, pressure), _) => {
                let at = |at: &Place<'_>| at.normal.map(|n| -pressure.at(at.x) * n);
                add(Domain::Facets(part(on)), Rule::Fixed, &at)
            }
            (LoadKind::Line(on, line), _) => {
                add(Domain::Edges(part(on)), Rule::Fixed, &|_| vector(line))
            }
            (LoadKind::Body(density, side), _) => {
                let at = |at: &Place<'_>| match side {
                    Some(CrackSide { side, .. }) if self.side(at) != *side => [0.0; 3],
                    _ => vector(density),
                };
                add(Domain::Cells, Rule::Fixed, &at)
            }
            (LoadKind::InitialStress(stress), _) => {
                xfem::add_initial_stress(self.integrator, stress, force)
            }
            (LoadKind::ExactTraction(on), Some(field)) => {
                let at = |at: &Place<'_>| {
                    let stress = field.stress(at.x, self.side(at));
                    stress.map(|row| dot(&row, at.normal))
                };
                add(Domain::Facets(part(on)), Rule::Exact, &at)
            }
            (LoadKind::ExactBody, Some(field)) => {
                let at = |at: &Place<'_>| field.body_force(at.x, self.side(at));
                add(Domain::Cells, Rule::Exact, &at)
            }
            (LoadKind::ExactTraction(_) | LoadKind::ExactBody, None) => Ok(()),
        }
    }
}

/// Components in space of a vector of a case.
pub fn vector(v: &[f64]) -> Point {
    [0, 1, 2].map(|a| v.get(a).copied().unwrap_or(0.0))
}
