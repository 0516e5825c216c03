//! The files that every command writes: CSV, summary tables, figures, fields, provenance.
//!
//! Profiles show the last increment of runs that did what they claim: solved the contact laws or, named as such, their own
//! approximate ones. A wrong answer never stands beside right ones; residual histories show every run. Names are made from the run's key, see [`stem`] and `docs/schema.md`.

use super::names::stem;
use super::number::value;
use super::tables::runs::ExpectSummary;
use super::{Bundle, Provenance, ReportError, figures, table, vtu};
use crate::run::verdict::VerdictKind;
use crate::studies::rows::{Results, RunFields, RunKey, RunRow};
use std::collections::BTreeMap;

/// Everything that one command writes, apart from the tables of the paper.
///
/// # Errors
/// Those of the parts; [`FolderError::Duplicate`](crate::files::bundle::FolderError::Duplicate) where two runs give the same file name.
pub fn bundle(results: &Results, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    add_tables(&mut bundle, results)?;
    add_figures(&mut bundle, results)?;
    add_fields(&mut bundle, &results.fields, provenance)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// Adds the figures of the runs.
///
/// # Errors
/// Those of the figures.
pub fn add_figures(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    figures::residual::add(bundle, results)?;
    figures::profile::add(bundle, results)?;
    figures::friction_loop::add(bundle, results)?;
    for fields in &results.fields {
        figures::fields::add(bundle, fields)?;
    }
    Ok(())
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
            .filter(|r| r.step.verdict.kind() == kind)
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

/// Adds `fields/<stem>.*.vtu` and `.pvd`.
///
/// # Errors
/// Those of [`vtu::add_fields`].
pub fn add_fields(
    bundle: &mut Bundle,
    all: &[RunFields],
    provenance: &Provenance,
) -> Result<(), ReportError> {
    for fields in all {
        let RunKey {
            case,
            mesh,
            space,
            method,
            friction,
            ..
        } = &fields.key;
        // The version, not the commit: an unchanged field stays an unchanged file.
        let origin = format!(
            "stickslip {}: {case}, {mesh}, {space}, {method}, friction {}",
            provenance.version,
            value(*friction)
        );
        vtu::add_fields(bundle, "fields", &stem(&fields.key), fields, &origin)?;
    }
    Ok(())
}
