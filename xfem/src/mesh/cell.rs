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

use crate::geometry::{Point, dot, sub};

/// Corner signs of the reference cell; quad4 uses the first four.
const CORNERS: [Point; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Values of all shape functions at a point; quad4 uses the first four.
pub type Shape = [f64; 8];
/// Gradients of all shape functions at a point, in space [1/m].
pub type Gradients = [Point; 8];

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
        1 << self.dim()
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

    /// Reference coordinates of a local node.
    pub fn corner(self, node: usize) -> Point {
        let mut corner = CORNERS[node];
        if self == CellKind::Quad4 {
            corner[2] = 0.0;
        }
        corner
    }

    /// N_i(ξ).
    pub fn shape(self, xi: &Point) -> Shape {
        let mut n = [0.0; 8];
        for (i, value) in n.iter_mut().enumerate().take(self.nodes()) {
            let c = &CORNERS[i];
            *value = 0.25 * (1.0 + xi[0] * c[0]) * (1.0 + xi[1] * c[1]);
            if self == CellKind::Hex8 {
                *value *= 0.5 * (1.0 + xi[2] * c[2]);
            }
        }
        n
    }

    /// ∂N_i/∂ξ_a.
    pub fn reference_gradients(self, xi: &Point) -> Gradients {
        let mut g = [[0.0; 3]; 8];
        for (i, grad) in g.iter_mut().enumerate().take(self.nodes()) {
            let c = &CORNERS[i];
            let f = [1.0 + xi[0] * c[0], 1.0 + xi[1] * c[1], 1.0 + xi[2] * c[2]];
            *grad = match self {
                CellKind::Quad4 => [0.25 * c[0] * f[1], 0.25 * c[1] * f[0], 0.0],
                CellKind::Hex8 => [
                    0.125 * c[0] * f[1] * f[2],
                    0.125 * c[1] * f[0] * f[2],
                    0.125 * c[2] * f[0] * f[1],
                ],
            };
        }
        g
    }

    /// x(ξ) for a cell with the given node positions.
    pub fn map(self, nodes: &[Point], xi: &Point) -> Point {
        let n = self.shape(xi);
        let mut x = [0.0; 3];
        for (node, value) in nodes.iter().zip(n) {
            for a in 0..3 {
                x[a] += value * node[a];
            }
        }
        x
    }

    /// Gradients in space and det J [m^dim] at ξ.
    pub fn gradients(self, nodes: &[Point], xi: &Point) -> (Gradients, f64) {
        let reference = self.reference_gradients(xi);
        let (inverse, det) = self.inverse_jacobian(nodes, &reference);
        let mut g = [[0.0; 3]; 8];
        for i in 0..self.nodes() {
            for a in 0..self.dim() {
                // ∂N/∂x_a = Σ_b ∂N/∂ξ_b ∂ξ_b/∂x_a
                g[i][a] = dot(
                    &reference[i],
                    &[inverse[0][a], inverse[1][a], inverse[2][a]],
                );
            }
        }
        (g, det)
    }

    /// (∂ξ_b/∂x_a)[b][a] and det ∂x/∂ξ; in 2D the third direction is the identity.
    fn inverse_jacobian(self, nodes: &[Point], reference: &Gradients) -> ([Point; 3], f64) {
        let mut j = [[0.0; 3]; 3]; // j[a][b] = ∂x_a/∂ξ_b
        for (node, grad) in nodes.iter().zip(reference) {
            for a in 0..3 {
                for b in 0..3 {
                    j[a][b] += node[a] * grad[b];
                }
            }
        }
        if self == CellKind::Quad4 {
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

    /// ξ of a point in space, by Newton's method; `None` if it does not converge (point far outside a distorted cell).
    ///
    /// One step is exact on affine cells.
    pub fn inverse_map(self, nodes: &[Point], x: &Point) -> Option<Point> {
        /// Newton steps; bilinear maps need 3 to 6 inside the cell.
        const STEPS: usize = 30;
        /// In reference units, well above rounding and far below any quadrature error.
        const TOLERANCE: f64 = 1e-14;
        let mut xi = [0.0; 3];
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let residual = sub(x, &self.map(nodes, &xi));
            let (inverse, det) = self.inverse_jacobian(nodes, &self.reference_gradients(&xi));
            if det == 0.0 || !det.is_finite() {
                return None;
            }
            let mut step: f64 = 0.0;
            for b in 0..self.dim() {
                let delta = dot(&inverse[b], &residual);
                xi[b] += delta;
                step = step.max(delta.abs());
            }
            // Converged, or the step has sunk into rounding and no longer shrinks.
            if step <= TOLERANCE || (step < 1e-12 && step >= last) {
                return Some(xi);
            }
            last = step;
        }
        None
    }

    /// True if the map is affine (parallelogram, parallelepiped) to rounding.
    pub fn is_affine(self, nodes: &[Point]) -> bool {
        let size = dot(&sub(&nodes[0], &nodes[2]), &sub(&nodes[0], &nodes[2])).sqrt();
        let parallel = |a: usize, b: usize, c: usize, d: usize| {
            (0..3).all(|k| {
                ((nodes[a][k] - nodes[b][k]) - (nodes[c][k] - nodes[d][k])).abs() <= 1e-12 * size
            })
        };
        match self {
            CellKind::Quad4 => parallel(1, 0, 2, 3),
            CellKind::Hex8 => {
                parallel(1, 0, 2, 3)
                    && parallel(4, 0, 5, 1)
                    && parallel(4, 0, 6, 2)
                    && parallel(4, 0, 7, 3)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KINDS: [CellKind; 2] = [CellKind::Quad4, CellKind::Hex8];

    #[test]
    fn shape_functions_are_one_at_their_node_and_zero_at_the_others() {
        for kind in KINDS {
            for j in 0..kind.nodes() {
                let n = kind.shape(&kind.corner(j));
                for (i, value) in n.iter().enumerate().take(kind.nodes()) {
                    assert_eq!(*value, if i == j { 1.0 } else { 0.0 });
                }
            }
        }
    }

    #[test]
    fn facet_normals_point_outwards() {
        for kind in KINDS {
            for facet in kind.facets() {
                let c: Vec<Point> = facet.iter().map(|&i| kind.corner(i)).collect();
                let e = sub(&c[1], &c[0]);
                let normal = match kind {
                    CellKind::Quad4 => [e[1], -e[0], 0.0],
                    CellKind::Hex8 => crate::geometry::cross(&e, &sub(&c[2], &c[1])),
                };
                assert!(dot(&normal, &c[0]) > 0.0, "{kind:?} {facet:?}");
            }
        }
    }

    /// A cell with randomly moved corners, by at most 0.2 of the edge.
    fn distorted(kind: CellKind, shifts: &[f64]) -> Vec<Point> {
        (0..kind.nodes())
            .map(|i| {
                let mut x = kind.corner(i);
                for a in 0..kind.dim() {
                    x[a] += 0.4 * shifts[3 * i + a];
                }
                x
            })
            .collect()
    }

    proptest! {
        #[test]
        fn shape_functions_sum_to_one_and_gradients_to_zero(
            xi in prop::array::uniform3(-1.0f64..1.0), shifts in prop::collection::vec(-1.0f64..1.0, 24)
        ) {
            for kind in KINDS {
                let nodes = distorted(kind, &shifts);
                let sum: f64 = kind.shape(&xi)[..kind.nodes()].iter().sum();
                prop_assert!((sum - 1.0).abs() < 1e-14);
                let (g, det) = kind.gradients(&nodes, &xi);
                prop_assert!(det > 0.0);
                for a in 0..kind.dim() {
                    let total: f64 = g[..kind.nodes()].iter().map(|v| v[a]).sum();
                    prop_assert!(total.abs() < 1e-13);
                    // linear fields are reproduced: Σ ∂N_i/∂x_a x_i = e_a
                    for b in 0..kind.dim() {
                        let slope: f64 = (0..kind.nodes()).map(|i| g[i][a] * nodes[i][b]).sum();
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
                let nodes = distorted(kind, &shifts);
                let mut xi = xi;
                if kind == CellKind::Quad4 { xi[2] = 0.0; }
                let back = kind.inverse_map(&nodes, &kind.map(&nodes, &xi));
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
            let mut nodes: Vec<Point> = (0..kind.nodes()).map(|i| kind.corner(i)).collect();
            for x in &mut nodes {
                x[0] += 0.7 * x[1] + 0.1 * x[2];
            }
            assert!(kind.is_affine(&nodes));
            nodes[kind.nodes() - 1][1] += 1e-6;
            assert!(!kind.is_affine(&nodes));
        }
    }
}
