//! The files that every command writes: CSV, summary tables, figures, fields, provenance.
//!
//! Profiles show the last increment of runs that did what they claim: solved the contact laws or, named as such, their own
//! approximate ones. A wrong answer never stands beside right ones; residual histories show every run. Names are made from the run's key, see [`stem`] and `docs/schema.md`.

use super::number::{residual, significant, time, value};
use super::tables::{Align, Column, Table};
use super::{Bundle, Provenance, ReportError, csv, figures, tables, vtu};
use crate::run::record::{
    ExpectRow, MET, MISSED_AS_DOCUMENTED, Results, RunFields, RunKey, RunRow,
};
use crate::run::verdict::{Verdict, VerdictKind};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Everything that one command writes, apart from the tables of the paper.
///
/// # Errors
/// Those of the parts; [`FolderError::Duplicate`](crate::files::bundle::FolderError::Duplicate) where two runs give the same file name.
pub fn bundle(results: &Results, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    csv::add_to(&mut bundle, results)?;
    tables::add_readable(&mut bundle, "runs", &runs_table(&results.runs)?)?;
    if !results.expectations.is_empty() {
        let table = expectations_table(&results.expectations)?;
        tables::add_readable(&mut bundle, "expectations", &table)?;
    }
    figures::residual::add(&mut bundle, results)?;
    figures::profile::add(&mut bundle, results)?;
    figures::friction_loop::add(&mut bundle, results)?;
    for fields in &results.fields {
        add_fields(&mut bundle, fields, provenance)?;
    }
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
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

/// Summary of the runs for reading: last increment of each run.
///
/// # Errors
/// Those of [`Table::push`].
pub fn runs_table(rows: &[RunRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Runs, last increment",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("mesh", "", Align::Left),
            Column::new("space", "", Align::Left),
            Column::new("method", "", Align::Left),
            Column::new("μ", "", Align::Decimal),
            Column::new("increment", "", Align::Right),
            Column::new("tier", "", Align::Left),
            Column::new("verdict", "", Align::Left),
            Column::new("natural map", "", Align::Right),
            Column::new("iterations", "", Align::Right),
            Column::new("factorisations", "", Align::Right),
            Column::new("solves", "", Align::Right),
            Column::new("points", "", Align::Right),
            Column::new("solve", "s", Align::Right),
        ],
    );
    let mut sorted: Vec<&RunRow> = rows.iter().collect();
    sorted.sort_by(|a, b| csv::compare_keys(&a.key, &b.key).then_with(|| a.tier.cmp(&b.tier)));
    let last = last_increments(rows.iter().map(|row| &row.key));
    for row in sorted.into_iter().filter(|row| is_last(&last, &row.key)) {
        // A time is published only beside a right answer.
        let solve = if row.verdict == Verdict::Solved {
            time(row.solve_s)
        } else {
            "–".into()
        };
        table.push(vec![
            row.key.case.clone(),
            row.key.mesh.clone(),
            row.key.space.clone(),
            row.key.method.clone(),
            value(row.key.friction),
            row.key.increment.to_string(),
            row.tier.clone(),
            row.verdict.to_string(),
            residual(row.natural_map),
            row.iterations.to_string(),
            row.factorisations.to_string(),
            row.solves.to_string(),
            row.points.to_string(),
            solve,
        ])?;
    }
    Ok(table)
}

/// Expected and found quantities for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn expectations_table(rows: &[ExpectRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Expected and found",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("mesh", "", Align::Left),
            Column::new("method", "", Align::Left),
            Column::new("μ", "", Align::Decimal),
            Column::new("quantity", "", Align::Left),
            Column::new("expected", "", Align::Right),
            Column::new("found", "", Align::Right),
            Column::new("difference", "", Align::Right),
            Column::new("allowed", "", Align::Right),
            Column::new("unit", "", Align::Left),
            Column::new("kind", "", Align::Left),
            Column::new("source", "", Align::Left),
            Column::new("verdict", "", Align::Left),
        ],
    );
    let mut sorted: Vec<&ExpectRow> = rows.iter().collect();
    sorted.sort_by(|a, b| csv::compare_keys(&a.key, &b.key).then_with(|| csv::Row::order(*a, *b)));
    for row in sorted {
        let quantity = [&row.quantity, &row.at, &row.component];
        let quantity = quantity
            .map(String::as_str)
            .into_iter()
            .filter(|part| !part.is_empty());
        table.push(vec![
            row.key.case.clone(),
            row.key.mesh.clone(),
            row.key.method.clone(),
            value(row.key.friction),
            quantity.collect::<Vec<_>>().join(" "),
            value(row.expected),
            value(row.found),
            significant(row.found - row.expected, 3),
            significant(row.allowed, 3),
            row.unit.clone(),
            row.kind.clone(),
            row.source.clone(),
            row.verdict.clone(),
        ])?;
    }
    Ok(table)
}

/// Expected numbers by case, for a terminal.
///
/// # Errors
/// Those of [`Table::push`].
pub fn expectation_summary(rows: &[ExpectRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Expected numbers, all exact methods",
        vec![
            Column::new("case", "", Align::Left),
            Column::new("numbers", "", Align::Right),
            Column::new("met", "", Align::Right),
            Column::new("missed as documented", "", Align::Right),
            Column::new("worst met, of its tolerance", "", Align::Right),
        ],
    );
    let cases: BTreeSet<&str> = rows.iter().map(|row| row.key.case.as_str()).collect();
    for case in cases {
        let own = || rows.iter().filter(move |row| row.key.case == case);
        let count = |verdict: &str| own().filter(|row| row.verdict == verdict).count();
        let worst = own()
            .filter(|row| row.verdict == MET)
            .map(|row| (row.found - row.expected).abs() / row.allowed)
            .fold(0.0, f64::max);
        table.push(vec![
            case.to_owned(),
            own().count().to_string(),
            count(MET).to_string(),
            count(MISSED_AS_DOCUMENTED).to_string(),
            format!("{worst:.1e}"),
        ])?;
    }
    Ok(table)
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

    figures::fields::add(bundle, fields)
}
