//! The linear problem of a Newton step, on the contact rows or on the whole body.
//! ```text
//! A δP + C δv = −h  at every point,   δv = W δP + Q δβ,   Qᵀ (P + δP) = c
//! ```
//! Condensed: rows that read δP = const are eliminated, the rest is one dense LU, of which rows that tie two forces to each other take
//! no part (`tied.rs`), or few changes of an earlier one (`reuse.rs`).
//! Monolithic: the same rows beside K δu = Bᵀ δP on all unknowns, as papers usually run Newton methods. Both give the same step to
//! rounding.

#![allow(non_snake_case)]

use crate::algebra::delassus::Delassus;
use crate::algebra::dense::{refill, zero};
use crate::condensed::forces::Forces;
use crate::condensed::pair::Pair;
use crate::condensed::point_row::{Bordered, Law, PointRow};
use crate::condensed::problem::ContactProblem;
use crate::condensed::whole_body::WholeBody;
use crate::contract::operator::DelassusForm;
use crate::contract::options::{OptionSpec, options};
use crate::contract::registry::Needs;
use crate::contract::system::ContactSystem;
use crate::error::MethodError;
use crate::newton::reuse::{Factored, Rows, Solved};

/// Where the linear problems of a method are solved.
pub(crate) enum Tangent {
    /// On the contact rows, with W.
    Condensed(Box<CondensedStep>),
    /// On all unknowns; the pattern is analysed once per system. W is not formed.
    Monolithic(Option<Box<WholeBody>>),
}

options! {
    MONOLITHIC: Switch("monolithic", false): "1: solve each step on all unknowns of the body instead of the contact rows";
}

impl Default for Tangent {
    fn default() -> Self {
        Self::Condensed(Box::default())
    }
}

impl Tangent {
    /// Effect of the option `monolithic`.
    pub const HELP: &str = MONOLITHIC.help;
    /// The option.
    pub const OPTION: OptionSpec = OptionSpec::Switch(MONOLITHIC);

    /// As the option says.
    pub fn new(monolithic: bool) -> Self {
        if monolithic {
            Tangent::Monolithic(None)
        } else {
            Tangent::default()
        }
    }

    /// Why it cannot treat a system.
    pub fn refuses(&self, system: &ContactSystem) -> Option<String> {
        let blind =
            matches!(self, Tangent::Monolithic(_)) && system.elastic().stiffness().is_none();
        blind.then(|| "the monolithic variant needs the stiffness of the body".to_string())
    }

    /// Its needs of the body.
    pub fn needs(&self) -> Needs {
        let delassus = match self {
            Tangent::Condensed(_) => DelassusForm::Formed,
            Tangent::Monolithic(_) => DelassusForm::Products,
        };
        Needs {
            delassus,
            ..Needs::ANY_OPERATOR
        }
    }

    /// Called after the last step of a run: what was factored serves no other.
    pub fn forget(&mut self) {
        if let Tangent::Condensed(condensed) = self {
            (condensed.held, condensed.spoilt) = (None, false);
            condensed.factored.forget();
        }
    }

    /// (δP, δβ) in place of what `step` holds; false if the tangent is singular. `hold`: loose pieces by springs, where W is at
    /// hand.
    pub fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        x: &Forces,
        rows: &mut [[PointRow; 3]],
        hold: bool,
        step: &mut Forces,
    ) -> Result<bool, MethodError> {
        match self {
            Tangent::Condensed(condensed) => {
                let w = problem.operator.w.clone();
                Ok(condensed.solve(problem, &*w, &x.p, rows, hold, step))
            }
            Tangent::Monolithic(body) => {
                let found = body_step(body, problem, &x.p, rows)?;
                let singular = found.is_none();
                if let Some(Pair { p, beta, .. }) = found {
                    *step = Forces { p, beta };
                }
                Ok(!singular)
            }
        }
    }
}

/// The step of the whole body, analysed where that was not done for the system; `None` if its tangent is singular.
pub(crate) fn body_step(
    body: &mut Option<Box<WholeBody>>,
    problem: &mut ContactProblem<'_>,
    P: &[f64],
    rows: &mut [[PointRow; 3]],
) -> Result<Option<Pair>, MethodError> {
    let system = problem.increment.system;
    let body = match body {
        Some(body) if body.belongs_to(system) => body,
        stale => stale.insert(Box::new(WholeBody::new(system)?)),
    };
    body.step(problem, P, rows)
}

