//! Penalised contact equations and their Newton solver, shared by the penalty and augmented Lagrangian methods.
//! ```text
//! P = Π(A − k v),  v = q + W P + Q β,  Qᵀ P = c
//! ```
//! with Π the return mapping of the law, k_n and k_t the penalty stiffnesses and A the anchor: contact forces the
//! springs start from (penalty: A = (0, P_t at the start of the increment); augmented Lagrangian: the multipliers).
//!
//! The springs sit in series with the body: in terms of v' = v + (P − A)/k the law is the exact one, P = Π(P − r v')
//! for *any* r > 0. Newton's method runs on
//! ```text
//! F(z, β) = (z − P)/r + v'(P, β) = 0,   P = Π(z)
//! ```
//! with the consistent tangent through Π'(z), non-symmetric where points slip (Simo & Laursen 1992). r = k gives the
//! textbook iteration z = A − k v. We take r = 1/(W_ii + 1/k): the solution is the same, but for k far above the
//! stiffness of the body the textbook trial overshoots from slip one way to slip the other and cycles.
//!
//! A further, full compliance C and stretch c₀ may lie in series, v' = v + (P − A)/k + C P + c₀: Nitsche's method, whose
//! springs are rigid otherwise.
//!
//! Points with Π'(z) = 0 (open) are eliminated. Full steps first, then the non-monotone line search.

#![allow(non_snake_case)]

use crate::algebra::delassus::Series;
use crate::algebra::dense::{mul_add, ratio, refill, zero};
use crate::condensed::branches::changed;
use crate::condensed::forces::Forces;
use crate::condensed::pair::Pair;
use crate::condensed::point_row::PointRow;
use crate::condensed::problem::ContactProblem;
use crate::condensed::stages::rescue;
use crate::contract::law::{Branch, return_map, return_map_derivative};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;
use crate::newton::line_search::LineSearch;
use crate::newton::step::{Tangent, body_step};

/// Below this a residual that no longer halves has met rounding.
const ROUNDING: f64 = 1e-12;

/// The penalised laws.
pub(crate) struct Springs<'a> {
    /// A by row.
    pub anchor: Vec<f64>,
    /// 1/k by row.
    compliance: Vec<f64>,
    /// r by row.
    r: Vec<f64>,
    coupled: Option<Coupled<'a>>,
}

/// Springs between all rows, which only the condensed tangent knows.
pub(crate) struct Coupled<'a> {
    /// W + C.
    pub series: &'a Series,
    /// c₀ by row.
    pub stretch: Vec<f64>,
}

impl<'a> Springs<'a> {
    /// With stiffnesses k_n and k_t, in N/m.
    pub fn new(
        problem: &ContactProblem<'_>,
        (normal, tangential): (f64, f64),
        anchor: Vec<f64>,
        coupled: Option<Coupled<'a>>,
    ) -> Self {
        let compliance = problem.by_row(1.0 / normal, 1.0 / tangential);
        let mut all = compliance.clone();
        if let Some(coupled) = &coupled {
            let further = coupled.series.compliance();
            (all.iter_mut().enumerate()).for_each(|(k, c)| *c += further[(k, k)]);
        }
        Self {
            r: problem.scales(&all),
            anchor,
            compliance,
            coupled,
        }
    }

    /// v' by row in place of what `v` holds.
    fn stretched(&self, problem: &ContactProblem<'_>, p: &[f64], beta: &[f64], v: &mut Vec<f64>) {
        problem.jump_into(p, beta, v);
        for (k, c) in self.compliance.iter().enumerate() {
            v[k] += c * (p[k] - self.anchor[k]);
        }
        if let Some(Coupled { series, stretch }) = &self.coupled {
            mul_add(series.compliance(), p, v);
            v.iter_mut().zip(stretch).for_each(|(v, c)| *v += c);
        }
    }
}

/// An iterate.
#[derive(Default)]
pub(crate) struct Trial {
    z: Vec<f64>,
    /// Π(z), β.
    pub forces: Forces,
    branches: Vec<Branch>,
    /// F by row, in m.
    mismatch: Vec<f64>,
}

impl Trial {
    /// Takes z + t δz and β + t δβ.
    fn take(
        &mut self,
        problem: &ContactProblem<'_>,
        springs: &Springs<'_>,
        (z, beta): (&[f64], &[f64]),
        (t, step): (f64, &Forces),
    ) {
        let moved = |x: &mut Vec<f64>, from: &[f64], step: &[f64]| {
            refill(x, from.iter().zip(step).map(|(x, step)| x + t * step));
        };
        moved(&mut self.z, z, &step.p);
        moved(&mut self.forces.beta, beta, &step.beta);
        self.map(problem, springs);
    }

