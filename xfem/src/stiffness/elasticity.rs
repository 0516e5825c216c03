//! Isotropic linear elasticity through gradient Gram matrices.
//!
//! For scalar functions φ_k with vector unknowns, the stiffness needs only the Gram matrix of their gradients:
//!
//! ```text
//!   σ = λ tr ε I + 2 μ ε                     G[(k,a),(l,b)] = ∫ ∂_a φ_k ∂_b φ_l
//!   K[(k,a),(l,b)] = λ G[(k,a),(l,b)] + μ G[(k,b),(l,a)] + μ δ_ab Σ_c G[(k,c),(l,c)]
//! ```
//!
//! With the mean dilatation ∫ ∂_a φ_k ∫ ∂_b φ_l / V takes the place of G behind λ, see [`dilatation`](super::dilatation).
//!
//! So quadrature accumulates rank-one updates w g gᵀ, and the material enters once per cell. Standard, Heaviside and
//! branch functions are all scalar functions here.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::{DMatrix, DMatrixView};

use crate::geometry::{Point, Points};
use crate::material::{Dilatation, Lame};
use crate::mesh::cell::CellMap;

use super::assumed_stress::{AssumedStress, ShapePoint};
use super::cell_matrix::{CellError, whole_cell};
use super::lanes::LANES;

/// Measure of a region, and ∫ of the gradients of all functions over it.
#[derive(Debug, Clone, Default)]
pub struct Moments {
    /// Sum of the weights [m^dim].
    pub measure: f64,
    /// By function.
    pub gradients: Vec<Point>,
}

/// Gram matrix of gradients, dense symmetric, rows (k, a) with a fastest.
///
/// Points are gathered and added as one product of matrices: a cell at a crack front has 4·10⁴ points and 120 rows.
#[derive(Debug, Clone)]
pub struct Gram {
    size: usize,
    dim: usize,
    /// Lower triangle, column by column; what is above the diagonal means nothing.
    values: Vec<f64>,
    /// Gradients of the gathered points, row by row.
    gathered: Vec<f64>,
    /// The same times their weights.
    weighted: Vec<f64>,
    /// How many are gathered.
    count: usize,
    /// ∫ g of what is in `values`.
    integral: Vec<f64>,
    /// Sum of the weights.
    measure: f64,
}

impl Gram {
    /// Points of one product: enough for it to pay, few enough for the cache.
    const GATHER: usize = 128;

    /// From row to row of the gathered points: a power of two would crowd them in the cache.
    const STRIDE: usize = Self::GATHER + 8;

    /// Zero matrix for a number of scalar functions.
    pub fn zero(functions: usize, dim: usize) -> Self {
        let size = functions * dim;
        Gram {
            size,
            dim,
            values: vec![0.0; size * size],
            gathered: vec![0.0; size * Self::STRIDE],
            weighted: vec![0.0; size * Self::STRIDE],
            count: 0,
            integral: vec![0.0; size],
            measure: 0.0,
        }
    }

    /// G += w g gᵀ; `g`: the gradients of all functions.
    pub fn add(&mut self, weight: f64, g: &[Point]) {
        for (k, gradient) in g.iter().enumerate() {
            self.put(k, &[weight], &gradient.map(|v| [v]));
        }
        self.end(&[weight]);
    }

    /// Gradients of the k-th function at the next L <= [`LANES`] points; [`Gram::end`] adds the points, when all are put.
    #[inline(always)]
    pub fn put<const L: usize>(&mut self, k: usize, weights: &[f64; L], g: &Points<L>) {
        for (a, g) in g.iter().enumerate().take(self.dim) {
            let start = (k * self.dim + a) * Self::STRIDE + self.count;
            self.gathered[start..][..L].copy_from_slice(g);
            for (slot, (g, w)) in self.weighted[start..][..L]
                .iter_mut()
                .zip(g.iter().zip(weights))
            {
                *slot = g * w;
            }
        }
    }

    /// Adds the points whose gradients are put.
    #[inline(always)]
    pub fn end<const L: usize>(&mut self, weights: &[f64; L]) {
        self.measure += weights.iter().sum::<f64>();
        self.count += L;
        if self.count + LANES > Self::GATHER {
            self.gather();
        }
    }

    /// Takes ∫ g and the measure of what was added since the last time.
    pub fn take_moments(&mut self) -> Moments {
        self.gather();
        let moments = Moments {
            measure: self.measure,
            gradients: (self.integral.chunks_exact(self.dim))
                .map(|g| [0, 1, 2].map(|a| g.get(a).copied().unwrap_or(0.0)))
                .collect(),
        };
        self.integral.fill(0.0);
        self.measure = 0.0;
        moments
    }

    /// Gives moments back with g + c, c by function, in the place of g: G += s cᵀ + c sᵀ + V c cᵀ, s = ∫ g.
    pub fn return_moments(&mut self, moments: &Moments, c: &[Point]) {
        let flat = |g: &[Point]| -> Vec<f64> {
            g.iter()
                .flat_map(|g| g[..self.dim].iter().copied())
                .collect()
        };
        let (s, c, measure) = (flat(&moments.gradients), flat(c), moments.measure);
        for (j, column) in self.values.chunks_exact_mut(self.size).enumerate() {
            let half = s[j] + measure * c[j];
            for i in j..self.size {
                column[i] += s[i] * c[j] + c[i] * half;
            }
        }
        for (sum, (s, c)) in self.integral.iter_mut().zip(s.iter().zip(&c)) {
            *sum += s + measure * c;
        }
        self.measure += measure;
    }

