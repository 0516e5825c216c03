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

use faer::Mat;

use crate::algebra::dense::{mul_add, solve_dense};
use crate::condensed::problem::Reduced;
use crate::condensed::stages::rescue;
use crate::condensed::whole_body::{Global, TwoVectors};
use crate::contract::judge::ratio;
use crate::contract::law::{Branch, return_map, return_map_derivative};
use crate::contract::state::{Monitor, Status};
use crate::error::MethodError;
use crate::newton::b_equations::Row;
use crate::newton::line_search::LineSearch;
use crate::newton::step::{Tangent, amplitudes, whole_body};

/// Below this a residual that no longer halves has met rounding.
const ROUNDING: f64 = 1e-12;

/// Penalty stiffnesses and anchor.
pub(crate) struct Springs<'a> {
    pub normal: f64,
    pub tangential: f64,
    /// A by row.
    pub anchor: Vec<f64>,
    /// Only the condensed tangent knows them.
    pub coupled: Option<Coupled<'a>>,
}

/// Springs between all rows.
pub(crate) struct Coupled<'a> {
    /// C.
    pub compliance: &'a Mat<f64>,
    /// c₀ by row.
    pub stretch: Vec<f64>,
}

/// Where the Newton iteration stands.
#[derive(Clone)]
pub(crate) struct Point {
    pub z: Vec<f64>,
    pub beta: Vec<f64>,
    /// Π(z).
    pub p: Vec<f64>,
    pub branches: Vec<Branch>,
}

impl Springs<'_> {
    /// Compliance 1/k by row.
    fn compliance(&self, problem: &Reduced<'_>) -> Vec<f64> {
        problem.by_row(1.0 / self.normal, 1.0 / self.tangential)
    }

    /// r by row.
    fn scales(&self, problem: &Reduced<'_>) -> Vec<f64> {
        let mut compliance = self.compliance(problem);
        if let Some(coupled) = &self.coupled {
            for (k, c) in compliance.iter_mut().enumerate() {
                *c += coupled.compliance[(k, k)];
            }
        }
        problem.scales(&compliance)
    }

    /// v' by row.
    fn stretched(&self, problem: &Reduced<'_>, p: &[f64], beta: &[f64]) -> Vec<f64> {
        let mut v = problem.jump(p, beta);
        for (k, c) in self.compliance(problem).into_iter().enumerate() {
            v[k] += c * (p[k] - self.anchor[k]);
        }
        if let Some(coupled) = &self.coupled {
            mul_add(coupled.compliance, p, &mut v);
            v.iter_mut()
                .zip(&coupled.stretch)
                .for_each(|(v, c)| *v += c);
        }
        v
    }

    /// The trial z = P − r v' for given contact forces and rigid amplitudes.
    pub fn predict(&self, problem: &Reduced<'_>, p: &[f64], beta: Vec<f64>) -> Point {
        let r = self.scales(problem);
        let v = self.stretched(problem, p, &beta);
        let z = (0..p.len()).map(|k| p[k] - r[k] * v[k]).collect();
        Point::new(problem, z, beta)
    }

    /// F by row, in m.
    fn mismatch(&self, problem: &Reduced<'_>, r: &[f64], at: &Point) -> Vec<f64> {
        let mut f = self.stretched(problem, &at.p, &at.beta);
        for k in 0..f.len() {
            f[k] += (at.z[k] - at.p[k]) / r[k];
        }
        f
    }

    /// Newton's method from `at` until the residual is at most `stop`. The residual is F and the missing balance on
    /// the scale of the natural map. `report(iterate, changes)` is called for every iterate and may stop.
    pub fn solve(
        &self,
        problem: &mut Reduced<'_>,
        mut at: Point,
        stop: f64,
        max_iterations: usize,
        tangent: &mut Tangent,
        mut report: impl FnMut(&mut Reduced<'_>, &Point, usize) -> bool,
    ) -> Result<(Status, Point), MethodError> {
        let (r, c) = (self.scales(problem), self.compliance(problem));
        let mut search = LineSearch::default();
        let mut before = at.branches.clone();
        let mut last = f64::INFINITY;
        for iteration in 0.. {
            let mismatch = self.mismatch(problem, &r, &at);
            let residual = residual(problem, &at, &mismatch);
            let changes = at
                .branches
                .iter()
                .zip(&before)
                .filter(|(a, b)| a != b)
                .count();
            problem.counters.local_solves += problem.rows.points();
            if !residual.is_finite() {
                return Ok((Status::Diverged, at));
            }
            let go_on = report(problem, &at, changes);
            if residual <= stop {
                return Ok((Status::Converged, at));
            }
            if !go_on {
                return Ok((Status::Stopped, at));
            }
            if residual <= ROUNDING && residual > 0.5 * last {
                return Ok((Status::Stalled, at));
            }
            last = residual;
            if iteration == max_iterations {
                break;
            }
            let step = match tangent {
                Tangent::Condensed => {
                    let coupled = self.coupled.as_ref();
                    direction(problem, coupled, &r, &c, &at, &mismatch)
                }
                Tangent::Monolithic(global) => {
                    whole_direction(global, problem, &r, &c, &at, &mismatch)?
                }
            };
            let Some((dz, dbeta)) = step else {
                if problem.rescue_left()
                    && let Some(pair) = rescue(problem)?
                {
                    at = self.predict(problem, &pair.p, pair.beta);
                    continue;
                }
                return Ok((problem.singular(), at));
            };
            search.record(merit(problem, &r, &at, &mismatch));
            let t = search.length(|t| {
                let trial = at.moved(problem, t, &dz, &dbeta);
                let mismatch = self.mismatch(problem, &r, &trial);
                merit(problem, &r, &trial, &mismatch)
            });
            before.clone_from(&at.branches);
            at = at.moved(problem, t, &dz, &dbeta);
        }
        Ok((Status::MaxIterations, at))
    }
}

