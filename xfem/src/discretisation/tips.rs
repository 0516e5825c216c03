//! Stress intensity factors at the tips and fronts of a solved body: in 2D by the interaction integral and by the jump fit, in 3D
//! by the jump fit.

use std::f64::consts::PI;

use crate::contact::surface_point::{SurfacePoint, jump_at};
use crate::cut::crack::{Crack, Geometry};
use crate::cut::placement::{self, cells_at};
use crate::fields::sampling::ComparisonPoint;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, add_scaled, norm, sub};
use crate::intensity::interaction::{Domain, Fields, interaction};
use crate::intensity::{FitRange, JumpSample, jump_fit, jump_fit_along};
use crate::stiffness::cell_matrix::CellError;

use super::Discretisation;
use super::norms::RULE;

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

/// Tips of all cracks, whether they carry branch functions or not.
pub fn fronts(body: &Discretisation) -> Vec<TipFrame> {
    let cracks = body.cracks.iter().enumerate();
    cracks
        .flat_map(|(index, crack)| placement::fronts(&body.mesh, index, crack))
        .collect()
}

/// Tips inside the body with the name of their place, `crack-1 tip-2`; points of a 3D front by their parameter,
/// `crack-1 front-45deg`.
pub fn tip_fronts(body: &Discretisation) -> Vec<(String, TipFrame)> {
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
pub fn crack_size(crack: &Crack) -> f64 {
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

/// Intensities at a tip from the discrete solution: all unknowns and the contact forces; `surface`: quadrature points of all
/// crack surfaces.
///
/// # Errors
/// [`CellError`] of a cell that cannot be integrated.
pub fn tip_intensities(
    body: &Discretisation,
    surface: &[SurfacePoint],
    tip: &TipFrame,
    [u, p]: [&[f64]; 2],
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
        let jump = |x: &Point| jump_at(&integrator, tip.crack, x, u);
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
            jump: p.jump(&integrator, u),
            weight: p.weight,
        });
    let faces: Vec<(&SurfacePoint, Point)> = surface
        .iter()
        .map(|q| {
            let local = q.traction(dim, &body.points, p);
            let mut traction = [0.0; 3];
            for (value, axis) in local.iter().zip(&q.frame) {
                traction = add_scaled(&traction, *value, axis);
            }
            (q, traction)
        })
        .collect();
    let gradients = |cell: usize, points: &[ComparisonPoint]| {
        let mut stress = integrator.stress(cell)?;
        let at = |p: &ComparisonPoint| {
            let p = &p.point;
            stress.field(&p.xi, &p.x, p.region, u).1
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
