//! Contact of floating bodies as a saddle point, augmented so that methods that sweep over the points can hold them.
//! ```text
//! v = q + W P + Q β,  Qᵀ P = c      for any κ > 0 the same as
//! v = q' + W' P + Q γ,  Qᵀ P = c    W' = Π W Π + κ Q Qᵀ,  q' = Π (q + W Q c) − κ Q c,  Π = I − Q Qᵀ
//! γ <- γ + κ (Qᵀ P − c)             method of multipliers
//! ```
//! (Hestenes, J. Optim. Theory Appl. 4 (1969) 303; Powell 1969.) W' is definite on the rigid motions, and neither it nor
//! the iterates depend on the pins behind W. With P' = P + Q (c − Qᵀ P), the nearest balanced forces, and the updated γ
//! the true jump of P' is q' + W' P + Q γ(old): judging the iterate costs nothing. Without rigid motions W' = W, q' = q.

use std::borrow::Cow;
use std::sync::Arc;

use faer::Mat;

use crate::algebra::delassus::{Delassus, Dense};
use crate::algebra::dense::{add, dot};
use crate::algebra::plain::Full;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::contract::operator::ContactOperator;
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;

/// κ as a multiple of 1/ρ. Larger values hold a rigid body faster and couple its points more: with 3, sweeps over the
/// points of some bodies cycle.
const AUGMENTATION: f64 = 1.0;

/// Iterations after which v is computed afresh.
pub(crate) const REFRESH: usize = 100;

/// The augmented operator of a system.
pub(crate) struct Saddle {
    operator: Arc<ContactOperator>,
    /// W' where it differs from W.
    own: Option<Dense>,
    /// κ in m/N.
    pub kappa: f64,
}

/// Forces P, multipliers γ and v = q' + W' P + Q γ.
#[derive(Default)]
pub(crate) struct Iterate {
    pub p: Vec<f64>,
    pub gamma: Vec<f64>,
    pub v: Vec<f64>,
}

impl Iterate {
    /// self := x, in the memory of self.
    pub fn copy(&mut self, x: &Iterate) {
        self.p.clone_from(&x.p);
        self.gamma.clone_from(&x.gamma);
        self.v.clone_from(&x.v);
    }
}

impl Saddle {
    pub fn new(operator: Arc<ContactOperator>) -> Self {
        let kappa = AUGMENTATION / operator.rho;
        let own = (operator.modes.len() > 0).then(|| augment(&operator, kappa));
        Self {
            operator,
            own,
            kappa,
        }
    }

    /// W'.
    pub fn w(&self) -> &dyn Delassus {
        match &self.own {
            Some(own) => own,
            None => &*self.operator.w,
        }
    }

    /// The iterate every method starts from.
    pub fn start(&self, problem: &ContactProblem<'_>) -> Iterate {
        self.at(problem, problem.start_forces())
    }

    /// The iterate of given forces.
    pub fn at(&self, problem: &ContactProblem<'_>, p: Vec<f64>) -> Iterate {
        let beta = problem.start_amplitudes(&p);
        let v = problem.jump(&p, &beta);
        Iterate {
            gamma: self.operator.modes.components(&v),
            v,
            p,
        }
    }

