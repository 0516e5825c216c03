//! B-differentiable Newton method.
//!
//! Pang, Math. Oper. Res. 15 (1990) 311; Christensen, Klarbring, Pang & Strömberg, Int. J. Numer. Meth. Engng 42
//! (1998) 145; on crack faces the method of the founding paper of this code (its Eqs. 5 to 7, with the bound
//! μ max(P_n, 0): as printed, min(P_n, 0), friction would vanish).
//!
//! ```text
//! v = (g, d) = q + W P + Q β             condensed equilibrium, solved exactly at every step
//! H_n = min(r_n g, P_n)                  Signorini
//! H_t = P_t − proj_{μ max(P_n, 0)}(P_t − r_t d)     Coulomb; proj_s projects on the ball of radius s
//! H(x) + H'(x; δ) = 0,  x <- x + t δ     x = (P, β), together with Qᵀ P = c
//! ```
//!
//! | point                             | row of H'(x; δ)                                                        |
//! |-----------------------------------|------------------------------------------------------------------------|
//! | open,   P_n − r_n g < 0           | δP_n                                                                   |
//! | closed                            | r_n δg                                                                 |
//! | stick,  \|z\| < s                 | r_t δd                                                                 |
//! | slip,   \|z\| > s, e = z/\|z\|    | δP_t − e δs − (s/\|z\|)(I − e eᵀ)(δP_t − r_t δd), δs = μ δP_n if P_n > 0 |
//!
//! with z = P_t − r_t d and s = μ max(P_n, 0). On a kink H' is piecewise linear in δ: a branch is tried, and the one
//! the direction itself asks for is taken (the *B*-derivative, not just one element of a generalised Jacobian).
//! Rows that read δP = −H are eliminated before the dense LU.
//!
//! # Options
//! `r`: r_n = r/W_nn and r_t = r/mean(W_tt) per point. Safe from 1e-3 to 1e3; the limit does not depend on it.
//! `max_iterations`.
//!
//! # Guarantees
//! Full steps are tried first; a non-monotone line search on the energy-scaled merit Σ H²/r steps in only after a rise
//! above the last five merits. Locally quadratic at regular points; in 2D and without friction the last linear
//! problem is the solution, so it ends after finitely many steps. No global guarantee: Coulomb friction is no
//! minimisation.
//!
//! # Failure modes
//! Cycling or stalling for large μ, outside the range where the solution is unique (on random, strongly coupled
//! systems: none fails up to μ = 1, one in ten at μ = 2, half at μ = 5); a singular tangent at P_n = 0, d = 0 corners. If contact points are redundant, W is singular and so is the tangent of sticking points: the step is
//! then regularised by 1e-10/ρ, which leaves the solution untouched and picks one of the possible P. If all points of a
//! floating piece open or slide on the way, the tangent cannot hold it: a few local and global stages (as in LATIN) move
//! the iterate on, and if that happens again and again the piece is reported as a mechanism. The same stages move it on
//! after 15 steps without progress.

#![allow(non_snake_case)]

use faer::Mat;

use crate::problem::b_equations::{Piece, Row, equations, linearise, trial};
use crate::problem::law::tangential_norm;
use crate::problem::line_search::LineSearch;
use crate::problem::linear::dense::{mul_add, solve_dense};
use crate::problem::reduced::{Begin, Limits, Reduced};
use crate::problem::stages::rescue;
use crate::{
    Claim, ContactSystem, Enforcement, Increment, Method, MethodError, Monitor, OptionSpec,
    Options, Outcome, Status,
};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "b-newton",
    label: "B-differentiable Newton",
    reference: "Christensen, Klarbring, Pang & Strömberg, Int. J. Numer. Meth. Engng 42 (1998) 145",
    summary: "Newton's method on the non-smooth equations min(r g, P_n) = 0 and P_t = proj(P_t - r d)",
    exact: true,
    options: &OPTIONS,
    source: include_str!("b_newton.rs"),
    build: |options| Ok(Box::new(BNewton::new(options))),
};

static OPTIONS: [OptionSpec; 2] = [
    OptionSpec {
        name: "r",
        unit: "-",
        default: 1.0,
        min: 1e-3,
        max: 1e3,
        integer: false,
        help: "multiple of 1/W_ii that turns gaps and slips into forces",
    },
    OptionSpec {
        name: "max_iterations",
        unit: "-",
        default: 100.0,
        min: 1.0,
        max: 1e6,
        integer: true,
        help: "Newton steps before giving up",
    },
];

/// Steps without progress after which the iteration counts as cycling.
const PATIENCE: usize = 60;
/// Rounds of branch correction at kinks within one step.
const BRANCH_ROUNDS: usize = 10;
/// Regularisation of a singular tangent of redundant points, relative to 1/ρ.
const RIDGE: f64 = 1e-10;

