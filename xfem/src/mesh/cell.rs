//! The two cells, quad4 and hex8: numbering, shape functions, maps between reference and space.
//!
//! ```text
//!   quad4      3 ---- 2          hex8        7 ---- 6
//!     η        |      |           ζ  η     / |    / |
//!     |        |      |           | /     4 ---- 5  |
//!     +-- ξ    0 ---- 1           +-- ξ   |  3 --|- 2        reference cell [−1, 1]^dim
//!                                         | /    | /
//!                                         0 ---- 1
//!
//!   N_i(ξ) = 2^−dim Π_a (1 + ξ_a ξ_a^i)        x(ξ) = Σ N_i x_i        ∂N/∂x = J⁻ᵀ ∂N/∂ξ,  J = ∂x/∂ξ
//! ```

use std::ops::{Deref, DerefMut};

use crate::geometry::{Point, Points, mean, norm, sub};

use super::inverter::Inverter;

/// Most nodes of a cell.
pub const MOST_NODES: usize = 8;

/// Corner signs of the reference cell; quad4 uses the first four.
const CORNERS: [Point; MOST_NODES] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// One value per node of a cell.
#[derive(Debug, Clone, Copy)]
pub struct Nodal<T> {
    values: [T; MOST_NODES],
    count: usize,
}

impl<T: Copy + Default> Nodal<T> {
    /// The values of the nodes 0, 1, …
    pub fn new(count: usize, value: impl FnMut(usize) -> T) -> Self {
        let mut values = [T::default(); MOST_NODES];
        let filled = values.iter_mut().zip((0..count).map(value));
        filled.for_each(|(slot, value)| *slot = value);
        Nodal { values, count }
    }
}

impl<T> Deref for Nodal<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.values[..self.count]
    }
}

impl<T> DerefMut for Nodal<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values[..self.count]
    }
}

/// Kind of cell; a mesh holds one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// Bilinear quadrilateral.
    Quad4,
    /// Trilinear hexahedron.
    Hex8,
}

impl CellKind {
    /// Space dimension.
    pub fn dim(self) -> usize {
        match self {
            CellKind::Quad4 => 2,
            CellKind::Hex8 => 3,
        }
    }

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            CellKind::Quad4 => 4,
            CellKind::Hex8 => 8,
        }
    }

    /// Edges as pairs of local nodes.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            CellKind::Quad4 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            CellKind::Hex8 => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [4, 5],
                [5, 6],
                [6, 7],
                [7, 4],
                [0, 4],
                [1, 5],
                [2, 6],
                [3, 7],
            ],
        }
    }

    /// Facets (edges of the quad, faces of the hex) as local nodes in cyclic order, the normal pointing outwards.
    pub fn facets(self) -> &'static [&'static [usize]] {
        match self {
            CellKind::Quad4 => &[&[3, 0], &[1, 2], &[0, 1], &[2, 3]],
            CellKind::Hex8 => &[
                &[0, 4, 7, 3],
                &[1, 2, 6, 5],
                &[0, 1, 5, 4],
                &[3, 7, 6, 2],
                &[0, 3, 2, 1],
                &[4, 5, 6, 7],
            ],
        }
    }

    /// The node opposite to the first.
    fn opposite(self) -> usize {
        match self {
            CellKind::Quad4 => 2,
            CellKind::Hex8 => 6,
        }
    }

    /// Tetrahedra around the diagonal 0–6 that fill a 3D cell, exactly if its faces are planar; none in 2D.
    pub fn tetrahedra(self) -> &'static [[usize; 4]] {
        match self {
            CellKind::Quad4 => &[],
            CellKind::Hex8 => &[
                [0, 1, 2, 6],
                [0, 2, 3, 6],
                [0, 3, 7, 6],
                [0, 7, 4, 6],
                [0, 4, 5, 6],
                [0, 5, 1, 6],
            ],
        }
    }

    /// Reference coordinates of a local node.
    pub fn corner(self, node: usize) -> Point {
        let [x, y, z] = CORNERS[node];
        [x, y, if self.dim() == 3 { z } else { 0.0 }]
    }

    /// True for a reference point inside the cell, or outside by less than `slack`.
    pub fn contains(self, xi: &Point, slack: f64) -> bool {
        xi.iter().all(|v| v.abs() < 1.0 + slack)
    }

    /// N_i(ξ).
    pub fn shape(self, xi: &Point) -> Nodal<f64> {
        let n = self.shapes(&xi.map(|v| [v]));
        Nodal::new(self.nodes(), |i| n[i][0])
    }

    /// N_i(ξ) at L points, by node.
    #[inline(always)]
    pub fn shapes<const L: usize>(self, xi: &Points<L>) -> [[f64; L]; MOST_NODES] {
        let mut n = [[0.0; L]; MOST_NODES];
        for (n, c) in n.iter_mut().zip(&CORNERS).take(self.nodes()) {
            for q in 0..L {
                n[q] = 0.25 * (1.0 + xi[0][q] * c[0]) * (1.0 + xi[1][q] * c[1]);
            }
            if self == CellKind::Hex8 {
                for q in 0..L {
                    n[q] *= 0.5 * (1.0 + xi[2][q] * c[2]);
                }
            }
        }
        n
    }

    /// ∂N_i/∂ξ_a.
    pub(super) fn reference_gradients(self, xi: &Point) -> Nodal<Point> {
        let g = self.reference_slopes(&xi.map(|v| [v]));
        Nodal::new(self.nodes(), |i| g[i].map(|v| v[0]))
    }

    /// ∂N_i/∂ξ_a at L points, by node and direction.
    #[inline(always)]
    fn reference_slopes<const L: usize>(self, xi: &Points<L>) -> [Points<L>; MOST_NODES] {
        let mut slopes = [[[0.0; L]; 3]; MOST_NODES];
        for (g, c) in slopes.iter_mut().zip(&CORNERS).take(self.nodes()) {
            for q in 0..L {
                let f = [0, 1, 2].map(|a| 1.0 + xi[a][q] * c[a]);
                let own = match self {
                    CellKind::Quad4 => [0.25 * c[0] * f[1], 0.25 * c[1] * f[0], 0.0],
                    CellKind::Hex8 => [
                        0.125 * c[0] * f[1] * f[2],
                        0.125 * c[1] * f[0] * f[2],
                        0.125 * c[2] * f[0] * f[1],
                    ],
                };
                for a in 0..3 {
                    g[a][q] = own[a];
                }
            }
        }
        slopes
    }
}

