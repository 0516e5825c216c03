//! The main job: the two tables of the founding paper, our values beside the printed ones, and all that stands with them.

pub mod converged_reactions;
pub mod plate_series;

use self::plate_series::{add_penalty, add_refinement};
use super::plot::method_cost;
use super::table::{self, readable};
use super::tables::runs::ExpectSummary;
use super::{Bundle, Provenance, ReportError, standard};
use crate::studies::paper::Paper;
use crate::studies::paper::comparison::comparison;
use crate::studies::paper::printed_tables::{Table1Row, Table2Row};

/// All files of the report of the main job.
///
/// # Errors
/// Those of the parts.
pub fn bundle(paper: &Paper, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = standard::bundle(&paper.results, provenance)?;
    table::add(&mut bundle, &paper.table1, "")?;
    table::add(&mut bundle, &paper.table2, "")?;
    add_penalty(&mut bundle, &paper.penalty)?;
    add_refinement(&mut bundle, &paper.refinement, &paper.limits)?;
    let comparison = comparison(&paper.results.runs);
    table::add(&mut bundle, &comparison, "")?;
    // Where nothing did what it claims there is nothing to draw.
    if comparison.iter().any(|row| row.verdict.is_honest()) {
        bundle.add("figures/cost.svg", method_cost(&comparison)?)?;
    }
    if let Some(long) = &paper.long {
        converged_reactions::add(
            &mut bundle,
            &long.converged_meshes,
            &long.converged,
            &paper.refinement,
        )?;
        table::add(&mut bundle, &long.variants, "")?;
    }
    Ok(bundle)
}

/// What the terminal shows at first: the tables of the paper.
pub fn tables(table1: &[Table1Row], table2: &[Table2Row]) -> String {
    let tables = [readable(table1, ""), readable(table2, "")];
    tables.map(|table| table.terminal() + "\n").concat()
}

/// What the terminal shows at the end.
pub fn text(paper: &Paper) -> String {
    let mut tables = vec![
        readable(&paper.penalty, ""),
        readable(&paper.refinement, ""),
        readable(&paper.limits, ""),
    ];
    let mut lines = vec![format!(
        "Model I with exact sub-cells against Model II: {:.1e} mm",
        paper.beam_models_mm
    )];
    if let Some(long) = &paper.long {
        tables.push(readable(&long.converged, ""));
        tables.push(readable(&long.variants, ""));
        lines.insert(0, converged_reactions::summary(&long.converged));
    }
    tables.push(readable(
        &ExpectSummary::of(&paper.results.expectations),
        "",
    ));
    lines.push(standard::summary(&paper.results));
    let tables: String = tables.iter().map(|table| table.terminal() + "\n").collect();
    format!("{tables}{}", lines.join("\n"))
}
