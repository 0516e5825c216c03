//! The main job: the two tables of the founding paper, our values beside the printed ones, and all that stands with them.

use super::table::{self, readable};
use super::tables::runs::ExpectSummary;
use super::{Bundle, Provenance, ReportError, figures, standard};
use crate::studies::paper::comparison::comparison;
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
    let drawn = match paper.variants {
        Some(_) => &paper.results,
        None => &paper.results.of_cases(&CASES),
    };
    standard::add_figures(&mut bundle, drawn)?;
    standard::add_fields(&mut bundle, &drawn.fields, provenance)?;
    super::add_provenance(&mut bundle, provenance)?;
    table::add(&mut bundle, &paper.table1, "")?;
    table::add(&mut bundle, &paper.table2, "")?;
    table::add(&mut bundle, &paper.penalty, "")?;
    table::add(&mut bundle, &paper.refinement, "")?;
    table::add(&mut bundle, &paper.converged, "")?;
    let comparison = comparison(&paper.results.runs);
    table::add(&mut bundle, &comparison, "")?;
    figures::cost::add(&mut bundle, &comparison)?;
    if let Some(variants) = &paper.variants {
        table::add(&mut bundle, variants, "")?;
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
        readable(&paper.converged, ""),
    ];
    let mut lines = vec![format!(
        "Model I with exact sub-cells against Model II: {:.1e} mm",
        paper.beam_models_mm
    )];
    if let Some(variants) = &paper.variants {
        tables.push(readable(variants, ""));
    }
    tables.push(readable(
        &ExpectSummary::of(&paper.results.expectations),
        "",
    ));
    lines.push(standard::summary(&paper.results));
    let tables: String = tables.iter().map(|table| table.terminal() + "\n").collect();
    format!("{tables}{}", lines.join("\n"))
}
