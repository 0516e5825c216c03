//! Median, minimum and a 95 % interval of repeated times.
//!
//! ```text
//! t₁ ≤ … ≤ t_n        times, independent and from one distribution with median m
//! #{t_i < m} ~ Binomial(n, ½)
//! [t_k, t_(n+1−k)]    holds m with probability 1 − 2 P(Binomial(n, ½) < k) ≥ 0.95 for the largest such k
//! ```
//!
//! No normal distribution is assumed: times have a lower bound and a long tail. Fewer than six times say nothing at 95 %.
//!
//! Source: W. J. Conover, Practical Nonparametric Statistics (1999), confidence interval for a quantile.

/// Probability that the interval misses the median, both sides together.
const MISSED: f64 = 0.05;

/// What repeated times say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Median; the mean of the two middle ones of an even number; NaN of none.
    pub median: f64,
    /// Least; NaN of none.
    pub min: f64,
    /// Lower end of the 95 % interval of the median; NaN of fewer than six.
    pub low: f64,
    /// Upper end; NaN of fewer than six.
    pub high: f64,
    /// How many.
    pub samples: usize,
}

impl Timing {
    /// Of times in any order, all in one unit, none NaN.
    pub fn of(samples: &[f64]) -> Self {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let (Some(&min), rank) = (sorted.first(), rank(n)) else {
            return Self {
                median: f64::NAN,
                min: f64::NAN,
                low: f64::NAN,
                high: f64::NAN,
                samples: 0,
            };
        };
        let (low, high) = match rank {
            0 => (f64::NAN, f64::NAN),
            k => (sorted[k - 1], sorted[n - k]),
        };
        Self {
            median: 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
            min,
            low,
            high,
            samples: n,
        }
    }
}

/// The largest k with 2 P(Binomial(n, ½) < k) ≤ 0.05; 0 if there is none.
fn rank(n: usize) -> usize {
    // ln of the binomial probability of k: the probability itself underflows beyond a thousand samples.
    let mut ln_term = -(n as f64) * std::f64::consts::LN_2;
    let mut below = 0.0;
    for k in 0..n {
        below += ln_term.exp();
        if 2.0 * below > MISSED {
            return k;
        }
        ln_term += ((n - k) as f64 / (k + 1) as f64).ln();
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the ranks of the textbook tables for the median at 95 %, 0 where no interval exists.
    #[test]
    fn ranks_are_those_of_the_binomial_tables() {
        let expected = [
            (0, 0),
            (5, 0),
            (6, 1),
            (8, 1),
            (9, 2),
            (10, 2),
            (12, 3),
            (15, 4),
            (20, 6),
            (25, 8),
            (50, 18),
            (100, 40),
        ];
        for (n, k) in expected {
            assert_eq!(rank(n), k, "{n} samples");
        }
    }

    /// Goal: thousands of samples do not underflow. Expected: exact whole-number arithmetic.
    #[test]
    fn ranks_of_large_samples_are_exact() {
        assert_eq!((rank(1000), rank(10_000)), (469, 4902));
    }

    #[test]
    fn ten_samples_leave_out_one_at_either_end() {
        let t = Timing::of(&[9.0, 1.0, 4.0, 2.0, 10.0, 3.0, 8.0, 7.0, 5.0, 6.0]);
        let expected = Timing {
            median: 5.5,
            min: 1.0,
            low: 2.0,
            high: 9.0,
            samples: 10,
        };
        assert_eq!(t, expected);
    }

    #[test]
    fn few_samples_have_a_median_but_no_interval() {
        let t = Timing::of(&[3.0, 1.0, 2.0]);
        assert_eq!((t.median, t.min, t.samples), (2.0, 1.0, 3));
        assert!(t.low.is_nan() && t.high.is_nan());
        let none = Timing::of(&[]);
        assert!(none.median.is_nan() && none.min.is_nan());
        assert_eq!(none.samples, 0);
    }
}
