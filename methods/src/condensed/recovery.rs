//! From iterates to displacements, and back: iterative refinement of the condensed problem on the body itself.
//!
//! W has lost digits to its own condition, and v = q + W P more where slender parts sway by 10⁵ times what they deform. So
//! an iterate that holds to be solved is recovered and measured as the judge will. If its displacements do not fulfil the
//! laws, it becomes the anchor, from which the method goes on: what is computed then are differences, and what rounding
//! spoils is relative to those.

use crate::algebra::dense::{minus, norm};
use crate::condensed::anchor::Anchor;
use crate::condensed::forces::Forces;
use crate::condensed::problem::{Check, ContactProblem};
use crate::contract::free_jump::slip_from;
use crate::contract::judge::imbalance;
use crate::contract::state::{ContactState, Status};
use crate::error::MethodError;

/// Corrections of q per increment; each gains the digits that W has right.
const MAX_CORRECTIONS: usize = 3;

/// Violations below this may be rounding of W P where slender parts sway, once they have not fallen for some iterations.
const DROWNED: f64 = 1e-3;
const DROWNING: usize = 3;

/// Backward error of equilibrium that displacements from an anchor may have: half of what the judge allows.
const BALANCED: f64 = 5e-13;

impl ContactProblem<'_> {
    /// v = q + W P + Q β.
    pub fn jump(&self, p: &[f64], beta: &[f64]) -> Vec<f64> {
        let mut v = Vec::new();
        self.jump_into(p, beta, &mut v);
        v
    }

    /// The same in place of what `v` holds.
    pub(crate) fn jump_into(&self, p: &[f64], beta: &[f64], v: &mut Vec<f64>) {
        match &self.anchor {
            Some(anchor) => {
                let step = anchor.step_to(p, beta);
                v.clone_from(&anchor.v);
                self.add_jump(&step.p, &step.beta, v);
            }
            None => {
                v.clone_from(&self.q);
                self.add_jump(p, beta, v);
            }
        }
    }

    /// v := v + W δP + Q δβ.
    fn add_jump(&self, p: &[f64], beta: &[f64], v: &mut [f64]) {
        self.operator.w.apply_add(p, v);
        self.operator.modes.add(beta, v);
    }

    /// Checks a converged iterate against K itself. If it falls short, the method goes on from its displacements.
    pub(crate) fn confirm(
        &mut self,
        status: Status,
        p: &[f64],
        beta: &[f64],
    ) -> Result<Check, MethodError> {
        if status != Status::Converged {
            return Ok(Check::End(status));
        }
        let Some(mut state) = self.recover(p, beta)? else {
            return Ok(Check::End(Status::Diverged));
        };
        if self.anchor.is_some() && self.imbalance(&state)? > BALANCED {
            // It once stood far away: what was rounded there is still in its displacements.
            self.anchor = None;
            match self.recover(p, beta)? {
                Some(fresh) => state = fresh,
                None => return Ok(Check::End(Status::Diverged)),
            }
        }
        let found = self.slip_of(&state.u);
        let violation = self.violation(&self.rows.restrict(&state.p), &found);
        if violation <= self.increment.tolerance {
            self.confirmed = Some(state);
            return Ok(Check::End(status));
        }
        if self.last_violation() > self.stop {
            // It was taken late, for less than methods stop at.
            self.counters.iterations += 1;
            return Ok(Check::GoOn);
        }
        if self.corrections == MAX_CORRECTIONS {
            return Ok(Check::End(Status::Stalled));
        }
        self.counters.iterations += 1;
        self.move_anchor(state, found, p, beta);
        Ok(Check::Corrected)
    }

    /// Backward error of equilibrium, as the judge measures it.
    fn imbalance(&self, state: &ContactState) -> Result<f64, MethodError> {
        let none = vec![0.0; state.u.len()];
        let further = if self.further.is_empty() {
            &none
        } else {
            &self.further
        };
        let elastic = self.increment.system.elastic();
        elastic.on_body(|| imbalance(self.increment, state, further))
    }

    /// Puts the anchor to an iterate whose violation no longer falls because slender parts sway: what is left of it is
    /// rounding of W P.
    pub(crate) fn surface(
        &mut self,
        violation: f64,
        p: &[f64],
        beta: &[f64],
    ) -> Result<Check, MethodError> {
        let swaying = self.operator.sharp > self.operator.rho;
        let drowned = swaying && violation < DROWNED && self.idle() >= DROWNING;
        if drowned
            && self.corrections < MAX_CORRECTIONS
            && let Some(state) = self.recover(p, beta)?
        {
            let found = self.slip_of(&state.u);
            self.move_anchor(state, found, p, beta);
            return Ok(Check::Corrected);
        }
        Ok(Check::GoOn)
    }

    /// x + t step in place of what `moved` holds, and its jump in place of `v`.
    pub(crate) fn jump_after(
        &self,
        x: &Forces,
        t: f64,
        step: &Forces,
        moved: &mut Forces,
        v: &mut Vec<f64>,
    ) {
        moved.copy(x);
        moved.move_along(t, step);
        match &self.anchor {
            Some(anchor) if anchor.at.p == x.p => {
                let step = scaled(t, step);
                v.clone_from(&anchor.v);
                self.add_jump(&step.p, &step.beta, v);
            }
            _ => self.jump_into(&moved.p, &moved.beta, v),
        }
    }

    /// Whether [`move_along`](Self::move_along) gives anything but x + t step, with the jump of that.
    pub(crate) fn corrects_steps(&self) -> bool {
        self.modes() > 0 || self.anchor.is_some()
    }

    /// x := x + t step, balanced. If x is the anchor, its displacements go along: they follow from the step itself, whose
    /// digits P + t step does not keep.
    pub(crate) fn move_along(
        &mut self,
        x: &mut Forces,
        t: f64,
        step: &Forces,
    ) -> Result<(), MethodError> {
        let anchored = (self.anchor.as_ref()).is_some_and(|anchor| anchor.at.p == x.p);
        x.move_along(t, step);
        self.rebalance(&mut x.p);
        if anchored && let Some(u) = self.displaced(&scaled(t, step))? {
            let v = self.slip_of(&u);
            let p = self.balanced(&x.p);
            self.anchor = Some(Anchor {
                at: x.clone(),
                v,
                state: ContactState { u, p },
            });
        }
        Ok(())
    }

    /// From an iterate with its recovered displacements, and the rows found on them, all is computed relative to it.
    fn move_anchor(&mut self, state: ContactState, found: Vec<f64>, p: &[f64], beta: &[f64]) {
        self.corrections += 1;
        self.best = (f64::INFINITY, self.counters.iterations);
        self.correct(&found, p, beta);
        self.anchor = Some(Anchor {
            at: Forces::of(p, beta),
            v: found,
            state,
        });
    }

    /// Rows (g, d) of displacements.
    pub(crate) fn slip_of(&self, u: &[f64]) -> Vec<f64> {
        let (increment, dim) = (self.increment, self.increment.system.dim());
        slip_from(self.rows, dim, &increment.jump(u), &self.start_jump)
    }

    /// q takes up the difference between the jump found on the body and the condensed one.
    pub(crate) fn correct(&mut self, found: &[f64], p: &[f64], beta: &[f64]) {
        let condensed = self.jump(p, beta);
        for ((q, found), condensed) in self.q.iter_mut().zip(found).zip(&condensed) {
            *q += found - condensed;
        }
    }

    /// The state with u = G (f + Bᵀ P) + R α, one solve; `None` if the forces left the finite range. What rounding took
    /// from the balance of P is put back, so that it is small beside P itself however small that has become.
    pub(crate) fn recover(
        &mut self,
        p: &[f64],
        beta: &[f64],
    ) -> Result<Option<ContactState>, MethodError> {
        let p = self.balanced(p);
        let step = match &self.anchor {
            Some(anchor) => Forces {
                p: self.rows.restrict(&minus(&p, &anchor.state.p)),
                beta: minus(beta, &anchor.at.beta),
            },
            None => Forces::of(&self.rows.restrict(&p), beta),
        };
        Ok(self.displaced(&step)?.map(|u| ContactState { u, p }))
    }

    /// All contact forces of an iterate, balanced; none where all they are is the rounding of larger ones.
    fn balanced(&self, p: &[f64]) -> Vec<f64> {
        let mut p = p.to_vec();
        self.rebalance(&mut p);
        if norm(&p) <= f64::EPSILON * self.reference_force() {
            p.fill(0.0);
        }
        self.all_forces(&p)
    }

    /// Displacements after a step from the anchor, or from no contact forces, one solve; `None` if they left the finite range.
    fn displaced(&mut self, step: &Forces) -> Result<Option<Vec<f64>>, MethodError> {
        let elastic = self.increment.system.elastic();
        elastic.on_body(|| self.displace(step))?
    }

    fn displace(&mut self, step: &Forces) -> Result<Option<Vec<f64>>, MethodError> {
        let elastic = self.increment.system.elastic();
        let mut u = match &self.anchor {
            Some(_) => vec![0.0; self.free.len()],
            None => self.increment.load.force.clone(),
        };
        let forces = self.all_forces(&step.p);
        elastic.jump().mul_transpose_add(&forces, &mut u);
        if self.anchor.is_none() {
            u.iter_mut().zip(&self.further).for_each(|(u, f)| *u += f);
        }
        if !u.iter().all(|x| x.is_finite()) {
            return Ok(None);
        }
        let amplitudes = self.operator.modes.amplitudes(&step.beta);
        let f = (!amplitudes.is_empty()).then(|| u.clone());
        elastic.solve(&mut u)?;
        self.counters.solves += 1;
        for (r, alpha) in elastic.floating().iter().zip(&amplitudes) {
            u.iter_mut().zip(r).for_each(|(u, r)| *u += alpha * r);
        }
        if let (Some(f), Some(k)) = (f, elastic.stiffness())
            && elastic.imbalance(&u, &[&f]) > BALANCED
        {
            // K r vanishes to rounding of K alone, and r may be far larger than what deforms, or than forces on a sliver allow.
            let mut rest = vec![0.0; u.len()];
            k.mul(&u, &mut rest);
            let mut rest = minus(&f, &rest);
            elastic.solve(&mut rest)?;
            self.counters.solves += 1;
            u.iter_mut().zip(&rest).for_each(|(u, rest)| *u += rest);
        }
        if let Some(anchor) = &self.anchor {
            let known = &anchor.state.u;
            u.iter_mut().zip(known).for_each(|(u, known)| *u += known);
        }
        Ok(Some(u))
    }
}

fn scaled(t: f64, step: &Forces) -> Forces {
    let times = |x: &[f64]| x.iter().map(|x| t * x).collect();
    Forces {
        p: times(&step.p),
        beta: times(&step.beta),
    }
}
