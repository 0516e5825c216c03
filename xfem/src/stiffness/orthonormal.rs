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

mod ties;

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::enrichment::Enrichment;
use crate::enrichment::basis::FunctionKind;
use crate::geometry::tip_frame::FrontShape;
use crate::mesh::Mesh;

use super::elasticity::{CellMatrix, CellView};
use ties::{alike, dependent, gram};

/// A function is dropped if the square of its part outside the span of the others is smaller than this part of its own
/// square: K' carries the rounding of K divided by it.
const DROPPED: f64 = 1e-8;

/// Nodes of a zone with a ramp in which other tips have functions, too, that is searched for ties: larger ones reach far beyond the
/// cells of a tip.
const SMALL: usize = 160;

/// The functions of one node.
#[derive(Debug, Clone)]
struct Block {
    /// First of the functions, which follow each other.
    first: usize,
    count: usize,
    /// T for every set of prescribed functions, the smallest first; lower triangular, row by row. The row of a dropped function
    /// is zero, that of a prescribed one the identity.
    forms: Vec<Vec<f64>>,
    /// Form of every component.
    form: [usize; 3],
}

impl Block {
    /// Of the functions of a node. `left_out`: whether one is not to be used, where nothing is prescribed or anyhow.
    fn new(
        dim: usize,
        own: &[usize],
        gram: &[f64],
        unit: f64,
        held: impl Fn(usize, usize) -> bool,
        left_out: impl Fn(usize, bool) -> bool,
    ) -> Self {
        let count = own.len();
        let of = |a: usize| own.iter().map(|&f| held(f, a)).collect::<Vec<bool>>();
        let mut sets: Vec<Vec<bool>> = (0..dim).map(of).collect();
        sets.sort_by_key(|set| set.iter().filter(|held| **held).count());
        sets.dedup();
        let form = |set: &Vec<bool>| {
            // Prescribed values break the relations of what is left.
            let whole = !set.contains(&true);
            let mut t = inverse_factor(gram, count, |i| set[i] || left_out(own[i], whole));
            t.iter_mut().for_each(|t| *t *= unit);
            let kept = (0..count).filter(|&i| set[i]);
            kept.for_each(|i| t[i * count + i] = 1.0);
            t
        };
        let place = |a: usize| sets.iter().position(|set| a < dim && *set == of(a));
        Block {
            first: own[0],
            count,
            forms: sets.iter().map(form).collect(),
            form: [0, 1, 2].map(|a| place(a).unwrap_or(0)),
        }
    }

    fn t(&self, component: usize, row: usize, column: usize) -> f64 {
        self.forms[self.form[component]][row * self.count + column]
    }
}

/// The basis in which the solver works.
#[derive(Debug, Clone, Default)]
pub struct SolverBasis {
    blocks: Vec<Block>,
    /// Block of every function; empty if there are none.
    block_of: Vec<Option<u32>>,
    /// Functions that are dropped for others of their cell.
    alike: BTreeSet<usize>,
}