struct BNewton {
    r: f64,
    max_iterations: usize,
}

impl BNewton {
    fn new(options: &Options) -> Self {
        Self {
            r: options.own("r"),
            max_iterations: options.own("max_iterations") as usize,
        }
    }
}

/// Unknowns of the method.
#[derive(Clone)]
struct Iterate {
    P: Vec<f64>,
    beta: Vec<f64>,
}

impl Iterate {
    fn moved(&self, t: f64, step: &Iterate) -> Iterate {
        let add = |x: &[f64], s: &[f64]| x.iter().zip(s).map(|(x, s)| x + t * s).collect();
        Iterate {
            P: add(&self.P, &step.P),
            beta: add(&self.beta, &step.beta),
        }
    }
}

/// Which pieces of H' meet at the iterate, so that the direction decides.
#[derive(Debug, Clone, Copy)]
struct Kink {
    normal: bool,
    bound: bool,
    tangential: bool,
}

impl Enforcement for BNewton {
    fn prepare(&mut self, system: &ContactSystem) -> Result<(), MethodError> {
        system.elastic().factorise()
    }

    fn solve(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        let mut problem = match Reduced::begin(increment, |_| Claim::Exact)? {
            Begin::Done(outcome) => return Ok(outcome),
            Begin::Contact(problem) => problem,
        };
        let rigid_springs = vec![0.0; problem.len()];
        let r: Vec<f64> = problem
            .scales(&rigid_springs)
            .iter()
            .map(|scale| self.r * scale)
            .collect();
        let P = problem.start_forces();
        let mut x = Iterate {
            beta: problem.start_amplitudes(&P),
            P,
        };
        let limits = Limits {
            iterations: self.max_iterations,
            patience: PATIENCE,
        };
        let mut search = LineSearch::default();
        let mut before: Vec<Piece> = Vec::new();

        let status = loop {
            let v = problem.jump(&x.P, &x.beta);
            let (pieces, kinks) = classify(&problem, &r, &x.P, &v);
            let changes = pieces.iter().zip(&before).filter(|(a, b)| a != b).count();
            let natural_map = problem.natural_map(&x.P, &v);
            if let Some(status) = problem.ends(natural_map, changes, limits, monitor) {
                match problem.confirm(status, &x.P, &x.beta)? {
                    Some(status) => break status,
                    None => continue,
                }
            }
            before.clone_from(&pieces);
            let stuck = problem.stagnates();
            let step = (!stuck).then(|| direction(&mut problem, &r, &x, &v, pieces, &kinks));
            let Some(step) = step.flatten() else {
                if problem.rescue_left()
                    && let Some(pair) = rescue(&mut problem)
                {
                    x = Iterate {
                        P: pair.p,
                        beta: pair.beta,
                    };
                    continue;
                }
                break if stuck {
                    Status::Stalled
                } else {
                    problem.singular()
                };
            };
            search.record(merit(&problem, &r, &x.P, &v));
            let t = search.length(|t| {
                let trial = x.moved(t, &step);
                let v = problem.jump(&trial.P, &trial.beta);
                merit(&problem, &r, &trial.P, &v)
            });
            x = x.moved(t, &step);
            problem.rebalance(&mut x.P);
        };
        problem.finish(status, &x.P, &x.beta)
    }
}

/// Σ H²/r over all rows, an energy.
fn merit(problem: &Reduced<'_>, r: &[f64], P: &[f64], v: &[f64]) -> f64 {
    let mut sum = 0.0;
    for i in 0..problem.rows.points() {
        let rows = problem.rows.of(i);
        let H = equations(
            problem.friction(i),
            &r[rows.clone()],
            &P[rows.clone()],
            &v[rows.clone()],
        );
        sum += rows.zip(H).map(|(k, h)| h * h / r[k]).sum::<f64>();
    }
    sum
}

/// Piece of H' per point at the current iterate, closed and sticking on a kink, and where the kinks are.
fn classify(problem: &Reduced<'_>, r: &[f64], P: &[f64], v: &[f64]) -> (Vec<Piece>, Vec<Kink>) {
    let point = |i: usize| {
        let rows = problem.rows.of(i);
        let (r, P, v) = (&r[rows.clone()], &P[rows.clone()], &v[rows]);
        let s = problem.friction(i) * P[0].max(0.0);
        let z = trial(r, P, v);
        let t = tangential_norm(&z[..P.len()]);
        let closed = r[0] * v[0] <= P[0];
        let kink = Kink {
            normal: r[0] * v[0] == P[0],
            bound: P[0] == 0.0,
            tangential: t == s,
        };
        let bound_moves = P[0] > 0.0 || (kink.bound && closed);
        // At t = s = 0 an open point has to lose its tangential force, a closed one may stick.
        let slip = t > s || (kink.tangential && s == 0.0 && !closed);
        (
            Piece {
                closed,
                bound_moves,
                slip,
            },
            kink,
        )
    };
    (0..problem.rows.points()).map(point).unzip()
}

