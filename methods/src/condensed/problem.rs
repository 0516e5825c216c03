//! One increment seen from the contact points, as every method starts from it.
//! ```text
//! v = (g, d) = q + W P + Q β,    Qᵀ P = c
//! ```
//! with the start jump already taken off the tangential rows of q. Q and c are empty unless the body floats.

use std::sync::Arc;

use crate::algebra::dense::mul_add;
use crate::algebra::factor::norm;
use crate::algebra::floating::dot;
use crate::contract::judge::{free_jump, natural_map_norm, ratio, reference_force, slip_from};
use crate::contract::operator::{Condensed, RowSet};
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

/// Corrections of q per increment; each gains the digits that W has right.
const MAX_CORRECTIONS: usize = 3;

/// A natural map counts as progress below this fraction of the best before.
const IMPROVEMENT: f64 = 0.99;

/// When to give up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Iterations in all.
    pub iterations: usize,
    /// Iterations without progress.
    pub patience: usize,
}

/// How an increment begins.
pub(crate) enum Begin<'a> {
    /// Nothing closes, or nothing can: there is nothing to iterate on.
    Done(Outcome),
    /// Contact has to be resolved.
    Contact(Reduced<'a>),
}

/// The condensed increment.
pub(crate) struct Reduced<'a> {
    pub increment: &'a Increment<'a>,
    pub condensed: Arc<Condensed>,
    /// Rows in use.
    pub rows: &'a RowSet,
    /// Rows (g, d) for P = 0, β = 0.
    pub q: Vec<f64>,
    /// Displacements for P = 0, pinned unknowns at 0.
    pub free: Vec<f64>,
    /// Forces on the body beside f + Bᵀ P: none, or Nitsche's consistency term.
    pub further: Vec<f64>,
    /// What `Converged` stands for.
    pub claim: Claim,
    /// c in Qᵀ P = c.
    pub balance: Vec<f64>,
    /// Natural map at which methods stop.
    pub stop: f64,
    pub counters: Counters,
    pub history: Vec<Iteration>,
    /// |q| of the natural map's denominator.
    free_jump: f64,
    rescues: usize,
    /// Smallest natural map so far and its iteration.
    best: (f64, usize),
    corrections: usize,
    /// The iterate confirmed last, with its displacements.
    pub confirmed: Option<ContactState>,
}

impl<'a> Reduced<'a> {
    /// Does the one linear solve without contact forces. If it leaves every gap open, that is the solution, and the
    /// body is not even condensed.
    pub fn begin(
        increment: &'a Increment<'a>,
        claim: impl Fn(f64) -> Claim,
    ) -> Result<Begin<'a>, MethodError> {
        increment.check()?;
        let system = increment.system;
        let (elastic, dim) = (system.elastic(), system.dim());
        let mut u = increment.load.force.clone();
        elastic.solve(&mut u)?;
        let counters = Counters {
            solves: 1,
            ..Default::default()
        };
        let jump = increment.jump(&u);
        if elastic.floating().is_empty() && jump.iter().step_by(dim).all(|&g| g >= 0.0) {
            let p = vec![0.0; jump.len()];
            return Ok(Begin::Done(Outcome {
                status: Status::Converged,
                // Slack springs are no modelling error: this holds for every method.
                claim: Claim::Exact,
                state: ContactState { u, p },
                history: vec![Iteration {
                    natural_map: 0.0,
                    changes: 0,
                }],
                counters,
            }));
        }

