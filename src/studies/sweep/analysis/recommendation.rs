//! Which method to use when, and how sure that is.
//!
//! Problems are sorted into classes by what a user knows beforehand: dimension, friction, one increment or a path, size. In a
//! class, only methods that are right as often as any other may be the fastest; of these, all are named that none is faster
//! than beyond the intervals of the [shifted geometric means](super::ranking), first the one that is among the fastest of all
//! methods on most problems (of equals in the order of the registry).
//!
//! Confidence comes from the problems on which no method at all is faster than the first beyond the intervals, k of n:
//! `sure` if Wilson's 95 % interval of k/n lies above ½, `likely` if k/n does and n is at least 3, `open` otherwise. Friction
//! coefficients and meshes of one case are no independent evidence: k and n are scaled down to as many votes as there are cases.

use std::collections::BTreeSet;

use stickslip_methods::Tier;

use super::costs::Costs;
use super::ranking::ranking;
use super::test_set::TestSet;
use super::{compare_methods, is_correct};
use crate::case::named;
use crate::studies::sweep::cell::Problem;
use crate::studies::sweep::record::Record;
use crate::studies::sweep::statistics::wilson;

/// Fewer problems say nothing.
const FEWEST: usize = 3;
/// A slip below this part of the displacements is none.
const STICKS: f64 = 1e-8;

named! {
    /// What friction does.
    pub enum Friction {
        /// All coefficients are zero.
        Frictionless = "frictionless",
        /// Something slips, or may do so.
        Slip = "slip",
        /// Nothing slips on the whole path.
        Stick = "stick",
    }
}

named! {
    /// How many contact unknowns.
    pub enum Size {
        /// Up to 100.
        Small = "up to 100",
        /// Up to 1000.
        Medium = "101 to 1000",
        /// More.
        Large = "over 1000",
    }
}

/// A class of problems; what is absent may be anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Class {
    /// Dimension of the body.
    pub dim: Option<usize>,
    /// What friction does.
    pub friction: Option<Friction>,
    /// Whether the load comes in several increments.
    pub path: Option<bool>,
    /// How many contact unknowns.
    pub size: Option<Size>,
}

impl Class {
    const ALL: Self = Self {
        dim: None,
        friction: None,
        path: None,
        size: None,
    };

    /// The class of a problem, from its records; absent where none knows.
    fn of(problem: &Problem, records: &[&Record]) -> Self {
        let size = records.iter().find_map(|r| r.found.problem.as_ref());
        let frictionless = problem.friction.iter().all(|mu| *mu == 0.0);
        let friction = match records.iter().find_map(|r| sticks(r)) {
            _ if frictionless => Friction::Frictionless,
            Some(true) => Friction::Stick,
            _ => Friction::Slip,
        };
        // A cell that failed may have ended early.
        let increments = records.iter().map(|r| r.found.increments.len()).max();
        Self {
            dim: size.map(|s| s.dim),
            friction: Some(friction),
            path: increments.map(|count| count > 1),
            size: size.map(|s| match s.unknowns {
                0..=100 => Size::Small,
                101..=1000 => Size::Medium,
                _ => Size::Large,
            }),
        }
    }

    /// Coarser classes that hold this one, and itself, from coarse to fine.
    fn levels(self) -> [Self; 3] {
        let middle = Self {
            path: None,
            size: None,
            ..self
        };
        [Self::ALL, middle, self]
    }

    /// Whether a problem of a class belongs to this one.
    fn holds(&self, other: &Self) -> bool {
        fn fits<T: PartialEq>(own: &Option<T>, other: &Option<T>) -> bool {
            own.is_none() || own == other
        }
        fits(&self.dim, &other.dim)
            && fits(&self.friction, &other.friction)
            && fits(&self.path, &other.path)
            && fits(&self.size, &other.size)
    }
}

/// Whether nothing slips at the end of the path; none where the record does not tell.
fn sticks(record: &Record) -> Option<bool> {
    if !super::is_honest(record) {
        return None;
    }
    let found = &record.found;
    let values = found.values.iter().filter(|v| v.quantity == "max_slip");
    let slips = values.map(|v| v.value.abs() > STICKS * v.scale);
    let exact = |name: &'static str| {
        let own = found.deviations.iter().filter(move |d| d.quantity == name);
        own.map(|d| d.exact.abs())
    };
    let scale = exact("displacement").fold(0.0, f64::max);
    let slips = slips.chain(exact("slip").map(|slip| slip > STICKS * scale));
    slips.reduce(|a, b| a || b).map(|slips| !slips)
}

named! {
    /// How sure the fastest methods are.
    pub enum Confidence {
        /// Fastest on most problems of the class with 95 % confidence.
        Sure = "sure",
        /// Fastest on most of the problems that were measured.
        Likely = "likely",
        /// Not even that, too few problems, or no times.
        Open = "open",
    }
}

