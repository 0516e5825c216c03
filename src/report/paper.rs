//! The main job: the two tables of the founding paper, our values beside the printed ones, and all that stands with them.

use super::table::{self, readable};
use super::{Bundle, Provenance, ReportError, figures, standard};
use crate::studies::paper::comparison::comparison;
use crate::studies::paper::printed_tables::{Table1Row, Table2Row};
use crate::studies::paper::{CASES, Extent, Paper};

/// All files of the report of the main job.
///
/// # Errors
/// Those of the parts.
pub fn bundle(paper: &Paper, provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    standard::add_tables(&mut bundle, &paper.results)?;
    // Figures of the other cases, some hundred, are drawn by `run` and by the full job.
    let drawn = match paper.extent {
        Extent::Full => &paper.results,
        Extent::Quick => &paper.results.of_cases(&CASES),
    };
    standard::add_figures(&mut bundle, drawn)?;
    standard::add_fields(&mut bundle, drawn, provenance)?;
    super::add_provenance(&mut bundle, provenance)?;
    table::add(&mut bundle, &paper.table1, "")?;
    table::add(&mut bundle, &paper.table2, "")?;
    table::add(&mut bundle, &paper.penalty, "")?;
    table::add(&mut bundle, &paper.convergence, "")?;
    table::add(&mut bundle, &paper.converged, "")?;
    let defaults = comparison(paper.results.records());
    figures::cost::add(&mut bundle, &defaults)?;
    figures::time_against_total_error::add(&mut bundle, &paper.refined, "")?;
    let all = paper.results.records().chain(&paper.variants);
    table::add(&mut bundle, &comparison(all), "")?;
    Ok(bundle)
}

/// Text of the terminal at first: the tables of the paper.
pub fn tables(table1: &[Table1Row], table2: &[Table2Row]) -> String {
    let tables = [readable(table1, ""), readable(table2, "")];
    tables.map(|table| table.terminal() + "\n").concat()
}

/// Text of the terminal at the end.
pub fn text(paper: &Paper) -> String {
    let tables = [readable(&paper.penalty, ""), readable(&paper.converged, "")];
    let tables = tables.map(|table| table.terminal() + "\n").concat();
    format!(
        "{tables}Model I with exact sub-cells against Model II: {:.1e} mm\n{}",
        paper.beam_models_mm,
        standard::summary(&paper.results)
    )
}
