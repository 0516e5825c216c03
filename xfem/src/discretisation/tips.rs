//! Stress intensity factors at the tips and fronts of a solved body: in 2D by the interaction integral and by the jump fit, in 3D
//! by the jump fit.

use std::f64::consts::PI;

use crate::contact::surface_point::{SurfacePoint, jump_at};
use crate::cut::crack::{Crack, Geometry};
use crate::cut::placement::{self, cells_at};
use crate::fields::sampling::ComparisonPoint;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, add_scaled, cross, dot, norm, sub};
use crate::intensity::interaction::{BodyForce, Domain, Fields, Obstacle, interaction};
use crate::intensity::{FitRange, JumpSample, jump_fit, jump_fit_along};
use crate::stiffness::cell_matrix::CellError;

use super::Discretisation;
use super::norms::RULE;

/// Reach of the jump fit behind the tip, in lengths of the crack. It must not shrink with the mesh: with branch functions on
/// the tip's cell only, the jump at a given number of cells behind the tip keeps its relative error on every mesh.
pub const FIT_REACH: f64 = 0.25;
/// The nearest part of the reach is left out, and at least this many cells.
const FIT_LEFT_OUT: f64 = 0.2;
const FIT_CELLS_LEFT_OUT: f64 = 1.0;
/// Radii of the domain of the interaction integral in cells, and reaches of the jump fit in the first; the preferred one first.
const DOMAIN_CELLS: [f64; WAYS] = [3.0, 2.0, 4.0];
const REACHES: [f64; WAYS] = [1.0, 0.8, 0.6];
/// Number of either.
pub const WAYS: usize = 3;
/// Points of a 3D front at which intensities are found, evenly spaced in its parameter.
pub const FRONT_POINTS: usize = 8;
/// Samples behind a point of a 3D front.
const FRONT_SAMPLES: usize = 24;

/// Tips of all cracks, whether they carry branch functions or not.
pub fn fronts(body: &Discretisation) -> Vec<TipFrame> {
    let of = |(index, crack)| placement::fronts(index, crack);
    body.cracks.iter().enumerate().flat_map(of).collect()
}

/// Place of a tip of a crack, counted from 0.
pub fn tip_place(crack: &str, tip: usize) -> String {
    format!("{crack} tip-{}", tip + 1)
}

