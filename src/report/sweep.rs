//! Records of a sweep as tables and figures.
//!
//! Files that hold no times are the same on every machine: `cells.csv`, `increments.csv`, `deviations.csv`, `study.csv`,
//! `success.*`, `sensitivity.*`, `safe_windows.*`, `starts.*`. All others belong to the machine. Times stand beside honest verdicts only, see
//! [`published_times`](crate::studies::sweep::analysis::published_times).

use stickslip_methods::Tier;

use super::names::file_name;
use super::number::significant;
use super::table;
use super::tables::ranks::{AccuracyRow, PointRow, ProfileRow, RankingRow};
use super::tables::sensitivity::{SensitivityRow, WindowRow};
use super::tables::sweep::{
    CellRow, DeviationRow, IncrementRow, SummaryRow, TimeRow, compare_cells,
};
use super::{Bundle, Provenance, ReportError, figures};
use crate::run::verdict::Verdict;
use crate::studies::exchange::collection::{FamilyRun, ProblemRow, by_family, family};
use crate::studies::exchange::problem_file::Size;
use crate::studies::sweep::analysis::accuracy::{refinements, sequences};
use crate::studies::sweep::analysis::costs::Costs;
use crate::studies::sweep::analysis::profile::performance;
use crate::studies::sweep::analysis::ranking::ranking;
use crate::studies::sweep::analysis::scaling::growth;
use crate::studies::sweep::analysis::sensitivity::{starts, sweeps};
use crate::studies::sweep::analysis::series::{Series, series};
use crate::studies::sweep::analysis::success::success;
use crate::studies::sweep::analysis::test_set::TestSet;
use crate::studies::sweep::analysis::{problem_names, problems};
use crate::studies::sweep::cell::Problem;
use crate::studies::sweep::record::{Record, SCHEMA};

/// Files of a sweep; `total`: cells that the sweep has in all. Paths have no common folder.
///
/// # Errors
/// Those of the parts.
pub fn bundle(
    records: &[Record],
    total: usize,
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let caveat = match records.len() {
        found if found < total => format!("; incomplete, {found} of {total} cells"),
        _ => String::new(),
    };
    let sets = Tier::ALL.map(|tier| TestSet::new(records, tier));
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &numbers(records, total, &sets), "")?;
    add_cells(&mut bundle, records)?;
    add_files(&mut bundle, records, &caveat)?;
    table::add(&mut bundle, &success(records), &caveat)?;
    add_sensitivity(&mut bundle, records, &caveat)?;
    let starts = starts(records);
    if !starts.is_empty() {
        table::add(&mut bundle, &starts, &caveat)?;
    }
    table::add(&mut bundle, &profiles(&sets), "")?;
    table::add(&mut bundle, &rankings(&sets), &caveat)?;
    table::add(&mut bundle, &growth(records), &caveat)?;
    table::add(&mut bundle, &curves(records), "")?;
    let meshes = refinements(records);
    let errors = meshes
        .iter()
        .flat_map(|one| one.errors.iter().map(AccuracyRow));
    table::add(&mut bundle, &errors.collect::<Vec<_>>(), "")?;
    figures::fastest::add(&mut bundle, &sets, &caveat)?;
    figures::scaling::add(&mut bundle, records, &caveat)?;
    figures::performance::add(&mut bundle, "", &sets, &caveat)?;
    figures::work_precision::add(&mut bundle, records, &caveat)?;
    figures::time_to_accuracy::add(&mut bundle, records, &caveat)?;
    figures::stages::add(&mut bundle, records, &caveat)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// The study in numbers.
