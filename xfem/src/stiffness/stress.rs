//! The stress of a cell, region by region, as its stiffness has it: assumed, of the gradient, or with the mean dilatation.
//! Whoever wants a stress asks here.

use crate::cut::part::Region;
use crate::enrichment::cell_functions::CellFunctions;
use crate::geometry::{Point, add_scaled, dot};
use crate::material::{Dilatation, Lame, strain};
use crate::mesh::cell::Nodal;
use crate::quadrature::{Quadrature, measure};

use super::assumed_stress::{AssumedStress, ShapePoint};
use super::cell_matrix::{CellError, CellIntegrator, SidedPoint};
use super::dilatation::ProjectedDilatation;
use super::elasticity::{CellMatrix, gradient_stiffness};

/// A region of less than this part of its cell keeps the stress of the gradient. Its forces are rounding to its cell, and
/// without extent in some direction it has no stress to assume.
const SLIVER: f64 = 1e-2;

/// Displacement and stress of a cell from the unknowns of the body.
#[derive(Debug)]
pub struct CellStress<'a> {
    functions: CellFunctions<'a>,
    lame: Lame,
    /// By region; `None`: of the gradient.
    assumed: Vec<Option<AssumedStress>>,
    /// Dilatation of the gradient's stress; `None`: the trace.
    dilatation: Option<ProjectedDilatation<'a>>,
}

impl<'a> CellIntegrator<'a> {
    /// The stress of a cell.
    ///
    /// # Errors
    /// A cell that cannot be integrated.
    pub fn stress(&self, cell: usize) -> Result<CellStress<'a>, CellError> {
        let mut assumed = vec![None; self.enrichment.regions(cell)];
        if self.assumes(cell) {
            for (own, points) in assumed.iter_mut().zip(self.shape_points(cell)?) {
                *own = self.assumed(cell, &points)?;
            }
        }
        let mean = self.lame.dilatation == Dilatation::Mean && assumed.iter().any(Option::is_none);
        let evaluated = mean.then(|| self.evaluated(cell)).transpose()?;
        let dilatation = evaluated.map(|own| ProjectedDilatation::of(self, cell, &own));
        Ok(CellStress {
            functions: self.functions(cell),
            lame: self.lame,
            assumed,
            dilatation,
        })
    }

    /// ∂u_a/∂x_b at the centre of a plain parallelogram or parallelepiped, from all unknowns; `None` elsewhere. Its stress by Hooke's
    /// law is that of the cell, assumed or not: the modes that vanish at the centre are orthogonal to the constants, and the
    /// gradient there is the mean one.
    pub fn central_gradient(&self, cell: usize, u: &[f64]) -> Option<[Point; 3]> {
        let (map, dim, mut h) = (self.mesh.map(cell), self.mesh.dim(), [[0.0; 3]; 3]);
        for (&node, g) in (self.mesh.cell(cell).iter()).zip(map.gradients(&[0.0; 3]).0.iter()) {
            let own = &u[node as usize * dim..][..dim];
            (h.iter_mut().zip(own)).for_each(|(h, &u)| *h = add_scaled(h, u, g));
        }
        (self.enrichment.is_plain(self.mesh, cell) && map.is_affine()).then_some(h)
    }

    /// Stiffness of the shape functions by region of a cell without branch functions, by node and component.
    pub(super) fn region_stiffness(&self, cell: usize) -> Result<Vec<CellMatrix>, CellError> {
        let of_region = |points: &Vec<ShapePoint>| match self.assumed(cell, points)? {
            Some(assumed) => Ok(assumed.stiffness()),
            None => Ok(gradient_stiffness(&self.mesh.map(cell), self.lame, points)),
        };
        self.shape_points(cell)?.iter().map(of_region).collect()
    }

    /// Whether a cell has regions of assumed stress: not beside tips, and not where the rule does not know the regions.
    fn assumes(&self, cell: usize) -> bool {
        let whole = self.enrichment.partition(cell).is_none();
        self.lame.assumed
            && !self.enrichment.has_branch(cell)
            && (whole || self.quadrature == Quadrature::SubCells)
    }

    /// The assumed stress of a region; `None`: of the gradient.
    fn assumed(
        &self,
        cell: usize,
        points: &[ShapePoint],
    ) -> Result<Option<AssumedStress>, CellError> {
        let map = self.mesh.map(cell);
        let volume: f64 = points.iter().map(|(at, _)| at.weight).sum();
        if !self.assumes(cell) || volume < SLIVER * measure(&map) {
            return Ok(None);
        }
        AssumedStress::new(&map, self.lame, points).map(Some)
    }

    /// The points of a cell without branch functions, by region, with the gradients of the shape functions.
    fn shape_points(&self, cell: usize) -> Result<Vec<Vec<ShapePoint>>, CellError> {
        let functions = self.functions(cell);
        let (map, nodes) = (&functions.map, functions.map.len());
        let mut regions = vec![Vec::new(); self.enrichment.regions(cell)];
        let mut put = |at: SidedPoint, g: Nodal<Point>| regions[at.region].push((at, g));
        match map.constant_inverse() {
            Some(inverse) => self.points(cell)?.into_iter().for_each(|at| {
                let slopes = map.slopes(&at.xi.map(|v| [v]), Some(&inverse));
                put(at, Nodal::new(nodes, |i| slopes[i].map(|[g]| g)));
            }),
            None => {
                // Standard functions come first.
                let locals: Vec<usize> = functions.steps(0).take(nodes).map(|s| s.0).collect();
                for p in self.evaluated(cell)? {
                    let mut gradients = Nodal::new(nodes, |_| [0.0; 3]);
                    for (&local, g) in locals.iter().zip(&p.gradients) {
                        gradients[local] = *g;
                    }
                    put(p.at, gradients);
                }
            }
        }
        Ok(regions)
    }
}

