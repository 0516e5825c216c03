//! Primal-dual interior-point method.
//!
//! Central path: Kanno, Martins & Pinto da Costa, Int. J. Numer. Meth. Engng 65 (2006) 62, for the laws as complementarity
//! of second-order cones; predictor and corrector: Mehrotra, SIAM J. Optim. 2 (1992) 575. Related: Acary, Armand, Nguyen
//! & Shpakovych, Second-order cone programming for frictional contact mechanics using interior point algorithm (2023), with
//! De Saxcé's cone in place of the pair (g, λ).
//!
//! ```text
//! v = (g, d) = q + W P + Q β,  Qᵀ P = c          condensed equilibrium; v is an unknown of its own
//! P_n g = ν                                      P_n > 0, g > 0             Signorini
//! (P_n, P_t/μ) ∘ (λ, d) = (ν, 0)                 |P_t| < μ P_n, |d| < λ     Coulomb; ∘ is the Jordan product
//!
//! ν = mean of the products of all cones
//! predictor:  Newton's direction for ν -> 0      δᵃ, longest step tᵃ inside the cones, νᵃ there
//! corrector:  Newton's direction for σ ν, σ = (νᵃ/ν)³, with the products of δᵃ as errors of second order
//! x <- x + t δ                                   t = min(1, fraction · longest step)
//! ```
//! δv and δλ are eliminated, which leaves one dense LU of m + |β| rows for both directions (the equations stand in
//! `newton/central_path.rs`). The directions are those of the Jordan product itself, without a scaling that would make
//! them symmetric: friction is not, and the matrix stays regular at the solution, so that the last digits are not lost.
//!
//! # Options
//! `fraction`: of the way to the boundary; 1 − natural map if that is larger, so that the last steps are full Newton steps.
//! `max_iterations`.
//!
//! # Guarantees
//! Quadratic convergence where no point is at once at a bound and without slip, or closed without force; the number of
//! steps hardly depends on μ or on the number of points. On random, strongly coupled systems of 12 points (100 for each
//! μ and dimension, tolerance 1e-9, `tests/robustness.rs`) none fails up to μ = 1, with 7 or 8 steps in the median.
//! Starts from the forces of the increment's start, moved inside by the fraction of the reference force that they are
//! wrong by.
//!
//! # Failure modes
//! Coulomb friction is no minimisation: the path may end at a boundary where the problem is not unique (of 200 of those
//! systems 1 at μ = 2 and 11 at μ = 5). Steps below 2 % start it again from the iterate, moved inside deeper every
//! time; then it reports a stall. A body that nothing holds ends as stall or mechanism.
//!
//! # Skips
//! Points without friction have no cone. No line search, no switching of branches: one factorisation per step.

#![allow(non_snake_case)]

use crate::algebra::dense::along;
use crate::condensed::branches::Branches;
use crate::condensed::point_row::{Bordered, Law};
use crate::newton::central_path::{ConePoint, PathRow, Products, move_inside};
use crate::{
    Check, CondensedMethod, ContactProblem, End, Ended, Forces, Limits, Method, Monitor, Needs,
    options,
};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "interior-point",
    label: "Interior point",
    reference: "Kanno, Martins & Pinto da Costa, Int. J. Numer. Meth. Engng 65 (2006) 62",
    summary: "follows the central path of the contact laws, written as complementarity of second-order cones",
    exact: true,
    options: InteriorPoint::OPTIONS,
    source: include_str!("interior_point.rs"),
    build: |options| Box::new(InteriorPoint::new(options)),
};

options! {
    InteriorPoint {
        fraction: Real(FRACTION, 0.5, 0.9999), "fraction of the way to the boundary of the cones that a step may take";
        max_iterations: Count(200, 1, 1_000_000), "steps before giving up";
    }
}

/// Fraction of the way to the boundary that a step takes by default.
pub(crate) const FRACTION: f64 = 0.99;
/// Steps without progress after which the iteration counts as stalled.
pub(crate) const PATIENCE: usize = 40;
/// Steps below this length jam: the path is left, and taken up again deeper inside.
const JAMMED: f64 = 0.02;
/// Least depth of the start inside the cones, relative to the reference force per point.
const SHALLOWEST: f64 = 0.1;

