//! Runs a scene by every method, and judges what comes back.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use stickslip_methods::{PointStatus, Status};

use super::finding::{Cause, Finding, Trial};
use super::invariance::Base;
use super::referee::{Patch, compare, uncovered};
use super::scene::Scene;
use super::transform::Transform;
use super::trial::trial;
use super::truth::Truth;
use crate::case::{self, Case};
use crate::model::quantities::PointState;
use crate::run::choice::Choice;
use crate::run::record::{Results, RunRow};
use crate::run::registry::methods;
use crate::run::run_case::{Fields, Quiet, RunError, Settings, friction_values, run_case};
use crate::run::verdict::Verdict;

/// Name of the file, as errors tell it.
pub const FILE: &str = "scene.toml";

/// The method that is to solve every scene with one solution.
pub const DEFAULT: &str = "hybrid";

/// Error of the energy identity that is rounding, in a body whose forces hold to 1e-12.
const ENERGY: f64 = 1e-8;

/// Two answers that differ by more are two.
const DIFFERENT: f64 = 1e-6;

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
        dimension: scene.dim,
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

pub(super) fn default_method() -> Vec<Choice> {
    Choice::parse(DEFAULT).into_iter().collect()
}

/// The default method first, whose fields are looked at, and those of some labels.
fn and_others<'a>(labels: impl Iterator<Item = &'a str>) -> Vec<Choice> {
    let mut all = default_method();
    let others = labels.filter_map(|label| Choice::parse(label).ok());
    all.extend(others.filter(|choice| choice.label != DEFAULT));
    all
}

pub(super) fn run(case: &Case, choices: &[Choice]) -> Result<Results, RunError> {
    let settings = Settings {
        tier: None,
        jobs: 1,
        fields: Fields::First,
        starts: 1,
    };
    run_case(case, choices, settings, &Quiet)
}

