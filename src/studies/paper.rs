//! The main job: the founding paper's plate and beam by every method, beside the printed tables.
//!
//! Also the penalty error against its parameter, both plate meshes under refinement, the converged reactions of the plate,
//! and every other shipped case against its expected numbers.

pub mod comparison;
pub mod converged_reactions;
mod lookup;
pub mod plate_series;
pub mod printed_tables;
pub mod variants;

pub use lookup::PaperError;

use crate::case::shipped;
use crate::run::record::Results;
use crate::run::run_case::{Fields, Progress, Settings, run_case};

use converged_reactions::{ConvergedRow, SequenceRow, converged_reactions};
use lookup::case;
use plate_series::{
    LimitRow, PenaltyRow, RefinementRow, limit_rows, penalty_rows, refinement_rows,
};
use printed_tables::{Table1Row, Table2Row, beam_difference, beam_rows, plate_rows};
use variants::{VariantRow, variant_rows};

/// Everything the main job found.
#[derive(Debug, Default)]
pub struct Paper {
    /// Runs of all shipped cases.
    pub results: Results,
    /// Table 1.
    pub table1: Vec<Table1Row>,
    /// Table 2.
    pub table2: Vec<Table2Row>,
    /// Error of the penalty method against its parameter.
    pub penalty: Vec<PenaltyRow>,
    /// Reactions of both plate meshes under refinement.
    pub refinement: Vec<RefinementRow>,
    /// Their limits.
    pub limits: Vec<LimitRow>,
    /// Reactions of the plate by star multipliers with a fixed tip radius, on three meshes under refinement.
    pub converged_meshes: Vec<SequenceRow>,
    /// Their limits beside the printed numbers.
    pub converged: Vec<ConvergedRow>,
    /// Plate and beam by every method and variant.
    pub variants: Vec<VariantRow>,
    /// Largest difference of the seven points between Model I with exact sub-cells and Model II [mm].
    pub beam_models_mm: f64,
}

/// Runs everything.
pub fn run(settings: Settings, progress: &dyn Progress) -> Result<Paper, PaperError> {
    let mut paper = Paper::default();
    let numbers_only = Settings {
        fields: Fields::None,
        ..settings
    };
    for (name, _) in shipped::CASES {
        let results = run_case(&case(name)?, &[], settings, progress)?;
        paper.results.append(results);
    }
    paper.table1 = plate_rows(&paper.results)?;
    paper.table2 = beam_rows(&paper.results)?;
    paper.beam_models_mm = beam_difference(&paper.results);
    paper.penalty = penalty_rows(&paper.results, numbers_only, progress)?;
    paper.refinement = refinement_rows(numbers_only, progress)?;
    paper.limits = limit_rows(&paper.refinement);
    (paper.converged_meshes, paper.converged) = converged_reactions(&paper.table1, progress)?;
    paper.variants = variant_rows(&paper.results, numbers_only, progress)?;
    Ok(paper)
}
