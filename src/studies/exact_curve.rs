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
use crate::studies::rows::ExactRow;

/// Intervals N of the curve: half a millimetre at most on a figure of 85 mm.
const INTERVALS: usize = 160;

/// Distance of the first and the last place from the ends, in lengths of the crack.
const INSIDE: f64 = 1e-12;

/// Tractions and jumps below this fraction of the largest are round-off.
const ROUND_OFF: f64 = 1e-12;

/// The closed form along a 2D crack at the end of every increment, time 0 included where a run begins there; nothing where the case names none, or in a solid.
pub fn exact_rows(case: &Case, loading: &Loading<'_>, friction: f64) -> Vec<ExactRow> {
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
            ExactRow {
                case: case.name.clone(),
                friction,
                increment,
                crack: 1,
                s_m: *s,
                x_m: x[0],
                y_m: x[1],
                gap_m: jump[0],
                slip_a_m: jump[1],
                p_n_pa: traction[0],
                p_a_pa: traction[1],
            }
        })
    });
    let finite = |row: &ExactRow| {
        let values = [row.gap_m, row.slip_a_m, row.p_n_pa, row.p_a_pa];
        values.iter().all(|value| value.is_finite())
    };
    let mut rows: Vec<ExactRow> = rows.filter(finite).collect();
    forget_round_off(&mut rows);
    rows
}

/// Makes round-off zero: it would differ between machines.
fn forget_round_off(rows: &mut [ExactRow]) {
    type Pair = fn(&mut ExactRow) -> [&mut f64; 2];
    let pairs: [Pair; 2] = [
        |row| [&mut row.gap_m, &mut row.slip_a_m],
        |row| [&mut row.p_n_pa, &mut row.p_a_pa],
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
        let row = |gap_m, p_a_pa| ExactRow {
            case: "case".into(),
            friction: 0.1,
            increment: 1,
            crack: 1,
            s_m: 0.5,
            x_m: 0.5,
            y_m: 0.0,
            gap_m,
            slip_a_m: -1e-5,
            p_n_pa: 1e7,
            p_a_pa,
        };
        let mut rows = vec![row(9e-18, 9e-6), row(-2e-17, 2e-5)];
        forget_round_off(&mut rows);
        // Each pair against its own largest value: 1e-12 of 1e-5 m and of 1e7 Pa.
        assert_eq!(rows, [row(0.0, 0.0), row(-2e-17, 2e-5)]);
    }
}
