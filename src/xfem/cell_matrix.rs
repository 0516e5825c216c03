//! Stiffness of enriched cells.
//!
//! Cells with Heaviside functions only need the standard stiffness of their two sides, K⁺ and K⁻: every function is
//! N_i times a constant on each side, f_i^± = 1 (standard) or ±1 − H_j (Heaviside), so
//!
//! ```text
//!   K[(p,a),(q,b)] = Σ_± f_p^± f_q^± K^±[(i_p,a),(i_q,b)]
//! ```
//!
//! On affine cells the smaller side is integrated and the larger is K_e minus it: half the work, and a sliver keeps its
//! full relative accuracy (its entries may be 10⁻²⁴ of K_e and still count). Cells with branch functions are integrated
//! function by function.

use crate::fem::cell::CellKind;
use crate::fem::elasticity::{CellMatrix, Gram, Lame, cell_stiffness, flatten};
use crate::fem::mesh::Mesh;
use crate::fem::quadrature::{WeightedPoint, gauss_cell};
use crate::fem::{Point, sub};
use crate::harness::case::Quadrature;

use super::basis::{CellBasis, CellFunction};
use super::crack::Crack;
use super::cut::{self, Side, SubCells};
use super::enrichment::Enrichment;

/// A quadrature point of a cell.
#[derive(Debug, Clone, Copy)]
pub struct SidedPoint {
    /// Reference position.
    pub xi: Point,
    /// Position [m].
    pub x: Point,
    /// Weight [m^dim].
    pub weight: f64,
    /// Side of the splitting crack.
    pub side: Side,
}

/// A cell whose sub-cells cannot be integrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cell at {at:?}: {reason}")]
pub struct CellError {
    /// Centre of the cell [m].
    pub at: Point,
    /// What went wrong.
    pub reason: String,
}

/// Everything the cells of one body share.
pub struct CellIntegrator<'a> {
    /// Mesh.
    pub mesh: &'a Mesh,
    /// Cracks through cells.
    pub cracks: &'a [Crack],
    /// Functions.
    pub enrichment: &'a Enrichment,
    /// Rule for cut cells.
    pub quadrature: Quadrature,
    /// Material.
    pub lame: Lame,
}

