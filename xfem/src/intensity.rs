//! Stress intensity factors from the jump behind a crack front.
//!
//! ```text
//!   [[u]](r)/√r = c₀ + c₁ r        least squares over from < r <= to, r the distance behind the front
//!
//!   K_I = E'/8 √(2π) c₀·n      K_II = E'/8 √(2π) c₀·ahead      K_III = μ/4 √(2π) c₀·(ahead × n)
//! ```
//!
//! Displacement correlation with the next term of Williams' series: Chan, Tuba & Wilson, Eng. Fract. Mech. 2 (1970) 1.
//! The jump of a loaded or free crack goes on in r^(3/2) after √r, whatever smooth traction its faces carry. The cells at
//! the front represent the field worst, so the nearest part is left out.

mod behind;
pub mod interaction;
pub mod williams;

use std::f64::consts::PI;

use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, add_scaled, cross, dot};
use crate::intensity::williams::plane_modulus;
use crate::material::Lame;

/// A jump at a distance behind a front.
#[derive(Debug, Clone, Copy)]
pub struct JumpSample {
    /// Distance r > 0 [m].
    pub distance: f64,
    /// Jump u₁ − u₂ in space [m].
    pub jump: Point,
    /// Weight in the sum of squares, e.g. the length the sample stands for.
    pub weight: f64,
}

/// The range of distances a fit uses [m].
#[derive(Debug, Clone, Copy)]
pub struct FitRange {
    /// Nearest distance, left out itself.
    pub from: f64,
    /// Farthest distance, included.
    pub to: f64,
}

/// K_I, K_II, K_III [Pa √m] at a front from jumps behind it; in 2D the last is 0. Samples outside of the range do not
/// count; `None` if fewer than two distances are left, too few for two coefficients.
pub fn jump_fit(
    tip: &TipFrame,
    lame: Lame,
    range: FitRange,
    samples: impl IntoIterator<Item = JumpSample>,
) -> Option<[f64; 3]> {
    let inside: Vec<JumpSample> = samples
        .into_iter()
        .filter(|s| s.distance > range.from && s.distance <= range.to)
        .collect();
    let total: f64 = inside.iter().map(|s| s.weight).sum();
    if total <= 0.0 {
        return None;
    }
    // Straight line through (r, [[u]]/√r): about the mean distance the normal equations are diagonal.
    let mean = inside.iter().map(|s| s.weight * s.distance).sum::<f64>() / total;
    let spread: f64 = (inside
        .iter()
        .map(|s| s.weight * (s.distance - mean).powi(2)))
    .sum();
    if spread <= 1e-12 * total * range.to * range.to {
        return None;
    }
    let axes = [tip.normal, tip.ahead, cross(&tip.ahead, &tip.normal)];
    let modulus = plane_modulus(lame);
    let factors = [modulus / 8.0, modulus / 8.0, lame.mu / 4.0];
    Some([0, 1, 2].map(|k| {
        let value = |s: &JumpSample| dot(&s.jump, &axes[k]) / s.distance.sqrt();
        let level = inside.iter().map(|s| s.weight * value(s)).sum::<f64>() / total;
        let slope = inside
            .iter()
            .map(|s| s.weight * (s.distance - mean) * value(s))
            .sum::<f64>()
            / spread;
        factors[k] * (2.0 * PI).sqrt() * (level - slope * mean)
    }))
}

/// The same from a function that gives the jump at a point of the crack (`None`: the point is not on it), sampled at
/// `count` distances along the in-plane inward normal of the front, evenly spaced in the range.
pub fn jump_fit_along(
    tip: &TipFrame,
    lame: Lame,
    range: FitRange,
    count: usize,
    jump: impl Fn(&Point) -> Option<Point>,
) -> Option<[f64; 3]> {
    let samples = (0..count).filter_map(|i| {
        let part = (i as f64 + 0.5) / count as f64;
        let distance = range.from + part * (range.to - range.from);
        let jump = jump(&add_scaled(&tip.position, -distance, &tip.ahead))?;
        Some(JumpSample {
            distance,
            jump,
            weight: 1.0,
        })
    });
    jump_fit(tip, lame, range, samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::williams::{Mode, Williams};
    use crate::material::{Material, Model};

    const RANGE: FitRange = FitRange {
        from: 0.02,
        to: 0.3,
    };

    fn lame() -> Lame {
        let material = Material::new(2.0, 0.3);
        Lame::new(material, Model::Solid)
    }

    fn tip() -> TipFrame {
        let (s, c) = (-2.1f64).sin_cos();
        TipFrame::straight(0, [1.0, 2.0, 0.5], [c, 0.0, s], [0.0, 1.0, 0.0])
    }

    /// Source: Williams 1957. Goal: the unit fields, and any jump √r (c₀ + c₁ r), to rounding.
    #[test]
    fn unit_fields_are_found_in_the_frame_of_the_front() {
        let (tip, lame) = (tip(), lame());
        for (k, mode) in [Mode::I, Mode::II, Mode::III].into_iter().enumerate() {
            let field = Williams::new(&tip, lame, mode);
            let jump = |x: &Point| {
                let [one, two] = [1.0, -1.0].map(|side| field.at(x, Some(side)).0);
                let r = crate::geometry::norm(&crate::geometry::sub(x, &tip.position));
                Some(add_scaled(
                    &[0.0; 3],
                    1.0 - 0.7 * r,
                    &crate::geometry::sub(&one, &two),
                ))
            };
            let found = jump_fit_along(&tip, lame, RANGE, 7, jump).unwrap();
            for (m, value) in found.iter().enumerate() {
                let exact = if m == k { 1.0 } else { 0.0 };
                assert!((value - exact).abs() < 1e-12, "{mode:?}: {found:?}");
            }
        }
    }

    /// Source: Westergaard 1939: a crack of length 2a opens by 4σ/E' √(a² − s²), K_I = σ √(πa). Goal: what the two-term fit
    /// leaves out falls like (r/a)²; 1e-3 at r <= 0.3 a.
    #[test]
    fn a_griffith_crack_is_found_to_the_second_order_of_the_range() {
        let (tip, lame) = (tip(), lame());
        let a = 1.0;
        let found = |to: f64| {
            let range = FitRange { from: 0.1 * to, to };
            let jump = |x: &Point| {
                let r = crate::geometry::norm(&crate::geometry::sub(x, &tip.position));
                let opening = 4.0 / plane_modulus(lame) * (a * a - (a - r).powi(2)).sqrt();
                Some(add_scaled(&[0.0; 3], opening, &tip.normal))
            };
            jump_fit_along(&tip, lame, range, 20, jump).unwrap()[0] / (PI * a).sqrt() - 1.0
        };
        let [coarse, fine] = [found(0.3), found(0.15)];
        assert!(coarse.abs() < 1e-3, "{coarse}");
        assert!((coarse / fine - 4.0).abs() < 0.5, "{coarse} {fine}");
    }

    /// Source: linear algebra. Goal: a fit without two distances is refused.
    #[test]
    fn two_coefficients_need_two_distances() {
        let sample = |distance| JumpSample {
            distance,
            jump: [0.0, 1.0, 0.0],
            weight: 1.0,
        };
        let fit = |d: &[f64]| jump_fit(&tip(), lame(), RANGE, d.iter().map(|&r| sample(r)));
        assert!(fit(&[]).is_none());
        assert!(fit(&[0.1, 0.1, 0.01, 0.5]).is_none());
        assert!(fit(&[0.1, 0.2]).is_some());
    }
}
