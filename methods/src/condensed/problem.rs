//! One increment seen from the contact points, as every method starts from it.
//! ```text
//! v = (g, d) = q + W P + Q β,    Qᵀ P = c
//! ```
//! with the start jump already taken off the tangential rows of q. Q and c are empty unless the body floats.

use std::sync::Arc;

use crate::algebra::dense::{dot, norm, ratio};
use crate::algebra::rows::RowSet;
use crate::condensed::anchor::Anchor;
use crate::condensed::forces::{End, Forces};
use crate::contract::free_jump::{FreeJump, slip_from};
use crate::contract::judge::Violations;
use crate::contract::operator::{ContactOperator, DelassusForm};
use crate::contract::state::{Claim, ContactState, Counters, Iteration, Monitor, Outcome, Status};
use crate::contract::system::Increment;
use crate::error::MethodError;

/// Methods stop at this fraction of the tolerance: what rounding adds when displacements are recovered must not turn
/// a claim false.
const STOP_FRACTION: f64 = 0.5;

/// Compliance below which a point counts as rigid, as a fraction of the mean 1/ρ.
pub(crate) const COMPLIANCE_FLOOR: f64 = 1e-2;

/// Rescues per increment.
const MAX_RESCUES: usize = 6;

/// Iterations without progress after which a Newton method is moved on.
const STAGNATION: usize = 15;

/// Iterations that most methods need at most: the history holds as many without asking for memory again.
const EXPECTED: usize = 64;

/// Iterations without progress after which a violation below the rounding of W P counts as that.
const AT_REST: usize = 5;

/// A violation counts as progress below this fraction of the best before.
const IMPROVEMENT: f64 = 0.99;

/// When to give up.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Iterations in all.
    pub iterations: usize,
    /// Iterations without progress.
    pub patience: usize,
}

impl Limits {
    /// Both.
    pub fn new(iterations: usize, patience: usize) -> Self {
        Self {
            iterations,
            patience,
        }
    }
}

/// Fate of an iterate that was checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Check {
    /// The method goes on from it.
    GoOn,
    /// It fulfils the condensed laws, but not those of the body: q was corrected, and the jump has to be computed anew.
    Corrected,
    /// The method ends there.
    End(Status),
}

/// How an increment begins.
pub(crate) enum Begin<'a> {
    /// Nothing closes, or nothing can: there is nothing to iterate on.
    Done(Outcome),
    /// Contact has to be resolved.
    Contact(Box<ContactProblem<'a>>),
}

/// The condensed increment, with what happens to every iterate whatever the method: measured, noted, checked, recovered.
pub struct ContactProblem<'a> {
    /// The increment itself.
    pub increment: &'a Increment<'a>,
    /// W, Q and ρ.
    pub operator: Arc<ContactOperator>,
    /// Rows in use.
    pub rows: &'a RowSet,
    /// Rows (g, d) for P = 0, β = 0, in m.
    pub q: Vec<f64>,
    /// c in Qᵀ P = c.
    pub balance: Vec<f64>,
    /// Violation at which methods stop.
    pub stop: f64,
    /// Work done so far.
    pub counters: Counters,
    /// Displacements for P = 0, pinned unknowns at 0.
    pub(crate) free: Arc<Vec<f64>>,
    /// Forces on the body beside f + Bᵀ P: none, or Nitsche's consistency term.
    pub(crate) further: Vec<f64>,
    /// Meaning of `Converged`.
    pub(crate) claim: Claim,
    pub(crate) history: Vec<Iteration>,
    /// `[[u]]` at the start of the increment.
    pub(super) start_jump: Vec<f64>,
    /// s; see [`Residuals`](crate::Residuals).
    scale: f64,
    /// Rounding of W P in the violation measured last; 0 as long as that falls.
    floor: f64,
    rescues: usize,
    /// Whether an iterate short of `stop` was taken for good enough.
    late: bool,
    /// Smallest violation so far and its iteration.
    pub(super) best: (f64, usize),
    pub(super) corrections: usize,
    /// Where the jump is known from the body itself.
    pub(super) anchor: Option<Anchor>,
    /// The iterate confirmed last, with its displacements.
    pub(crate) confirmed: Option<ContactState>,
}

