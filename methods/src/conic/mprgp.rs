//! Contact with a given friction bound by active sets and conjugate gradients: MPRGP.
//! ```text
//! min ½ P·W' P + (q' + Q γ)·P    over P_n >= 0, |P_t| <= a            f = q' + W' P + Q γ, the gradient
//!
//! free rows: P_n > 0, |P_t| < a    φ = f there, 0 elsewhere;   φ̃ = (P − proj(P − ᾱ φ))/ᾱ,   β = (P − proj(P − ᾱ f))/ᾱ on the others
//! |β|² <= φ̃·φ   conjugate gradients along p on the free rows; a step that would leave the set ends at its boundary, and
//!               P <- proj(P − ᾱ φ) goes on from there with p <- φ
//! |β|² > φ̃·φ    P <- proj(P − ᾱ f),  p <- φ
//! γ <- γ + κ (Qᵀ P − c)            bodies that float: method of multipliers, once the rest is solved better than that
//! ```
//! ᾱ = 1.9/λ_max(W'). Intervals: Dostál & Schöberl, Comput. Optim. Appl. 30 (2005) 23; discs: Dostál & Kozubek, Math. Program.
//! 135 (2012) 195. Nothing is factored. W', q', γ: `condensed/saddle.rs`.

use crate::algebra::dense::{dot, minus, norm};
use crate::algebra::floating::ModeJumps;
use crate::algebra::spectrum::extremes;
use crate::condensed::forces::Forces;
use crate::condensed::problem::ContactProblem;
use crate::condensed::saddle::{Iterate, Saddle};
use crate::conic::fixed_point::Program;
use crate::contract::law::{project_ball, tangential_norm};
use crate::error::MethodError;

/// ᾱ λ_max.
const FIXED_STEP: f64 = 1.9;
/// Steps before the iterate has to do.
const MAX_STEPS: usize = 20_000;
/// Part of the imbalance to which the rest is solved before γ moves.
const SOLVED: f64 = 0.1;
/// A tangential force counts as free this far inside its bound.
const INSIDE: f64 = 1.0 - 1e-12;

/// The program of one increment, with the forces it ended with last.
pub(crate) struct Mprgp {
    saddle: Saddle,
    x: Iterate,
    /// ᾱ in N/m.
    step: f64,
}

impl Mprgp {
    /// The program of an increment; from its start.
    pub fn new(problem: &ContactProblem<'_>) -> Self {
        let saddle = Saddle::new(problem.operator.clone());
        let most = extremes(saddle.w(), &ModeJumps::empty()).map_or(0.0, |(_, most)| most);
        let most = if most > 0.0 {
            most
        } else {
            1.0 / problem.operator.rho
        };
        Self {
            x: saddle.start(problem),
            saddle,
            step: FIXED_STEP / most,
        }
    }

    /// Forces for one bound per point, to a projected gradient of `tolerance` times the reference force.
    fn forces(
        &mut self,
        problem: &mut ContactProblem<'_>,
        bounds: &[f64],
        tolerance: f64,
    ) -> Forces {
        project(problem, bounds, &mut self.x.p);
        self.saddle.refresh(problem, &mut self.x);
        let mut p: Option<Vec<f64>> = None;
        for _ in 0..MAX_STEPS {
            problem.counters.local_solves += bounds.len();
            let stop = tolerance * problem.reference_force();
            let imbalance = norm(&problem.missing(&self.x.p));
            let free = free_rows(problem, bounds, &self.x.p);
            let phi = masked(&self.x.v, &free);
            let left = self.reduced(problem, bounds, &self.x.v);
            let size = self.step * norm(&left);
            if size <= stop.max(SOLVED * imbalance) {
                if imbalance <= stop {
                    break;
                }
                self.saddle.update_multipliers(problem, &mut self.x);
                p = None;
                continue;
            }
            let chopped: f64 = (left.iter().zip(&free))
                .map(|(b, free)| if *free { 0.0 } else { b * b })
                .sum();
            if chopped <= dot(&self.reduced(problem, bounds, &phi), &phi) {
                let along = p.take().unwrap_or_else(|| phi.clone());
                p = self.conjugate(problem, bounds, &free, along);
            } else {
                self.projected(problem, bounds, &left);
                p = None;
            }
        }
        self.saddle.refresh(problem, &mut self.x);
        let (p, beta) = self.saddle.balanced(problem, &self.x);
        self.saddle.update_multipliers(problem, &mut self.x);
        Forces { p, beta }
    }

