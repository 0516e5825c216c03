//! Errors of a discrete solution against a closed form.
//!
//! ```text
//!   energy              ( ∫ (σ_h − σ):C⁻¹:(σ_h − σ) / ∫ σ:C⁻¹:σ )^½
//!   displacement        ( ∫ |u_h − u|² / ∫ |u|² )^½                      displacement_rms   the same over the nodes
//!   traction            ( ∫_Γ |λ_h − λ|² / ∫_Γ |λ|² )^½                  traction_rms       P/w against λ, over the points
//!   slip, gap           max |[[u_h]] − [[u]]|, tangential and normal, over max |[[u]]|, on the crack surface
//!   slip_direction      angle between ∫ [[u_h]]_t and ∫ [[u]]_t over the crack [rad], in 3D; its values: angles from a towards b
//!   slip_points, gap_points                                               the same over the contact points
//!   dissipation         relative
//!   k1_jump …           K found by the jump fit, over |K|                k1_interaction …   by the interaction integral
//! ```
//!
//! A contact point of an integrated space is compared with the mean of the exact field over its function.
//!
//! Where the exact value is zero (below 1e-9 of the natural scale of the field) the error is measured against that scale
//! instead: the root mean square of the exact displacement for jumps, that of the exact stress Σ for tractions, Σ √(π L/2)
//! for intensities (L: length of the crack), the exact elastic energy ½ ∫ σ:C⁻¹:σ for dissipation. Slip and gap share the
//! scale max |[[u]]|, so that neither the gap of a sliding crack nor the slip of an opening one divides by zero.

mod deviation;
mod front;
mod stick_boundary;
mod surface;

use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::discretisation::norms::{RULE, bulk, nodal_displacement};
use stickslip_xfem::exact::Field;
use stickslip_xfem::stiffness::cell_matrix::CellError;

use crate::model::body::Body;
use crate::model::snapshot::Snapshot;

use deviation::{Scales, norm_row};

pub use deviation::Deviation;

/// Errors of a state against the exact field at the same time. `surface`: quadrature points of all crack surfaces; without
/// any there are no rows for `traction`, `slip`, `gap`, the stick boundary and the intensities.
///
/// # Errors
/// [`CellError`] of a cell that cannot be integrated.
pub fn errors(
    body: &Body,
    surface: &[SurfacePoint],
    field: &dyn Field,
    now: &Snapshot,
) -> Result<Vec<Deviation>, CellError> {
    let bulk = bulk(body, field, &now.u, RULE)?;
    let scales = Scales {
        displacement: (bulk.displacement / bulk.measure).sqrt(),
        stress: (bulk.stress / bulk.measure).sqrt(),
        energy: 0.5 * bulk.energy,
    };
    let mut rows = vec![
        norm_row(
            "energy",
            [bulk.energy_found, bulk.energy, bulk.energy_error],
            bulk.energy.sqrt(),
        ),
        norm_row(
            "displacement",
            [
                bulk.displacement_found,
                bulk.displacement,
                bulk.displacement_error,
            ],
            bulk.displacement.sqrt(),
        ),
    ];
    let nodes = nodal_displacement(body, field, &now.u);
    rows.push(norm_row("displacement_rms", nodes, scales.displacement));
    rows.extend(surface::rows(body, surface, field, now, &scales));
    rows.extend(stick_boundary::row(body, surface, field, now));
    if let Some(exact) = field.dissipation() {
        let difference = (now.work.dissipation() - exact).abs();
        rows.push(Deviation::new(
            "dissipation",
            String::new(),
            [now.work.dissipation(), exact],
            difference,
            exact.abs(),
            scales.energy,
        ));
    }
    if !surface.is_empty() {
        rows.extend(front::rows(body, surface, field, now, &scales)?);
    }
    Ok(rows)
}