/// Displacements and jump without contact forces.
fn free(increment: &Increment<'_>) -> Result<(Arc<Vec<f64>>, Vec<f64>), MethodError> {
    increment.check()?;
    let u = increment.system.elastic().free(&increment.load.force)?;
    let jump = increment.jump(&u);
    Ok((u, jump))
}

impl<'a> ContactProblem<'a> {
    /// Does the one linear solve without contact forces. If it leaves every gap open, that is the solution, and the
    /// body is not even condensed.
    pub(crate) fn begin(
        increment: &'a Increment<'a>,
        form: DelassusForm,
        claim: impl Fn(f64) -> Claim,
    ) -> Result<Begin<'a>, MethodError> {
        let system = increment.system;
        let (elastic, dim) = (system.elastic(), system.dim());
        let (u, jump) = elastic.on_body(|| free(increment))??;
        let counters = Counters {
            solves: 1,
            ..Default::default()
        };
        if elastic.floating().is_empty() && jump.iter().step_by(dim).all(|&g| g >= 0.0) {
            let p = vec![0.0; jump.len()];
            return Ok(Begin::Done(Outcome {
                status: Status::Converged,
                // Slack springs are no modelling error: this holds for every method.
                claim: Claim::Exact,
                state: ContactState { u: u.to_vec(), p },
                history: vec![Iteration {
                    violation: 0.0,
                    changes: 0,
                }],
                counters,
            }));
        }

