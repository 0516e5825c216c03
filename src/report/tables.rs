//! Every table that a command writes: its row type with its columns, and the chapter it belongs to.

pub mod convergence;
pub mod paper;
pub mod problems;
pub mod ranks;
pub mod robustness;
pub mod runs;
pub mod sensitivity;
pub mod stress;
pub mod sweep;
pub mod timings;
mod words;

use super::table::Description;
use crate::run::record::{ExactRow, ExpectRow, HistoryRow, PointRow, QuantityRow, RunRow};
use crate::studies::convergence::orders::{ErrorRow, OrderRow};
use crate::studies::exchange::collection::{FamilyRow, ProblemRow};
use crate::studies::paper::comparison::ComparisonRow;
use crate::studies::paper::converged_reactions::{ConvergedRow, SequenceRow};
use crate::studies::paper::penalty::PenaltyRow;
use crate::studies::paper::printed_tables::{Table1Row, Table2Row};
use crate::studies::paper::variants::VariantRow;
use crate::studies::robustness::atlas::{AtlasRow, StoppingRow};
use crate::studies::robustness::summary::{FailureRow, RobustnessRow};
use crate::studies::stress::rungs::{LadderRow, OptionRow, RungRow};
use crate::studies::stress::summary::{CauseRow, InvarianceRow, MethodRow, SceneRow};
use crate::studies::sweep::analysis::scaling::Growth;
use crate::studies::sweep::analysis::sensitivity::Starts;
use crate::studies::sweep::analysis::success::SuccessRow;

/// What a table or figure is about: a section of the page, a chapter of `docs/schema.md`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Chapter {
    /// The founding paper.
    Paper,
    /// Method against method on the shipped cases.
    Methods,
    /// Run time against error.
    Study,
    /// Random scenes: what fails, and why.
    Stress,
    /// Random problems.
    Robustness,
    /// Errors of meshes.
    Accuracy,
    /// Benchmarks and other programs.
    Benchmarks,
    /// Expected numbers.
    Expected,
    /// Single runs.
    Runs,
}

impl Chapter {
    /// All, in the order of the page.
    pub const ALL: [Self; 9] = [
        Self::Paper,
        Self::Methods,
        Self::Study,
        Self::Stress,
        Self::Robustness,
        Self::Accuracy,
        Self::Benchmarks,
        Self::Expected,
        Self::Runs,
    ];

    /// Anchor in the page.
    pub fn id(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Methods => "methods",
            Self::Study => "study",
            Self::Stress => "stress",
            Self::Robustness => "robustness",
            Self::Accuracy => "accuracy",
            Self::Benchmarks => "benchmarks",
            Self::Expected => "expected",
            Self::Runs => "runs",
        }
    }

    /// Heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Paper => "Founding paper",
            Self::Methods => "Methods on all cases",
            Self::Study => "Run time against error",
            Self::Stress => "Numerical stability",
            Self::Robustness => "Robustness",
            Self::Accuracy => "Accuracy of the discretisation",
            Self::Benchmarks => "Benchmarks and other programs",
            Self::Expected => "Expected numbers",
            Self::Runs => "Runs",
        }
    }

    /// What the reader finds there, and which command writes it.
    pub fn lead(self) -> &'static str {
        match self {
            Self::Paper => {
                "Plate and beam of the founding paper: computed beside printed numbers, and what the plate converges to \
                 (`stickslip paper`)."
            }
            Self::Methods => {
                "Every method on the shipped cases, the plate and the beam also by the variants of the methods (`stickslip paper`)."
            }
            Self::Study => {
                "Every method on the same problems, asked for one accuracy after the other (`stickslip study`). Time of the \
                 method: preparation and solution of all increments, K factored and condensed before; median of repetitions \
                 on one thread. A time counts beside a right answer only."
            }
            Self::Stress => {
                "Random scenes whose cracks lie where discretisations break: as good as on nodes, edges, sides, corners, tips and \
                 each other, at distances from 1e-14 of a cell. Every one is run by every method, judged, and run again in other \
                 units, elsewhere and with other names of sides and faces (`stickslip stress`)."
            }
            Self::Robustness => {
                "The same seeded random problems for every method (`stickslip stress methods`). Exact methods succeed where they \
                 solved the contact laws, approximate ones where they kept their claim."
            }
            Self::Accuracy => {
                "Errors and observed orders on sequences of meshes, against closed forms where there are any (`stickslip \
                 converge`)."
            }
            Self::Benchmarks => "Times of `cargo bench`, and other programs on the same problems.",
            Self::Expected => {
                "Closed forms and published numbers that the cases must reproduce, by every exact method. Missed as \
                 documented: a limitation that the case file states."
            }
            Self::Runs => {
                "The runs themselves, increment by increment: the results of `stickslip run`."
            }
        }
    }
}

