//! The closed form of a case along its crack, for figures: contact traction and jump from end to end.
//!
//! ```text
//!   s_k = ½ L (1 − cos π k/N),  k = 0, …, N       dense at the ends, where slip and opening grow like √s
//! ```
//!
//! L is the length of the crack. Places outside the body, and those where the closed form has no value, are left out. It
//! does not depend on the discretisation, so there is one curve per case, friction coefficient and increment.

use std::f64::consts::PI;

use crate::harness::case::Case;
use crate::harness::loading::Loading;
use crate::harness::record::ExactRow;
use crate::xfem::crack::{Crack, Geometry};
use crate::xfem::placement::cells_at;

/// Intervals N of the curve: half a millimetre at most on a figure of 85 mm.
const INTERVALS: usize = 160;

/// The closed form along a 2D crack at the end of every increment; nothing where the case names none, or in a solid.
pub fn exact_rows(case: &Case, loading: &Loading<'_>, friction: f64) -> Vec<ExactRow> {
    let mesh = &loading.body().mesh;
    let Some(spec) = case.cracks.first().filter(|_| case.exact.is_some()) else {
        return Vec::new();
    };
    // From the case file: a crack along cell edges has no level set.
    let crack = Crack::new(0, spec, mesh);
    let Geometry::Curve(curve) = &crack.geometry else {
        return Vec::new();
    };
    let at = |k: usize| {
        let turn = PI * k as f64 / INTERVALS as f64;
        let s = 0.5 * curve.length() * (1.0 - turn.cos());
        (s, curve.at(s).0)
    };
    let places: Vec<_> = (0..=INTERVALS)
        .map(at)
        .filter(|(_, x)| !cells_at(mesh, x).is_empty())
        .collect();
    let increments = (1..=loading.increments()).filter_map(|i| Some((i, loading.exact(i)?)));
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
    rows.filter(finite).collect()
}
