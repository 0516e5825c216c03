//! Limit of a sequence of values for vanishing cell size, and the order in which it is approached.
//!
//! ```text
//!   v(h) ≈ v₀ + C h^p      (v₁ − v₂)/(v₂ − v₃) = (h₁^p − h₂^p)/(h₂^p − h₃^p)   gives p
//!                          v₀ = v₃ − (v₂ − v₃) h₃^p/(h₂^p − h₃^p)
//! ```
//!
//! The error bar is 1.25 |v₀ − v₃| with an order of at most 2.
//!
//! Sources: Richardson, Phil. Trans. R. Soc. A 210 (1911) 307; safety factor 1.25: Roache, Annu. Rev. Fluid Mech. 29 (1997)
//! 123.

/// Observed orders outside are no power law.
const ORDERS: [f64; 2] = [0.1, 10.0];
/// Safety factor of Roache's error bar for three meshes.
const SAFETY: f64 = 1.25;

/// Highest order that an error bar relies on: bilinear cells give displacements and energies to h². What seems to converge
/// faster rather hides a change of sign of the error.
const HIGHEST: f64 = 2.0;

/// Limit of a sequence for vanishing cell size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Extrapolated value.
    pub value: f64,
    /// Observed order.
    pub order: f64,
    /// Uncertainty of the value.
    pub error_bar: f64,
}

/// Richardson extrapolation from the three finest meshes, (h, value) from coarse to fine; none where the values do not
/// approach a limit like a power of h.
pub fn limit(points: &[[f64; 2]; 3]) -> Option<Limit> {
    let [[h1, v1], [h2, v2], [h3, v3]] = *points;
    let (first, last) = (v1 - v2, v2 - v3);
    if !(h1 > h2 && h2 > h3 && h3 > 0.0) {
        return None;
    }
    // Rises with p.
    let ratio = |p: f64| (h1.powf(p) - h2.powf(p)) / (h2.powf(p) - h3.powf(p));
    let wanted = first / last;
    let [mut low, mut high] = ORDERS;
    if !(ratio(low) <= wanted && wanted <= ratio(high)) {
        return None;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if ratio(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    let order = 0.5 * (low + high);
    let step = |p: f64| last * h3.powf(p) / (h2.powf(p) - h3.powf(p));
    Some(Limit {
        value: v3 - step(order),
        order,
        error_bar: SAFETY * step(order.min(HIGHEST)).abs(),
    })
}

/// Limit of v(h) = v₀ + C h through two meshes, (h, value), the finer one last: where theory says order 1.
pub fn linear_limit([[h1, v1], [h2, v2]]: [[f64; 2]; 2]) -> f64 {
    let slope = (v1 - v2) / (h1 - h2);
    v2 - slope * h2
}

/// Slope of ln e over ln h by least squares; NaN where a value is not positive or there are fewer than two.
pub fn slope(points: &[[f64; 2]]) -> f64 {
    if points.len() < 2
        || points
            .iter()
            .flatten()
            .any(|x| !(*x > 0.0 && x.is_finite()))
    {
        return f64::NAN;
    }
    let count = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k].ln()).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
    sum(&|p| (p[0].ln() - x) * (p[1].ln() - y)) / sum(&|p| (p[0].ln() - x).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the definition of a power law. Goal: value, order and error bar of exact power laws, on unequal ratios too.
    #[test]
    fn power_laws_are_extrapolated_to_their_limit() {
        for (c, p) in [(1.0, 0.5), (-2.0, 1.0), (0.3, 2.0), (5.0, 1.37)] {
            for hs in [[1.0, 0.5, 0.25], [1.0, 0.4, 0.3], [7e-3, 6e-3, 1e-3]] {
                let points = hs.map(|h: f64| [h, 3.0 + c * h.powf(p)]);
                let found = limit(&points).expect("a power law");
                let bar = SAFETY * c.abs() * hs[2].powf(p);
                assert!((found.order - p).abs() < 1e-7, "{c} {p}: {found:?}");
                assert!((found.value - 3.0).abs() < 1e-7 * bar, "{c} {p}: {found:?}");
                assert!(
                    (found.error_bar - bar).abs() < 1e-6 * bar,
                    "{c} {p}: {found:?}"
                );
            }
        }
    }

    /// Source: two-term expansion. Goal: the limit lies within the bar and closer than the last value; an order above 2 does
    /// not shrink the bar below that of order 2.
    #[test]
    fn the_bar_holds_the_limit_of_a_sequence_with_two_terms() {
        for (first, second) in [(1.0, 0.5), (1.0, -0.3), (-0.2, -0.4)] {
            let points = [0.2, 0.1, 0.05].map(|h| [h, 3.0 + first * h + second * h * h]);
            let found = limit(&points).expect("close to a power law");
            let off = (found.value - 3.0).abs();
            assert!(off < found.error_bar, "{found:?}");
            assert!(off < 0.5 * (points[2][1] - 3.0).abs(), "{found:?}");
        }
        let points = [0.4, 0.2, 0.1].map(|h: f64| [h, 3.0 + h.powi(6)]);
        let found = limit(&points).expect("a power law");
        let last = (points[2][1] - points[1][1]).abs();
        assert!((found.order - 6.0).abs() < 1e-7, "{found:?}");
        assert!(
            (found.error_bar - SAFETY * last / 3.0).abs() < 1e-12,
            "{found:?}"
        );
    }

    #[test]
    fn what_is_no_power_law_has_no_limit() {
        for values in [
            [1.0, 2.0, 1.5],        // to and fro
            [1.0, 2.0, 4.0],        // growing steps
            [1.0, 2.0, 3.0],        // steady steps: order 0
            [1.0, 2.0, 2.0],        // no last step
            [1.0, 1.0, 2.0],        // no first step
            [1.0, 2.0, f64::NAN],   // no value
            [1.0, 2.0, 2.0 + 1e-9], // order 30
        ] {
            let [a, b, c] = values;
            assert_eq!(limit(&[[1.0, a], [0.5, b], [0.25, c]]), None, "{values:?}");
        }
        assert_eq!(
            limit(&[[0.25, 1.0], [0.5, 2.0], [1.0, 2.5]]),
            None,
            "fine to coarse"
        );
    }

    #[test]
    fn slopes_are_those_of_logarithms() {
        let points: Vec<[f64; 2]> = [4.0, 1.0, 0.1]
            .map(|h: f64| [h, 7.0 * h.powf(1.5)])
            .to_vec();
        assert!((slope(&points) - 1.5).abs() < 1e-12);
        // Least squares: a symmetric kink leaves the slope alone.
        assert!((slope(&[[1.0, 1.0], [2.0, 4.0], [4.0, 4.0]]) - 1.0).abs() < 1e-12);
        for bad in [
            &[[1.0, 1.0]][..],
            &[[1.0, 0.0], [2.0, 1.0]],
            &[[1.0, f64::NAN], [2.0, 1.0]],
        ] {
            assert!(slope(bad).is_nan(), "{bad:?}");
        }
    }
}