impl CellIntegrator<'_> {
    /// Stiffness of any cell over its function list, `plain` being its standard stiffness.
    pub fn stiffness(&self, cell: usize, plain: &CellMatrix) -> Result<CellMatrix, CellError> {
        let basis = self.enrichment.cell_basis(self.mesh, cell);
        if basis.len() == self.mesh.kind.nodes() {
            Ok(plain.clone())
        } else if self.enrichment.has_branch(cell) {
            self.by_functions(cell, &basis)
        } else {
            self.by_sides(cell, &basis, plain)
        }
    }

    /// K⁺ and K⁻ combined.
    fn by_sides(
        &self,
        cell: usize,
        basis: &[CellFunction],
        plain: &CellMatrix,
    ) -> Result<CellMatrix, CellError> {
        let (kind, dim) = (self.mesh.kind, self.mesh.dim());
        let corners = self.mesh.corners(cell);
        let corners = &corners[..kind.nodes()];
        let points = self.points(cell)?;
        let volume = |side: Side| -> f64 {
            points
                .iter()
                .filter(|p| p.side == side)
                .map(|p| p.weight)
                .sum()
        };
        let small = if volume(1.0) <= volume(-1.0) {
            1.0
        } else {
            -1.0
        };
        let integrate = |side: Side| {
            let mut gram = Gram::zero(kind.nodes(), dim);
            let mut flat = vec![0.0; kind.nodes() * dim];
            for p in points.iter().filter(|p| p.side == side) {
                flatten(
                    &kind.gradients(corners, &p.xi).0[..kind.nodes()],
                    dim,
                    &mut flat,
                );
                gram.add(p.weight, &flat);
            }
            gram.stiffness(self.lame)
        };
        let k_small = integrate(small);
        let k_large = if kind.is_affine(corners) && self.quadrature == Quadrature::SubCells {
            CellMatrix::difference(plain, &k_small)
        } else {
            integrate(-small)
        };
        let mut k = CellMatrix::zero(basis.len() * dim);
        for (side, part) in [(small, &k_small), (-small, &k_large)] {
            for (p, fp) in basis.iter().enumerate() {
                for (q, fq) in basis.iter().enumerate() {
                    let f = fp.step(side) * fq.step(side);
                    if f == 0.0 {
                        continue;
                    }
                    for a in 0..dim {
                        for b in 0..dim {
                            let value = f * part.get(fp.local * dim + a, fq.local * dim + b);
                            k.add(p * dim + a, q * dim + b, value);
                        }
                    }
                }
            }
        }
        Ok(k)
    }

    /// Direct integration of all functions.
    fn by_functions(&self, cell: usize, basis: &[CellFunction]) -> Result<CellMatrix, CellError> {
        let dim = self.mesh.dim();
        let corners = self.mesh.corners(cell);
        let cell_basis = self.basis(cell, &corners, basis);
        let mut gram = Gram::zero(basis.len(), dim);
        let mut values = vec![0.0; basis.len()];
        let mut gradients = vec![[0.0; 3]; basis.len()];
        let mut flat = vec![0.0; basis.len() * dim];
        for p in self.points(cell)? {
            cell_basis.evaluate(&p.xi, &p.x, p.side, &mut values, &mut gradients);
            flatten(&gradients, dim, &mut flat);
            gram.add(p.weight, &flat);
        }
        Ok(gram.stiffness(self.lame))
    }

    /// The cell's functions, ready to be evaluated.
    pub fn basis<'b>(
        &'b self,
        cell: usize,
        corners: &'b [Point; 8],
        functions: &'b [CellFunction],
    ) -> CellBasis<'b> {
        CellBasis {
            kind: self.mesh.kind,
            corners: &corners[..self.mesh.kind.nodes()],
            functions,
            crack: self.enrichment.split[cell].map(|c| c as usize),
            tips: &self.enrichment.tips,
        }
    }

    /// Quadrature points of a cell for its functions; the weights sum to its measure.
    pub fn points(&self, cell: usize) -> Result<Vec<SidedPoint>, CellError> {
        let kind = self.mesh.kind;
        let corners = self.mesh.corners(cell);
        let corners = &corners[..kind.nodes()];
        let split = self.enrichment.split[cell].map(|c| &self.cracks[c as usize]);
        let branch = self.enrichment.has_branch(cell);
        match (split, self.quadrature) {
            (None, _) if !branch => Ok(whole_cell(kind, corners, 2, |_| 1.0)),
            (Some(crack), Quadrature::Gauss(n)) => Ok(whole_cell(kind, corners, n, |x| {
                if crack.distance(x) >= 0.0 { 1.0 } else { -1.0 }
            })),
            _ => self.sub_cell_points(cell, corners, split, branch),
        }
    }

    fn sub_cell_points(
        &self,
        cell: usize,
        corners: &[Point],
        split: Option<&Crack>,
        branch: bool,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let kind = self.mesh.kind;
        let affine = kind.is_affine(corners);
        let phi = match split {
            Some(crack) => crack.cell_phi(self.mesh, cell),
            None => [1.0; 8],
        };
        let tip = self
            .enrichment
            .tip_cells
            .iter()
            .find(|&&(c, _)| c == cell)
            .map(|&(_, tip)| self.enrichment.tips[tip].position);
        let mut points = Vec::new();
        for side in [1.0, -1.0] {
            let part = match (branch, tip) {
                (true, Some(tip)) => {
                    let polygon = cut::polygon_part(corners, &phi[..kind.nodes()], side);
                    cut::tip_points(&polygon, &tip, affine)
                }
                (true, None) => {
                    let polygon = cut::polygon_part(corners, &phi[..kind.nodes()], side);
                    let tips: Vec<Point> =
                        self.enrichment.tips.iter().map(|t| t.position).collect();
                    cut::graded_points(&cut::fan(&polygon), &tips)
                }
                (false, _) => {
                    let cells = SubCells::of(kind, corners, &phi, side);
                    if affine {
                        cells.points()
                    } else {
                        cells.fine_points()
                    }
                }
            };
            for WeightedPoint { x, weight } in part {
                let Some(xi) = kind.inverse_map(corners, &x) else {
                    return Err(
                        self.error(cell, "a sub-cell point has no reference position".into())
                    );
                };
                points.push(SidedPoint {
                    xi,
                    x,
                    weight,
                    side,
                });
            }
        }
        // A slip in the geometry shows as a wrong measure: never integrate over it.
        let measure: f64 = gauss_cell(kind.dim(), 2)
            .iter()
            .map(|(xi, w)| w * kind.gradients(corners, xi).1)
            .sum();
        let sum: f64 = points.iter().map(|p| p.weight).sum();
        // The sinh rule of a tip fan integrates constants to its own accuracy, not to rounding.
        let tolerance = if tip.is_some() { 1e-6 } else { 1e-12 };
        if (sum - measure).abs() > tolerance * measure {
            let reason = format!("sub-cells measure {sum:e} instead of {measure:e}");
            return Err(self.error(cell, reason));
        }
        Ok(points)
    }

    fn error(&self, cell: usize, reason: String) -> CellError {
        CellError {
            at: self.mesh.centre(cell),
            reason,
        }
    }

    /// Standard stiffness of a cell.
    pub fn plain(&self, cell: usize) -> CellMatrix {
        let corners = self.mesh.corners(cell);
        cell_stiffness(
            self.mesh.kind,
            &corners[..self.mesh.kind.nodes()],
            self.lame,
        )
    }

    /// Values of the functions of a cell at a reference point (position x).
    pub fn values(&self, cell: usize, xi: &Point, x: &Point, side: Side) -> Vec<f64> {
        let functions = self.enrichment.cell_basis(self.mesh, cell);
        let corners = self.mesh.corners(cell);
        let mut values = vec![0.0; functions.len()];
        let mut gradients = vec![[0.0; 3]; functions.len()];
        self.basis(cell, &corners, &functions)
            .evaluate(xi, x, side, &mut values, &mut gradients);
        values
    }

    /// Gradients of the functions of a cell at a reference point (position x) [1/m].
    pub fn gradients(&self, cell: usize, xi: &Point, x: &Point, side: Side) -> Vec<Point> {
        let functions = self.enrichment.cell_basis(self.mesh, cell);
        let corners = self.mesh.corners(cell);
        let mut values = vec![0.0; functions.len()];
        let mut gradients = vec![[0.0; 3]; functions.len()];
        self.basis(cell, &corners, &functions)
            .evaluate(xi, x, side, &mut values, &mut gradients);
        gradients
    }

    /// Displacement gradient ∂u_a/∂x_b at a reference point of a cell, from all unknowns u (function-major).
    pub fn displacement_gradient(
        &self,
        cell: usize,
        xi: &Point,
        side: Side,
        u: &[f64],
    ) -> [Point; 3] {
        let dim = self.mesh.dim();
        let corners = self.mesh.corners(cell);
        let x = (self.mesh.kind).map(&corners[..self.mesh.kind.nodes()], xi);
        let gradients = self.gradients(cell, xi, &x, side);
        let mut h = [[0.0; 3]; 3];
        for (&f, g) in self.enrichment.cell(cell).iter().zip(&gradients) {
            for a in 0..dim {
                for b in 0..dim {
                    h[a][b] += u[f as usize * dim + a] * g[b];
                }
            }
        }
        h
    }

    /// Displacement at a point of a cell, on a side of the crack that splits it.
    pub fn displacement(&self, cell: usize, x: &Point, side: Side, u: &[f64]) -> Option<Point> {
        let dim = self.mesh.dim();
        let functions = self.enrichment.cell_basis(self.mesh, cell);
        let corners = self.mesh.corners(cell);
        let basis = self.basis(cell, &corners, &functions);
        let xi = self.mesh.kind.inverse_map(basis.corners, x)?;
        let mut values = vec![0.0; functions.len()];
        let mut gradients = vec![[0.0; 3]; functions.len()];
        basis.evaluate(&xi, x, side, &mut values, &mut gradients);
        let mut v = [0.0; 3];
        for (&f, n) in self.enrichment.cell(cell).iter().zip(&values) {
            for (a, va) in v.iter_mut().enumerate().take(dim) {
                *va += n * u[f as usize * dim + a];
            }
        }
        Some(v)
    }

    /// Shape up to translation, in multiples of `quantum` [m]: cells with equal keys share one standard stiffness.
    pub fn shape_key(&self, cell: usize, quantum: f64) -> [i64; 21] {
        let corners = self.mesh.corners(cell);
        let mut key = [0; 21];
        for (i, corner) in corners
            .iter()
            .enumerate()
            .take(self.mesh.kind.nodes())
            .skip(1)
        {
            let d = sub(corner, &corners[0]);
            for a in 0..3 {
                key[3 * (i - 1) + a] = (d[a] / quantum).round() as i64;
            }
        }
        key
    }
}

/// Tensor Gauss points of the whole cell with a side each.
fn whole_cell(
    kind: CellKind,
    corners: &[Point],
    n: usize,
    side: impl Fn(&Point) -> Side,
) -> Vec<SidedPoint> {
    gauss_cell(kind.dim(), n)
        .into_iter()
        .map(|(xi, w)| {
            let x = kind.map(corners, &xi);
            SidedPoint {
                xi,
                x,
                weight: w * kind.gradients(corners, &xi).1,
                side: side(&x),
            }
        })
        .collect()
}