/// A method that none is faster than in the mean, and the problems on which none is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fastest {
    /// Method.
    pub method: String,
    /// Problems on which no method is faster beyond the intervals.
    pub among: usize,
    /// Of these, problems on which it is faster than all others.
    pub alone: usize,
}

/// What to use in a class of problems at a tier.
#[derive(Debug, Clone, PartialEq)]
pub struct Recommendation {
    /// Which problems.
    pub class: Class,
    /// Accuracy asked for.
    pub tier: Tier,
    /// Fewest and most contact unknowns of those measured.
    pub unknowns: [usize; 2],
    /// How many there were.
    pub problems: usize,
    /// How many of them have times that can be compared.
    pub timed: usize,
    /// Fastest methods among the most reliable, none faster than another in the mean; first who is among the fastest on
    /// most problems. Empty without times.
    pub fastest: Vec<Fastest>,
    /// How sure the first is.
    pub confidence: Confidence,
    /// Methods with the highest rate of right answers.
    pub reliable: Vec<String>,
    /// Problems that they solve.
    pub correct: usize,
}

impl Recommendation {
    /// Rate of right answers of the most reliable methods with Wilson's 95 % interval.
    pub fn rate(&self) -> [f64; 3] {
        wilson(self.correct, self.problems)
    }

    /// What the confidence stands on, in words.
    pub fn evidence(&self) -> String {
        let Some(first) = self.fastest.first() else {
            return "no times".into();
        };
        let Fastest { among, alone, .. } = first;
        let equal = |f: &&Fastest| f.among == *among;
        let (top, others): (Vec<&Fastest>, Vec<&Fastest>) = self.fastest.iter().partition(equal);
        let names: Vec<&str> = top.iter().map(|f| f.method.as_str()).collect();
        let who = match names.len() {
            1..=3 => names.join(", "),
            count => format!("{count} methods"),
        };
        let mut words = format!("{who} among the fastest on {among} of {}", self.timed);
        if names.len() > 1 {
            words += " each";
        } else if *alone > 0 {
            words += &format!(", alone on {alone}");
        }
        for other in others.iter().take(2) {
            words += &format!("; {} on {}", other.method, other.among);
        }
        words
    }
}

/// Recommendations for all classes, from coarse to fine, at all tiers. A finer class that holds the same problems as a
/// coarser one is left out.
pub fn recommendations(records: &[Record]) -> Vec<Recommendation> {
    let mut all = Vec::new();
    for tier in Tier::ALL {
        let set = TestSet::new(records, tier);
        let rows = set.problems.iter().zip(&set.records);
        let of: Vec<Class> = rows.map(|(p, row)| Class::of(p, row)).collect();
        let mut seen: Vec<Vec<usize>> = Vec::new();
        for level in 0..3 {
            let mut classes: Vec<Class> = of.iter().map(|class| class.levels()[level]).collect();
            classes.sort();
            classes.dedup();
            for class in classes {
                let own = |i: &usize| class.holds(&of[*i]);
                let members: Vec<usize> = (0..of.len()).filter(own).collect();
                if seen.contains(&members) {
                    continue;
                }
                let problems: Vec<&Problem> = members.iter().map(|i| &set.problems[*i]).collect();
                let part = set.restricted(|problem| problems.contains(&problem));
                seen.push(members);
                all.push(recommend(class, &part));
            }
        }
    }
    all
}

fn recommend(class: Class, set: &TestSet<'_>) -> Recommendation {
    let right = |method: usize| {
        let cells = set.records.iter().map(|row| row[method]);
        cells.filter(|cell| is_correct(cell, set.tier)).count()
    };
    let counts: Vec<usize> = (0..set.methods.len()).map(right).collect();
    let correct = counts.iter().copied().max().unwrap_or(0);
    let reliable: Vec<usize> = (0..counts.len())
        .filter(|m| correct > 0 && counts[*m] == correct)
        .collect();
    let costs = Costs::new(set);
    let name = |m: &usize| set.methods[*m].to_owned();
    let ranking = ranking(&costs.of_methods(&reliable));
    let standings = ranking.map_or_else(Vec::new, |ranking| ranking.standings);
    let cheapest: Vec<Vec<usize>> = (0..costs.problems()).map(|p| costs.cheapest(p)).collect();
    let first = standings.iter().filter(|standing| standing.rank[0] == 1);
    let mut fastest: Vec<Fastest> = first
        .map(|standing| {
            let own = |m: &usize| costs.methods[*m] == standing.method;
            let among = cheapest.iter().filter(|all| all.iter().any(own));
            Fastest {
                method: standing.method.to_owned(),
                among: among.clone().count(),
                alone: among.filter(|all| all.len() == 1).count(),
            }
        })
        .collect();
    fastest.sort_by(|a, b| {
        (b.among, b.alone)
            .cmp(&(a.among, a.alone))
            .then_with(|| compare_methods(&a.method, &b.method))
    });
    let timed = costs.problems() - costs.unsolved();
    let among = fastest.first().map_or(0, |first| first.among);
    // Friction coefficients and meshes of one case are no independent evidence: it counts as much as there are cases.
    let cases: BTreeSet<&str> = set.problems.iter().map(|p| p.case.as_str()).collect();
    let votes = timed.min(cases.len());
    let confidence = match wilson(among * votes / timed.max(1), votes) {
        [_, low, _] if low > 0.5 => Confidence::Sure,
        [rate, ..] if rate > 0.5 && votes >= FEWEST => Confidence::Likely,
        _ => Confidence::Open,
    };
    let sizes = (set.records.iter().flatten()).filter_map(|r| r.found.problem.as_ref());
    let sizes = sizes.map(|size| size.unknowns);
    Recommendation {
        class,
        tier: set.tier,
        unknowns: [sizes.clone().min().unwrap_or(0), sizes.max().unwrap_or(0)],
        problems: set.problems.len(),
        timed,
        fastest,
        confidence,
        reliable: reliable.iter().map(name).collect(),
        correct,
    }
}

