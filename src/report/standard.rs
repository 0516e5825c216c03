//! The files that every command writes: CSV, summary tables, figures, fields, provenance.
//!
//! Profiles show the last increment of runs that did what they claim: solved the contact laws or, named as such, their own
//! approximate ones. A wrong answer never stands beside right ones; residual histories show every run. Names are made from the run's key, see [`stem`] and `docs/schema.md`.

use super::number::value;
use super::plot::{self, Axis3, Magnification, Tier};
use super::tables::runs::ExpectSummary;
use super::{Bundle, Provenance, ReportError, loops, table, vtu};
use crate::run::record::{HistoryRow, PointRow, Results, RunFields, RunKey, RunRow};
use crate::run::verdict::VerdictKind;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Everything that one command writes, apart from the tables of the paper.
///
/// # Errors
/// Those of the parts; [`FolderError::Duplicate`](crate::files::bundle::FolderError::Duplicate) where two runs give the same file name.
pub fn bundle(results: &Results, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    add_tables(&mut bundle, results)?;
    add_residuals(&mut bundle, results)?;
    add_profiles(&mut bundle, results)?;
    loops::add_to(&mut bundle, results)?;
    for fields in &results.fields {
        add_fields(&mut bundle, fields, provenance)?;
    }
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// Adds the tables of the runs.
///
/// # Errors
/// Those of [`table::add`].
pub fn add_tables(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    table::add(bundle, &results.runs, "")?;
    table::add(bundle, &results.quantities, "")?;
    table::add(bundle, &results.history, "")?;
    table::add(bundle, &results.points, "")?;
    table::add(bundle, &results.exact, "")?;
    table::add(bundle, &results.expectations, "")?;
    table::add(bundle, &ExpectSummary::of(&results.expectations), "")
}

/// Writes [`bundle`] into `dir`, all files or none.
///
/// # Errors
/// Those of [`bundle`] and [`Bundle::commit`].
pub fn write(dir: &Path, results: &Results, provenance: &Provenance) -> Result<(), ReportError> {
    Ok(bundle(results, provenance)?.commit(dir)?)
}

/// File name part for a run without its increment: `case.mesh.space.method.mu-0.1`, other characters than letters,
/// digits, `.`, `-`, `_` and `=` replaced by `-`.
pub fn stem(key: &RunKey) -> String {
    let friction = value(key.friction);
    file_name(&[
        &key.case,
        &key.mesh,
        &key.space,
        &key.method,
        &format!("mu-{friction}"),
    ])
}

pub(super) fn file_name(parts: &[&str]) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "._-=".contains(c);
    let clean = |c: char| if allowed(c) { c } else { '-' };
    parts.join(".").chars().map(clean).collect()
}

/// The last increment of every run.
pub fn last_runs(rows: &[RunRow]) -> Vec<RunRow> {
    let last = last_increments(rows.iter().map(|row| &row.key));
    let rows = rows.iter().filter(|row| is_last(&last, &row.key));
    rows.cloned().collect()
}

/// One line on the verdicts and expectations of all runs.
pub fn summary(results: &Results) -> String {
    let count = |kind| {
        results
            .runs
            .iter()
            .filter(|r| r.verdict.kind() == kind)
            .count()
    };
    let stated = results.expectations.iter().filter(|e| e.as_stated());
    format!(
        "{} increments: {} solved, {} approximate, {} refused, {} failed; {} of {} expected numbers as stated",
        results.runs.len(),
        count(VerdictKind::Solved),
        count(VerdictKind::Approximate),
        count(VerdictKind::Refused),
        results.failures(),
        stated.count(),
        results.expectations.len()
    )
}

/// What identifies a run without its increment; the friction as printed, so that it can be compared.
type RunName = (String, String, String, String, String);

fn run_name(key: &RunKey) -> RunName {
    let friction = value(key.friction);
    (
        key.case.clone(),
        key.mesh.clone(),
        key.space.clone(),
        key.method.clone(),
        friction,
    )
}

fn last_increments<'a>(keys: impl Iterator<Item = &'a RunKey>) -> BTreeMap<RunName, usize> {
    let mut last = BTreeMap::new();
    for key in keys {
        let increment = last.entry(run_name(key)).or_insert(key.increment);
        *increment = key.increment.max(*increment);
    }
    last
}

fn is_last(last: &BTreeMap<RunName, usize>, key: &RunKey) -> bool {
    last.get(&run_name(key)) == Some(&key.increment)
}

