//! The contact laws as complementarity of cones with v and λ as unknowns beside P, and Newton's directions for them.
//! ```text
//! v = q + W P + Q β,   Qᵀ P = c               v is its own unknown, as is λ for |d|
//! P_n g = ν,  (P_n, P_t/μ) ∘ (λ, d) = (ν, 0)   by point: `central_path.rs`
//! ```
//! A direction makes up for what is [lacking](Lack) anywhere. δv and δλ are eliminated, which leaves one LU of m + |β| rows.

#![allow(non_snake_case)]

use std::ops::Range;

use crate::algebra::dense::{add, refill};
use crate::condensed::forces::Forces;
use crate::condensed::point_row::{Bordered, Law};
use crate::condensed::problem::ContactProblem;
use crate::condensed::starts::RIDGE;
use crate::newton::central_path::{ConePoint, PathRow, Products, move_inside};

/// The unknowns, or a step of them.
#[derive(Clone, Default)]
pub(crate) struct Iterate {
    pub P: Vec<f64>,
    pub beta: Vec<f64>,
    /// Equal to the jump of P and β only once a full step was taken.
    pub v: Vec<f64>,
    /// One per point.
    pub lambda: Vec<f64>,
}

impl Iterate {
    /// `start` and its jump, moved inside the cones by `depth` times the reference force per point.
    pub fn begin(
        &mut self,
        problem: &ContactProblem<'_>,
        start: &Forces,
        jump: &[f64],
        depth: f64,
    ) {
        let points = problem.rows.points();
        let force = depth * problem.reference_force() / (points as f64).sqrt();
        let length = force / problem.operator.rho;
        let Self { P, beta, v, lambda } = self;
        P.clone_from(&start.p);
        beta.clone_from(&start.beta);
        jump.clone_into(v);
        let point = |(i, own): (usize, Range<usize>)| {
            let (P, v) = (&mut P[own.clone()], &mut v[own]);
            move_inside(problem.friction(i), P, v, force, length)
        };
        refill(lambda, problem.rows.iter().enumerate().map(point));
    }

    /// The cones of point `i`.
    pub fn at(&self, problem: &ContactProblem<'_>, i: usize) -> ConePoint<'_> {
        let rows = problem.rows.of(i);
        ConePoint {
            mu: problem.friction(i),
            P: &self.P[rows.clone()],
            v: &self.v[rows],
            lambda: self.lambda[i],
        }
    }

    /// self := self + t step.
    pub fn move_along(&mut self, t: f64, step: &Iterate) {
        add(t, &step.P, &mut self.P);
        add(t, &step.beta, &mut self.beta);
        add(t, &step.v, &mut self.v);
        add(t, &step.lambda, &mut self.lambda);
    }

    /// self := t self.
    pub fn scale(&mut self, t: f64) {
        let parts = [&mut self.P, &mut self.beta, &mut self.v, &mut self.lambda];
        parts.into_iter().flatten().for_each(|x| *x *= t);
    }

    /// min(1, `fraction` · longest step inside all cones).
    pub fn step_length(&self, problem: &ContactProblem<'_>, step: &Iterate, fraction: f64) -> f64 {
        let points = 0..problem.rows.points();
        fraction
            * points.fold(1.0 / fraction, |t, i| {
                self.at(problem, i).step_length(&step.at(problem, i), t)
            })
    }

    /// The forces alone, balanced.
    pub fn forces(&self, problem: &ContactProblem<'_>, at: &mut Forces) {
        at.p.clone_from(&self.P);
        problem.rebalance(&mut at.p);
        at.beta.clone_from(&self.beta);
    }
}

/// What an iterate lacks to fulfil the equations.
#[derive(Clone, Default)]
pub(crate) struct Lack {
    /// By point: targets less products.
    pub products: Vec<Products>,
    /// q + W P + Q β − v.
    pub v: Vec<f64>,
    /// c − Qᵀ P.
    pub balance: Vec<f64>,
}

impl Lack {
    /// That of an iterate to ν = 0.
    pub fn read(&mut self, problem: &ContactProblem<'_>, x: &Iterate) {
        problem.jump_into(&x.P, &x.beta, &mut self.v);
        add(-1.0, &x.v, &mut self.v);
        self.balance = problem.missing(&x.P);
        let (points, none) = (0..problem.rows.points(), Products::default());
        let lacking = |i| x.at(problem, i).products().lack(0.0, &none);
        refill(&mut self.products, points.map(lacking));
    }

    /// t self.
    pub fn times(&self, t: f64) -> Self {
        let times = |x: &Vec<f64>| x.iter().map(|x| t * x).collect();
        let products = self.products.iter();
        Self {
            products: products
                .map(|own| Products::default().plus(t, own))
                .collect(),
            v: times(&self.v),
            balance: times(&self.balance),
        }
    }
}

/// Newton's equations at one iterate, condensed to (P, β) and factored.
#[derive(Default)]
pub(crate) struct PathEquations {
    system: Bordered,
    /// All rows.
    rows: Vec<usize>,
    /// Coefficients of δP and δv by row, scaled like all of the row to unit size.
    a: Vec<[f64; 3]>,
    c: Vec<[f64; 3]>,
    scale: Vec<f64>,
    /// Right-hand side of a direction.
    f: Vec<f64>,
}

impl PathEquations {
    /// Assembles and factors them; false if the matrix is singular. Near a solution with redundant points it is: then
    /// 1e-10/ρ on the diagonal of W picks one of the possible δP.
    pub fn factor(&mut self, problem: &ContactProblem<'_>, x: &Iterate) -> bool {
        let Self { a, c, scale, .. } = self;
        a.clear();
        c.clear();
        scale.clear();
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
        refill(&mut self.rows, 0..problem.len());
        if (self.system).factor_held(problem, &self.rows, &Law::Rows { a, c }) {
            return true;
        }
        let ridge = RIDGE / problem.operator.rho;
        for (a, c) in a.iter_mut().zip(&*c) {
            (a.iter_mut().zip(c)).for_each(|(a, c)| *a += ridge * c);
        }
        (self.system).factor_held(problem, &self.rows, &Law::Rows { a, c })
    }

    /// The direction from `x` that makes up for a lack; false if it is not finite.
    pub fn direction(
        &mut self,
        problem: &ContactProblem<'_>,
        x: &Iterate,
        lack: &Lack,
        step: &mut Iterate,
    ) -> bool {
        self.f.clear();
        for ((i, own), products) in problem.rows.iter().enumerate().zip(&lack.products) {
            let h = x.at(problem, i).right_side(products);
            for (k, h) in own.clone().zip(h) {
                let known: f64 = lack.v[own.clone()]
                    .iter()
                    .zip(self.c[k])
                    .map(|(v, c)| v * c)
                    .sum();
                self.f.push(self.scale[k] * h - known);
            }
        }
        let Iterate { P, beta, v, lambda } = step;
        if !(self.system).solve_into(&self.f, &lack.balance, P, beta) {
            return false;
        }
        v.clone_from(&lack.v);
        problem.operator.w.apply_add(P, v);
        problem.operator.modes.add(beta, v);
        let points = problem.rows.iter().zip(&lack.products).enumerate();
        let step_of = |(i, (own, lack)): (usize, (Range<usize>, &Products))| {
            x.at(problem, i).lambda_step(lack, &P[own.clone()], &v[own])
        };
        refill(lambda, points.map(step_of));
        true
    }
}
