//! Sparse Cholesky factor of the symmetrically scaled stiffness, D K D = L Lᵀ with D = diag(K)^(−1/2).
//!
//! The scaling keeps the condition number bounded however small a cut cell is. Rows and columns of pinned unknowns
//! (one per rigid motion) are replaced by those of the unit matrix; what is solved for are balanced forces, see [`Balance`].

use std::sync::Arc;
use std::time::Instant;

use crate::algebra::dense::{larger, norm, ratio};
use crate::algebra::floating::Balance;
use crate::algebra::matrix::SquareMatrix;
use crate::algebra::multifrontal::{Analysis, Cholesky, Columns, Ordering};
use crate::algebra::plain::Full;
use crate::algebra::strips::Failure;
use crate::error::MethodError;

/// Refinement aims at this [`backward_error`], a few units of rounding.
const REFINED: f64 = 1e-15;
/// Pivots of D K D, whose diagonal is 1, lie above this unless K is singular to working precision.
const SMALLEST_PIVOT: f64 = 1e-12;
/// More refinement steps do not help once rounding of the residual itself dominates.
const MAX_REFINEMENTS: usize = 3;

/// Part of the error of one row that counts: where all rows together may be off by 1e-12 of all forces, none may by more than
/// 1e-7 of its own. Refined solves leave 1e-15 to 4e-9; 2e-3 was left where the displacements of a sliver were lost.
const ROW: f64 = 1e-5;
/// What moves an unknown by ROW times this of the largest is no error of a row.
const UNMOVED: f64 = 1e-6;

/// Backward error of displacements u under some forces, r = K u − Σ f the residual:
/// ```text
/// max(|r| / (||K| |u|| + Σ |f|),  ROW max_j |r_j| / ((|K| |u| + Σ |f|)_j + UNMOVED K_jj u_max))
/// u_max = max(max |u_j|, max Σ |f_j| / max K_jj)
/// ```
/// The norm of all rows loses the forces on a sliver beside those on whole cells, and its displacements then are anything; its
/// own rows do not (Oettli and Prager, 1964). `size` is work.
pub(crate) fn backward_error(
    k: &SquareMatrix,
    u: &[f64],
    forces: &[&[f64]],
    residual: &[f64],
    size: &mut [f64],
) -> f64 {
    k.mul_abs(u, size);
    let on = |j: usize| forces.iter().map(|f| f[j].abs()).sum::<f64>();
    let (mut moved, mut force, mut stiffest) = (0.0, 0.0, 0.0);
    for (j, u) in u.iter().enumerate() {
        moved = larger(moved, u.abs());
        force = larger(force, on(j));
        stiffest = larger(stiffest, k.diagonal(j));
    }
    let moved = larger(moved, ratio(force, stiffest));
    let rows = residual.iter().enumerate().map(|(j, r)| {
        let own = size[j] + on(j) + UNMOVED * k.diagonal(j) * moved;
        ratio(r.abs(), own)
    });
    let forces: f64 = forces.iter().map(|f| norm(f)).sum();
    let all = ratio(norm(residual), norm(size) + forces);
    larger(all, ROW * rows.fold(0.0, larger))
}

/// The factor with everything needed to solve.
pub(crate) struct Factor {
    cholesky: Cholesky,
    pub ordering: Arc<Ordering>,
    /// D by unknown.
    pub scale: Vec<f64>,
    /// Pinned unknowns.
    pub pins: Vec<usize>,
    /// Forces and motions of a floating body.
    pub balance: Arc<Balance>,
    pub factorisation_s: f64,
}

