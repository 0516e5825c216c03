//! Functions of several nodes that depend on each other, from their Gram matrix.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{DMatrix, DVectorViewMut};

use crate::enrichment::Enrichment;
use crate::stiffness::elasticity::CellView;
use crate::stiffness::inverse_iteration::smallest_eigenvalue;

/// A function is dropped if the square of its part outside the span of those before it, of other nodes, is smaller than this part of
/// its own: the rules of cells hold what ties them to 1e-8.
const TIED: f64 = 1e-6;

/// A combination of functions of unit length with less than this square vanishes: the pivots before it do not tell.
const VANISHING: f64 = 1e-8;

/// Piece functions with less than this part of the energy of their node's standard function live on slivers. On one around a
/// point, a junction next to a grid line say, those of all nodes of a cell are alike …
const SLIVER: f64 = 1e-6;

/// … and dropped, whatever is held of their nodes, if the square of what is their own is smaller than this part of it.
const ALIKE: f64 = 1e-10;

/// Piece functions that live on less than this part of their cells' edges are rounding.
const VOID: f64 = 1e-11;

/// Piece functions with less than this part may live on a prism of a solid, thinner than 3e-9 of a cell, which turns about its own
/// axis for the square of that …
const PRISM: f64 = 1e-17;

/// … and those around a node are dropped if the square of what is one's own is smaller than this part of it.
const TURNING: f64 = 1e-13;

/// (λ + (d + 1) μ) ∫ ∇φ_f · ∇φ_g, the trace over components of the stiffness block of f and g.
pub(super) fn gram<'a>(
    enrichment: &Enrichment,
    dim: usize,
    own: &[usize],
    users: &[Vec<u32>],
    matrix: &impl Fn(usize) -> CellView<'a>,
) -> Vec<f64> {
    assembled(enrichment, own, 1, users, |cell| {
        let k = matrix(cell);
        move |p, q| (0..dim).map(|a| k[(p * dim + a, q * dim + a)]).sum::<f64>()
    })
}

/// A matrix over some functions with `width` unknowns each; `entries`: of a cell, by places in it.
fn assembled<E: Fn(usize, usize) -> f64>(
    enrichment: &Enrichment,
    own: &[usize],
    width: usize,
    users: &[Vec<u32>],
    entries: impl Fn(usize) -> E,
) -> Vec<f64> {
    let count = own.len() * width;
    let mut sum = vec![0.0; count * count];
    let cells: BTreeSet<u32> = own.iter().flat_map(|&f| users[f].iter().copied()).collect();
    let number: BTreeMap<usize, usize> = own.iter().copied().zip(0..).collect();
    for cell in cells.into_iter().map(|c| c as usize) {
        let functions = enrichment.cell(cell).iter().enumerate();
        let places: Vec<(usize, usize)> = functions
            .filter_map(|(p, &f)| Some((*number.get(&(f as usize))?, p)))
            .flat_map(|(i, p)| (0..width).map(move |a| (i * width + a, p * width + a)))
            .collect();
        let entry = entries(cell);
        for &(i, p) in &places {
            for &(j, q) in &places {
                sum[i * count + j] += entry(p, q);
            }
        }
    }
    sum
}

/// Functions that are in the span of those before them but for a part of their square; the Gram matrix is eliminated in place.
fn tied(gram: &mut [f64], least: f64) -> Vec<usize> {
    let n = gram.len().isqrt();
    let squares: Vec<f64> = (0..n).map(|i| gram[i * n + i]).collect();
    let mut found = Vec::new();
    for k in 0..n {
        let pivot = gram[k * n + k];
        if pivot <= least * squares[k] {
            found.push(k);
            continue;
        }
        for i in k + 1..n {
            let factor = gram[i * n + k] / pivot;
            if factor != 0.0 {
                (k + 1..n).for_each(|j| gram[i * n + j] -= factor * gram[k * n + j]);
            }
        }
    }
    found
}

/// Functions that may go until none left is in the span of those before it, and none of their combinations of unit length
/// nearly vanishes: of each the one with the largest part.
pub(super) fn dependent(gram: &[f64], may_go: impl Fn(usize) -> bool) -> Vec<usize> {
    let n = gram.len().isqrt();
    let mut found = tied(&mut gram.to_vec(), TIED);
    let mut kept: Vec<usize> = (0..n).filter(|k| !found.contains(k)).collect();
    found.retain(|&k| may_go(k));
    loop {
        let scale = |k: usize| gram[k * n + k].sqrt();
        let entry = |i: usize, j: usize| {
            // A little more than rounding may take from the smallest eigenvalue.
            let shift = if i == j { 0.1 * VANISHING } else { 0.0 };
            let (i, j) = (kept[i], kept[j]);
            shift + gram[i * n + j] / (scale(i) * scale(j))
        };
        let Some(factor) = DMatrix::from_fn(kept.len(), kept.len(), entry).cholesky() else {
            return found;
        };
        let solve = |x: &mut [f64]| {
            let count = x.len();
            factor.solve_mut(&mut DVectorViewMut::from_slice(x, count));
        };
        let (smallest, x) = smallest_eigenvalue(kept.len(), solve);
        let candidates = (0..kept.len()).filter(|&i| may_go(kept[i]));
        match candidates.max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs())) {
            Some(i) if smallest < VANISHING => found.push(kept.remove(i)),
            _ => return found,
        }
    }
}

/// Piece functions on slivers that are alike in some cell, or turn with a prism of them.
pub(super) fn alike<'a>(
    dim: usize,
    enrichment: &Enrichment,
    users: &[Vec<u32>],
    matrix: &(impl Fn(usize) -> CellView<'a> + Sync),
    held: impl Fn(usize, usize) -> bool,
) -> BTreeSet<usize> {
    let square = |f: usize| gram(enrichment, dim, &[f], users, matrix)[0];
    let mut slivers: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut found = BTreeSet::new();
    let mut thin = BTreeSet::new();
    for node in 0..enrichment.nodes() {
        let pieces: Vec<usize> = enrichment.pieces_of(node).collect();
        if pieces.is_empty() {
            continue;
        }
        let standard = square(node);
        for f in pieces {
            let part = square(f) / standard;
            if part <= VOID.powi(dim as i32) {
                found.insert(f);
            }
            if dim == 3 && part <= PRISM {
                thin.insert(f);
            }
            if part > SLIVER {
                continue;
            }
            users[f]
                .iter()
                .for_each(|&cell| slivers.entry(cell).or_default().push(f));
        }
    }
    for own in slivers.values().filter(|own| own.len() > 1) {
        let mut gram = gram(enrichment, dim, own, users, matrix);
        found.extend(tied(&mut gram, ALIKE).into_iter().map(|k| own[k]));
    }
    for &f in &thin {
        let around = users[f].iter().flat_map(|cell| &slivers[cell]);
        let around = around.filter(|g| thin.contains(g) && !found.contains(g));
        let own: BTreeSet<usize> = around.copied().collect();
        let own: Vec<usize> = own.into_iter().collect();
        let n = own.len() * dim;
        let mut block = assembled(enrichment, &own, dim, users, |cell| {
            let k = matrix(cell);
            move |p, q| k[(p, q)]
        });
        for i in (0..n).filter(|&i| held(own[i / dim], i % dim)) {
            for j in 0..n {
                (block[i * n + j], block[j * n + i]) = (0.0, 0.0);
            }
            block[i * n + i] = 1.0;
        }
        if !tied(&mut block, TURNING).is_empty() {
            found.extend(own);
        }
    }
    found
}