/// `figures/<case>.<mesh>.<space>.mu-<friction>.residual.svg`: all methods on one problem.
fn add_residuals(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    let last = last_increments(results.history.iter().map(|row| &row.key));
    let mut figures: BTreeMap<String, Vec<HistoryRow>> = BTreeMap::new();
    for row in results
        .history
        .iter()
        .filter(|row| is_last(&last, &row.key))
    {
        figures
            .entry(problem_name(&row.key))
            .or_default()
            .push(row.clone());
    }
    let tiers: BTreeSet<&str> = results.runs.iter().map(|row| row.tier.as_str()).collect();
    let tier = match tiers.into_iter().collect::<Vec<_>>()[..] {
        [tier] => Tier::named(tier),
        _ => None,
    };
    for (name, rows) in figures {
        if rows.iter().any(|row| row.natural_map.is_finite()) {
            let svg = plot::residual_history(&rows, tier.as_ref())?;
            bundle.add(format!("figures/{name}.residual.svg"), svg)?;
        }
    }
    Ok(())
}

/// `figures/….crack-<n>.traction.svg` and `….slip.svg`: per problem all methods, and all friction values by the first
/// method that has several, which is an exact one where there is any: the others would show the same.
fn add_profiles(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    let last = last_increments(results.points.iter().map(|row| &row.key));
    let right: BTreeSet<(RunName, usize)> = results
        .runs
        .iter()
        .filter(|row| row.verdict.is_honest())
        .map(|row| (run_name(&row.key), row.key.increment))
        .collect();
    let mut problems: BTreeMap<(String, usize), Vec<PointRow>> = BTreeMap::new();
    // By case, mesh, space and crack, then by method in the order of the registry.
    type ByMethod<'a> = BTreeMap<(usize, &'a str), Vec<PointRow>>;
    let mut sweeps: BTreeMap<(String, usize), ByMethod<'_>> = BTreeMap::new();
    for row in &results.points {
        let plane = row.point.force_unit == "N/m";
        let wanted = plane && is_last(&last, &row.key);
        if wanted && right.contains(&(run_name(&row.key), row.key.increment)) {
            let RunKey {
                case,
                mesh,
                space,
                method,
                ..
            } = &row.key;
            problems
                .entry((problem_name(&row.key), row.point.crack))
                .or_default()
                .push(row.clone());
            let body = file_name(&[case, mesh, space]);
            let methods = sweeps.entry((body, row.point.crack)).or_default();
            let own = methods.entry((plot::method_rank(method), method));
            own.or_default().push(row.clone());
        }
    }
    let several = |rows: &Vec<PointRow>| {
        let frictions: BTreeSet<String> = rows.iter().map(|row| value(row.key.friction)).collect();
        frictions.len() > 1
    };
    let sweeps = sweeps.into_iter().filter_map(|((body, crack), methods)| {
        let ((_, method), rows) = methods.into_iter().find(|(_, rows)| several(rows))?;
        Some(((format!("{body}.{}", file_name(&[method])), crack), rows))
    });
    for ((name, crack), rows) in problems.into_iter().chain(sweeps) {
        let name = format!("figures/{name}.crack-{crack}");
        bundle.add(
            format!("{name}.traction.svg"),
            plot::contact_traction(&rows, &results.exact, crack)?,
        )?;
        bundle.add(
            format!("{name}.slip.svg"),
            plot::contact_slip(&rows, &results.exact, crack)?,
        )?;
    }
    Ok(())
}

/// File name part for the problem of a run, without its method: `case.mesh.space.mu-0.1`.
pub fn problem_name(key: &RunKey) -> String {
    let friction = format!("mu-{}", value(key.friction));
    file_name(&[&key.case, &key.mesh, &key.space, &friction])
}

/// `fields/<stem>.*.vtu` and `.pvd`, and the displacement figure of the last increment.
fn add_fields(
    bundle: &mut Bundle,
    fields: &RunFields,
    provenance: &Provenance,
) -> Result<(), ReportError> {
    let key = &fields.key;
    let stem = stem(key);
    let friction = value(key.friction);
    let RunKey {
        case,
        mesh,
        space,
        method,
        ..
    } = key;
    let run = format!("{case}, {mesh}, {space}, {method}");
    // The version, not the commit: an unchanged field stays an unchanged file.
    let origin = format!(
        "stickslip {}: {run}, friction {friction}",
        provenance.version
    );
    vtu::add_fields(bundle, "fields", &stem, fields, &origin)?;

    let Some(step) = fields.steps.last() else {
        return Ok(());
    };
    let caption = format!("{run}, μ = {friction}");
    let (body, magnified) = (&step.body, Magnification::Auto);
    let (displacement, stress) = match body.dim {
        2 => (
            plot::displacement_contours(body, magnified, &caption)?,
            plot::von_mises_contours(body, magnified, &caption)?,
        ),
        3 => (
            plot::solid_displacement(body, Axis3::Z, magnified, &caption)?,
            plot::solid_von_mises(body, magnified, &caption)?,
        ),
        _ => return Ok(()),
    };
    if body.dim == 3 && !step.crack.cells.is_empty() {
        let svg = plot::contact_status(step, magnified, &caption)?;
        bundle.add(format!("figures/{stem}.contact.svg"), svg)?;
    }
    bundle.add(format!("figures/{stem}.displacement.svg"), displacement)?;
    Ok(bundle.add(format!("figures/{stem}.von-mises.svg"), stress)?)
}