fn numbers(records: &[Record], total: usize, sets: &[TestSet<'_>]) -> Vec<SummaryRow> {
    let row = |quantity: String, value| SummaryRow { quantity, value };
    let mut rows = vec![
        row("cells".into(), records.len()),
        row("cells_of_the_sweep".into(), total),
        row("problems".into(), problems(records).len()),
        row("schema".into(), SCHEMA as usize),
    ];
    for set in sets {
        let tier = set.tier;
        rows.push(row(format!("problems_compared_{tier}"), set.problems.len()));
        rows.push(row(format!("problems_left_out_{tier}"), set.left_out));
    }
    rows
}

/// Adds `safe_windows.*`, `sensitivity.*` and its figure, where options were swept.
fn add_sensitivity(
    bundle: &mut Bundle,
    records: &[Record],
    caveat: &str,
) -> Result<(), ReportError> {
    let sweeps = sweeps(records);
    if sweeps.is_empty() {
        return Ok(());
    }
    table::add(bundle, &WindowRow::of(&sweeps), caveat)?;
    let rows: Vec<SensitivityRow> = sweeps.iter().flat_map(SensitivityRow::of).collect();
    table::add(bundle, &rows, caveat)?;
    figures::sensitivity::add(bundle, &sweeps, caveat)
}

/// What a paper would print of the options that were swept, a sentence each.
pub fn sensitivity_sentences(records: &[Record]) -> Vec<String> {
    let sweeps = sweeps(records);
    let rows = WindowRow::of(&sweeps);
    rows.iter().map(WindowRow::sentence).collect()
}

/// Adds `cells.csv`, `increments.csv`, `deviations.csv` and `times.csv`.
fn add_cells(bundle: &mut Bundle, records: &[Record]) -> Result<(), ReportError> {
    let cells: Vec<CellRow> = records.iter().map(CellRow).collect();
    table::add(bundle, &cells, "")?;
    let increments = records.iter().flat_map(IncrementRow::of);
    table::add(bundle, &increments.collect::<Vec<_>>(), "")?;
    // A quantity without exact value says something only beside that of another mesh.
    let refined: Vec<Problem> = sequences(records).into_iter().flatten().collect();
    let deviations = records.iter().flat_map(|record| {
        let several = refined.contains(&record.cell.problem());
        DeviationRow::of(record).filter(move |row| several || row.is_exact())
    });
    table::add(bundle, &deviations.collect::<Vec<_>>(), "")?;
    let times: Vec<TimeRow> = records.iter().filter_map(TimeRow::of).collect();
    table::add(bundle, &times, "")
}

/// Adds `problems.csv`, `families.csv` and a performance profile per family, where problems come from files.
fn add_files(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let mut own: Vec<&Record> = records.iter().filter(|r| r.cell.is_from_file()).collect();
    own.sort_by(|a, b| compare_cells(a, b));
    let same = |a: &&Record, b: &&Record| a.cell.problem() == b.cell.problem();
    let rows: Vec<ProblemRow> = own.chunk_by(same).map(problem_row).collect();
    table::add(bundle, &rows, caveat)?;
    let runs = own.iter().map(|record| FamilyRun {
        problem: &record.cell.case,
        accuracy: significant(record.cell.tolerance, 2),
        method: &record.found.method,
        verdict: &record.found.verdict,
        iterations: record.found.sum(|i| i.iterations),
    });
    let mut families = by_family(runs);
    // Stable: methods stay in their order.
    families.sort_by(|a, b| (&a.family, &a.accuracy).cmp(&(&b.family, &b.accuracy)));
    table::add(bundle, &families, caveat)?;
    let mut names: Vec<&str> = families.iter().map(|row| row.family.as_str()).collect();
    names.dedup();
    for name in names {
        let members = own
            .iter()
            .filter(|record| family(&record.cell.case) == name);
        let members: Vec<Record> = members.map(|record| (*record).clone()).collect();
        let sets = Tier::ALL.map(|tier| TestSet::new(&members, tier));
        figures::performance::add(bundle, &format!("{}.", file_name(&[name])), &sets, caveat)?;
    }
    Ok(())
}

/// What the cells on one problem file say of it.
fn problem_row(own: &[&Record]) -> ProblemRow {
    let size = own.iter().find_map(|record| {
        let size = record.found.problem.as_ref()?;
        Some(Size {
            dim: size.dim,
            points: size.points,
            operator: size.operator.clone()?,
        })
    });
    ProblemRow {
        problem: own[0].cell.case.clone(),
        found: size.ok_or_else(|| match &own[0].found.verdict {
            Verdict::Refused(reason) => reason.clone(),
            other => other.to_string(),
        }),
    }
}

/// Steps of the performance profiles, tier after tier.
fn profiles(sets: &[TestSet<'_>]) -> Vec<ProfileRow> {
    let mut rows = Vec::new();
    for set in sets {
        let costs = Costs::new(set);
        for curve in performance(&costs) {
            rows.extend(curve.steps.iter().map(|step| ProfileRow {
                tier: set.tier,
                method: curve.method.to_owned(),
                step: *step,
                problems: costs.problems(),
            }));
        }
    }
    rows
}

/// Methods by mean time, tier after tier.
fn rankings(sets: &[TestSet<'_>]) -> Vec<RankingRow> {
    let of = |set| Some((set, ranking(&Costs::new(set))?));
    let all = sets.iter().filter_map(of);
    all.flat_map(|(set, own): (&TestSet<'_>, _)| RankingRow::of(set.tier, &own))
        .collect()
}

/// Points of all curves of solver error against work.
fn curves(records: &[Record]) -> Vec<PointRow<'_>> {
    let all = problems(records);
    let mut rows = Vec::new();
    for (problem, name) in all.iter().zip(problem_names(&all)) {
        for own in series(records, problem) {
            let Series { label, swept, .. } = own;
            rows.extend(own.points.into_iter().map(|point| PointRow {
                problem: name.clone(),
                label: label.clone(),
                swept: swept.clone(),
                exact: own.exact,
                point,
            }));
        }
    }
    rows
}

#[cfg(test)]
mod tests;