impl Factor {
    /// Of a K of the pattern that was analysed, without its pinned rows and columns.
    pub fn new(
        k: &SquareMatrix,
        analysis: &Analysis,
        pins: Vec<usize>,
        balance: Arc<Balance>,
    ) -> Result<Self, MethodError> {
        let Analysis {
            ordering,
            tree,
            entries,
        } = analysis;
        let n = k.size();
        let clock = Instant::now();
        let scale: Vec<f64> = (0..n).map(|j| 1.0 / k.diagonal(j).sqrt()).collect();
        let values = scaled_values(k, &scale, &pins, ordering, &entries.begin);
        let not_positive = |column: usize| MethodError::NotPositiveDefinite {
            unknown: ordering.forward[column],
            size: n,
        };
        let cholesky =
            Cholesky::new(tree.clone(), entries, &values).map_err(|failure| match failure {
                Failure::NotPositive(column) => not_positive(column),
                // The largest array of a run: where it does not fit, the run says so.
                Failure::OutOfMemory => MethodError::OutOfMemory {
                    what: "sparse factorisation",
                },
            })?;
        let factorisation_s = clock.elapsed().as_secs_f64();
        // A singular K can pass by luck, with pivots that are rounding.
        if let Some(column) = cholesky.pivot_below(SMALLEST_PIVOT) {
            return Err(not_positive(column));
        }
        Ok(Self {
            cholesky,
            ordering: ordering.clone(),
            scale,
            pins,
            balance,
            factorisation_s,
        })
    }

    /// x := G f in place with iterative refinement: solves K x = f if f leaves no rigid motion a resultant.
    pub fn solve(&self, k: &SquareMatrix, x: &mut [f64]) {
        let n = k.size();
        let mut work = vec![0.0; n];
        let mut f = x.to_vec();
        self.balance.balance(&mut f);
        for &pin in &self.pins {
            f[pin] = 0.0;
        }
        x.copy_from_slice(&f);
        self.solve_scaled(x, &mut work);

        let (mut residual, mut kx) = (vec![0.0; n], vec![0.0; n]);
        let mut best = f64::INFINITY;
        for _ in 0..MAX_REFINEMENTS {
            k.mul(x, &mut kx);
            for &pin in &self.pins {
                kx[pin] = 0.0;
            }
            for j in 0..n {
                residual[j] = f[j] - kx[j];
            }
            let relative = backward_error(k, x, &[&f], &residual, &mut kx);
            if relative <= REFINED || relative > 0.5 * best {
                break;
            }
            best = relative;
            self.solve_scaled(&mut residual, &mut work);
            for j in 0..n {
                x[j] += residual[j];
            }
        }
        self.balance.take_out(x);
    }

    /// x := D (L Lᵀ)⁻¹ D x, 0 for pinned unknowns.
    pub fn solve_scaled(&self, x: &mut [f64], work: &mut [f64]) {
        self.scale_and_permute(x, work);
        self.cholesky.solve(work);
        self.permute_back_and_scale(work, x);
    }

    fn scale_and_permute(&self, from: &[f64], to: &mut [f64]) {
        for (to, &j) in to.iter_mut().zip(&self.ordering.forward) {
            *to = from[j] * self.scale[j];
        }
    }

    fn permute_back_and_scale(&self, from: &[f64], to: &mut [f64]) {
        for (from, &j) in from.iter().zip(&self.ordering.forward) {
            to[j] = from * self.scale[j];
        }
        self.pins.iter().for_each(|&pin| to[pin] = 0.0);
    }

    /// Yᵀ Y with L Y = B, if it is to be formed, of which the upper triangle counts, and its diagonal.
    pub fn condense(&self, b: &Columns, formed: bool) -> (Full, Vec<f64>) {
        self.cholesky.condense(b, formed)
    }
}

/// Values of D K D below its diagonal of ones, in the order of L, column `c` from `begin[c]` on; 0 where a pinned unknown
/// has a part.
fn scaled_values(
    k: &SquareMatrix,
    scale: &[f64],
    pins: &[usize],
    ordering: &Ordering,
    begin: &[usize],
) -> Vec<f64> {
    let mut scale = scale.to_vec();
    pins.iter().for_each(|&pin| scale[pin] = 0.0);
    let mut next = begin.to_vec();
    let mut values = vec![0.0; begin.last().copied().unwrap_or(0)];
    for j in 0..k.size() {
        for e in k.col_ptr()[j] + 1..k.col_ptr()[j + 1] {
            let i = k.row_idx()[e];
            let column = ordering.inverse[i].min(ordering.inverse[j]);
            values[next[column]] = k.values()[e] * scale[i] * scale[j];
            next[column] += 1;
        }
    }
    values
}

/// An error of a kernel.
pub(crate) fn kernel(what: &'static str, reason: String) -> MethodError {
    MethodError::Kernel { what, reason }
}
