//! Limits and orders from a sequence of meshes h, h/2, h/4.
//!
//! ```text
//!   q(h) = q* + C hᵖ + …      ρ = (q(h/2) − q(h)) / (q(h/4) − q(h/2)) = 2ᵖ      q* ≈ q(h/4) + (q(h/4) − q(h/2)) / (ρ − 1)
//! ```
//!
//! Richardson, Phil. Trans. R. Soc. A 226 (1927) 299; order from three meshes and the factor of safety 1.25: Roache, J.
//! Fluids Engng 116 (1994) 405, grid convergence index.

/// Factor of safety on the last correction (Roache 1994, three meshes).
const SAFETY: f64 = 1.25;

/// Highest order that an error bar may rely on: bilinear cells give displacements and energies to h². A sequence that
/// seems to converge faster is more likely to hide a change of sign of the error.
const HIGHEST_ORDER: f64 = 2.0;

/// A limit estimated from three meshes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extrapolated {
    /// Estimate of the limit, in the unit of the values.
    pub value: f64,
    /// Observed order p; `None` for a sequence without one: it oscillates, or no longer changes.
    pub order: Option<f64>,
    /// Half-width of the interval around `value` that is believed to hold the limit, same unit; never below the rounding
    /// of the values.
    pub error_bar: f64,
}

/// Limit of the values at h, h/2 and h/4.
///
/// - Monotone with shrinking differences: Richardson's limit; the bar is 1.25 times the correction, with an order of at
///   most 2.
/// - Oscillating with shrinking differences: there is no order; the value is the last one, the bar the spread of all three.
/// - Differences that do not shrink, or values that are not finite: `None`, the sequence says nothing about a limit.
pub fn richardson(values: [f64; 3]) -> Option<Extrapolated> {
    let [coarse, middle, fine] = values;
    if values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let rounding = 4.0 * f64::EPSILON * values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let (first, last) = (middle - coarse, fine - middle);
    if first.abs() <= rounding && last.abs() <= rounding {
        return Some(Extrapolated {
            value: fine,
            order: None,
            error_bar: rounding,
        });
    }
    if last.abs() >= first.abs() {
        return None;
    }
    if last.abs() <= rounding || first * last < 0.0 {
        let highest = coarse.max(middle).max(fine);
        let lowest = coarse.min(middle).min(fine);
        return Some(Extrapolated {
            value: fine,
            order: None,
            error_bar: highest - lowest,
        });
    }
    let ratio = first / last;
    let correction = last / (ratio - 1.0);
    let cautious = last.abs() / (HIGHEST_ORDER.exp2() - 1.0);
    Some(Extrapolated {
        value: fine + correction,
        order: Some(ratio.log2()),
        error_bar: (SAFETY * correction.abs().max(cautious)).max(rounding),
    })
}

/// Observed order of errors on meshes halved from one to the next: the mean slope over the last two halvings,
/// ½ log₂(e(4h)/e(h)). `None` with fewer than three meshes or an error that is not positive and finite.
pub fn observed_order(errors: &[f64]) -> Option<f64> {
    let [.., coarse, middle, fine] = *errors else {
        return None;
    };
    [coarse, middle, fine]
        .iter()
        .all(|e| e.is_finite() && *e > 0.0)
        .then(|| 0.5 * (coarse / fine).log2())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: definition. Goal: a pure power is extrapolated to rounding, whatever its order and sign, and the bar holds
    /// the distance of the last value from the limit.
    #[test]
    fn a_pure_power_gives_its_limit_and_order() {
        for order in [0.5, 1.0, 1.7, 2.0] {
            for constant in [0.3, -2.0] {
                let at = |h: f64| 5.0 + constant * h.powf(order);
                let found = richardson([at(0.4), at(0.2), at(0.1)]).unwrap();
                assert!((found.value - 5.0).abs() < 1e-12, "{found:?}");
                assert!((found.order.unwrap() - order).abs() < 1e-10, "{found:?}");
                let left = (at(0.1) - 5.0).abs();
                assert!(
                    found.error_bar > left && found.error_bar < 1.3 * left,
                    "{found:?}"
                );
            }
        }
    }

    /// Source: two-term expansion. Goal: with a second term the limit stays within the bar, and is closer than the last
    /// value; an order above 2 does not shrink the bar below that of order 2.
    #[test]
    fn the_bar_holds_the_limit_of_a_sequence_with_two_terms() {
        for (first, second) in [(1.0, 0.5), (1.0, -0.3), (-0.2, -0.4)] {
            let at = |h: f64| 3.0 + first * h + second * h * h;
            let found = richardson([at(0.2), at(0.1), at(0.05)]).unwrap();
            assert!((found.value - 3.0).abs() < found.error_bar, "{found:?}");
            assert!((found.value - 3.0).abs() < 0.5 * (at(0.05) - 3.0).abs());
        }
        let at = |h: f64| 3.0 + h.powi(6);
        let found = richardson([at(0.4), at(0.2), at(0.1)]).unwrap();
        let last = (at(0.1) - at(0.2)).abs();
        assert!((found.order.unwrap() - 6.0).abs() < 1e-8);
        assert!((found.error_bar - 1.25 * last / 3.0).abs() < 1e-12);
    }

    /// Source: definition. Goal: no limit without shrinking differences, a wide bar without a sign, rounding as the bar of
    /// a sequence that has arrived.
    #[test]
    fn sequences_without_an_order_say_so() {
        assert_eq!(richardson([1.0, 2.0, 3.0]), None);
        assert_eq!(richardson([1.0, 2.0, 0.5]), None);
        assert_eq!(richardson([1.0, f64::NAN, 0.5]), None);
        assert_eq!(richardson([1.0, 1.0, 2.0]), None);
        let wave = richardson([1.0, 2.0, 1.6]).unwrap();
        assert_eq!((wave.value, wave.order, wave.error_bar), (1.6, None, 1.0));
        let arrived = richardson([7.0; 3]).unwrap();
        assert_eq!((arrived.value, arrived.order), (7.0, None));
        assert!(arrived.error_bar > 0.0 && arrived.error_bar < 1e-13);
        assert_eq!(richardson([0.0; 3]).map(|e| e.error_bar), Some(0.0));
    }

    /// Source: definition.
    #[test]
    fn observed_order_is_the_slope_of_the_last_two_halvings() {
        let errors: Vec<f64> = (0..5).map(|i| 3.0 * 0.5f64.powi(i).powf(1.5)).collect();
        assert!((observed_order(&errors).unwrap() - 1.5).abs() < 1e-12);
        // A bad coarse mesh is outside of the window.
        assert!((observed_order(&[100.0, 4.0, 2.0, 1.0]).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(observed_order(&[1.0, 0.5]), None);
        assert_eq!(observed_order(&[1.0, 0.5, 0.0]), None);
        assert_eq!(observed_order(&[1.0, f64::INFINITY, 0.1]), None);
    }
}
