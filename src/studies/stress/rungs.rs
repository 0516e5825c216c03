//! What came of the ladders, as rows of tables.

use super::finding::{Cause, Finding, Trial};
use super::ladder::rung::Ladder;
use super::ladder::{ladders, rung};
use super::scene::Family;

/// One value of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct RungRow {
    /// Name of the ladder.
    pub ladder: String,
    /// What changes, with its unit.
    pub parameter: String,
    /// The value.
    pub value: f64,
    /// The worst that was found; none: right.
    pub cause: Option<Cause>,
    /// In one line.
    pub reason: String,
    /// Error against the closed form or of the energy identity; of the ladder of loads the change of forces [-].
    pub error: f64,
    /// Of the default method, or of the method whose option it is.
    pub iterations: usize,
    /// Methods that did what they are for, and methods tried.
    pub done: [usize; 2],
    /// The others.
    pub lost: Vec<String>,
    /// Condition: see `runs.csv`.
    pub sway: f64,
    /// Deepest overlap over the largest jump or displacement [-].
    pub overlap: f64,
}

/// A parameter of a scene.
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
    /// The others: values and causes.
    pub others: String,
    /// Largest error where right [-].
    pub error: f64,
    /// Most iterations of the default method where right.
    pub iterations: usize,
    /// Methods that lost somewhere, and at how many values.
    pub lost: String,
}

/// An option of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct OptionRow {
    /// Method.
    pub method: &'static str,
    /// Name of the option.
    pub option: &'static str,
    /// Its default.
    pub default: f64,
    /// Least and largest value tried.
    pub tried: [f64; 2],
    /// Least and largest value, next to each other about the default, at which the method did what it is for.
    pub safe: [f64; 2],
    /// Iterations at the default.
    pub iterations: usize,
    /// Fewest iterations, and the value that took them.
    pub fewest: (usize, f64),
    /// Every value tried, from the least.
    pub steps: Vec<Step>,
}

/// A method on one ladder of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the ladder.
    pub ladder: &'static str,
    /// Method.
    pub method: String,
    /// Every value tried.
    pub steps: Vec<Step>,
}

/// A value, and the iterations of a method there; none where it did not do what it is for.
pub type Step = (f64, Option<usize>);

/// Findings on a ladder, with its values.
fn of_ladder<'a>(
    findings: &'a [Finding],
    ladder: &'a Ladder,
) -> impl Iterator<Item = (f64, &'a Finding)> {
    let own = findings.iter().filter(|f| f.family == Family::Ladder);
    let own = own.filter(|f| f.category == ladder.name);
    own.map(|f| (rung(f.number).1, f))
}

/// The methods that a rung is about: of an option its own alone, which ran last.
fn trials<'a>(ladder: &Ladder, finding: &'a Finding) -> &'a [Trial] {
    match ladder.option {
        Some(_) => &finding.trials[finding.trials.len().saturating_sub(1)..],
        None => &finding.trials,
    }
}

fn step(value: f64, trial: &Trial) -> Step {
    (value, trial.cause.is_none().then_some(trial.iterations))
}

/// Every rung.
pub fn rungs(findings: &[Finding]) -> Vec<RungRow> {
    let own = findings.iter().filter(|f| f.family == Family::Ladder);
    let row = |finding: &Finding| {
        let (ladder, value) = rung(finding.number);
        let trials = trials(ladder, finding);
        let lost = trials.iter();
        let lost = lost.filter_map(|t| Some(format!("{}: {}", t.method, t.cause?)));
        let lost: Vec<String> = lost.collect();
        RungRow {
            ladder: ladder.name.clone(),
            parameter: ladder.parameter.clone(),
            value,
            cause: finding.cause,
            reason: finding.reason.clone(),
            error: finding.error.unwrap_or(f64::NAN),
            iterations: trials.first().map_or(0, |t| t.iterations),
            done: [trials.len() - lost.len(), trials.len()],
            lost,
            sway: finding.sway.unwrap_or(f64::NAN),
            overlap: finding.overlap.unwrap_or(f64::NAN),
        }
    };
    own.map(row).collect()
}