    /// Adds the gathered points.
    fn gather(&mut self) {
        let count = std::mem::take(&mut self.count);
        if count == 0 {
            return;
        }
        let rows = |values| {
            let rows = MatRef::from_row_major_slice(values, self.size, Self::STRIDE);
            rows.subcols(0, count)
        };
        matmul(
            MatMut::from_column_major_slice_mut(&mut self.values, self.size, self.size),
            BlockStructure::TriangularLower,
            Accum::Add,
            rows(&self.gathered),
            BlockStructure::Rectangular,
            rows(&self.weighted).transpose(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        let rows = self.weighted.chunks_exact(Self::STRIDE);
        for (sum, row) in self.integral.iter_mut().zip(rows) {
            *sum += total(&row[..count]);
        }
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        self.values[j * self.size + i]
    }

    /// ∫ g_i ∫ g_j / V, the product of the means; nothing over nothing.
    fn mean(&self, i: usize, j: usize) -> f64 {
        if self.measure > 0.0 {
            self.integral[i] * self.integral[j] / self.measure
        } else {
            0.0
        }
    }

    /// Stiffness matrix of the functions, symmetric, full storage [N/m].
    pub fn stiffness(self, lame: Lame) -> CellMatrix {
        match lame.dilatation {
            Dilatation::Full => self.stiffness_over(lame, Self::at),
            Dilatation::Mean => self.stiffness_over(lame, Self::mean),
        }
    }

    /// The same with Σ_m s_mi s_mj behind λ; `modes`: the s_m, by function and component.
    pub fn projected_stiffness(self, lame: Lame, modes: &[Vec<f64>]) -> CellMatrix {
        self.stiffness_over(lame, |_, i, j| modes.iter().map(|s| s[i] * s[j]).sum())
    }

    /// The same with `dilatation` behind λ.
    fn stiffness_over(
        mut self,
        lame: Lame,
        dilatation: impl Fn(&Self, usize, usize) -> f64,
    ) -> CellMatrix {
        self.gather();
        let Lame { lambda, mu, .. } = lame;
        let dim = self.dim;
        let mut k = DMatrix::zeros(self.size, self.size);
        for i in 0..self.size / dim {
            for j in 0..=i {
                let laplace: f64 = (0..dim).map(|c| self.at(i * dim + c, j * dim + c)).sum();
                for a in 0..dim {
                    for b in 0..dim {
                        let direct = dilatation(&self, i * dim + a, j * dim + b);
                        let swapped = self.at(i * dim + b, j * dim + a);
                        let same = if a == b { mu * laplace } else { 0.0 };
                        let value = lambda * direct + mu * swapped + same;
                        k[(i * dim + a, j * dim + b)] = value;
                        k[(j * dim + b, i * dim + a)] = value;
                    }
                }
            }
        }
        k
    }
}

/// Sum of numbers, several side by side.
fn total(values: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let chunks = values.chunks_exact(LANES);
    let rest = chunks.remainder();
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(s, v)| *s += v);
    }
    sums.iter().chain(rest).sum()
}

/// Dense symmetric matrix of one cell [N/m].
pub type CellMatrix = DMatrix<f64>;

/// A cell matrix that lies elsewhere.
pub type CellView<'a> = DMatrixView<'a, f64>;

/// Stiffness of an uncut cell: 2 Gauss points per direction, exact on affine cells.
///
/// # Errors
/// A cell without extent.
pub fn cell_stiffness(map: &CellMap, lame: Lame) -> Result<CellMatrix, CellError> {
    let points = whole_cell(map, 2, |_| 0).into_iter();
    let points: Vec<ShapePoint> = points.map(|at| (at, map.gradients(&at.xi).0)).collect();
    if lame.assumed {
        return Ok(AssumedStress::new(map, lame, &points)?.stiffness());
    }
    Ok(gradient_stiffness(map, lame, &points))
}

/// Stiffness of the shape functions in a region, with the stress of the gradient.
pub fn gradient_stiffness(map: &CellMap, lame: Lame, points: &[ShapePoint]) -> CellMatrix {
    let mut gram = Gram::zero(map.len(), map.kind.dim());
    points.iter().for_each(|(at, g)| gram.add(at.weight, g));
    gram.stiffness(lame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Material, Model};
    use crate::mesh::cell::CellKind;

    const STEEL: Material = Material::new(210e9, 0.3);

    /// K of a unit square, plane stress, against the printed closed form (Cook et al., Concepts and Applications of
    /// Finite Element Analysis, bilinear square): K_11 = E (3 − ν) / (6 (1 − ν²)) ... (thickness 1, side independent).
    #[test]
    fn square_plane_stress_matches_the_closed_form() {
        let corners = [[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        let map = CellMap::new(CellKind::Quad4, |i| corners[i]);
        let lame = Lame {
            assumed: false,
            ..Lame::new(STEEL, Model::PlaneStress)
        };
        let k = cell_stiffness(&map, lame).unwrap();
        let (e, nu) = (STEEL.young, STEEL.poisson);
        let c = e / (1.0 - nu * nu);
        for (j, exact) in [
            (0, (3.0 - nu) / 6.0),
            (1, (1.0 + nu) / 8.0),
            (2, -(3.0 + nu) / 12.0),
            (3, (3.0 * nu - 1.0) / 8.0),
            (4, (nu - 3.0) / 12.0),
            (5, -(1.0 + nu) / 8.0),
            (6, nu / 6.0),
            (7, (1.0 - 3.0 * nu) / 8.0),
        ] {
            assert!((k[(0, j)] - c * exact).abs() < 1e-12 * c, "column {j}");
        }
    }
}