/// Mismatch and missing balance on the scale of the natural map.
fn residual(problem: &Reduced<'_>, at: &Point, mismatch: &[f64]) -> f64 {
    let rho = problem.condensed.rho;
    let missing: f64 = problem.missing(&at.p).iter().map(|c| c * c).sum();
    let square: f64 = mismatch.iter().map(|f| (rho * f).powi(2)).sum();
    ratio((square + missing).sqrt(), problem.reference_force(&at.p))
}

/// Σ r F² plus the missing balance, an energy.
fn merit(problem: &Reduced<'_>, r: &[f64], at: &Point, mismatch: &[f64]) -> f64 {
    let missing: f64 = problem
        .missing(&at.p)
        .iter()
        .map(|c| c * c / problem.condensed.rho)
        .sum();
    missing + mismatch.iter().zip(r).map(|(f, r)| r * f * f).sum::<f64>()
}

/// Newton step (δz, δβ); `None` if the tangent is singular.
///
/// With y = δz/r and δP = S y, S = Π'(z) r, the rows of active points read y + (W + C + 1/k − 1/r) S y + Q δβ = −F.
fn direction(
    problem: &mut Reduced<'_>,
    coupled: Option<&Coupled<'_>>,
    r: &[f64],
    c: &[f64],
    at: &Point,
    mismatch: &[f64],
) -> Option<(Vec<f64>, Vec<f64>)> {
    problem.counters.factorisations += 1;
    let (w, modes, rho) = (
        &problem.condensed.w,
        &problem.condensed.modes,
        problem.condensed.rho,
    );
    // Active rows with the first row of their point, and the rows of S within the point.
    let mut active: Vec<(usize, usize)> = Vec::new();
    let mut slope = vec![[0.0; 3]; problem.len()];
    for i in (0..problem.rows.points()).filter(|&i| at.branches[i] != Branch::Open) {
        let rows = problem.rows.of(i);
        let d = return_map_derivative(problem.friction(i), &at.z[rows.clone()], at.branches[i]);
        for k in rows.clone() {
            active.push((k, rows.start));
            for l in rows.clone() {
                slope[k][l - rows.start] = d[k - rows.start][l - rows.start] * r[l];
            }
        }
    }

    let (n, size) = (active.len(), active.len() + problem.modes());
    let mut tangent = Mat::<f64>::zeros(size, size);
    let mut rhs = vec![0.0; size];
    for (b, &(k, start)) in active.iter().enumerate() {
        let column = tangent.col_as_slice_mut(b);
        column[b] += 1.0;
        for l in start..start + problem.rows_at(start) {
            let s = slope[l][k - start];
            if s != 0.0 {
                let compliances = [Some(w), coupled.map(|c| c.compliance)];
                for compliance in compliances.into_iter().flatten() {
                    let w = compliance.col_as_slice(l);
                    for (entry, &(a, _)) in column[..n].iter_mut().zip(&active) {
                        *entry += w[a] * s;
                    }
                }
                // Rows of one point follow each other, so row l of this point is active row b − k + l.
                column[b + l - k] += (c[l] - 1.0 / r[l]) * s;
                for (entry, q) in column[n..].iter_mut().zip(&modes.q) {
                    *entry += q[l] * s / rho;
                }
            }
        }
        rhs[b] = -mismatch[k];
        for (j, q) in modes.q.iter().enumerate() {
            tangent[(b, n + j)] = q[k];
        }
    }
    for (j, missing) in problem.missing(&at.p).iter().enumerate() {
        rhs[n + j] = missing / rho;
    }
    let solution = solve_dense(&tangent, &rhs)?;

    let mut dp = vec![0.0; problem.len()];
    for (b, &(k, start)) in active.iter().enumerate() {
        for l in start..start + problem.rows_at(start) {
            dp[l] += slope[l][k - start] * solution[b];
        }
    }
    let dbeta = solution[n..].to_vec();
    // Open rows follow: y = −F − (W + C) δP − Q δβ.
    let mut dv = vec![0.0; problem.len()];
    mul_add(w, &dp, &mut dv);
    if let Some(coupled) = coupled {
        mul_add(coupled.compliance, &dp, &mut dv);
    }
    modes.add(&dbeta, &mut dv);
    let mut y: Vec<f64> = mismatch.iter().zip(&dv).map(|(f, dv)| -f - dv).collect();
    for (b, &(k, _)) in active.iter().enumerate() {
        y[k] = solution[b];
    }
    let dz = y.iter().zip(r).map(|(y, r)| y * r).collect();
    Some((dz, dbeta))
}

