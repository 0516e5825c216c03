//! Place along a 2D crack where slip ends and stick begins, read from the slip of the crack surface.
//!
//! ```text
//!   |slip|^{2/3} ≈ c (s* − s)        line of least squares over the surface from the third last slipping point to the last
//! ```
//!
//! Where a slip zone grows into stick its slip falls with the 3/2 power of the distance from the boundary s*, since the
//! stress is finite there: H. M. Westergaard (1939). So the boundary is found between the points, not at one of them. The
//! contact points only tell which part of the surface slips for certain: the mean slip of a point is not the slip at its
//! centroid, and the function of the last one reaches into the stick zone. A line through two such means is off by a third
//! of a cell on every mesh; the slip of the surface itself leaves that bias behind, and the curvature of
//! (s* − s)(s − s₀)^{1/3} along the line an error of order h² (s₀: the other end of the zone).

use stickslip_methods::PointStatus;
use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::exact::Field;

use crate::model::body::Body;
use crate::model::snapshot::Snapshot;

use super::deviation::Deviation;

/// Slipping points that the line of least squares reaches over; two where there are no more.
const REACH: usize = 3;

/// The row of the boundary, if the closed form has one. It belongs to the only crack of the body. `surface`: quadrature
/// points of that crack.
pub(super) fn row(
    body: &Body,
    surface: &[SurfacePoint],
    field: &dyn Field,
    now: &Snapshot,
) -> Option<Deviation> {
    let place = field.stick_boundary()?;
    let crack = body.cracks.first()?;
    let integrator = body.integrator();
    let mut points: Vec<(f64, PointStatus)> = body
        .points
        .iter()
        .zip(&now.status)
        .map(|(point, status)| (point.s, *status))
        .collect();
    points.sort_by(|p, q| p.0.total_cmp(&q.0));
    if surface.is_empty() {
        return None;
    }
    let samples: Vec<[f64; 3]> = surface
        .iter()
        .map(|q| {
            let slip = q.local(&q.jump(&integrator, &now.u))[1].abs();
            [crack.abscissa(&q.x), q.weight, slip]
        })
        .collect();
    let found = boundary(&points, &samples).unwrap_or(f64::NAN);
    let exact = crack.abscissa(&place);
    let length = crack.range[1] - crack.range[0];
    Some(Deviation::new(
        "stick_boundary",
        String::new(),
        [found, exact],
        (found - exact).abs(),
        length,
        length,
    ))
}

/// s* from contact points (abscissa, status) in order and surface points (abscissa, weight, size of the slip); `None` unless
/// slip turns into stick exactly once, behind two slipping points.
fn boundary(points: &[(f64, PointStatus)], surface: &[[f64; 3]]) -> Option<f64> {
    let slips = |k: usize| points[k].1 == PointStatus::Slip;
    let mut turns = (1..points.len()).filter(|&k| slips(k - 1) != slips(k));
    let turn = turns.next()?;
    if turns.next().is_some() {
        return None;
    }
    // From the last slipping point back to the one the line starts at.
    let (last, first) = if slips(turn - 1) {
        (turn - 1, turn.saturating_sub(REACH))
    } else {
        (turn, (turn + REACH).min(points.len()) - 1)
    };
    let ends = [points[last].0, points[first].0];
    let (from, to) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let within = surface.iter().filter(|q| q[0] >= from && q[0] <= to);
    // Sums of w, w s, w s², w v, w s v with v = |slip|^{2/3}, s from the last slipping point.
    let mut sums = [0.0; 5];
    for &[s, w, slip] in within {
        let (s, v) = (s - ends[0], slip.powf(2.0 / 3.0));
        for (sum, term) in sums.iter_mut().zip([1.0, s, s * s, v, s * v]) {
            *sum += w * term;
        }
    }
    let [w, ws, wss, wv, wsv] = sums;
    let slope = (w * wsv - ws * wv) / (w * wss - ws * ws);
    let place = ends[0] + (ws / w - wv / w / slope);
    // Slip falls towards the boundary.
    let falls = slope * (ends[0] - ends[1]) < 0.0;
    (falls && place.is_finite()).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use PointStatus::{Open, Slip, Stick};

    const PLACES: [f64; 6] = [0.1, 0.25, 0.3, 0.5, 0.6, 0.85];

    fn points(places: &[f64], boundary: f64, sense: f64) -> Vec<(f64, PointStatus)> {
        let status = |s: f64| {
            if sense * (boundary - s) > 0.0 {
                Slip
            } else {
                Stick
            }
        };
        places.iter().map(|&s| (s, status(s))).collect()
    }

    fn surface(boundary: f64, sense: f64) -> Vec<[f64; 3]> {
        let at = |k: usize| {
            let s = 0.013 * k as f64;
            let inside = (sense * (boundary - s)).max(0.0);
            [s, 1.0 + (k % 3) as f64, 3e-4 * inside.powf(1.5)]
        };
        (0..77).map(at).collect()
    }

    /// Source: definition. Goal: the boundary of a slip that falls with the 3/2 power is found exactly, from either end.
    #[test]
    fn the_boundary_of_a_growing_slip_zone_is_found_between_the_points() {
        for sense in [1.0, -1.0] {
            let found = boundary(&points(&PLACES, 0.43, sense), &surface(0.43, sense)).unwrap();
            assert!((found - 0.43).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn without_one_boundary_behind_two_slipping_points_there_is_none() {
        let places = [0.1, 0.2, 0.3];
        for (end, sense) in [(2.0, 1.0), (0.15, 1.0), (0.25, -1.0)] {
            let surface = surface(end, sense);
            assert_eq!(boundary(&points(&places, end, sense), &surface), None);
        }
        let twice = [(0.0, Stick), (0.1, Slip), (0.2, Slip), (0.3, Open)];
        assert_eq!(boundary(&twice, &surface(0.25, 1.0)), None);
        assert_eq!(boundary(&[], &[]), None);
    }

    /// Slip that grows towards the sticking points has no boundary there.
    #[test]
    fn slip_that_grows_towards_stick_has_no_boundary() {
        let found = boundary(&points(&PLACES, 0.43, 1.0), &surface(0.05, -1.0));
        assert_eq!(found, None);
    }
}