        let condensed = system.condensed()?;
        if condensed.modes.free > 0 {
            return Ok(Begin::Done(Outcome {
                status: Status::Mechanism,
                claim: claim(condensed.rho),
                state: increment.start.clone(),
                history: Vec::new(),
                counters,
            }));
        }
        let rows = system.row_set();
        let resultant: Vec<f64> = elastic
            .floating()
            .iter()
            .map(|r| -dot(r, &increment.load.force))
            .collect();
        let balance = condensed.modes.balance(&resultant);
        Ok(Begin::Contact(Reduced {
            free_jump: free_jump(increment, &condensed, &rows.restrict(&jump), &balance),
            q: slip_from(rows, dim, &jump, &increment.start_jump()),
            stop: STOP_FRACTION * increment.tolerance,
            history: Vec::new(),
            increment,
            rows,
            rescues: 0,
            best: (f64::INFINITY, 0),
            balance,
            counters,
            free: u,
            further: Vec::new(),
            claim: claim(condensed.rho),
            corrections: 0,
            confirmed: None,
            condensed,
        }))
    }

    /// Number of rows.
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

    /// Contact forces to start from: those of the start state, corrected by the least change that balances the load.
    pub fn start_forces(&self) -> Vec<f64> {
        let mut p = self.rows.restrict(&self.increment.start.p);
        self.rebalance(&mut p);
        p
    }

    /// Rigid amplitudes that bring the jump closest to that at the start.
    pub fn start_amplitudes(&self, p: &[f64]) -> Vec<f64> {
        if self.modes() == 0 {
            return Vec::new();
        }
        let dim = self.increment.system.dim();
        let start = self.increment.start_jump();
        let target = slip_from(self.rows, dim, &start, &start);
        let zero = vec![0.0; self.modes()];
        let v = self.jump(p, &zero);
        let distance: Vec<f64> = target.iter().zip(&v).map(|(t, v)| t - v).collect();
        self.condensed.modes.components(&distance)
    }

    /// Rows of the point that starts at row `start`.
    pub fn rows_at(&self, start: usize) -> usize {
        self.rows.size_at[start]
    }

    /// A vector with one value on normal and one on tangential rows.
    pub fn by_row(&self, normal: f64, tangential: f64) -> Vec<f64> {
        let mut values = vec![tangential; self.len()];
        for &row in &self.rows.start[..self.rows.points()] {
            values[row] = normal;
        }
        values
    }

    /// r by row: 1/(W_nn + extra) for the normal and 1/mean(W_tt + extra) for the tangential rows of a point, so that
    /// tangent frames do not matter. Points that move almost rigidly do not raise r without bound.
    pub fn scales(&self, extra: &[f64]) -> Vec<f64> {
        let w = &self.condensed.w;
        let floor = COMPLIANCE_FLOOR / self.condensed.rho;
        let mut scale = vec![0.0; self.len()];
        for i in 0..self.rows.points() {
            let rows = self.rows.of(i);
            for part in [rows.start..rows.start + 1, rows.start + 1..rows.end] {
                let sum: f64 = part.clone().map(|k| w[(k, k)] + extra[k]).sum();
                let mean = sum / part.len().max(1) as f64;
                scale[part].fill(1.0 / mean.max(floor));
            }
        }
        scale
    }

    /// c − Qᵀ P: what the contact forces lack to balance the load.
    pub fn missing(&self, p: &[f64]) -> Vec<f64> {
        self.condensed
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
        self.condensed.modes.add(&missing, p);
    }

    /// Whether a Newton method that cannot go on by itself may be moved on by [`rescue`](crate::condensed::stages::rescue): after
    /// too long without progress, or where the tangent of a floating body is singular. On the way all points of a piece
    /// may open or slide, but a piece that gets loose again and again is a mechanism.
    pub fn rescue_left(&mut self) -> bool {
        if self.modes() == 0 && !self.stagnates() {
            return false;
        }
        self.rescues += 1;
        self.best.1 = self.counters.iterations;
        self.rescues <= MAX_RESCUES
    }

    /// Whether the natural map has not fallen for [`STAGNATION`] iterations.
    pub fn stagnates(&self) -> bool {
        self.idle() >= STAGNATION
    }

    /// Forgets what progress was: another algorithm takes over.
    pub fn begin_phase(&mut self) {
        self.best = (f64::INFINITY, self.counters.iterations);
    }

    /// Iterations since the natural map last fell.
    pub fn idle(&self) -> usize {
        self.counters.iterations - self.best.1
    }

    /// Rescues before the current one.
    pub fn earlier_rescues(&self) -> usize {
        self.rescues.saturating_sub(1)
    }

    /// What a singular tangent means here.
    pub fn singular(&self) -> Status {
        if self.modes() > 0 {
            Status::Mechanism
        } else {
            Status::SingularTangent
        }
    }

    /// v = q + W P + Q β.
    pub fn jump(&self, p: &[f64], beta: &[f64]) -> Vec<f64> {
        let mut v = self.q.clone();
        mul_add(&self.condensed.w, p, &mut v);
        self.condensed.modes.add(beta, &mut v);
        v
    }

    /// Mean size of the jump without contact forces, or of what balancing the load alone takes; 0 if nothing acts.
    pub fn mean_jump(&self) -> f64 {
        let least = norm(&self.balance) / self.condensed.rho;
        self.free_jump.max(least) / (self.rows.points() as f64).sqrt()
    }

    /// P_ref, the force the natural map is relative to.
    pub fn reference_force(&self, p: &[f64]) -> f64 {
        reference_force(&self.condensed, p, self.free_jump)
    }

    /// The natural map, as the judge computes it.
    pub fn natural_map(&mut self, p: &[f64], v: &[f64]) -> f64 {
        self.counters.local_solves += self.rows.points();
        let friction = self.increment.system.friction();
        let e = natural_map_norm(friction, self.rows, self.condensed.rho, p, v);
        ratio(e, self.reference_force(p))
    }

    /// Notes an iterate in the history; says whether the method ends there, and how. Otherwise counts an iteration.
    pub fn ends(
        &mut self,
        natural_map: f64,
        changes: usize,
        limits: Limits,
        monitor: &mut dyn Monitor,
    ) -> Option<Status> {
        if natural_map < IMPROVEMENT * self.best.0 {
            self.best = (natural_map, self.counters.iterations);
        }
        self.history.push(Iteration {
            natural_map,
            changes,
        });
        let iteration = self.counters.iterations;
        if natural_map <= self.stop {
            Some(Status::Converged)
        } else if !natural_map.is_finite() {
            Some(Status::Diverged)
        } else if !monitor.step(iteration, natural_map) {
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

    /// Checks a converged iterate against K itself, as the judge will: W has lost digits to its own condition.
    ///
    /// If the recovered displacements do not fulfil the laws, q takes up the difference between their jump and the
    /// condensed one, and the method goes on from where it is (`None`): iterative refinement of the condensed problem.
    pub fn confirm(
        &mut self,
        status: Status,
        p: &[f64],
        beta: &[f64],
    ) -> Result<Option<Status>, MethodError> {
        if status != Status::Converged {
            return Ok(Some(status));
        }
        let Some(state) = self.recover(p, beta)? else {
            return Ok(Some(Status::Diverged));
        };
        let increment = self.increment;
        let dim = increment.system.dim();
        let found = slip_from(
            self.rows,
            dim,
            &increment.jump(&state.u),
            &increment.start_jump(),
        );
        let natural_map = self.natural_map(&self.rows.restrict(&state.p), &found);
        if natural_map <= increment.tolerance {
            self.confirmed = Some(state);
            return Ok(Some(status));
        }
        if self.corrections == MAX_CORRECTIONS {
            return Ok(Some(Status::Stalled));
        }
        self.corrections += 1;
        self.counters.iterations += 1;
        self.best = (f64::INFINITY, self.counters.iterations);
        let condensed = self.jump(p, beta);
        for ((q, found), condensed) in self.q.iter_mut().zip(&found).zip(&condensed) {
            *q += found - condensed;
        }
        Ok(None)
    }

    /// Contact forces with all `dim` rows per point.
    pub fn all_forces(&self, p: &[f64]) -> Vec<f64> {
        let system = self.increment.system;
        let mut all = vec![0.0; system.dim() * system.points()];
        for (&row, &force) in self.rows.source.iter().zip(p) {
            all[row] = force;
        }
        all
    }

    /// The state with u = K⁻¹ (f + Bᵀ P) + R α, one solve; `None` if the forces left the finite range. What rounding took
    /// from the balance of P is put back, so that it is small beside P itself however small that has become.
    pub fn recover(
        &mut self,
        p: &[f64],
        beta: &[f64],
    ) -> Result<Option<ContactState>, MethodError> {
        let mut p = p.to_vec();
        self.rebalance(&mut p);
        let p = self.all_forces(&p);
        let elastic = self.increment.system.elastic();
        let mut u = self.increment.load.force.clone();
        elastic.jump().mul_transpose_add(&p, &mut u);
        u.iter_mut().zip(&self.further).for_each(|(u, f)| *u += f);
        if !u.iter().all(|x| x.is_finite()) {
            return Ok(None);
        }
        elastic.solve(&mut u)?;
        self.counters.solves += 1;
        let amplitudes = self.condensed.modes.amplitudes(beta);
        for (r, alpha) in elastic.floating().iter().zip(amplitudes) {
            u.iter_mut().zip(r).for_each(|(u, r)| *u += alpha * r);
        }
        Ok(Some(ContactState { u, p }))
    }

    /// Closes the outcome with the displacements of the last iterate.
    pub fn finish(
        mut self,
        status: Status,
        p: &[f64],
        beta: &[f64],
    ) -> Result<Outcome, MethodError> {
        let state = match self.confirmed.take() {
            Some(state) => Some(state),
            None => self.recover(p, beta)?,
        };
        let state = state.unwrap_or_else(|| self.increment.start.clone());
        Ok(Outcome {
            status,
            claim: self.claim,
            state,
            history: self.history,
            counters: self.counters,
        })
    }
}
