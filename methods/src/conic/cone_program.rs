//! Contact with Coulomb's cone as an associated law: a cone program, solved by the interior-point code clarabel.
//! ```text
//! min ½ P·W P + (q + a e_n)·P   over |P_t| <= μ P_n,   Qᵀ P = c          a per point, in m
//! ```
//! The multiplier of Qᵀ P = c is β. Forces are in units of the reference force per point, W in units of 1/ρ: nothing is
//! left to equilibrate, and clarabel's own equilibration would see units and tangent frames. Built once; between solves only
//! the linear term changes. P stays dense: a factor of W with variables of its own fills in as much.

#![allow(non_snake_case)]

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

use crate::algebra::dense::norm;
use crate::algebra::factor::kernel;
use crate::condensed::forces::Forces;
use crate::condensed::problem::ContactProblem;
use crate::conic::fixed_point::{Program, TIGHTEST};
use crate::error::MethodError;

/// A tolerance that was not reached is asked for again, this much larger …
const RELAX: f64 = 100.0;
/// … up to here; then the last iterate has to do.
const LOOSEST_RETRY: f64 = 1e-6;

/// The program of one increment.
pub(crate) struct ConeProgram {
    solver: DefaultSolver<f64>,
    /// Unit of P.
    force: f64,
    /// Unit of v.
    length: f64,
    /// (I − Q Qᵀ) q, scaled.
    linear: Vec<f64>,
    /// Qᵀ q.
    rigid: Vec<f64>,
}