impl SolverBasis {
    /// Orthonormalises the nodes of branch functions. `matrix`: stiffness of a cell over its functions; `held`: whether a component
    /// of a function is prescribed, which keeps this component as it is.
    pub fn new<'a>(
        mesh: &Mesh,
        enrichment: &Enrichment,
        users: &[Vec<u32>],
        matrix: impl Fn(usize) -> CellView<'a> + Sync,
        held: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let dim = mesh.dim();
        let mut basis = SolverBasis {
            alike: alike(dim, enrichment, users, &matrix, &held),
            ..SolverBasis::default()
        };
        let surplus = surplus(dim, enrichment, &held);
        // Pieces are disjoint: of a node without branch functions they depend on no other.
        let free = |f: usize| (0..dim).any(|a| !held(f, a));
        let acts = |node: &usize| {
            let mut own = enrichment.enriched_of(*node);
            own.clone().any(|f| enrichment.is_branch(f)) && own.any(free)
        };
        let nodes: Vec<usize> = (0..enrichment.nodes()).filter(acts).collect();
        let standard = |&node: &usize| gram(enrichment, dim, &[node], users, &matrix)[0];
        let stiffest = nodes
            .par_iter()
            .map(standard)
            .reduce(|| f64::MIN_POSITIVE, f64::max);
        // A power of two changes no bit of a scaled matrix.
        let unit = (0.5 * stiffest.log2()).round().exp2();
        let own = |node: usize| enrichment.enriched_of(node).collect::<Vec<usize>>();
        let own = nodes.into_par_iter().map(own);
        let grams = own.map(|all| (gram(enrichment, dim, &all, users, &matrix), all));
        for (gram, all) in grams.collect::<Vec<_>>() {
            if basis.block_of.is_empty() {
                basis.block_of = vec![None; enrichment.functions.len()];
            }
            for &f in &all {
                basis.block_of[f] = Some(basis.blocks.len() as u32);
            }
            let left_out =
                |f: usize, whole: bool| basis.alike.contains(&f) || whole && surplus.contains(&f);
            let block = Block::new(dim, &all, &gram, unit, &held, left_out);
            basis.blocks.push(block);
        }
        basis.search_zones(mesh, enrichment, users, &matrix);
        basis
    }

    /// Looks for ties where there may be any: in zones without ramp or cut by other cracks, and in those of short cracks, which overlap.
    fn search_zones<'a>(
        &mut self,
        mesh: &Mesh,
        enrichment: &Enrichment,
        users: &[Vec<u32>],
        matrix: &impl Fn(usize) -> CellView<'a>,
    ) {
        // The arms of a corner share their nodes.
        let mut seen = BTreeSet::new();
        let zones = (enrichment.tips.iter().zip(&enrichment.zones))
            .filter(|(_, zone)| seen.insert(&zone.nodes));
        let zones: Vec<_> = zones.collect();
        let mut zones_of = BTreeMap::<u32, usize>::new();
        let nodes = zones.iter().flat_map(|(_, zone)| &zone.nodes);
        nodes.for_each(|&node| *zones_of.entry(node).or_default() += 1);
        for (tip, zone) in zones {
            let nodes = &zone.nodes;
            let mixed = || nodes.iter().any(|node| zones_of[node] > 1);
            // Seen from some cells away a short crack is a point.
            let pair = matches!(tip.shape, FrontShape::Pair { .. });
            let cut = zone.radius == 0.0 || !zone.cut_off.is_empty();
            if cut || nodes.len() <= SMALL && (pair || mixed()) {
                // Which of equals goes must not depend on how the body is turned.
                let lengths = &enrichment.lengths;
                let key = |&node: &u32| {
                    let x = &mesh.nodes[node as usize];
                    [lengths.apart(x, &tip.position), lengths.from_middle(x)]
                };
                let mut nodes: Vec<u32> = nodes.iter().copied().collect();
                nodes.sort_by_cached_key(key);
                self.drop_tied(mesh.dim(), enrichment, &nodes, users, matrix);
            }
        }
    }

    /// Drops branch functions at the nodes of a tip or corner that are in the span of all functions there: on the little that cracks
    /// leave of a zone without ramp, and far from a short crack, those of different nodes depend on each other.
    fn drop_tied<'a>(
        &mut self,
        dim: usize,
        enrichment: &Enrichment,
        nodes: &[u32],
        users: &[Vec<u32>],
        matrix: &impl Fn(usize) -> CellView<'a>,
    ) {
        let is_branch = |f: usize| enrichment.is_branch(f);
        let nodes = nodes.iter().map(|&node| node as usize);
        let enriched = nodes.clone().flat_map(|node| enrichment.enriched_of(node));
        let mut own: Vec<usize> = nodes.chain(enriched).collect();
        own.sort_by_key(|&f| is_branch(f));
        let mut gram = gram(enrichment, dim, &own, users, matrix);
        let n = own.len();
        // T G Tᵀ, one after the other on columns and rows.
        let place: BTreeMap<usize, usize> = own.iter().copied().zip(0..).collect();
        let blocks: BTreeSet<u32> = own.iter().filter_map(|&f| *self.block_of.get(f)?).collect();
        for turn in 0..2 {
            for block in blocks.iter().map(|&b| &self.blocks[b as usize]) {
                let at: Vec<usize> = (0..block.count)
                    .map(|i| place[&(block.first + i)])
                    .collect();
                for line in 0..n {
                    let index = |i: usize| {
                        if turn == 0 {
                            line * n + at[i]
                        } else {
                            at[i] * n + line
                        }
                    };
                    for i in (0..block.count).rev() {
                        let sum = (0..=i)
                            .map(|j| block.forms[0][i * block.count + j] * gram[index(j)])
                            .sum();
                        gram[index(i)] = sum;
                    }
                }
            }
        }
        for k in dependent(&gram, |k| is_branch(own[k])) {
            if let Some(Some(block)) = self.block_of.get(own[k]) {
                let block = &mut self.blocks[*block as usize];
                let row = own[k] - block.first;
                let entries = row * block.count..(row + 1) * block.count;
                for t in &mut block.forms {
                    t[entries.clone()].fill(0.0);
                }
            }
        }
    }

    /// True if the solver works with the functions themselves.
    pub fn is_identity(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The block that acts on a function, and its place there.
    fn block(&self, function: usize) -> Option<(&Block, usize)> {
        let number = self.block_of.get(function).copied().flatten()?;
        let block = &self.blocks[number as usize];
        Some((block, function - block.first))
    }

    /// True for an unknown that the solver does not see.
    pub fn drops(&self, dim: usize, unknown: usize) -> bool {
        let (function, a) = (unknown / dim, unknown % dim);
        let block = self.block(function);
        self.alike.contains(&function) || block.is_some_and(|(block, i)| block.t(a, i, i) == 0.0)
    }

    /// Changes the values of every block, component by component.
    fn change(&self, dim: usize, v: &mut [f64], change: impl Fn(&Block, usize, &mut [f64])) {
        for block in &self.blocks {
            for a in 0..dim {
                let at = |i: usize| (block.first + i) * dim + a;
                let mut own: Vec<f64> = (0..block.count).map(|i| v[at(i)]).collect();
                change(block, a, &mut own);
                own.into_iter().enumerate().for_each(|(i, x)| v[at(i)] = x);
            }
        }
    }

    /// f' = T f, in place.
    pub fn force(&self, dim: usize, f: &mut [f64]) {
        self.change(dim, f, |block, a, f| {
            for i in (0..block.count).rev() {
                f[i] = (0..=i).map(|j| block.t(a, i, j) * f[j]).sum();
            }
        });
    }

    /// u = Tᵀ u', in place.
    pub fn unknowns(&self, dim: usize, u: &mut [f64]) {
        self.change(dim, u, |block, a, u| {
            for j in 0..block.count {
                u[j] = (j..block.count).map(|i| block.t(a, i, j) * u[i]).sum();
            }
        });
    }

    /// The u' of a u, in place; what only dropped functions could carry is lost.
    pub fn solver_unknowns(&self, dim: usize, u: &mut [f64]) {
        self.change(dim, u, |block, a, u| {
            for j in (0..block.count).rev() {
                let rest: f64 = (j + 1..block.count).map(|i| block.t(a, i, j) * u[i]).sum();
                let pivot = block.t(a, j, j);
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
        let (function, a) = (unknown / dim, unknown % dim);
        match self.block(function) {
            None => vec![(unknown, 1.0)],
            Some((block, j)) => {
                let at = |i: usize| (block.first + i) * dim + a;
                let rows = (j..block.count).map(|i| (at(i), block.t(a, i, j)));
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
            (0..dim).map(move |a| match self.block(f as usize) {
                None => vec![(p * dim + a, 1.0)],
                Some((block, i)) => {
                    let place = |f: usize| functions.iter().position(|&g| g as usize == f);
                    let entry =
                        |j: usize| Some((place(block.first + j)? * dim + a, block.t(a, i, j)));
                    (0..=i).filter_map(entry).collect()
                }
            })
        };
        let parts: Vec<Vec<(usize, f64)>> =
            functions.iter().enumerate().flat_map(of_unknown).collect();
        let n = functions.len() * dim;
        // K Tᵀ of any matrix K.
        let on_columns = |k: CellView<'_>| {
            let mut found = CellMatrix::zeros(n, n);
            for (p, part) in parts.iter().enumerate() {
                for &(q, t) in part {
                    found.column_mut(p).axpy(t, &k.column(q), 1.0);
                }
            }
            found
        };
        let half = on_columns(k).transpose();
        Some(on_columns(half.as_view()).transpose())
    }
}

/// g₃ and g₄ where the ramps of tips make them superfluous.
fn surplus(
    dim: usize,
    enrichment: &Enrichment,
    held: impl Fn(usize, usize) -> bool,
) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let mut of_tips = vec![Vec::new(); enrichment.tips.len()];
    for (f, function) in enrichment.functions.iter().enumerate() {
        if let FunctionKind::Branch { tip, order } = function.kind {
            of_tips[tip as usize].push((f, function.node, order));
        }
    }
    for (zone, functions) in enrichment.zones.iter().zip(of_tips) {
        // A prescribed component breaks the relations of that component alone.
        let broken = (0..dim).all(|a| functions.iter().any(|&(f, ..)| held(f, a)));
        let gone = functions
            .into_iter()
            .filter(|(_, node, order)| !broken && *order >= 2 && zone.surplus.contains(node));
        found.extend(gone.map(|own| own.0));
    }
    found
}

/// T = (D L)⁻¹ of a Gram matrix, with zero rows for functions left out and those in the span of others before them.
fn inverse_factor(gram: &[f64], n: usize, left_out: impl Fn(usize) -> bool) -> Vec<f64> {
    let scale: Vec<f64> = (0..n).map(|i| gram[i * n + i].sqrt()).collect();
    let mut t = vec![0.0; n * n];
    for i in 0..n {
        if scale[i] == 0.0 || left_out(i) {
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
