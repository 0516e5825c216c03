//! W and the tangent of the contact equations on the points that are in contact.
//! ```text
//! W_AA            rows of all points that are not open
//! T = | W_nn − μ W_ne   W_nt |     n: all closed points, t: tangential rows of sticking ones,
//!     | W_tn − μ W_te   W_tt |     e: direction in which a point slips, P_t = μ P_n e
//! ```
//! both bordered by Q/ρ where the body floats. T is the matrix of an active-set step, columns of slip eliminated; that the
//! direction of slip turns in space is left out.

use faer::Mat;
use stickslip_methods::Gauge;

use super::watch::{OPEN, STICK, State};

/// Singular values of a matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Largest.
    pub largest: f64,
    /// Smallest.
    pub smallest: f64,
}

impl Spectrum {
    /// Of a matrix, without singular values at most `redundant` times the largest.
    fn of(matrix: &Mat<f64>, redundant: f64) -> Option<Self> {
        let values = matrix.singular_values().ok()?;
        let largest = values.iter().copied().fold(0.0, f64::max);
        let counts = values.iter().copied().filter(|&s| s > redundant * largest);
        let smallest = counts.fold(f64::INFINITY, f64::min);
        (largest > 0.0).then_some(Self { largest, smallest })
    }

    /// Largest over smallest; infinite for a singular matrix.
    pub fn condition(self) -> f64 {
        self.largest / self.smallest
    }

    /// Smallest over largest.
    pub fn distance(self) -> f64 {
        self.smallest / self.largest
    }
}

/// Rows `of` against columns given as combinations of rows, bordered by Q/ρ.
fn bordered(gauge: &Gauge<'_>, of: &[usize], columns: &[Vec<(usize, f64)>]) -> Mat<f64> {
    let (w, q, rho) = (gauge.columns(), gauge.rigid(), gauge.rho());
    let (m, modes) = (of.len(), gauge.rigid().len());
    Mat::from_fn(m + modes, m + modes, |i, j| match (i < m, j < m) {
        (true, true) => columns[j].iter().map(|&(k, c)| c * w[k][of[i]]).sum(),
        (true, false) => q[j - m][of[i]] / rho,
        (false, true) => {
            columns[j]
                .iter()
                .map(|&(k, c)| c * q[i - m][k])
                .sum::<f64>()
                / rho
        }
        (false, false) => 0.0,
    })
}

/// Singular values of W at most this fraction of the largest are redundant contact points: no iteration feels them.
const REDUNDANT: f64 = 1e-12;

/// Spectrum of W on the rows of all points that are not open, redundancy left out; `None` without any.
pub fn loaded(gauge: &Gauge<'_>, states: &[State]) -> Option<Spectrum> {
    let points = gauge.rows().iter().zip(states);
    let rows: Vec<usize> = points
        .filter(|(_, state)| **state != OPEN)
        .flat_map(|(own, _)| own)
        .collect();
    let columns: Vec<Vec<(usize, f64)>> = rows.iter().map(|&k| vec![(k, 1.0)]).collect();
    (!rows.is_empty()).then(|| Spectrum::of(&bordered(gauge, &rows, &columns), REDUNDANT))?
}

/// Spectrum of T at (P, v) with these states. Without points in contact a floating body is held by nothing: T is 0.
pub fn tangent(gauge: &Gauge<'_>, states: &[State], (p, v): (&[f64], &[f64])) -> Option<Spectrum> {
    let rho = gauge.rho();
    let (mut rows, mut columns) = (Vec::new(), Vec::new());
    for ((own, &state), &mu) in gauge.rows().iter().zip(states).zip(gauge.friction()) {
        if state == OPEN {
            continue;
        }
        let mut normal = vec![(own.start, 1.0)];
        if state == STICK {
            for k in own.start + 1..own.end {
                rows.push(k);
                columns.push(vec![(k, 1.0)]);
            }
        } else {
            let z: Vec<(usize, f64)> = (own.start + 1..own.end)
                .map(|k| (k, p[k] - rho * v[k]))
                .collect();
            let size = z.iter().map(|(_, z)| z * z).sum::<f64>().sqrt();
            normal.extend(z.into_iter().map(|(k, z)| (k, mu * z / size)));
        }
        rows.push(own.start);
        columns.push(normal);
    }
    if rows.is_empty() {
        let held = gauge.rigid().is_empty();
        return (!held).then_some(Spectrum {
            largest: 1.0,
            smallest: 0.0,
        });
    }
    // All of them count: a negative fraction leaves none out.
    Spectrum::of(&bordered(gauge, &rows, &columns), -1.0)
}
