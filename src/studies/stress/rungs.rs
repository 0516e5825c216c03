//! What came of the ladders, as rows of tables.

use super::finding::{Cause, Finding, Trial};
use super::ladder::{Ladder, ladders, rung};
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
    pub option: String,
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
}

fn of_ladder<'a>(findings: &'a [Finding], ladder: &'a Ladder) -> impl Iterator<Item = &'a Finding> {
    let own = findings.iter().filter(|f| f.family == Family::Ladder);
    own.filter(|f| f.category == ladder.name)
}

/// The trial a rung is about.
fn own(finding: &Finding, of_method: bool) -> Option<&Trial> {
    match of_method {
        true => finding.trials.last(),
        false => finding.trials.first(),
    }
}

/// Every rung.
pub fn rungs(findings: &[Finding]) -> Vec<RungRow> {
    let own_rows = findings.iter().filter(|f| f.family == Family::Ladder);
    let row = |finding: &Finding| {
        let rung = rung(finding.number);
        let of_method = rung.ladder.method.is_some();
        let trials =
            &finding.trials[usize::from(of_method).min(finding.trials.len().saturating_sub(1))..];
        let lost = trials
            .iter()
            .filter_map(|t| Some(format!("{}: {}", t.method, t.cause?)));
        let lost: Vec<String> = lost.collect();
        RungRow {
            ladder: rung.ladder.name,
            parameter: rung.ladder.parameter,
            value: rung.value,
            cause: finding.cause,
            reason: finding.reason.clone(),
            error: finding.error.unwrap_or(f64::NAN),
            iterations: own(finding, of_method).map_or(0, |t| t.iterations),
            done: [trials.len() - lost.len(), trials.len()],
            lost,
            sway: finding.sway.unwrap_or(f64::NAN),
            overlap: finding.overlap.unwrap_or(f64::NAN),
        }
    };
    own_rows.map(row).collect()
}

/// Every ladder of a scene that has a finding.
pub fn of_scenes(findings: &[Finding]) -> Vec<LadderRow> {
    let all = ladders();
    let rows = all
        .iter()
        .filter(|l| l.method.is_none())
        .filter_map(|ladder| {
            let own: Vec<&Finding> = of_ladder(findings, ladder).collect();
            let values: Vec<f64> = own.iter().map(|f| rung(f.number).value).collect();
            let right: Vec<&&Finding> = own.iter().filter(|f| f.cause.is_none()).collect();
            let wrong = own.iter().zip(&values);
            let others = wrong.filter_map(|(f, v)| Some(format!("{v:e}: {}", f.cause?)));
            let mut lost: Vec<(&str, usize)> = Vec::new();
            for trial in own
                .iter()
                .flat_map(|f| &f.trials)
                .filter(|t| t.cause.is_some())
            {
                match lost.iter_mut().find(|l| l.0 == trial.method) {
                    Some(known) => known.1 += 1,
                    None => lost.push((&trial.method, 1)),
                }
            }
            let lost: Vec<String> = lost.iter().map(|(name, n)| format!("{name} {n}")).collect();
            let error = |f: &&Finding| f.error.unwrap_or(0.0);
            let steps = |f: &&Finding| f.trials.first().map_or(0, |t| t.iterations);
            Some(LadderRow {
                ladder: ladder.name.clone(),
                parameter: ladder.parameter.clone(),
                range: extremes(&values)?,
                rungs: own.len(),
                right: right.len(),
                others: others.collect::<Vec<_>>().join("; "),
                error: right.iter().map(|f| error(f)).fold(0.0, f64::max),
                iterations: right.iter().map(|f| steps(f)).max().unwrap_or(0),
                lost: lost.join(", "),
            })
        });
    rows.collect()
}

fn extremes(values: &[f64]) -> Option<[f64; 2]> {
    let least = values.iter().copied().reduce(f64::min)?;
    let largest = values.iter().copied().reduce(f64::max)?;
    Some([least, largest])
}

/// Every option of a method that has findings.
pub fn of_options(findings: &[Finding]) -> Vec<OptionRow> {
    let all = ladders();
    let rows = all.iter().filter_map(|ladder| {
        let method = ladder.method?;
        let option = ladder.name.split(' ').nth(1)?;
        let mut rungs: Vec<(f64, &Trial)> = of_ladder(findings, ladder)
            .filter_map(|f| Some((rung(f.number).value, own(f, true)?)))
            .collect();
        rungs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let default = rungs.iter().position(|r| r.1.method == method)?;
        let done = |k: &usize| rungs[*k].1.cause.is_none();
        let low = (0..=default).rev().take_while(done).last();
        let high = (default..rungs.len()).take_while(done).last();
        let value = |k: Option<usize>| k.map_or(f64::NAN, |k| rungs[k].0);
        let few = rungs.iter().filter(|r| r.1.cause.is_none());
        let few = few.min_by_key(|r| r.1.iterations);
        Some(OptionRow {
            method,
            option: option.into(),
            default: rungs[default].0,
            tried: [rungs[0].0, rungs[rungs.len() - 1].0],
            safe: [value(low), value(high)],
            iterations: rungs[default].1.iterations,
            fewest: few.map_or((0, f64::NAN), |r| (r.1.iterations, r.0)),
        })
    });
    rows.collect()
}

/// An option of a method over its decades.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Method.
    pub method: &'static str,
    /// Name of the option.
    pub option: String,
    /// Its default.
    pub default: f64,
    /// Iterations at the default.
    pub iterations: usize,
    /// Values with iterations; none where the method did not do what it is for.
    pub steps: Vec<(f64, Option<usize>)>,
}

/// A method on a ladder of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the ladder.
    pub ladder: String,
    /// Method.
    pub method: String,
    /// Values with iterations; none where the method did not do what it is for.
    pub steps: Vec<(f64, Option<usize>)>,
}

fn steps(trial: &Trial) -> Option<usize> {
    trial.cause.is_none().then_some(trial.iterations)
}

/// Every option of a method that has findings.
pub fn windows(findings: &[Finding]) -> Vec<Window> {
    let rows = of_options(findings).into_iter().map(|row| {
        let name = format!("{} {}", row.method, row.option);
        let all = findings.iter().filter(|f| f.family == Family::Ladder);
        let all = all.filter(|f| f.category == name);
        let step = |f: &Finding| Some((rung(f.number).value, steps(own(f, true)?)));
        Window {
            method: row.method,
            option: row.option,
            default: row.default,
            iterations: row.iterations,
            steps: all.filter_map(step).collect(),
        }
    });
    rows.collect()
}

/// Every method on every ladder of a scene that has findings.
pub fn curves(findings: &[Finding]) -> Vec<Curve> {
    let mut found: Vec<Curve> = Vec::new();
    for ladder in ladders().iter().filter(|l| l.method.is_none()) {
        for finding in of_ladder(findings, ladder) {
            let value = rung(finding.number).value;
            for trial in &finding.trials {
                let step = (value, steps(trial));
                let known = found
                    .iter_mut()
                    .find(|c| c.ladder == ladder.name && c.method == trial.method);
                match known {
                    Some(curve) => curve.steps.push(step),
                    None => found.push(Curve {
                        ladder: ladder.name.clone(),
                        method: trial.method.clone(),
                        steps: vec![step],
                    }),
                }
            }
        }
    }
    found
}
