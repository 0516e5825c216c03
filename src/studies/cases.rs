//! Cases as they say themselves: their meshes, friction values, methods and accuracy, with all tables of a run.

use stickslip_methods::Tier;

use crate::case::{Case, Target};
use crate::run::choice::{Choice, choices};
use crate::run::progress::Progress;
use crate::run::verdict::Accuracy;
use crate::studies::axes::{Axes, Subject, named};
use crate::studies::convergence::{OfMeshes, estimate, of_problem, put};
use crate::studies::exact_curve::exact_points;
use crate::studies::expect::{self, expectation_rows};
use crate::studies::measure::{Bench, Repeats, RunError, here};
use crate::studies::results::Results;
use crate::studies::several::mark_several;
use crate::studies::task::{Looks, Task};

/// How to run cases.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Accuracy asked for; `None`: the case's own.
    pub tier: Option<Target>,
    /// Whether the errors of the meshes are estimated.
    pub error: bool,
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
        error: false,
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

/// Violation that leaves a method a tenth of the error of the mesh: in the energy norm that of a method is up to 42 times its
/// violation on the shipped cases. No looser than tier low.
const OF_MESH: f64 = 0.1 / 40.0;

/// A task to the error of its mesh, where that is known and not beyond the accuracy of the case, and the task itself.
fn to_mesh(mut fine: Task, errors: &OfMeshes) -> [Task; 2] {
    let mut own = fine.clone();
    if let Some((error, _)) = of_problem(errors, &fine.asked).and_then(|errors| errors.energy)
        && OF_MESH * error > fine.asked.tolerance
    {
        own.asked.tolerance = Tier::Low.tolerance().min(OF_MESH * error);
        own.asked.finer = None;
    }
    (fine.looks.fields, fine.looks.curves) = (false, false);
    [own, fine]
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
    let target = settings.tier.unwrap_or(case.target);
    let by_mesh = target == Target::Mesh;
    let accuracy = Accuracy::of(case, target.tier());
    let errors = if settings.error || by_mesh {
        estimate(case, progress)?
    } else {
        OfMeshes::default()
    };
    let first = choices.iter().position(Choice::exact).unwrap_or(0);
    let looks = Looks {
        quantities: true,
        curves: true,
        error: by_mesh,
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
    if by_mesh {
        let both = |fine| to_mesh(fine, &errors);
        tasks = tasks.into_iter().flat_map(both).collect();
    }
    let (mut results, mut bench) = (Results::default(), Bench::default());
    let answers = here(
        &mut bench,
        &tasks,
        &choices,
        settings.jobs,
        by_mesh.then_some(Repeats::DEFAULT),
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
    let mut answers = answers.into_iter();
    for choice in choices.iter().cycle() {
        let Some(mut answer) = answers.next() else {
            break;
        };
        put(&errors, &mut answer.record);
        let record = &mut answer.record;
        if by_mesh {
            record.beside = answers.next().map(|fine| Box::new(fine.record));
        }
        // Numbers of the case are those to its own accuracy.
        let fine = record.beside.as_deref().unwrap_or(record);
        let held = expectation_rows(case, choice, fine);
        results.expectations.extend(held);
        results.answers.push(answer);
    }
    mark_several(&mut results.answers);
    if settings.jobs > 1 {
        let spent = results.answers.iter_mut().map(|own| &mut own.record.spent);
        spent.for_each(|own| *own = None);
    }
    Ok(results)
}