/// The condensed problem of a step. Its memory serves all steps.
#[derive(Default)]
pub(crate) struct CondensedStep {
    system: Bordered,
    /// Whether loose pieces are held in what is factored; none where nothing is.
    held: Option<bool>,
    /// The factored matrix: later steps may start from it.
    factored: Factored,
    /// Rounding has spoilt that: every tangent is factored.
    spoilt: bool,
    a: Vec<[f64; 3]>,
    c: Vec<[f64; 3]>,
    /// Rows that are not known beforehand.
    active: Vec<usize>,
    /// W δP of the rows that are.
    known: Vec<f64>,
    reached: Vec<f64>,
    f: Vec<f64>,
    solution: Vec<f64>,
}

impl CondensedStep {
    /// (δP, δβ) from forces `P` in place of what `step` holds; false if the tangent is singular. `w`: W, or that with a compliance in
    /// series; `hold`: loose pieces by springs.
    pub fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        w: &dyn Delassus,
        P: &[f64],
        rows: &[[PointRow; 3]],
        hold: bool,
        step: &mut Forces,
    ) -> bool {
        let p = &mut step.p;
        zero(p, problem.len());
        for vector in [&mut self.a, &mut self.c] {
            vector.clear();
        }
        // Rows δP = −H are known, the others active.
        self.active.clear();
        for (own, of_point) in problem.rows.iter().zip(rows) {
            for (k, row) in own.clone().zip(of_point) {
                let local = k - own.start;
                let alone =
                    (0..own.len()).all(|l| row.c[l] == 0.0 && (l == local || row.a[l] == 0.0));
                self.a.push(row.a);
                self.c.push(row.c);
                if alone {
                    p[k] = -row.h / row.a[local];
                } else {
                    self.active.push(k);
                }
            }
        }
        zero(&mut self.known, p.len());
        w.apply_add(p, &mut self.known);
        self.f.clear();
        let mut next = self.active.iter().peekable();
        for (own, of_point) in problem.rows.iter().zip(rows) {
            while let Some(k) = next.next_if(|k| own.contains(k)) {
                let row = &of_point[k - own.start];
                // δP is still zero on active rows.
                let lacking = |f: f64, l: usize| {
                    f - (row.a[l] * p[own.start + l] + row.c[l] * self.known[own.start + l])
                };
                self.f.push((0..own.len()).fold(-row.h, lacking));
            }
        }
        refill(
            &mut self.reached,
            P.iter().zip(&*p).map(|(P, step)| P + step),
        );
        if !self.solve_active(problem, w, hold, &mut step.beta) {
            return false;
        }
        for (&k, &value) in self.active.iter().zip(&self.solution) {
            p[k] = value;
        }
        true
    }

    /// The active rows and β, from the factors of an earlier step where that is possible.
    fn solve_active(
        &mut self,
        problem: &mut ContactProblem<'_>,
        w: &dyn Delassus,
        hold: bool,
        beta: &mut Vec<f64>,
    ) -> bool {
        let Self {
            system,
            held,
            factored,
            spoilt,
            a,
            c,
            active,
            f,
            reached,
            solution,
            ..
        } = self;
        let (rows, law) = (Rows { w, active, a, c }, Law::Rows { a, c });
        let (balance, hold) = (problem.missing(reached), hold && problem.modes() > 0);
        if *held == Some(hold) && factored.is_of(rows) {
            return system.solve_into(f, &balance, solution, beta);
        }
        let mut failed = false;
        if *held == Some(false)
            && !hold
            && !*spoilt
            && let Some(factors) = system.factors()
        {
            f.extend(balance.iter());
            match factored.solve(problem, factors, rows, f) {
                Solved::Step(found) => {
                    *solution = found;
                    let amplitudes = solution.drain(active.len()..);
                    refill(beta, amplitudes.map(|b| b / problem.operator.rho));
                    return true;
                }
                Solved::TooManyChanges => {}
                Solved::Failed => failed = true,
            }
        }
        f.truncate(active.len());
        problem.counters.factorisations += 1;
        let regular = system.factor_with(problem, w, active, &law, hold);
        *held = regular.then_some(hold);
        if !regular {
            return false;
        }
        // It was not the tangent's fault.
        *spoilt |= failed;
        factored.remember(rows);
        system.solve_into(f, &balance, solution, beta)
    }
}
