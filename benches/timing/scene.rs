//! One increment of a case, ready for any method: K factored and condensed, start state reached.

use std::sync::Arc;
use std::time::Duration;

use stickslip::model::body::{Body, Needs};
use stickslip::model::loading::Loading;
use stickslip::run::choice::Choice;
use stickslip::run::path::Solver;
use stickslip::run::registry::method;
use stickslip::run::verdict::Verdict;
use stickslip_methods::{
    ContactState, ContactSystem, Enforcement, Increment, Load, Outcome, Silent, Tier,
};

use crate::{EXACT, Problem};

/// The increment of a load path in which an exact method took the most iterations.
pub struct Scene {
    system: ContactSystem,
    load: Load,
    start_load: Load,
    start: ContactState,
    index: usize,
}

impl Scene {
    /// Follows the load path to its end with an exact method.
    pub fn new(problem: &Problem) -> Self {
        let case = problem.case();
        let needs = Needs {
            frictionless: Vec::new(),
            traction: true,
        };
        let body =
            Body::new(&case, problem.refine, &needs).expect("shipped cases can be discretised");
        let friction = vec![problem.friction; body.points.len()];
        let system =
            || ContactSystem::new(Arc::clone(&body.elastic), friction.clone()).expect("valid");
        let path = system();
        path.condense().expect("the body is held");
        let loading = Loading::new(&body, &case, problem.friction).expect("the closed form holds");
        let exact = Choice::new(method(EXACT).expect("registered"), &[]).expect("defaults");
        let mut solver = Solver::new(&exact, &path).expect("an exact method takes every case");
        let mut start = ContactState::zero(&path);
        let mut start_load = loading.before(loading.first());
        let mut hardest = None;
        for (index, increment) in (loading.first()..=loading.increments()).enumerate() {
            let load = loading.at(increment);
            let scene = Scene {
                system: system(),
                load: load.clone(),
                start_load,
                start,
                index,
            };
            let tried = solver.judge(&scene.increment(), Tier::High.tolerance());
            assert_eq!(tried.verdict, Verdict::Solved, "{}", case.name);
            let outcome = tried.judged.expect("solved").outcome;
            let iterations = outcome.counters.iterations;
            if hardest.as_ref().is_none_or(|(most, _)| iterations > *most) {
                hardest = Some((iterations, scene));
            }
            (start, start_load) = (outcome.state, load);
        }
        hardest.expect("a load path has an increment").1
    }

    /// The increment, to the highest accuracy.
    pub fn increment(&self) -> Increment<'_> {
        Increment {
            system: &self.system,
            load: &self.load,
            start_load: &self.start_load,
            start: &self.start,
            guess: None,
            index: self.index,
            tolerance: Tier::High.tolerance(),
        }
    }

    /// Verdict of the judge on a method on this increment. Afterwards all is computed that methods share.
    pub fn judge(&self, choice: &Choice) -> Verdict {
        let solver = Solver::new(choice, &self.system);
        solver.map_or_else(
            |verdict| verdict,
            |mut solver| {
                solver
                    .judge(&self.increment(), Tier::High.tolerance())
                    .verdict
            },
        )
    }

    /// A new instance of a method that has seen nothing.
    pub fn build(&self, choice: &Choice) -> Box<dyn Enforcement> {
        choice.build()
    }

    /// Prepares a method.
    pub fn prepare(&self, solver: &mut dyn Enforcement) {
        solver.prepare(&self.system).expect("K is factored");
    }

    /// A method built and prepared.
    pub fn solver(&self, choice: &Choice) -> Solver<'_> {
        Solver::new(choice, &self.system).expect("the judge accepted it")
    }

    /// Time to solve the increment without the work on all unknowns of the body.
    pub fn enforcement(&self, solver: &mut Solver<'_>) -> Duration {
        let (outcome, seconds) = solver.solve(&self.increment());
        std::hint::black_box(outcome.expect("the input is valid"));
        Duration::from_secs_f64(seconds.enforcement_s)
    }

    /// Solves the increment.
    pub fn solve(&self, solver: &mut dyn Enforcement) -> Outcome {
        let solved = solver.solve(&self.increment(), &mut Silent);
        solved.expect("the input is valid")
    }
}