/// The same step from the displacement form on the whole body, as papers usually run penalty methods.
///
/// With T = Π'(z) and M = (I − T)/r + T/k, which never loses digits, the springs read δP = −T M⁻¹ (F + δv).
fn whole_direction(
    global: &mut Option<Box<Global>>,
    problem: &mut Reduced<'_>,
    r: &[f64],
    c: &[f64],
    at: &Point,
    mismatch: &[f64],
) -> Result<Option<TwoVectors>, MethodError> {
    let mut rows = Vec::with_capacity(problem.rows.points());
    for i in 0..problem.rows.points() {
        let own = problem.rows.of(i);
        let t = return_map_derivative(problem.friction(i), &at.z[own.clone()], at.branches[i]);
        let (size, first) = (own.len(), own.start);
        let unit = |a: usize, b: usize| f64::from(u8::from(a == b));
        // Mᵀ, since the rows of T M⁻¹ are wanted.
        let m = Mat::from_fn(size, size, |b, a| {
            (unit(a, b) - t[a][b]) / r[first + a] + c[first + a] * t[a][b]
        });
        let mut of_point = [0.0; 3].map(Row::reading);
        for a in 0..size {
            let Some(slope) = solve_dense(&m, &t[a][..size]) else {
                return Ok(None);
            };
            of_point[a].a[a] = 1.0;
            of_point[a].c[..size].copy_from_slice(&slope);
            of_point[a].h = (0..size).map(|b| slope[b] * mismatch[first + b]).sum();
        }
        rows.push(of_point);
    }
    let Some((dp, dv)) = whole_body(global, problem, &at.p, &mut rows, Global::explicit)? else {
        return Ok(None);
    };
    let dz = (0..dp.len())
        .map(|k| dp[k] - r[k] * (mismatch[k] + dv[k] + c[k] * dp[k]))
        .collect();
    Ok(Some((dz, amplitudes(problem, &dp, dv))))
}

impl Point {
    fn new(problem: &Reduced<'_>, z: Vec<f64>, beta: Vec<f64>) -> Self {
        let mut p = z.clone();
        let branches = (0..problem.rows.points())
            .map(|i| return_map(problem.friction(i), &mut p[problem.rows.of(i)]))
            .collect();
        Self {
            z,
            beta,
            p,
            branches,
        }
    }

    fn moved(&self, problem: &Reduced<'_>, t: f64, dz: &[f64], dbeta: &[f64]) -> Self {
        let add = |x: &[f64], s: &[f64]| x.iter().zip(s).map(|(x, s)| x + t * s).collect();
        Self::new(problem, add(&self.z, dz), add(&self.beta, dbeta))
    }
}

/// Adapts a [`Monitor`] and the history to the `report` argument of [`Springs::solve`]. What is noted is the natural map
/// of the contact laws, as for every method: it ends at the modelling error, not at zero.
///
/// `jump(problem, iterate)` is v, without what lies in series.
pub(crate) fn recorded<'m>(
    monitor: &'m mut dyn Monitor,
    jump: impl Fn(&Reduced<'_>, &Point) -> Vec<f64> + 'm,
) -> impl FnMut(&mut Reduced<'_>, &Point, usize) -> bool + 'm {
    move |problem, at, changes| {
        let v = jump(problem, at);
        let natural_map = problem.natural_map(&at.p, &v);
        problem.counters.iterations = problem.history.len();
        problem.history.push(crate::contract::state::Iteration {
            natural_map,
            changes,
        });
        monitor.step(problem.counters.iterations, natural_map)
    }
}
