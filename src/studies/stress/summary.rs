//! Findings summed up: faults, invariances, ladders; the records of methods go to the analyses of any records.

use std::collections::BTreeMap;

use super::find::INVARIANT;
use super::finding::{Fault, Finding, Seen};
use super::places::{Ladder, Step, step};
use super::scene::Family;
use crate::run::verdict::Verdict;
use crate::studies::record::Record;

/// Scenes of a family that ended alike.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultRow {
    /// Family.
    pub family: Family,
    /// Worst fault; none: right.
    pub fault: Option<Fault>,
    /// How many.
    pub scenes: usize,
    /// Of all of the family [-].
    pub share: f64,
    /// Their numbers; none of right ones.
    pub numbers: Vec<u64>,
    /// Fault of the first.
    pub reason: String,
    /// Largest error of the default method [-].
    pub error: f64,
    /// Smallest case of the first that has one, as a file of the report.
    pub minimal: Option<String>,
}

/// One transformation that leaves answers as they are, over all scenes of a dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct InvarianceRow {
    /// Space dimension.
    pub dimension: usize,
    /// The transformation.
    pub transformation: String,
    /// Whether it rounds nothing and gives nothing another name.
    pub exact: bool,
    /// Scenes it was tried on.
    pub scenes: usize,
    /// Scenes whose contact points stayed where they were.
    pub same: usize,
    /// Scenes that kept at least nine digits.
    pub kept: usize,
    /// Digits that half of the scenes with the same points kept at least.
    pub median: f64,
    /// Fewest digits kept by a scene with the same points.
    pub fewest: f64,
    /// Largest change of energy of any scene [-].
    pub energy: f64,
    /// Family and number of that scene.
    pub worst: String,
}

/// A parameter of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct LadderRow {
    /// Name of the ladder.
    pub ladder: String,
    /// The parameter that changes, with its unit.
    pub parameter: String,
    /// Least and largest value.
    pub range: [f64; 2],
    /// Values tried.
    pub steps: usize,
    /// How many are right, refused, jump, wrong, other than in other cells, suspect, and without an answer.
    pub ended: [usize; 7],
    /// Values by fault.
    pub others: String,
    /// Largest error where right [-].
    pub error: f64,
    /// Largest difference of neighbours, and from other cells, with their values; NaN where nothing is compared.
    pub apart: [(f64, f64); 2],
    /// Steps that differ by more than 2 % from other cells.
    pub beyond: usize,
}

/// Difference from other cells that is worth a look [-].
const MESH: f64 = 0.02;

/// File of the smallest case of a finding.
pub fn minimal(finding: &Finding) -> Option<String> {
    let name = finding.scene.family.name();
    (finding.minimal.as_ref()).map(|_| format!("cases/{name}-{}.toml", finding.scene.number))
}

/// Counts by family and fault, the right ones first.
pub fn faults(findings: &[Finding]) -> Vec<FaultRow> {
    let mut groups: BTreeMap<(Family, Option<Fault>), Vec<&Finding>> = BTreeMap::new();
    for finding in findings {
        let key = (finding.scene.family, finding.fault);
        groups.entry(key).or_default().push(finding);
    }
    let all = |family: Family| findings.iter().filter(|f| f.scene.family == family).count();
    let row = |((family, fault), own): ((Family, Option<Fault>), Vec<&Finding>)| {
        let wrong = own.iter().filter(|f| f.fault.is_some());
        let errors = own.iter().map(|f| f.error()).filter(|e| e.is_finite());
        FaultRow {
            family,
            fault,
            scenes: own.len(),
            share: own.len() as f64 / all(family) as f64,
            numbers: wrong.clone().map(|f| f.scene.number).collect(),
            reason: wrong
                .clone()
                .next()
                .map_or_else(String::new, |f| f.reason.clone()),
            error: errors.reduce(f64::max).unwrap_or(f64::NAN),
            minimal: own.iter().find_map(|f| minimal(f)),
        }
    };
    groups.into_iter().map(row).collect()
}

/// Digits of a relative change; at most those of the arithmetic.
fn digits(change: f64) -> f64 {
    -change.max(f64::EPSILON).log10()
}

