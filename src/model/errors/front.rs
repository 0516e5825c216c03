//! Stress intensity factors at the tips of 2D cracks, by the jump fit and by the interaction integral.

use std::f64::consts::PI;

use stickslip_xfem::contact::surface_point::{SurfacePoint, jump_at};
use stickslip_xfem::cut::crack::{Crack, Geometry};
use stickslip_xfem::cut::placement::{self, cells_at};
use stickslip_xfem::exact::Field;
use stickslip_xfem::fields::sampling::ComparisonPoint;
use stickslip_xfem::geometry::tip_frame::{FrontShape, TipFrame};
use stickslip_xfem::geometry::{Point, add_scaled, norm, sub};
use stickslip_xfem::intensity::interaction::{Domain, Fields, interaction};
use stickslip_xfem::intensity::{FitRange, JumpSample, jump_fit, jump_fit_along};
use stickslip_xfem::stiffness::cell_matrix::CellError;

use crate::model::body::Body;
use crate::model::quantities::Snapshot;

use super::deviation::{Deviation, RULE, Scales, fronts, side_of};

/// Reach of the jump fit behind the tip, in lengths of the crack. It must not shrink with the mesh: with branch functions on
/// the tip's cell only, the jump at a given number of cells behind the tip keeps its relative error on every mesh.
const FIT_REACH: f64 = 0.25;
/// The nearest part of the reach is left out, and at least this many cells.
const FIT_LEFT_OUT: f64 = 0.2;
const FIT_CELLS_LEFT_OUT: f64 = 1.0;
/// Radius of the domain of the interaction integral, in cells: the first that stands alone around the tip.
const DOMAIN_CELLS: [f64; 2] = [3.0, 2.0];

/// Points of a 3D front at which intensities are found, evenly spaced in its parameter.
const FRONT_POINTS: usize = 8;
/// Samples behind a point of a 3D front.
const FRONT_SAMPLES: usize = 24;

/// Tips inside the body with the name of their place, `crack-1 tip-2`; points of a 3D front by their parameter,
/// `crack-1 front-45deg`.
pub fn tip_fronts(body: &Body) -> Vec<(String, TipFrame)> {
    let mut tips = Vec::new();
    for (index, crack) in body.cracks.iter().enumerate() {
        let name = format!("crack-{}", crack.number + 1);
        // Arms of a crack share its name, those of an ellipse its front.
        let known = |tips: &[(String, TipFrame)]| {
            let own = |t: &&(String, TipFrame)| t.0.starts_with(&format!("{name} "));
            tips.iter().filter(own).count()
        };
        for tip in placement::fronts(&body.mesh, index, crack) {
            let FrontShape::Ellipse(ellipse) = &tip.shape else {
                let number = known(&tips) + 1;
                tips.push((format!("{name} tip-{number}"), tip));
                continue;
            };
            if known(&tips) > 0 {
                continue;
            }
            for k in 0..FRONT_POINTS {
                let parameter = 2.0 * PI * k as f64 / FRONT_POINTS as f64;
                let position = ellipse.point(parameter);
                let local = TipFrame {
                    crack: index,
                    position,
                    ahead: ellipse.nearest(&position).ahead,
                    normal: ellipse.normal,
                    shape: FrontShape::Straight,
                };
                tips.push((format!("{name} front-{}deg", 360 * k / FRONT_POINTS), local));
            }
        }
    }
    tips
}

/// Length of a 2D crack, smaller axis of an ellipse [m].
fn crack_size(crack: &Crack) -> f64 {
    match &crack.geometry {
        Geometry::Curve(_) => crack.range[1] - crack.range[0],
        Geometry::Ellipse(e) => 2.0 * e.half_axes[0].min(e.half_axes[1]),
        Geometry::Plane { .. } => f64::INFINITY,
    }
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
    body_force: &(dyn Fn(&Point, Option<f64>) -> Point + Sync),
) -> Result<TipIntensities, CellError> {
    let integrator = body.integrator();
    let (mesh, dim) = (&body.mesh, body.mesh.dim());
    let crack = &body.cracks[tip.crack];
    let mut size: f64 = 0.0;
    for cell in cells_at(mesh, &tip.position) {
        size = size.max(mesh.map(cell).longest_edge());
    }
    let to = FIT_REACH * crack_size(crack);
    let range = FitRange {
        from: (FIT_LEFT_OUT * to).max(FIT_CELLS_LEFT_OUT * size),
        to,
    };
    if dim == 3 {
        let jump = |x: &Point| jump_at(&integrator, tip.crack, x, &now.u);
        return Ok(TipIntensities {
            jump: jump_fit_along(tip, body.lame, range, FRONT_SAMPLES, jump),
            interaction: None,
        });
    }
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
    let gradients = |cell: usize, points: &[ComparisonPoint]| {
        let mut stress = integrator.stress(cell)?;
        let at = |p: &ComparisonPoint| {
            let p = &p.point;
            stress.field(&p.xi, &p.x, p.region, &now.u).1
        };
        Ok(points.iter().map(at).collect::<Vec<_>>())
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
        let scale = scales.stress * (0.5 * PI * crack_size(&body.cracks[tip.crack])).sqrt();
        let body_force = |x: &Point, side: Option<f64>| {
            let side = side.unwrap_or_else(|| side_of(body, x));
            field.body_force(x, side)
        };
        let found = tip_intensities(body, surface, &tip, now, &body_force)?;
        let jump = found.jump.unwrap_or([f64::NAN; 3]);
        let interaction = found.interaction.unwrap_or([f64::NAN; 2]);
        let mut pairs = vec![
            ("k1_jump", jump[0], exact[0]),
            ("k2_jump", jump[1], exact[1]),
        ];
        if body.mesh.dim() == 2 {
            pairs.push(("k1_interaction", interaction[0], exact[0]));
            pairs.push(("k2_interaction", interaction[1], exact[1]));
        } else {
            pairs.push(("k3_jump", jump[2], exact[2]));
        }
        for (name, found, exact) in pairs {
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
