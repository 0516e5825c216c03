//! Common steps of methods on the condensed increment: begin, iterate, finish.

use crate::condensed::forces::{End, Ended};
use crate::condensed::problem::{Begin, ContactProblem};
use crate::contract::registry::{Enforcement, Needs};
use crate::contract::state::{Claim, Monitor, Outcome, Status};
use crate::contract::system::{ContactSystem, Increment};
use crate::error::MethodError;

/// A method that iterates on the condensed increment, once contact has to be resolved.
pub trait CondensedMethod: Send {
    /// Why the method cannot treat this system; `None` if it can.
    fn refuses(&self, _system: &ContactSystem) -> Option<String> {
        None
    }

    /// Needs of the method.
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// Meaning of [`Status::Converged`] on a body of scale ρ.
    fn claim(&self, _rho: f64) -> Claim {
        Claim::Exact
    }

    /// Iterates until it ends, one way or another.
    ///
    /// # Errors
    /// Input that no method could treat; see [`MethodError`].
    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended;
}

impl End {
    /// Given up at the start of the increment.
    pub fn at_start(problem: &ContactProblem<'_>) -> Self {
        Self {
            status: Status::Stalled,
            at: problem.start(),
        }
    }
}

impl<M: CondensedMethod> Enforcement for M {
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        let needs = CondensedMethod::needs(self);
        CondensedMethod::refuses(self, system).or_else(|| needs.refuses(system))
    }

    fn needs(&self) -> Needs {
        CondensedMethod::needs(self)
    }

    fn solve(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        let form = CondensedMethod::needs(self).delassus;
        match ContactProblem::begin(increment, form, |rho| self.claim(rho))? {
            Begin::Done(outcome) => Ok(outcome),
            Begin::Contact(mut problem) => {
                let end = self.iterate(&mut problem, monitor)?;
                problem.finish(end)
            }
        }
    }
}