#[cfg(test)]
mod tests {
    use super::super::support::{end_with, solved, timed};
    use super::*;
    use crate::studies::convergence::Value;

    /// pdas is fastest wherever it is right; latin is right everywhere; b-newton too, and faster than latin.
    fn records(problems: usize, failures: usize) -> Vec<Record> {
        let times = [("b-newton", 2.0), ("pdas", 1.0), ("latin", 3.0)];
        let problem = |index| {
            let mut all = solved(&format!("case-{index}"), &times);
            if index < failures {
                end_with(&mut all[1], "gave-up: stalled");
            }
            all
        };
        (0..problems).flat_map(problem).collect()
    }

    fn names(found: &Recommendation) -> Vec<&str> {
        found.fastest.iter().map(|f| f.method.as_str()).collect()
    }

    fn overall(records: &[Record]) -> Recommendation {
        let all = recommendations(records);
        all.into_iter().find(|r| r.class == Class::ALL).unwrap()
    }

    #[test]
    fn an_unreliable_method_is_never_recommended() {
        let found = overall(&records(6, 1));
        assert_eq!(names(&found), ["b-newton"]);
        assert_eq!(found.reliable, ["b-newton", "latin"]);
        assert_eq!((found.confidence, found.correct), (Confidence::Open, 6));
        let evidence = "b-newton among the fastest on 1 of 6, alone on 1";
        assert_eq!(found.evidence(), evidence);
        let found = overall(&records(6, 0));
        assert_eq!(names(&found), ["pdas"]);
        assert_eq!((found.fastest[0].among, found.fastest[0].alone), (6, 6));
    }

    /// Source: Wilson's interval of 3 of 3 begins at 0.44, of 4 of 4 at 0.51.
    #[test]
    fn a_few_problems_make_nothing_sure() {
        assert_eq!(overall(&records(2, 0)).confidence, Confidence::Open);
        assert_eq!(overall(&records(3, 0)).confidence, Confidence::Likely);
        assert_eq!(overall(&records(4, 0)).confidence, Confidence::Sure);
    }

    #[test]
    fn overlapping_intervals_are_recommended_together() {
        let mut records = records(5, 0);
        for record in records.iter_mut().filter(|r| r.cell.method == "b-newton") {
            *record = timed(record.clone(), 1.1);
        }
        let found = overall(&records);
        let evidence = "b-newton, pdas among the fastest on 5 of 5 each";
        assert_eq!(found.evidence(), evidence);
        // One problem on which only one of them is: it comes first.
        let slow = records.iter_mut().find(|r| r.cell.method == "b-newton");
        let slow = slow.unwrap();
        *slow = timed(slow.clone(), 1.3);
        let found = overall(&records);
        assert_eq!(names(&found), ["pdas", "b-newton"]);
        let evidence = "pdas among the fastest on 5 of 5, alone on 1; b-newton on 4";
        assert_eq!(found.evidence(), evidence);
    }

    #[test]
    fn without_times_nothing_is_fastest() {
        let mut records = records(5, 0);
        records.iter_mut().for_each(|r| r.spent = None);
        let found = overall(&records);
        assert_eq!((found.timed, found.evidence().as_str()), (0, "no times"));
        assert_eq!(found.reliable.len(), 3);
    }

    #[test]
    fn classes_tell_problems_apart_and_are_not_repeated() {
        let mut records = records(2, 0);
        let classes = |records: &[Record]| -> Vec<Class> {
            recommendations(records).iter().map(|r| r.class).collect()
        };
        assert_eq!(classes(&records), [Class::ALL], "all alike");
        for record in records.iter_mut().filter(|r| r.cell.case == "case-1") {
            record.found.values.push(Value {
                quantity: "max_slip".into(),
                at: "crack-1".into(),
                value: 1e-20,
                norm: 1e-20,
                scale: 1e-3,
            });
        }
        let found = classes(&records);
        let friction: Vec<Option<Friction>> = found.iter().map(|c| c.friction).collect();
        assert_eq!(
            friction,
            [None, Some(Friction::Slip), Some(Friction::Stick)]
        );
    }
}
