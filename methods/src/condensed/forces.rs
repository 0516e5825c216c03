//! Iterates of methods on the condensed increment: contact forces with what goes with them.

use crate::algebra::dense::along;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;

/// Contact forces on the rows in use and amplitudes of the rigid motions, or a step of both.
#[derive(Debug, Clone)]
pub struct Forces {
    /// P by row, in N (2D: N/m).
    pub p: Vec<f64>,
    /// β by rigid motion, in m; empty unless the body floats.
    pub beta: Vec<f64>,
}

impl Forces {
    /// What every increment starts from.
    pub fn start(problem: &ContactProblem<'_>) -> Self {
        let p = problem.start_forces();
        let beta = problem.start_amplitudes(&p);
        Self { p, beta }
    }

    /// self + t step.
    pub fn moved(&self, t: f64, step: &Forces) -> Self {
        Self {
            p: along(&self.p, t, &step.p),
            beta: along(&self.beta, t, &step.beta),
        }
    }
}

/// Contact forces, jump rows and rigid amplitudes that fulfil equilibrium.
pub(crate) struct Pair {
    pub p: Vec<f64>,
    pub v: Vec<f64>,
    pub beta: Vec<f64>,
}

impl From<Pair> for Forces {
    fn from(Pair { p, beta, .. }: Pair) -> Self {
        Self { p, beta }
    }
}

impl Pair {
    /// The pair every method starts from.
    pub fn start(problem: &ContactProblem<'_>) -> Self {
        let Forces { p, beta } = Forces::start(problem);
        Self {
            v: problem.jump(&p, &beta),
            p,
            beta,
        }
    }

    /// Checks the pair as [`ContactProblem::check`] does, and says how the method ends there. A relaxed v carries the
    /// rounding of all stages before: nothing is claimed without a fresh one.
    pub fn ends(
        &mut self,
        problem: &mut ContactProblem<'_>,
        changes: usize,
        limits: Limits,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Status>, MethodError> {
        loop {
            let mut natural_map = problem.natural_map(&self.p, &self.v);
            if natural_map <= problem.stop {
                self.v = problem.jump(&self.p, &self.beta);
                natural_map = problem.natural_map(&self.p, &self.v);
            }
            let at = (&self.p[..], &self.beta[..]);
            match problem.check(natural_map, at, changes, limits, monitor)? {
                Check::GoOn => return Ok(None),
                Check::End(status) => return Ok(Some(status)),
                Check::Corrected => self.v = problem.jump(&self.p, &self.beta),
            }
        }
    }

    /// self += ω (new − self).
    pub fn relax(&mut self, problem: &ContactProblem<'_>, omega: f64, new: &Pair) {
        let step = |x: &mut [f64], new: &[f64]| {
            x.iter_mut()
                .zip(new)
                .for_each(|(x, new)| *x += omega * (new - *x));
        };
        step(&mut self.p, &new.p);
        step(&mut self.v, &new.v);
        step(&mut self.beta, &new.beta);
        problem.rebalance(&mut self.p);
    }
}
