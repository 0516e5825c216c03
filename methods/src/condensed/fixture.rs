//! Contact problems for unit tests.

use std::sync::Arc;

use crate::condensed::problem::{Begin, ContactProblem};
use crate::contract::elastic::Elastic;
use crate::contract::operator::DelassusForm;
use crate::contract::state::{Claim, ContactState};
use crate::contract::system::{ContactSystem, Increment, Load};

/// Runs a test on the first increment of a body under a load that closes the contact.
pub(crate) fn with_contact<T>(
    body: &Arc<Elastic>,
    friction: Vec<f64>,
    (force, offset): (Vec<f64>, Vec<f64>),
    test: impl FnOnce(&Increment<'_>, ContactProblem<'_>) -> T,
) -> T {
    let system = ContactSystem::new(body.clone(), friction).unwrap();
    let load = Load {
        force,
        offset,
        traction: vec![],
    };
    let increment = Increment {
        system: &system,
        load: &load,
        start_load: &Load::zero(body),
        start: &ContactState::zero(&system),
        guess: None,
        index: 0,
        tolerance: 1e-9,
    };
    let begun = ContactProblem::begin(&increment, DelassusForm::Formed, |_| Claim::Exact);
    let Begin::Contact(problem) = begun.unwrap() else {
        panic!("the load must close the contact");
    };
    test(&increment, *problem)
}
