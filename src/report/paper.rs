//! The main job: the two tables of the founding paper, our values beside the printed ones, and all that stands with them.

use super::number::{significant, value};
use super::table::{self, readable};
use super::tables::runs::ExpectSummary;
use super::{Bundle, Provenance, ReportError, figures, standard};
use crate::studies::paper::comparison::comparison;
use crate::studies::paper::converged_reactions::{ConvergedRow, agreements};
use crate::studies::paper::printed_tables::{Table1Row, Table2Row};
use crate::studies::paper::{CASES, Paper};

/// All files of the report of the main job.
///
/// # Errors
/// Those of the parts.
pub fn bundle(paper: &Paper, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    standard::add_tables(&mut bundle, &paper.results)?;
    // Figures of the other cases, some hundred, are drawn by `run` and by the full job.
    let drawn = match paper.long {
        Some(_) => &paper.results,
        None => &paper.results.of_cases(&CASES),
    };
    standard::add_figures(&mut bundle, drawn)?;
    standard::add_fields(&mut bundle, &drawn.fields, provenance)?;
    super::add_provenance(&mut bundle, provenance)?;
    table::add(&mut bundle, &paper.table1, "")?;
    table::add(&mut bundle, &paper.table2, "")?;
    figures::table1::add(&mut bundle, &paper.table1)?;
    table::add(&mut bundle, &paper.penalty, "")?;
    table::add(&mut bundle, &paper.refinement, "")?;
    table::add(&mut bundle, &paper.limits, "")?;
    let comparison = comparison(&paper.results.runs);
    table::add(&mut bundle, &comparison, "")?;
    figures::cost::add(&mut bundle, &comparison)?;
    if let Some(long) = &paper.long {
        let (meshes, limits) = (&long.converged_meshes, &long.converged);
        table::add(&mut bundle, meshes, "")?;
        table::add(&mut bundle, limits, "")?;
        figures::converged::add(&mut bundle, meshes, limits, &paper.refinement)?;
        table::add(&mut bundle, &long.variants, "")?;
    }
    Ok(bundle)
}

/// One paragraph on the agreement of the meshes.
fn summary(rows: &[ConvergedRow]) -> String {
    let lines = agreements(rows).into_iter().map(|found| {
        format!(
            "μ = {}: {} limits within {} MN/m of each other, {} their smallest error bar of {} MN/m",
            value(found.friction),
            found.meshes,
            significant(found.spread_mn_per_m, 2),
            if found.holds() { "inside" } else { "NOT inside" },
            significant(found.smallest_bar_mn_per_m, 2),
        )
    });
    let lines: Vec<String> = lines.collect();
    format!("Converged reactions of the plate: {}", lines.join("; "))
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
        lines.insert(0, summary(&long.converged));
    }
    tables.push(readable(
        &ExpectSummary::of(&paper.results.expectations),
        "",
    ));
    lines.push(standard::summary(&paper.results));
    let tables: String = tables.iter().map(|table| table.terminal() + "\n").collect();
    format!("{tables}{}", lines.join("\n"))
}
