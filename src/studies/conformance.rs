//! Does a method do what methods are to do? Small problems with known answers, each asked twice.
//!
//! The answers are not computed: reactions r and local velocities u that fulfil the contact laws are chosen first, and
//! q = u − W r − V λ makes them the solution. W = I + A Aᵀ/m with entries of A in [−1, 1] is conditioned well enough for
//! it to be the only one at these friction coefficients.

mod problems;

pub use problems::{Exercise, Known, exercises};

use stickslip_methods::{ContactState, ContactSystem, Increment, Load, MethodError};

use crate::run::choice::Choice;
use crate::run::increment::{JudgedIncrement, Solver};
use crate::run::verdict::Verdict;
use crate::studies::exchange::local_system;

/// Distance of the reactions from the known ones that is passed, in multiples of the tolerance.
const DISTANCE: f64 = 1e3;

/// What became of an exercise.
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

/// One exercise by one method.
#[derive(Debug, Clone)]
pub struct Attempt {
    /// Name of the exercise.
    pub exercise: &'static str,
    /// Label of the method.
    pub method: String,
    /// What was to come out.
    pub expected: &'static str,
    /// What came out.
    pub verdict: Verdict,
    /// |r − r*| / max(|r*|, ρ |q|); NaN where there is none.
    pub distance: f64,
    /// Violation found by the judge; NaN where there is none.
    pub violation: f64,
    /// Iterations of the method.
    pub iterations: usize,
    /// What it is worth.
    pub mark: Mark,
}

/// Has a method do an exercise, to a violation of `tolerance`.
///
/// # Errors
/// An exercise that makes no system.
pub fn attempt(
    exercise: &Exercise,
    choice: &Choice,
    tolerance: f64,
) -> Result<Attempt, MethodError> {
    let posed = local_system(&exercise.problem)?;
    let system = ContactSystem::new(posed.elastic, posed.friction)?;
    let (rest, start) = (Load::zero(system.elastic()), ContactState::zero(&system));
    let increment = Increment {
        system: &system,
        load: &posed.load,
        start_load: &rest,
        start: &start,
        guess: None,
        index: 0,
        tolerance,
    };
    let done = solved_twice(choice, &increment);
    let judged = done.judged.as_ref();
    let distance = match (judged, &exercise.known) {
        (Some(judged), Known::Reactions(r)) => distance(&judged.outcome.state.p, r, exercise),
        _ => f64::NAN,
    };
    let right = match (&done.verdict, &exercise.known) {
        (Verdict::Solved, Known::Reactions(_)) => distance <= DISTANCE * tolerance,
        // Laws of its own, as it says.
        (Verdict::Approximate(_), Known::Reactions(_)) => true,
        (Verdict::GaveUp(_), Known::Nothing) => true,
        _ => false,
    };
    let mark = match done.verdict {
        Verdict::Refused(_) => Mark::Declined,
        _ if right => Mark::Passed,
        _ => Mark::Failed,
    };
    Ok(Attempt {
        exercise: exercise.name,
        method: choice.label.clone(),
        expected: match exercise.known {
            Known::Reactions(_) => "solved",
            Known::Nothing => "gave-up",
        },
        distance,
        violation: judged.map_or(f64::NAN, |judged| judged.found.violation),
        iterations: judged.map_or(0, |judged| judged.outcome.counters.iterations),
        verdict: done.verdict,
        mark,
    })
}

/// The increment solved twice: other bits are an error of the method, as where it is timed.
fn solved_twice(choice: &Choice, increment: &Increment<'_>) -> JudgedIncrement {
    let accepted = increment.tolerance;
    let solve = || Solver::new(choice, increment.system).map(|mut s| s.judge(increment, accepted));
    let once = |tried: Result<JudgedIncrement, Verdict>| {
        tried.unwrap_or_else(JudgedIncrement::not_started)
    };
    let mut first = once(solve());
    if let Some(judged) = &first.judged {
        let again = once(solve());
        let same = |other: &JudgedIncrement| {
            let other = other.judged.as_ref();
            other.is_some_and(|other| other.outcome.state == judged.outcome.state)
        };
        if !same(&again) {
            let message = "the same increment gave other bits when it was solved again";
            first.verdict = Verdict::Crashed(message.into());
        }
    }
    first
}

/// Relative to what forces are compared with.
fn distance(found: &[f64], known: &[f64], exercise: &Exercise) -> f64 {
    let norm = |all: &mut dyn Iterator<Item = f64>| all.map(|x| x * x).sum::<f64>().sqrt();
    let problem = &exercise.problem;
    let rows = problem.q.len();
    let trace: f64 = (0..rows).map(|k| problem.w.get(k, k)).sum();
    let free = rows as f64 / trace * norm(&mut problem.q.iter().copied());
    let scale = norm(&mut known.iter().copied()).max(free);
    norm(&mut found.iter().zip(known).map(|(r, known)| r - known)) / scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_methods::{ContactState, Tier, residuals};

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
                assert!(stickslip_methods::conic::no_equilibrium(&increment).unwrap());
                continue;
            };
            let state: ContactState = increment.state_of(r, &exercise.amplitudes()).unwrap();
            let found = residuals(&increment, &state).unwrap();
            let worst = found.violation.max(found.equilibrium);
            assert!(worst < 1e-13, "{}: {found:?}", exercise.name);
            solvable += 1;
        }
        assert!(solvable >= 12);
    }

    #[test]
    fn an_exact_method_passes_and_one_with_laws_of_its_own_is_not_held_to_the_contact_laws() {
        for (method, all) in [("hybrid", true), ("penalty", false)] {
            let choice = Choice::parse(method).unwrap();
            for exercise in exercises() {
                let found = attempt(&exercise, &choice, Tier::High.tolerance()).unwrap();
                assert_eq!(found.mark, Mark::Passed, "{found:?}");
                assert!(!all || found.distance.is_nan() || found.distance < 1e-6);
            }
        }
    }

    #[test]
    fn one_that_gives_up_fails() {
        let choice = Choice::parse("nsgs:max_iterations=1").unwrap();
        let marks = exercises().into_iter().map(|exercise| {
            let found = attempt(&exercise, &choice, 1e-9).unwrap();
            (exercise.name, found.mark)
        });
        let marks: Vec<_> = marks.collect();
        assert!(marks.contains(&("open-2d", Mark::Passed)));
        assert!(marks.contains(&("mixed-3d", Mark::Failed)));
    }
}
