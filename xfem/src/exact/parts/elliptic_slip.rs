//! Uniform stress drop on an elliptic crack, and the slip at which Coulomb friction holds the rest of a remote shear.
//!
//! ```text
//!   jump at the centre D = C · drop,   I₀, I₁: integrals of [`super::elliptic_disc`] on the disc
//!     C_a = 4 (1−ν) / (G a b (I₀ + (1−ν) I₁))     C_b = 4 (1−ν) / (G a b ((1−ν) I₀ + I₁))
//!     C_n = 4 (1−ν) / (G a b (I₀ + I₁))
//!   slip D (cos α, sin α):   cos α = τ_a C_a / (D + μ p C_a),   sin α = τ_b C_b / (D + μ p C_b),   cos² α + sin² α = 1
//! ```
//!
//! The compliances are those of Kassir and Sih (1966); with I₀ and I₁ the disc is no special case, with complete elliptic
//! integrals K and E it is 0/0. On an ellipse the slip does not point along the shear, and neither does friction.

use crate::material::Material;

use super::elliptic_disc::disc_integrals;

/// Jump at the centre per unit of uniform stress drop, along the axes of the frame [m/Pa].
pub fn compliance(half_axes: [f64; 2], Material { young, poisson }: Material) -> [f64; 3] {
    let shear = young / (2.0 * (1.0 + poisson));
    let [i0, i1] = disc_integrals(half_axes);
    let scale = 4.0 * (1.0 - poisson) / (shear * half_axes[0] * half_axes[1]);
    [
        scale / (i0 + (1.0 - poisson) * i1),
        scale / ((1.0 - poisson) * i0 + i1),
        scale / (i0 + i1),
    ]
}

/// Slip at the centre under remote shear `tau` and a friction bound >= 0; zero if the bound holds the shear.
///
/// D solves F(D) = Σ (τ_i C_i / (D + bound C_i))² = 1. 1/√F is concave, so Newton's method on it is monotone from the left.
pub fn slip(tau: [f64; 2], bound: f64, compliance: [f64; 2]) -> [f64; 2] {
    /// Newton steps; 3 to 6 are needed.
    const STEPS: usize = 60;
    if tau[0].hypot(tau[1]) <= bound {
        return [0.0; 2];
    }
    let ratio = |d: f64, k: usize| tau[k] * compliance[k] / (d + bound * compliance[k]);
    // Largest of the values at which a single term is 1: F >= 1 there.
    let mut d = (0..2)
        .map(|k| (tau[k].abs() - bound) * compliance[k])
        .fold(0.0, f64::max);
    for _ in 0..STEPS {
        let f: f64 = (0..2).map(|k| ratio(d, k).powi(2)).sum();
        let slope: f64 = (0..2)
            .map(|k| ratio(d, k).powi(2) / (d + bound * compliance[k]))
            .sum();
        let step = f * (f.sqrt() - 1.0) / slope;
        if step.is_nan() || step <= 1e-16 * d {
            break;
        }
        d += step;
    }
    [d * ratio(d, 0), d * ratio(d, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const MATERIAL: Material = Material::new(2.6, 0.3);

    /// Complete elliptic integrals K and E of k² = `m` by the arithmetic-geometric mean.
    fn complete(m: f64) -> (f64, f64) {
        let (mut a, mut g, mut c2, mut power, mut sum) = (1.0, (1.0 - m).sqrt(), m, 0.5, 0.5 * m);
        while c2 > 1e-30 {
            let difference = 0.5 * (a - g);
            (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
            c2 = difference * difference;
            power *= 2.0;
            sum += power * c2;
        }
        let k = PI / (2.0 * a);
        (k, k * (1.0 - sum))
    }

    #[test]
    fn compliances_are_those_with_complete_elliptic_integrals() {
        let (k, e) = complete(0.75);
        assert!((k - 2.156_515_647_499_643).abs() < 1e-14);
        assert!((e - 1.211_056_027_568_459_5).abs() < 1e-14);
        let (g, nu) = (1.0, 0.3);
        for ratio in [0.1, 0.5, 0.8] {
            let found = compliance([1.0, ratio], MATERIAL);
            let (m, m1) = (1.0 - ratio * ratio, ratio * ratio);
            let (k, e) = complete(m);
            let exact = [
                2.0 * ratio * (1.0 - nu) * m / (g * ((m - nu) * e + nu * m1 * k)),
                2.0 * ratio * (1.0 - nu) * m / (g * ((m + nu * m1) * e - nu * m1 * k)),
                2.0 * ratio * (1.0 - nu) / (g * e),
            ];
            for (c, exact) in found.iter().zip(exact) {
                assert!(
                    (c - exact).abs() < 1e-13 * exact,
                    "{ratio}: {found:?} {exact}"
                );
            }
        }
    }
}
