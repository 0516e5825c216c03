//! Tables and figures of the two studies beside the paper's tables: penalty error and mesh refinement.

use std::cmp::Ordering;

use super::csv::{self, Row};
use super::number::{fixed, residual, significant, value};
use super::plot::{Curve, CurvePlot, error_plot};
use super::tables::{Align, Column, Table};
use super::{Bundle, ReportError, paper};
use crate::harness::verdict::Verdict;

/// Error of the penalty method for one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct PenaltyRow {
    /// Friction coefficient [-].
    pub friction: f64,
    /// k_n/ρ = k_t/ρ, stiffness in multiples of the natural scale [-].
    pub parameter: f64,
    /// Reaction at the top [MN/m].
    pub reaction_mn_per_m: f64,
    /// |reaction − exact| / |exact|, exact by the reference method on the same mesh [-].
    pub relative_error: f64,
    /// Largest penetration [m].
    pub max_penetration_m: f64,
    /// Natural map found by the judge [-].
    pub natural_map: f64,
    /// Claim × check; none where there is no such run.
    pub verdict: Option<Verdict>,
}

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

/// Reaction of the plate on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinementRow {
    /// Mesh of the paper: `I` or `II`.
    pub family: String,
    /// Mesh label.
    pub mesh: String,
    /// Cell width [m].
    pub h_m: f64,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Free unknowns.
    pub dofs: usize,
    /// Reaction at the top [MN/m].
    pub reaction_mn_per_m: f64,
    /// Claim × check.
    pub verdict: Verdict,
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

/// Limits of the reaction for h → 0.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitRow {
    /// Friction coefficient [-].
    pub friction: f64,
    /// Limit of Mesh I [MN/m].
    pub mesh_1_mn_per_m: f64,
    /// Limit of Mesh II [MN/m].
    pub mesh_2_mn_per_m: f64,
    /// |difference| / mean [-].
    pub relative_gap: f64,
}

impl LimitRow {
    /// A line with its gap computed.
    pub fn new(friction: f64, mesh_1_mn_per_m: f64, mesh_2_mn_per_m: f64) -> Self {
        let mean = 0.5 * (mesh_1_mn_per_m + mesh_2_mn_per_m);
        LimitRow {
            friction,
            mesh_1_mn_per_m,
            mesh_2_mn_per_m,
            relative_gap: ((mesh_1_mn_per_m - mesh_2_mn_per_m) / mean).abs(),
        }
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

/// Adds `penalty.csv`, `.md`, `.tex` and the figure of the error against the parameter.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figure.
pub fn add_penalty(bundle: &mut Bundle, rows: &[PenaltyRow]) -> Result<(), ReportError> {
    bundle.add(PenaltyRow::FILE, csv::file(rows)?)?;
    paper::add_readable(bundle, "penalty", &penalty_table(rows)?)?;
    let plot = CurvePlot {
        caption: "plate, Mesh I, penalty method".into(),
        x_label: "penalty stiffness / natural scale".into(),
        y_label: "relative error of the reaction".into(),
        curves: curves(
            rows,
            |r| (r.friction, String::new()),
            |r| [r.parameter, r.relative_error],
        ),
    };
    bundle.add("figures/penalty.svg", error_plot(&plot, Some(-1.0))?)
}

/// Adds `refinement.*`, `limits.*` and the figure of the distance from the common limit.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figure.
pub fn add_refinement(
    bundle: &mut Bundle,
    rows: &[RefinementRow],
    limits: &[LimitRow],
) -> Result<(), ReportError> {
    bundle.add(RefinementRow::FILE, csv::file(rows)?)?;
    paper::add_readable(bundle, "refinement", &refinement_table(rows)?)?;
    bundle.add(LimitRow::FILE, csv::file(limits)?)?;
    paper::add_readable(bundle, "limits", &limit_table(limits)?)?;
    let distance = |r: &RefinementRow| {
        let limit = limits.iter().find(|l| l.friction == r.friction);
        let mean = limit.map_or(f64::NAN, |l| 0.5 * (l.mesh_1_mn_per_m + l.mesh_2_mn_per_m));
        [r.h_m, ((r.reaction_mn_per_m - mean) / mean).abs()]
    };
    let plot = CurvePlot {
        caption: "plate, b-newton, edge pairs".into(),
        x_label: "cell width h [m]".into(),
        y_label: "relative distance to limit".into(),
        curves: curves(
            rows,
            |r| (r.friction, format!("Mesh {}, ", r.family)),
            distance,
        ),
    };
    bundle.add("figures/refinement.svg", error_plot(&plot, Some(1.0))?)
}

/// One curve per friction value and prefix, in order of appearance.
fn curves<R>(
    rows: &[R],
    name: impl Fn(&R) -> (f64, String),
    point: impl Fn(&R) -> [f64; 2],
) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        let (friction, prefix) = name(row);
        let label = format!("{prefix}μ = {}", value(friction));
        match curves.iter_mut().find(|c| c.label == label) {
            Some(curve) => curve.points.push(point(row)),
            None => curves.push(Curve {
                label,
                points: vec![point(row)],
            }),
        }
    }
    curves
}
