//! Place along a 2D crack where slip ends and stick begins, read from the contact points.
//!
//! ```text
//!   |slip|^{2/3} ≈ c (s* − s)        through the two slipping points next to the first sticking one
//! ```
//!
//! Where a slip zone grows into stick its slip falls with the 3/2 power of the distance from the boundary s*, since the
//! stress is finite there: H. M. Westergaard (1939). So the boundary is found between the points, not at one of them.

use stickslip_methods::PointStatus;

use crate::analytic::Field;
use crate::fem::{dot, sub};
use crate::harness::body::Body;
use crate::harness::quantities::Snapshot;

use super::Deviation;

/// The row of the boundary, if the closed form has one. It belongs to the only crack of the body.
pub(super) fn row(body: &Body, field: &dyn Field, now: &Snapshot) -> Option<Deviation> {
    let place = field.stick_boundary()?;
    let crack = body.cracks.first()?;
    let dim = body.mesh.dim();
    // From the nearest contact point, whose abscissa is known, along the crack.
    let near = body.points.iter().min_by(|p, q| {
        let away = |x| dot(&sub(x, &place), &sub(x, &place));
        away(&p.x).total_cmp(&away(&q.x))
    })?;
    let exact = near.s + dot(&near.frame[1], &sub(&place, &near.x));
    let mut points: Vec<(f64, f64, PointStatus)> = body
        .points
        .iter()
        .enumerate()
        .map(|(i, point)| (point.s, now.jump[i * dim + 1].abs(), now.status[i]))
        .collect();
    points.sort_by(|p, q| p.0.total_cmp(&q.0));
    let found = boundary(&points).unwrap_or(f64::NAN);
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

/// s* from points (abscissa, size of the slip, status) in order; `None` unless slip turns into stick exactly once, behind two
/// slipping points.
fn boundary(points: &[(f64, f64, PointStatus)]) -> Option<f64> {
    let slips = |k: usize| points[k].2 == PointStatus::Slip;
    let mut turns = (1..points.len()).filter(|&k| slips(k - 1) != slips(k));
    let turn = turns.next()?;
    if turns.next().is_some() {
        return None;
    }
    // The last slipping point and the one before it, counted from the slipping end.
    let (last, before) = if slips(turn - 1) {
        (turn - 1, turn.checked_sub(2)?)
    } else {
        (turn, turn + 1)
    };
    let value = |k: usize| points.get(k).map(|p| (p.0, p.1.powf(2.0 / 3.0)));
    let ((s, a), (r, b)) = (value(last)?, value(before)?);
    let place = s + (s - r) * a / (b - a);
    (b > a && place.is_finite()).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use PointStatus::{Open, Slip, Stick};

    fn points(places: &[f64], boundary: f64, sense: f64) -> Vec<(f64, f64, PointStatus)> {
        let at = |&s: &f64| {
            let inside = sense * (boundary - s);
            let status = if inside > 0.0 { Slip } else { Stick };
            (s, 3e-4 * inside.max(0.0).powf(1.5), status)
        };
        places.iter().map(at).collect()
    }

    /// Source: definition. Goal: the boundary of a slip that falls with the 3/2 power is found exactly, from either end.
    #[test]
    fn the_boundary_of_a_growing_slip_zone_is_found_between_the_points() {
        let places = [0.1, 0.25, 0.3, 0.5, 0.6, 0.85];
        for sense in [1.0, -1.0] {
            let found = boundary(&points(&places, 0.43, sense)).unwrap();
            assert!((found - 0.43).abs() < 1e-14, "{found}");
        }
    }

    #[test]
    fn without_one_boundary_behind_two_slipping_points_there_is_none() {
        let places = [0.1, 0.2, 0.3];
        assert_eq!(boundary(&points(&places, 2.0, 1.0)), None);
        assert_eq!(boundary(&points(&places, 0.15, 1.0)), None);
        assert_eq!(boundary(&points(&places, 0.25, -1.0)), None);
        let twice = [
            (0.0, 0.0, Stick),
            (0.1, 1.0, Slip),
            (0.2, 2.0, Slip),
            (0.3, 0.0, Open),
        ];
        assert_eq!(boundary(&twice), None);
        assert_eq!(boundary(&[]), None);
    }
}
