//! Findings summed up: faults, invariances, methods, ladders, and every scene that is not right.

use std::collections::BTreeMap;

use super::find::INVARIANT;
use super::finding::{Fault, Finding, Seen, is_done};
use super::places::{Ladder, ladders, rung};
use super::scene::Family;
use crate::run::verdict::{GIVE_UPS, Verdict};
use crate::studies::record::Record;
use crate::studies::statistics::quantile;
use stickslip_methods::Status;

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
    /// Number of the first.
    pub example: u64,
    /// Its smallest case, as a file of the report.
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
    /// Of these, those whose contact points stayed where they were.
    pub same: usize,
    /// Of these, those that kept at least nine digits.
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

/// A method over all scenes of a dimension that have an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodRow {
    /// Space dimension.
    pub dimension: usize,
    /// Label.
    pub method: String,
    /// Whether its limit are the contact laws.
    pub exact: bool,
    /// Scenes tried.
    pub scenes: usize,
    /// Of these, done what it is for.
    pub done: usize,
    /// Claims that the judge refuted.
    pub false_claims: usize,
    /// Errors, time and memory.
    pub crashed: usize,
    /// Those that gave up, by status in the order of [`GIVE_UPS`].
    pub gave_up: [usize; GIVE_UPS.len()],
    /// Median and largest number of iterations where done.
    pub iterations: [f64; 2],
    /// Largest friction coefficient at which it was done.
    pub friction: f64,
    /// Largest condition (`sway`) at which it was done.
    pub sway: f64,
}

/// A parameter of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct LadderRow {
    /// Name of the ladder.
    pub ladder: String,
    /// What changes, with its unit.
    pub parameter: String,
    /// Least and largest value.
    pub range: [f64; 2],
    /// Values tried.
    pub rungs: usize,
    /// Values at which the answer was right.
    pub right: usize,
    /// The others: values and faults.
    pub others: String,
    /// Largest error where right [-].
    pub error: f64,
    /// Most iterations of the default method where right.
    pub iterations: usize,
}

/// A scene that is not right.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRow {
    /// Seed of the suite.
    pub seed: u64,
    /// Family.
    pub family: Family,
    /// Number.
    pub number: u64,
    /// How its cracks lie.
    pub category: String,
    /// The worst that was found.
    pub fault: Fault,
    /// In one line.
    pub reason: String,
    /// Largest error.
    pub error: f64,
    /// Its smallest case, as a file of the report.
    pub minimal: Option<String>,
}

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
        let small = own.iter().find(|f| f.minimal.is_some());
        let example = small.or(own.first());
        FaultRow {
            family,
            fault,
            scenes: own.len(),
            share: own.len() as f64 / all(family) as f64,
            example: example.map_or(0, |f| f.scene.number),
            minimal: small.and_then(|f| minimal(f)),
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

/// Every method, by dimension; the scenes are those that have an answer.
pub fn methods(findings: &[Finding]) -> Vec<MethodRow> {
    let mut groups: BTreeMap<(usize, &str), Vec<&Record>> = BTreeMap::new();
    let none = [Fault::NoEquilibrium, Fault::FrictionLimit].map(Some);
    let random = findings.iter().filter(|f| f.scene.family.is_random());
    for finding in random.filter(|f| !none.contains(&f.fault)) {
        for record in &finding.records {
            let key = (finding.scene.dim, record.found.method.as_str());
            groups.entry(key).or_default().push(record);
        }
    }
    let row = |((dimension, method), own): ((usize, &str), Vec<&Record>)| {
        let without = Verdict::GaveUp(Status::NoEquilibrium);
        let tried = |own: &&&Record| {
            let verdict = &own.found.verdict;
            !matches!(verdict, Verdict::Refused(_)) && *verdict != without
        };
        let own: Vec<&Record> = own.iter().filter(tried).copied().collect();
        let count = |of: &dyn Fn(&Record) -> bool| own.iter().filter(|own| of(own)).count();
        let done: Vec<&Record> = own.iter().filter(|own| is_done(own)).copied().collect();
        let iterations = || {
            done.iter()
                .map(|own| own.found.sum(|step| step.iterations) as f64)
        };
        let largest =
            |of: &dyn Fn(&Record) -> f64| done.iter().map(|own| of(own)).fold(0.0, f64::max);
        let sway = |own: &Record| {
            let steps = own.found.increments.iter();
            steps.map(|step| step.judge.sway).fold(0.0, f64::max)
        };
        MethodRow {
            dimension,
            method: method.into(),
            exact: own.first().is_some_and(|own| own.found.exact),
            scenes: own.len(),
            done: done.len(),
            false_claims: count(&|own| own.found.verdict == Verdict::FalseClaim),
            crashed: count(&|own| {
                let verdict = &own.found.verdict;
                verdict.kind().is_limit() || matches!(verdict, Verdict::Crashed(_))
            }),
            gave_up: std::array::from_fn(|k| {
                count(&|own| own.found.verdict == Verdict::GaveUp(GIVE_UPS[k]))
            }),
            iterations: [0.5, 1.0].map(|q| quantile(q, iterations())),
            friction: largest(&|own| own.asked.friction.iter().copied().fold(0.0, f64::max)),
            sway: largest(&sway),
        }
    };
    groups.into_iter().map(row).collect()
}

/// Every ladder that has findings.
pub fn of_ladders(findings: &[Finding]) -> Vec<LadderRow> {
    let row = |ladder: &Ladder| {
        let all = findings.iter().filter(|f| f.scene.family == Family::Ladder);
        let own = all.filter(|f| f.scene.category == ladder.name);
        let own: Vec<(f64, &Finding)> = own.map(|f| (rung(f.scene.number).1, f)).collect();
        let others = own.iter();
        let others = others.filter_map(|(v, f)| Some(format!("at {v:e}: {}", f.fault?)));
        let right: Vec<&Finding> = (own.iter().map(|own| own.1))
            .filter(|f| f.fault.is_none())
            .collect();
        let values = || own.iter().map(|own| own.0);
        let errors = right.iter().map(|f| f.error());
        let iterations = right.iter().filter_map(|f| f.records.first());
        let iterations = iterations.map(|own| own.found.sum(|step| step.iterations));
        Some(LadderRow {
            ladder: ladder.name.clone(),
            parameter: ladder.parameter.clone(),
            range: [values().reduce(f64::min)?, values().reduce(f64::max)?],
            rungs: own.len(),
            right: right.len(),
            others: others.collect::<Vec<_>>().join("; "),
            error: errors.fold(0.0, f64::max),
            iterations: iterations.max().unwrap_or(0),
        })
    };
    ladders().iter().filter_map(row).collect()
}

/// Every scene that is not right, but those beyond the mesh.
pub fn scenes(seed: u64, findings: &[Finding]) -> Vec<SceneRow> {
    let row = |finding: &Finding| {
        Some(SceneRow {
            seed,
            family: finding.scene.family,
            number: finding.scene.number,
            category: finding.scene.category.clone(),
            fault: finding.fault?,
            reason: finding.reason.clone(),
            error: finding.error(),
            minimal: minimal(finding),
        })
    };
    // Those beyond any mesh of such cells are as many as were drawn.
    let told = findings.iter().filter(|f| f.fault != Some(Fault::Beyond));
    told.filter_map(row).collect()
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
