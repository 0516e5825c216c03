//! Conclusions from a set of records about the methods: pure functions of the records, no files, no clock.
//!
//! Two questions are kept apart, as qpbenchmark does: *success* is what a method says of itself, *correct* is what the judge
//! says of it. Only right answers are compared, and times stand beside honest verdicts only: [`published_times`] is the one
//! place that decides about it.

pub mod accuracy;
pub mod causes;
pub mod costs;
pub mod options;
pub mod profile;
pub mod ranking;
pub mod scaling;
pub mod series;
pub mod success;
#[cfg(test)]
pub mod support;
pub mod test_set;

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::files::bundle::file_name;
use crate::run::choice::is_outside;
use crate::run::registry::methods;
use crate::studies::several::DIFFERENT;
use stickslip_methods::Tier;

use super::record::{Record, Spent};
use super::statistics::Timing;
use super::task::{Asked, Problem};

/// Times of a cell, if they may be shown: beside an honest verdict on every increment, and a violation that agrees with it.
pub fn published_times(record: &Record) -> Option<&Spent> {
    record.spent.as_ref().filter(|_| record.is_honest())
}

/// Whether the method says of itself that it succeeded: it ended with a claim, right or wrong.
pub fn claims(record: &Record) -> bool {
    record.found.verdict.claims()
}

/// Whether the answer is right to a tier: an honest verdict, contact laws that hold to the tier on every increment, and for
/// methods with laws of their own equilibrium too, which their grade says.
pub fn is_correct(record: &Record, tier: Tier) -> bool {
    let found = &record.found;
    record.is_honest()
        && found.increments.iter().all(|i| i.verdict.holds_to(tier))
        && found.violation() <= tier.tolerance()
}

/// Marks what is `solved` at tier high on problems to which different answers are known: cells are measured apart, and told
/// apart by their distance from the converged solution.
pub fn mark_several(records: &mut [Record]) {
    let high = |r: &Record| r.asked.tolerance <= Tier::High.tolerance();
    let differs = |r: &&Record| {
        let error = r.found.solver_error.as_ref();
        high(r) && r.found.verdict.is_solved() && error.is_some_and(|e| e.jump > DIFFERENT)
    };
    let ambiguous = problems(records.iter().filter(differs));
    for record in records.iter_mut().filter(|r| high(r)) {
        let mut all = ambiguous.iter();
        let ambiguous = all.any(|own| own.is_same_problem(&record.asked));
        record.found.verdict.mark(ambiguous);
    }
}

/// Time of the method alone, preparation and enforcement on all increments: what methods differ in. K is factored and
/// condensed for all of them, and load solves and recoveries of displacements cost each the same. The intervals of the two
/// are added, which is on the safe side.
pub fn method_time(spent: &Spent) -> Timing {
    let (prepare, enforcement) = (&spent.prepare, &spent.enforcement);
    Timing {
        median_s: prepare.median_s + enforcement.median_s,
        min_s: prepare.min_s + enforcement.min_s,
        low_s: prepare.low_s + enforcement.low_s,
        high_s: prepare.high_s + enforcement.high_s,
        samples: prepare.samples.min(enforcement.samples),
    }
}

/// Setup, assembly of K and its factorisation for a cell with times [s]: the least of all cells that build the same body on
/// the same machine. Each is measured once, and a cold start has nothing to do with the method.
pub fn body_times(record: &Record, records: &[Record]) -> Option<[f64; 3]> {
    let of = |r: &Record| {
        published_times(r).map(|spent| [spent.setup_s, spent.assembly_s, spent.factorisation_s])
    };
    let alike = |other: &&Record| {
        record.asked.is_same_problem(&other.asked)
            && record.origin.machine == other.origin.machine
            && record.origin.profile == other.origin.profile
    };
    let own = of(record)?;
    let all = records.iter().filter(alike).filter_map(of);
    Some(all.fold(own, |least, other| {
        std::array::from_fn(|k| least[k].min(other[k]))
    }))
}

/// Whether the options of a cell's method are the defaults.
pub fn has_defaults(cell: &Asked) -> bool {
    !cell.method.contains(':') || is_outside(&cell.method)
}

/// Name of a cell's method in the registry; of a program its argument.
pub fn method_name(cell: &Asked) -> &str {
    if is_outside(&cell.method) {
        return &cell.method;
    }
    cell.method.split(':').next().unwrap_or(&cell.method)
}

/// Order of methods: that of the registry, then by name with options.
pub fn compare_methods(a: &str, b: &str) -> Ordering {
    let place = |label: &str| {
        let name = label.split([':', '[']).next().unwrap_or(label);
        let known = methods().iter().position(|method| method.name == name);
        known.unwrap_or(methods().len())
    };
    place(a).cmp(&place(b)).then_with(|| a.cmp(b))
}

