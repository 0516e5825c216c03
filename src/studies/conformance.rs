//! Does a method do what methods are to do? Small problems with known answers, each asked twice.

use crate::run::choice::Choice;
use crate::run::progress::Progress;
use crate::run::verdict::{Accuracy, Verdict};
use crate::studies::axes::{Axes, named};
use crate::studies::measure::{Bench, MeasureError, Repeats, RunError, here};
use crate::studies::record::Record;
use crate::studies::sources::exercises::{WITHOUT_ANSWER, exercises};
use crate::studies::task::Looks;

/// Distance of the reactions from the known ones that is passed, in multiples of the tolerance.
const DISTANCE: f64 = 1e3;

/// Twice: other bits are an error of the method, as where it is timed.
const TWICE: Repeats = Repeats {
    least: 2,
    most: 2,
    seconds: 0.0,
    patience_s: f64::INFINITY,
};

/// Result of an exercise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// As known.
    Passed,
    /// The method says that it cannot treat it.
    Declined,
    /// Anything else.
    Failed,
}

impl Mark {
    /// In tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Mark::Passed => "yes",
            Mark::Declined => "declined",
            Mark::Failed => "NO",
        }
    }
}

/// Has methods do all exercises, to a violation of `tolerance`: records by exercise, then method.
///
/// # Errors
/// An exercise that makes no system.
pub fn run(
    choices: &[Choice],
    tolerance: f64,
    progress: &dyn Progress,
) -> Result<Vec<Record>, RunError> {
    let (mut bench, mut records) = (Bench::default(), Vec::new());
    let looks = Looks {
        truth: true,
        ..Looks::default()
    };
    for exercise in exercises() {
        let subject = exercise.subject();
        let subject = subject.map_err(|e| MeasureError::File(e.to_string()))?;
        let axes = Axes::of_file(&exercise.problem.mu[..1]);
        let accuracy = Accuracy::exactly(tolerance);
        let tasks = subject.tasks(&axes, &named(choices), &[accuracy], looks);
        let answers = here(
            &mut bench,
            &tasks,
            choices,
            1,
            Some(TWICE),
            progress,
            &mut |_, _| (),
        )?;
        records.extend(answers.into_iter().map(|own| own.record));
    }
    Ok(records)
}

/// Verdict that passes.
pub fn expected(record: &Record) -> &'static str {
    match record.class.as_str() {
        WITHOUT_ANSWER => "gave-up",
        _ => "solved",
    }
}

/// Distance of the reactions from the known ones; NaN where there is none.
pub fn distance(record: &Record) -> f64 {
    let mut own = record.found.deviations.iter().map(|own| own.error);
    own.next().unwrap_or(f64::NAN)
}

/// Worth of a record of an exercise.
pub fn mark(record: &Record) -> Mark {
    let known = record.class != WITHOUT_ANSWER;
    let right = match &record.found.verdict {
        Verdict::Refused(_) => return Mark::Declined,
        Verdict::Solved => known && distance(record) <= DISTANCE * record.asked.tolerance,
        // Laws of its own, as it says.
        Verdict::Approximate(_) => known,
        Verdict::GaveUp(_) => !known,
        _ => false,
    };
    if right { Mark::Passed } else { Mark::Failed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::progress::Quiet;
    use crate::studies::exchange::local_system;
    use crate::studies::sources::exercises::Known;
    use stickslip_methods::{
        ContactState, ContactSystem, Increment, Load, Tier, conic::no_equilibrium, residuals,
    };

    /// Goal: the known answers are answers, found without a method.
    #[test]
    fn known_reactions_fulfil_the_contact_laws() {
        let mut solvable = 0;
        for exercise in exercises() {
            let posed = local_system(&exercise.problem).unwrap();
            let system = ContactSystem::new(posed.elastic, posed.friction).unwrap();
            let (rest, start) = (Load::zero(system.elastic()), ContactState::zero(&system));
            let increment = Increment {
                system: &system,
                load: &posed.load,
                start_load: &rest,
                start: &start,
                guess: None,
                index: 0,
                tolerance: 1e-9,
            };
            let Known::Reactions(r) = &exercise.known else {
                assert!(no_equilibrium(&increment).unwrap());
                continue;
            };
            let state: ContactState = increment.state_of(r, &exercise.amplitudes).unwrap();
            let found = residuals(&increment, &state).unwrap();
            let worst = found.violation.max(found.equilibrium);
            assert!(worst < 1e-13, "{}: {found:?}", exercise.name);
            solvable += 1;
        }
        assert!(solvable >= 12);
    }

    fn marks(method: &str) -> Vec<(Record, Mark)> {
        let choice = Choice::parse(method).unwrap();
        let records = run(&[choice], Tier::High.tolerance(), &Quiet).unwrap();
        records
            .into_iter()
            .map(|own| (own.clone(), mark(&own)))
            .collect()
    }

    #[test]
    fn an_exact_method_passes_and_one_with_laws_of_its_own_is_not_held_to_the_contact_laws() {
        for (method, all) in [("hybrid", true), ("penalty", false)] {
            for (record, mark) in marks(method) {
                assert_eq!(mark, Mark::Passed, "{record:?}");
                let distance = distance(&record);
                assert!(!all || distance < 1e-6 || record.class == WITHOUT_ANSWER);
            }
        }
    }

    #[test]
    fn one_that_gives_up_fails() {
        let marks = marks("nsgs:max_iterations=1");
        let of = |name: &str| marks.iter().find(|own| own.0.asked.case == name).unwrap().1;
        assert_eq!(
            (of("open-2d"), of("mixed-3d")),
            (Mark::Passed, Mark::Failed)
        );
    }
}
