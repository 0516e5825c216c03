//! Statistics of repeated times.
//!
//! The median and its distribution-free 95 % interval: with n independent samples sorted, the median of the distribution
//! lies between the k-th smallest and the k-th largest with probability 1 − 2 P(X < k), X ~ Binomial(n, ½). k is the
//! largest for which that is at least 0.95. Below six samples there is none; then the interval is the range, and covers
//! less (1 − 2^(1−n)).
//!
//! Reference: J. D. Gibbons, S. Chakraborti, *Nonparametric Statistical Inference*, 5th ed., CRC Press 2011, section 5.2.

use serde::{Deserialize, Serialize};

/// Probability that an interval covers the median, at least, from six samples on.
pub const COVERAGE: f64 = 0.95;

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

    /// Whether the intervals of two timings have a point in common: then neither is faster.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.low_s <= other.high_s && other.low_s <= self.high_s
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

    #[test]
    fn touching_intervals_overlap() {
        let timing = |low, high| Timing {
            median_s: low,
            min_s: low,
            low_s: low,
            high_s: high,
            samples: 9,
        };
        assert!(timing(1.0, 2.0).overlaps(&timing(2.0, 3.0)));
        assert!(timing(1.0, 4.0).overlaps(&timing(2.0, 3.0)));
        assert!(!timing(1.0, 2.0).overlaps(&timing(2.1, 3.0)));
    }
}