/// Order of problems: case, refinement, contact space, friction, increments, start.
pub fn compare_problems(a: &Problem, b: &Problem) -> Ordering {
    fn key(p: &Problem) -> impl PartialOrd + '_ {
        let path = (p.increments, p.cold);
        (&p.case, p.refine, &p.space, &p.digest, &p.friction, path)
    }
    // Coefficients of friction are numbers.
    key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal)
}

/// The finest tolerance that was asked for on every mesh, given those of each; none where they share none.
pub fn common_tolerance(meshes: &[Vec<f64>]) -> Option<f64> {
    let (first, others) = meshes.split_first()?;
    let shared = |tolerance: &&f64| others.iter().all(|mesh| mesh.contains(tolerance));
    first.iter().filter(shared).copied().min_by(f64::total_cmp)
}

/// Records by problem, in the order of problems.
pub fn by_problem<'a>(records: impl IntoIterator<Item = &'a Record>) -> Vec<Vec<&'a Record>> {
    let mut all: Vec<&Record> = records.into_iter().collect();
    all.sort_by(|a, b| compare_problems(&a.asked, &b.asked));
    let own = all.chunk_by(|a, b| a.asked.is_same_problem(&b.asked));
    own.map(<[&Record]>::to_vec).collect()
}

/// All problems of some records, in order.
pub fn problems<'a>(records: impl IntoIterator<Item = &'a Record>) -> Vec<Problem> {
    let all = by_problem(records).into_iter();
    all.map(|own| own[0].asked.problem()).collect()
}

/// A problem in words that are also a file name: `case.r2.star.mu-0.3`. Where two problems of the list share them, the
/// digest of the case and all coefficients of friction follow, and a number where one case has two names that files do not
/// tell apart.
pub fn problem_names(problems: &[Problem]) -> Vec<String> {
    let short = |p: &Problem| {
        let space = p.space.as_deref().unwrap_or("own");
        let mu = p.friction.first().copied().unwrap_or(0.0);
        let path = p.path_name();
        file_name(&[&format!("{}.r{}.{space}.mu-{mu}{path}", p.case, p.refine)])
    };
    let mut alike: BTreeMap<String, usize> = BTreeMap::new();
    for problem in problems {
        *alike.entry(short(problem)).or_default() += 1;
    }
    let name = |problem: &Problem| {
        let name = short(problem);
        if alike[&name] == 1 {
            return name;
        }
        let rest = problem.friction.iter().skip(1).map(f64::to_string);
        let rest: Vec<String> = rest.chain([problem.digest.clone()]).collect();
        format!("{name}-{}", rest.join("-"))
    };
    let mut before: BTreeMap<String, usize> = BTreeMap::new();
    let numbered = |name: String| {
        let count = before.entry(name.clone()).or_default();
        *count += 1;
        match *count {
            1 => name,
            number => format!("{name}-{number}"),
        }
    };
    problems.iter().map(name).map(numbered).collect()
}

#[cfg(test)]
mod tests {
    use super::support::{lying, record, timed};
    use super::*;
    use crate::run::verdict::Verdict;

    #[test]
    fn only_honest_verdicts_have_times() {
        for verdict in ["solved", "approximate: low", "approximate: none"] {
            let mut kept = timed(record("plate", "latin", 1e-3), 1.0);
            kept.found.verdict = verdict.parse().unwrap();
            kept.found.increments[0].verdict = verdict.parse().unwrap();
            assert!(published_times(&kept).is_some(), "{verdict}");
        }
        for verdict in [
            "false-claim",
            "gave-up: stalled",
            "refused: friction",
            "crashed: no",
            "timed-out",
            "out-of-memory",
        ] {
            let record = lying(verdict);
            assert!(record.spent.is_some(), "it does carry times");
            assert_eq!(published_times(&record), None, "{verdict}");
        }
    }

    #[test]
    fn a_record_that_contradicts_itself_has_no_times() {
        let good = || timed(record("plate", "latin", 1e-6), 1.0);
        let spoilt: [fn(&mut Record); 4] = [
            |r| r.found.increments[0].verdict = Verdict::FalseClaim,
            |r| r.found.increments[0].judge.violation = 1e-3,
            |r| r.found.increments[0].judge.violation = f64::NAN,
            |r| r.found.increments.clear(),
        ];
        assert!(published_times(&good()).is_some());
        for spoil in spoilt {
            let mut record = good();
            spoil(&mut record);
            assert_eq!(published_times(&record), None);
            assert!(!is_correct(&record, Tier::Low));
        }
    }