    /// P and F of z and β.
    fn map(&mut self, problem: &ContactProblem<'_>, springs: &Springs<'_>) {
        let (z, Forces { p, beta }) = (&self.z, &mut self.forces);
        p.clone_from(z);
        let points = problem.rows.iter().enumerate();
        let branch = |(i, own)| return_map(problem.friction(i), &mut p[own]);
        refill(&mut self.branches, points.map(branch));
        springs.stretched(problem, p, beta, &mut self.mismatch);
        for (k, f) in self.mismatch.iter_mut().enumerate() {
            *f += (z[k] - p[k]) / springs.r[k];
        }
    }

    /// Mismatch and missing balance on the scale of the natural map.
    fn residual(&self, problem: &ContactProblem<'_>) -> f64 {
        let (p, rho) = (&self.forces.p, problem.operator.rho);
        let missing: f64 = problem.missing(p).iter().map(|c| c * c).sum();
        let square: f64 = self.mismatch.iter().map(|f| (rho * f).powi(2)).sum();
        ratio((square + missing).sqrt(), problem.reference_force())
    }

    /// Σ r F² plus the missing balance, an energy.
    fn merit(&self, problem: &ContactProblem<'_>, r: &[f64]) -> f64 {
        let missing = problem.missing(&self.forces.p);
        let missing: f64 = missing.iter().map(|c| c * c / problem.operator.rho).sum();
        let pairs = self.mismatch.iter().zip(r);
        missing + pairs.map(|(f, r)| r * f * f).sum::<f64>()
    }
}

/// Newton's method on penalised laws. Every step works in the memory of the one before.
#[derive(Default)]
pub(crate) struct SpringNewton {
    pub tangent: Tangent,
    /// Where it stands.
    pub at: Trial,
    before: Vec<Branch>,
    /// An iterate that is tried.
    trial: Trial,
    rows: Vec<[PointRow; 3]>,
    /// (δP, δβ), δv + C δP.
    step: Forces,
    jump: Vec<f64>,
    /// (δz, δβ).
    direction: Forces,
}

impl SpringNewton {
    /// With the tangent that solves for its steps.
    pub fn new(tangent: Tangent) -> Self {
        Self {
            tangent,
            ..Self::default()
        }
    }

    /// Starts from the trial z = P − r v' of given contact forces and rigid amplitudes.
    pub fn start(&mut self, problem: &ContactProblem<'_>, springs: &Springs<'_>, x: &Forces) {
        let at = &mut self.at;
        springs.stretched(problem, &x.p, &x.beta, &mut at.z);
        for (k, z) in at.z.iter_mut().enumerate() {
            *z = x.p[k] - springs.r[k] * *z;
        }
        at.forces.beta.clone_from(&x.beta);
        at.map(problem, springs);
    }

    /// Steps from where it stands until the residual is at most `stop`. The residual is F and the missing balance on
    /// the scale of the natural map. `report(iterate, changes)` is called for every iterate and may stop.
    pub fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        springs: &Springs<'_>,
        stop: f64,
        max_iterations: usize,
        mut report: impl FnMut(&mut ContactProblem<'_>, &Forces, usize) -> bool,
    ) -> Result<Status, MethodError> {
        let mut search = LineSearch::default();
        self.before.clone_from(&self.at.branches);
        let mut last = f64::INFINITY;
        for iteration in 0.. {
            let residual = self.at.residual(problem);
            let changes = changed(&self.at.branches, &self.before);
            problem.counters.local_solves += problem.rows.points();
            if !residual.is_finite() {
                return Ok(Status::Diverged);
            }
            let go_on = report(problem, &self.at.forces, changes);
            if residual <= stop {
                return Ok(Status::Converged);
            }
            if !go_on {
                return Ok(Status::Stopped);
            }
            if residual <= ROUNDING && residual > 0.5 * last {
                return Ok(Status::Stalled);
            }
            last = residual;
            if iteration == max_iterations {
                break;
            }
            let mut found = self.direction(problem, springs, false)?;
            if !found
                && problem.rescue_left()
                && let Some(pair) = rescue(problem)?
            {
                self.start(problem, springs, &pair.into());
                continue;
            }
            if !found && matches!(self.tangent, Tangent::Condensed(_)) {
                found = self.direction(problem, springs, true)?;
            }
            if !found {
                return Ok(problem.singular());
            }
            search.record(self.at.merit(problem, &springs.r));
            let mut tried = f64::NAN;
            let t = search.length(|t| {
                tried = t;
                self.try_step(problem, springs, t)
            });
            if t != tried {
                self.try_step(problem, springs, t);
            }
            self.before.clone_from(&self.at.branches);
            std::mem::swap(&mut self.at, &mut self.trial);
        }
        Ok(Status::MaxIterations)
    }