/// Every table with its chapter, those of a chapter in the order of the page.
pub fn catalogue() -> Vec<(Chapter, Description)> {
    let of = |chapter: Chapter, tables: Vec<Description>| {
        tables.into_iter().map(move |table| (chapter, table))
    };
    let paper = vec![
        Description::of::<Table1Row>(),
        Description::of::<Table2Row>(),
        Description::of::<ConvergedRow>(),
        Description::of::<SequenceRow>(),
        Description::of::<PenaltyRow>(),
    ];
    let methods = vec![
        Description::of::<ComparisonRow>(),
        Description::of::<VariantRow>(),
    ];
    let study = vec![
        Description::of::<ranks::RankingRow>(),
        Description::of::<Growth>(),
        Description::of::<SuccessRow>(),
        Description::of::<sensitivity::WindowRow<'_>>(),
        Description::of::<sensitivity::SensitivityRow<'_>>(),
        Description::of::<Starts>(),
        Description::of::<sweep::SummaryRow>(),
        Description::of::<ranks::ProfileRow>(),
        Description::of::<ranks::PointRow<'_>>(),
        Description::of::<ranks::AccuracyRow<'_>>(),
        Description::of::<sweep::CellRow<'_>>(),
        Description::of::<sweep::IncrementRow<'_>>(),
        Description::of::<sweep::DeviationRow<'_>>(),
        Description::of::<sweep::TimeRow<'_>>(),
    ];
    let stress = vec![
        Description::of::<CauseRow>(),
        Description::of::<InvarianceRow>(),
        Description::of::<MethodRow>(),
        Description::of::<LadderRow>(),
        Description::of::<OptionRow>(),
        Description::of::<RungRow>(),
        Description::of::<SceneRow>(),
    ];
    let robustness = vec![
        Description::of::<RobustnessRow>(),
        Description::of::<FailureRow>(),
        Description::of::<AtlasRow>(),
        Description::of::<StoppingRow>(),
    ];
    let accuracy = vec![Description::of::<OrderRow>(), Description::of::<ErrorRow>()];
    let benchmarks = vec![
        Description::of::<super::timings::TimingRow>(),
        timings::peers(),
    ];
    let expected = vec![
        Description::of::<runs::ExpectSummary>(),
        Description::of::<ExpectRow>(),
    ];
    let runs = vec![
        Description::of::<RunRow>(),
        Description::of::<QuantityRow>(),
        Description::of::<HistoryRow>(),
        Description::of::<PointRow>(),
        Description::of::<ExactRow>(),
        Description::of::<ProblemRow>(),
        Description::of::<FamilyRow>(),
    ];
    of(Chapter::Paper, paper)
        .chain(of(Chapter::Methods, methods))
        .chain(of(Chapter::Study, study))
        .chain(of(Chapter::Stress, stress))
        .chain(of(Chapter::Robustness, robustness))
        .chain(of(Chapter::Accuracy, accuracy))
        .chain(of(Chapter::Benchmarks, benchmarks))
        .chain(of(Chapter::Expected, expected))
        .chain(of(Chapter::Runs, runs))
        .collect()
}
