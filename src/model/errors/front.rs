//! Rows of the stress intensity factors at crack tips and fronts.

use std::f64::consts::PI;

use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::discretisation::norms::side_of;
use stickslip_xfem::discretisation::tips::{Loads, SolvedBody, crack_size, tip_fronts};
use stickslip_xfem::exact::Field;
use stickslip_xfem::geometry::Point;
use stickslip_xfem::stiffness::cell_matrix::CellError;

use crate::model::body::Body;
use crate::model::snapshot::Snapshot;

use super::deviation::{Deviation, Scales};

/// Rows of the intensities at all tips where the closed form has them.
pub(super) fn rows(
    body: &Body,
    surface: &[SurfacePoint],
    field: &dyn Field,
    now: &Snapshot,
    scales: &Scales,
) -> Result<Vec<Deviation>, CellError> {
    let mut rows = Vec::new();
    let body_force = |x: &Point, side: Option<f64>| {
        let side = side.unwrap_or_else(|| side_of(body, x));
        field.body_force(x, side)
    };
    let loads = Loads {
        body_force: Some(&body_force),
        initial_stress: [[0.0; 3]; 3],
    };
    let solved = SolvedBody::new(body, surface, [&now.u, &now.p], &loads);
    for (at, tip) in tip_fronts(body) {
        let Some(exact) = field.intensity(&tip.position) else {
            continue;
        };
        let size = exact.iter().map(|k| k * k).sum::<f64>().sqrt();
        let scale = scales.stress * (0.5 * PI * crack_size(&body.cracks[tip.crack])).sqrt();
        let found = solved.intensities(&tip, 1)?;
        let jump = found.jumps.first().copied().unwrap_or([f64::NAN; 3]);
        let interaction = found.integrals.first().copied().unwrap_or([f64::NAN; 2]);
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
