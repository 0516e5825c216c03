//! Assumed stress: what keeps bilinear quadrilaterals and trilinear hexahedra from locking in bending.
//!
//! Of a region r (a whole cell, or one of the parts that cracks divide it into) with B the strains of the shape functions, C
//! Hooke's law and P the modes of the stress, Hellinger & Reissner's principle gives
//!
//! ```text
//!   σ = P β,     H = ∫_r Pᵀ C⁻¹ P,     L = ∫_r Pᵀ B,     β = H⁻¹ L u,     K^r = Lᵀ H⁻¹ L
//!
//!   2D, 5 modes:    σ_ξξ: 1, η            σ_ηη: 1, ξ            σ_ξη: 1
//!   3D, 18 modes:   σ_ξξ: 1, η, ζ, ηζ     σ_ηη: 1, ζ, ξ, ζξ     σ_ζζ: 1, ξ, η, ξη     σ_ηζ: 1, ξ     σ_ζξ: 1, η     σ_ξη: 1, ζ
//! ```
//!
//! Pian & Sumihara, Int. J. Numer. Meth. Engng 20 (1984) 1685; Pian & Tong, ibid. 22 (1986) 173. Components are along the unit
//! columns of ∂x/∂ξ at the centre of the cell; ξ, η, ζ are centred in the region, which changes the basis of the modes, not
//! their span. Uniform stresses are among them: patch tests stay exact in every part of a cut cell. A bilinear displacement
//! that bends a cell shears it, too; no mode resists that shear. Next to a tip the modes would take from branch functions what they
//! are there for: those cells keep the stress of the gradient.
//!
//! With H = R Rᵀ the modes R⁻¹ P are orthonormal, and V = R⁻¹ L gives K^r = Vᵀ V, σ = (R⁻¹ P)ᵀ V u.

use nalgebra::{DMatrix, DVectorView};

use crate::geometry::{Point, add_scaled, dot, sub, unit};
use crate::material::{Lame, double_dot, strain};
use crate::mesh::cell::{CellMap, Nodal};

use super::cell_matrix::{CellError, SidedPoint};
use super::elasticity::CellMatrix;

/// A quadrature point with the gradients of the shape functions by local node [1/m].
pub type ShapePoint = (SidedPoint, Nodal<Point>);

/// 1, ξ, η, ζ, ηζ, ζξ, ξη.
const SCALARS: usize = 7;

/// A pivot of H smaller than this part of its diagonal is rounding.
const ROUNDING: f64 = 1e-14;

/// The assumed stress of a region, as a function of the displacements of the nodes.
#[derive(Debug, Clone)]
pub struct AssumedStress {
    /// The modes P: which scalar times which tensor.
    modes: Vec<(usize, [Point; 3])>,
    /// Centre of the region in reference coordinates.
    centre: Point,
    /// R, lower triangular.
    root: DMatrix<f64>,
    /// V, by mode, and by node and component.
    rows: DMatrix<f64>,
}