    /// Judges an iterate whose multipliers are not yet updated, as [`ContactProblem::ends`] and [`ContactProblem::confirm`] do: says
    /// how the method ends there. Claims nothing without a fresh v.
    pub fn ends(
        &self,
        problem: &mut ContactProblem<'_>,
        x: &mut Iterate,
        changes: usize,
        limits: Limits,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Status>, MethodError> {
        loop {
            let p = self.nearest(problem, &x.p);
            let mut violation = problem.violation(&p, &x.v);
            if violation <= problem.stop {
                self.refresh(problem, x);
                let (p, beta) = self.balanced(problem, x);
                let v = problem.jump(&p, &beta);
                violation = problem.violation(&p, &v);
            }
            monitor.iterate(&|| self.seen(problem, x));
            let Some(status) = problem.ends(violation, changes, limits, monitor) else {
                return Ok(None);
            };
            let (p, beta) = self.balanced(problem, x);
            if let Check::End(status) = problem.confirm(status, &p, &beta)? {
                return Ok(Some(status));
            }
            self.refresh(problem, x);
        }
    }

    /// The nearest balanced forces and their jump, γ not yet updated.
    fn seen(&self, problem: &ContactProblem<'_>, x: &Iterate) -> (Vec<f64>, Vec<f64>) {
        (self.nearest(problem, &x.p).into_owned(), x.v.clone())
    }

    /// The nearest balanced forces: P itself unless the body floats.
    fn nearest<'p>(&self, problem: &ContactProblem<'_>, p: &'p [f64]) -> Cow<'p, [f64]> {
        let mut nearest = Cow::Borrowed(p);
        if self.operator.modes.len() > 0 {
            problem.rebalance(nearest.to_mut());
        }
        nearest
    }

    /// Computes v afresh.
    pub fn refresh(&self, problem: &ContactProblem<'_>, x: &mut Iterate) {
        let modes = &self.operator.modes;
        x.v.clone_from(&problem.q);
        if modes.len() > 0 {
            let mut least = vec![0.0; x.p.len()];
            modes.add(&problem.balance, &mut least);
            self.operator.w.apply_add(&least, &mut x.v);
            modes.project_out(&mut x.v);
            let held: Vec<f64> = (x.gamma.iter().zip(&problem.balance))
                .map(|(g, c)| g - self.kappa * c)
                .collect();
            modes.add(&held, &mut x.v);
        }
        self.w().apply_add(&x.p, &mut x.v);
    }

    /// P and γ/κ in one vector of forces.
    pub fn stacked(&self, x: &Iterate) -> Vec<f64> {
        let held = x.gamma.iter().map(|gamma| gamma / self.kappa);
        x.p.iter().copied().chain(held).collect()
    }

    /// Takes what [`stacked`](Self::stacked) gives, and computes v if it is something else.
    pub fn unstack(&self, problem: &ContactProblem<'_>, x: &mut Iterate, stacked: &[f64]) {
        if self.stacked(x) == stacked {
            return;
        }
        let (p, held) = stacked.split_at(x.p.len());
        x.p.copy_from_slice(p);
        let own = x.gamma.iter_mut().zip(held);
        own.for_each(|(gamma, held)| *gamma = self.kappa * held);
        self.refresh(problem, x);
    }

    /// γ <- γ + κ (Qᵀ P − c).
    pub fn update_multipliers(&self, problem: &ContactProblem<'_>, x: &mut Iterate) {
        let step: Vec<f64> = (problem.missing(&x.p).iter())
            .map(|missing| -self.kappa * missing)
            .collect();
        x.gamma.iter_mut().zip(&step).for_each(|(g, s)| *g += s);
        self.operator.modes.add(&step, &mut x.v);
    }

    /// The nearest balanced forces P' and the amplitudes β for which v is their jump, γ not yet updated.
    pub fn balanced(&self, problem: &ContactProblem<'_>, x: &Iterate) -> (Vec<f64>, Vec<f64>) {
        let p = self.nearest(problem, &x.p).into_owned();
        if self.operator.modes.len() == 0 {
            return (p, Vec::new());
        }
        let zero = vec![0.0; problem.modes()];
        let fixed = problem.jump(&p, &zero);
        let rigid: Vec<f64> = x.v.iter().zip(&fixed).map(|(v, f)| v - f).collect();
        (p, self.operator.modes.components(&rigid))
    }
}

/// Π W Π + κ Q Qᵀ.
fn augment(operator: &ContactOperator, kappa: f64) -> Dense {
    let (q, w) = (&operator.modes.q, &operator.w);
    let m = w.rows();
    let each = |product: &dyn Fn(&[f64], &mut [f64])| -> Vec<Vec<f64>> {
        let one = |q: &Vec<f64>| {
            let mut found = vec![0.0; m];
            product(q, &mut found);
            found
        };
        q.iter().map(one).collect()
    };
    let wq = each(&|q, wq| w.apply_add(q, wq));
    let qw = if w.symmetric() {
        wq.clone()
    } else {
        each(&|q, qw| w.apply_transpose_add(q, qw))
    };
    // Π W Π = W − Q (Qᵀ W) − (W Q) Qᵀ + Q (Qᵀ W Q) Qᵀ.
    let inner = Mat::from_fn(q.len(), q.len(), |a, b| dot(&q[a], &wq[b]));
    let augmented = Full::of_columns(m, m, |j, column| {
        column.copy_from_slice(w.column(j, &mut Vec::new()));
        for a in 0..q.len() {
            let back: f64 = (0..q.len()).map(|b| inner[(a, b)] * q[b][j]).sum();
            add(kappa * q[a][j] - qw[a][j] + back, &q[a], column);
            add(-q[a][j], &wq[a], column);
        }
    });
    Dense::new(augmented, w.symmetric())
}
