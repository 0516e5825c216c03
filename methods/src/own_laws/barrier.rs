//! Barrier method with smoothed friction.
//!
//! Zhao, Choo, Jiang, Li, Jiang & Soga, Comput. Meth. Appl. Mech. Engng 393 (2022) 114820 (arXiv 2107.05814), on interfaces
//! embedded in finite elements; barrier and mollifier: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39
//! (2020) 49.
//!
//! ```text
//! P_n = −B'(g),  B = −κ (g − ĝ)² ln(g/ĝ) for 0 < g < ĝ, else 0      no penetration, no force beyond ĝ
//! P_t = −μ P_n f(|d|/ε) d/|d|,  f(y) = 2 y − y² for y < 1, else 1   sticking creeps by less than ε
//! ĝ = gap · ū,  ε = slip · ū,  κ ĝ = stiffness · ρ ū                 ū: mean jump without contact forces
//! ```
//! The jump v = (g, d) at the contact points is the unknown, with g > 0 from the start on even where nothing is open
//! yet, and Newton's method with the fully coupled tangent D = ∂P/∂v closes the equilibrium,
//! ```text
//! F(v, β) = v − q − W P(v) − Q β = 0,  Qᵀ P(v) = c
//! S = (I − r⁻¹ D)⁻¹ by point,  (S − W D S) y − Q δβ = −F,  δv = S y
//! g + t δg >= (1 − τ) g                                               fraction to the boundary
//! ```
//! In y instead of δv the columns of stiff points (S → 0, D S → −r) are as large as those of open ones (S = I, D = 0),
//! and a gap far below the rounding of q keeps its own digits because it is not computed as a difference.
//!
//! The laws are approached from wider ones: ĝ and ε start at ū and shrink tenfold, v of the points in contact with
//! them, so that P is kept. The start sticks (d = 0). Neither is in the paper: from the sharp laws, or from the slip
//! without friction, Newton's method fails more often than not from μ = 0.6 on.
//!
//! # Options
//! `gap`, `slip`: ĝ and ε as multiples of ū. The error of gaps, slips and forces is proportional to them.
//! `stiffness`: force at about half of ĝ as a multiple of the mean reference force ρ ū.
//! `max_iterations`.
//!
//! # Guarantees
//! P is inside Coulomb's cone and no gap closes fully, at any step. Locally quadratic. `Converged` refers to the
//! equations above ([`Claim::Barrier`]) and is judged before it is claimed; where the claim would be false, at most
//! three more steps follow, then `stalled`. The natural map measures the modelling error, which is about ĝ and ε over
//! ū.
//!
//! # Failure modes
//! With friction the equations are the gradient of no energy: the line search on |F| may end in a local minimum for
//! large μ. After 30 steps without progress a few local and global stages (as in LATIN) move the iterate on, up to six
//! times, so that failures mostly end at the iteration limit. Of 200 random, strongly coupled systems per μ all are
//! solved up to μ = 1, 199 at μ = 2 and 192 at μ = 5 (`tests/robustness.rs`). Below ĝ of 1e-8 ū rounding of the
//! displacements is a visible part of the gap.
//!
//! # Skips
//! A floating body without load keeps no forces; rigid motions alone take it out of what it would penetrate, or it stalls.
//! Points beyond ĝ have D = 0: their columns are unit vectors. No multipliers and no active sets.

#![allow(non_snake_case)]

use crate::algebra::dense::{along, ratio};
use crate::condensed::branches::changed;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::pair::Pair;
use crate::condensed::point_row::{Bordered, Law};
use crate::condensed::problem::ContactProblem;
use crate::condensed::stages::rescue;
use crate::contract::barrier_law::{BarrierLaw, resolvent};
use crate::contract::law::{Branch, tangential_norm};
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Monitor, Status};
use crate::newton::line_search::LineSearch;
use crate::own_laws::confirm::confirm;
use crate::own_laws::unloaded::unloaded;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "barrier",
    label: "Barrier, smoothed friction",
    reference: "Zhao, Choo, Jiang, Li, Jiang & Soga, Comput. Meth. Appl. Mech. Engng 393 (2022) 114820",
    summary: "keeps gaps open by a barrier energy with smoothed friction; its error is proportional to the width of the barrier",
    exact: false,
    options: Barrier::OPTIONS,
    source: include_str!("barrier.rs"),
    build: |options| Box::new(Barrier::new(options)),
};

options! {
    Barrier {
        gap: Real(1e-4, 1e-9, 1.0), "gap below which points repel each other, as a multiple of the mean jump without contact forces";
        slip: Real(1e-4, 1e-9, 1.0), "slip from which on friction is full, as a multiple of the same jump";
        stiffness: Real(1.0, 1e-3, 1e3), "contact force at half the gap as a multiple of rho times the same jump";
        max_iterations: Count(200, 1, 1_000_000), "Newton steps before giving up";
    }
}