/// Unknowns of the method, or a step of them.
struct Iterate {
    P: Vec<f64>,
    beta: Vec<f64>,
    /// Equal to the jump of P and β only once a full step was taken.
    v: Vec<f64>,
    /// One per point.
    lambda: Vec<f64>,
}

impl CondensedMethod for InteriorPoint {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.max_iterations, PATIENCE);
        along_path(problem, self.fraction, limits, monitor)
    }
}

/// The loop, from the start of the increment until it ends.
pub(crate) fn along_path(
    problem: &mut ContactProblem<'_>,
    fraction: f64,
    limits: Limits,
    monitor: &mut dyn Monitor,
) -> Ended {
    let Forces { p: mut P, mut beta } = problem.start();
    let mut branches = Branches::default();
    let mut path: Option<Iterate> = None;
    let mut depth = 0.0;

    let status = loop {
        let v = problem.jump(&P, &beta);
        let changes = branches.changes(problem, &P, &v);
        let violation = problem.violation(&P, &v);
        match problem.check(violation, (&P, &beta), changes, limits, monitor)? {
            Check::GoOn => {}
            Check::Corrected => continue,
            Check::End(status) => break status,
        }
        let x = path.take().unwrap_or_else(|| {
            depth = next_depth(depth, &P, violation);
            Iterate::inside(problem, &P, &beta, depth)
        });
        problem.counters.factorisations += 1;
        let Some(step) = PathStep::new(problem, &x).and_then(|mut s| s.corrected(problem, &x))
        else {
            break problem.singular();
        };
        let t = x.step_length(problem, &step, fraction.max(1.0 - violation));
        let x = x.moved(t, &step);
        P.clone_from(&x.P);
        problem.rebalance(&mut P);
        beta.clone_from(&x.beta);
        path = (t >= JAMMED).then_some(x);
    };
    let at = Forces { p: P, beta };
    Ok(End { status, at })
}

/// How deep inside the cones the path begins: as far as the start is wrong, and twice as deep after every jam. The
/// natural map of a start without forces says nothing.
fn next_depth(before: f64, P: &[f64], violation: f64) -> f64 {
    match before {
        0.0 if P.iter().any(|&p| p != 0.0) => violation.clamp(SHALLOWEST, 1.0),
        0.0 => 1.0,
        _ => 2.0 * before.max(0.5),
    }
}

impl Iterate {
    /// (P, β) and its jump, moved inside the cones by `depth` times the reference force per point.
    fn inside(problem: &ContactProblem<'_>, P: &[f64], beta: &[f64], depth: f64) -> Self {
        let points = problem.rows.points();
        let force = depth * problem.reference_force(P) / (points as f64).sqrt();
        let length = force / problem.operator.rho;
        let (mut P, mut v) = (P.to_vec(), problem.jump(P, beta));
        let lambda = (0..points)
            .map(|i| {
                let rows = problem.rows.of(i);
                let (P, v) = (&mut P[rows.clone()], &mut v[rows]);
                move_inside(problem.friction(i), P, v, force, length)
            })
            .collect();
        let beta = beta.to_vec();
        Self { P, beta, v, lambda }
    }

