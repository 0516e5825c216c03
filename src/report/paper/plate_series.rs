//! The plate over one parameter: penalty error against the stiffness, reaction against the cell width.

use std::cmp::Ordering;

use crate::report::csv::{self, Row};
use crate::report::number::{fixed, residual, significant, value};
use crate::report::tables::{self, Align, Column, Table};
use crate::report::{Bundle, ReportError};
use crate::run::verdict::Verdict;
use crate::studies::paper::plate_series::{LimitRow, PenaltyRow, RefinementRow};

impl Row for PenaltyRow {
    const FILE: &'static str = "penalty.csv";
    const COLUMNS: &'static [&'static str] = &[
        "friction",
        "parameter",
        "reaction_mn_per_m",
        "relative_error",
        "max_penetration_m",
        "natural_map",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            value(self.friction),
            value(self.parameter),
            value(self.reaction_mn_per_m),
            significant(self.relative_error, 3),
            significant(self.max_penetration_m, 3),
            residual(self.natural_map),
            Verdict::or_not_run(self.verdict.as_ref()),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let friction = self.friction.total_cmp(&other.friction);
        friction.then(self.parameter.total_cmp(&other.parameter))
    }
}

impl Row for RefinementRow {
    const FILE: &'static str = "refinement.csv";
    const COLUMNS: &'static [&'static str] = &[
        "family",
        "mesh",
        "h_m",
        "friction",
        "dofs",
        "reaction_mn_per_m",
        "verdict",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            self.family.clone(),
            self.mesh.clone(),
            value(self.h_m),
            value(self.friction),
            self.dofs.to_string(),
            value(self.reaction_mn_per_m),
            self.verdict.to_string(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let family = self.family.cmp(&other.family);
        family
            .then(self.friction.total_cmp(&other.friction))
            .then(other.h_m.total_cmp(&self.h_m))
    }
}

impl Row for LimitRow {
    const FILE: &'static str = "limits.csv";
    const COLUMNS: &'static [&'static str] = &[
        "friction",
        "mesh_1_mn_per_m",
        "mesh_2_mn_per_m",
        "relative_gap",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        vec![
            value(self.friction),
            value(self.mesh_1_mn_per_m),
            value(self.mesh_2_mn_per_m),
            significant(self.relative_gap, 3),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        self.friction.total_cmp(&other.friction)
    }
}

/// Penalty errors for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn penalty_table(rows: &[PenaltyRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Penalty method, plate Mesh I: error against its parameter",
        vec![
            Column::new("friction", "", Align::Decimal),
            Column::new("k/ρ", "", Align::Right),
            Column::new("reaction", "MN/m", Align::Decimal),
            Column::new("rel. error", "", Align::Right),
            Column::new("max. penetration", "m", Align::Right),
            Column::new("natural map", "", Align::Right),
            Column::new("verdict", "", Align::Left),
        ],
    );
    for row in rows {
        table.push(vec![
            value(row.friction),
            format!("{:e}", row.parameter),
            fixed(row.reaction_mn_per_m, 4),
            significant(row.relative_error, 2),
            significant(row.max_penetration_m, 2),
            residual(row.natural_map),
            Verdict::or_not_run(row.verdict.as_ref()),
        ])?;
    }
    Ok(table)
}

/// Refinement for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn refinement_table(rows: &[RefinementRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Plate under refinement: vertical reaction at the top",
        vec![
            Column::new("mesh", "", Align::Left),
            Column::new("cells", "", Align::Right),
            Column::new("h", "m", Align::Decimal),
            Column::new("unknowns", "", Align::Right),
            Column::new("friction", "", Align::Decimal),
            Column::new("reaction", "MN/m", Align::Decimal),
            Column::new("verdict", "", Align::Left),
        ],
    );
    for row in rows {
        table.push(vec![
            row.family.clone(),
            row.mesh.clone(),
            fixed(row.h_m, 4),
            row.dofs.to_string(),
            value(row.friction),
            fixed(row.reaction_mn_per_m, 3),
            row.verdict.to_string(),
        ])?;
    }
    Ok(table)
}

/// Limits for reading.
///
/// # Errors
/// Those of [`Table::push`].
pub fn limit_table(rows: &[LimitRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Plate, limits for h → 0 extrapolated from the two finest meshes",
        vec![
            Column::new("friction", "", Align::Decimal),
            Column::new("Mesh I", "MN/m", Align::Decimal),
            Column::new("Mesh II", "MN/m", Align::Decimal),
            Column::new("rel. gap", "", Align::Right),
        ],
    );
    for row in rows {
        table.push(vec![
            value(row.friction),
            fixed(row.mesh_1_mn_per_m, 2),
            fixed(row.mesh_2_mn_per_m, 2),
            significant(row.relative_gap, 2),
        ])?;
    }
    Ok(table)
}

/// Adds `penalty.csv`, `.md` and `.tex`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_penalty(bundle: &mut Bundle, rows: &[PenaltyRow]) -> Result<(), ReportError> {
    bundle.add(PenaltyRow::FILE, csv::file(rows)?)?;
    tables::add_readable(bundle, "penalty", &penalty_table(rows)?)
}

/// Adds `refinement.*` and `limits.*`; the figure of the converged reactions shows them.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_refinement(
    bundle: &mut Bundle,
    rows: &[RefinementRow],
    limits: &[LimitRow],
) -> Result<(), ReportError> {
    bundle.add(RefinementRow::FILE, csv::file(rows)?)?;
    tables::add_readable(bundle, "refinement", &refinement_table(rows)?)?;
    bundle.add(LimitRow::FILE, csv::file(limits)?)?;
    tables::add_readable(bundle, "limits", &limit_table(limits)?)
}
