//! All solutions of a small plane problem: every combination of states is one linear system.
//!
//! ```text
//! open: P = 0     stick: v = 0     slip ±: g = 0, P_t = ∓ μ P_n     without friction closed: g = 0
//! ρ (q + W P + Q β) = 0 on the rows that hold still,   Qᵀ P = c
//! ```
//! A combination whose matrix is singular may hold solutions that this does not see: then nothing is proved.

use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use stickslip_methods::Gauge;

/// Points with which all 4ⁿ combinations are tried: 65 536.
pub const POINTS: usize = 8;

/// Bound that counts as fulfilled, relative to the size of the forces: on the side of a solution.
const SLACK: f64 = 1e-9;

/// Forces beyond this multiple of ρ |q| come of a matrix that is singular to rounding.
const UNBOUNDED: f64 = 1e10;

/// The findings.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Enumeration {
    /// Contact forces of every solution, rows in use, no two of them alike.
    pub solutions: Vec<Vec<f64>>,
    /// Combinations tried.
    pub pieces: usize,
    /// Number with a singular matrix.
    pub undecided: usize,
}

impl Enumeration {
    /// Whether it proves that there is no solution.
    pub fn proves_none(&self) -> bool {
        self.pieces > 0 && self.solutions.is_empty() && self.undecided == 0
    }
}

/// Row k of one combination: v_k = 0, or P_k + s P_n = 0.
enum Law {
    Still,
    Force(f64),
}

/// Tries all combinations; `None` in space, and for more than [`POINTS`] points.
pub fn enumerate(gauge: &Gauge<'_>) -> Option<Enumeration> {
    let rows = gauge.rows();
    let sizes: Vec<usize> = rows.iter().map(|own| own.len()).collect();
    if rows.points() > POINTS || sizes.iter().any(|&n| n > 2) {
        return None;
    }
    // States of a point: open, closed or stick, and with friction the two ways of slip.
    let counts: Vec<usize> = sizes.iter().map(|&n| if n == 1 { 2 } else { 4 }).collect();
    let w = gauge.columns();
    let mut found = Enumeration {
        pieces: counts.iter().product(),
        ..Enumeration::default()
    };
    for code in 0..found.pieces {
        let mut rest = code;
        let states: Vec<usize> = counts
            .iter()
            .map(|count| {
                let state = rest % count;
                rest /= count;
                state
            })
            .collect();
        match solve(gauge, &w, &states) {
            None => found.undecided += 1,
            Some(p) if p.is_empty() => {}
            Some(p) => {
                let size = largest(&p).max(f64::MIN_POSITIVE);
                let alike = |other: &Vec<f64>| {
                    let pairs = p.iter().zip(other);
                    pairs.map(|(a, b)| (a - b).abs()).all(|d| d <= 1e-6 * size)
                };
                if !found.solutions.iter().any(alike) {
                    found.solutions.push(p);
                }
            }
        }
    }
    Some(found)
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// The solution with these states, empty if they do not hold there; `None` if the matrix is singular.
fn solve(gauge: &Gauge<'_>, w: &[Vec<f64>], states: &[usize]) -> Option<Vec<f64>> {
    let (rows, q, rho) = (gauge.rows(), gauge.q(), gauge.rho());
    let (m, modes) = (q.len(), gauge.rigid());
    let n = m + modes.len();
    let mut matrix = Mat::<f64>::zeros(n, n);
    let mut right = Mat::<f64>::zeros(n, 1);
    for ((own, &state), &mu) in rows.iter().zip(states).zip(gauge.friction()) {
        for k in own.clone() {
            let law = match (state, k == own.start) {
                (0, _) => Law::Force(0.0),
                (1, _) | (_, true) => Law::Still,
                (2, false) => Law::Force(mu),
                _ => Law::Force(-mu),
            };
            match law {
                Law::Still => {
                    (0..m).for_each(|j| matrix[(k, j)] = rho * w[j][k]);
                    for (a, mode) in modes.iter().enumerate() {
                        matrix[(k, m + a)] = mode[k];
                    }
                    right[(k, 0)] = -rho * q[k];
                }
                Law::Force(slope) => {
                    matrix[(k, own.start)] += slope;
                    matrix[(k, k)] += 1.0;
                }
            }
        }
    }
    for (a, (mode, c)) in modes.iter().zip(gauge.balance()).enumerate() {
        (0..m).for_each(|j| matrix[(m + a, j)] = mode[j]);
        right[(m + a, 0)] = *c;
    }
    let x = PartialPivLu::new(matrix.as_ref()).solve(&right);
    let p: Vec<f64> = (0..m).map(|k| x[(k, 0)]).collect();
    let scale = rho * largest(q) + largest(gauge.balance());
    // NaN and infinity are no solution either.
    let bounded = (0..n).all(|k| x[(k, 0)].abs() <= UNBOUNDED * scale.max(f64::MIN_POSITIVE));
    let missed = &matrix * &x - &right;
    let met = (0..n).all(|k| missed[(k, 0)].abs() <= SLACK * scale.max(largest(&p)));
    if !bounded || !met {
        return None;
    }
    let slack = SLACK * scale.max(largest(&p));
    let mut points = rows.iter().zip(states).zip(gauge.friction());
    let holds = points.all(|((own, &state), &mu)| {
        let v = |k: usize| {
            let moved: f64 = (0..m).map(|j| w[j][k] * p[j]).sum();
            let rigid: f64 = (modes.iter().enumerate())
                .map(|(a, mode)| mode[k] * x[(m + a, 0)])
                .sum();
            rho * (q[k] + moved) + rigid
        };
        let (normal, shear) = (own.start, own.start + 1);
        match state {
            0 => v(normal) >= -slack,
            1 if own.len() == 1 => p[normal] >= -slack,
            1 => p[normal] >= -slack && p[shear].abs() <= mu * p[normal] + slack,
            2 => p[normal] >= -slack && v(shear) >= -slack,
            _ => p[normal] >= -slack && v(shear) <= slack,
        }
    });
    Some(if holds { p } else { Vec::new() })
}