impl AssumedStress {
    /// From the points of a region.
    ///
    /// # Errors
    /// The region has no extent in some direction, or ν is ½ to rounding.
    pub fn new(map: &CellMap, lame: Lame, points: &[ShapePoint]) -> Result<Self, CellError> {
        let dim = map.kind.dim();
        let modes = modes(map);
        let (m, n) = (modes.len(), map.len() * dim);
        let volume: f64 = points.iter().map(|(at, _)| at.weight).sum();
        let add = |sum: Point, (at, _): &ShapePoint| add_scaled(&sum, at.weight / volume, &at.xi);
        let mut found = AssumedStress {
            modes,
            centre: points.iter().fold([0.0; 3], add),
            root: DMatrix::zeros(m, m),
            rows: DMatrix::zeros(m, n),
        };
        // ∫ c_i c_j and ∫ c_i ∇N of the scalars c.
        let mut products = [[0.0; SCALARS]; SCALARS];
        let mut moments = [Nodal::new(map.len(), |_| [0.0; 3]); SCALARS];
        for (at, gradients) in points {
            let c = found.scalars(&at.xi);
            for i in 0..SCALARS {
                let factor = at.weight * c[i];
                (0..=i).for_each(|j| products[i][j] += factor * c[j]);
                for (sum, g) in moments[i].iter_mut().zip(gradients.iter()) {
                    (0..dim).for_each(|a| sum[a] += factor * g[a]);
                }
            }
        }
        for (p, (c, s)) in found.modes.iter().enumerate() {
            let e = strain(lame, dim, s);
            for (q, (d, t)) in found.modes[..=p].iter().enumerate() {
                found.root[(p, q)] = double_dot(&e, t) * products[*c.max(d)][*c.min(d)];
            }
            for (k, g) in moments[*c].iter().enumerate() {
                (0..dim).for_each(|a| found.rows[(p, k * dim + a)] = dot(&s[a], g));
            }
        }
        let squares = found.root.diagonal();
        let r = &mut found.root;
        for (i, j) in (0..m).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let known: f64 = (0..j).map(|k| r[(i, k)] * r[(j, k)]).sum();
            let own = r[(i, j)] - known;
            r[(i, j)] = if j < i { own / r[(j, j)] } else { own.sqrt() };
        }
        // The root of a negative pivot is no number.
        if !(0..m).all(|i| r[(i, i)].powi(2) > ROUNDING * squares[i]) {
            let what = "stress modes that nothing tells apart";
            return Err(CellError::new(map.centre(), what));
        }
        found.root.solve_lower_triangular_mut(&mut found.rows);
        Ok(found)
    }

    /// K^r = Vᵀ V, by node and component.
    pub fn stiffness(&self) -> CellMatrix {
        self.rows.tr_mul(&self.rows)
    }

    /// σ n at ξ per unit displacement, by node and component [Pa/m].
    pub fn response(&self, xi: &Point, n: &Point) -> Vec<Point> {
        let mut found = vec![[0.0; 3]; self.rows.ncols()];
        for (s, row) in self.orthonormal(xi).iter().zip(self.rows.row_iter()) {
            let t = s.map(|row| dot(&row, n));
            for (sum, v) in found.iter_mut().zip(row.iter()) {
                *sum = add_scaled(sum, *v, &t);
            }
        }
        found
    }

    /// σ at ξ [Pa] from the displacements of the nodes, by node and component.
    pub fn at(&self, xi: &Point, u: &[f64]) -> [Point; 3] {
        let mut sigma = [[0.0; 3]; 3];
        let amounts = &self.rows * DVectorView::from_slice(u, u.len());
        for (s, amount) in self.orthonormal(xi).iter().zip(amounts.iter()) {
            sigma = [0, 1, 2].map(|a| [0, 1, 2].map(|b| sigma[a][b] + amount * s[a][b]));
        }
        sigma
    }

    /// The modes R⁻¹ P at ξ.
    fn orthonormal(&self, xi: &Point) -> Vec<[Point; 3]> {
        let (m, c) = (self.modes.len(), self.scalars(xi));
        let mut found: Vec<[Point; 3]> = Vec::with_capacity(m);
        for (i, (scalar, tensor)) in self.modes.iter().enumerate() {
            let row = self.root.row(i);
            let entry = |a: usize, b: usize| {
                let known: f64 = row.iter().zip(&found).map(|(r, s)| r * s[a][b]).sum();
                (c[*scalar] * tensor[a][b] - known) / row[i]
            };
            found.push([0, 1, 2].map(|a| [0, 1, 2].map(|b| entry(a, b))));
        }
        found
    }

    fn scalars(&self, xi: &Point) -> [f64; SCALARS] {
        let [x, y, z] = sub(xi, &self.centre);
        [1.0, x, y, z, y * z, z * x, x * y]
    }
}

/// The modes of a cell.
fn modes(map: &CellMap) -> Vec<(usize, [Point; 3])> {
    let column = |b: usize| {
        let corners = map.iter().enumerate();
        corners.fold([0.0; 3], |sum, (i, x)| {
            add_scaled(&sum, map.kind.corner(i)[b], x)
        })
    };
    let t = [0, 1, 2].map(|b| unit(&column(b)));
    let tensor = |i: usize, j: usize| {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| 0.5 * (t[i][a] * t[j][b] + t[j][a] * t[i][b])))
    };
    if map.kind.dim() == 2 {
        let [xx, yy] = [tensor(0, 0), tensor(1, 1)];
        return vec![(0, xx), (2, xx), (0, yy), (1, yy), (0, tensor(0, 1))];
    }
    let of_axis = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let normal = [0, 1 + j, 1 + k, 4 + i].map(|scalar| (scalar, tensor(i, i)));
        let shear = [0, 1 + i].map(|scalar| (scalar, tensor(j, k)));
        normal.into_iter().chain(shear)
    };
    (0..3).flat_map(of_axis).collect()
}
