//! Stiffness of enriched cells.
//!
//! Cells with Heaviside functions only need the standard stiffness K^r of their regions r, the two sides of a crack or the
//! parts between several: every function is N_i times a constant in each, f_i^r = 1 (standard) or ±1 − H_j (Heaviside), so
//!
//! ```text
//!   K[(p,a),(q,b)] = Σ_r f_p^r f_q^r K^r[(i_p,a),(i_q,b)]
//! ```
//!
//! On affine cells the largest region is K_e minus the others: half the work, and a sliver keeps its
//! full relative accuracy (its entries may be 10⁻²⁴ of K_e and still count). Cells with branch functions are integrated
//! function by function.

use crate::cut::crack::Crack;
use crate::cut::partition::{Part, Partition};
use crate::enrichment::Enrichment;
use crate::enrichment::basis::{CellBasis, CellFunction, Region};
use crate::enrichment::facets::CrackFacets;
use crate::geometry::clip::Side;
use crate::geometry::{Point, sub};
use crate::material::Lame;
use crate::mesh::Mesh;
use crate::mesh::cell::CellKind;
use crate::quadrature::graded::graded_points;
use crate::quadrature::{Quadrature, WeightedPoint, gauss_cell, tip_points};

use super::elasticity::{CellMatrix, Gram, cell_stiffness, flatten};
use super::near_front::{Effort, NearFront};

