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

mod bulk;
mod front;
mod stick_boundary;
mod surface;

use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::cut::placement;
use stickslip_xfem::exact::Field;
use stickslip_xfem::geometry::tip_frame::TipFrame;
use stickslip_xfem::geometry::{Point, dot, sub};
use stickslip_xfem::stiffness::cell_matrix::CellError;

use crate::model::body::Body;
use crate::model::quantities::Snapshot;

pub use bulk::{Bulk, bulk};
pub use front::{tip_fronts, tip_intensities};

/// Points per direction of the rule for the bulk: doubling it changes the errors by less than 1e-3 of themselves.
pub const RULE: usize = 4;

/// An exact value below this, in units of its natural scale, is zero.
const ZERO: f64 = 1e-9;

/// One quantity, found and exact.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviation {
    /// Name, see the head of this module.
    pub quantity: &'static str,
    /// `crack-1 tip-2` for a tip; empty for the whole body.
    pub at: String,
    /// Discrete value; for a field its norm. NaN: the mesh leaves no room to find it.
    pub found: f64,
    /// Exact value; for a field its norm.
    pub exact: f64,
    /// Relative error; where the exact value is zero, relative to the natural scale; of a direction the angle [rad].
    pub error: f64,
}

/// Natural scales of the exact field.
#[derive(Debug, Clone, Copy)]
struct Scales {
    /// Root mean square of the displacement [m].
    displacement: f64,
    /// Root mean square of the stress [Pa].
    stress: f64,
    /// Elastic energy [J, in 2D J/m].
    energy: f64,
}

impl Deviation {
    /// A deviation whose difference is measured against the exact size, or the natural scale if that is zero.
    fn new(
        quantity: &'static str,
        at: String,
        [found, exact]: [f64; 2],
        difference: f64,
        size: f64,
        scale: f64,
    ) -> Self {
        let unit = if size > ZERO * scale { size } else { scale };
        Deviation {
            quantity,
            at,
            found,
            exact,
            // A field that is zero everywhere has no scale: the difference itself, in SI units.
            error: if unit > 0.0 {
                difference / unit
            } else {
                difference
            },
        }
    }
}

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
    let nodes = bulk::nodal_displacement(body, field, &now.u);
    rows.push(norm_row("displacement_rms", nodes, scales.displacement));
    rows.extend(surface::rows(body, surface, field, now, &scales));
    rows.extend(stick_boundary::row(body, surface, field, now));
    if let Some(exact) = field.dissipation() {
        let difference = (now.dissipation - exact).abs();
        rows.push(Deviation::new(
            "dissipation",
            String::new(),
            [now.dissipation, exact],
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

/// A row of a norm from the squares of the found one, the exact one and that of the difference.
fn norm_row(quantity: &'static str, squares: [f64; 3], scale: f64) -> Deviation {
    let [found, exact, difference] = squares.map(f64::sqrt);
    Deviation::new(
        quantity,
        String::new(),
        [found, exact],
        difference,
        exact,
        scale,
    )
}

/// Side of the crack that a point off the crack lies on; 1 in a body without cracks. A closed form belongs to one crack.
fn side_of(body: &Body, x: &Point) -> f64 {
    let distance = match (body.cracks.first(), body.points.first()) {
        (Some(crack), _) => crack.distance(x),
        // A crack along cell edges has no level set, but points.
        (None, Some(point)) => dot(&point.frame[0], &sub(x, &point.x)),
        (None, None) => 0.0,
    };
    if distance < 0.0 { -1.0 } else { 1.0 }
}

/// Tips of all cracks, whether they carry branch functions or not.
pub fn fronts(body: &Body) -> Vec<TipFrame> {
    let cracks = body.cracks.iter().enumerate();
    cracks
        .flat_map(|(index, crack)| placement::fronts(&body.mesh, index, crack))
        .map(|(tip, _)| tip)
        .collect()
}
