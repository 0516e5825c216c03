//! Remedies for a problem on which a method gave up: a short list, the method itself with one option changed first.

use stickslip_methods::Increment;

use crate::run::choice::Choice;
use crate::run::path::Solver;
use crate::run::registry::method;

/// Options of the method's own that are changed one by one, in this order, where it has them.
pub const OWN: [(&str, f64); 3] = [("r", 0.1), ("r", 10.0), ("anderson", 5.0)];

/// Other methods, with their defaults, the cheapest first.
pub const OTHERS: [&str; 4] = ["newton-ac", "pdas", "hybrid", "interior-point"];

/// The first of the list that solves the increment, as on the command line; `None` if nothing does.
pub fn of(choice: &Choice, increment: &Increment<'_>) -> Option<String> {
    let own = OWN
        .iter()
        .filter_map(|&(name, value)| changed(choice, name, value));
    let others = OTHERS
        .iter()
        .filter(|name| **name != choice.name())
        .filter_map(|name| Choice::parse(name).ok());
    let mut all = own.chain(others);
    all.find(|remedy| solves(remedy, increment))
        .map(|remedy| remedy.argument())
}

/// The method with one option changed; `None` if it has no such option, or that value already.
fn changed(choice: &Choice, name: &str, value: f64) -> Option<Choice> {
    let mut given = Vec::new();
    let mut known = false;
    for (spec, own) in choice.options() {
        let new = if spec.name() == name {
            value
        } else {
            own.number()
        };
        known |= spec.name() == name && own.number() != value;
        given.push((spec.name().to_owned(), new));
    }
    let method = method(choice.name()).filter(|_| known)?;
    Choice::new(method, &given).ok()
}

/// Whether it does what it is for: an exact method the contact laws, another one its own.
fn solves(choice: &Choice, increment: &Increment<'_>) -> bool {
    Solver::new(choice, increment.system).is_ok_and(|mut solver| {
        let verdict = solver.judge(increment, increment.tolerance).verdict;
        verdict.is_solved() || !choice.exact() && verdict.is_honest()
    })
}
