//! Rates and how sure they are.

/// Two-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// Rate of `hits` among `count` and Wilson's 95 % interval (J. Am. Stat. Assoc. 22 (1927) 209); NaN if nothing was tried.
pub fn wilson(hits: usize, count: usize) -> [f64; 3] {
    if count == 0 {
        return [f64::NAN; 3];
    }
    let (n, p) = (count as f64, hits as f64 / count as f64);
    let centre = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + (Z / (2.0 * n)).powi(2)).sqrt();
    // Rounding may leave the ends just outside of what a rate can be.
    [
        p,
        (centre - half).clamp(0.0, p),
        (centre + half).clamp(p, 1.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: Newcombe, Stat. Med. 17 (1998) 857, Table I, method 3 (Wilson without continuity correction).
    #[test]
    fn intervals_agree_with_newcombe() {
        for (hits, count, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let [rate, found_low, found_high] = wilson(hits, count);
            assert_eq!(rate, hits as f64 / count as f64);
            assert!((found_low - low).abs() < 5e-5 && (found_high - high).abs() < 5e-5);
        }
        assert!(wilson(0, 0).iter().all(|x| x.is_nan()));
    }
}
