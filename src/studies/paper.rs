//! The main job: the founding paper's plate and beam by every method, beside the printed tables.
//!
//! Also the penalty error against its parameter, both plate meshes under refinement, the converged reactions of the plate,
//! and every other shipped case against its expected numbers.

pub mod comparison;
pub mod converged_reactions;
mod lookup;
pub mod penalty;
pub mod printed_tables;
pub mod variants;

pub use lookup::{PaperError, as_printed};

use crate::case::shipped;
use crate::run::choice::Choice;
use crate::run::progress::Progress;
use crate::studies::axes::Axes;
use crate::studies::cases::{Fields, Settings, run_case};
use crate::studies::convergence::orders::{ErrorRow, OrderRow};
use crate::studies::convergence::records;
use crate::studies::measure::Bench;
use crate::studies::record::Record;
use crate::studies::results::Results;
use crate::studies::task::Looks;

use converged_reactions::converged_reactions;
use lookup::{case, choice};
use penalty::{PenaltyRow, penalty_rows};
use printed_tables::{PAPER_METHODS, Table1Row, Table2Row, beam_difference, beam_rows, plate_rows};
use variants::variant_runs;

/// Cases that take longer than all others together.
const LONG: [&str; 6] = [
    "branched_crack",
    "crossing_cracks",
    "elliptic_crack",
    "kinked_crack",
    "parallel_cracks",
    "penny_crack",
];

/// Cases of the paper's two tables.
pub const CASES: [&str; 5] = [
    "plate_mesh1",
    "plate_mesh2",
    "beam_model1",
    "beam_model1_gauss6",
    "beam_model2",
];

/// Everything the main job found.
#[derive(Debug, Default)]
pub struct Paper {
    /// Runs of the shipped cases.
    pub results: Results,
    /// Table 1.
    pub table1: Vec<Table1Row>,
    /// Table 2.
    pub table2: Vec<Table2Row>,
    /// Error of the penalty method against its parameter.
    pub penalty: Vec<PenaltyRow>,
    /// Reactions of the plate under refinement: by edge pairs, and by star multipliers if they were asked for.
    pub convergence: Vec<ErrorRow>,
    /// The finest ones beside the printed numbers.
    pub converged: Vec<OrderRow>,
    /// Largest difference of the seven points between Model I with exact sub-cells and Model II [mm].
    pub beam_models_mm: f64,
    /// The plate with sticking on Mesh I and finer ones, by the methods of the paper.
    pub refined: Vec<Record>,
    /// Plate and beam by variants of the methods, if they were asked for.
    pub variants: Vec<Record>,
    /// How much was run.
    pub extent: Extent,
}

/// How much is run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Extent {
    /// All that takes seconds.
    #[default]
    Quick,
    /// The long cases, the converged sequences and the variants of the methods too.
    Full,
}

/// Tables 1 and 2, at once.
///
/// # Errors
/// Of the cases or their discretisation.
pub fn first_tables(
    settings: Settings,
    progress: &dyn Progress,
) -> Result<(Vec<Table1Row>, Vec<Table2Row>), PaperError> {
    let choices = paper_choices()?;
    let settings = Settings {
        fields: Fields::None,
        ..settings
    };
    let mut results = Results::default();
    for name in CASES {
        results.append(run_case(&case(name)?, &choices, settings, progress)?);
    }
    Ok((plate_rows(&results)?, beam_rows(&results)?))
}

/// Runs everything.
///
/// # Errors
/// Of the cases or their discretisation.
pub fn run(
    extent: Extent,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Paper, PaperError> {
    let numbers_only = Settings {
        fields: Fields::None,
        ..settings
    };
    let mut paper = Paper {
        extent,
        ..Paper::default()
    };
    for (name, _) in shipped::CASES {
        if extent == Extent::Full || !LONG.contains(name) {
            let pictured = extent == Extent::Full || CASES.contains(name);
            let settings = if pictured { settings } else { numbers_only };
            let results = run_case(&case(name)?, &[], settings, progress)?;
            paper.results.append(results);
        }
    }
    paper.table1 = plate_rows(&paper.results)?;
    paper.table2 = beam_rows(&paper.results)?;
    paper.beam_models_mm = beam_difference(&paper.results);
    paper.penalty = penalty_rows(&paper.results, numbers_only, progress)?;
    let full = extent == Extent::Full;
    (paper.convergence, paper.converged) = converged_reactions(full, &paper.table1, progress)?;
    paper.refined = refined_plate(progress)?;
    if full {
        paper.variants = variant_runs(numbers_only, progress)?;
    }
    Ok(paper)
}

/// Refinement factors of Mesh I, and the friction coefficient, for time against error.
const MESHES: [usize; 3] = [1, 2, 4];
const FRICTION: f64 = 0.8;

fn paper_choices() -> Result<Vec<Choice>, PaperError> {
    let choices = PAPER_METHODS.map(|name| choice(name, &[]));
    choices.into_iter().collect()
}

fn refined_plate(progress: &dyn Progress) -> Result<Vec<Record>, PaperError> {
    let plate = case(CASES[0])?;
    let axes = Axes {
        refine: MESHES.to_vec(),
        friction: vec![vec![FRICTION]],
        ..Axes::of(&plate)
    };
    let mut bench = Bench::default();
    let choices = paper_choices()?;
    Ok(records(
        &mut bench,
        &plate,
        &axes,
        &choices,
        Looks::truth(),
        progress,
    )?)
}