/// Place of one of the [`FRONT_POINTS`] of a front, counted from 0.
pub fn front_place(crack: &str, point: usize) -> String {
    format!("{crack} front-{}deg", 360 * point / FRONT_POINTS)
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
        for tip in placement::fronts(index, crack) {
            let FrontShape::Ellipse(ellipse) = &tip.shape else {
                let place = tip_place(&name, known(&tips));
                tips.push((place, tip));
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
                tips.push((front_place(&name, k), local));
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
#[derive(Debug, Clone, PartialEq)]
pub struct TipIntensities {
    /// By the jump fit over the preferred reach, in 3D over others too; none: too few surface points behind the tip.
    pub jumps: Vec<[f64; 3]>,
    /// By the interaction integral over the domains that stand alone around the tip, the preferred one first; none in 3D.
    pub integrals: Vec<[f64; 2]>,
    /// Obstacle of the smallest domain, where none stands alone.
    pub obstacle: Option<Obstacle>,
}

impl TipIntensities {
    /// The value: by the integral in 2D, by the jump in 3D; how far the others are from it at most, not-a-number where there are none.
    pub fn best(&self) -> Option<[[f64; 3]; 2]> {
        if self.obstacle.is_some() {
            return None;
        }
        let integrals = self.integrals.iter().map(|k| [k[0], k[1], 0.0]);
        let own: Vec<[f64; 3]> = integrals.chain(self.jumps.iter().copied()).collect();
        let value = *own.first()?;
        let apart = |c: usize| {
            let others = own[1..].iter().map(|k| (k[c] - value[c]).abs());
            others.reduce(f64::max).unwrap_or(f64::NAN)
        };
        Some([value, [0, 1, 2].map(apart)])
    }
}

/// Loads beside the displacement, for the interaction integral.
pub struct Loads<'a> {
    /// If there is any.
    pub body_force: Option<&'a BodyForce<'a>>,
    /// Uniform initial stress [Pa].
    pub initial_stress: [Point; 3],
}

/// A solved body as all of its tips see it.
pub struct SolvedBody<'a> {
    body: &'a Discretisation,
    /// All unknowns.
    u: &'a [f64],
    loads: &'a Loads<'a>,
    /// Quadrature points of all crack surfaces with the contact traction on side 1 [Pa].
    faces: Vec<(&'a SurfacePoint, Point)>,
    fronts: Vec<TipFrame>,
}

impl<'a> SolvedBody<'a> {
    /// From all unknowns and the contact forces; `surface`: quadrature points of all crack surfaces.
    pub fn new(
        body: &'a Discretisation,
        surface: &'a [SurfacePoint],
        [u, p]: [&'a [f64]; 2],
        loads: &'a Loads<'a>,
    ) -> Self {
        let dim = body.mesh.dim();
        let faces = surface.iter().map(|q| {
            let local = q.traction(dim, &body.points, p);
            let mut traction = [0.0; 3];
            for (value, axis) in local.iter().zip(&q.frame) {
                traction = add_scaled(&traction, *value, axis);
            }
            // Of the strain alone: the normal points into side 1, on which σ₀ exerts −σ₀ n.
            let implied = loads.initial_stress.map(|row| dot(&row, &q.frame[0]));
            (q, add_scaled(&traction, 1.0, &implied))
        });
        Self {
            faces: faces.collect(),
            fronts: fronts(body),
            body,
            u,
            loads,
        }
    }

    /// Intensities at a tip; `ways`: domains and reaches that are wanted at most, [`WAYS`] for all.
    ///
    /// # Errors
    /// [`CellError`] of a cell that cannot be integrated.
    pub fn intensities(&self, tip: &TipFrame, ways: usize) -> Result<TipIntensities, CellError> {
        let SolvedBody { body, u, .. } = *self;
        let integrator = body.integrator();
        let mesh = &body.mesh;
        let crack = &body.cracks[tip.crack];
        let edges = (cells_at(mesh, &tip.position).into_iter()).map(|c| mesh.map(c).longest_edge());
        let size = edges.fold(0.0, f64::max);
        let ranges = REACHES.map(|part| {
            let to = part * FIT_REACH * crack_size(crack);
            FitRange {
                from: (FIT_LEFT_OUT * to).max(FIT_CELLS_LEFT_OUT * size),
                to,
            }
        });
        if mesh.dim() == 3 {
            let jump = |x: &Point| jump_at(&integrator, tip.crack, x, u);
            let fit = |range| jump_fit_along(tip, body.lame, range, FRONT_SAMPLES, jump);
            return Ok(TipIntensities {
                jumps: ranges.into_iter().filter_map(fit).take(ways).collect(),
                integrals: Vec::new(),
                obstacle: None,
            });
        }
        let own = (self.faces.iter()).filter(|(p, _)| p.crack == crack.number);
        // A face that turns takes its jump along: what opens at the tip opens there.
        let along = cross(&tip.normal, &[0.0, 0.0, 1.0]);
        let turned = |p: &SurfacePoint, jump: &Point| {
            let opening = tip.normal.map(|n| dot(jump, &p.frame[0]) * n);
            add_scaled(&opening, dot(jump, &p.frame[1]), &along)
        };
        let samples = own
            .map(|(p, _)| (p, norm(&sub(&p.x, &tip.position))))
            .filter(|(_, distance)| *distance <= ranges[0].to)
            .map(|(p, distance)| JumpSample {
                distance,
                jump: turned(p, &p.jump(&integrator, u)),
                weight: p.weight,
            });
        let samples: Vec<JumpSample> = samples.collect();
        let fit = |range| jump_fit(tip, body.lame, range, samples.iter().copied());
        let gradients = |cell: usize, points: &[ComparisonPoint]| {
            let mut stress = integrator.stress(cell)?;
            let at = |p: &ComparisonPoint| {
                let p = &p.point;
                stress.field(&p.xi, &p.x, p.region, u).1
            };
            Ok(points.iter().map(at).collect::<Vec<_>>())
        };
        let fields = Fields {
            gradients: &gradients,
            faces: &self.faces,
            body_force: self.loads.body_force,
        };
        let (mut integrals, mut obstacles) = (Vec::new(), Vec::new());
        for cells in DOMAIN_CELLS {
            if integrals.len() == ways {
                break;
            }
            let domain = Domain {
                radius: cells * size,
                fronts: &self.fronts,
                rule: RULE,
            };
            match interaction(&integrator, tip, domain, &fields)? {
                Ok(found) => integrals.push(found),
                // The smaller one may reach less.
                Err(obstacle) => obstacles.push(obstacle),
            }
        }
        let obstacle = obstacles.get(1).copied().filter(|_| integrals.is_empty());
        Ok(TipIntensities {
            jumps: ranges.into_iter().filter_map(fit).take(1).collect(),
            integrals,
            obstacle,
        })
    }
}
