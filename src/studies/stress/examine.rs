//! Runs a scene by every method, and judges what comes back.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use super::finding::{Cause, Change, Finding, Trial};
use super::referee::{Patch, compare, uncovered};
use super::scene::Scene;
use super::transform::Transform;
use crate::case::{self, Case};
use crate::model::quantities::PointState;
use crate::run::choice::Choice;
use crate::run::record::{Results, RunRow};
use crate::run::registry::methods;
use crate::run::run_case::{Fields, Quiet, RunError, Settings, run_case};
use crate::run::verdict::Verdict;
use stickslip_methods::Status;

/// Name of the file, as errors tell it.
pub const FILE: &str = "scene.toml";

/// The method that is to solve every scene with one solution.
pub const DEFAULT: &str = "hybrid";

/// Error of the energy identity that is rounding, in a body whose forces hold to 1e-12.
const ENERGY: f64 = 1e-8;

/// Change of contact forces by a transformation that is rounding; the table counts digits by it.
pub const INVARIANT: f64 = 1e-9;

/// Change of energy that the error of the mesh may make.
const CHOSEN: f64 = 0.02;

/// Quantities whose change measures how far two answers are apart.
const ENERGIES: [&str; 2] = ["strain_energy", "dissipation"];

/// Two answers that differ by more are two.
const DIFFERENT: f64 = 1e-6;

/// A method that stopped within this many times its tolerance stopped at rounding.
const FLOOR: f64 = 1e3;

/// How many transformations a solid is put through: its set-up takes a second.
const OF_SOLIDS: usize = 2;

/// How much is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Every method and the transformations.
    All,
    /// The default method on the scene as it is.
    Default,
}

/// Runs a scene and judges it.
pub fn examine(scene: &Scene, effort: Effort) -> Finding {
    let clock = Instant::now();
    let caught = catch_unwind(AssertUnwindSafe(|| look(scene, effort)));
    let mut finding = caught.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        ended(scene, Cause::Panic, text.unwrap_or("of unknown kind"))
    });
    finding.seconds = clock.elapsed().as_secs_f64();
    finding
}

/// A finding on a scene without an answer.
pub fn ended(scene: &Scene, cause: Cause, reason: &str) -> Finding {
    let line = reason.lines().next().unwrap_or_default();
    Finding {
        family: scene.family,
        number: scene.number,
        category: scene.category.clone(),
        cause: Some(cause),
        reason: line.chars().take(300).collect(),
        error: None,
        cells: 0,
        points: 0,
        friction: 0.0,
        sway: None,
        uniform_stress: None,
        overlap: None,
        disagreement: None,
        invariance: Vec::new(),
        trials: Vec::new(),
        seconds: 0.0,
        minimal: None,
    }
}

fn default_method() -> Vec<Choice> {
    Choice::parse(DEFAULT).into_iter().collect()
}

/// All methods, the default one first: its fields are looked at.
fn all_methods() -> Vec<Choice> {
    let others = methods()
        .iter()
        .map(|m| m.name)
        .filter(|name| *name != DEFAULT);
    let all = std::iter::once(DEFAULT).chain(others);
    all.filter_map(|name| Choice::parse(name).ok()).collect()
}

fn run(case: &Case, choices: &[Choice]) -> Result<Results, RunError> {
    let settings = Settings {
        tier: None,
        jobs: 1,
        fields: Fields::First,
    };
    run_case(case, choices, settings, &Quiet)
}

