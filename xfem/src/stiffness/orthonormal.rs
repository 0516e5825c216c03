//! Orthonormal enriched functions, node by node, where there are branch functions.
//!
//! ```text
//!   A_fg = ∫ ∇φ_f · ∇φ_g over the enriched functions of a node,   A = D L Lᵀ D,   φ' = T φ,   T = (D L)⁻¹
//!   K' = T K Tᵀ,   B' = B Tᵀ,   f' = T f,   u = Tᵀ u'
//! ```
//!
//! Far from the tip the four branch functions of a node, and its piece functions, are nearly the same: the condition of K
//! grows like a high power of radius over cell size (1e12 instead of 1e3). Scaled Cholesky factors of the node blocks bring
//! it back: Béchet, Minnebo, Moës & Burgardt, Int. J. Numer. Meth. Engng 64 (2005) 1033. A function whose part outside the
//! span of those before it is too small to be told from rounding is dropped. Functions keep their numbers; only what the
//! solver sees is transformed. A is divided by that of a standard function, rounded to a power of four: all unknowns of the
//! solver are displacements then, and residuals compare whatever the units.
//!
//! With a ramp the shape functions sum to one over all cells of a straight tip, and the branch functions become exactly
//! dependent: with x, y ahead and across,
//!
//! ```text
//!   y (g₂ − g₃) − x g₄ = 0,     y (g₁ − g₄) + x g₃ = 0
//! ```
//!
//! and Σ N_k x_k = x, Σ N_k y_k = y. Both relations are resolved by leaving out g₃ and g₄ at one node, where r is largest.

use std::collections::{BTreeMap, BTreeSet};

use crate::enrichment::Enrichment;
use crate::enrichment::basis::FunctionKind;
use crate::geometry::tip_frame::FrontShape;
use crate::mesh::Mesh;

use super::elasticity::{CellMatrix, CellView};

/// A function is dropped if the square of its part outside the span of the others is smaller than this part of its own
/// square: K' carries the rounding of K divided by it.
const DROPPED: f64 = 1e-8;

/// The functions of one node.
#[derive(Debug, Clone)]
struct Block {
    /// First of the functions, which follow each other.
    first: usize,
    /// T, lower triangular, row by row; the row of a dropped function is zero.
    t: Vec<f64>,
    count: usize,
    /// Components it acts on: those of which nothing is prescribed.
    free: [bool; 3],
}

impl Block {
    fn t(&self, row: usize, column: usize) -> f64 {
        self.t[row * self.count + column]
    }
}

/// The basis in which the solver works.
#[derive(Debug, Clone, Default)]
pub struct SolverBasis {
    blocks: Vec<Block>,
    /// Block of every function; empty if there are none.
    block_of: Vec<Option<u32>>,
}

