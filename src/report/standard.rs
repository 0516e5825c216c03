//! The files that every command writes: CSV, summary tables, figures, fields, provenance.
//!
//! Profiles show the last increment of runs that did what they claim: solved the contact laws or, named as such, their own
//! approximate ones. A wrong answer never stands beside right ones; residual histories show every run. Names are made from the run's key, see [`stem`] and `stickslip show schema`.

use super::names::stem;
use super::number::value;
use super::tables::details::ExpectedNumber;
use super::tables::runs::RunRow;
use super::{Bundle, Provenance, ReportError, figures, table, vtu};
use crate::run::verdict::VerdictKind;
use crate::studies::results::Results;
use crate::studies::rows::RunKey;

/// Everything that one command writes, apart from the tables of the paper.
///
/// # Errors
/// Those of the parts; [`FolderError::Duplicate`](crate::files::bundle::FolderError::Duplicate) where two runs give the same file name.
pub fn bundle(results: &Results, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let (mut bundle, mut fields) = (Bundle::new(), Bundle::new());
    let (pictures, files) = rayon::join(
        || add_tables(&mut bundle, results).and_then(|()| add_figures(&mut bundle, results)),
        || add_fields(&mut fields, results, provenance),
    );
    pictures.and(files)?;
    bundle.append(fields)?;
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
    for fields in results.fields() {
        figures::fields::add(bundle, &fields)?;
    }
    let kinds = [&figures::profile::KIND, &figures::fields::KIND];
    for &increment in &results.pictured {
        let (own, mut pictures) = (results.until(increment), Bundle::new());
        figures::profile::add(&mut pictures, &own)?;
        for fields in own.fields() {
            figures::fields::add(&mut pictures, &fields)?;
        }
        for (name, picture) in pictures.files() {
            for end in kinds.map(|kind| kind.file.trim_start_matches('*')) {
                if let Some(own) = name.strip_suffix(end) {
                    bundle.add(format!("{own}.increment-{increment}{end}"), picture)?;
                }
            }
        }
    }
    Ok(())
}

/// Adds the tables of the runs.
///
/// # Errors
/// Those of [`table::add`].
pub fn add_tables(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    table::add(bundle, &runs(results), "")?;
    table::add(bundle, &results.increments(), "")?;
    table::add(bundle, &results.quantities(), "")?;
    table::add(bundle, &results.history(), "")?;
    let mut points = results.points();
    points.extend(results.exact_points());
    table::add(bundle, &points, "")?;
    table::add(bundle, &ExpectedNumber::of(&results.expectations), "")
}

/// The rows of `runs.csv`.
pub fn runs(results: &Results) -> Vec<RunRow<'_>> {
    results.records().map(RunRow).collect()
}

/// One line on the verdicts and expectations of all runs.
pub fn summary(results: &Results) -> String {
    let count = |kind| {
        let own = results.records();
        own.filter(|r| r.found.verdict.kind() == kind).count()
    };
    let stated = results.expectations.iter().filter(|e| e.as_stated());
    format!(
        "{} runs: {} solved, {} approximate, {} refused, {} failed; {} of {} expected numbers as stated",
        results.answers.len(),
        count(VerdictKind::Solved),
        count(VerdictKind::Approximate),
        count(VerdictKind::Refused),
        results.failures(),
        stated.count(),
        results.expectations.len()
    )
}

/// Adds `fields/<stem>.*.vtu` and `.pvd`.
///
/// # Errors
/// Those of [`vtu::add_fields`].
pub fn add_fields(
    bundle: &mut Bundle,
    results: &Results,
    provenance: &Provenance,
) -> Result<(), ReportError> {
    for fields in results.fields() {
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
        vtu::add_fields(bundle, "fields", &stem(&fields.key), &fields, &origin)?;
    }
    Ok(())
}