fn look(scene: &Scene, effort: Effort) -> Finding {
    let choices = match effort {
        Effort::All => all_methods(),
        Effort::Default => default_method(),
    };
    let parsed = case::parse(FILE, scene.text.as_str());
    let solved = parsed
        .map_err(RunError::from)
        .and_then(|case| Ok((run(&case, &choices)?, case)));
    let (results, case) = match solved {
        Ok(found) => found,
        Err(error) => return refused(scene, &error.to_string()),
    };
    let points = |method: &str| -> Vec<PointState> {
        let own = results.points.iter().filter(|p| p.key.method == method);
        own.map(|row| row.point.clone()).collect()
    };
    let quantity = |name: &str| {
        let mut own = results
            .quantities
            .iter()
            .filter(|q| q.key.method == DEFAULT);
        let row = own.find(|q| q.quantity.name == name && q.quantity.at.is_empty());
        row.map(|q| q.quantity.value)
    };
    let Some(main) = results.runs.iter().find(|row| row.key.method == DEFAULT) else {
        return ended(scene, Cause::NoPlace, "no run of the default method");
    };
    let mut trials: Vec<Trial> = results
        .runs
        .iter()
        .map(|row| trial(row, &results))
        .collect();
    let base = points(DEFAULT);
    let disagreement = disagreement(&trials, &base, points);
    if disagreement.is_some_and(|d| d > DIFFERENT) {
        // Where several answers hold a method may find another one, or none.
        for trial in trials.iter_mut().filter(|t| t.cause > Some(Cause::Beyond)) {
            trial.cause = Some(Cause::SeveralSolutions);
        }
    }
    let mut finding = Finding {
        cause: None,
        reason: String::new(),
        cells: cells_of(&main.key.mesh),
        points: main.points,
        friction: main.key.friction,
        sway: Some(main.sway),
        uniform_stress: Some(main.uniform_stress),
        disagreement,
        overlap: (main.reference_jump_m > 0.0).then(|| main.overlap_m / main.reference_jump_m),
        ..ended(scene, Cause::Panic, "")
    };
    let mut seen: Vec<(Cause, String)> = Vec::new();
    let solved = main.verdict == Verdict::Solved;
    if let Verdict::Suspect(reason) = &main.verdict {
        seen.push((Cause::SuspectMesh, reason.clone()));
    } else if let Verdict::Crashed(reason) = &main.verdict {
        seen.push((Cause::Factorisation, reason.clone()));
    }
    for own in trials.iter().filter(|t| t.verdict == Verdict::FalseClaim) {
        seen.push((Cause::FalseClaim, own.method.clone()));
    }
    if let Some(cause) = trials[0].cause.filter(|c| *c > Cause::Beyond) {
        seen.push((cause, format!("{DEFAULT}: {}", main.verdict)));
    }
    if solved && scene.family.sticks() {
        let (faults, error, remark) = held(&case, &results);
        (finding.error, finding.reason) = (Some(error), remark);
        if !faults.is_empty() {
            seen.push((Cause::WrongPatch, faults.join("; ")));
        }
    } else if solved {
        let error = quantity("energy_identity").unwrap_or(f64::NAN).abs();
        finding.error = Some(error);
        if error.is_nan() || error > ENERGY {
            seen.push((
                Cause::WrongEnergy,
                format!("energy identity off by {error:.1e}"),
            ));
        }
    }
    // A different answer of several is no change by the transformation.
    let one = disagreement.is_none_or(|d| d <= DIFFERENT);
    if effort == Effort::All && solved && seen.is_empty() && one {
        let energies = ENERGIES.map(|name| quantity(name).unwrap_or(0.0));
        finding.invariance = invariance(scene, &case, &base, energies);
        for change in finding.invariance.iter().filter(|c| !kept(c)) {
            let (name, energy) = (&change.transformation, change.energy);
            let force = (change.force).map_or("other points".into(), |f| format!("forces {f:.1e}"));
            seen.push((
                Cause::NotInvariant,
                format!("{name}: {force}, energy {energy:.1e}"),
            ));
        }
    }
    finding.trials = trials;
    if let Some((cause, reason)) = seen.into_iter().min_by_key(|s| s.0) {
        (finding.cause, finding.reason) = (Some(cause), reason);
    }
    finding
}

/// A case without runs: refused at a place in its file, or an error.
fn refused(scene: &Scene, error: &str) -> Finding {
    let cause = match (has_place(error), scene.beyond) {
        (true, true) => Cause::Beyond,
        (true, false) => Cause::Refused,
        (false, _) => Cause::NoPlace,
    };
    ended(scene, cause, error)
}

/// Whether an error says `file:line:column:`.
fn has_place(error: &str) -> bool {
    let mut parts = error.split(':').map(str::trim);
    let number = |part: Option<&str>| part.is_some_and(|p| p.parse::<usize>().is_ok_and(|n| n > 0));
    parts.next() == Some(FILE) && number(parts.next()) && number(parts.next())
}

