//! Performance profiles: how much of a test set a method solves within a multiple of the least time.
//!
//! ```text
//!   r_{p,s} = t_{p,s} / min_s t_{p,s}        ρ_s(τ) = |{p: r_{p,s} ≤ τ}| / |P|
//! ```
//!
//! t is infinite where a method has no right answer; a problem that none solves stays in |P|. ρ_s(1) is the fraction of
//! problems on which s is best or equal to the best, its limit the fraction it solves at all. Medians enter: two methods
//! whose intervals overlap still have different ratios, so differences below the width of the intervals mean nothing.
//! Profiles of more than two methods do not order them: the best of a problem may be a third one (N. Gould, J. Scott, ACM
//! Trans. Math. Softw. 43 (2016) 15); [`ranking`](super::ranking) does.
//!
//! Reference: E. D. Dolan, J. J. Moré, Math. Program. 91 (2002) 201.

use super::costs::{Cost, Costs, least};

/// Fraction of the problems against a bound, for one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<'a> {
    /// Method.
    pub method: &'a str,
    /// Bound and fraction where the fraction jumps up, increasing, from bound 1 on.
    pub steps: Vec<[f64; 2]>,
}

/// Performance profile of every method; none without problems.
pub fn performance<'a>(costs: &Costs<'a>) -> Vec<Curve<'a>> {
    let count = costs.problems();
    if count == 0 {
        return Vec::new();
    }
    let curve = |(index, method): (usize, &&'a str)| {
        let ratio = |row: &Vec<Option<Cost>>| Some(row[index]?.value / least(row));
        let ratios = costs.costs.iter().filter_map(ratio);
        let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
        ratios.sort_by(f64::total_cmp);
        let mut steps = vec![[1.0, 0.0]];
        for (done, ratio) in ratios.iter().enumerate() {
            let fraction = (done + 1) as f64 / count as f64;
            match steps.last_mut() {
                Some(last) if last[0] == *ratio => last[1] = fraction,
                _ => steps.push([*ratio, fraction]),
            }
        }
        Curve { method, steps }
    };
    costs.methods.iter().enumerate().map(curve).collect()
}

#[cfg(test)]
mod tests {
    use super::super::support::{costs, failed, solved};
    use super::*;

    /// Source: hand calculation. Times 1 and 2, 4 and 2, 2 and 2 s, and no answer; ratios 1, 2, 1, ∞ and 2, 1, 1, ∞.
    #[test]
    fn a_performance_profile_is_the_distribution_of_ratios_to_the_best() {
        let mut records = Vec::new();
        for (case, newton, latin) in [("a", 1.0, 2.0), ("b", 4.0, 2.0), ("c", 2.0, 2.0)] {
            records.extend(solved(case, &[("b-newton", newton), ("latin", latin)]));
        }
        records.extend(["b-newton", "latin"].map(|method| failed("d", method)));
        let costs = costs(&records);
        assert_eq!((costs.problems(), costs.unsolved()), (4, 1));
        for curve in performance(&costs) {
            assert_eq!(curve.steps, [[1.0, 0.5], [2.0, 0.75]], "{}", curve.method);
        }
    }

    #[test]
    fn a_method_that_is_never_best_starts_at_zero() {
        let records = solved("a", &[("b-newton", 1.0), ("latin", 3.0)]);
        let curves = performance(&costs(&records));
        assert_eq!(curves[0].steps, [[1.0, 1.0]]);
        let [start, end] = [curves[1].steps[0], curves[1].steps[1]];
        assert_eq!(start, [1.0, 0.0]);
        assert!((end[0] - 3.0).abs() < 1e-12 && end[1] == 1.0);
    }
}