/// The smoothed equations are solved this much more accurately than asked: the judge holds the claim to them in another
/// norm.
const CLAIM_FRACTION: f64 = 0.1;
/// Widest barrier and slip of the continuation, as multiples of ū.
const WIDEST: f64 = 1.0;
/// Factor between one barrier and the next.
const NARROWING: f64 = 0.1;
/// Part of the way to the boundary that one step may go.
const TO_BOUNDARY: f64 = 0.9;
/// A residual counts as progress below this fraction of the best before.
const IMPROVEMENT: f64 = 0.99;
/// Steps without progress after which the iteration is moved on, or counts as stalled.
const PATIENCE: usize = 30;

/// Unknowns of the method.
#[derive(Clone)]
struct Iterate {
    v: Vec<f64>,
    beta: Vec<f64>,
}

impl Iterate {
    fn moved(&self, t: f64, step: &Iterate) -> Iterate {
        Iterate {
            v: along(&self.v, t, &step.v),
            beta: along(&self.beta, t, &step.beta),
        }
    }
}

/// Residuals of an iterate in the laws and in equilibrium.
struct Balance {
    P: Vec<f64>,
    branches: Vec<Branch>,
    /// F by row, in m.
    F: Vec<f64>,
    /// c − Qᵀ P.
    missing: Vec<f64>,
}

impl Balance {
    fn of(problem: &ContactProblem<'_>, law: &BarrierLaw, x: &Iterate) -> Self {
        let mut P = vec![0.0; problem.len()];
        let mut branches = Vec::with_capacity(problem.rows.points());
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            let v = &x.v[rows.clone()];
            let p = law.forces(problem.friction(i), v);
            P[rows.clone()].copy_from_slice(&p[..rows.len()]);
            branches.push(if p[0] == 0.0 {
                Branch::Open
            } else if tangential_norm(v) < law.slip {
                Branch::Stick
            } else {
                Branch::Slip
            });
        }
        let mut F = problem.jump(&P, &x.beta);
        F.iter_mut().zip(&x.v).for_each(|(F, v)| *F = v - *F);
        let missing = problem.missing(&P);
        Self {
            P,
            branches,
            F,
            missing,
        }
    }

    /// |ρ F| and the missing balance, squared.
    fn merit(&self, rho: f64) -> f64 {
        let squares = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        rho * rho * squares(&self.F) + squares(&self.missing)
    }
}

impl CondensedMethod for Barrier {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let (rho, unit) = (problem.operator.rho, problem.mean_jump());
        if unit == 0.0 || problem.increment.unloaded() {
            return unloaded(problem);
        }
        let narrowest = self.law(rho, unit);
        problem.claim = narrowest.claim();
        // How many times the narrowest law the present one is wide.
        let mut width = (WIDEST / self.gap.max(self.slip)).max(1.0);
        let mut law = narrowest.widened(width);
        let mut x = sticking(problem, inside(problem, &law, Pair::start(problem)));
        let mut search = LineSearch::default();
        let mut best = (f64::INFINITY, 0);
        let mut before: Vec<Branch> = Vec::new();
        let mut corrections = 0;

        let (status, P) = loop {
            let mut at = Balance::of(problem, &law, &x);
            let residual = ratio(at.merit(rho).sqrt(), problem.reference_force());
            let changes = changed(&at.branches, &before);
            before.clone_from(&at.branches);
            let solved = width == 1.0 && residual <= CLAIM_FRACTION * problem.stop;
            let found = (residual, solved);
            let ended = self.ends(problem, &at, &x.beta, found, changes, monitor);
            if let Some(status) = ended {
                problem.rebalance(&mut at.P);
                if status != Status::Converged {
                    break (status, at.P);
                }
                match confirm(problem, &at.P, &x.beta, &mut corrections)? {
                    Some(status) => break (status, at.P),
                    None if problem.counters.iterations == self.max_iterations => {
                        break (Status::MaxIterations, at.P);
                    }
                    None => {
                        problem.counters.iterations += 1;
                        at = Balance::of(problem, &law, &x);
                    }
                }
            }
            let iteration = problem.counters.iterations;
            if residual < IMPROVEMENT * best.0 {
                best = (residual, iteration);
            }
            // A wide barrier needs no better solution than it is wide.
            if width > 1.0 && residual <= law.gap / unit {
                let factor = NARROWING.max(1.0 / width);
                narrow(problem, &law, factor, &mut x);
                width = (width * factor).max(1.0);
                law = narrowest.widened(width);
                (search, best) = (LineSearch::default(), (f64::INFINITY, iteration));
                continue;
            }
            let stuck = iteration >= best.1 + PATIENCE;
            let step = (!stuck).then(|| direction(problem, &law, &x, &at));
            let Some(step) = step.flatten() else {
                if problem.rescue_left()
                    && let Some(pair) = rescue(problem)?
                {
                    x = inside(problem, &law, pair);
                    (search, best) = (LineSearch::default(), (f64::INFINITY, iteration));
                    continue;
                }
                let singular = problem.singular();
                break (if stuck { Status::Stalled } else { singular }, at.P);
            };
            search.record(at.merit(rho));
            let reach = reach(problem, &x, &step);
            let t = search
                .length(|t| Balance::of(problem, &law, &x.moved(t * reach, &step)).merit(rho));
            x = x.moved(t * reach, &step);
        };
        let at = Forces { p: P, beta: x.beta };
        Ok(End { status, at })
    }
}

