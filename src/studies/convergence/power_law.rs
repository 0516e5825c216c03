//! Powers of the cell size by which errors and values of a sequence of meshes change.

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

/// Order p of v(h) ≈ v₀ + C h^p by three meshes, (h, value) from coarse to fine: their divided differences fall like h^(p−1).
/// NaN where the values do not approach a limit.
pub fn order_of_steps([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let step = |[h1, v1]: [f64; 2], [h2, v2]: [f64; 2]| [(h1 * h2).sqrt(), (v1 - v2) / (h1 - h2)];
    let ([first, v], [last, w]) = (step(a, b), step(b, c));
    let sign = v.signum();
    let order = 1.0 + slope(&[[first, sign * v], [last, sign * w]]);
    if order > 0.0 { order } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the definition of a power law. Goal: its order from meshes of one ratio; none of what goes to and fro or away.
    #[test]
    fn the_order_of_a_power_law_is_that_of_its_steps() {
        for (c, p) in [(1.0, 0.5), (-2.0, 1.0), (0.3, 2.0), (5.0, 1.37)] {
            for ratio in [0.5, 0.3] {
                let points = [1.0, ratio, ratio * ratio].map(|h: f64| [h, 3.0 + c * h.powf(p)]);
                let found = order_of_steps(points);
                assert!((found - p).abs() < 1e-9, "{c} {p} {ratio}: {found}");
            }
        }
        for values in [
            [1.0, 2.0, 1.5],
            [1.0, 2.0, 2.0],
            [1.0, 2.0, 4.0],
            [1.0, 2.0, f64::NAN],
        ] {
            let [a, b, c] = values;
            assert!(order_of_steps([[1.0, a], [0.5, b], [0.25, c]]).is_nan());
        }
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
