//! The linear problem of a Newton step, on the contact rows or on the whole body.
//! ```text
//! A δP + C δv = −h  at every point,   δv = W δP + Q δβ,   Qᵀ (P + δP) = c
//! ```
//! Condensed: rows that read δP = const are eliminated, the rest is one dense LU. Monolithic: the same rows beside
//! K δu = Bᵀ δP in one sparse LU, as papers usually run Newton methods. Both give the same step to rounding.

#![allow(non_snake_case)]

use crate::condensed::pair::Pair;
use crate::condensed::point_row::{Bordered, Law, PointRow};
use crate::condensed::whole_body::WholeBody;
use crate::{
    ContactProblem, ContactSystem, DelassusForm, Forces, MethodError, Needs, OptionSpec, options,
};

/// Where the linear problems of a method are solved.
pub(crate) enum Tangent {
    /// On the contact rows, with W.
    Condensed,
    /// On all unknowns and contact forces; the pattern is analysed once per system. W is not formed.
    Monolithic(Option<Box<WholeBody>>),
}

options! {
    MONOLITHIC: Switch("monolithic", false): "1: factor the matrix of the whole body in every iteration instead of the condensed one";
}

impl Tangent {
    /// What the option `monolithic` that chooses does.
    pub const HELP: &str = MONOLITHIC.help;
    /// The option.
    pub const OPTION: OptionSpec = OptionSpec::Switch(MONOLITHIC);

    /// As the option says.
    pub fn new(monolithic: bool) -> Self {
        if monolithic {
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

    /// What it needs of the body.
    pub fn needs(&self) -> Needs {
        let delassus = match self {
            Tangent::Condensed => DelassusForm::Formed,
            Tangent::Monolithic(_) => DelassusForm::Products,
        };
        Needs {
            delassus,
            ..Needs::ANY_OPERATOR
        }
    }

    /// (δP, δβ); `None` if the tangent is singular. `hold`: loose pieces by springs, where W is at hand.
    pub fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        x: &Forces,
        rows: &mut [[PointRow; 3]],
        hold: bool,
    ) -> Result<Option<Forces>, MethodError> {
        match self {
            Tangent::Condensed => {
                problem.counters.factorisations += 1;
                Ok(condensed_step(problem, x, rows, hold))
            }
            Tangent::Monolithic(body) => {
                let Pair { p, beta, .. } =
                    match monolithic_step(body, problem, &x.p, rows, WholeBody::saddle)? {
                        Some(step) => step,
                        None => return Ok(None),
                    };
                Ok(Some(Forces { p, beta }))
            }
        }
    }
}

/// The step from the matrix of the whole body, analysed by `new` where that was not done for the system; `None` if it is
/// singular.
pub(crate) fn monolithic_step(
    body: &mut Option<Box<WholeBody>>,
    problem: &mut ContactProblem<'_>,
    P: &[f64],
    rows: &mut [[PointRow; 3]],
    new: fn(&ContactSystem) -> Result<WholeBody, MethodError>,
) -> Result<Option<Pair>, MethodError> {
    let system = problem.increment.system;
    let body = match body {
        Some(body) if body.belongs_to(system) => body,
        stale => stale.insert(Box::new(new(system)?)),
    };
    body.step(problem, P, rows)
}

fn condensed_step(
    problem: &ContactProblem<'_>,
    x: &Forces,
    rows: &[[PointRow; 3]],
    hold: bool,
) -> Option<Forces> {
    let mut p = vec![0.0; problem.len()];
    let (mut a, mut c) = (vec![[0.0; 3]; p.len()], vec![[0.0; 3]; p.len()]);
    // Rows δP = −H are known, the others active.
    let mut active = Vec::new();
    for (own, of_point) in problem.rows.iter().zip(rows) {
        for (k, row) in own.clone().zip(of_point) {
            let local = k - own.start;
            let alone = (0..own.len()).all(|l| row.c[l] == 0.0 && (l == local || row.a[l] == 0.0));
            (a[k], c[k]) = (row.a, row.c);
            if alone {
                p[k] = -row.h / row.a[local];
            } else {
                active.push(k);
            }
        }
    }
    let mut known = vec![0.0; p.len()];
    problem.operator.w.apply_add(&p, &mut known);
    let factored = if hold { Bordered::held } else { Bordered::new };
    let system = factored(problem, &active, &Law::Rows { a: &a, c: &c })?;

    let mut f = Vec::with_capacity(active.len());
    let mut next = active.iter().peekable();
    for (own, of_point) in problem.rows.iter().zip(rows) {
        while let Some(k) = next.next_if(|k| own.contains(k)) {
            let row = &of_point[k - own.start];
            // δP is still zero on active rows.
            let lacking = |f: f64, l: usize| {
                f - (row.a[l] * p[own.start + l] + row.c[l] * known[own.start + l])
            };
            f.push((0..own.len()).fold(-row.h, lacking));
        }
    }
    let reached: Vec<f64> = x.p.iter().zip(&p).map(|(x, step)| x + step).collect();
    let (solution, beta) = system.solve(&f, &problem.missing(&reached))?;
    for (&k, &step) in active.iter().zip(&solution) {
        p[k] = step;
    }
    Some(Forces { p, beta })
}
