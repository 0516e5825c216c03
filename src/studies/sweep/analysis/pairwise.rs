//! Methods two by two: who is cheaper beyond the intervals, on how many problems.
//!
//! A performance profile measures every method against the best of the whole set, so the order of two methods in it depends
//! on who else is there; profiles of two methods alone do not.
//!
//! Reference: N. Gould, J. Scott, ACM Trans. Math. Softw. 43 (2016) 15.

use super::costs::Costs;
use super::profile::{Curve, performance};

/// One method against another.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair<'a> {
    /// The method.
    pub method: &'a str,
    /// Whom it is compared with.
    pub other: &'a str,
    /// Problems; the four that follow add up to it.
    pub problems: usize,
    /// The method alone is right, or both are and it is cheaper beyond the intervals.
    pub wins: usize,
    /// Both are right and the intervals overlap.
    pub ties: usize,
    /// Wins of the other.
    pub losses: usize,
    /// Neither is right.
    pub neither: usize,
}

/// Every method against every other.
pub fn pairs<'a>(costs: &Costs<'a>) -> Vec<Pair<'a>> {
    let count = costs.methods.len();
    let all = (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
    all.filter(|(a, b)| a != b)
        .map(|(a, b)| pair(costs, a, b))
        .collect()
}

fn pair<'a>(costs: &Costs<'a>, a: usize, b: usize) -> Pair<'a> {
    let mut pair = Pair {
        method: costs.methods[a],
        other: costs.methods[b],
        problems: costs.problems(),
        wins: 0,
        ties: 0,
        losses: 0,
        neither: 0,
    };
    for row in &costs.costs {
        let outcome = match (row[a], row[b]) {
            (None, None) => &mut pair.neither,
            (Some(_), None) => &mut pair.wins,
            (None, Some(_)) => &mut pair.losses,
            (Some(own), Some(other)) if own.is_below(&other) => &mut pair.wins,
            (Some(own), Some(other)) if other.is_below(&own) => &mut pair.losses,
            (Some(_), Some(_)) => &mut pair.ties,
        };
        *outcome += 1;
    }
    pair
}

/// Profiles of two methods alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Duel<'a> {
    /// The first is the same in all duels of a list.
    pub first: Curve<'a>,
    /// The other.
    pub second: Curve<'a>,
}

/// The method with this index against every other.
pub fn duels<'a>(costs: &Costs<'a>, first: usize) -> Vec<Duel<'a>> {
    let others = (0..costs.methods.len()).filter(|other| *other != first);
    let duel = |other: usize| {
        let mut curves = performance(&costs.of_methods(&[first, other])).into_iter();
        Some(Duel {
            first: curves.next()?,
            second: curves.next()?,
        })
    };
    others.filter_map(duel).collect()
}

#[cfg(test)]
mod tests {
    use stickslip_methods::Tier;

    use super::super::costs::Measure;
    use super::super::support::{lying, of_case, record, timed};
    use super::super::test_set::TestSet;
    use super::*;
    use crate::studies::sweep::record::Record;

    /// latin against b-newton: faster, as fast, slower, alone right, neither right.
    fn records() -> Vec<Record> {
        let pairs = [("a", 1.0, 2.0), ("b", 1.0, 1.1), ("c", 2.0, 1.0)];
        let mut records: Vec<Record> = pairs
            .iter()
            .flat_map(|(case, latin, newton)| {
                [("latin", *latin), ("b-newton", *newton)]
                    .map(|(method, t)| timed(record(case, method, 1e-6), t))
            })
            .collect();
        let failed = |case: &str, method: &str| {
            let mut failed = of_case(lying("false-claim"), case);
            failed.cell.method = method.into();
            failed
        };
        records.push(timed(record("d", "latin", 1e-6), 1.0));
        records.push(failed("d", "b-newton"));
        records.push(failed("e", "latin"));
        records.push(failed("e", "b-newton"));
        records
    }

    #[test]
    fn overlapping_intervals_are_ties() {
        let records = records();
        let set = TestSet::new(&records, Tier::Mid);
        let costs = Costs::new(&set, Measure::Time);
        let pairs = pairs(&costs);
        let of = |method: &str| {
            let pair = pairs.iter().find(|p| p.method == method).unwrap();
            [
                pair.problems,
                pair.wins,
                pair.ties,
                pair.losses,
                pair.neither,
            ]
        };
        assert_eq!(of("latin"), [5, 2, 1, 1, 1]);
        assert_eq!(of("b-newton"), [5, 1, 1, 2, 1]);
    }

    /// Goal: the profile of two does not depend on the others. A third method, ten times as fast, moves the joint profile.
    #[test]
    fn a_duel_does_not_know_the_other_methods() {
        let mut records = records();
        let steps = |records: &[Record]| {
            let set = TestSet::new(records, Tier::Mid);
            let costs = Costs::new(&set, Measure::Time);
            let newton = costs.methods.iter().position(|m| *m == "b-newton").unwrap();
            let duels = duels(&costs, newton);
            let duel = duels.iter().find(|d| d.second.method == "latin").unwrap();
            let joint = performance(&costs)[newton].steps.clone();
            (duel.first.steps.clone(), duel.second.steps.clone(), joint)
        };
        let before = steps(&records);
        // b-newton: ratios 2, 1.1, 1 of five problems.
        let rounded: Vec<[i64; 2]> = before
            .0
            .iter()
            .map(|s| s.map(|x| (10.0 * x).round() as i64))
            .collect();
        assert_eq!(rounded, [[10, 2], [11, 4], [20, 6]]);
        for case in ["a", "b", "c", "d", "e"] {
            records.push(timed(record(case, "pdas", 1e-6), 0.1));
        }
        let after = steps(&records);
        assert_eq!((&before.0, &before.1), (&after.0, &after.1));
        assert_ne!(before.2, after.2);
    }
}