impl SolverBasis {
    /// Orthonormalises the nodes of branch functions. `matrix`: stiffness of a cell over its
    /// functions; `held`: whether a component of a function is prescribed, which keeps this component of its node as it is.
    pub fn new<'a>(
        mesh: &Mesh,
        enrichment: &Enrichment,
        users: &[Vec<u32>],
        matrix: impl Fn(usize) -> CellView<'a>,
        held: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let dim = mesh.dim();
        let mut basis = SolverBasis::default();
        let surplus = surplus(mesh, enrichment, &held);
        let mut stiffest = f64::MIN_POSITIVE;
        for node in 0..enrichment.nodes() {
            let own = enrichment.enriched_of(node);
            let kind = |f: usize| enrichment.functions[f].kind;
            let branch = |f: usize| matches!(kind(f), FunctionKind::Branch { .. });
            // Pieces are disjoint: their functions depend on no other.
            let dependent = own.clone().any(branch);
            let free = [0, 1, 2].map(|a| a < dim && !own.clone().any(|f| held(f, a)));
            if !dependent || free == [false; 3] {
                continue;
            }
            if basis.block_of.is_empty() {
                basis.block_of = vec![None; enrichment.functions.len()];
            }
            let standard = gram(enrichment, dim, node..node + 1, users, &matrix);
            stiffest = standard[0].max(stiffest);
            let gram = gram(enrichment, dim, own.clone(), users, &matrix);
            for f in own.clone() {
                basis.block_of[f] = Some(basis.blocks.len() as u32);
            }
            basis.blocks.push(Block {
                first: own.start,
                t: inverse_factor(&gram, own.len(), |i| surplus.contains(&(own.start + i))),
                count: own.len(),
                free,
            });
        }
        // A power of two changes no bit of a scaled matrix.
        let unit = (0.5 * stiffest.log2()).round().exp2();
        let entries = basis.blocks.iter_mut().flat_map(|block| &mut block.t);
        entries.for_each(|t| *t *= unit);
        basis
    }

    /// True if the solver works with the functions themselves.
    pub fn is_identity(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The block that acts on an unknown, and the place of its function there.
    fn block(&self, dim: usize, unknown: usize) -> Option<(&Block, usize)> {
        let (function, a) = (unknown / dim, unknown % dim);
        let number = self.block_of.get(function).copied().flatten()?;
        let block = &self.blocks[number as usize];
        block.free[a].then(|| (block, function - block.first))
    }

    /// True for an unknown that the solver does not see.
    pub fn drops(&self, dim: usize, unknown: usize) -> bool {
        let block = self.block(dim, unknown);
        block.is_some_and(|(block, i)| block.t(i, i) == 0.0)
    }

    /// Changes the values of every block, component by component.
    fn change(&self, dim: usize, v: &mut [f64], change: impl Fn(&Block, &mut [f64])) {
        for block in &self.blocks {
            for a in (0..dim).filter(|&a| block.free[a]) {
                let at = |i: usize| (block.first + i) * dim + a;
                let mut own: Vec<f64> = (0..block.count).map(|i| v[at(i)]).collect();
                change(block, &mut own);
                own.into_iter().enumerate().for_each(|(i, x)| v[at(i)] = x);
            }
        }
    }

    /// f' = T f, in place.
    pub fn force(&self, dim: usize, f: &mut [f64]) {
        self.change(dim, f, |block, f| {
            for i in (0..block.count).rev() {
                f[i] = (0..=i).map(|j| block.t(i, j) * f[j]).sum();
            }
        });
    }

    /// u = Tᵀ u', in place.
    pub fn unknowns(&self, dim: usize, u: &mut [f64]) {
        self.change(dim, u, |block, u| {
            for j in 0..block.count {
                u[j] = (j..block.count).map(|i| block.t(i, j) * u[i]).sum();
            }
        });
    }

    /// The u' of a u, in place; what only dropped functions could carry is lost.
    pub fn solver_unknowns(&self, dim: usize, u: &mut [f64]) {
        self.change(dim, u, |block, u| {
            for j in (0..block.count).rev() {
                let rest: f64 = (j + 1..block.count).map(|i| block.t(i, j) * u[i]).sum();
                let pivot = block.t(j, j);
                u[j] = if pivot == 0.0 {
                    0.0
                } else {
                    (u[j] - rest) / pivot
                };
            }
        });
    }

    /// Column of T: the unknowns of the solver to which one unknown contributes, with the factors.
    pub fn column(&self, dim: usize, unknown: usize) -> Vec<(usize, f64)> {
        match self.block(dim, unknown) {
            None => vec![(unknown, 1.0)],
            Some((block, j)) => {
                let at = |i: usize| (block.first + i) * dim + unknown % dim;
                let rows = (j..block.count).map(|i| (at(i), block.t(i, j)));
                rows.filter(|(_, t)| *t != 0.0).collect()
            }
        }
    }

    /// A sparse row of B over all unknowns, times Tᵀ.
    pub fn row(&self, dim: usize, row: &[(usize, f64)]) -> Vec<(usize, f64)> {
        if self.is_identity() {
            return row.to_vec();
        }
        let mut found: BTreeMap<usize, f64> = BTreeMap::new();
        for &(unknown, value) in row {
            for (i, t) in self.column(dim, unknown) {
                *found.entry(i).or_default() += t * value;
            }
        }
        found.into_iter().filter(|(_, v)| *v != 0.0).collect()
    }

    /// T K Tᵀ of a cell over its functions; `None` if it is K.
    pub fn matrix(&self, dim: usize, functions: &[u32], k: CellView<'_>) -> Option<CellMatrix> {
        let touched = |f: &u32| self.block_of.get(*f as usize).copied().flatten().is_some();
        if !functions.iter().any(touched) {
            return None;
        }
        // (T restricted to the cell's unknowns) one after the other on rows and columns.
        let of_unknown = |(p, &f): (usize, &u32)| {
            (0..dim).map(move |a| match self.block(dim, f as usize * dim + a) {
                None => vec![(p * dim + a, 1.0)],
                Some((block, i)) => {
                    let place = |f: usize| functions.iter().position(|&g| g as usize == f);
                    let entry = |j: usize| Some((place(block.first + j)? * dim + a, block.t(i, j)));
                    (0..=i).filter_map(entry).collect()
                }
            })
        };
        let parts: Vec<Vec<(usize, f64)>> =
            functions.iter().enumerate().flat_map(of_unknown).collect();
        let n = functions.len() * dim;
        let mut half = CellMatrix::zero(n);
        for (p, part) in parts.iter().enumerate() {
            for &(q, t) in part {
                for column in 0..n {
                    half.add(p, column, t * k.get(q, column));
                }
            }
        }
        let mut found = CellMatrix::zero(n);
        for (p, part) in parts.iter().enumerate() {
            for &(q, t) in part {
                for row in 0..n {
                    found.add(row, p, t * half.get(row, q));
                }
            }
        }
        Some(found)
    }
}

