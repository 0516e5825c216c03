//! Stress intensity, energy release rate and direction of growth at the tips of all cracks, at points of their fronts in solids.
//!
//! ```text
//!   G = (K_I² + K_II²)/E' + K_III²/(2μ)                       Irwin, J. Appl. Mech. 24 (1957) 361
//!   tan(θ/2) = (K_I − √(K_I² + 8 K_II²)) / (4 K_II)           θ from ahead towards the normal: largest hoop stress,
//!                                                             Erdogan & Sih, J. Basic Eng. 85 (1963) 519, eq. 14
//! ```
//!
//! In the plane K is the interaction integral with contact tractions, body forces and initial stress, see
//! [`interaction`](stickslip_xfem::intensity::interaction), and its error estimate the largest difference from the same over other
//! domains and from the jump behind the tip. Where the faces behind a tip touch, K_I is that of their jump. In solids it is the fit of the jump, and the estimate compares three reaches. Neither
//! knows how far the displacement itself is off: meshes tell that.

use stickslip_methods::PointStatus;
use stickslip_xfem::discretisation::norms::side_of;
use stickslip_xfem::discretisation::tips::{
    FIT_REACH, FRONT_POINTS, Loads, SolvedBody, WAYS, crack_size, front_place, tip_fronts,
    tip_place,
};
use stickslip_xfem::geometry::tip_frame::TipFrame;
use stickslip_xfem::geometry::{Point, norm, sub};
use stickslip_xfem::intensity::williams::plane_modulus;

use crate::model::loading::Loading;
use crate::model::quantities::{ESTIMATE, Quantity};
use crate::model::snapshot::Snapshot;

/// Components of `stress_intensity`.
pub const MODES: [&str; 3] = ["I", "II", "III"];

/// The quantities of interest of tips.
pub const OF_TIPS: [&str; 3] = ["stress_intensity", "energy_release_rate", "growth_angle"];

/// Places of the tips of a crack, as far as its case tells: a mesh may have fewer.
pub fn places(crack: &str, dim: usize) -> impl Iterator<Item = String> {
    (0..FRONT_POINTS).map(move |k| match dim {
        2 => tip_place(crack, k),
        _ => front_place(crack, k),
    })
}

/// Quantities of interest at the end of an increment; of a tip without room for an integral one without value, with the reason.
pub fn intensities(loading: &Loading<'_>, increment: usize, now: &Snapshot) -> Vec<Quantity> {
    let (body, dim) = (loading.body(), loading.body().mesh.dim());
    let side_at = |x: &Point, side: Option<f64>| side.unwrap_or_else(|| side_of(body, x));
    let force = |x: &Point, side| loading.body_force(increment, x, side_at(x, side));
    let loads = Loads {
        body_force: loading.has_body_force().then_some(&force as _),
        initial_stress: loading.initial_stress(increment),
    };
    let state = [&now.u[..], &now.p[..]];
    let solved = SolvedBody::new(body, &body.surface.quadrature, state, &loads);
    let mut rows = Vec::new();
    for (at, tip) in tip_fronts(body) {
        let row = |name: &str, component: &str, value: f64, error: f64| Quantity {
            error,
            error_kind: if error.is_nan() { "" } else { ESTIMATE }.into(),
            ..Quantity::new([name, &at, component], value, dim)
        };
        match of_tip(loading, now, &solved, &tip) {
            Ok([k, apart]) => {
                let rates = |k: [f64; 3]| rate(k, plane_modulus(body.lame), body.lame.mu);
                for c in 0..dim {
                    rows.push(row("stress_intensity", MODES[c], k[c], apart[c]));
                }
                let error = spread(rates, k, apart);
                rows.push(row("energy_release_rate", "", rates(k), error));
                rows.push(row("growth_angle", "", angle(k), spread(angle, k, apart)));
            }
            Err(reason) => rows.push(Quantity {
                error_kind: format!("not computable: {reason}"),
                ..row("stress_intensity", "", f64::NAN, f64::NAN)
            }),
        }
    }
    rows
}

