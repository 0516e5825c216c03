//! Stress intensity factors at the tips of 2D cracks, by the jump fit and by the interaction integral.

use std::f64::consts::PI;

use crate::analytic::Field;
use crate::fem::{Point, add_scaled, norm, sub};
use crate::harness::body::Body;
use crate::harness::quantities::Snapshot;
use crate::xfem::basis::TipFrame;
use crate::xfem::cell_matrix::{CellError, SidedPoint};
use crate::xfem::enrichment::{cells_at, ends_inside};
use crate::xfem::intensity::{FitRange, JumpSample, jump_fit};
use crate::xfem::interaction::{Domain, Fields, interaction};
use crate::xfem::sampling::CellField;
use crate::xfem::surface_point::SurfacePoint;

use super::{Deviation, RULE, Scales, fronts};

/// Reach of the jump fit behind the tip, in lengths of the crack. It must not shrink with the mesh: with branch functions on
/// the tip's cell only, the jump at a given number of cells behind the tip keeps its relative error on every mesh.
const FIT_REACH: f64 = 0.25;
/// The nearest part of the reach is left out, and at least this many cells.
const FIT_LEFT_OUT: f64 = 0.2;
const FIT_CELLS_LEFT_OUT: f64 = 1.0;
/// Radius of the domain of the interaction integral, in cells: the first that stands alone around the tip.
const DOMAIN_CELLS: [f64; 2] = [3.0, 2.0];

/// Tips inside the body with the name of their place, `crack-1 tip-2`.
pub fn tip_fronts(body: &Body) -> Vec<(String, TipFrame)> {
    let mut tips = Vec::new();
    for (index, crack) in body.cracks.iter().enumerate() {
        for (number, (position, ahead)) in ends_inside(&body.mesh, crack).into_iter().enumerate() {
            let tip = TipFrame {
                crack: index,
                position,
                ahead,
                normal: crack.frame[0],
            };
            let at = format!("crack-{} tip-{}", crack.number + 1, number + 1);
            tips.push((at, tip));
        }
    }
    tips
}

/// K_I, K_II[, K_III] at a tip [Pa √m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipIntensities {
    /// By the jump fit; `None`: too few surface points behind the tip.
    pub jump: Option<[f64; 3]>,
    /// By the interaction integral; `None`: no room for its domain.
    pub interaction: Option<[f64; 2]>,
}

/// Intensities at a tip from the discrete solution.
///
/// # Errors
/// [`CellError`] of a cell that cannot be integrated.
pub fn tip_intensities(
    body: &Body,
    surface: &[SurfacePoint],
    tip: &TipFrame,
    now: &Snapshot,
    body_force: &(dyn Fn(&Point, f64) -> Point + Sync),
) -> Result<TipIntensities, CellError> {
    let integrator = body.integrator();
    let (mesh, dim) = (&body.mesh, body.mesh.dim());
    let crack = &body.cracks[tip.crack];
    let mut size: f64 = 0.0;
    for cell in cells_at(mesh, &tip.position) {
        let corners = mesh.corners(cell);
        for &[i, j] in mesh.kind.edges() {
            size = size.max(norm(&sub(&corners[i], &corners[j])));
        }
    }
    let to = FIT_REACH * crack.length;
    let range = FitRange {
        from: (FIT_LEFT_OUT * to).max(FIT_CELLS_LEFT_OUT * size),
        to,
    };
    let own = surface.iter().filter(|p| p.crack == crack.number);
    let samples = own
        .map(|p| (p, norm(&sub(&p.x, &tip.position))))
        .filter(|(_, distance)| *distance <= to)
        .map(|(p, distance)| JumpSample {
            distance,
            jump: p.jump(&integrator, &now.u),
            weight: p.weight,
        });
    let faces: Vec<(&SurfacePoint, Point)> = surface
        .iter()
        .map(|p| {
            let local = p.traction(dim, &body.points, &now.p);
            let mut traction = [0.0; 3];
            for (value, axis) in local.iter().zip(&p.frame) {
                traction = add_scaled(&traction, *value, axis);
            }
            (p, traction)
        })
        .collect();
    let gradients = |cell: usize, points: &[SidedPoint]| {
        let mut field = CellField::new(&integrator, cell);
        let at = |p: &SidedPoint| field.at(&p.xi, &p.x, p.side, &now.u).1;
        points.iter().map(at).collect::<Vec<_>>()
    };
    let fronts = fronts(body);
    let fields = Fields {
        gradients: &gradients,
        faces: &faces,
        body_force,
    };
    let mut integral = None;
    for cells in DOMAIN_CELLS {
        let domain = Domain {
            radius: cells * size,
            fronts: &fronts,
            rule: RULE,
        };
        integral = interaction(&integrator, tip, domain, &fields)?;
        if integral.is_some() {
            break;
        }
    }
    Ok(TipIntensities {
        jump: jump_fit(tip, body.lame, range, samples),
        interaction: integral,
    })
}

/// Rows of the intensities at all tips where the closed form has them.
pub(super) fn rows(
    body: &Body,
    surface: &[SurfacePoint],
    field: &dyn Field,
    now: &Snapshot,
    scales: &Scales,
) -> Result<Vec<Deviation>, CellError> {
    let mut rows = Vec::new();
    for (at, tip) in tip_fronts(body) {
        let Some(exact) = field.intensity(&tip.position) else {
            continue;
        };
        let size = exact.iter().map(|k| k * k).sum::<f64>().sqrt();
        let scale = scales.stress * (0.5 * PI * body.cracks[tip.crack].length).sqrt();
        let body_force = |x: &Point, side: f64| field.body_force(x, side);
        let found = tip_intensities(body, surface, &tip, now, &body_force)?;
        let jump = found.jump.unwrap_or([f64::NAN; 3]);
        let interaction = found.interaction.unwrap_or([f64::NAN; 2]);
        for (name, found, exact) in [
            ("k1_jump", jump[0], exact[0]),
            ("k2_jump", jump[1], exact[1]),
            ("k1_interaction", interaction[0], exact[0]),
            ("k2_interaction", interaction[1], exact[1]),
        ] {
            let difference = (found - exact).abs();
            rows.push(Deviation::new(
                name,
                at.clone(),
                [found, exact],
                difference,
                size,
                scale,
            ));
        }
    }
    Ok(rows)
}