/// The functions that the relations between branch functions make superfluous: two per straight ramped tip.
fn surplus(
    mesh: &Mesh,
    enrichment: &Enrichment,
    held: impl Fn(usize, usize) -> bool,
) -> BTreeSet<usize> {
    let dim = mesh.dim();
    let any = |f: usize| (0..dim).any(|a| held(f, a));
    let mut found = BTreeSet::new();
    let mut of_tips = vec![Vec::new(); enrichment.tips.len()];
    for (f, function) in enrichment.functions.iter().enumerate() {
        if let FunctionKind::Branch { tip, .. } = function.kind {
            of_tips[tip as usize].push(f);
        }
    }
    for (number, (tip, functions)) in enrichment.tips.iter().zip(of_tips).enumerate() {
        // A prescribed component breaks the relations of that component alone.
        let broken = (0..dim).all(|a| functions.iter().any(|&f| held(f, a)));
        if tip.shape != FrontShape::Straight || !enrichment.is_ramped(number) || broken {
            continue;
        }
        let node_of = |f: usize| enrichment.functions[f].node;
        let r = |f: usize| tip.distance(&mesh.nodes[node_of(f) as usize]);
        let own = functions.iter().copied();
        let free = |f: usize| !enrichment.enriched_of(node_of(f) as usize).any(any);
        let core = own.filter(|&f| enrichment.in_core(number, node_of(f)) && free(f));
        let farthest = core.max_by(|&f, &g| r(f).total_cmp(&r(g)).then(g.cmp(&f)));
        let node = farthest.map(node_of);
        found.extend(functions.into_iter().filter(|&f| {
            let function = enrichment.functions[f];
            let last = matches!(function.kind, FunctionKind::Branch { order: 2..=3, .. });
            last && Some(function.node) == node
        }));
    }
    found
}

