//! Cases as they say themselves: their meshes, friction values, methods and accuracy, with all tables of a run.

use stickslip_methods::Tier;

use crate::case::Case;
use crate::run::choice::{Choice, choices};
use crate::run::progress::Progress;
use crate::run::verdict::Accuracy;
use crate::studies::axes::{Axes, Subject, named};
use crate::studies::exact_curve::exact_points;
use crate::studies::expect::{self, expectation_rows};
use crate::studies::measure::{Bench, RunError, here};
use crate::studies::results::Results;
use crate::studies::several::mark_several;
use crate::studies::task::Looks;

/// How to run cases.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Tier asked for; `None`: the case's own.
    pub tier: Option<Tier>,
    /// Runs at the same time; times are recorded for one only.
    pub jobs: usize,
    /// Methods whose fields are kept for pictures.
    pub fields: Fields,
    /// Starts from which every exact method looks for answers; 1: that of the increment alone, whose runs are kept.
    pub starts: usize,
    /// Questions to a run that gave up.
    pub why: Why,
}

impl Settings {
    /// Cases as they are, one run after the other, numbers alone.
    pub const PLAIN: Self = Self {
        tier: None,
        jobs: 1,
        fields: Fields::None,
        starts: 1,
        why: Why::Nothing,
    };
}

/// Questions to a run that gave up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// Nothing.
    Nothing,
    /// Why.
    Cause,
    /// Why, and what solves the problem instead.
    Remedy,
}

/// Methods whose fields are kept: pictures cost more than solving, and exact methods agree to many digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fields {
    /// Nobody's.
    None,
    /// The first exact method's of every problem, or the first method's if none is exact.
    First,
    /// Everybody's.
    All,
}

/// Runs a case for some methods and gathers everything it produced.
///
/// # Errors
/// [`RunError`]; what a method does wrong is a verdict.
pub fn run_case(
    case: &Case,
    given: &[Choice],
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Results, RunError> {
    let choices = choices(case, given)?;
    expect::check(case)?;
    let accuracy = Accuracy::of(case, settings.tier.unwrap_or(case.tier));
    let first = choices.iter().position(Choice::exact).unwrap_or(0);
    let looks = Looks {
        quantities: true,
        curves: true,
        starts: settings.starts.saturating_sub(1),
        why: settings.why != Why::Nothing,
        remedy: settings.why == Why::Remedy,
        ..Looks::default()
    };
    let mut tasks =
        Subject::given(case).tasks(&Axes::of(case), &named(&choices), &[accuracy], looks);
    for (k, task) in tasks.iter_mut().enumerate() {
        task.looks.fields = match settings.fields {
            Fields::None => false,
            Fields::First => k % choices.len() == first,
            Fields::All => true,
        };
    }
    let (mut results, mut bench) = (Results::default(), Bench::default());
    let jobs = settings.jobs;
    let answers = here(
        &mut bench,
        &tasks,
        &choices,
        jobs,
        None,
        progress,
        &mut |scene, task| {
            // The same on every mesh.
            if let Some((case, loading)) = scene.body()
                && Some(&task.asked.refine) == case.sweep.refine.first()
            {
                let own = exact_points(case, loading, task.asked.mu());
                results.exact.extend(own);
            }
        },
    )?;
    for (answer, choice) in answers.iter().zip(choices.iter().cycle()) {
        results
            .expectations
            .extend(expectation_rows(case, choice, &answer.record));
    }
    results.answers = answers;
    mark_several(&mut results.answers);
    if settings.jobs > 1 {
        let spent = results.answers.iter_mut().map(|own| &mut own.record.spent);
        spent.for_each(|own| *own = None);
    }
    Ok(results)
}