/// A quadrature point of a cell.
#[derive(Debug, Clone, Copy)]
pub struct SidedPoint {
    /// Reference position.
    pub xi: Point,
    /// Position [m].
    pub x: Point,
    /// Weight [m^dim].
    pub weight: f64,
    /// Part of the cell.
    pub region: Region,
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
            self.by_regions(cell, &basis, plain)
        }
    }

    /// The standard stiffness of every region, combined.
    fn by_regions(
        &self,
        cell: usize,
        basis: &[CellFunction],
        plain: &CellMatrix,
    ) -> Result<CellMatrix, CellError> {
        let (kind, dim) = (self.mesh.kind, self.mesh.dim());
        let corners = self.mesh.corners(cell);
        let corners = &corners[..kind.nodes()];
        let points = self.points(cell)?;
        let regions = self.enrichment.regions(cell);
        let volume = |region: Region| -> f64 {
            let own = points.iter().filter(|p| p.region == region);
            own.map(|p| p.weight).sum()
        };
        // The first of the largest: the others are integrated.
        let largest = (0..regions)
            .rev()
            .max_by(|&a, &b| volume(a).total_cmp(&volume(b)))
            .unwrap_or(0);
        let integrate = |region: Region| {
            let mut gram = Gram::zero(kind.nodes(), dim);
            let mut flat = vec![0.0; kind.nodes() * dim];
            for p in points.iter().filter(|p| p.region == region) {
                flatten(
                    &kind.gradients(corners, &p.xi).0[..kind.nodes()],
                    dim,
                    &mut flat,
                );
                gram.add(p.weight, &flat);
            }
            gram.stiffness(self.lame)
        };
        let mut parts: Vec<CellMatrix> = Vec::with_capacity(regions);
        let exact = kind.is_affine(corners) && self.quadrature == Quadrature::SubCells;
        let mut rest = plain.clone();
        for region in 0..regions {
            if exact && region == largest {
                parts.push(CellMatrix::zero(0));
                continue;
            }
            let own = integrate(region);
            rest = CellMatrix::difference(&rest, &own);
            parts.push(own);
        }
        if exact {
            parts[largest] = rest;
        }
        let mut k = CellMatrix::zero(basis.len() * dim);
        let cell_basis = self.basis(cell, corners, basis);
        for (region, part) in parts.iter().enumerate() {
            let steps = cell_basis.steps(region);
            for (p, fp) in basis.iter().enumerate() {
                for (q, fq) in basis.iter().enumerate() {
                    let f = steps[p] * steps[q];
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
        let cell_basis = self.basis(cell, &corners[..self.mesh.kind.nodes()], basis);
        let mut gram = Gram::zero(basis.len(), dim);
        let mut values = vec![0.0; basis.len()];
        let mut gradients = vec![[0.0; 3]; basis.len()];
        let mut flat = vec![0.0; basis.len() * dim];
        for p in self.points(cell)? {
            cell_basis.evaluate(&p.xi, &p.x, p.region, &mut values, &mut gradients);
            flatten(&gradients, dim, &mut flat);
            gram.add(p.weight, &flat);
        }
        Ok(gram.stiffness(self.lame))
    }

    /// The cell's functions, ready to be evaluated.
    pub fn basis<'b>(
        &'b self,
        cell: usize,
        corners: &'b [Point],
        functions: &'b [CellFunction],
    ) -> CellBasis<'b> {
        CellBasis {
            kind: self.mesh.kind,
            corners,
            functions,
            steps: self.enrichment.steps(cell),
            tips: &self.enrichment.tips,
        }
    }

    /// Quadrature points of a cell for its functions; the weights sum to its measure.
    pub fn points(&self, cell: usize) -> Result<Vec<SidedPoint>, CellError> {
        let kind = self.mesh.kind;
        let corners = self.mesh.corners(cell);
        let corners = &corners[..kind.nodes()];
        let partition = self.enrichment.partition(cell);
        let branch = self.enrichment.has_branch(cell);
        match (partition, self.quadrature) {
            (None, _) if !branch => Ok(whole_cell(kind, corners, 2, |_| 0)),
            (Some(partition), Quadrature::Gauss(n)) => Ok(whole_cell(kind, corners, n, |x| {
                let holds = |&(crack, side): &(usize, Side)| {
                    (self.cracks[crack].distance(x) >= 0.0) == (side > 0.0)
                };
                let inside = |part: &Part| part.sides.iter().all(holds);
                partition.parts.iter().position(inside).unwrap_or(0)
            })),
            _ => self.sub_cell_points(cell, corners, partition, branch),
        }
    }

    fn sub_cell_points(
        &self,
        cell: usize,
        corners: &[Point],
        partition: Option<&Partition>,
        branch: bool,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let kind = self.mesh.kind;
        let affine = kind.is_affine(corners);
        let whole = Partition::whole(kind, corners);
        let parts = &partition.unwrap_or(&whole).parts;
        if branch && kind == CellKind::Hex8 {
            return self.near_front_points(cell, corners, parts, Effort::WORKING);
        }
        let tip = self.tip_in(cell);
        let mut points = Vec::new();
        for (region, part) in parts.iter().enumerate() {
            let rule = match (branch, tip) {
                (true, Some(tip)) => {
                    tip_points(&part.polygon, &self.enrichment.tips[tip].position, affine)
                }
                (true, None) => {
                    let tips: Vec<Point> =
                        self.enrichment.tips.iter().map(|t| t.position).collect();
                    graded_points(&part.sub_cells().triangles, &tips)
                }
                (false, _) if affine => part.sub_cells().points(),
                (false, _) => part.sub_cells().fine_points(kind, corners),
            };
            points.extend(rule.into_iter().map(|p| (p, region)));
        }
        // The sinh rule of a tip fan integrates constants to its own accuracy, not to rounding.
        let tolerance = if tip.is_some() { 1e-6 } else { 1e-12 };
        self.located(cell, corners, points, tolerance)
    }

    /// The tip or front in a cell.
    fn tip_in(&self, cell: usize) -> Option<usize> {
        let own = self.enrichment.tip_cells.iter().find(|&&(c, _)| c == cell);
        own.map(|&(_, tip)| tip)
    }

    /// Points of a 3D cell with branch functions.
    pub fn near_front_points(
        &self,
        cell: usize,
        corners: &[Point],
        parts: &[Part],
        effort: Effort,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let near = NearFront {
            corners,
            parts,
            fronts: &self.enrichment.tips,
            chord: self.tip_in(cell).and_then(|tip| {
                let index = self.enrichment.tips[tip].crack;
                let crack = &self.cracks[index];
                let facets = CrackFacets::of_cell(self.mesh, cell, index, crack, self.enrichment);
                facets
                    .facets
                    .iter()
                    .find_map(|f| f.front.as_ref().map(|cut| cut.chord))
            }),
        };
        let points = near.points(|crack| self.cracks[crack].cell_phi(self.mesh, cell), effort);
        self.located(cell, corners, points, 1e-6)
    }

    /// Reference positions of points that must fill the cell up to a relative tolerance.
    fn located(
        &self,
        cell: usize,
        corners: &[Point],
        points: Vec<(WeightedPoint, Region)>,
        tolerance: f64,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let kind = self.mesh.kind;
        // A slip in the geometry shows as a wrong measure: never integrate over it.
        let measure: f64 = gauss_cell(kind.dim(), 2)
            .iter()
            .map(|(xi, w)| w * kind.gradients(corners, xi).1)
            .sum();
        let sum: f64 = points.iter().map(|(p, _)| p.weight).sum();
        if (sum - measure).abs() > tolerance * measure {
            let reason = format!("sub-cells measure {sum:e} instead of {measure:e}");
            return Err(self.error(cell, reason));
        }
        let place = |(WeightedPoint { x, weight }, region)| {
            let xi = kind.inverse_map(corners, &x).ok_or_else(|| {
                self.error(cell, "a sub-cell point has no reference position".into())
            })?;
            Ok(SidedPoint {
                xi,
                x,
                weight,
                region,
            })
        };
        points.into_iter().map(place).collect()
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
    pub fn values(&self, cell: usize, xi: &Point, x: &Point, region: Region) -> Vec<f64> {
        let functions = self.enrichment.cell_basis(self.mesh, cell);
        let corners = self.mesh.corners(cell);
        let mut values = vec![0.0; functions.len()];
        let mut gradients = vec![[0.0; 3]; functions.len()];
        self.basis(cell, &corners[..self.mesh.kind.nodes()], &functions)
            .evaluate(xi, x, region, &mut values, &mut gradients);
        values
    }

    /// Gradients of the functions of a cell at a reference point (position x) [1/m].
    pub fn gradients(&self, cell: usize, xi: &Point, x: &Point, region: Region) -> Vec<Point> {
        let functions = self.enrichment.cell_basis(self.mesh, cell);
        let corners = self.mesh.corners(cell);
        let mut values = vec![0.0; functions.len()];
        let mut gradients = vec![[0.0; 3]; functions.len()];
        self.basis(cell, &corners[..self.mesh.kind.nodes()], &functions)
            .evaluate(xi, x, region, &mut values, &mut gradients);
        gradients
    }

    /// Displacement gradient ∂u_a/∂x_b at a reference point of a cell, from all unknowns u (function-major).
    pub fn displacement_gradient(
        &self,
        cell: usize,
        xi: &Point,
        region: Region,
        u: &[f64],
    ) -> [Point; 3] {
        let dim = self.mesh.dim();
        let corners = self.mesh.corners(cell);
        let x = (self.mesh.kind).map(&corners[..self.mesh.kind.nodes()], xi);
        let gradients = self.gradients(cell, xi, &x, region);
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

    /// Displacement at a point of a cell, in one of its regions.
    pub fn displacement(&self, cell: usize, x: &Point, region: Region, u: &[f64]) -> Option<Point> {
        let dim = self.mesh.dim();
        let functions = self.enrichment.cell_basis(self.mesh, cell);
        let corners = self.mesh.corners(cell);
        let basis = self.basis(cell, &corners[..self.mesh.kind.nodes()], &functions);
        let xi = self.mesh.kind.inverse_map(basis.corners, x)?;
        let mut values = vec![0.0; functions.len()];
        let mut gradients = vec![[0.0; 3]; functions.len()];
        basis.evaluate(&xi, x, region, &mut values, &mut gradients);
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

/// Tensor Gauss points of the whole cell with a region each.
fn whole_cell(
    kind: CellKind,
    corners: &[Point],
    n: usize,
    region: impl Fn(&Point) -> Region,
) -> Vec<SidedPoint> {
    gauss_cell(kind.dim(), n)
        .into_iter()
        .map(|(xi, w)| {
            let x = kind.map(corners, &xi);
            SidedPoint {
                xi,
                x,
                weight: w * kind.gradients(corners, &xi).1,
                region: region(&x),
            }
        })
        .collect()
}
