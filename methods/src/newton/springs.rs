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

use crate::algebra::dense::{DenseLu, along, mul_add, ratio};
use crate::condensed::pair::Pair;
use crate::condensed::point_row::{Bordered, Law, PointRow};
use crate::condensed::stages::rescue;
use crate::condensed::whole_body::WholeBody;
use crate::contract::law::{Branch, return_map, return_map_derivative};
use crate::newton::line_search::LineSearch;
use crate::newton::step::{Tangent, monolithic_step};
use crate::{ContactProblem, Forces, MethodError, Monitor, Status};

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
    fn compliance(&self, problem: &ContactProblem<'_>) -> Vec<f64> {
        problem.by_row(1.0 / self.normal, 1.0 / self.tangential)
    }

    /// r by row.
    fn scales(&self, problem: &ContactProblem<'_>) -> Vec<f64> {
        let mut compliance = self.compliance(problem);
        if let Some(coupled) = &self.coupled {
            for (k, c) in compliance.iter_mut().enumerate() {
                *c += coupled.compliance[(k, k)];
            }
        }
        problem.scales(&compliance)
    }

    /// v' by row.
    fn stretched(&self, problem: &ContactProblem<'_>, p: &[f64], beta: &[f64]) -> Vec<f64> {
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
    pub fn predict(&self, problem: &ContactProblem<'_>, Forces { p, beta }: Forces) -> Point {
        let r = self.scales(problem);
        let v = self.stretched(problem, &p, &beta);
        let z = (0..p.len()).map(|k| p[k] - r[k] * v[k]).collect();
        Point::new(problem, z, beta)
    }

    /// F by row, in m.
    fn mismatch(&self, problem: &ContactProblem<'_>, r: &[f64], at: &Point) -> Vec<f64> {
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
        problem: &mut ContactProblem<'_>,
        mut at: Point,
        stop: f64,
        max_iterations: usize,
        tangent: &mut Tangent,
        mut report: impl FnMut(&mut ContactProblem<'_>, &Point, usize) -> bool,
    ) -> Result<(Status, Point), MethodError> {
        let (r, c) = (self.scales(problem), self.compliance(problem));
        let mut search = LineSearch::default();
        let mut before = at.branches.clone();
        let mut last = f64::INFINITY;
        for iteration in 0.. {
            let mismatch = self.mismatch(problem, &r, &at);
            let residual = residual(problem, &at, &mismatch);
            let pairs = at.branches.iter().zip(&before);
            let changes = pairs.filter(|(a, b)| a != b).count();
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
            let coupled = self.coupled.as_ref();
            let mut step = match tangent {
                Tangent::Condensed(_) => {
                    direction(problem, coupled, &r, &c, &at, &mismatch, Bordered::new)
                }
                Tangent::Monolithic(body) => {
                    whole_direction(body, problem, &r, &c, &at, &mismatch)?
                }
            };
            if step.is_none()
                && problem.rescue_left()
                && let Some(pair) = rescue(problem)?
            {
                at = self.predict(problem, pair.into());
                continue;
            }
            if step.is_none() && matches!(tangent, Tangent::Condensed(_)) {
                step = direction(problem, coupled, &r, &c, &at, &mismatch, Bordered::held);
            }
            let Some((dz, dbeta)) = step else {
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
fn residual(problem: &ContactProblem<'_>, at: &Point, mismatch: &[f64]) -> f64 {
    let rho = problem.operator.rho;
    let missing: f64 = problem.missing(&at.p).iter().map(|c| c * c).sum();
    let square: f64 = mismatch.iter().map(|f| (rho * f).powi(2)).sum();
    ratio((square + missing).sqrt(), problem.reference_force(&at.p))
}

/// Σ r F² plus the missing balance, an energy.
fn merit(problem: &ContactProblem<'_>, r: &[f64], at: &Point, mismatch: &[f64]) -> f64 {
    let missing: f64 = problem
        .missing(&at.p)
        .iter()
        .map(|c| c * c / problem.operator.rho)
        .sum();
    missing + mismatch.iter().zip(r).map(|(f, r)| r * f * f).sum::<f64>()
}

/// With loose pieces held or not.
type Factored = fn(&ContactProblem<'_>, &[usize], &Law<'_>) -> Option<Bordered>;

/// (δz, δβ).
type SpringStep = (Vec<f64>, Vec<f64>);

/// Newton step (δz, δβ); `None` if the tangent is singular.
///
/// With y = δz/r and δP = S y, S = Π'(z) r, the rows of active points read y + (W + C + 1/k − 1/r) S y + Q δβ = −F.
fn direction(
    problem: &mut ContactProblem<'_>,
    coupled: Option<&Coupled<'_>>,
    r: &[f64],
    c: &[f64],
    at: &Point,
    mismatch: &[f64],
    factored: Factored,
) -> Option<SpringStep> {
    problem.counters.factorisations += 1;
    let n = problem.len();
    let (mut active, mut e, mut s) = (Vec::new(), vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
    for (i, own) in problem.rows.iter().enumerate() {
        if at.branches[i] == Branch::Open {
            continue;
        }
        let d = return_map_derivative(problem.friction(i), &at.z[own.clone()], at.branches[i]);
        active.extend(own.clone());
        for (a, k) in own.clone().enumerate() {
            for (b, l) in own.clone().enumerate() {
                s[k][b] = d[a][b] * r[l];
                e[k][b] = (c[k] - 1.0 / r[k]) * s[k][b];
            }
        }
    }
    let law = Law::Columns {
        unit: 1.0,
        e: &e,
        s: &s,
        series: coupled.map(|c| c.compliance),
    };
    let f: Vec<f64> = active.iter().map(|&k| -mismatch[k]).collect();
    let mut system = factored(problem, &active, &law)?;
    let (solution, dbeta) = system.solve(&f, &problem.missing(&at.p))?;

    let mut y = vec![0.0; n];
    active.iter().zip(&solution).for_each(|(&k, x)| y[k] = *x);
    let mut dp = vec![0.0; n];
    for own in problem.rows.iter() {
        for k in own.clone() {
            dp[k] = own.clone().zip(s[k]).map(|(l, s)| s * y[l]).sum();
        }
    }
    // Open rows follow: y = −F − (W + C) δP − Q δβ.
    let mut dv = vec![0.0; n];
    problem.operator.w.apply_add(&dp, &mut dv);
    if let Some(coupled) = coupled {
        mul_add(coupled.compliance, &dp, &mut dv);
    }
    problem.operator.modes.add(&dbeta, &mut dv);
    let mut y: Vec<f64> = mismatch.iter().zip(&dv).map(|(f, dv)| -f - dv).collect();
    active.iter().zip(&solution).for_each(|(&k, x)| y[k] = *x);
    let dz = y.iter().zip(r).map(|(y, r)| y * r).collect();
    Some((dz, dbeta))
}

/// The same step from the displacement form on the whole body, as papers usually run penalty methods.
///
/// With T = Π'(z) and M = (I − T)/r + T/k, which never loses digits, the springs read δP = −T M⁻¹ (F + δv).
fn whole_direction(
    body: &mut Option<Box<WholeBody>>,
    problem: &mut ContactProblem<'_>,
    r: &[f64],
    c: &[f64],
    at: &Point,
    mismatch: &[f64],
) -> Result<Option<SpringStep>, MethodError> {
    let mut rows = Vec::with_capacity(problem.rows.points());
    for i in 0..problem.rows.points() {
        let own = problem.rows.of(i);
        let t = return_map_derivative(problem.friction(i), &at.z[own.clone()], at.branches[i]);
        let (size, first) = (own.len(), own.start);
        let unit = |a: usize, b: usize| f64::from(u8::from(a == b));
        // Mᵀ, since the rows of T M⁻¹ are wanted.
        let Some(m) = DenseLu::new(&Mat::from_fn(size, size, |b, a| {
            (unit(a, b) - t[a][b]) / r[first + a] + c[first + a] * t[a][b]
        })) else {
            return Ok(None);
        };
        let mut of_point = PointRow::reading([0.0; 3]);
        for a in 0..size {
            let Some(slope) = m.solve(&t[a][..size]) else {
                return Ok(None);
            };
            of_point[a].a[a] = 1.0;
            of_point[a].c[..size].copy_from_slice(&slope);
            of_point[a].h = (0..size).map(|b| slope[b] * mismatch[first + b]).sum();
        }
        rows.push(of_point);
    }
    let step = monolithic_step(body, problem, &at.p, &mut rows, WholeBody::explicit)?;
    let Some(Pair { p: dp, v: dv, beta }) = step else {
        return Ok(None);
    };
    let dz = (0..dp.len())
        .map(|k| dp[k] - r[k] * (mismatch[k] + dv[k] + c[k] * dp[k]))
        .collect();
    Ok(Some((dz, beta)))
}

impl From<Point> for Forces {
    fn from(Point { p, beta, .. }: Point) -> Self {
        Self { p, beta }
    }
}

impl Point {
    fn new(problem: &ContactProblem<'_>, z: Vec<f64>, beta: Vec<f64>) -> Self {
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

    fn moved(&self, problem: &ContactProblem<'_>, t: f64, dz: &[f64], dbeta: &[f64]) -> Self {
        Self::new(problem, along(&self.z, t, dz), along(&self.beta, t, dbeta))
    }
}

/// Adapts a [`Monitor`] and the history to the `report` argument of [`Springs::solve`]. What is noted is the violation
/// of the contact laws, as for every method: it ends at the modelling error, not at zero.
///
/// `jump(problem, iterate)` is v, without what lies in series.
pub(crate) fn recorded<'m>(
    monitor: &'m mut dyn Monitor,
    jump: impl Fn(&ContactProblem<'_>, &Point) -> Vec<f64> + 'm,
) -> impl FnMut(&mut ContactProblem<'_>, &Point, usize) -> bool + 'm {
    move |problem, at, changes| {
        let v = jump(problem, at);
        let violation = problem.violation(&at.p, &v);
        problem.counters.iterations = problem.history.len();
        problem.note(violation, changes);
        monitor.iterate(&|| (at.p.clone(), v.clone()));
        monitor.step(problem.counters.iterations, violation)
    }
}