/// Every transformation, by dimension.
pub fn invariances(findings: &[Finding]) -> Vec<InvarianceRow> {
    type Key<'a> = (usize, bool, &'a str);
    let mut groups: BTreeMap<Key<'_>, Vec<(&Seen, &Finding)>> = BTreeMap::new();
    for finding in findings {
        for seen in &finding.seen {
            let key = (finding.scene.dim, !seen.exact, seen.transformation.as_str());
            groups.entry(key).or_default().push((seen, finding));
        }
    }
    let row = |((dimension, inexact, name), own): (Key<'_>, Vec<(&Seen, &Finding)>)| {
        let mut forces: Vec<f64> = own.iter().filter_map(|(s, _)| s.change?.force).collect();
        forces.sort_by(f64::total_cmp);
        let worst = own
            .iter()
            .max_by(|a, b| a.0.energy().total_cmp(&b.0.energy()));
        let at = |k: usize| forces.get(k).map_or(f64::NAN, |&change| digits(change));
        let scene = |f: &Finding| format!("{} {}", f.scene.family.name(), f.scene.number);
        InvarianceRow {
            dimension,
            transformation: name.into(),
            exact: !inexact,
            scenes: own.len(),
            same: forces.len(),
            kept: forces.iter().filter(|change| **change <= INVARIANT).count(),
            median: at(forces.len() / 2),
            fewest: at(forces.len().wrapping_sub(1)),
            energy: worst.map_or(f64::NAN, |w| w.0.energy()),
            worst: worst.map_or_else(String::new, |w| scene(w.1)),
        }
    };
    groups.into_iter().map(row).collect()
}

/// Records of the random scenes whose body is sound and has an answer, in classes by dimension.
pub fn records(findings: &[Finding]) -> Vec<Record> {
    let none = [
        Fault::SuspectMesh,
        Fault::NoEquilibrium,
        Fault::FrictionLimit,
    ];
    let random = findings.iter().filter(|f| f.scene.family.is_random());
    let answered = random.filter(|f| f.fault.is_none_or(|fault| !none.contains(&fault)));
    let of = |finding: &Finding| {
        let class = format!("{}D", finding.scene.dim);
        let own = finding.records.clone().into_iter();
        own.map(move |record| Record {
            class: class.clone(),
            ..record
        })
    };
    answered.flat_map(of).collect()
}

/// Place of a fault in [`LadderRow::ended`].
fn ended(fault: Option<Fault>) -> usize {
    match fault {
        None | Some(Fault::Floor) => 0,
        Some(Fault::Refused | Fault::Beyond) => 1,
        Some(Fault::Jump | Fault::Step) => 2,
        Some(Fault::WrongPatch | Fault::WrongEnergy | Fault::FalseClaim) => 3,
        Some(Fault::OtherCells) => 4,
        Some(Fault::SuspectMesh) => 5,
        Some(_) => 6,
    }
}

/// Every ladder that has findings.
pub fn of_ladders<'a>(findings: &'a [Finding]) -> Vec<LadderRow> {
    let all = findings.iter().filter(|f| f.scene.family == Family::Ladder);
    let with = |f: &'a Finding| {
        let (place, ladder, step) = step(f.scene.number);
        (place, ladder, step, f)
    };
    let all: Vec<(usize, &Ladder, &Step, &Finding)> = all.map(with).collect();
    let row = |own: &[(usize, &Ladder, &Step, &Finding)]| {
        let ladder = own[0].1;
        let mut others: BTreeMap<Fault, Vec<String>> = BTreeMap::new();
        for (.., step, f) in own {
            if let Some(fault) = f.fault {
                let values = others.entry(fault).or_default();
                values.push(match step.value {
                    whole if whole.fract() == 0.0 => whole.to_string(),
                    value => format!("{value:.1e}"),
                });
            }
        }
        let told =
            |(fault, values): (&Fault, &Vec<String>)| format!("{fault}: {}", values.join(" "));
        let values = || own.iter().map(|own| own.2.value);
        let count = |k: usize| own.iter().filter(|own| ended(own.3.fault) == k).count();
        let apart = |far: bool| {
            let own = own.iter().filter(move |own| own.2.other.is_some() == far);
            own.map(|own| (own.3.apart, own.2.value))
                .filter(|own| !own.0.is_nan())
        };
        let worst = |far: bool| apart(far).max_by(|a, b| a.0.total_cmp(&b.0));
        let right = own.iter().filter(|own| own.3.fault.is_none());
        LadderRow {
            ladder: ladder.name.clone(),
            parameter: ladder.parameter.clone(),
            range: [f64::min, f64::max].map(|of| values().fold(own[0].2.value, of)),
            steps: own.len(),
            ended: [0, 1, 2, 3, 4, 5, 6].map(count),
            others: others.iter().map(told).collect::<Vec<_>>().join("; "),
            error: right.map(|own| own.3.error()).fold(0.0, f64::max),
            apart: [false, true].map(|far| worst(far).unwrap_or((f64::NAN, f64::NAN))),
            beyond: apart(true).filter(|own| own.0 > MESH).count(),
        }
    };
    all.chunk_by(|a, b| a.0 == b.0).map(row).collect()
}

/// Whether the program did nothing wrong: no fault, and no scene with one answer that the default method missed.
pub fn as_expected(findings: &[Finding]) -> bool {
    let wrong = |f: &Finding| {
        f.fault
            .is_some_and(|own| own.is_wrong() || own == Fault::Missed)
    };
    let crashed =
        |own: &Record| matches!(own.found.verdict, Verdict::FalseClaim | Verdict::Crashed(_));
    !findings
        .iter()
        .any(|f| wrong(f) || f.records.iter().any(crashed))
}