    /// The merit after a step of length t.
    fn try_step(&mut self, problem: &ContactProblem<'_>, springs: &Springs<'_>, t: f64) -> f64 {
        let (z, beta) = (&self.at.z, &self.at.forces.beta);
        self.trial
            .take(problem, springs, (z, beta), (t, &self.direction));
        self.trial.merit(problem, &springs.r)
    }

    /// Newton's direction (δz, δβ); false if the tangent is singular. δz = δP − r (F + δv + C δP + δP/k); `hold`: loose pieces by
    /// springs.
    fn direction(
        &mut self,
        problem: &mut ContactProblem<'_>,
        springs: &Springs<'_>,
        hold: bool,
    ) -> Result<bool, MethodError> {
        let (at, step, dv) = (&self.at, &mut self.step, &mut self.jump);
        tangent_rows(problem, springs, at, &mut self.rows);
        match &mut self.tangent {
            Tangent::Condensed(condensed) => {
                let w = problem.operator.w.clone();
                let w = springs.coupled.as_ref().map_or(&*w, |c| c.series);
                if !condensed.solve(problem, w, &at.forces.p, &self.rows, hold, step) {
                    return Ok(false);
                }
                zero(dv, problem.len());
                w.apply_add(&step.p, dv);
                problem.operator.modes.add(&step.beta, dv);
            }
            Tangent::Monolithic(body) => {
                match body_step(body, problem, &at.forces.p, &mut self.rows)? {
                    Some(Pair { p, v, beta }) => (*step, *dv) = (Forces { p, beta }, v),
                    None => return Ok(false),
                }
            }
        }
        let Forces { p: dz, beta } = &mut self.direction;
        let of_row = |k: usize| {
            let dp = step.p[k];
            dp - springs.r[k] * (at.mismatch[k] + dv[k] + springs.compliance[k] * dp)
        };
        refill(dz, (0..dv.len()).map(of_row));
        beta.clone_from(&step.beta);
        Ok(true)
    }
}

/// The step by row, T = Π'(z), from δP = T δz and the row of F:
/// ```text
/// (I − T + T r/k) δP + T r (δv + C δP) = −T r F
/// ```
fn tangent_rows(
    problem: &ContactProblem<'_>,
    springs: &Springs<'_>,
    at: &Trial,
    rows: &mut Vec<[PointRow; 3]>,
) {
    let of_point = |(i, own): (usize, std::ops::Range<usize>)| {
        let mut rows = PointRow::reading([0.0; 3]);
        let t = return_map_derivative(problem.friction(i), &at.z[own.clone()], at.branches[i]);
        for (a, row) in rows[..own.len()].iter_mut().enumerate() {
            for (b, k) in own.clone().enumerate() {
                let tr = t[a][b] * springs.r[k];
                row.a[b] = f64::from(u8::from(a == b)) - t[a][b] + tr * springs.compliance[k];
                row.c[b] = tr;
                row.h += tr * at.mismatch[k];
            }
        }
        rows
    };
    refill(rows, problem.rows.iter().enumerate().map(of_point));
}

/// Adapts a [`Monitor`] and the history to the `report` argument of [`SpringNewton::solve`]. What is noted is the violation
/// of the contact laws, as for every method: it ends at the modelling error, not at zero.
///
/// `jump(problem, iterate)` is v, without what lies in series.
pub(crate) fn recorded<'m>(
    monitor: &'m mut dyn Monitor,
    jump: impl Fn(&ContactProblem<'_>, &Forces) -> Vec<f64> + 'm,
) -> impl FnMut(&mut ContactProblem<'_>, &Forces, usize) -> bool + 'm {
    move |problem, at, changes| {
        let v = jump(problem, at);
        let violation = problem.violation(&at.p, &v);
        problem.counters.iterations = problem.history.len();
        problem.note(violation, changes);
        monitor.iterate(&|| (at.p.clone(), v.clone()));
        monitor.step(problem.counters.iterations, violation)
    }
}