/// Constraints s = right − A P in their cones.
struct Constraints {
    A: CscMatrix<f64>,
    right: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl ConeProgram {
    /// The program of an increment.
    ///
    /// # Errors
    /// Data clarabel refuses.
    pub fn new(problem: &ContactProblem<'_>) -> Result<Self, MethodError> {
        let rho = problem.operator.rho;
        let force = problem.reference_force() / (problem.rows.points() as f64).sqrt();
        let length = force / rho;
        let modes = &problem.operator.modes;
        let mut linear = problem.q.clone();
        modes.project_out(&mut linear);
        linear.iter_mut().for_each(|q| *q /= length);

        let constraints = Constraints::new(problem, force);
        let P = upper_triangle(problem, rho);
        let solver = DefaultSolver::new(
            &P,
            &linear,
            &constraints.A,
            &constraints.right,
            &constraints.cones,
            settings(TIGHTEST)?,
        )
        .map_err(refused)?;
        Ok(Self {
            solver,
            force,
            length,
            linear,
            rigid: modes.components(&problem.q),
        })
    }

    /// Looks for forces within Coulomb's cones that balance the load alone; if there are none, a rigid motion β that none of them
    /// opposes and the load drives, as clarabel has it.
    ///
    /// # Errors
    /// Data clarabel refuses.
    pub fn unbalanced(problem: &ContactProblem<'_>) -> Result<Option<Vec<f64>>, MethodError> {
        let load = norm(&problem.balance);
        if load == 0.0 {
            return Ok(None);
        }
        let constraints = Constraints::new(problem, load);
        let n = problem.len();
        let mut solver = DefaultSolver::new(
            &CscMatrix::zeros((n, n)),
            &vec![0.0; n],
            &constraints.A,
            &constraints.right,
            &constraints.cones,
            settings(TIGHTEST)?,
        )
        .map_err(refused)?;
        solver.solve();
        let proved = solver.solution.status == SolverStatus::PrimalInfeasible;
        Ok(proved.then(|| solver.solution.z[..problem.modes()].to_vec()))
    }

    fn infeasible(&self) -> bool {
        matches!(
            self.solver.solution.status,
            SolverStatus::PrimalInfeasible
                | SolverStatus::DualInfeasible
                | SolverStatus::AlmostPrimalInfeasible
                | SolverStatus::AlmostDualInfeasible
        )
    }

    /// Whatever else the status is, the natural map will judge the iterate.
    fn forces(&self) -> Option<Forces> {
        let solution = &self.solver.solution;
        let p: Vec<f64> = solution.x.iter().map(|x| x * self.force).collect();
        let multipliers = solution.z.iter().zip(&self.rigid);
        let beta: Vec<f64> = multipliers.map(|(z, q)| z * self.length - q).collect();
        let finite = p.iter().chain(&beta).all(|x| x.is_finite());
        (finite && !self.infeasible()).then_some(Forces { p, beta })
    }
}

impl Program for ConeProgram {
    /// Steps of clarabel, each a factorisation of 2 m rows and more, count as factorisations.
    fn solve(
        &mut self,
        problem: &mut ContactProblem<'_>,
        a: &[f64],
        mut tolerance: f64,
    ) -> Result<Option<Forces>, MethodError> {
        let mut linear = self.linear.clone();
        for (own, a) in problem.rows.iter().zip(a) {
            // Without friction there is no slip to shift by.
            if own.len() > 1 {
                linear[own.start] += a / self.length;
            }
        }
        self.solver.update_q(&linear).map_err(refused)?;
        loop {
            let settings = settings(tolerance)?;
            self.solver.update_settings(settings).map_err(refused)?;
            self.solver.solve();
            problem.counters.factorisations += self.solver.solution.iterations as usize;
            let solved = self.solver.solution.status == SolverStatus::Solved;
            if solved || self.infeasible() || tolerance >= LOOSEST_RETRY {
                return Ok(self.forces());
            }
            tolerance *= RELAX;
        }
    }
}

impl Constraints {
    fn new(problem: &ContactProblem<'_>, force: f64) -> Self {
        let (n, modes) = (problem.len(), &problem.operator.modes.q);
        let mut right: Vec<f64> = problem.balance.iter().map(|c| c / force).collect();
        let mut cones = vec![SupportedConeT::ZeroConeT(modes.len())];
        // Row and value of each force component in A.
        let mut place = vec![(0, -1.0); n];
        for i in 0..problem.rows.points() {
            let rows = problem.rows.of(i);
            cones.push(match rows.len() {
                1 => SupportedConeT::NonnegativeConeT(1),
                size => {
                    place[rows.start].1 = -problem.friction(i);
                    SupportedConeT::SecondOrderConeT(size)
                }
            });
            for k in rows {
                place[k].0 = right.len();
                right.push(0.0);
            }
        }
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for k in 0..n {
            for (j, q) in modes.iter().enumerate() {
                rows.push(j);
                values.push(q[k]);
            }
            rows.push(place[k].0);
            values.push(place[k].1);
            starts.push(rows.len());
        }
        Self {
            A: CscMatrix::new(right.len(), n, starts, rows, values),
            right,
            cones,
        }
    }
}

/// Upper triangle of ρ W.
fn upper_triangle(problem: &ContactProblem<'_>, rho: f64) -> CscMatrix<f64> {
    let (n, mut work) = (problem.len(), Vec::new());
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..n {
        if let Some(w) = problem.operator.w.sparse() {
            for (i, w) in w.entries(j).filter(|(i, _)| *i <= j) {
                rows.push(i);
                values.push(rho * w);
            }
        } else {
            let w = problem.operator.w.column(j, &mut work);
            rows.extend(0..=j);
            values.extend(w[..=j].iter().map(|w| rho * w));
        }
        starts.push(rows.len());
    }
    CscMatrix::new(n, n, starts, rows, values)
}

pub(crate) fn settings(tolerance: f64) -> Result<DefaultSettings<f64>, MethodError> {
    DefaultSettingsBuilder::default()
        .verbose(false)
        .max_threads(1)
        .presolve_enable(false)
        .equilibrate_enable(false)
        .tol_gap_abs(tolerance)
        .tol_gap_rel(tolerance)
        .tol_feas(tolerance)
        .build()
        .map_err(refused)
}

pub(crate) fn refused(error: impl std::fmt::Display) -> MethodError {
    kernel("cone program", error.to_string())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::algebra::matrix::SquareMatrix;
    use crate::condensed::fixture::with_contact;
    use crate::contract::elastic::Elastic;
    use crate::contract::law::project_cone;

    /// One point on springs of stiffness k in all directions; W = I/k and q = f/k.
    fn springs(dim: usize, k: f64) -> Arc<Elastic> {
        let (ends, all) = ((0..=dim).collect(), (0..dim).collect());
        let w = SquareMatrix::symmetric(dim, ends, all, vec![1.0 / k; dim]).unwrap();
        Elastic::from_delassus(dim, w, vec![]).unwrap()
    }

    /// P for a load and several parameters, one program for all.
    fn solve(k: f64, mu: f64, f: &[f64], parameters: &[f64]) -> Vec<Vec<f64>> {
        let load = (f.to_vec(), vec![0.0; f.len()]);
        with_contact(&springs(f.len(), k), vec![mu], load, |_, mut problem| {
            let mut program = ConeProgram::new(&problem).unwrap();
            let solve = |a: &f64| {
                let solved = program.solve(&mut problem, &[*a], TIGHTEST);
                solved.unwrap().unwrap().p
            };
            parameters.iter().map(solve).collect()
        })
    }

    fn assert_close(found: &[f64], exact: &[f64], size: f64) {
        for (a, b) in found.iter().zip(exact) {
            assert!((a - b).abs() < 1e-8 * size, "{found:?} {exact:?}");
        }
    }

    const LOADS: [&[f64]; 5] = [
        &[-4.0, 1.0],
        &[-4.0, -9.0],
        &[-0.1, 5.0],
        &[-3.0, 1.0, -0.5],
        &[-3.0, 4.0, -5.0],
    ];

    /// With W = I/k the program is a projection on Coulomb's cone: inside it, on its side and at its tip.
    #[test]
    fn a_single_point_with_a_shifted_gap_is_a_projection_on_the_cone() {
        for (mu, k, f) in [0.1, 0.7, 3.0].into_iter().flat_map(|mu| {
            LOADS
                .into_iter()
                .flat_map(move |f| [1.0, 1e9].map(|k| (mu, k, f)))
        }) {
            let shifts = [0.0, 0.9 / k, 30.0 / k, 0.5 / k];
            let found = solve(k, mu, f, &shifts);
            for (P, a) in found.iter().zip(shifts) {
                let mut exact: Vec<f64> = f.iter().map(|f| -f).collect();
                exact[0] -= k * a;
                project_cone(mu, &mut exact);
                assert_close(P, &exact, 30.0);
            }
        }
    }
}