/// Every ladder of a scene that has a finding.
pub fn of_scenes(findings: &[Finding]) -> Vec<LadderRow> {
    let row = |ladder: &Ladder| {
        let own: Vec<(f64, &Finding)> = of_ladder(findings, ladder).collect();
        let others = own.iter();
        let others = others.filter_map(|(v, f)| Some(format!("at {v:e}: {}", f.cause?)));
        let right: Vec<&Finding> = (own.iter().map(|own| own.1))
            .filter(|f| f.cause.is_none())
            .collect();
        let mut lost: Vec<(&str, usize)> = Vec::new();
        let trials = own.iter().flat_map(|(_, f)| &f.trials);
        for trial in trials.filter(|t| t.cause.is_some()) {
            match lost.iter_mut().find(|l| l.0 == trial.method) {
                Some(known) => known.1 += 1,
                None => lost.push((&trial.method, 1)),
            }
        }
        let lost: Vec<String> = lost.iter().map(|(name, n)| format!("{name} {n}")).collect();
        let values = || own.iter().map(|own| own.0);
        let errors = right.iter().map(|f| f.error.unwrap_or(0.0));
        let iterations = right.iter().filter_map(|f| f.trials.first());
        Some(LadderRow {
            ladder: ladder.name.clone(),
            parameter: ladder.parameter.clone(),
            range: [values().reduce(f64::min)?, values().reduce(f64::max)?],
            rungs: own.len(),
            right: right.len(),
            others: others.collect::<Vec<_>>().join("; "),
            error: errors.fold(0.0, f64::max),
            iterations: iterations.map(|t| t.iterations).max().unwrap_or(0),
            lost: lost.join(", "),
        })
    };
    let scenes = ladders().iter().filter(|l| l.option.is_none());
    scenes.filter_map(row).collect()
}

/// Every option of a method that has findings.
pub fn of_options(findings: &[Finding]) -> Vec<OptionRow> {
    let row = |ladder: &Ladder| {
        let (method, option) = ladder.option?;
        let own = of_ladder(findings, ladder);
        let mut tried: Vec<(f64, &Trial)> = own
            .filter_map(|(v, f)| Some((v, trials(ladder, f).first()?)))
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let default = tried.iter().position(|t| t.1.method == method)?;
        let steps: Vec<Step> = tried.iter().map(|(v, trial)| step(*v, trial)).collect();
        let done = |k: &usize| steps[*k].1.is_some();
        let low = (0..=default).rev().take_while(done).last();
        let high = (default..steps.len()).take_while(done).last();
        let value = |k: Option<usize>| k.map_or(f64::NAN, |k| steps[k].0);
        let few = steps.iter().filter_map(|(v, n)| Some(((*n)?, *v)));
        Some(OptionRow {
            method,
            option,
            default: steps[default].0,
            tried: [steps[0].0, steps[steps.len() - 1].0],
            safe: [value(low), value(high)],
            iterations: tried[default].1.iterations,
            fewest: few.min_by_key(|f| f.0).unwrap_or((0, f64::NAN)),
            steps,
        })
    };
    ladders().iter().filter_map(row).collect()
}

/// Every method on every ladder of a scene that has findings.
pub fn curves(findings: &[Finding]) -> Vec<Curve> {
    let mut found: Vec<Curve> = Vec::new();
    for ladder in ladders().iter().filter(|l| l.option.is_none()) {
        for (value, finding) in of_ladder(findings, ladder) {
            for trial in &finding.trials {
                let is = |c: &Curve| c.ladder == ladder.name && c.method == trial.method;
                let step = step(value, trial);
                match found.iter_mut().find(|c| is(c)) {
                    Some(curve) => curve.steps.push(step),
                    None => found.push(Curve {
                        ladder: &ladder.name,
                        method: trial.method.clone(),
                        steps: vec![step],
                    }),
                }
            }
        }
    }
    found
}
