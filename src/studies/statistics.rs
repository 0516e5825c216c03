//! Statistics of repeated times and of rates.
//!
//! Times: the median and its distribution-free 95 % interval: with n independent samples sorted, the median of the distribution
//! lies between the k-th smallest and the k-th largest with probability 1 − 2 P(X < k), X ~ Binomial(n, ½). k is the
//! largest for which that is at least 0.95. Below six samples there is none; then the interval is the range, and covers
//! less (1 − 2^(1−n)).
//!
//! Reference: J. D. Gibbons, S. Chakraborti, *Nonparametric Statistical Inference*, 5th ed., CRC Press 2011, section 5.2.

use serde::{Deserialize, Serialize};

/// Probability that an interval covers the median, at least, from six samples on.
pub const COVERAGE: f64 = 0.95;

/// Two-sided 95 % quantile of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// Summary of repeated times [s].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Median.
    pub median_s: f64,
    /// Smallest.
    pub min_s: f64,
    /// Lower end of the interval of the median.
    pub low_s: f64,
    /// Upper end of the interval of the median.
    pub high_s: f64,
    /// Number of samples.
    pub samples: usize,
}

impl Timing {
    /// Summary of some samples; none without any, or where one is not finite.
    pub fn of(samples: &[f64]) -> Option<Self> {
        if samples.iter().any(|s| !s.is_finite()) {
            return None;
        }
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let (first, last) = (*sorted.first()?, *sorted.last()?);
        let rank = interval_rank(n);
        Some(Self {
            median_s: median(sorted.iter().copied()),
            min_s: first,
            low_s: rank.map_or(first, |k| sorted[k - 1]),
            high_s: rank.map_or(last, |k| sorted[n - k]),
            samples: n,
        })
    }
}

/// The larger of two numbers; NaN if one is, which `max` would drop.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// Median of some numbers; NaN of none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => f64::NAN,
        _ if n % 2 == 1 => sorted[n / 2],
        _ => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// The smallest value that a fraction `q` of the values does not exceed; NaN of nothing.
pub fn quantile(q: f64, values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let rank = (q * sorted.len() as f64).ceil() as usize;
    let value = sorted.get(rank.saturating_sub(1));
    value.copied().unwrap_or(f64::NAN)
}

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

/// Largest k with 2 P(X < k) <= 1 − [`COVERAGE`], X ~ Binomial(n, ½); none below six samples.
fn interval_rank(n: usize) -> Option<usize> {
    // Terms of the distribution in logarithms: 2^-n leaves the range of numbers at n = 1075.
    let mut log_term = -(n as f64) * std::f64::consts::LN_2;
    let (mut below, mut rank) = (0.0, 0);
    for k in 0..n / 2 {
        below += log_term.exp();
        if 2.0 * below > 1.0 - COVERAGE {
            break;
        }
        rank = k + 1;
        log_term += ((n - k) as f64 / (k + 1) as f64).ln();
    }
    (rank > 0).then_some(rank)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the ranks of the published table: Gibbons & Chakraborti, Table G (sign test, α = 0.05 two-sided).
    #[test]
    fn the_interval_is_that_of_the_sign_test() {
        for (n, rank) in [
            (5, None),
            (6, Some(1)),
            (8, Some(1)),
            (9, Some(2)),
            (12, Some(3)),
            (15, Some(4)),
            (20, Some(6)),
            (25, Some(8)),
        ] {
            assert_eq!(interval_rank(n), rank, "{n}");
        }
        // For many samples n/2 − 1.96 √n/2, here 4902.
        let k = interval_rank(10_000).unwrap();
        assert!((4900..=4904).contains(&k), "{k}");
    }

    #[test]
    fn a_timing_is_read_off_the_sorted_samples() {
        let timing = Timing::of(&[9.0, 1.0, 4.0, 2.0, 8.0, 3.0, 7.0, 5.0, 6.0]).unwrap();
        let expected = Timing {
            median_s: 5.0,
            min_s: 1.0,
            low_s: 2.0,
            high_s: 8.0,
            samples: 9,
        };
        assert_eq!(timing, expected);
        let two = Timing::of(&[2.0, 1.0]).unwrap();
        assert_eq!((two.median_s, two.low_s, two.high_s), (1.5, 1.0, 2.0));
        assert_eq!(Timing::of(&[]), None);
        assert_eq!(Timing::of(&[1.0, f64::NAN]), None);
    }

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