        let operator = system.operator(form)?;
        if operator.modes.free > 0 {
            return Ok(Begin::Done(Outcome {
                status: Status::Mechanism,
                claim: claim(operator.rho),
                state: increment.start.clone(),
                history: Vec::new(),
                counters,
            }));
        }
        let free_jump = FreeJump::new(increment, &operator, &jump)?;
        Ok(Begin::Contact(Box::new(ContactProblem {
            scale: free_jump.scale,
            floor: 0.0,
            q: free_jump.q,
            balance: free_jump.balance,
            start_jump: free_jump.start_jump,
            stop: STOP_FRACTION * increment.tolerance,
            history: Vec::with_capacity(EXPECTED),
            increment,
            rows: system.row_set(),
            rescues: 0,
            late: false,
            best: (f64::INFINITY, 0),
            counters,
            free: u,
            further: Vec::new(),
            claim: claim(operator.rho),
            corrections: 0,
            anchor: None,
            confirmed: None,
            operator,
        })))
    }

    /// Number of rows.
    #[expect(clippy::len_without_is_empty, reason = "there is contact to resolve")]
    pub fn len(&self) -> usize {
        self.q.len()
    }

    /// Number of rigid motions.
    pub fn modes(&self) -> usize {
        self.balance.len()
    }

    /// Friction coefficient of point `i`.
    pub fn friction(&self, i: usize) -> f64 {
        self.increment.system.friction()[i]
    }

    /// Contact forces to start from: the guess, corrected by the least change that balances the load.
    pub fn start_forces(&self) -> Vec<f64> {
        let mut p = self.rows.restrict(self.increment.guess());
        self.rebalance(&mut p);
        p
    }

    /// Start of every increment.
    pub fn start(&self) -> Forces {
        let p = self.start_forces();
        let beta = self.start_amplitudes(&p);
        Forces { p, beta }
    }

    /// Rigid amplitudes that bring the jump closest to that at the start.
    pub fn start_amplitudes(&self, p: &[f64]) -> Vec<f64> {
        if self.modes() == 0 {
            return Vec::new();
        }
        let dim = self.increment.system.dim();
        let start = &self.start_jump;
        let target = slip_from(self.rows, dim, start, start);
        let zero = vec![0.0; self.modes()];
        let v = self.jump(p, &zero);
        let distance: Vec<f64> = target.iter().zip(&v).map(|(t, v)| t - v).collect();
        self.operator.modes.components(&distance)
    }

    /// A vector with one value on normal and one on tangential rows.
    pub fn by_row(&self, normal: f64, tangential: f64) -> Vec<f64> {
        let mut values = vec![tangential; self.len()];
        for &row in self.rows.normal() {
            values[row] = normal;
        }
        values
    }

    /// r by row: 1/(W_nn + extra) for the normal and 1/mean(W_tt + extra) for the tangential rows of a point, so that
    /// tangent frames do not matter. Points that move almost rigidly do not raise r without bound.
    pub fn scales(&self, extra: &[f64]) -> Vec<f64> {
        let w = self.operator.w.diagonal();
        let floor = COMPLIANCE_FLOOR / self.operator.rho;
        let mut scale = vec![0.0; self.len()];
        for i in 0..self.rows.points() {
            let rows = self.rows.of(i);
            for part in [rows.start..rows.start + 1, rows.start + 1..rows.end] {
                let sum: f64 = part.clone().map(|k| w[k] + extra[k]).sum();
                let mean = sum / part.len().max(1) as f64;
                scale[part].fill(1.0 / mean.max(floor));
            }
        }
        scale
    }

    /// c − Qᵀ P: what the contact forces lack to balance the load.
    pub fn missing(&self, p: &[f64]) -> Vec<f64> {
        self.operator
            .modes
            .q
            .iter()
            .zip(&self.balance)
            .map(|(q, c)| c - dot(q, p))
            .collect()
    }

    /// Restores Qᵀ P = c by the smallest change. Meant for rounding and iteration errors.
    pub fn rebalance(&self, p: &mut [f64]) {
        let missing = self.missing(p);
        self.operator.modes.add(&missing, p);
    }

    /// Whether a Newton method that cannot go on by itself may be moved on by the sweeps of `stages.rs`: after
    /// too long without progress, or where the tangent of a floating body is singular. On the way all points of a piece
    /// may open or slide, but a piece that gets loose again and again is a mechanism.
    pub(crate) fn rescue_left(&mut self) -> bool {
        if self.modes() == 0 && !self.stagnates() {
            return false;
        }
        self.rescues += 1;
        self.best.1 = self.counters.iterations;
        self.rescues <= MAX_RESCUES
    }

    /// Whether the violation has not fallen for some iterations.
    pub fn stagnates(&self) -> bool {
        self.idle() >= STAGNATION
    }

    /// Forgets what progress was: another algorithm takes over.
    pub(crate) fn begin_phase(&mut self) {
        (self.best, self.late) = ((f64::INFINITY, self.counters.iterations), false);
    }

    /// The same, and forgets where iterates were measured from and how often they were rescued: the algorithm starts where the
    /// increment does.
    pub(crate) fn begin_again(&mut self) {
        self.begin_phase();
        (self.anchor, self.corrections, self.rescues) = (None, 0, 0);
    }

    /// Iterations since the violation last fell.
    pub fn idle(&self) -> usize {
        self.counters.iterations - self.best.1
    }

    /// Rescues before the current one.
    pub(crate) fn earlier_rescues(&self) -> usize {
        self.rescues.saturating_sub(1)
    }

    /// Meaning of a singular tangent.
    pub fn singular(&self) -> Status {
        if self.modes() > 0 {
            Status::Mechanism
        } else {
            Status::SingularTangent
        }
    }

    /// Mean size of the jump without contact forces, or of what balancing the load alone takes; 0 if nothing acts.
    pub(crate) fn mean_jump(&self) -> f64 {
        let least = norm(&self.balance) / self.operator.rho;
        self.scale.max(least) / (self.rows.points() as f64).sqrt()
    }

    /// P_ref, the force that violations are relative to.
    pub fn reference_force(&self) -> f64 {
        self.operator.rho * self.scale
    }

    /// u_ref, the jump that overlap is relative to.
    pub(crate) fn reference_jump(&self) -> f64 {
        self.operator.reference(self.scale).1
    }

    /// η, the largest violation of the contact laws, as the judge computes it; see
    /// [`Residuals::violation`](crate::Residuals::violation).
    pub fn violation(&mut self, p: &[f64], v: &[f64]) -> f64 {
        self.counters.local_solves += self.rows.points();
        let friction = self.increment.system.friction();
        self.floor = if self.idle() >= AT_REST {
            ratio(self.operator.rounding(p), self.reference_jump())
        } else {
            0.0
        };
        Violations::of(friction, self.rows, &self.operator, self.scale, p, v).largest()
    }

    /// That of the iterate noted last.
    pub(crate) fn last_violation(&self) -> f64 {
        self.history.last().map_or(f64::INFINITY, |h| h.violation)
    }

    /// Adds an entry to the history.
    pub(crate) fn note(&mut self, violation: f64, changes: usize) {
        self.history.push(Iteration { violation, changes });
    }

    /// Notes an iterate, which was shown to the monitor, in the history; says whether the method ends there, and how. Otherwise
    /// counts an iteration.
    pub(crate) fn ends(
        &mut self,
        violation: f64,
        changes: usize,
        limits: Limits,
        monitor: &mut dyn Monitor,
    ) -> Option<Status> {
        if violation < IMPROVEMENT * self.best.0 {
            self.best = (violation, self.counters.iterations);
        }
        self.note(violation, changes);
        let iteration = self.counters.iterations;
        // Where rounding is all that is left the judge says what that is worth.
        let at_rest = self.idle() >= AT_REST && violation <= self.floor;
        // What the judge would take is good enough where little patience is left for more.
        let late = !self.late
            && self.idle() >= limits.patience / 2
            && violation <= self.increment.tolerance;
        self.late |= late;
        if violation <= self.stop || late {
            Some(Status::Converged)
        } else if at_rest {
            Some(Status::Rounding)
        } else if !violation.is_finite() {
            Some(Status::Diverged)
        } else if !monitor.step(iteration, violation) {
            Some(Status::Stopped)
        } else if iteration >= limits.iterations {
            Some(Status::MaxIterations)
        } else if iteration >= self.best.1 + limits.patience {
            Some(Status::Stalled)
        } else {
            self.counters.iterations += 1;
            None
        }
    }

    /// Notes an iterate (P, β) of this violation and says what becomes of it. One that has converged is checked against K
    /// itself, as the judge will.
    ///
    /// # Errors
    /// Those of a solve with K.
    pub fn check(
        &mut self,
        violation: f64,
        (p, beta): (&[f64], &[f64]),
        changes: usize,
        limits: Limits,
        monitor: &mut dyn Monitor,
    ) -> Result<Check, MethodError> {
        monitor.iterate(&|| (p.to_vec(), self.jump(p, beta)));
        match self.ends(violation, changes, limits, monitor) {
            None => self.surface(violation, p, beta),
            Some(status) => self.confirm(status, p, beta),
        }
    }

    /// Contact forces with all `dim` rows per point.
    pub fn all_forces(&self, p: &[f64]) -> Vec<f64> {
        let system = self.increment.system;
        self.rows.extend(p, system.dim() * system.points())
    }

    /// Closes the outcome with the displacements of the last iterate.
    pub(crate) fn finish(mut self, end: End) -> Result<Outcome, MethodError> {
        let state = match self.confirmed.take() {
            Some(state) => Some(state),
            None => self.recover(&end.at.p, &end.at.beta)?,
        };
        let state = state.unwrap_or_else(|| self.increment.start.clone());
        Ok(Outcome {
            status: end.status,
            claim: self.claim,
            state,
            history: self.history,
            counters: self.counters,
        })
    }
}