    /// (P − proj(P − ᾱ f))/ᾱ.
    fn reduced(&self, problem: &ContactProblem<'_>, bounds: &[f64], f: &[f64]) -> Vec<f64> {
        let mut p: Vec<f64> = (self.x.p.iter().zip(f))
            .map(|(p, f)| p - self.step * f)
            .collect();
        project(problem, bounds, &mut p);
        (self.x.p.iter().zip(&p))
            .map(|(old, new)| (old - new) / self.step)
            .collect()
    }

    /// P −= t d, with v.
    fn advance(&mut self, t: f64, d: &[f64], wd: &[f64]) {
        for k in 0..d.len() {
            self.x.p[k] -= t * d[k];
            self.x.v[k] -= t * wd[k];
        }
    }

    fn product(&self, d: &[f64]) -> Vec<f64> {
        let mut wd = vec![0.0; d.len()];
        self.saddle.w().apply_add(d, &mut wd);
        wd
    }

    /// P <- proj(P − ᾱ f) for its reduced gradient, exactly inside the set.
    fn projected(&mut self, problem: &ContactProblem<'_>, bounds: &[f64], reduced: &[f64]) {
        let mut p: Vec<f64> = (self.x.p.iter().zip(reduced))
            .map(|(p, f)| p - self.step * f)
            .collect();
        project(problem, bounds, &mut p);
        let moved = minus(&self.x.p, &p);
        let wd = self.product(&moved);
        self.advance(1.0, &moved, &wd);
        self.x.p = p;
    }

    /// A step along `p`; the next direction, none where the set of free rows changes.
    fn conjugate(
        &mut self,
        problem: &ContactProblem<'_>,
        bounds: &[f64],
        free: &[bool],
        p: Vec<f64>,
    ) -> Option<Vec<f64>> {
        let wp = self.product(&p);
        let curvature = dot(&p, &wp);
        let best = dot(&self.x.v, &p) / curvature;
        let longest = longest_step(problem, bounds, &self.x.p, &p);
        if best <= longest {
            self.advance(best, &p, &wp);
            let phi = masked(&self.x.v, free);
            let beta = dot(&phi, &wp) / curvature;
            return Some(phi.iter().zip(&p).map(|(f, p)| f - beta * p).collect());
        }
        if longest.is_finite() {
            self.advance(longest, &p, &wp);
        }
        let phi = masked(&self.x.v, free);
        let reduced = self.reduced(problem, bounds, &phi);
        self.projected(problem, bounds, &reduced);
        None
    }
}

impl Program for Mprgp {
    fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        bounds: &[f64],
        tolerance: f64,
    ) -> Result<Option<Forces>, MethodError> {
        Ok(Some(self.forces(problem, bounds, tolerance)))
    }
}

/// Nearest forces with P_n >= 0, |P_t| <= a.
fn project(problem: &ContactProblem<'_>, bounds: &[f64], p: &mut [f64]) {
    for (own, bound) in problem.rows.iter().zip(bounds) {
        let p = &mut p[own];
        p[0] = p[0].max(0.0);
        project_ball(*bound, &mut p[1..]);
    }
}

fn free_rows(problem: &ContactProblem<'_>, bounds: &[f64], p: &[f64]) -> Vec<bool> {
    let mut free = Vec::with_capacity(p.len());
    for (own, bound) in problem.rows.iter().zip(bounds) {
        let p = &p[own];
        let inside = tangential_norm(p) < INSIDE * bound;
        free.push(p[0] > 0.0);
        free.extend(p[1..].iter().map(|_| inside));
    }
    free
}

fn masked(f: &[f64], free: &[bool]) -> Vec<f64> {
    let keep = |(f, free): (&f64, &bool)| if *free { *f } else { 0.0 };
    f.iter().zip(free).map(keep).collect()
}

/// Largest t for which P − t p stays in the set.
fn longest_step(problem: &ContactProblem<'_>, bounds: &[f64], force: &[f64], p: &[f64]) -> f64 {
    let mut longest = f64::INFINITY;
    for (own, bound) in problem.rows.iter().zip(bounds) {
        let (force, p) = (&force[own.clone()], &p[own]);
        if p[0] > 0.0 {
            longest = longest.min(force[0] / p[0]);
        }
        // a t² − 2 h t − c = 0 with c >= 0: one root is not negative.
        let a = tangential_norm(p).powi(2);
        if a > 0.0 {
            let h = dot(&force[1..], &p[1..]);
            let size = tangential_norm(force);
            let c = ((bound - size) * (bound + size)).max(0.0);
            longest = longest.min((h + (h * h + a * c).sqrt()) / a);
        }
    }
    longest
}