fn look(scene: &Scene, effort: Effort) -> Finding {
    let choices = match effort {
        Effort::All if scene.methods.is_empty() => and_others(methods().iter().map(|m| m.name)),
        Effort::All => and_others(scene.methods.iter().map(String::as_str)),
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
    let quantity = |name: &str| {
        let own = results.quantities.iter();
        let mut own = own.filter(|q| q.key.method == DEFAULT && q.quantity.at.is_empty());
        let row = own.rfind(|q| q.quantity.name == name);
        row.map(|q| q.quantity.value)
    };
    // Of an answer to several increments the worst counts.
    let increments = results.runs.chunk_by(|a, b| a.key.method == b.key.method);
    let worst = |own: &[RunRow]| own.iter().max_by_key(|row| row.verdict.rank()).cloned();
    let rows: Vec<RunRow> = increments.filter_map(worst).collect();
    let Some(main) = rows.iter().find(|row| row.key.method == DEFAULT) else {
        return ended(scene, Cause::NoPlace, "no run of the default method");
    };
    let mut trials: Vec<Trial> = rows.iter().map(|row| trial(row, &results)).collect();
    let base = points_of(&results, DEFAULT);
    let disagreement = disagreement(&trials, &base, &results);
    if disagreement.is_some_and(|d| d > DIFFERENT) {
        // Where several answers hold a method may find another one, or none.
        for trial in trials.iter_mut().filter(|t| t.cause > Some(Cause::Beyond)) {
            trial.cause = Some(Cause::SeveralSolutions);
        }
    }
    let missed = |t: &Trial| t.cause > Some(Cause::NoEquilibrium);
    if trials.iter().filter(|t| t.exact).all(missed) && is_at_limit(&case) {
        for trial in trials.iter_mut().filter(|t| missed(t)) {
            trial.cause = Some(Cause::FrictionLimit);
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
    let solved = main.verdict.is_solved();
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
    let jumps = ["max_gap", "max_slip"].map(|name| quantity(name).unwrap_or(0.0));
    let jump = jumps.into_iter().fold(main.reference_jump_m, f64::max);
    let answer = Base::new(scene, &case, &base, quantity, jump);
    match &scene.truth {
        _ if !solved => {}
        Truth::Uniform => {
            let (faults, error, remark) = held(&case, &results);
            (finding.error, finding.reason) = (Some(error), remark);
            if !faults.is_empty() {
                let cause = match is_rounding(scene, error) {
                    true => Cause::Floor,
                    false => Cause::WrongPatch,
                };
                seen.push((cause, faults.join("; ")));
            }
        }
        Truth::Energy if !answer.has_energy() => {}
        Truth::Energy => {
            let identity = quantity("energy_identity").unwrap_or(f64::NAN).abs();
            let dissipation = quantity("dissipation").unwrap_or(f64::NAN);
            let friction = answer.relative(dissipation - friction_work(&case, &results));
            // NaN is the larger.
            let error = if identity >= friction || identity.is_nan() {
                identity
            } else {
                friction
            };
            finding.error = Some(error);
            if error.is_nan() || error > ENERGY {
                let reason = format!("energy identity or friction off by {error:.1e}");
                seen.push((Cause::WrongEnergy, reason));
            }
        }
        Truth::Case(text) => finding.error = away(&base, text),
    }
    // A different answer of several is no change by the transformation.
    let one = disagreement.is_none_or(|d| d <= DIFFERENT);
    if effort == Effort::All && scene.family.is_random() && solved && seen.is_empty() && one {
        finding.invariance = answer.changes();
        if let Some(reason) = answer.not_kept(&finding.invariance) {
            seen.push((Cause::NotInvariant, reason));
        }
    }
    finding.trials = trials;
    if let Some((cause, reason)) = seen.into_iter().min_by_key(|s| s.0) {
        (finding.cause, finding.reason) = (Some(cause), reason);
    }
    finding
}

/// Whether a little less friction bears the load no more, as a certificate proves.
///
/// The certificate is that of limit analysis: no force at all within the cones of friction balances the load. Slip that does
/// not open asks for more than such forces (Coulomb's law is not associated), so answers end above the friction at which the
/// forces do.
fn is_at_limit(case: &Case) -> bool {
    /// By so much less: a body of three planes has forces from 0.96 of its friction on, and answers from 1.03.
    const LESS: f64 = 0.9;
    let mut weaker = case.clone();
    for crack in &mut weaker.cracks {
        crack.friction *= LESS;
    }
    let results = Choice::parse("interior-point").map(|choice| run(&weaker, &[choice]));
    let none = Verdict::GaveUp(Status::NoEquilibrium);
    results.is_ok_and(|own| own.is_ok_and(|r| r.runs.iter().any(|row| row.verdict == none)))
}

/// ½ Σ μ (P_n⁰ + P_n¹) |Δd| over all increments and slipping points of the default method: what friction took.
fn friction_work(case: &Case, results: &Results) -> f64 {
    let friction = &friction_values(case)[0];
    let own = results.points.iter().filter(|p| p.key.method == DEFAULT);
    let own: Vec<_> = own.map(|row| (row.key.increment, &row.point)).collect();
    let mut before = vec![[0.0; 3]; own.len()];
    let mut work = 0.0;
    for points in own.chunk_by(|a, b| a.0 == b.0) {
        for ((increment, p), start) in points.iter().zip(&mut before) {
            let now = [p.p_n.max(0.0), p.slip_a_m, p.slip_b_m];
            let slip = (now[1] - start[1]).hypot(now[2] - start[2]);
            if p.status == PointStatus::Slip.as_str() && *increment > 0 {
                work += 0.5 * friction[p.crack - 1] * (start[0] + now[0]) * slip;
            }
            *start = now;
        }
    }
    work
}

/// Contact points of a method at the end.
fn points_of(results: &Results, method: &str) -> Vec<PointState> {
    let own = results.points.iter().filter(|p| p.key.method == method);
    let last = own.clone().map(|p| p.key.increment).max();
    let own = own.filter(|p| Some(p.key.increment) == last);
    own.map(|row| row.point.clone()).collect()
}

/// Largest difference to the contact forces of another case, over the largest.
fn away(base: &[PointState], text: &str) -> Option<f64> {
    let case = case::parse(FILE, text).ok()?;
    let other = points_of(&run(&case, &default_method()).ok()?, DEFAULT);
    (other.len() == base.len()).then(|| difference(base, &other))
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
pub(super) fn has_place(error: &str) -> bool {
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

/// Whether an error is rounding that the body amplifies: small, and another one in other units. One of the program stays
/// as it is, whatever the last digits of the case.
fn is_rounding(scene: &Scene, error: f64) -> bool {
    /// Largest error of answers that hold six digits.
    const SMALL: f64 = 1e-6;
    /// Part of an error by which it differs if it is rounding.
    const APART: f64 = 0.1;
    let in_unit = |factor: f64| {
        let text = Transform::Length(factor).apply(&scene.text)?;
        let case = case::parse(FILE, text).ok()?;
        Some(held(&case, &run(&case, &default_method()).ok()?).1)
    };
    let others: Option<Vec<f64>> = [39.37, 0.3048, 7.0].into_iter().map(in_unit).collect();
    others.is_some_and(|mut errors| {
        errors.push(error);
        errors.sort_by(f64::total_cmp);
        let (least, largest) = (errors[0], errors[errors.len() - 1]);
        largest <= SMALL && largest - least > APART * largest
    })
}

fn of_default<T: Clone>(rows: &[T], method: impl Fn(&T) -> &String) -> Vec<T> {
    let own = rows.iter().filter(|row| method(row) == DEFAULT);
    own.cloned().collect()
}

/// Largest difference of contact forces between exact methods that solved the scene.
fn disagreement(trials: &[Trial], base: &[PointState], results: &Results) -> Option<f64> {
    let solved = trials
        .iter()
        .filter(|t| t.exact && t.verdict.is_solved() && t.method != DEFAULT);
    let of = |t: &Trial| difference(base, &points_of(results, &t.method));
    solved.map(of).reduce(f64::max)
}

/// Largest difference of contact forces at the same points, over the largest.
fn difference(base: &[PointState], other: &[PointState]) -> f64 {
    let size = base.iter().map(magnitude).fold(0.0, f64::max);
    let away = |(p, q): (&PointState, &PointState)| {
        let d = [p.p_n - q.p_n, p.p_a - q.p_a, p.p_b - q.p_b];
        d.iter().map(|v| v * v).sum::<f64>().sqrt()
    };
    let largest = base.iter().zip(other).map(away).fold(0.0, f64::max);
    if size > 0.0 { largest / size } else { 0.0 }
}

pub(super) fn magnitude(p: &PointState) -> f64 {
    p.p_n.hypot(p.p_a).hypot(p.p_b)
}

/// Cells of a mesh by its label.
fn cells_of(label: &str) -> usize {
    let axes = label.split('x').map(|n| n.parse::<usize>().unwrap_or(0));
    axes.product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::stress::scene::Family;

    fn scene(family: Family, number: u64, text: String) -> Scene {
        let truth = match family {
            Family::Patch2d => Truth::Uniform,
            _ => Truth::Energy,
        };
        Scene {
            family,
            number,
            category: "planted".into(),
            dim: 2,
            text,
            truth,
            methods: Vec::new(),
            beyond: false,
        }
    }

    /// A crack along the diagonal of a body whose upper side is held ends at the corner of the support. Moved by a
    /// thousand sizes the file states it 1e-12 of a cell beside the corner; the piece below must not hang on the node.
    #[test]
    fn a_crack_that_ends_where_a_support_ends_does_so_wherever_the_body_lies() {
        let text = "title = \"t\"\nmodel = \"plane-stress\"\ntolerance = 1e-12\n\
                    material = { young_pa = 54.559785694589685, poisson = 0.06620393066179478 }\n\
                    mesh = { box = { min_m = [-0.20204568588666033, -0.0762717981933992], \
                    max_m = [0.11854454230143646, 0.45804524878676217], cells = [6, 10] } }\n\
                    [[crack]]\npoints_m = [[-0.843226142262854, -1.1449058921537218], \
                    [0.75972499867763, 1.5266793427470848]]\nfriction = 0.5451060469186785\n\
                    [[support]]\non = \"bottom\"\ndisplacement_m = [0, 0]\n\
                    [[support]]\non = \"top\"\n\
                    displacement_m = [5.614076928936276e-5, -6.423364087246463e-5]\n";
        let far = Transform::Shift(1e3);
        let turn = (0..)
            .find(|n| {
                Transform::ALL[n * 4 % Transform::ALL.len()..]
                    .iter()
                    .take(4)
                    .any(|t| *t == far)
            })
            .unwrap_or(0usize);
        let found = examine(
            &scene(Family::Slip2d, turn as u64, text.into()),
            Effort::All,
        );
        let moved = found.invariance.iter();
        let mut moved = moved.filter(|c| c.transformation == far.name());
        let change = moved.next().map(|c| (c.force.unwrap_or(1.0), c.energy));
        assert!(
            change.is_some_and(|(force, energy)| force < 1e-9 && energy < 1e-9),
            "{:?}",
            found.invariance
        );
    }

    /// Source: Coulomb. A crack whose friction is a ten-millionth below what sticking asks for slips by as little: an error
    /// of 1e-9 to 1e-6 that is the same in every unit, and no rounding.
    #[test]
    fn a_small_error_that_no_unit_changes_is_not_taken_for_rounding() {
        let [p, q] = [2.0_f64, 1.0];
        // n = (−3, 4)/5 on a crack along (4, 3): |τ| / σ_n.
        let (n, t) = ([-0.6, 0.8], [0.8, 0.6]);
        let (pressure, shear) = (
            p * n[0] * n[0] + q * n[1] * n[1],
            p * n[0] * t[0] + q * n[1] * t[1],
        );
        let friction = (shear / pressure).abs() * (1.0 - 1e-7);
        let text = format!(
            "title = \"t\"\nmodel = \"plane-strain\"\ntolerance = 1e-12\n\
             material = {{ young_pa = 1000, poisson = 0.3 }}\n\
             mesh = {{ box = {{ min_m = [0, 0], max_m = [4, 4], cells = [9, 9] }} }}\n\
             [[crack]]\npoints_m = [[1, 1.1], [3, 2.6]]\nfriction = {friction:?}\ntip = \"none\"\n\
             [[support]]\non = \"left\"\ndisplacement_m = [0, \"free\"]\n\
             [[support]]\non = \"bottom\"\ndisplacement_m = [\"free\", 0]\n\
             [[load]]\non = \"right\"\npressure_pa = {p:?}\n\
             [[load]]\non = \"top\"\npressure_pa = {q:?}\n"
        );
        let found = examine(&scene(Family::Patch2d, 0, text), Effort::Default);
        let error = found.error.unwrap();
        assert!((1e-9..1e-6).contains(&error), "{error:e}");
        assert_eq!(found.cause, Some(Cause::WrongPatch), "{}", found.reason);
    }
}
