//! Problems and methods of a comparison: every method, with default options, on the same problems at the same accuracy.
//!
//! Dolan & Moré's test set P and solver set S. A problem that some method was not given is left out, or its absence would
//! count as a failure.

use std::collections::BTreeMap;

use stickslip_methods::Tier;

use super::{compare_methods, compare_problems, has_defaults, problems};
use crate::studies::record::Record;
use crate::studies::task::{Asked, Problem};

/// Records of all methods on the problems that all of them were given, asked for one tier.
#[derive(Debug, Clone)]
pub struct TestSet<'a> {
    /// Accuracy asked for.
    pub tier: Tier,
    /// Methods in the order of the registry.
    pub methods: Vec<&'a str>,
    /// Problems in order.
    pub problems: Vec<Problem>,
    /// A record per problem and method.
    pub records: Vec<Vec<&'a Record>>,
    /// Problems that not every method was given.
    pub left_out: usize,
}

impl<'a> TestSet<'a> {
    /// The test set of a tier.
    pub fn new(records: &'a [Record], tier: Tier) -> Self {
        let wanted = |r: &&Record| has_defaults(&r.asked) && r.asked.tolerance == tier.tolerance();
        let own: Vec<&Record> = records.iter().filter(wanted).collect();
        let mut methods: Vec<&str> = own.iter().map(|r| r.found.method.as_str()).collect();
        methods.sort_by(|a, b| compare_methods(a, b));
        methods.dedup();
        let all = problems(records);
        let place = |own: &Asked| all.binary_search_by(|p| compare_problems(p, own));
        let mut by_place: BTreeMap<(usize, &str), &Record> = BTreeMap::new();
        for record in own {
            if let Ok(place) = place(&record.asked) {
                let key = (place, record.found.method.as_str());
                by_place.entry(key).or_insert(record);
            }
        }
        let mut set = Self {
            tier,
            methods,
            problems: Vec::new(),
            records: Vec::new(),
            left_out: 0,
        };
        for (place, problem) in all.iter().enumerate() {
            let row = |method: &&str| by_place.get(&(place, *method)).copied();
            let row: Vec<Option<&Record>> = set.methods.iter().map(row).collect();
            if row.iter().all(Option::is_none) {
                continue;
            }
            match row.into_iter().collect::<Option<Vec<&Record>>>() {
                Some(row) => {
                    set.problems.push(problem.clone());
                    set.records.push(row);
                }
                None => set.left_out += 1,
            }
        }
        set
    }
}

#[cfg(test)]
mod tests {
    use super::super::support::record;
    use super::*;

    #[test]
    fn methods_meet_on_the_problems_that_all_were_given() {
        let records = vec![
            record("b", "latin", 1e-6),
            record("a", "latin", 1e-6),
            record("a", "b-newton", 1e-6),
            record("a", "b-newton", 1e-3),
            record("a", "penalty:normal=1e2", 1e-6),
        ];
        let set = TestSet::new(&records, Tier::Mid);
        assert_eq!(set.methods, ["b-newton", "latin"]);
        let cases: Vec<&str> = set.problems.iter().map(|p| p.case.as_str()).collect();
        assert_eq!((cases, set.left_out), (vec!["a"], 1));
        assert_eq!(set.records[0][1].asked.method, "latin");
        assert!(TestSet::new(&records, Tier::High).methods.is_empty());
    }
}