/// The map from the reference cell to a cell in space, given by its corners [m].
#[derive(Debug, Clone, Copy)]
pub struct CellMap {
    /// Kind of the cell.
    pub kind: CellKind,
    corners: Nodal<Point>,
}

/// The corners.
impl Deref for CellMap {
    type Target = [Point];

    fn deref(&self) -> &[Point] {
        &self.corners
    }
}

impl CellMap {
    /// The map of a cell whose node i lies at `corner(i)`.
    pub fn new(kind: CellKind, corner: impl FnMut(usize) -> Point) -> Self {
        CellMap {
            kind,
            corners: Nodal::new(kind.nodes(), corner),
        }
    }

    /// Diagonal from the first corner to the opposite one: the length to which distances in the cell are compared [m].
    pub fn diagonal(&self) -> f64 {
        norm(&sub(&self[self.kind.opposite()], &self[0]))
    }

    /// Longest edge [m].
    pub fn longest_edge(&self) -> f64 {
        self.edge_lengths().fold(0.0, f64::max)
    }

    /// Longest over shortest edge.
    pub fn aspect(&self) -> f64 {
        self.longest_edge() / self.edge_lengths().fold(f64::INFINITY, f64::min)
    }

    fn edge_lengths(&self) -> impl Iterator<Item = f64> + '_ {
        let edges = self.kind.edges().iter();
        edges.map(|&[i, j]| norm(&sub(&self[i], &self[j])))
    }

    /// Mean of the corners [m].
    pub fn centre(&self) -> Point {
        mean(self.iter())
    }

    /// x(ξ).
    pub fn at(&self, xi: &Point) -> Point {
        let mut x = [0.0; 3];
        for (corner, value) in self.iter().zip(self.kind.shape(xi).iter()) {
            for a in 0..3 {
                x[a] += value * corner[a];
            }
        }
        x
    }

    /// Gradients ∂N_i/∂x [1/m] and det J [m^dim] at ξ.
    pub fn gradients(&self, xi: &Point) -> (Nodal<Point>, f64) {
        let reference = self.kind.reference_gradients(xi);
        let (inverse, det) = self.inverse_jacobian(&reference);
        let slopes = self.slopes(&xi.map(|v| [v]), Some(&inverse));
        (Nodal::new(self.len(), |i| slopes[i].map(|[v]| v)), det)
    }

    /// Gradients ∂N_i/∂x [1/m] at L points ξ, by node and direction; `inverse`: ∂ξ/∂x if it is the same everywhere.
    #[inline(always)]
    pub fn slopes<const L: usize>(
        &self,
        xi: &Points<L>,
        inverse: Option<&[Point; 3]>,
    ) -> [Points<L>; MOST_NODES] {
        let Some(inverse) = inverse else {
            let mut slopes = [[[0.0; L]; 3]; MOST_NODES];
            for q in 0..L {
                let own = self.gradients(&xi.map(|v| v[q])).0;
                for (slope, g) in slopes.iter_mut().zip(own.iter()) {
                    (0..3).for_each(|a| slope[a][q] = g[a]);
                }
            }
            return slopes;
        };
        let mut slopes = self.kind.reference_slopes(xi);
        for g in slopes.iter_mut().take(self.len()) {
            let own = *g;
            for a in 0..self.kind.dim() {
                for q in 0..L {
                    g[a][q] = own[0][q] * inverse[0][a]
                        + own[1][q] * inverse[1][a]
                        + own[2][q] * inverse[2][a];
                }
            }
        }
        slopes
    }

    /// ∂ξ_b/∂x_a by b and a [1/m], where it is the same all over the cell.
    pub fn constant_inverse(&self) -> Option<[Point; 3]> {
        let centre = self.kind.reference_gradients(&[0.0; 3]);
        self.is_affine().then(|| self.inverse_jacobian(&centre).0)
    }

    /// det J [m^dim] at ξ.
    pub fn determinant(&self, xi: &Point) -> f64 {
        self.inverse_jacobian(&self.kind.reference_gradients(xi)).1
    }

    /// (∂ξ_b/∂x_a)[b][a] and det ∂x/∂ξ; in 2D the third direction is the identity.
    pub(super) fn inverse_jacobian(&self, reference: &[Point]) -> ([Point; 3], f64) {
        let mut j = [[0.0; 3]; 3]; // j[a][b] = ∂x_a/∂ξ_b
        for (corner, grad) in self.iter().zip(reference) {
            for a in 0..3 {
                for b in 0..3 {
                    j[a][b] += corner[a] * grad[b];
                }
            }
        }
        if self.kind.dim() == 2 {
            j[2] = [0.0, 0.0, 1.0];
        }
        let cofactor = |a: usize, b: usize| {
            let (p, q) = ((a + 1) % 3, (a + 2) % 3);
            let (r, s) = ((b + 1) % 3, (b + 2) % 3);
            j[p][r] * j[q][s] - j[p][s] * j[q][r]
        };
        let det = (0..3).map(|b| j[0][b] * cofactor(0, b)).sum::<f64>();
        let mut inverse = [[0.0; 3]; 3];
        for (b, row) in inverse.iter_mut().enumerate() {
            for (a, entry) in row.iter_mut().enumerate() {
                *entry = cofactor(a, b) / det;
            }
        }
        (inverse, det)
    }

    /// ξ of a point in space; `None` if it is far outside a distorted cell.
    pub fn inverse(&self, x: &Point) -> Option<Point> {
        self.inverter().at(x)
    }

    /// Finds the ξ of many points.
    pub fn inverter(&self) -> Inverter {
        Inverter::new(self)
    }

    /// True if the map is affine (parallelogram, parallelepiped) to rounding.
    pub fn is_affine(&self) -> bool {
        let size = self.diagonal();
        let parallel = |[a, b, c, d]: [usize; 4]| {
            let differs = |k: usize| (self[a][k] - self[b][k]) - (self[c][k] - self[d][k]);
            (0..3).all(|k| differs(k).abs() <= 1e-12 * size)
        };
        match self.kind {
            CellKind::Quad4 => parallel([1, 0, 2, 3]),
            CellKind::Hex8 => [[1, 0, 2, 3], [4, 0, 5, 1], [4, 0, 6, 2], [4, 0, 7, 3]]
                .into_iter()
                .all(parallel),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KINDS: [CellKind; 2] = [CellKind::Quad4, CellKind::Hex8];

    /// A cell with randomly moved corners, by at most 0.2 of the edge.
    fn distorted(kind: CellKind, shifts: &[f64]) -> CellMap {
        CellMap::new(kind, |i| {
            let mut x = kind.corner(i);
            for a in 0..kind.dim() {
                x[a] += 0.4 * shifts[3 * i + a];
            }
            x
        })
    }

    proptest! {
        #[test]
        fn shape_functions_sum_to_one_and_gradients_to_zero(
            xi in prop::array::uniform3(-1.0f64..1.0), shifts in prop::collection::vec(-1.0f64..1.0, 24)
        ) {
            for kind in KINDS {
                let map = distorted(kind, &shifts);
                let sum: f64 = kind.shape(&xi).iter().sum();
                prop_assert!((sum - 1.0).abs() < 1e-14);
                let (g, det) = map.gradients(&xi);
                prop_assert!(det > 0.0);
                for a in 0..kind.dim() {
                    let total: f64 = g.iter().map(|v| v[a]).sum();
                    prop_assert!(total.abs() < 1e-13);
                    // linear fields are reproduced: Σ ∂N_i/∂x_a x_i = e_a
                    for b in 0..kind.dim() {
                        let slope: f64 = g.iter().zip(map.iter()).map(|(g, x)| g[a] * x[b]).sum();
                        let exact = f64::from(u8::from(a == b));
                        prop_assert!((slope - exact).abs() < 1e-12);
                    }
                }
            }
        }

        #[test]
        fn inverse_map_returns_the_reference_point(
            xi in prop::array::uniform3(-1.0f64..1.0), shifts in prop::collection::vec(-1.0f64..1.0, 24)
        ) {
            for kind in KINDS {
                let map = distorted(kind, &shifts);
                let mut xi = xi;
                xi[kind.dim()..].fill(0.0);
                let back = map.inverse(&map.at(&xi));
                prop_assert!(back.is_some());
                for (a, b) in back.iter().flatten().zip(&xi) {
                    prop_assert!((a - b).abs() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn only_parallelepipeds_are_affine() {
        for kind in KINDS {
            let sheared = |i: usize| {
                let [x, y, z] = kind.corner(i);
                [x + 0.7 * y + 0.1 * z, y, z]
            };
            let mut map = CellMap::new(kind, sheared);
            assert!(map.is_affine());
            map.corners[kind.nodes() - 1][1] += 1e-6;
            assert!(!map.is_affine());
        }
    }
}
