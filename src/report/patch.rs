//! The patch tests of contact spaces: every error, and for reading the worst over all distances of the crack from a node.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::csv::{self, Row};
use super::number::{significant, value};
use super::tables::{self, Align, Column, Table};
use super::{Bundle, ReportError};
use crate::studies::spaces::patch::{Loaded, PASSED, PatchRow, State};

/// Significant digits of errors.
const DIGITS: usize = 3;

/// An error; rounding is 0, so that the same table comes out on every machine.
fn error(x: f64) -> String {
    significant(if x <= PASSED { 0.0 } else { x }, DIGITS)
}

fn verdict(passed: bool) -> &'static str {
    if passed { "pass" } else { "fail" }
}

impl Row for PatchRow {
    const FILE: &'static str = "patch.csv";
    const COLUMNS: &'static [&'static str] = &[
        "patch",
        "boundary",
        "dimension",
        "crack",
        "mesh",
        "distance",
        "space",
        "points",
        "run",
        "traction_error",
        "displacement_error",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let PatchRow {
            state,
            loaded,
            dimension,
            crack,
            mesh,
            distance,
            space,
            points,
            verdict: run,
            traction,
            displacement,
        } = self;
        vec![
            state.name().into(),
            loaded.name().into(),
            dimension.to_string(),
            crack.clone(),
            mesh.clone(),
            value(*distance),
            space.clone(),
            points.to_string(),
            // The place in a case file that nobody has says nothing.
            run.to_string()
                .lines()
                .next()
                .unwrap_or_default()
                .to_owned(),
            error(*traction),
            error(*displacement),
            verdict(self.passed()).into(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let key = |row: &Self| (row.dimension, row.state, row.loaded);
        key(self)
            .cmp(&key(other))
            .then_with(|| (&self.crack, &self.mesh).cmp(&(&other.crack, &other.mesh)))
            .then_with(|| other.distance.total_cmp(&self.distance))
            .then_with(|| self.space.cmp(&other.space))
    }
}

/// What the rows of the readable table are gathered by.
type Group<'a> = (usize, State, Loaded, &'a str, &'a str, &'a str);

/// The worst of every patch test over all distances.
///
/// # Errors
/// Those of [`Table::push`].
pub fn table(rows: &[PatchRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        format!(
            "Patch tests: largest errors over all distances of the crack from a node; pass: at most {PASSED:e}, \
             shown as 0"
        ),
        vec![
            Column::new("patch", "", Align::Left),
            Column::new("boundary", "", Align::Left),
            Column::new("dim", "", Align::Right),
            Column::new("crack", "", Align::Left),
            Column::new("mesh", "", Align::Left),
            Column::new("space", "", Align::Left),
            Column::new("traction error", "", Align::Right),
            Column::new("displacement error", "", Align::Right),
            Column::new("passed", "", Align::Right),
            Column::new("without answer", "", Align::Right),
            Column::new("verdict", "", Align::Left),
        ],
    );
    let mut groups: BTreeMap<Group<'_>, Vec<&PatchRow>> = BTreeMap::new();
    for row in rows {
        let group = (
            row.dimension,
            row.state,
            row.loaded,
            row.crack.as_str(),
            row.mesh.as_str(),
            row.space.as_str(),
        );
        groups.entry(group).or_default().push(row);
    }
    for ((dimension, state, loaded, crack, mesh, space), own) in groups {
        // `max` drops NaN: runs without an answer are counted on their own.
        let worst = |f: fn(&PatchRow) -> f64| own.iter().map(|r| f(r)).fold(f64::NAN, f64::max);
        let shown = |x: f64| {
            if x.is_nan() {
                "–".to_owned()
            } else {
                error(x)
            }
        };
        let passed = own.iter().filter(|r| r.passed()).count();
        let silent = own.iter().filter(|r| r.traction.is_nan()).count();
        table.push(vec![
            state.name().into(),
            loaded.name().into(),
            dimension.to_string(),
            crack.into(),
            mesh.into(),
            space.into(),
            shown(worst(|r| r.traction)),
            shown(worst(|r| r.displacement)),
            format!("{passed}/{}", own.len()),
            silent.to_string(),
            verdict(passed == own.len()).into(),
        ])?;
    }
    Ok(table)
}

/// Adds `patch.csv`, `patch.md` and `patch.tex`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_to(bundle: &mut Bundle, rows: &[PatchRow]) -> Result<(), ReportError> {
    bundle.add(PatchRow::FILE, csv::file(rows)?)?;
    tables::add_readable(bundle, "patch", &table(rows)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::verdict::Verdict;

    fn row(distance: f64, space: &str, traction: f64) -> PatchRow {
        PatchRow {
            state: State::Stick,
            loaded: Loaded::Displacement,
            dimension: 2,
            crack: "27°".into(),
            mesh: "regular".into(),
            distance,
            space: space.into(),
            points: 5,
            verdict: Verdict::Refused("no\n  at a place".into()),
            traction,
            displacement: 1e-15,
        }
    }

    #[test]
    fn the_table_shows_the_worst_and_counts_what_has_no_answer() {
        let rows = [
            row(0.1, "star", 3e-12),
            row(0.0, "star", 2e-14),
            row(0.1, "facet", 0.25),
            row(0.0, "facet", f64::NAN),
        ];
        assert!(rows[0].passed() && !rows[2].passed() && !rows[3].passed());
        let mut bundle = Bundle::new();
        add_to(&mut bundle, &rows).unwrap();
        let text = |name| String::from_utf8(bundle.get(name).unwrap().to_vec()).unwrap();
        let csv = text("patch.csv");
        assert!(csv.contains("stick,displacement,2,27°,regular,0.1,star,5,refused: no,0,0,pass"));
        assert!(csv.contains("stick,displacement,2,27°,regular,0,facet,5,refused: no,NaN,0,fail"));
        let markdown = text("patch.md");
        let line = |space: &str| {
            let found = markdown.lines().find(|l| l.contains(space));
            found
                .unwrap()
                .split('|')
                .map(str::trim)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        let facet = line("facet");
        assert_eq!(facet[7..12], ["0.25", "0", "0/2", "1", "fail"]);
        let star = line("star");
        assert_eq!(star[7..12], ["0", "0", "2/2", "0", "pass"]);
        assert!(text("patch.tex").contains("tab:patch"));
    }
}
