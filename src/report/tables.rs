//! Every table that a command writes: its row type with its columns, and the chapter it belongs to.

pub mod causes;
pub mod convergence;
pub mod details;
pub mod options;
pub mod paper;
pub mod peers;
pub mod problems;
pub mod ranks;
pub mod runs;
pub mod stress;
mod words;

use options::OptionRow;
use problems::ProblemRow;
use ranks::{PointRow, RankingRow};
use runs::RunRow;

use super::table::{Description, Row, add};
use super::{Bundle, ReportError};
use crate::studies::analysis::accuracy::refinements;
use crate::studies::analysis::causes::{CauseRow, StoppingRow, causes, stopping};
use crate::studies::analysis::options::sweeps;
use crate::studies::analysis::scaling::{Growth, growth};
use crate::studies::analysis::success::{SuccessRow, success};
use crate::studies::convergence::orders::{ErrorRow, OrderRow};
use crate::studies::paper::comparison::ComparisonRow;
use crate::studies::paper::penalty::PenaltyRow;
use crate::studies::paper::printed_tables::{Table1Row, Table2Row};
use crate::studies::record::Record;
use crate::studies::rows::{self, HistoryRow, IncrementRow, QuantityRow};
use crate::studies::stress::summary::{FaultRow, InvarianceRow, LadderRow};

/// Subject of a table or figure: a section of the page, a chapter of `stickslip show schema`.
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
    pub const ALL: [Self; 8] = [
        Self::Paper,
        Self::Methods,
        Self::Study,
        Self::Stress,
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
            Self::Accuracy => "Accuracy of the discretisation",
            Self::Benchmarks => "Other programs",
            Self::Expected => "Expected numbers",
            Self::Runs => "Runs",
        }
    }

    /// Contents for the reader, and the command that writes them.
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

/// A table that a study makes of its records.
pub struct OfStudy {
    /// Where it stands.
    pub chapter: Chapter,
    /// The kind.
    pub about: Description,
    /// Adds it.
    pub add: Add,
}

/// Adds what is made of records, with a caveat for the heading.
type Add = fn(&mut Bundle, &[Record], &str) -> Result<(), ReportError>;

fn table<R: Row>(chapter: Chapter, add: Add) -> OfStudy {
    let about = Description::of::<R>();
    OfStudy {
        chapter,
        about,
        add,
    }
}

/// The tables of a study, in the order of the page: a new one is its file and a line here.
pub fn of_study() -> Vec<OfStudy> {
    use Chapter::{Accuracy, Runs, Study};
    vec![
        table::<RankingRow>(Study, |to, of, caveat| {
            add(to, &ranks::rankings(of), caveat)
        }),
        table::<Growth>(Study, |to, of, caveat| add(to, &growth(of), caveat)),
        table::<SuccessRow>(Study, |to, of, caveat| add(to, &success(of), caveat)),
        table::<CauseRow>(Study, |to, of, caveat| add(to, &causes(of), caveat)),
        table::<StoppingRow>(Study, |to, of, caveat| add(to, &stopping(of), caveat)),
        table::<OptionRow>(Study, |to, of, caveat| {
            add(to, &OptionRow::of(&sweeps(of)), caveat)
        }),
        table::<PointRow>(Study, |to, of, _| add(to, &ranks::curves(of), "")),
        table::<ErrorRow>(Accuracy, |to, of, _| {
            let errors = refinements(of).into_iter().flat_map(|one| one.errors);
            add(to, &errors.collect::<Vec<_>>(), "")
        }),
        table::<RunRow>(Runs, |to, of, _| {
            add(to, &of.iter().map(RunRow).collect::<Vec<_>>(), "")
        }),
        table::<IncrementRow>(Runs, |to, of, _| {
            let rows = of.iter().flat_map(IncrementRow::of);
            add(to, &rows.collect::<Vec<_>>(), "")
        }),
        table::<ProblemRow>(Study, |to, of, caveat| {
            add(to, &problems::of_files(of), caveat)
        }),
    ]
}

/// Every table with its chapter, those of a chapter in the order of the page.
pub fn catalogue() -> Vec<(Chapter, Description)> {
    let of = |chapter: Chapter, tables: Vec<Description>| {
        tables.into_iter().map(move |table| (chapter, table))
    };
    let paper = vec![
        Description::of::<Table1Row>(),
        Description::of::<Table2Row>(),
        Description::of::<PenaltyRow>(),
    ];
    let methods = vec![Description::of::<ComparisonRow>()];
    let of_chapter = |chapter| {
        let own = of_study()
            .into_iter()
            .filter(move |own| own.chapter == chapter);
        own.map(|table| table.about)
    };
    let study = of_chapter(Chapter::Study).collect();
    let stress = vec![
        Description::of::<FaultRow>(),
        Description::of::<InvarianceRow>(),
        Description::of::<LadderRow>(),
    ];
    let accuracy = of_chapter(Chapter::Accuracy)
        .chain([Description::of::<OrderRow>()])
        .collect();
    let benchmarks = vec![peers::peers()];
    let expected = vec![Description::of::<details::ExpectedNumber<'_>>()];
    let details = [
        Description::of::<QuantityRow>(),
        Description::of::<HistoryRow>(),
        Description::of::<rows::PointRow>(),
    ];
    let runs = of_chapter(Chapter::Runs).chain(details).collect();
    of(Chapter::Paper, paper)
        .chain(of(Chapter::Methods, methods))
        .chain(of(Chapter::Study, study))
        .chain(of(Chapter::Stress, stress))
        .chain(of(Chapter::Accuracy, accuracy))
        .chain(of(Chapter::Benchmarks, benchmarks))
        .chain(of(Chapter::Expected, expected))
        .chain(of(Chapter::Runs, runs))
        .collect()
}
