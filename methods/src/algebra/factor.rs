//! Sparse Cholesky factor of the symmetrically scaled stiffness, D K D = L Lᵀ with D = diag(K)^(−1/2).
//!
//! The scaling keeps the condition number bounded however small a cut cell is. Rows and columns of pinned unknowns
//! (one per rigid motion) are replaced by those of the unit matrix; what is solved for are balanced forces, see [`Balance`].

use std::sync::Arc;
use std::time::Instant;

use faer::{Mat, MatRef};

use crate::algebra::dense::{larger, norm, ratio};
use crate::algebra::floating::Balance;
use crate::algebra::matrix::SquareMatrix;
use crate::algebra::multifrontal::{Analysis, Cholesky, Ordering};
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

/// In which order the unknowns may be eliminated, and what is condensed to.
#[derive(Default)]
pub(crate) struct Elimination {
    /// Preferred order of those not in contact, then of those in contact.
    pub contact_last: Vec<usize>,
    /// Preferred order of all alike; empty if contact unknowns are to come last.
    pub free: Vec<usize>,
    /// The unknowns that move a contact point.
    pub in_contact: Vec<bool>,
    /// Unknowns of every contact row.
    pub rows: Vec<Vec<usize>>,
}

impl Elimination {
    /// Of the order that takes least work until W is known.
    ///
    /// With the contact unknowns last W follows from their part of L alone, which is dense: where cracks run all over a body
    /// that is most of the work. Then W is condensed along the tree of the free order instead. Rows that balance a floating body
    /// touch all contact unknowns, which come last there.
    pub fn planned(&self, k: &SquareMatrix, balance: &Balance) -> Planned {
        /// Multiplications and additions in the contact unknowns below which another order gains little.
        const WORTH: f64 = 5e8;
        /// Least gain by the free order.
        const GAIN: f64 = 0.8;
        let clock = Instant::now();
        let planned = |analysis: Analysis, condensation: f64| Planned {
            analysis,
            condensation,
            analysis_s: clock.elapsed().as_secs_f64(),
        };
        let last = || Analysis::new(k, &self.contact_last, &self.in_contact);
        let c = self.in_contact.iter().filter(|own| **own).count() as f64;
        let m = self.rows.len() as f64;
        // Columns of Y begin where their row does: of a dense triangle and a dense square about a third is left.
        let condensation = c * m * (c + m) / 3.0;
        // With the contact unknowns last at least that of their own part.
        let dense = c.powi(3) / 3.0 + condensation;
        if self.free.is_empty() || balance.holds_something() || dense < WORTH {
            return planned(last(), condensation);
        }
        let free = Analysis::new(k, &self.free, &vec![false; k.size()]);
        let place = |row: &Vec<usize>| row.iter().map(|&j| free.ordering.inverse[j]).collect();
        let along_tree = free.tree.condensation(self.rows.iter().map(place));
        let least = (free.tree.work() + along_tree) / GAIN;
        if least < dense {
            return planned(free, along_tree);
        }
        let last = last();
        if least < last.tree.work() + condensation {
            planned(free, along_tree)
        } else {
            planned(last, condensation)
        }
    }
}

/// How K will be factored.
pub(crate) struct Planned {
    pub analysis: Analysis,
    /// Multiplications and additions from there to W.
    pub condensation: f64,
    pub analysis_s: f64,
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

    /// Whether contact unknowns come last.
    pub fn contact_last(&self) -> bool {
        self.ordering.contact_begin < self.scale.len()
    }

    /// Yᵀ Y with L Y = B for columns of B given by positions in L, if it is to be formed, of which the upper triangle counts,
    /// and its diagonal.
    pub fn condense(&self, b: &[Vec<(usize, f64)>], formed: bool) -> (Mat<f64>, Vec<f64>) {
        self.cholesky.condense(b, formed)
    }

    /// The part of L on the contact unknowns, strip by strip.
    pub fn of_contact(&self) -> impl Iterator<Item = Columns<'_>> {
        let tree = &self.cholesky.tree;
        (tree.contact..tree.nodes.len()).flat_map(move |s| {
            let begin = tree.nodes[s].columns.start - self.ordering.contact_begin;
            let strips = self.cholesky.strips(s);
            strips.map(move |(first, block)| Columns {
                begin: begin + first,
                block,
                below: tree.pattern(s),
            })
        })
    }
}

/// Columns of L on contact unknowns, which are counted from the first of them.
pub(crate) struct Columns<'a> {
    /// First column.
    pub begin: usize,
    /// Their own rows, of which the lower triangle counts, those of the later columns of the supernode, and the rows below.
    pub block: MatRef<'a, f64>,
    /// Unknowns of the last of these, counted from the first of all.
    pub below: &'a [u32],
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of n × n points with springs to their neighbours.
    fn grid(n: usize) -> SquareMatrix {
        let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n * n {
            let right = (j % n + 1 < n).then_some(j + 1);
            let above = (j + n < n * n).then_some(j + n);
            row_idx.push(j);
            values.push(4.1);
            for i in right.into_iter().chain(above) {
                row_idx.push(i);
                values.push(-1.0);
            }
            col_ptr.push(row_idx.len());
        }
        SquareMatrix::symmetric(n * n, col_ptr, row_idx, values).unwrap()
    }

    /// By halves, the line between them last.
    fn dissected([x, y]: [std::ops::Range<usize>; 2], n: usize, order: &mut Vec<usize>) {
        let wide = x.len() >= y.len();
        let long = if wide { x.clone() } else { y.clone() };
        if long.len() < 3 {
            order.extend(y.flat_map(|j| x.clone().map(move |i| i + n * j)));
            return;
        }
        let middle = (long.start + long.end) / 2;
        for part in [long.start..middle, middle + 1..long.end, middle..middle + 1] {
            let own = if wide {
                [part, y.clone()]
            } else {
                [x.clone(), part]
            };
            if own.iter().any(|r| r.len() == 1) {
                order.extend(
                    own[1]
                        .clone()
                        .flat_map(|j| own[0].clone().map(move |i| i + n * j)),
                )
            } else {
                dissected(own, n, order)
            }
        }
    }

    /// Goal: contact unknowns come last where they lie on a line, and anywhere where they are all over a body; never where it
    /// floats.
    #[test]
    fn the_order_that_takes_less_work_is_taken() {
        let n = 220;
        let k = grid(n);
        let mut order = Vec::new();
        dissected([0..n, 0..n], n, &mut order);
        let free = |touched: &dyn Fn(usize) -> bool, balance: &Balance| {
            let in_contact: Vec<bool> = (0..n * n).map(touched).collect();
            let rows = (0..n * n).filter(|&j| in_contact[j]).map(|j| vec![j]);
            let elimination = Elimination {
                contact_last: order.clone(),
                free: order.clone(),
                rows: rows.step_by(4).collect(),
                in_contact,
            };
            let analysis = elimination.planned(&k, balance).analysis;
            analysis.ordering.contact_begin == n * n
        };
        let held = Balance::new(&k, &[], &[]);
        assert!(!free(&|j| j / n == 100, &held));
        let everywhere = |j: usize| (j % n).is_multiple_of(5) && j / n % 3 == 1;
        assert!(free(&everywhere, &held));
        let floating = Balance::new(&k, &[vec![1.0; n * n]], &vec![true; n * n]);
        assert!(!free(&everywhere, &floating));
    }
}
