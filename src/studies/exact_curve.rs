//! The closed form of a case along its crack, for figures: contact traction and jump from end to end.
//!
//! ```text
//!   s_k = ½ L (1 − cos π k/N),  k = 0, …, N       dense at the ends, where slip and opening grow like √s
//! ```
//!
//! L is the length of the crack; the ends are taken 1e-12 L inside, since a tip itself has no side. Places outside the body, and those where the closed form has no value, are left out. It
//! does not depend on the discretisation, so there is one curve per case, friction coefficient and increment.

use std::f64::consts::PI;

use stickslip_xfem::cut::crack::{Crack, Geometry};
use stickslip_xfem::cut::placement::cells_at;

use crate::case::Case;
use crate::model::loading::Loading;
use crate::model::quantities::PointState;
use crate::studies::rows::{ExactPoint, RunKey};

/// Intervals N of the curve: half a millimetre at most on a figure of 85 mm.
const INTERVALS: usize = 160;

/// Distance of the first and the last place from the ends, in lengths of the crack.
const INSIDE: f64 = 1e-12;

/// Stands for the method.
const EXACT: &str = "exact";

/// Tractions and jumps below this fraction of the largest are round-off.
const ROUND_OFF: f64 = 1e-12;

/// The closed form along a 2D crack at the end of every increment, time 0 included where a run begins there; nothing where the case names none, or in a solid.
pub fn exact_points(case: &Case, loading: &Loading<'_>, friction: f64) -> Vec<ExactPoint> {
    let mesh = &loading.body().mesh;
    let Some(spec) = case.cracks.first().filter(|_| case.exact.is_some()) else {
        return Vec::new();
    };
    // From the case file: a crack along cell edges has no level set.
    let crack = Crack::new(0, &spec.geometry, spec.tip, mesh, &mesh.lengths());
    let Geometry::Curve(curve) = &crack.geometry else {
        return Vec::new();
    };
    let at = |k: usize| {
        let turn = PI * k as f64 / INTERVALS as f64;
        let s = (0.5 - 0.5 * turn.cos()).clamp(INSIDE, 1.0 - INSIDE) * curve.length();
        (s, curve.at(s).0)
    };
    let places: Vec<_> = (0..=INTERVALS)
        .map(at)
        .filter(|(_, x)| !cells_at(mesh, x).is_empty())
        .collect();
    let increments =
        (loading.first()..=loading.increments()).filter_map(|i| Some((i, loading.exact(i)?)));
    let rows = increments.flat_map(|(increment, field)| {
        places.iter().map(move |(s, x)| {
            let (traction, jump) = (field.traction(x), field.jump(x));
            ExactPoint {
                key: key(&case.name, friction, increment),
                point: point(*s, x, jump, traction),
            }
        })
    });
    let finite = |ExactPoint { point, .. }: &ExactPoint| {
        let values = [point.gap_m, point.slip_a_m, point.p_n, point.p_a];
        values.iter().all(|value| value.is_finite())
    };
    let mut rows: Vec<ExactPoint> = rows.filter(finite).collect();
    forget_round_off(&mut rows);
    rows
}

fn key(case: &str, friction: f64, increment: usize) -> RunKey {
    RunKey {
        case: case.to_owned(),
        mesh: String::new(),
        space: String::new(),
        method: EXACT.into(),
        friction,
        increment,
    }
}

/// A place at the distance `s` from the first end, with the jump and the traction (normal, tangential) of the closed form.
fn point(s: f64, x: &[f64], jump: [f64; 3], traction: [f64; 3]) -> PointState {
    PointState {
        crack: 1,
        number: 0,
        x_m: x[0],
        y_m: x[1],
        z_m: 0.0,
        s_m: s,
        weight: 1.0,
        gap_m: jump[0],
        slip_a_m: jump[1],
        slip_b_m: 0.0,
        p_n: traction[0],
        p_a: traction[1],
        p_b: 0.0,
        force_unit: "Pa".into(),
        status: String::new(),
    }
}

/// Makes round-off zero: it would differ between machines.
fn forget_round_off(rows: &mut [ExactPoint]) {
    type Pair = fn(&mut ExactPoint) -> [&mut f64; 2];
    let pairs: [Pair; 2] = [
        |row| [&mut row.point.gap_m, &mut row.point.slip_a_m],
        |row| [&mut row.point.p_n, &mut row.point.p_a],
    ];
    for pair in pairs {
        let largest = rows.iter_mut().flat_map(pair).map(|v| v.abs());
        let floor = ROUND_OFF * largest.fold(0.0, f64::max);
        for value in rows.iter_mut().flat_map(pair) {
            if value.abs() < floor {
                *value = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_off_beside_large_values_is_zero() {
        let row = |gap, shear| {
            let point = point(0.5, &[0.5, 0.0], [gap, -1e-5, 0.0], [1e7, shear, 0.0]);
            let key = key("case", 0.1, 1);
            ExactPoint { key, point }
        };
        let mut rows = vec![row(9e-18, 9e-6), row(-2e-17, 2e-5)];
        forget_round_off(&mut rows);
        // Each pair against its own largest value: 1e-12 of 1e-5 m and of 1e7 Pa.
        assert_eq!(rows, [row(0.0, 0.0), row(-2e-17, 2e-5)]);
    }
}