/// What differs from the closed form, as the default method has it, the largest error, and which cracks act in part only.
fn held(case: &Case, results: &Results) -> (Vec<String>, f64, String) {
    let Some(patch) = Patch::of(case) else {
        return (vec!["no closed form".into()], f64::NAN, String::new());
    };
    let own = Results {
        quantities: of_default(&results.quantities, |q| &q.key.method),
        points: of_default(&results.points, |p| &p.key.method),
        fields: results.fields.clone(),
        ..Results::default()
    };
    let (faults, error) = compare(&patch, &own);
    (faults, error, uncovered(&patch, &own))
}

fn of_default<T: Clone>(rows: &[T], method: impl Fn(&T) -> &String) -> Vec<T> {
    let own = rows.iter().filter(|row| method(row) == DEFAULT);
    own.cloned().collect()
}

/// One method: whether it did what it is for, and else why not.
fn trial(row: &RunRow, results: &Results) -> Trial {
    let own = results.history.iter().filter(|h| h.key == row.key);
    let history: Vec<f64> = own.map(|h| h.violation).collect();
    let exact = methods().iter().find(|m| m.name == row.key.method);
    let exact = exact.is_some_and(|m| m.exact);
    let cause = match &row.verdict {
        Verdict::Solved | Verdict::Suspect(_) => None,
        Verdict::Approximate(_) if !exact => None,
        Verdict::Approximate(_) | Verdict::GaveUp(_) => Some(gave_up(row, &history)),
        Verdict::FalseClaim => Some(Cause::FalseClaim),
        Verdict::Refused(_) => Some(Cause::Declined),
        Verdict::Crashed(_) => Some(Cause::Factorisation),
        Verdict::TimedOut => Some(Cause::Time),
        Verdict::OutOfMemory => Some(Cause::Memory),
    };
    Trial {
        method: row.key.method.clone(),
        exact,
        verdict: row.verdict.clone(),
        iterations: row.iterations,
        violation: row.violation.is_finite().then_some(row.violation),
        cause,
    }
}

/// Why a method ended without a claim, from how it ended and how it went.
fn gave_up(row: &RunRow, history: &[f64]) -> Cause {
    /// Tolerance of the scenes.
    const ASKED: f64 = 1e-12;
    match row.verdict {
        Verdict::GaveUp(Status::SingularTangent | Status::Mechanism) => Cause::SingularTangent,
        Verdict::GaveUp(Status::Diverged) => Cause::Diverged,
        _ if row.violation <= FLOOR * ASKED => Cause::Floor,
        _ if period(history).is_some() => Cause::Cycling,
        _ if still_falls(history) => Cause::Slow,
        _ => Cause::Stalled,
    }
}

/// After how many iterations the violation repeats, at the end of a history.
fn period(history: &[f64]) -> Option<usize> {
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    (2..=12).find(|&p| {
        let tail = 3 * p;
        history.len() > tail && {
            let last = &history[history.len() - tail..];
            let moves = last.windows(2).any(|w| !same(w[0], w[1]));
            moves && (p..tail).all(|i| same(last[i], last[i - p]))
        }
    })
}

/// Whether the violation was halved at least over the last half of a history.
fn still_falls(history: &[f64]) -> bool {
    let n = history.len();
    n >= 4 && history[n - 1] < 0.5 * history[n / 2]
}

/// Largest difference of contact forces between exact methods that solved the scene.
fn disagreement(
    trials: &[Trial],
    base: &[PointState],
    points: impl Fn(&str) -> Vec<PointState>,
) -> Option<f64> {
    let size = base.iter().map(magnitude).fold(0.0, f64::max);
    let solved = trials
        .iter()
        .filter(|t| t.exact && t.verdict == Verdict::Solved && t.method != DEFAULT);
    let of = |t: &Trial| {
        let other = points(&t.method);
        let away = |(p, q): (&PointState, &PointState)| {
            let d = [p.p_n - q.p_n, p.p_a - q.p_a, p.p_b - q.p_b];
            d.iter().map(|v| v * v).sum::<f64>().sqrt()
        };
        let largest = base.iter().zip(&other).map(away).fold(0.0, f64::max);
        if size > 0.0 { largest / size } else { 0.0 }
    };
    solved.map(of).reduce(f64::max)
}

fn magnitude(p: &PointState) -> f64 {
    p.p_n.hypot(p.p_a).hypot(p.p_b)
}

