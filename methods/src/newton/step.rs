//! The linear problem of a Newton step, on the contact rows or on the whole body.
//! ```text
//! A δP + C δv = −h  at every point,   δv = W δP + Q δβ,   Qᵀ (P + δP) = c
//! ```
//! Condensed: rows that read δP = const are eliminated, the rest is one dense LU. Monolithic: the same rows beside
//! K δu = Bᵀ δP in one sparse LU, as papers usually run Newton methods. Both give the same step to rounding.

#![allow(non_snake_case)]

use faer::Mat;

use crate::algebra::dense::{mul_add, solve_dense};
use crate::condensed::problem::Reduced;
use crate::condensed::whole_body::{Global, TwoVectors};
use crate::newton::b_equations::Row;
use crate::newton::iteration::Iterate;
use crate::{ContactSystem, MethodError, OptionSpec, Options};

/// Where the linear problems of a method are solved.
pub(crate) enum Tangent {
    /// On the contact rows, with W.
    Condensed,
    /// On all unknowns and contact forces; the pattern is analysed once per system.
    Monolithic(Option<Box<Global>>),
}

/// The option that chooses.
pub(crate) const MONOLITHIC: OptionSpec = OptionSpec {
    name: "monolithic",
    unit: "-",
    default: 0.0,
    min: 0.0,
    max: 1.0,
    integer: true,
    help: "1: factor the matrix of the whole body in every iteration instead of the condensed one",
};

impl Tangent {
    /// As the options say.
    pub fn new(options: &Options) -> Self {
        if options.own(MONOLITHIC.name) == 1.0 {
            Tangent::Monolithic(None)
        } else {
            Tangent::Condensed
        }
    }

    /// Why it cannot treat a system.
    pub fn refuses(&self, system: &ContactSystem) -> Option<String> {
        let blind =
            matches!(self, Tangent::Monolithic(_)) && system.elastic().stiffness().is_none();
        blind.then(|| "the monolithic variant needs the stiffness of the body".to_string())
    }

    /// (δP, δβ); `None` if the tangent is singular.
    pub fn solve(
        &mut self,
        problem: &mut Reduced<'_>,
        x: &Iterate,
        rows: &mut [[Row; 3]],
    ) -> Result<Option<Iterate>, MethodError> {
        match self {
            Tangent::Condensed => {
                problem.counters.factorisations += 1;
                Ok(condensed_step(problem, x, rows))
            }
            Tangent::Monolithic(global) => {
                let step = whole_body(global, problem, &x.P, rows, Global::saddle)?;
                Ok(step.map(|(P, dv)| {
                    let beta = amplitudes(problem, &P, dv);
                    Iterate { P, beta }
                }))
            }
        }
    }
}

/// (δP, δv) from the matrix of the whole body, analysed by `new` where that was not done for the system; `None` if it is
/// singular.
pub(crate) fn whole_body(
    global: &mut Option<Box<Global>>,
    problem: &mut Reduced<'_>,
    P: &[f64],
    rows: &mut [[Row; 3]],
    new: fn(&ContactSystem) -> Result<Global, MethodError>,
) -> Result<Option<TwoVectors>, MethodError> {
    problem.counters.global_factorisations += 1;
    // Without balance there is no equilibrium to linearise: step from the nearest balanced forces P + Q (c − Qᵀ P).
    let (mut lack, mut response) = (vec![0.0; P.len()], vec![0.0; P.len()]);
    if problem.modes() > 0 {
        problem.condensed.modes.add(&problem.missing(P), &mut lack);
        mul_add(&problem.condensed.w, &lack, &mut response);
    }
    for (i, of_point) in rows.iter_mut().enumerate() {
        let own = problem.rows.of(i);
        for row in of_point.iter_mut().take(own.len()) {
            for (l, k) in own.clone().enumerate() {
                row.h += row.a[l] * lack[k] + row.c[l] * response[k];
            }
        }
    }
    let system = problem.increment.system;
    let global = match global {
        Some(global) if global.belongs_to(system) => global,
        stale => stale.insert(Box::new(new(system)?)),
    };
    let Some((mut dP, mut dv)) = global.solve(rows)? else {
        return Ok(None);
    };
    dP.iter_mut().zip(&lack).for_each(|(x, l)| *x += l);
    dv.iter_mut().zip(&response).for_each(|(x, l)| *x += l);
    Ok(Some((dP, dv)))
}

/// δβ = Qᵀ (δv − W δP).
pub(crate) fn amplitudes(problem: &Reduced<'_>, dP: &[f64], mut dv: Vec<f64>) -> Vec<f64> {
    if problem.modes() > 0 {
        let minus: Vec<f64> = dP.iter().map(|p| -p).collect();
        mul_add(&problem.condensed.w, &minus, &mut dv);
    }
    problem.condensed.modes.components(&dv)
}

fn condensed_step(problem: &Reduced<'_>, x: &Iterate, rows: &[[Row; 3]]) -> Option<Iterate> {
    let (W, rho, modes) = (
        &problem.condensed.w,
        problem.condensed.rho,
        &problem.condensed.modes,
    );
    let mut step = Iterate {
        P: vec![0.0; problem.len()],
        beta: Vec::new(),
    };
    // Rows δP = −H are known; the others are active, kept with the first row of their point.
    let mut active: Vec<(usize, usize, &Row)> = Vec::new();
    for (i, of_point) in rows.iter().enumerate() {
        let own = problem.rows.of(i);
        for (k, row) in own.clone().zip(of_point) {
            let local = k - own.start;
            let alone = (0..own.len()).all(|l| row.c[l] == 0.0 && (l == local || row.a[l] == 0.0));
            if alone {
                step.P[k] = -row.h / row.a[local];
            } else {
                active.push((k, own.start, row));
            }
        }
    }
    let mut known = vec![0.0; problem.len()];
    mul_add(W, &step.P, &mut known);

    let (n, size) = (active.len(), active.len() + problem.modes());
    let mut J = Mat::<f64>::zeros(size, size);
    let mut rhs = vec![0.0; size];
    for (column, &(k, point, _)) in active.iter().enumerate() {
        let w = W.col_as_slice(k);
        for (entry, (_, start, row)) in J.col_as_slice_mut(column)[..n].iter_mut().zip(&active) {
            for l in 0..problem.rows_at(*start) {
                *entry += row.c[l] * w[start + l];
            }
            if *start == point {
                *entry += row.a[k - point];
            }
        }
    }
    for (a, (_, start, row)) in active.iter().enumerate() {
        rhs[a] = -row.h;
        for l in 0..problem.rows_at(*start) {
            // δP is still zero on active rows.
            rhs[a] -= row.a[l] * step.P[start + l] + row.c[l] * known[start + l];
            for (j, q) in modes.q.iter().enumerate() {
                J[(a, n + j)] += row.c[l] * q[start + l] / rho;
            }
        }
    }
    for (j, q) in modes.q.iter().enumerate() {
        for (b, (k, ..)) in active.iter().enumerate() {
            J[(n + j, b)] = q[*k];
        }
        rhs[n + j] = problem.balance[j]
            - q.iter()
                .zip(x.P.iter().zip(&step.P))
                .map(|(q, (p, s))| q * (p + s))
                .sum::<f64>();
    }

    let solution = solve_dense(&J, &rhs)?;
    for (a, (k, ..)) in active.iter().enumerate() {
        step.P[*k] = solution[a];
    }
    step.beta = solution[n..].iter().map(|b| b / rho).collect();
    Some(step)
}