/// K_I, K_II, K_III at a tip and how far other ways to find them differ, or why there are none.
fn of_tip(
    loading: &Loading<'_>,
    now: &Snapshot,
    solved: &SolvedBody<'_>,
    tip: &TipFrame,
) -> Result<[[f64; 3]; 2], String> {
    let found = solved.intensities(tip, WAYS);
    let found = found.map_err(|error| error.to_string())?;
    let [mut k, apart] = found.best().ok_or_else(|| match found.obstacle {
        Some(obstacle) => format!("its surroundings reach {obstacle}"),
        None => "too few contact points behind it".to_owned(),
    })?;
    if let Some(jump) = found.jumps.first().filter(|_| is_closed(loading, now, tip)) {
        k[0] = jump[0];
    }
    Ok([k, apart])
}

/// Whether the faces touch all along the jump fit: contact makes K_I vanish there, whatever the tractions that it takes.
fn is_closed(loading: &Loading<'_>, now: &Snapshot, tip: &TipFrame) -> bool {
    let (body, crack) = (loading.body(), &loading.body().cracks[tip.crack]);
    let reach = FIT_REACH * crack_size(crack);
    let points = body.points.iter().zip(&now.status);
    let mut own = points.filter(|(point, _)| {
        point.crack == crack.number && norm(&sub(&point.x, &tip.position)) <= reach
    });
    own.all(|(_, status)| *status != PointStatus::Open)
}

/// G [J/m²] of K_I, K_II, K_III [Pa √m]; E' and μ [Pa].
fn rate([k1, k2, k3]: [f64; 3], modulus: f64, mu: f64) -> f64 {
    (k1 * k1 + k2 * k2) / modulus + k3 * k3 / (2.0 * mu)
}

/// Direction of the largest hoop stress [°]; not-a-number where no mode opens or slides the tip.
fn angle([k1, k2, _]: [f64; 3]) -> f64 {
    let root = k1.hypot(8f64.sqrt() * k2);
    // The same without the difference that cancels: (K_I − √…)(K_I + √…) = −8 K_II².
    match k1 + root {
        sum if sum > 0.0 => 2.0 * (-2.0 * k2 / sum).atan().to_degrees(),
        _ => f64::NAN,
    }
}

/// Largest change of a function of K as the modes change by their estimates, one sign after the other.
fn spread(of: impl Fn([f64; 3]) -> f64, k: [f64; 3], apart: [f64; 3]) -> f64 {
    let value = of(k);
    let change = |bits: usize| {
        let sign = |c: usize| if bits >> c & 1 == 0 { 1.0 } else { -1.0 };
        (of([0, 1, 2].map(|c| k[c] + sign(c) * apart[c])) - value).abs()
    };
    let known = apart.iter().all(|a| a.is_finite());
    let largest = (0..8).map(change).fold(0.0, f64::max);
    if known { largest } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: Erdogan & Sih 1963: pure mode II turns by 70.5° against the sign of K_II, pure mode I does not turn; Irwin.
    #[test]
    fn directions_and_rates_are_those_of_the_formulas() {
        let root = 1.0f64 / 3.0;
        assert!((angle([0.0, 1.0, 0.0]) + root.acos().to_degrees()).abs() < 1e-12);
        assert!((angle([0.0, -1.0, 0.0]) - root.acos().to_degrees()).abs() < 1e-12);
        assert_eq!(angle([2.0, 0.0, 1.0]), 0.0);
        assert!(angle([-1.0, 0.0, 0.0]).is_nan());
        // sin θ K_I + (3 cos θ − 1) K_II = 0 is what the angle solves.
        let (k1, k2) = (1.3, -0.4);
        let (sin, cos) = angle([k1, k2, 0.0]).to_radians().sin_cos();
        assert!((sin * k1 + (3.0 * cos - 1.0) * k2).abs() < 1e-14);
        assert_eq!(rate([3.0, 4.0, 2.0], 5.0, 2.0), 6.0);
        let change = spread(|k| k[0] - k[1], [1.0, 2.0, 0.0], [0.5, 0.25, 9.0]);
        assert_eq!(change, 0.75);
    }
}