impl Barrier {
    /// The laws for a mean jump ū.
    fn law(&self, rho: f64, unit: f64) -> BarrierLaw {
        BarrierLaw {
            gap: self.gap * unit,
            slip: self.slip * unit,
            stiffness: self.stiffness * rho / self.gap,
        }
    }

    /// Notes an iterate in the history, by the natural map of the contact laws; says whether the method ends there, and
    /// how. Otherwise counts an iteration.
    fn ends(
        &self,
        problem: &mut ContactProblem<'_>,
        at: &Balance,
        beta: &[f64],
        (residual, solved): (f64, bool),
        changes: usize,
        monitor: &mut dyn Monitor,
    ) -> Option<Status> {
        let v = problem.jump(&at.P, beta);
        let violation = problem.violation(&at.P, &v);
        problem.note(violation, changes);
        let iteration = problem.counters.iterations;
        monitor.iterate(&|| (at.P.clone(), v.clone()));
        if !residual.is_finite() {
            return Some(Status::Diverged);
        }
        let go_on = monitor.step(iteration, violation);
        if solved {
            Some(Status::Converged)
        } else if !go_on {
            Some(Status::Stopped)
        } else if iteration == self.max_iterations {
            Some(Status::MaxIterations)
        } else {
            problem.counters.iterations += 1;
            None
        }
    }
}

/// The jump of contact forces, with every gap positive.
fn inside(problem: &ContactProblem<'_>, law: &BarrierLaw, pair: Pair) -> Iterate {
    let mut v = pair.v;
    for &k in problem.rows.normal() {
        // Half of ĝ also where nothing closes yet: a floating piece needs something to hold on to.
        if v[k] < 0.5 * law.gap || problem.modes() > 0 {
            v[k] = 0.5 * law.gap;
        }
    }
    Iterate { v, beta: pair.beta }
}

/// The same without slip. Friction that sticks is nearly linear, and points leave it one by one; from the slip without
/// friction Newton's method for large μ does not come back.
fn sticking(problem: &ContactProblem<'_>, mut x: Iterate) -> Iterate {
    for i in 0..problem.rows.points() {
        x.v[problem.rows.of(i)][1..].fill(0.0);
    }
    x
}

/// Takes the points in contact along to the narrower law, so that their forces stay.
fn narrow(problem: &ContactProblem<'_>, law: &BarrierLaw, factor: f64, x: &mut Iterate) {
    for i in 0..problem.rows.points() {
        let rows = problem.rows.of(i);
        let v = &mut x.v[rows];
        if v[0] < law.gap {
            v[0] *= factor;
            if tangential_norm(v) < law.slip {
                v[1..].iter_mut().for_each(|d| *d *= factor);
            }
        }
    }
}

/// Longest step that leaves every gap a part of what it is, at most 1.
fn reach(problem: &ContactProblem<'_>, x: &Iterate, step: &Iterate) -> f64 {
    let normal = problem.rows.normal();
    let ratios = normal.iter().map(|&k| -step.v[k] / x.v[k]);
    let steepest = ratios.fold(0.0, f64::max);
    (TO_BOUNDARY / steepest).min(1.0)
}

/// Newton step (δv, δβ); `None` if the tangent is singular.
///
/// With δv = S y, S = (I − r⁻¹ D)⁻¹ and D = ∂P/∂v: S y − W D S y − Q δβ = −F, Qᵀ D S y = c − Qᵀ P. Turned round in sign this is
/// the form by columns with the step −D S y of the forces.
fn direction(
    problem: &mut ContactProblem<'_>,
    law: &BarrierLaw,
    x: &Iterate,
    at: &Balance,
) -> Option<Iterate> {
    problem.counters.factorisations += 1;
    let n = problem.len();
    let r = problem.scales(&vec![0.0; n]);
    let (mut S, mut minus_DS) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
    for (i, own) in problem.rows.iter().enumerate() {
        let D = law.derivative(problem.friction(i), &x.v[own.clone()]);
        let of_point = resolvent(&D, &r[own.clone()]);
        S[own.clone()].copy_from_slice(&of_point[..own.len()]);
        for (a, k) in own.clone().enumerate() {
            for b in 0..own.len() {
                let ds: f64 = (0..own.len()).map(|c| D[a][c] * of_point[c][b]).sum();
                minus_DS[k][b] = -ds;
            }
        }
    }
    let all: Vec<usize> = (0..n).collect();
    let law = Law::Columns {
        e: &S,
        s: &minus_DS,
    };
    let f: Vec<f64> = at.F.iter().map(|F| -F).collect();
    let excess: Vec<f64> = at.missing.iter().map(|c| -c).collect();
    let (y, beta) = Bordered::new(problem, &all, &law)?.solve(&f, &excess)?;
    let mut v = vec![0.0; n];
    for own in problem.rows.iter() {
        for k in own.clone() {
            v[k] = own.clone().zip(S[k]).map(|(l, s)| s * y[l]).sum();
        }
    }
    Some(Iterate {
        v,
        beta: beta.iter().map(|b| -b).collect(),
    })
}
