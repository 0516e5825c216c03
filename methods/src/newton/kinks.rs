//! Where a step crosses the kinks of the contact equations.
//! ```text
//! z_n + t δz_n = 0                          a point opens or closes
//! |z_t + t δz_t| = μ (b + t δb),  b = 0     it begins or ends to slip; b is z_n or P_n
//! ```
//! Between them the equations are linear in t, so that the merit is a parabola, but for slip that turns (3D). Kinks as
//! places to stop at: Stefansson, Varela, Both & Keilegavlen, A line search algorithm for multiphysics problems with
//! fracture deformation, arXiv:2407.01184 (2024).

use crate::contract::law::tangential_norm;

/// Appends all t in (0, 1) at which the point with trial force `z` and `bound` changes its piece along (`dz`, `dbound`).
pub(crate) fn add_kinks(
    mu: f64,
    (z, bound): (&[f64], f64),
    (dz, dbound): (&[f64], f64),
    kinks: &mut Vec<f64>,
) {
    let mut roots = vec![-z[0] / dz[0], -bound / dbound];
    let product =
        |x: &[f64], y: &[f64]| -> f64 { x[1..].iter().zip(&y[1..]).map(|(x, y)| x * y).sum() };
    // a t² + 2 h t + c = 0.
    let (a, h, c) = (
        product(dz, dz) - (mu * dbound).powi(2),
        product(z, dz) - mu * mu * bound * dbound,
        (tangential_norm(z) - mu * bound) * (tangential_norm(z) + mu * bound),
    );
    if z.len() > 1 && h * h >= a * c {
        let q = -(h + h.signum() * (h * h - a * c).sqrt());
        roots.extend([q / a, c / q]);
    }
    // What never happens is infinite or NaN.
    kinks.extend(roots.into_iter().filter(|t| *t > 0.0 && *t < 1.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::law::return_map;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        /// Between two kinks nothing changes.
        #[test]
        fn every_change_of_branch_is_a_kink(
            mu in 0.0..3.0_f64, size in 1..=3_usize,
            z in prop::array::uniform3(-2.0..2.0_f64), dz in prop::array::uniform3(-4.0..4.0_f64),
        ) {
            let mut kinks = vec![0.0, 1.0];
            add_kinks(mu, (&z[..size], z[0]), (&dz[..size], dz[0]), &mut kinks);
            kinks.sort_by(f64::total_cmp);
            for pair in kinks.windows(2).filter(|pair| pair[1] - pair[0] > 1e-6) {
                let branch = |part: f64| {
                    let t = pair[0] + part * (pair[1] - pair[0]);
                    let mut at = [0, 1, 2].map(|k| z[k] + t * dz[k]);
                    return_map(mu, &mut at[..size])
                };
                prop_assert_eq!(branch(0.01), branch(0.5));
                prop_assert_eq!(branch(0.5), branch(0.99));
            }
        }
    }
}