    #[test]
    fn success_is_a_claim_and_correct_is_its_proof() {
        let mut wrong = lying("false-claim");
        assert!(claims(&wrong) && !is_correct(&wrong, Tier::Low));
        wrong.found.verdict = "gave-up: stalled".parse().unwrap();
        assert!(!claims(&wrong));
        let solved = record("plate", "latin", 1e-6);
        assert!(is_correct(&solved, Tier::Low) && is_correct(&solved, Tier::Mid));
        assert!(!is_correct(&solved, Tier::High));
    }

    /// Goal: an answer far from the converged one marks all that is solved at tier high on its problem, and nothing else.
    #[test]
    fn different_answers_of_a_problem_are_marked() {
        let mut far = record("plate", "latin", 1e-9);
        far.found.solver_error.as_mut().unwrap().jump = 0.1;
        let mut records = [
            far,
            record("plate", "nsgs", 1e-9),
            record("plate", "nsgs", 1e-3),
            record("beam", "nsgs", 1e-9),
        ];
        mark_several(&mut records);
        let several = records.map(|r| r.found.verdict == Verdict::Several);
        assert_eq!(several, [true, true, false, false]);
    }

    /// Goal: where equilibrium fails, as it may for laws of their own, a small natural map proves nothing; the grade knows.
    #[test]
    fn an_approximate_answer_is_as_right_as_its_worst_grade() {
        let mut path = record("plate", "nitsche", 1e-9);
        path.found.increments.push(path.found.increments[0].clone());
        for (verdict, map) in [("approximate: mid", 1e-7), ("approximate: low", 1e-8)] {
            path.found.increments[0].verdict = "approximate: mid".parse().unwrap();
            path.found.increments[1].verdict = verdict.parse().unwrap();
            path.found.increments[1].judge.violation = map;
            path.found.verdict = verdict.parse().unwrap();
            assert_eq!(is_correct(&path, Tier::Mid), verdict.ends_with("mid"));
            assert!(is_correct(&path, Tier::Low) && !is_correct(&path, Tier::High));
        }
    }

    #[test]
    fn the_time_of_a_method_is_preparation_and_enforcement() {
        let record = timed(record("plate", "latin", 1e-6), 2.0);
        let spent = record.spent.as_ref().unwrap();
        let time = method_time(spent);
        // See `timed`: prepare 10 %, enforcement 90 % of the time, intervals of ±10 %.
        assert!((time.median_s - 2.0).abs() < 1e-12);
        assert!((time.low_s - 1.8).abs() < 1e-12 && (time.high_s - 2.2).abs() < 1e-12);
    }

    #[test]
    fn a_cold_start_is_not_that_of_a_method() {
        let cold = |method: &str, setup_s: f64, machine: &str| {
            let mut cell = timed(record("plate", method, 1e-6), 1.0);
            cell.spent.as_mut().unwrap().setup_s = setup_s;
            cell.origin.machine = machine.into();
            cell
        };
        let records = [
            cold("latin", 0.5, "one"),
            cold("pdas", 0.2, "one"),
            cold("nsgs", 0.1, "two"),
        ];
        let mut liar = records[1].clone();
        liar.found.verdict = Verdict::FalseClaim;
        let setup = |records: &[Record]| body_times(&records[0], records).map(|t| t[0]);
        assert_eq!(setup(&records), Some(0.2));
        assert_eq!(setup(&[records[0].clone(), liar.clone()]), Some(0.5));
        assert_eq!(body_times(&liar, &records), None);
    }

    #[test]
    fn meshes_are_compared_at_a_tolerance_that_all_of_them_have() {
        let coarse = vec![1e-3, 1e-6, 1e-9, 1e-10];
        assert_eq!(
            common_tolerance(&[coarse.clone(), vec![1e-9, 1e-6]]),
            Some(1e-9)
        );
        assert_eq!(common_tolerance(&[coarse, vec![1e-8]]), None);
        assert_eq!(common_tolerance(&[]), None);
    }

    #[test]
    fn problems_with_the_same_words_have_different_names() {
        let mut other = record("plate", "latin", 1e-6).asked.problem();
        let one = other.clone();
        assert_eq!(
            problem_names(std::slice::from_ref(&one)),
            ["plate.r1.own.mu-0.3"]
        );
        other.friction.push(0.5);
        let names = problem_names(&[one, other]);
        assert!(
            names[0] != names[1] && names[1].contains("-0.5-"),
            "{names:?}"
        );
    }
}
