//! What was spent: the stages of every cell whose times may be shown, and their shares as bars.

use super::records::SweepRecords;
use crate::report::number::{significant, value};
use crate::report::plot::{Bar, Stacked, italic, stacked};
use crate::report::standard::file_name;
use crate::report::tables::sweep::{STAGES, TimeRow};
use crate::report::{Bundle, ReportError, table};
use crate::run::verdict::Verdict;
use crate::studies::sweep::analysis::{
    body_times, common_tolerance, compare_methods, compare_problems, has_defaults,
};

/// Adds `times.csv` and the figures of the stages.
pub fn add(bundle: &mut Bundle, sweep: &SweepRecords<'_>) -> Result<(), ReportError> {
    let rows: Vec<TimeRow> = sweep.sorted().into_iter().filter_map(TimeRow::of).collect();
    table::add(bundle, &rows, "")?;
    add_figures(bundle, &rows, sweep)
}

/// A figure per case, contact space and friction on several meshes: a bar per mesh by the fastest right method, then a bar per method on the
/// finest mesh, all at the finest tolerance at which something was solved on every mesh.
fn add_figures(
    bundle: &mut Bundle,
    rows: &[TimeRow<'_>],
    sweep: &SweepRecords<'_>,
) -> Result<(), ReportError> {
    let solved = |row: &&TimeRow| {
        row.record.found.verdict == Verdict::Solved && has_defaults(&row.record.cell)
    };
    let mut own: Vec<&TimeRow> = rows.iter().filter(solved).collect();
    let problem = |row: &TimeRow| row.record.cell.problem().without_mesh();
    own.sort_by(|a, b| {
        compare_problems(&problem(a), &problem(b))
            .then(a.record.cell.refine.cmp(&b.record.cell.refine))
            .then_with(|| compare_methods(&a.record.cell.method, &b.record.cell.method))
    });
    let mut names: Vec<String> = Vec::new();
    for group in own.chunk_by(|a, b| problem(a) == problem(b)) {
        if group.first().map(|row| row.record.cell.refine)
            == group.last().map(|row| row.record.cell.refine)
        {
            continue;
        }
        let on_mesh = |rows: &[&TimeRow]| rows.iter().map(|r| r.record.cell.tolerance).collect();
        let meshes = group.chunk_by(|a, b| a.record.cell.refine == b.record.cell.refine);
        let tolerance = common_tolerance(&meshes.map(on_mesh).collect::<Vec<_>>());
        let mut group = group.to_vec();
        group.retain(|row| Some(row.record.cell.tolerance) == tolerance);
        let Some(first) = group.first() else { continue };
        let cell = &first.record.cell;
        let space = cell.space.as_deref().unwrap_or("own");
        let friction = value(cell.mu());
        let mut stem = file_name(&["stages", &cell.case, space, &format!("mu-{friction}")]);
        if names.contains(&stem) {
            stem = format!("{stem}-{}", names.len());
        }
        names.push(stem.clone());
        let svg = stacked(&figure(&group, sweep))?;
        bundle.add(format!("figures/{stem}.svg"), svg)?;
    }
    Ok(())
}

fn figure(group: &[&TimeRow<'_>], sweep: &SweepRecords<'_>) -> Stacked {
    let cell = &group[0].record.cell;
    let same_mesh =
        |a: &&TimeRow<'_>, b: &&TimeRow<'_>| a.record.cell.refine == b.record.cell.refine;
    let meshes: Vec<&[&TimeRow]> = group.chunk_by(same_mesh).collect();
    let own = |row: &TimeRow| row.method().median_s;
    let fastest = meshes.iter().filter_map(|rows| {
        let best = rows.iter().min_by(|a, b| own(a).total_cmp(&own(b)))?;
        let mesh = best.record.found.problem.as_ref().map(|p| p.mesh.as_str());
        let label = format!("{}, {}", mesh.unwrap_or("?"), best.record.found.method);
        Some(bar(best, label, sweep))
    });
    let mut groups = vec![(
        "each mesh, least median of all methods".to_owned(),
        fastest.collect(),
    )];
    if let Some(finest) = meshes.last() {
        let bars = finest
            .iter()
            .map(|row| bar(row, row.record.found.method.clone(), sweep));
        groups.push(("finest mesh, each method".to_owned(), bars.collect()));
    }
    let space = group[0].record.found.problem.as_ref();
    let space = space.map_or("", |p| p.space.as_str());
    Stacked {
        title: format!("Stages of a run: {}", cell.case),
        caption: format!(
            "{}, {space}, {} = {}, solved to a natural map of {}{}\nshares from 8 % on are printed, total time at the right",
            cell.case,
            italic("μ"),
            value(cell.mu()),
            value(cell.tolerance),
            sweep.caveat(),
        ),
        scale: "share of the total time [%]".into(),
        parts: STAGES.map(str::to_owned).into(),
        groups,
    }
}

fn bar(row: &TimeRow<'_>, label: String, sweep: &SweepRecords<'_>) -> Bar {
    let mut values = row.stages();
    if let Some(body) = body_times(row.record, sweep.records) {
        values[..3].copy_from_slice(&body);
    }
    Bar {
        label,
        values: values.into(),
        note: format!("{} s", significant(values.iter().sum(), 3)),
    }
}
