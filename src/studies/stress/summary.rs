//! Findings summed up: causes, invariances, methods, and every scene that is not right.

use std::collections::BTreeMap;

use super::conduct::Suite;
use super::finding::{Cause, Change, Finding, Trial};
use super::invariance::INVARIANT;
use super::scene::Family;
use crate::run::verdict::Verdict;

/// Scenes of a family that ended for one cause.
#[derive(Debug, Clone, PartialEq)]
pub struct CauseRow {
    /// Family.
    pub family: Family,
    /// Worst cause; none: right.
    pub cause: Option<Cause>,
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
    /// Causes of the others, in the order of [`LOSSES`].
    pub losses: [usize; LOSSES.len()],
    /// Median and largest number of iterations where done.
    pub iterations: [f64; 2],
    /// Largest friction coefficient at which it was done.
    pub friction: f64,
    /// Largest condition (`sway`) at which it was done.
    pub sway: f64,
}

/// Why methods lose, with a column each.
pub const LOSSES: [Cause; 11] = [
    Cause::FalseClaim,
    Cause::Factorisation,
    Cause::SeveralSolutions,
    Cause::SingularTangent,
    Cause::Cycling,
    Cause::Diverged,
    Cause::Floor,
    Cause::Slow,
    Cause::Swaying,
    Cause::Wandering,
    Cause::Stalled,
];

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
    pub cause: Cause,
    /// In one line.
    pub reason: String,
    /// Largest error.
    pub error: f64,
    /// Time of the scene [s].
    pub seconds: f64,
    /// Its smallest case, as a file of the report.
    pub minimal: Option<String>,
}

/// File of the smallest case of a finding.
pub fn minimal(finding: &Finding) -> Option<String> {
    let name = finding.family.name();
    (finding.minimal.as_ref()).map(|_| format!("cases/{name}-{}.toml", finding.number))
}

/// Counts by family and cause, the right ones first.
pub fn causes(findings: &[Finding]) -> Vec<CauseRow> {
    let mut groups: BTreeMap<(Family, Option<Cause>), Vec<&Finding>> = BTreeMap::new();
    for finding in findings {
        let key = (finding.family, finding.cause);
        groups.entry(key).or_default().push(finding);
    }
    let all = |family: Family| findings.iter().filter(|f| f.family == family).count();
    let row = |((family, cause), own): ((Family, Option<Cause>), Vec<&Finding>)| {
        let small = own.iter().find(|f| f.minimal.is_some());
        let example = small.or(own.first());
        CauseRow {
            family,
            cause,
            scenes: own.len(),
            share: own.len() as f64 / all(family) as f64,
            example: example.map_or(0, |f| f.number),
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
    let mut groups: BTreeMap<Key<'_>, Vec<(&Change, &Finding)>> = BTreeMap::new();
    for finding in findings {
        for change in &finding.invariance {
            let dimension = finding.dimension;
            let key = (dimension, !change.exact, change.transformation.as_str());
            groups.entry(key).or_default().push((change, finding));
        }
    }
    let row = |((dimension, inexact, name), own): (Key<'_>, Vec<(&Change, &Finding)>)| {
        let mut forces: Vec<f64> = own.iter().filter_map(|(c, _)| c.force).collect();
        forces.sort_by(f64::total_cmp);
        let worst = own.iter().max_by(|a, b| a.0.energy.total_cmp(&b.0.energy));
        let at = |k: usize| forces.get(k).map_or(f64::NAN, |&change| digits(change));
        let scene = |f: &Finding| format!("{} {}", f.family.name(), f.number);
        InvarianceRow {
            dimension,
            transformation: name.into(),
            exact: !inexact,
            scenes: own.len(),
            same: forces.len(),
            kept: forces.iter().filter(|change| **change <= INVARIANT).count(),
            median: at(forces.len() / 2),
            fewest: at(forces.len().wrapping_sub(1)),
            energy: worst.map_or(f64::NAN, |w| w.0.energy),
            worst: worst.map_or_else(String::new, |w| scene(w.1)),
        }
    };
    groups.into_iter().map(row).collect()
}

/// Every method, by dimension; the scenes are those that have an answer.
pub fn methods(findings: &[Finding]) -> Vec<MethodRow> {
    let mut groups: BTreeMap<(usize, &str), Vec<(&Finding, &Trial)>> = BTreeMap::new();
    for finding in findings.iter().filter(|f| f.family.is_random()) {
        for trial in &finding.trials {
            let key = (finding.dimension, trial.method.as_str());
            groups.entry(key).or_default().push((finding, trial));
        }
    }
    let row = |((dimension, method), own): ((usize, &str), Vec<(&Finding, &Trial)>)| {
        let none = [Cause::Declined, Cause::NoEquilibrium, Cause::FrictionLimit];
        let tried = |(_, t): &&(&Finding, &Trial)| t.cause.is_none_or(|c| !none.contains(&c));
        let own: Vec<_> = own.iter().filter(tried).collect();
        let done: Vec<_> = own.iter().filter(|(_, t)| t.cause.is_none()).collect();
        let largest =
            |of: &dyn Fn(&Finding) -> f64| done.iter().map(|(f, _)| of(f)).fold(0.0, f64::max);
        let mut iterations: Vec<usize> = done.iter().map(|(_, t)| t.iterations).collect();
        iterations.sort_unstable();
        let at = |k: usize| iterations.get(k).map_or(f64::NAN, |&n| n as f64);
        MethodRow {
            dimension,
            method: method.into(),
            exact: own.first().is_some_and(|(_, t)| t.exact),
            scenes: own.len(),
            done: done.len(),
            losses: LOSSES.map(|c| own.iter().filter(|(_, t)| t.cause == Some(c)).count()),
            iterations: [
                at(iterations.len() / 2),
                at(iterations.len().wrapping_sub(1)),
            ],
            friction: largest(&|f| f.friction),
            sway: largest(&|f| f.sway.unwrap_or(0.0)),
        }
    };
    groups.into_iter().map(row).collect()
}

/// Every scene that is not right, but those beyond the mesh.
pub fn scenes(suite: &Suite, findings: &[Finding]) -> Vec<SceneRow> {
    let row = |finding: &Finding| {
        Some(SceneRow {
            seed: suite.seed,
            family: finding.family,
            number: finding.number,
            category: finding.category.clone(),
            cause: finding.cause?,
            reason: finding.reason.clone(),
            error: finding.error.unwrap_or(f64::NAN),
            seconds: finding.seconds,
            minimal: minimal(finding),
        })
    };
    // Those beyond any mesh of such cells are as many as were drawn.
    let told = findings.iter().filter(|f| f.cause != Some(Cause::Beyond));
    told.filter_map(row).collect()
}

/// Whether the program did nothing wrong: no fault, and no scene with one answer that the default method missed.
pub fn as_expected(findings: &[Finding]) -> bool {
    // A solved scene may be at the floor of the arithmetic too.
    let ended = |f: &Finding| f.trials.first().is_some_and(|t| t.cause.is_some());
    let missed = |f: &Finding| f.cause > Some(Cause::SeveralSolutions) && ended(f);
    let wrong = |f: &Finding| f.cause.is_some_and(Cause::is_fault) || missed(f);
    let crashed = |t: &Trial| matches!(t.verdict, Verdict::FalseClaim | Verdict::Crashed(_));
    !findings
        .iter()
        .any(|f| wrong(f) || f.trials.iter().any(crashed))
}
