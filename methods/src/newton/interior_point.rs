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
//! δv and δλ are eliminated, which leaves one LU of m + |β| rows for both directions (the equations stand in
//! `newton/path_equations.rs`). The directions are those of the Jordan product itself, without a scaling that would make
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

use crate::algebra::dense::refill;
use crate::condensed::branches::Branches;
use crate::condensed::forces::{End, Ended, Forces};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::{Check, ContactProblem, Limits};
use crate::contract::options::options;
use crate::contract::registry::{Method, Needs};
use crate::contract::state::Monitor;
use crate::newton::central_path::Products;
use crate::newton::iteration::Newton;
use crate::newton::path_equations::{Iterate, Lack, PathEquations};
use crate::newton::pdas::Sets;
use crate::newton::step::Tangent;

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
/// Newton's method is tried from the path below this violation, and again each time that it has fallen to such a part; it
/// is given up after so many steps without progress.
pub(crate) const NEAR: f64 = 1e-3;
const AGAIN: f64 = 1e-3;
const SOON: usize = 3;
/// Steps below this length jam: the path is left, and taken up again deeper inside.
const JAMMED: f64 = 0.02;
/// Least depth of the start inside the cones, relative to the reference force per point.
const SHALLOWEST: f64 = 0.1;

impl CondensedMethod for InteriorPoint {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.max_iterations, PATIENCE);
        along_path(problem, self.fraction, 0.0, limits, monitor)
    }
}

/// The loop, from the start of the increment until it ends, or Newton's method does that is tried from a violation below `cross`
/// on. Every step works in the memory of the one before.
pub(crate) fn along_path(
    problem: &mut ContactProblem<'_>,
    fraction: f64,
    mut cross: f64,
    limits: Limits,
    monitor: &mut dyn Monitor,
) -> Ended {
    let (mut at, mut v) = (problem.start(), Vec::new());
    let mut branches = Branches::default();
    let (mut x, mut step) = (Iterate::default(), Iterate::default());
    let (mut equations, mut lack) = (PathEquations::default(), Lack::default());
    let (mut on_path, mut depth) = (false, 0.0);

    let status = loop {
        problem.jump_into(&at.p, &at.beta, &mut v);
        let changes = branches.changes(problem, &at.p, &v);
        let violation = problem.violation(&at.p, &v);
        match problem.check(violation, (&at.p, &at.beta), changes, limits, monitor)? {
            Check::GoOn => {}
            Check::Corrected => continue,
            Check::End(status) => break status,
        }
        if violation < cross {
            cross = AGAIN * violation;
            let limits = Limits::new(limits.iterations, SOON);
            let end = cross_over(problem, &at, limits, monitor)?;
            if end.is_final() {
                return Ok(end);
            }
        }
        if !on_path {
            depth = next_depth(depth, &at.p, violation);
            x.begin(problem, &at, &v, depth);
        }
        problem.counters.factorisations += 1;
        let found = equations.factor(problem, &x)
            && predict_and_correct(problem, &mut equations, &x, &mut lack, &mut step);
        if !found {
            break problem.singular();
        }
        let t = x.step_length(problem, &step, fraction.max(1.0 - violation));
        x.move_along(t, &step);
        x.forces(problem, &mut at);
        on_path = t >= JAMMED;
    };
    Ok(End { status, at })
}

/// Newton's method from a place on the path, given up soon: it knows the states of the points, or does not.
pub(crate) fn cross_over(
    problem: &mut ContactProblem<'_>,
    at: &Forces,
    limits: Limits,
    monitor: &mut dyn Monitor,
) -> Ended {
    problem.begin_phase();
    let end = Newton::plain(Sets, limits, Tangent::default()).run(problem, at.clone(), monitor);
    problem.begin_phase();
    end
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

/// Mehrotra's direction in place of `step`: predictor, then the corrector that aims at σ ν. False if it is not finite.
fn predict_and_correct(
    problem: &ContactProblem<'_>,
    equations: &mut PathEquations,
    x: &Iterate,
    lack: &mut Lack,
    step: &mut Iterate,
) -> bool {
    lack.read(problem, x);
    if !equations.direction(problem, x, lack, step) {
        return false;
    }
    let t = x.step_length(problem, step, 1.0);
    let now = |i: usize| x.at(problem, i).products();
    let nu = mean(problem, now);
    let after = mean(problem, |i| {
        x.at(problem, i).products_after(t, &step.at(problem, i))
    });
    let sigma = (after / nu).clamp(0.0, 1.0).powi(3);
    let second = |i: usize| step.at(problem, i).products();
    let points = 0..problem.rows.points();
    refill(
        &mut lack.products,
        points.map(|i| now(i).lack(sigma * nu, &second(i))),
    );
    equations.direction(problem, x, lack, step)
}

/// ν: the mean of the points' products over all cones, two per point with friction and one per point without.
fn mean(problem: &ContactProblem<'_>, products: impl Fn(usize) -> Products) -> f64 {
    let points = 0..problem.rows.points();
    let cones: usize = (points.clone())
        .map(|i| problem.rows.of(i).len().min(2))
        .sum();
    let sum = |p: Products| p.normal + p.scalar;
    points.map(|i| sum(products(i))).sum::<f64>() / cones as f64
}