/// Whether a change is rounding; by transformations that are not exact, whether it is below the error of the mesh.
fn kept(change: &Change) -> bool {
    if change.exact {
        change.force.is_some_and(|f| f <= INVARIANT) && change.energy <= INVARIANT
    } else {
        change.energy <= CHOSEN
    }
}

/// Change by every transformation that applies to the case; `energies`: strain energy and dissipation.
fn invariance(scene: &Scene, case: &Case, base: &[PointState], energies: [f64; 2]) -> Vec<Change> {
    let all = Transform::ALL;
    let chosen: Vec<Transform> = if scene.family.dim() == 2 {
        all.to_vec()
    } else {
        let first = scene.number as usize * OF_SOLIDS;
        (0..OF_SOLIDS)
            .map(|k| all[(first + k) % all.len()])
            .collect()
    };
    let default = default_method();
    let mut found = Vec::new();
    for transform in chosen {
        let Some(text) = transform.apply(&scene.text) else {
            continue;
        };
        let changed = case::parse(FILE, text).map_err(RunError::from);
        let results = changed.and_then(|case| run(&case, &default));
        let refused = results.as_ref().is_err_and(|e| has_place(&e.to_string()));
        let suspect = |r: &RunRow| matches!(r.verdict, Verdict::Suspect(_));
        let doubted = results.as_ref().is_ok_and(|r| r.runs.iter().any(suspect));
        // Other contact points may be too few of them; and where the judge has doubts nothing is claimed.
        if refused && !transform.is_exact() || doubted {
            continue;
        }
        // Another verdict is the largest change there is.
        let (mut force, mut energy) = (None, 1.0);
        if let Ok(results) = results
            && results.runs.iter().all(|r| r.verdict == Verdict::Solved)
        {
            let factor = transform.energy(scene.family.dim());
            let away = |(name, before): (&str, f64)| {
                let mut own = results.quantities.iter().map(|row| &row.quantity);
                let after = own.find(|q| q.name == name && q.at.is_empty());
                after.map_or(f64::MAX, |q| (q.value / factor - before).abs())
            };
            let total = energies[0].abs() + energies[1].abs();
            energy = ENERGIES.into_iter().zip(energies).map(away).sum::<f64>() / total;
            let other: Vec<PointState> = results.points.into_iter().map(|row| row.point).collect();
            force = change(&transform, scene, case.cracks.len(), base, &other);
        }
        found.push(Change {
            transformation: transform.name(),
            exact: transform.is_exact(),
            force,
            energy: if energy.is_finite() { energy } else { 1.0 },
        });
    }
    found
}

/// Largest change of pressure and shear over the contact points, over the largest force; none where the points are others.
fn change(
    transform: &Transform,
    scene: &Scene,
    cracks: usize,
    base: &[PointState],
    other: &[PointState],
) -> Option<f64> {
    /// Points closer than this part of the weight of one are the same.
    const SAME: f64 = 1e-3;
    let dim = scene.family.dim();
    let size = base.iter().map(magnitude).fold(0.0, f64::max);
    if base.len() != other.len() {
        return None;
    }
    if size == 0.0 {
        return Some(other.iter().map(magnitude).fold(0.0, f64::max).min(1.0));
    }
    let places = transform.places(&scene.text)?;
    let shear = |p: &PointState| p.p_a.hypot(p.p_b);
    let mut largest: f64 = 0.0;
    for p in base {
        let x = places.point([p.x_m, p.y_m, p.z_m]);
        let crack = transform.crack(p.crack, cracks);
        let away = |q: &&PointState| {
            let d = [q.x_m - x[0], q.y_m - x[1], q.z_m - x[2]];
            d.iter().map(|v| v * v).sum::<f64>().sqrt()
        };
        let own = other.iter().filter(|q| q.crack == crack);
        let q = own.min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let width = p.weight.powf(1.0 / (dim as f64 - 1.0)) * transform.length();
        if away(&q) > SAME * width {
            return None;
        }
        let factor = transform.force(dim);
        let normal = (q.p_n / factor - p.p_n).abs();
        largest = largest.max(normal.max((shear(q) / factor - shear(p)).abs()) / size);
    }
    Some(largest)
}

/// Cells of a mesh by its label.
fn cells_of(label: &str) -> usize {
    let axes = label.split('x').map(|n| n.parse::<usize>().unwrap_or(0));
    axes.product()
}