impl CellStress<'_> {
    /// Displacement [m] at ξ (position x) in a region, and the gradient ∂u_a/∂x_b whose stress by Hooke's law is that of the
    /// cell; from all unknowns. Where the stress is assumed, C⁻¹ σ takes the place of the strain.
    pub fn field(
        &mut self,
        xi: &Point,
        x: &Point,
        region: Region,
        u: &[f64],
    ) -> (Point, [Point; 3]) {
        let functions = &mut self.functions;
        let (v, h) = functions.field(xi, x, region, u);
        let dim = functions.map.kind.dim();
        if let Some(assumed) = &self.assumed[region] {
            let mut nodal = vec![0.0; functions.map.len() * dim];
            for (&f, (local, step)) in functions.numbers.iter().zip(functions.steps(region)) {
                (0..dim).for_each(|a| nodal[local * dim + a] += step * u[f as usize * dim + a]);
            }
            let e = strain(self.lame, dim, &assumed.at(xi, &nodal));
            let part = |a: usize, b: usize| e[a][b] + 0.5 * (h[a][b] - h[b][a]);
            return (v, [0, 1, 2].map(|a| [0, 1, 2].map(|b| part(a, b))));
        }
        match &self.dilatation {
            Some(own) => (v, own.projected(region, x, functions.numbers, u, h)),
            None => (v, h),
        }
    }

    /// σ n at ξ (position x) in a region, per unit of every unknown of the cell [Pa/m], with the number of the unknown.
    ///
    /// With σ = λ tr(h) I + μ (h + hᵀ) and h_ab = Σ u_a ∂_b φ, the unknown u_a of a function φ enters by
    /// λ ∂_a φ n + μ ((∇φ·n) e_a + n_a ∇φ); behind λ what the dilatation takes for ∂_a φ.
    pub fn tractions(
        &mut self,
        xi: &Point,
        x: &Point,
        region: Region,
        n: &Point,
    ) -> Vec<(usize, Point)> {
        let functions = &mut self.functions;
        let dim = functions.map.kind.dim();
        let mut found = Vec::with_capacity(functions.numbers.len() * dim);
        if let Some(assumed) = &self.assumed[region] {
            let nodal = assumed.response(xi, n);
            for (&f, (local, step)) in functions.numbers.iter().zip(functions.steps(region)) {
                for a in 0..dim {
                    let t = nodal[local * dim + a].map(|t| step * t);
                    found.push((f as usize * dim + a, t));
                }
            }
            return found;
        }
        let Lame { lambda, mu, .. } = self.lame;
        functions.evaluate(xi, x, region);
        let gradients = &functions.gradients;
        let own = self.dilatation.as_ref();
        let dilating = own.map(|own| own.gradients(region, x, gradients.len()));
        for (k, &f) in functions.numbers.iter().enumerate() {
            let g = &gradients[k];
            let d = dilating.as_ref().map_or(g, |d| &d[k]);
            for a in 0..dim {
                let mut t = [0, 1, 2].map(|b| lambda * d[a] * n[b] + mu * n[a] * g[b]);
                t[a] += mu * dot(g, n);
                found.push((f as usize * dim + a, t));
            }
        }
        found
    }
}
