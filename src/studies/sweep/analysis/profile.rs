//! Performance and data profiles: how much of a test set a method solves within a multiple of the best, or within a budget.
//!
//! ```text
//!   r_{p,s} = t_{p,s} / min_s t_{p,s}        ρ_s(τ) = |{p: r_{p,s} ≤ τ}| / |P|       performance profile
//!                                            d_s(α) = |{p: t_{p,s}/n_p ≤ α}| / |P|   data profile
//! ```
//!
//! t is infinite where a method has no right answer; a problem that none solves stays in |P|. ρ_s(1) is the fraction of
//! problems on which s is best or equal to the best, its limit the fraction it solves at all. Medians enter: two methods
//! whose intervals overlap still have different ratios, so differences below the width of the intervals mean nothing.
//! Profiles of more than two methods do not order them, see [`pairwise`](super::pairwise).
//!
//! References: E. D. Dolan, J. J. Moré, Math. Program. 91 (2002) 201; J. J. Moré, S. M. Wild, SIAM J. Optim. 20 (2009) 172.

use super::costs::{Cost, Costs, Measure};
use crate::studies::sweep::record::Record;

/// Fraction of the problems against a bound, for one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<'a> {
    /// Method.
    pub method: &'a str,
    /// Bound and fraction where the fraction jumps up, increasing; performance profiles begin at 1.
    pub steps: Vec<[f64; 2]>,
}

/// Performance profile of every method; none without problems.
pub fn performance<'a>(costs: &Costs<'a>) -> Vec<Curve<'a>> {
    let best = |row: &[Option<Cost>]| {
        let values = row.iter().flatten().map(|cost| cost.value);
        values.fold(f64::INFINITY, f64::min)
    };
    let ratio = |_: &[&Record], row: &[Option<Cost>], cost: &Cost| cost.value / best(row);
    curves(costs, ratio, Some(1.0))
}

/// What a budget is counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Budget {
    /// Evaluations of the contact law per contact point: passes over the contact.
    Passes,
    /// Time of the method in factorisations of K on the same mesh.
    Factorisations,
}

impl Budget {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Budget::Passes => "passes",
            Budget::Factorisations => "factorisations",
        }
    }

    /// The cost that is counted.
    pub fn measure(self) -> Measure {
        match self {
            Budget::Passes => Measure::LocalSolves,
            Budget::Factorisations => Measure::Time,
        }
    }

    /// A cost in units of the budget; infinite where the unit is unknown.
    fn spent(self, records: &[&Record], cost: &Cost) -> f64 {
        let unit = match self {
            Budget::Passes => {
                let mut sizes = records.iter().filter_map(|r| r.found.problem.as_ref());
                sizes.next().map(|p| p.points as f64)
            }
            // One unit for all methods: the least of the bodies that were made for the problem.
            Budget::Factorisations => {
                let times = records.iter().filter_map(|r| super::published_times(r));
                times.map(|spent| spent.factorisation_s).reduce(f64::min)
            }
        };
        let unit = unit.filter(|unit| *unit > 0.0);
        unit.map_or(f64::INFINITY, |unit| cost.value / unit)
    }
}

/// Data profile of every method; `costs` are those of [`Budget::measure`].
pub fn data<'a>(costs: &Costs<'a>, budget: Budget) -> Vec<Curve<'a>> {
    curves(costs, |records, _, cost| budget.spent(records, cost), None)
}

/// Distribution of a number over the problems, for every method.
fn curves<'a>(
    costs: &Costs<'a>,
    of: impl Fn(&[&Record], &[Option<Cost>], &Cost) -> f64,
    from: Option<f64>,
) -> Vec<Curve<'a>> {
    let count = costs.problems();
    if count == 0 {
        return Vec::new();
    }
    let curve = |(index, method): (usize, &&'a str)| {
        let rows = costs.costs.iter().zip(&costs.records);
        let mut values: Vec<f64> = rows
            .filter_map(|(row, records)| Some(of(records, row, &row[index]?)))
            .filter(|value| value.is_finite())
            .collect();
        values.sort_by(f64::total_cmp);
        let mut steps: Vec<[f64; 2]> = from.map(|from| [from, 0.0]).into_iter().collect();
        for (done, value) in values.iter().enumerate() {
            let fraction = (done + 1) as f64 / count as f64;
            match steps.last_mut() {
                Some(last) if last[0] == *value => last[1] = fraction,
                _ => steps.push([*value, fraction]),
            }
        }
        Curve { method, steps }
    };
    costs.methods.iter().enumerate().map(curve).collect()
}

#[cfg(test)]
mod tests {
    use stickslip_methods::Tier;

    use super::super::support::{lying, of_case, record, timed};
    use super::super::test_set::TestSet;
    use super::*;

    /// Four problems: b-newton 1, 4, 2 s and no answer; latin 2, 2, 2 s and no answer.
    fn records() -> Vec<Record> {
        let times = [[1.0, 2.0], [4.0, 2.0], [2.0, 2.0]];
        let mut records = Vec::new();
        for (case, times) in ["a", "b", "c"].into_iter().zip(times) {
            for (method, time) in ["b-newton", "latin"].into_iter().zip(times) {
                records.push(timed(record(case, method, 1e-6), time));
            }
        }
        for method in ["b-newton", "latin"] {
            let mut failed = of_case(lying("gave-up: stalled"), "d");
            failed.cell.method = method.into();
            records.push(failed);
        }
        records
    }

    /// Source: hand calculation. Ratios: b-newton 1, 2, 1, ∞ and latin 2, 1, 1, ∞.
    #[test]
    fn a_performance_profile_is_the_distribution_of_ratios_to_the_best() {
        let records = records();
        let set = TestSet::new(&records, Tier::Mid);
        let costs = Costs::new(&set, Measure::Time);
        assert_eq!((costs.problems(), costs.unsolved()), (4, 1));
        for curve in performance(&costs) {
            assert_eq!(curve.steps, [[1.0, 0.5], [2.0, 0.75]], "{}", curve.method);
        }
    }

    #[test]
    fn a_method_that_is_never_best_starts_at_zero() {
        let records: Vec<Record> = [("b-newton", 1.0), ("latin", 3.0)]
            .map(|(method, t)| timed(record("a", method, 1e-6), t))
            .into();
        let set = TestSet::new(&records, Tier::Mid);
        let curves = performance(&Costs::new(&set, Measure::Time));
        assert_eq!(curves[0].steps, [[1.0, 1.0]]);
        let [start, end] = [curves[1].steps[0], curves[1].steps[1]];
        assert_eq!(start, [1.0, 0.0]);
        assert!((end[0] - 3.0).abs() < 1e-12 && end[1] == 1.0);
    }

    /// Source: the numbers of `record` and `timed`: 1 + 110 evaluations on 11 points; 0.1 s for a factorisation of K.
    #[test]
    fn budgets_are_passes_over_the_contact_and_factorisations() {
        let records = records();
        let set = TestSet::new(&records, Tier::Mid);
        let passes = data(&Costs::new(&set, Measure::LocalSolves), Budget::Passes);
        assert_eq!(passes[0].steps, [[111.0 / 11.0, 0.75]]);
        let times = data(&Costs::new(&set, Measure::Time), Budget::Factorisations);
        let steps: Vec<[f64; 2]> = times[0]
            .steps
            .iter()
            .map(|[x, y]| [x.round(), *y])
            .collect();
        assert_eq!(steps, [[10.0, 0.25], [20.0, 0.5], [40.0, 0.75]]);
    }
}