/// (λ + (d + 1) μ) ∫ ∇φ_f · ∇φ_g, the trace over components of the stiffness block of f and g.
fn gram<'a>(
    enrichment: &Enrichment,
    dim: usize,
    own: std::ops::Range<usize>,
    users: &[Vec<u32>],
    matrix: &impl Fn(usize) -> CellView<'a>,
) -> Vec<f64> {
    let count = own.len();
    let mut gram = vec![0.0; count * count];
    let cells: BTreeSet<u32> = own.clone().flat_map(|f| users[f].iter().copied()).collect();
    for cell in cells.into_iter().map(|c| c as usize) {
        let functions = enrichment.cell(cell);
        let place = |f: usize| functions.iter().position(|&g| g as usize == f);
        let k = matrix(cell);
        for (i, f) in own.clone().enumerate() {
            for (j, g) in own.clone().enumerate() {
                if let (Some(p), Some(q)) = (place(f), place(g)) {
                    let diagonal = (0..dim).map(|a| k.get(p * dim + a, q * dim + a));
                    gram[i * count + j] += diagonal.sum::<f64>();
                }
            }
        }
    }
    gram
}

/// T = (D L)⁻¹ of a Gram matrix, with zero rows for the superfluous functions and those in the span of others before them.
fn inverse_factor(gram: &[f64], n: usize, surplus: impl Fn(usize) -> bool) -> Vec<f64> {
    let scale: Vec<f64> = (0..n).map(|i| gram[i * n + i].sqrt()).collect();
    let mut t = vec![0.0; n * n];
    for i in 0..n {
        if scale[i] == 0.0 || surplus(i) {
            continue;
        }
        // Gram–Schmidt against the functions kept so far, twice for orthogonality.
        let mut row = vec![0.0; n];
        row[i] = 1.0 / scale[i];
        for _ in 0..2 {
            for j in 0..i {
                // ⟨φ'_j, φ⟩ = Σ t_jk A_kl row_l
                let mut product = 0.0;
                for k in 0..=j {
                    if t[j * n + k] != 0.0 {
                        product +=
                            t[j * n + k] * (0..=i).map(|l| gram[k * n + l] * row[l]).sum::<f64>();
                    }
                }
                for k in 0..=j {
                    row[k] -= product * t[j * n + k];
                }
            }
        }
        let mut square = 0.0;
        for k in 0..=i {
            square += row[k] * (0..=i).map(|l| gram[k * n + l] * row[l]).sum::<f64>();
        }
        if square > DROPPED {
            let length = square.sqrt();
            for k in 0..=i {
                t[i * n + k] = row[k] / length;
            }
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_orthonormalises_and_drops_what_is_in_the_span() {
        // Rows of V are functions, the third nearly the sum of the first two, the fourth exactly.
        let v = [
            [1.0, 2.0, 0.5, 0.0],
            [3.0, -1.0, 2.0, 1e3],
            [4.0, 1.0, 2.5 + 1e-3, 1e3],
            [4.0, 1.0, 2.5, 1e3],
        ];
        let n = 4;
        let dot = |a: &[f64; 4], b: &[f64; 4]| (0..4).map(|k| a[k] * b[k]).sum::<f64>();
        let gram: Vec<f64> = (0..16).map(|k| dot(&v[k / n], &v[k % n])).collect();
        let t = inverse_factor(&gram, n, |_| false);
        let product = |i: usize, j: usize| {
            let mut sum = 0.0;
            for k in 0..n {
                for l in 0..n {
                    sum += t[i * n + k] * gram[k * n + l] * t[j * n + l];
                }
            }
            sum
        };
        assert!(t[3 * n..].iter().all(|&x| x == 0.0));
        assert!(t[2 * n..3 * n].iter().all(|&x| x == 0.0));
        assert!((product(0, 0) - 1.0).abs() < 1e-12 && (product(1, 1) - 1.0).abs() < 1e-12);
        assert!(product(0, 1).abs() < 1e-12);
    }
}