    fn at(&self, problem: &ContactProblem<'_>, i: usize) -> ConePoint<'_> {
        let rows = problem.rows.of(i);
        ConePoint {
            mu: problem.friction(i),
            P: &self.P[rows.clone()],
            v: &self.v[rows],
            lambda: self.lambda[i],
        }
    }

    fn moved(&self, t: f64, step: &Iterate) -> Iterate {
        Iterate {
            P: along(&self.P, t, &step.P),
            beta: along(&self.beta, t, &step.beta),
            v: along(&self.v, t, &step.v),
            lambda: along(&self.lambda, t, &step.lambda),
        }
    }

    /// Products of all points.
    fn products(&self, problem: &ContactProblem<'_>) -> Vec<Products> {
        let points = 0..problem.rows.points();
        points.map(|i| self.at(problem, i).products()).collect()
    }

    /// min(1, `fraction` · longest step inside all cones).
    fn step_length(&self, problem: &ContactProblem<'_>, step: &Iterate, fraction: f64) -> f64 {
        let points = 0..problem.rows.points();
        fraction
            * points.fold(1.0 / fraction, |t, i| {
                self.at(problem, i).step_length(&step.at(problem, i), t)
            })
    }
}

/// ν: the mean over all cones, two per point with friction and one per point without.
fn mean(problem: &ContactProblem<'_>, products: &[Products]) -> f64 {
    let points = 0..problem.rows.points();
    let cones: usize = points.map(|i| problem.rows.of(i).len().min(2)).sum();
    products.iter().map(|p| p.normal + p.scalar).sum::<f64>() / cones as f64
}

/// Newton's equations at one iterate, condensed to (P, β) and factored.
struct PathStep {
    system: Bordered,
    /// Coefficients of δv by row, scaled like all of the row to unit size.
    c: Vec<[f64; 3]>,
    scale: Vec<f64>,
}

impl PathStep {
    /// `None` if the matrix is singular.
    fn new(problem: &ContactProblem<'_>, x: &Iterate) -> Option<Self> {
        let n = problem.len();
        let (mut a, mut c, mut scale) = (Vec::new(), Vec::new(), Vec::with_capacity(n));
        for (i, own) in problem.rows.iter().enumerate() {
            for PathRow { a: of_p, c: of_v } in
                x.at(problem, i).equations().into_iter().take(own.len())
            {
                let size = |x: &[f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
                let s = 1.0 / (size(&of_p) + size(&of_v) / problem.operator.rho);
                a.push(of_p.map(|x| x * s));
                c.push(of_v.map(|x| x * s));
                scale.push(s);
            }
        }
        let all: Vec<usize> = (0..n).collect();
        let system = Bordered::held(problem, &all, &Law::Rows { a: &a, c: &c })?;
        Some(Self { system, c, scale })
    }

    /// Mehrotra's direction: predictor, then the corrector that aims at σ ν.
    fn corrected(&mut self, problem: &ContactProblem<'_>, x: &Iterate) -> Option<Iterate> {
        let products = x.products(problem);
        let lack = |nu: f64, second: &[Products]| -> Vec<Products> {
            let pairs = products.iter().zip(second);
            pairs.map(|(p, second)| p.lack(nu, second)).collect()
        };
        let none = vec![Products::default(); products.len()];
        let affine = self.direction(problem, x, &lack(0.0, &none))?;
        let t = x.step_length(problem, &affine, 1.0);
        let nu = mean(problem, &products);
        let after = mean(problem, &x.moved(t, &affine).products(problem));
        let sigma = (after / nu).clamp(0.0, 1.0).powi(3);
        self.direction(problem, x, &lack(sigma * nu, &affine.products(problem)))
    }

    /// The direction that makes up for `lack` and for v ≠ q + W P + Q β, Qᵀ P ≠ c.
    fn direction(
        &mut self,
        problem: &ContactProblem<'_>,
        x: &Iterate,
        lack: &[Products],
    ) -> Option<Iterate> {
        let jump = problem.jump(&x.P, &x.beta);
        let mut dv: Vec<f64> = jump.iter().zip(&x.v).map(|(jump, v)| jump - v).collect();
        let mut f = Vec::with_capacity(problem.len());
        for ((i, own), lack) in problem.rows.iter().enumerate().zip(lack) {
            let h = x.at(problem, i).right_side(lack);
            for (k, h) in own.clone().zip(h) {
                let known: f64 = dv[own.clone()]
                    .iter()
                    .zip(self.c[k])
                    .map(|(v, c)| v * c)
                    .sum();
                f.push(self.scale[k] * h - known);
            }
        }
        let (dP, beta) = self.system.solve(&f, &problem.missing(&x.P))?;
        problem.operator.w.apply_add(&dP, &mut dv);
        problem.operator.modes.add(&beta, &mut dv);
        let lambda = problem.rows.iter().zip(lack).enumerate();
        let lambda = lambda.map(|(i, (own, lack))| {
            x.at(problem, i)
                .lambda_step(lack, &dP[own.clone()], &dv[own])
        });
        Some(Iterate {
            lambda: lambda.collect(),
            P: dP,
            beta,
            v: dv,
        })
    }
}
