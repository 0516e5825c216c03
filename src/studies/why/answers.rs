//! Which solutions an increment has, as far as exact methods from several starts and enumeration can tell.

use stickslip_methods::conic::no_equilibrium;
use stickslip_methods::{ContactState, Gauge, Increment, MethodError, Silent, guess, residuals};

use super::enumerate::enumerate;
use crate::run::choice::Choice;
use crate::run::path::Solver;
use crate::run::verdict::EQUILIBRIUM;

/// Exact methods that are asked, from the start of the increment.
const ASKED: [&str; 6] = [
    "hybrid",
    "newton-ac",
    "pdas",
    "b-newton",
    "nsgs",
    "interior-point",
];

/// The one that is asked from other contact forces too, and from how many: none, those of tied points, tension.
const FROM_ELSEWHERE: (&str, usize) = ("newton-ac", 3);

/// Violation they are asked for: the condition of a problem enlarges what a tolerance leaves open.
const TOLERANCE: f64 = 1e-12;

/// Largest violation of the contact laws of an answer.
const HOLDS: f64 = 1e-9;

/// Answers whose forces and jumps both differ by more, relative to the largest, are two.
const DIFFERENT: f64 = 1e-6;

/// The proof that there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// No contact force within the cones of friction balances the load, see [`no_equilibrium`].
    Certificate,
    /// None of so many combinations of states holds.
    Enumeration(usize),
}

/// Facts about an increment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answers {
    /// Different solutions known.
    pub solutions: usize,
    /// Largest difference of forces between them, over the largest force.
    pub apart: f64,
    /// Forces of those that methods found, all rows of every point.
    pub found: Vec<Vec<f64>>,
    /// Why there is none.
    pub none: Option<Proof>,
}

/// Largest |a − b| over the largest |a| and |b|.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = |x: &[f64]| x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let size = largest(a).max(largest(b));
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    if size > 0.0 { apart / size } else { 0.0 }
}

impl Answers {
    /// Asks for them.
    ///
    /// # Errors
    /// Input that no method could treat.
    pub fn of(increment: &Increment<'_>) -> Result<Self, MethodError> {
        let mut held: Vec<(ContactState, Vec<f64>)> = Vec::new();
        for state in asked(increment)? {
            let found = residuals(increment, &state)?;
            if !(found.violation <= HOLDS && found.equilibrium <= EQUILIBRIUM) {
                continue;
            }
            let jump = increment.jump(&state.u);
            let another = |(own, v): &(ContactState, Vec<f64>)| {
                difference(&own.p, &state.p) > DIFFERENT && difference(v, &jump) > DIFFERENT
            };
            if held.iter().all(another) {
                held.push((state, jump));
            }
        }
        let listed = enumerate(&Gauge::new(increment)?);
        let all = listed.as_ref().map(|list| &list.solutions[..]);
        let forces: Vec<&[f64]> = match all {
            Some(all) if all.len() > held.len() => all.iter().map(|p| &p[..]).collect(),
            _ => held.iter().map(|(state, _)| &state.p[..]).collect(),
        };
        let pairs = (0..forces.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let apart = pairs
            .map(|(i, j)| difference(forces[i], forces[j]))
            .fold(0.0, f64::max);
        let none = match &listed {
            _ if !held.is_empty() => None,
            _ if no_equilibrium(increment)? => Some(Proof::Certificate),
            Some(list) if list.proves_none() => Some(Proof::Enumeration(list.pieces)),
            _ => None,
        };
        Ok(Self {
            solutions: forces.len(),
            apart,
            found: held.into_iter().map(|(state, _)| state.p).collect(),
            none,
        })
    }
}

/// Ends of the methods, right or wrong.
fn asked(increment: &Increment<'_>) -> Result<Vec<ContactState>, MethodError> {
    let posed = Increment {
        tolerance: TOLERANCE,
        ..*increment
    };
    let mut states = Vec::new();
    for name in ASKED {
        let Ok(choice) = Choice::parse(name) else {
            continue;
        };
        let Ok(mut solver) = Solver::new(&choice, increment.system) else {
            continue;
        };
        states.push(solver.solve(&posed).0?.state);
    }
    let (name, starts) = FROM_ELSEWHERE;
    if let Ok(choice) = Choice::parse(name) {
        let mut method = choice.build();
        for number in 0..starts {
            let guess = guess(&posed, number)?;
            let posed = Increment {
                guess: guess.as_deref(),
                ..posed
            };
            states.push(method.solve(&posed, &mut Silent)?.state);
        }
    }
    Ok(states)
}
