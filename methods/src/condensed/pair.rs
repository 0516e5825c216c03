//! Contact forces with their jump: the iterate of alternating methods.

use crate::condensed::forces::Forces;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;

/// Contact forces, jump rows and rigid amplitudes that fulfil equilibrium.
#[derive(Default)]
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
        let Forces { p, beta } = problem.start();
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
            let mut violation = problem.violation(&self.p, &self.v);
            if violation <= problem.stop {
                problem.jump_into(&self.p, &self.beta, &mut self.v);
                violation = problem.violation(&self.p, &self.v);
            }
            let at = (&self.p[..], &self.beta[..]);
            match problem.check(violation, at, changes, limits, monitor)? {
                Check::GoOn => return Ok(None),
                Check::End(status) => return Ok(Some(status)),
                Check::Corrected => problem.jump_into(&self.p, &self.beta, &mut self.v),
            }
        }
    }

    /// P, k v and k β in one vector of forces.
    pub fn stacked(&self, k: f64) -> Vec<f64> {
        let jumps = self.v.iter().chain(&self.beta).map(|v| k * v);
        self.p.iter().copied().chain(jumps).collect()
    }

    /// Takes what [`stacked`](Self::stacked) gives.
    pub fn unstack(&mut self, k: f64, stacked: &[f64]) {
        let (p, jumps) = stacked.split_at(self.p.len());
        self.p.copy_from_slice(p);
        let own = self.v.iter_mut().chain(&mut self.beta);
        own.zip(jumps).for_each(|(v, jump)| *v = jump / k);
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