/// Newton direction H(x) + H'(x; δ) = 0; `None` if the tangent is singular.
fn direction(
    problem: &mut Reduced<'_>,
    r: &[f64],
    x: &Iterate,
    v: &[f64],
    mut pieces: Vec<Piece>,
    kinks: &[Kink],
) -> Option<Iterate> {
    let mut step = None;
    for _ in 0..BRANCH_ROUNDS {
        let solved = regularised_step(problem, r, x, v, &pieces)?;
        let contradicted = correct_pieces(problem, r, x, v, &solved, kinks, &mut pieces);
        step = Some(solved);
        if !contradicted {
            break;
        }
    }
    step
}

/// The step of the given pieces, regularised if their tangent is singular.
fn regularised_step(
    problem: &mut Reduced<'_>,
    r: &[f64],
    x: &Iterate,
    v: &[f64],
    pieces: &[Piece],
) -> Option<Iterate> {
    problem.counters.factorisations += 1;
    linear_step(problem, r, x, v, pieces, 0.0).or_else(|| {
        problem.counters.factorisations += 1;
        linear_step(problem, r, x, v, pieces, RIDGE)
    })
}

/// Switches every piece on a kink that the direction contradicts; says whether there was one.
fn correct_pieces(
    problem: &Reduced<'_>,
    r: &[f64],
    x: &Iterate,
    v: &[f64],
    step: &Iterate,
    kinks: &[Kink],
    pieces: &mut [Piece],
) -> bool {
    if !kinks.iter().any(|k| k.normal || k.bound || k.tangential) {
        return false;
    }
    let mut dv = vec![0.0; problem.len()];
    mul_add(&problem.condensed.w, &step.P, &mut dv);
    problem.condensed.modes.add(&step.beta, &mut dv);
    let mut contradicted = false;
    for (i, piece) in pieces.iter_mut().enumerate() {
        let rows = problem.rows.of(i);
        let (r, P, v) = (&r[rows.clone()], &x.P[rows.clone()], &v[rows.clone()]);
        let (dP, dv) = (&step.P[rows.clone()], &dv[rows]);
        let mu = problem.friction(i);
        let mut wanted = *piece;
        if kinks[i].normal {
            wanted.closed = r[0] * dv[0] <= dP[0];
        }
        if kinks[i].bound {
            wanted.bound_moves = dP[0] > 0.0;
        }
        if kinks[i].tangential && P.len() > 1 {
            let (z, dz) = (trial(r, P, v), trial(r, dP, dv));
            let t = tangential_norm(&z[..P.len()]);
            let outward = if t > 0.0 {
                (1..P.len()).map(|k| z[k] * dz[k]).sum::<f64>() / t
            } else {
                tangential_norm(&dz[..P.len()])
            };
            wanted.slip = outward > if piece.bound_moves { mu * dP[0] } else { 0.0 };
        }
        // Within rounding of the switching plane both pieces give the same step.
        let scale = dP
            .iter()
            .zip(dv)
            .zip(r)
            .map(|((p, v), r)| p.abs() + (r * v).abs())
            .sum::<f64>();
        let close = |a: f64| a.abs() <= 1e-12 * scale;
        if wanted.closed != piece.closed && close(r[0] * dv[0] - dP[0]) {
            wanted.closed = piece.closed;
        }
        if wanted.bound_moves != piece.bound_moves && close(dP[0]) {
            wanted.bound_moves = piece.bound_moves;
        }
        contradicted |= wanted != *piece;
        *piece = wanted;
    }
    contradicted
}

/// Solves the linear problem of the given pieces. `ridge`/ρ is added to the diagonal of W.
fn linear_step(
    problem: &Reduced<'_>,
    r: &[f64],
    x: &Iterate,
    v: &[f64],
    pieces: &[Piece],
    ridge: f64,
) -> Option<Iterate> {
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
    let mut active: Vec<(usize, usize, Row)> = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        let rows = problem.rows.of(i);
        let (mu, range) = (problem.friction(i), rows.clone());
        let equations = linearise(
            mu,
            &r[range.clone()],
            &x.P[range.clone()],
            &v[range],
            *piece,
        );
        for (k, row) in rows.clone().zip(equations) {
            let local = k - rows.start;
            let alone = (0..rows.len()).all(|l| row.c[l] == 0.0 && (l == local || row.a[l] == 0.0));
            if alone {
                step.P[k] = -row.h / row.a[local];
            } else {
                active.push((k, rows.start, row));
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
                *entry += row.a[k - point] + row.c[k - point] * ridge / rho;
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
