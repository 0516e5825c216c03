//! Order of the methods by shifted geometric mean, with ties.
//!
//! ```text
//!   M_s = exp( (1/|P|) Σ_p ln(t_{p,s} + δ) ) − δ
//! ```
//!
//! The shift δ keeps problems that every method solves at once from ruling the mean: it is the power of ten at or below the
//! median over the problems of the least right cost. A problem without right answer of the method enters with ten times the
//! largest right cost of any method on it (penalised average, PAR10); one that no method solves is left out, and so is a
//! method without any right answer. The ends of the interval are the means of the ends.
//!
//! A method has all ranks from 1 + (number of methods whose interval lies below its own) to (number of methods) − (number
//! whose interval lies above): methods whose intervals overlap always share a rank, none is put before the other.
//!
//! References: shifted geometric mean: T. Achterberg, *Constraint Integer Programming*, TU Berlin 2007, appendix A.3;
//! penalty: F. Hutter, H. Hoos, K. Leyton-Brown, T. Stützle, J. Artif. Intell. Res. 36 (2009) 267.

use super::costs::{Cost, Costs, least};
use crate::studies::statistics::median;

/// Factor on the largest right cost of a problem for those who have none.
pub const PENALTY: f64 = 10.0;

/// One method.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing<'a> {
    /// Method.
    pub method: &'a str,
    /// Problems with a right answer.
    pub correct: usize,
    /// Shifted geometric mean with its interval.
    pub mean: Cost,
    /// First and last rank it may have, from 1.
    pub rank: [usize; 2],
    /// Median relative width of its intervals; NaN without a right answer.
    pub width: f64,
}

/// All methods, by mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking<'a> {
    /// Shift δ.
    pub shift: f64,
    /// Problems in the means.
    pub problems: usize,
    /// Problems that no method solved.
    pub unsolved: usize,
    /// From the least mean on.
    pub standings: Vec<Standing<'a>>,
}

/// Ranks the methods; none where no problem has a right answer.
pub fn ranking<'a>(costs: &Costs<'a>) -> Option<Ranking<'a>> {
    let right = |row: &&Vec<Option<Cost>>| row.iter().any(Option::is_some);
    let rows: Vec<&Vec<Option<Cost>>> = costs.costs.iter().filter(right).collect();
    let shift = shift(&rows)?;
    let standing = |(index, method): (usize, &&'a str)| {
        let own = || rows.iter().filter_map(|row| row[index]);
        let entered: Vec<Cost> = rows.iter().map(|row| entered(row, index)).collect();
        let mean = |end: fn(&Cost) -> f64| shifted_mean(entered.iter().map(end), shift);
        Standing {
            method,
            correct: own().count(),
            mean: Cost {
                value: mean(|c| c.value),
                low: mean(|c| c.low),
                high: mean(|c| c.high),
            },
            rank: [1, 1],
            width: median(own().map(|cost| cost.relative_width())),
        }
    };
    let mut standings: Vec<Standing> = costs.methods.iter().enumerate().map(standing).collect();
    standings.retain(|standing| standing.correct > 0);
    let means: Vec<Cost> = standings.iter().map(|s| s.mean).collect();
    for standing in &mut standings {
        let below = means.iter().filter(|m| m.is_below(&standing.mean)).count();
        let above = means.iter().filter(|m| standing.mean.is_below(m)).count();
        standing.rank = [1 + below, means.len() - above];
    }
    // The sort is stable: equal means stay in the order of the registry.
    standings.sort_by(|a, b| a.mean.value.total_cmp(&b.mean.value));
    Some(Ranking {
        shift,
        problems: rows.len(),
        unsolved: costs.problems() - rows.len(),
        standings,
    })
}

/// Contribution of one method on one problem.
fn entered(row: &[Option<Cost>], index: usize) -> Cost {
    let right = row.iter().flatten().map(|cost| cost.value);
    let limit = || Cost::exactly(PENALTY * right.fold(0.0, f64::max));
    row[index].unwrap_or_else(limit)
}

fn shift(rows: &[&Vec<Option<Cost>>]) -> Option<f64> {
    let middle = median(rows.iter().map(|row| least(row)));
    (middle > 0.0).then(|| 10f64.powi(middle.log10().floor() as i32))
}

/// Shifted geometric mean.
pub fn shifted_mean(values: impl ExactSizeIterator<Item = f64>, shift: f64) -> f64 {
    let count = values.len() as f64;
    let logarithms: f64 = values.map(|value| (value + shift).ln()).sum();
    (logarithms / count).exp() - shift
}

#[cfg(test)]
mod tests {
    use super::super::support::{costs, failed, solved};
    use super::*;
    use crate::studies::record::Record;

    fn ranked(records: &[Record]) -> Vec<(String, f64, [usize; 2])> {
        let ranking = ranking(&costs(records)).unwrap();
        let line = |s: &Standing| (s.method.to_owned(), s.mean.value, s.rank);
        ranking.standings.iter().map(line).collect()
    }

    /// Source: hand calculation: (3 + 1)(15 + 1) = 8², less the shift of 1.
    #[test]
    fn the_mean_is_geometric_about_the_shift() {
        let found = shifted_mean([3.0, 15.0].into_iter(), 1.0);
        assert!((found - 7.0).abs() < 1e-12, "{found}");
        assert!((shifted_mean([4.0, 9.0].into_iter(), 0.0) - 6.0).abs() < 1e-12);
    }

    #[test]
    fn overlapping_intervals_are_not_ranked() {
        // ±10 %: the neighbours 1, 1.2, 1.4 overlap, the ends do not; 5 stands alone.
        let times = [
            ("b-newton", 1.0),
            ("pdas", 1.2),
            ("hybrid", 1.4),
            ("latin", 5.0),
        ];
        let ranked = ranked(&solved("a", &times));
        let ranks: Vec<[usize; 2]> = ranked.iter().map(|r| r.2).collect();
        assert_eq!(ranks, [[1, 2], [1, 3], [2, 3], [4, 4]]);
    }

    /// Source: hand calculation. Problem a: 1 s and 4 s; problem b: 2 s and no right answer, which enters as 20 s. Least
    /// costs 1 and 2, median 1.5, shift 1: (2·3)^½ − 1 and (5·21)^½ − 1.
    #[test]
    fn a_failure_costs_ten_times_the_slowest_right_answer() {
        let mut records = solved("a", &[("b-newton", 1.0), ("latin", 4.0)]);
        records.extend(solved("b", &[("b-newton", 2.0)]));
        records.push(failed("b", "latin"));
        let ranked = ranked(&records);
        assert_eq!(ranked[0].0, "b-newton");
        for (found, product) in ranked.iter().zip([6f64, 105.0]) {
            let mean = product.sqrt() - 1.0;
            assert!((found.1 - mean).abs() < 1e-12, "{ranked:?}");
        }
    }

    #[test]
    fn who_is_never_right_and_what_nobody_solves_is_not_ranked() {
        let mut records = solved("a", &[("b-newton", 1.0)]);
        records.push(failed("a", "latin"));
        let ranked = ranked(&records);
        assert_eq!(ranked.len(), 1);
        assert_eq!((ranked[0].0.as_str(), ranked[0].2), ("b-newton", [1, 1]));
        assert_eq!(ranking(&costs(&records[1..])), None);
    }
}
